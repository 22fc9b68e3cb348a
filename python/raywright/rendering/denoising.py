"""Denoising of a picture, and the error that remains."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .. import _core
from .halves import Halves

METHODS = ("regression", "oidn")
NO_OIDN = "method='oidn' needs Open Image Denoise: pip install 'raywright[oidn]'"


class Denoised(NamedTuple):
    """A picture without noise: its colors, how far they are off, and its relMSE with an interval."""

    rgb: NDArray[np.float32]
    off: NDArray[np.float32]
    error: tuple[float, float, float]
    trusted: bool


def check_method(name: str, value: object) -> str:
    """Return a method of the denoiser by `value`, or raise a ValueError."""
    if value not in METHODS:
        raise ValueError(f"{name} must be one of {', '.join(METHODS)}, got {value!r}")
    return str(value)


def denoised(halves: Halves, method: str, threads: int | None) -> Denoised:
    """Return the picture made of two halves, each filtered by itself."""
    known = {
        "quarters": halves.quarters,
        "variances": halves.variance,
        "samples": float(halves.samples),
        "patch": halves.patch,
    }
    if method == "oidn":
        candidates = _by_oidn(halves)
    else:
        candidates = _core.denoise_candidates(known, halves.features, threads)
    return Denoised(*_core.denoise_settle(known, candidates, threads))


def _by_oidn(halves: Halves) -> NDArray[np.float32]:
    """Return both halves without filter, and by Open Image Denoise."""
    try:
        import pyoidn
    except ImportError as error:
        raise ImportError(NO_OIDN) from error

    albedo, normal = (
        np.ascontiguousarray(np.nan_to_num(picture.mean(axis=0, dtype=np.float64)).astype(np.float32))
        for picture in (halves.albedo, halves.normal)
    )
    ways = []
    for half in halves.rgb:
        light = np.ascontiguousarray(np.maximum(half, 0))
        found = pyoidn.denoise(light, albedo=albedo.clip(0, 1), normal=normal, hdr=True)
        ways.append(np.stack([half, np.asarray(found, np.float32)]))
    return np.ascontiguousarray(np.stack(ways))
