"""Spectra that are told by wavelength, as linear red, green and blue (Rec. 709)."""

import numpy as np
from numpy.typing import NDArray

# From CIE 1931 XYZ (ITU-R BT.709).
_TO_RGB = np.array(
    [
        (3.240479, -1.537150, -0.498535),
        (-0.969256, 1.875991, 0.041556),
        (0.055648, -0.204043, 1.057311),
    ]
)

# What light of equal energy at all wavelengths is, of a luminance of 1: reddish, as white is D65.
EVEN = _TO_RGB.sum(axis=1)

_WAVELENGTHS = np.arange(360.0, 831.0)

# Daylight at 380, 390, ... 780 nm (CIE standard illuminant D65).
_D65 = """
49.98 54.65 82.75 91.49 93.43 86.68 104.86 117.01 117.81 114.86 115.92 108.81 109.35 107.80
104.79 107.69 104.41 104.05 100.00 96.33 95.79 88.69 90.01 89.60 87.70 83.29 83.70 80.03
80.21 82.28 78.28 69.72 71.61 74.35 61.60 69.89 75.09 63.59 46.42 66.81 63.38
"""


def rgb(table: NDArray[np.float64], emits: bool) -> NDArray[np.float64]:
    """Return the colour of values at wavelengths, in nm, linear between them and 0 outside.

    The eye's response is that of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ
    Color Matching Functions" (2013), within 1 % of the tables' peaks.

    Parameters
    ----------
    table : (N, 2) array
        Wavelengths, rising, and values.
    emits : bool
        Whether they are light: 1 at all wavelengths is `EVEN`. If not they are shares of daylight, of which
        1 is white.
    """
    values = np.interp(_WAVELENGTHS, table[:, 0], table[:, 1], left=0.0, right=0.0)
    if emits:
        response = _matching()
        return np.asarray(np.maximum(_TO_RGB @ (response @ values / response.sum(axis=1)), 0.0))
    daylight = np.interp(_WAVELENGTHS, np.arange(380, 781, 10), np.array(_D65.split(), np.float64))
    response = _TO_RGB @ (_matching() * daylight)
    return np.asarray(np.maximum(response @ values / response.sum(axis=1), 0.0))


def _matching() -> NDArray[np.float64]:
    def lobe(weight: float, middle: float, below: float, above: float) -> NDArray[np.float64]:
        x = _WAVELENGTHS - middle
        return np.asarray(weight * np.exp(-0.5 * (x * np.where(x < 0, below, above)) ** 2))

    return np.stack(
        [
            lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(0.362, 442.0, 0.0624, 0.0374)
            - lobe(0.065, 501.1, 0.0490, 0.0382),
            lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
            lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
        ]
    )
