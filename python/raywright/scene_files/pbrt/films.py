"""Films: their size, and the response of their sensor."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ... import _core
from ..mitsuba.spectra import black_body as planck
from .parameters import Floats, Parameters

# Linear red, green and blue (Rec. 709, white D65) from XYZ.
_RGB_FROM_XYZ = np.array(
    [(3.240479, -1.537150, -0.498535), (-0.969256, 1.875991, 0.041556), (0.055648, -0.204043, 1.057311)]
)
_XYZ_FROM_RGB = np.linalg.inv(_RGB_FROM_XYZ)
# Cone responses for von Kries' adaptation (Lam, "Metamerism and Colour Constancy", 1985: Bradford).
_LMS_FROM_XYZ = np.array([(0.8951, 0.2664, -0.1614), (-0.7502, 1.7135, 0.0367), (0.0389, -0.0685, 1.0296)])
# Below, daylight is not defined and white is a black body.
_COLDEST_DAYLIGHT = 4000.0


@dataclass(frozen=True)
class Film:
    """A film.

    Parameters
    ----------
    size : tuple of 2 ints
        Width and height in pixels.
    speed : float
        Its ISO speed over 100, times its own exposure time if it has one.
    timed : bool
        True if the film has an exposure time, which then counts in place of the camera's shutter.
    white : float, optional
        The temperature of the light that looks white, in kelvin.
    most : float, optional
        Limit on the largest component of a sample.
    """

    size: tuple[int, int] = (1280, 720)
    speed: float = 1.0
    timed: bool = False
    white: float | None = None
    most: float | None = None

    def imaging(self, exposure: float) -> Floats:
        """Return the (3, 3) matrix from radiance to the film's pixels.

        Parameters
        ----------
        exposure : float
            Time for which the camera's shutter is open.
        """
        ratio = self.speed * (1.0 if self.timed else exposure)
        return ratio * (np.eye(3) if self.white is None else balance(self.white))


def film(kind: str, parameters: Parameters) -> Film:
    """Return a film.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    if kind not in ("rgb", "gbuffer", "spectral"):
        parameters.fail(f"a film {kind!r} is not supported")
    if kind != "rgb":
        parameters.notes.tell(f"a film {kind!r} is read as an RGB film")
    size = parameters.integer("xresolution", 1280), parameters.integer("yresolution", 720)
    for side in size:
        if not 1 <= side <= 65536:
            parameters.fail(f"a resolution must be between 1 and 65536, got {side:g}")
    for name in ("cropwindow", "pixelbounds"):
        if parameters.has(name):
            parameters.fail(f"{name} is not supported")
    if parameters.text("sensor", "cie1931") != "cie1931":
        # White is daylight of 6500 K with or without a sensor.
        parameters.notes.tell("a film's sensor is left out: colors are those that the eye sees")
    white = _above_0(parameters, "whitebalance", 0.0, zero=True)
    if white and not math.isclose(white, 6500, rel_tol=0.01):
        parameters.notes.tell(
            "whitebalance is applied to the light: exact for gray surfaces, approximate for others"
        )
    if parameters.has("maxcomponentvalue"):
        parameters.notes.tell(
            "maxcomponentvalue limits red, green and blue, in place of the sensor's channels"
        )
    made = Film(
        size,
        0.01 * _above_0(parameters, "iso", 100.0) * _above_0(parameters, "exposuretime", 1.0),
        parameters.has("exposuretime"),
        white or None,
        _above_0(parameters, "maxcomponentvalue", 1.0) if parameters.has("maxcomponentvalue") else None,
    )
    # Parameters of output files, and of other cameras and films.
    parameters.ignore(
        "filename", "savefp16", "diagonal", "coordinatesystem", "nbuckets", "lambdamin", "lambdamax"
    )
    parameters.done()
    return made


def _above_0(parameters: Parameters, name: str, default: float, zero: bool = False) -> float:
    value = parameters.number(name, default)
    if value < 0 or (value == 0 and not zero):
        parameters.fail(f"{name} must be {'at least' if zero else 'above'} 0, got {value:g}")
    return value


def exposure(parameters: Parameters) -> float:
    """Return how long a camera's shutter is open."""
    opens, closes = parameters.number("shutteropen", 0.0), parameters.number("shutterclose", 1.0)
    if not closes > opens:
        parameters.fail(f"shutterclose must be above shutteropen, got {closes:g} and {opens:g}")
    return closes - opens


def balance(kelvin: float) -> Floats:
    """Return the (3, 3) matrix by which daylight of a temperature becomes white, as bright as before."""
    source, target = (_LMS_FROM_XYZ @ white for white in (_white(kelvin), _XYZ_FROM_RGB @ np.ones(3)))
    adapted = np.linalg.inv(_LMS_FROM_XYZ) @ np.diag(target / source) @ _LMS_FROM_XYZ
    return np.asarray(_RGB_FROM_XYZ @ adapted @ _XYZ_FROM_RGB, np.float64)


def _white(kelvin: float) -> Floats:
    """Return daylight of a correlated temperature as XYZ with a Y of 1 (CIE 015:2018)."""
    # The constant in Planck's law has changed since the definition of daylight.
    t = kelvin * 1.4388 / 1.4380
    if t < _COLDEST_DAYLIGHT:
        xyz = _XYZ_FROM_RGB @ np.array(_core.spectrum_rgb(planck(t).tolist(), False))
        return np.asarray(xyz / xyz[1])
    if t <= 7000:
        x = -4.6070e9 / t**3 + 2.9678e6 / t**2 + 99.11 / t + 0.244063
    else:
        x = -2.0064e9 / t**3 + 1.9018e6 / t**2 + 247.48 / t + 0.237040
    y = -3 * x * x + 2.870 * x - 0.275
    return np.array((x / y, 1.0, (1 - x - y) / y))
