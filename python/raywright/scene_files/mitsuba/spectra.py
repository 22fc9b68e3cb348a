"""Spectra that are given by wavelength, as linear red, green and blue (Rec. 709)."""

import numpy as np
from numpy.typing import NDArray

from ... import _core

# What light of equal energy at all wavelengths is, of a luminance of 1: reddish, as white is D65. By the
# matrix from CIE 1931 XYZ that Mitsuba has (ITU-R BT.709).
EVEN = np.array((1.204794, 0.948291, 0.908916))


def black_body(kelvin: float) -> NDArray[np.float64]:
    """Return the radiance of a black body by wavelength (Planck, 1900): rows of nm and W·sr⁻¹·m⁻²·nm⁻¹."""
    wavelengths = np.arange(360.0, 831.0, 5.0)
    metres = wavelengths * 1e-9
    # 2 h c², and h c over Boltzmann's constant (SI, 2019).
    with np.errstate(over="ignore"):
        shine = 1.1910429723971884e-16 / metres**5 / np.expm1(0.014387768775039337 / (metres * kelvin))
    return np.column_stack([wavelengths, 1e-9 * shine])


def rgb(table: NDArray[np.float64], emits: bool) -> NDArray[np.float64]:
    """Return the colour of values at wavelengths, in nm, linear between them and 0 outside.

    As the standard observer sees them (CIE 1931). Where a colour would need less than none of red, green or
    blue, it gets none of that.

    Parameters
    ----------
    table : (N, 2) array
        Wavelengths, rising, and values.
    emits : bool
        Whether they are light: 1 at all wavelengths is `EVEN`. If not they are shares of daylight, of which
        1 is white.
    """
    return np.maximum(_core.spectrum_rgb(table.tolist(), not emits), 0.0)
