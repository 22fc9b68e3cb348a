"""Colours and spectra, as linear red, green and blue (Rec. 709)."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from . import spectra
from .plugin import Plugin, Triple

# Types of plugins that are one colour, or one number, all over.
UNIFORM = ("rgb", "srgb", "spectrum", "uniform", "d65", "rawconstant", "blackbody")


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
    elif kind == "blackbody":
        kelvin, scale = plugin.number("temperature", 5000.0), plugin.number("scale", 1.0)
        if not kelvin > 0:
            plugin.fail(f"temperature must be greater than 0, got {kelvin:g}")
        result = _triple(scale * np.maximum(spectra.rgb(spectra.black_body(kelvin), emits), 0.0))
    elif plugin.has("filename"):
        plugin.fail("spectra in files are not supported; give an rgb")
    elif kind == "uniform" or not isinstance(plugin.take("value"), list | tuple | np.ndarray):
        value = plugin.number("value", 1.0)
        result = (value,) * 3
        if emits and kind == "spectrum":
            result = _triple(spectra.EVEN * value)
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
    try:
        table = np.array(pairs, dtype=np.float64)
    except (TypeError, ValueError):
        table = np.empty(0)
    if table.ndim != 2 or table.shape[1] != 2 or not np.isfinite(table).all() or not len(table):
        plugin.fail("value must be one number, or pairs of a wavelength and a number")
    if (np.diff(table[:, 0]) <= 0).any():
        plugin.fail("wavelengths must rise")
    plugin.warn("spectra by wavelength are approximated by red, green and blue")
    return _triple(spectra.rgb(table, emits))


def _triple(array: Any) -> Triple:
    red, green, blue = (float(x) for x in array)
    return red, green, blue
