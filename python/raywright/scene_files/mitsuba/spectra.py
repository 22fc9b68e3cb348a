"""Uniform spectra, and blackbody spectra."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...textures.blackbody import planck

# Color of an equal-energy spectrum of luminance 1: reddish, as white is D65. By Mitsuba's matrix from CIE
# 1931 XYZ (ITU-R BT.709).
EVEN = np.array((1.204794, 0.948291, 0.908916))


def black_body(kelvin: float) -> NDArray[np.float64]:
    """Return the radiance of a black body by wavelength (Planck, 1900): rows of nm and W·sr⁻¹·m⁻²·nm⁻¹."""
    wavelengths = np.arange(360.0, 831.0, 5.0)
    return np.column_stack([wavelengths, planck(wavelengths, kelvin)])
