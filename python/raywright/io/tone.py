"""Tone mapping: from unbounded radiance to displayable values."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import number

TONES = ("filmic", "linear")
# Default tone curve of all viewers.
DEFAULT = "filmic"

# Colors up to here are unchanged.
_KNEE = 0.5
# Rate at which bright colors turn white, from the Khronos PBR Neutral tone mapper.
_DESATURATION = 0.15
# Largest finite float32.
_BRIGHTEST = float(np.finfo(np.float32).max)
# More stops than any picture needs; far more would overflow float64.
_MOST_STOPS = 100.0


def check_tone(exposure: float, tone: str) -> float:
    """Return an exposure, in stops.

    Raises
    ------
    ValueError
        If it is out of -100..100, or the tone is not known.
    TypeError
        If an argument is not a number.
    """
    exposure = number("exposure", exposure)
    if not abs(exposure) <= _MOST_STOPS:
        raise ValueError(f"exposure must be between -100 and 100 stops, got {exposure:g}")
    if not isinstance(tone, str) or tone not in TONES:
        raise ValueError(f"tone must be one of {', '.join(TONES)}, got {tone!r}")
    return exposure


def toned(rgb: NDArray[np.floating[Any]], exposure: float, tone: str) -> NDArray[np.float64]:
    """Return linear colors between 0 and 1: exposed by so many stops, then brought into range.

    ``"linear"`` clips. ``"filmic"`` keeps colors up to half of white unchanged, and compresses brighter ones:
    the largest channel by the shoulder of the Khronos PBR Neutral tone mapper (Khronos Group, 2024), and the
    others with it, so that hues stay; far brighter colors fade to white, as on film. Its toe, which would
    darken mid-grays by more than a fifth, is left out, and its shoulder begins at 0.5 rather than at 0.76, so
    that skies and lamps keep their shapes.
    """
    light = np.nan_to_num(np.asarray(rgb, np.float64), nan=0.0, posinf=_BRIGHTEST)
    light = np.maximum(light, 0.0) * 2.0**exposure
    if tone == "linear":
        return np.asarray(np.minimum(light, 1.0))
    # All is white beyond, and squares would overflow.
    light = np.minimum(light, 1e30)
    peak = light.max(axis=-1, keepdims=True)
    over = np.maximum(peak - _KNEE, 0.0)
    room = 1.0 - _KNEE
    # The curve has slope 1 at the knee and tends to 1 at infinity.
    shown = np.where(peak > _KNEE, 1.0 - room * room / (over + room), peak)
    scaled = light * (shown / np.where(peak > 0, peak, 1.0))
    white = 1.0 - 1.0 / (_DESATURATION * (peak - shown) + 1.0)
    return np.asarray(scaled + (shown - scaled) * white)
