"""Colours and spectra, as linear red, green and blue (Rec. 709)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .plugin import Plugin, Triple

# Types of plugins that are one colour, or one number, all over.
UNIFORM = ("rgb", "srgb", "spectrum", "uniform", "d65", "rawconstant")

# From CIE 1931 XYZ to linear Rec. 709 (ITU-R BT.709).
_TO_RGB = np.array(
    [
        (3.240479, -1.537150, -0.498535),
        (-0.969256, 1.875991, 0.041556),
        (0.055648, -0.204043, 1.057311),
    ]
)


def colour(plugin: Plugin, name: str, default: float | Triple, emits: bool = False) -> Triple:
    """Return a parameter of a plugin that is one colour.

    Parameters
    ----------
    plugin : Plugin
        Whose parameter it is.
    name : str
        Its name.
    default : float or 3 floats
        If it is not given.
    emits : bool
        Whether it is light rather than a share of light: a spectrum that is even over wavelengths is not
        white then.
    """
    value = plugin.take(name, default)
    if isinstance(value, Mapping):
        inner = Plugin(value, f"{plugin.where}.{name}", plugin.context)
        if inner.type not in UNIFORM:
            plugin.fail(f"{name} must be the same everywhere, got a {inner.type}")
        return of_plugin(inner, emits)
    return of_numbers(plugin, name, value)


def of_plugin(plugin: Plugin, emits: bool) -> Triple:
    """Return the colour of a plugin of a type in `UNIFORM`."""
    kind = plugin.type
    if kind in ("rgb", "srgb", "rawconstant"):
        name = "color" if plugin.has("color") else "value"
        value = plugin.take(name)
        plugin.ignore("unbounded")
        coded = kind == "srgb"
        result = _hex(plugin, value, coded) if isinstance(value, str) else of_numbers(plugin, name, value)
    elif kind == "d65":
        scale = plugin.number("scale", 1.0)
        result = colour(plugin, "color", 1.0)
        result = _triple(np.multiply(result, scale))
    elif plugin.has("filename"):
        plugin.fail("spectra in files are not supported; give an rgb")
    elif kind == "uniform" or not isinstance(plugin.take("value"), list | tuple | np.ndarray):
        value = plugin.number("value", 1.0)
        result = (value,) * 3
        if emits and kind == "spectrum":
            result = _triple(_TO_RGB.sum(axis=1) * value)
    else:
        result = _by_wavelength(plugin, plugin.take("value"), emits)
    plugin.done()
    return result


def of_numbers(plugin: Plugin, name: str, value: Any) -> Triple:
    """Return one number or three as a colour."""
    try:
        array = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.shape not in ((), (1,), (3,)) or not np.isfinite(array).all():
        plugin.fail(f"{name} must be one finite number or 3, got {value!r}")
    return _triple(np.broadcast_to(array, 3))


def _hex(plugin: Plugin, text: str, coded: bool) -> Triple:
    """Read ``#rrggbb``: linear in an rgb, with the transfer of sRGB in an srgb."""
    digits = text.removeprefix("#")
    try:
        if len(digits) != 6 or not text.startswith("#"):
            raise ValueError
        shares = np.array([int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)])
    except ValueError:
        plugin.fail(f"value must be numbers or #rrggbb, got {text!r}")
    if coded:
        shares = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    return _triple(shares)


def _by_wavelength(plugin: Plugin, pairs: Any, emits: bool) -> Triple:
    """Return the colour of values at wavelengths, in nm, linear between them and 0 outside.

    The eye's response is that of Wyman, Sloan and Shirley, "Simple Analytic Approximations to the CIE XYZ
    Color Matching Functions" (2013), within 1 % of the tables' peaks. What reflects is seen in even light.
    """
    try:
        table = np.array(pairs, dtype=np.float64)
    except (TypeError, ValueError):
        table = np.empty(0)
    if table.ndim != 2 or table.shape[1] != 2 or not np.isfinite(table).all() or not len(table):
        plugin.fail("value must be one number, or pairs of a wavelength and a number")
    if (np.diff(table[:, 0]) <= 0).any():
        plugin.fail("wavelengths must rise")
    plugin.warn("spectra by wavelength are approximated by red, green and blue")
    wavelengths = np.arange(360.0, 831.0)
    response = _TO_RGB @ _matching(wavelengths)
    values = np.interp(wavelengths, table[:, 0], table[:, 1], left=0.0, right=0.0)
    even = response.sum(axis=1)
    result = (response @ values) / even
    if emits:
        # Even light is not white, but as red as its share of each response tells.
        result = result * _TO_RGB.sum(axis=1)
    return _triple(np.maximum(result, 0.0))


def _matching(wavelengths: NDArray[np.float64]) -> NDArray[np.float64]:
    def lobe(weight: float, middle: float, below: float, above: float) -> NDArray[np.float64]:
        x = wavelengths - middle
        return np.asarray(weight * np.exp(-0.5 * (x * np.where(x < 0, below, above)) ** 2))

    return np.stack(
        [
            lobe(0.362, 442.0, 0.0624, 0.0374)
            + lobe(1.056, 599.8, 0.0264, 0.0323)
            + lobe(-0.065, 501.1, 0.0490, 0.0382),
            lobe(0.821, 568.8, 0.0213, 0.0247) + lobe(0.286, 530.9, 0.0613, 0.0322),
            lobe(1.217, 437.0, 0.0845, 0.0278) + lobe(0.681, 459.0, 0.0385, 0.0725),
        ]
    )


def _triple(array: Any) -> Triple:
    red, green, blue = (float(x) for x in array)
    return red, green, blue
