"""Colors and spectra, as linear red, green and blue (Rec. 709)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import _core
from ..mitsuba.spectra import black_body as planck
from .parameters import Parameters

Triple = tuple[float, float, float]

# Catalog names of pbrt's glasses; those of F are Schott's SF.
GLASS = {
    "glass-BK7": "N-BK7",
    "glass-BAF10": "N-BAF10",
    "glass-FK51A": "N-FK51A",
    "glass-LASF9": "N-LASF9",
    "glass-F5": "SF5",
    "glass-F10": "SF10",
    "glass-F11": "N-SF11",
}


def color(parameters: Parameters, name: str, default: float | Triple, emits: bool = False) -> Triple:
    """Return a parameter that is one color.

    Emission that is not given as rgb has a luminance of 1, as in pbrt.
    """
    found = parameters.take(name)
    if found is None:
        return _triple(np.broadcast_to(default, 3))
    kind, values = found
    if kind == "rgb" and len(values) != 3:
        parameters.fail(f"{name} must be 3 numbers, got {len(values)}")
    plain = set(map(type, values)) <= {float}
    if plain and not np.isfinite(values).all():
        parameters.fail(f"{name} must be finite numbers")
    if plain and kind in ("rgb", "float", "color", "xyz") and len(values) in (1, 3):
        return _triple(np.broadcast_to(values, 3))
    if plain and kind == "blackbody" and emits and len(values) == 1:
        if values[0] <= 0:
            parameters.fail(f"{name} must be a temperature above 0, in kelvin, got {values[0]:g}")
        return _bright(black_body(values[0]))
    if plain and kind == "spectrum" and len(values) >= 4 and len(values) % 2 == 0:
        table = np.array(values, np.float64).reshape(-1, 2)
        if (np.diff(table[:, 0]) <= 0).any():
            parameters.fail(f"{name} must have increasing wavelengths")
        rgb = np.maximum(_core.spectrum_rgb(table.tolist(), not emits), 0.0)
        return _bright(rgb) if emits else _triple(rgb)
    parameters.fail(f"{name} must be an rgb or a spectrum of numbers, got a {kind} of {_told(values)}")


def black_body(kelvin: float) -> NDArray[np.float64]:
    """Return the color of a black body (Planck, 1900), of any brightness."""
    table = planck(kelvin)
    table[:, 1] /= table[:, 1].max()
    return np.maximum(_core.spectrum_rgb(table.tolist(), False), 0.0)


def _bright(rgb: Any) -> Triple:
    luminance = float(np.dot(rgb, (0.212671, 0.715160, 0.072169)))
    return _triple(np.asarray(rgb) / luminance) if luminance > 0 else (0.0, 0.0, 0.0)


def _told(values: list[Any]) -> str:
    return repr(values[0])[:40] if len(values) == 1 else f"{len(values)} values"


def _triple(values: Any) -> Triple:
    red, green, blue = (float(x) for x in values)
    return red, green, blue
