"""The colors of the Cornell box, from the spectra that were measured of it.

Reflectances of its walls and the radiance of its lamp, as published by the Cornell University Program of
Computer Graphics ("Cornell Box Data").
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple

# Nanometers.
_WAVELENGTHS = np.arange(400, 701, 4)

_WHITE = """
.343 .445 .551 .624 .665 .687 .708 .723 .715 .710 .745 .758 .739 .767 .777 .765 .751 .745 .748 .729 .745 .757
.753 .750 .746 .747 .735 .732 .739 .734 .725 .721 .733 .725 .732 .743 .744 .748 .728 .716 .733 .726 .713 .740
.754 .764 .752 .736 .734 .741 .740 .732 .745 .755 .751 .744 .731 .733 .744 .731 .712 .708 .729 .730 .727 .707
.703 .729 .750 .760 .751 .739 .724 .730 .740 .737
"""
_RED = """
.040 .046 .048 .053 .049 .050 .053 .055 .057 .056 .059 .057 .061 .061 .060 .062 .062 .062 .061 .062 .060 .059
.057 .058 .058 .058 .056 .055 .056 .059 .057 .055 .059 .059 .058 .059 .061 .061 .063 .063 .067 .068 .072 .080
.090 .099 .124 .154 .192 .255 .287 .349 .402 .443 .487 .513 .558 .584 .620 .606 .609 .651 .612 .610 .650 .638
.627 .620 .630 .628 .642 .639 .657 .639 .635 .642
"""
_GREEN = """
.092 .096 .098 .097 .098 .095 .095 .097 .095 .094 .097 .098 .096 .101 .103 .104 .107 .109 .112 .115 .125 .140
.160 .187 .229 .285 .343 .390 .435 .464 .472 .476 .481 .462 .447 .441 .426 .406 .373 .347 .337 .314 .285 .277
.266 .250 .230 .207 .186 .171 .160 .148 .141 .136 .130 .126 .123 .121 .122 .119 .114 .115 .117 .117 .118 .120
.122 .128 .132 .139 .144 .146 .150 .152 .157 .159
"""
# The lamp's radiance at four wavelengths, linear between them, and its reflectance at all of them.
_LAMP = {400: 0.0, 500: 8.0, 600: 15.6, 700: 18.4}
LAMP_REFLECTANCE = 0.78

# From CIE 1931 XYZ to linear Rec. 709 (IEC 61966-2-1).
_TO_RGB = np.array([[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]])


def _matching() -> NDArray[np.float64]:
    """Return the CIE 1931 color-matching functions, (3, W).

    Sums of lobes by Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching
    Functions" (2013), within 1 % of the tables' peaks.
    """

    def lobe(middle: float, below: float, above: float) -> NDArray[np.float64]:
        x = _WAVELENGTHS - middle
        return np.asarray(np.exp(-0.5 * (x * np.where(x < 0, below, above)) ** 2))

    lobes: NDArray[np.float64] = np.stack(
        [
            0.362 * lobe(442.0, 0.0624, 0.0374)
            + 1.056 * lobe(599.8, 0.0264, 0.0323)
            - 0.065 * lobe(501.1, 0.0490, 0.0382),
            0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322),
            1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725),
        ]
    )
    return lobes


def _color(spectrum: NDArray[np.float64]) -> Triple:
    """Linear Rec. 709 of a spectrum, such that one that is the same everywhere is gray of its value."""
    response = _TO_RGB @ _matching()
    red, green, blue = (response @ spectrum) / response.sum(axis=1)
    return float(red), float(green), float(blue)


def _of_table(table: str) -> Triple:
    return _color(np.array(table.split(), np.float64))


WHITE = _of_table(_WHITE)
RED = _of_table(_RED)
GREEN = _of_table(_GREEN)
EMISSION = _color(np.interp(_WAVELENGTHS, list(_LAMP), list(_LAMP.values())))
