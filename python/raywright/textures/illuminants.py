"""Light that standards define."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .spectrum import Spectrum

_WAVELENGTHS = np.arange(360.0, 831.0)
# Fluorescent lamps of the CIE (CIE 015:2018, every 5 nm from 380 to 780): cool white, broad-band daylight,
# and one of three narrow bands.
_LAMPS = {
    "F2": """
        1.18 1.48 1.84 2.15 3.44 15.69 3.85 3.74 4.19 4.62 5.06 34.98 11.81 6.27 6.63 6.93 7.19 7.40 7.54
        7.62 7.65 7.62 7.62 7.45 7.28 7.15 7.05 7.04 7.16 7.47 8.04 8.88 10.01 24.88 16.64 14.59 16.16 17.56
        18.62 21.47 22.79 19.29 18.66 17.73 16.54 15.21 13.80 12.36 10.95 9.65 8.40 7.32 6.31 5.43 4.68 4.02
        3.45 2.96 2.55 2.19 1.89 1.64 1.53 1.27 1.10 0.99 0.88 0.76 0.68 0.61 0.56 0.54 0.51 0.47 0.47 0.43
        0.46 0.47 0.40 0.33 0.27
    """,
    "F7": """
        2.56 3.18 3.84 4.53 6.15 19.37 7.37 7.05 7.71 8.41 9.15 44.14 17.52 11.35 12.00 12.58 13.08 13.45
        13.71 13.88 13.95 13.93 13.82 13.64 13.43 13.25 13.08 12.93 12.78 12.60 12.44 12.33 12.26 29.52
        17.05 12.44 12.58 12.72 12.83 15.46 16.75 12.83 12.67 12.45 12.19 11.89 11.60 11.35 11.12 10.95
        10.76 10.42 10.11 10.04 10.02 10.11 9.87 8.65 7.27 6.44 5.83 5.41 5.04 4.57 4.12 3.77 3.46 3.08 2.73
        2.47 2.25 2.06 1.90 1.75 1.62 1.54 1.45 1.32 1.17 0.99 0.81
    """,
    "F11": """
        0.91 0.63 0.46 0.37 1.29 12.68 1.59 1.79 2.46 3.33 4.49 33.94 12.13 6.95 7.19 7.12 6.72 6.13 5.46
        4.79 5.66 14.29 14.96 8.97 4.72 2.33 1.47 1.10 0.89 0.83 1.18 4.90 39.59 72.84 32.61 7.52 2.83 1.96
        1.67 4.43 11.28 14.76 12.73 9.74 7.33 9.72 55.27 42.58 13.18 13.16 12.26 5.11 2.07 2.34 3.58 3.01
        2.48 2.14 1.54 1.33 1.46 1.94 2.00 1.20 1.35 4.10 5.58 2.51 0.57 0.27 0.23 0.21 0.24 0.24 0.20 0.24
        0.32 0.26 0.16 0.12 0.09
    """,
}


def _incandescent() -> NDArray[np.float64]:
    """Return the standard illuminant A by its definition (CIE 015:2018): a light bulb of about 2856 K."""
    nm = _WAVELENGTHS
    power = 100 * (560 / nm) ** 5 * np.expm1(1.435e7 / (2848 * 560)) / np.expm1(1.435e7 / (2848 * nm))
    return np.asarray(power, np.float64)


def _lamp(name: str) -> Spectrum:
    return Spectrum(np.arange(380.0, 781.0, 5.0), np.array(_LAMPS[name].split(), np.float64))


_TOLD: dict[str, Callable[[], NDArray[np.float64]]] = {
    "A": _incandescent,
    "D65": lambda: np.asarray(_core.daylight_power()),
    "E": lambda: np.ones_like(_WAVELENGTHS),
}


class Illuminants(Mapping[str, Spectrum]):
    """Standard illuminants by name, each of a luminance of 1: ``5 * rw.textures.illuminants["A"]``.

    "A" is a light bulb, "D65" is daylight, which is white here, "E" is the same at all wavelengths, and "F2",
    "F7" and "F11" are fluorescent lamps (CIE 015:2018).

    Raises
    ------
    KeyError
        If there is no such name; the error lists all names.

    See Also
    --------
    Spectrum : Any light.

    Examples
    --------
    >>> sorted(rw.textures.illuminants)
    ['A', 'D65', 'E', 'F11', 'F2', 'F7']
    >>> lamp = rw.PointLight((0, 0, 3), 5 * rw.textures.illuminants["A"])
    >>> round(rw.textures.illuminants["F11"].luminance, 6)
    1.0
    """

    def __getitem__(self, name: str) -> Spectrum:
        if name not in (*_TOLD, *_LAMPS):
            raise KeyError(f"no illuminant {name!r}; there are {', '.join(self)}")
        told = _lamp(name) if name in _LAMPS else Spectrum(_WAVELENGTHS, _TOLD[name]())
        return told * (1 / told.luminance)

    def __iter__(self) -> Iterator[str]:
        return iter((*_TOLD, *_LAMPS))

    def __len__(self) -> int:
        return len(_TOLD) + len(_LAMPS)

    def __repr__(self) -> str:
        return f"Illuminants({', '.join(self)})"


illuminants = Illuminants()
