"""Colors, as linear red, green and blue (Rec. 709), and spectra."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...textures import Spectrum
from . import spectra
from .plugin import Plugin, Triple

# Plugin types with one constant color or number.
UNIFORM = (
    "rgb", "srgb", "spectrum", "uniform", "regular", "irregular", "d65", "rawconstant", "blackbody",
)  # fmt: skip


def color(plugin: Plugin, name: str, default: float | Triple, emits: bool = False) -> Triple:
    """Return a parameter of a plugin that is one color; one by wavelength is approximated, and warned of.

    Arguments are those of `shade`.
    """
    return _plain(plugin, shade(plugin, name, default, emits), emits)


def of_plugin(plugin: Plugin, emits: bool) -> Triple:
    """Return the color of a plugin of a type in `UNIFORM`, as `color` does."""
    return _plain(plugin, shade_of(plugin, emits), emits)


def _plain(plugin: Plugin, found: Triple | Spectrum, emits: bool) -> Triple:
    if not isinstance(found, Spectrum):
        return found
    plugin.warn("spectra by wavelength are approximated by red, green and blue here")
    return found.rgb if emits else found.reflected_rgb


def shade(plugin: Plugin, name: str, default: float | Triple, emits: bool = False) -> Triple | Spectrum:
    """Return a parameter of a plugin that is one color, or goes with wavelength.

    Parameters
    ----------
    plugin : Plugin
        Plugin with the parameter.
    name : str
        Name of the parameter.
    default : float or 3 floats
        If it is not given.
    emits : bool
        True for light rather than a share of light: a uniform spectrum is then not white.
    """
    value = plugin.take(name, default)
    if isinstance(value, Mapping):
        inner = Plugin(value, f"{plugin.where}.{name}", plugin.context)
        if inner.type not in UNIFORM:
            plugin.fail(f"{name} must be the same everywhere, got a {inner.type}")
        return shade_of(inner, emits)
    return of_numbers(plugin, name, value)


def shade_of(plugin: Plugin, emits: bool) -> Triple | Spectrum:
    """Return the color or the spectrum of a plugin of a type in `UNIFORM`."""
    kind = plugin.type
    result: Triple | Spectrum
    if kind in ("rgb", "srgb", "rawconstant"):
        name = "color" if plugin.has("color") else "value"
        value = plugin.take(name)
        plugin.ignore("unbounded")
        coded = kind == "srgb"
        result = _hex(plugin, value, coded) if isinstance(value, str) else of_numbers(plugin, name, value)
    elif kind == "d65":
        scale = plugin.number("scale", 1.0)
        result = _triple(np.multiply(color(plugin, "color", 1.0), scale))
    elif kind == "blackbody":
        kelvin, scale = plugin.number("temperature", 5000.0), plugin.number("scale", 1.0)
        if not kelvin > 0:
            plugin.fail(f"temperature must be greater than 0, got {kelvin:g}")
        result = Spectrum(*spectra.black_body(kelvin).T) * scale
    elif kind == "regular":
        values = _numbers(plugin, "values")
        low, high = plugin.number("wavelength_min", 360.0), plugin.number("wavelength_max", 830.0)
        result = _spectrum(plugin, np.linspace(low, high, len(values)), values)
    elif kind == "irregular":
        result = _spectrum(plugin, _numbers(plugin, "wavelengths"), _numbers(plugin, "values"))
    elif plugin.has("filename"):
        result = _spectrum(plugin, *_of_file(plugin, plugin.path()).T)
    elif kind == "uniform" or not isinstance(plugin.take("value"), list | tuple | np.ndarray):
        value = plugin.number("value", 1.0)
        result = (value,) * 3
        if emits and kind == "spectrum":
            result = _triple(spectra.EVEN * value)
    else:
        result = _spectrum(plugin, *_pairs(plugin, plugin.take("value")).T)
    plugin.done()
    return result


def of_numbers(plugin: Plugin, name: str, value: Any) -> Triple:
    """Return one number or three as a color."""
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


def at_each_nm(spectrum: Spectrum, change: Any) -> Spectrum:
    """Return a spectrum whose values are changed by a function that need not be linear."""
    ends = spectrum.wavelengths[0], spectrum.wavelengths[-1]
    between = np.arange(np.ceil(max(ends[0], 360.0)), min(ends[1], 830.0))
    nm = np.union1d(spectrum.wavelengths, between)
    return Spectrum(nm, change(np.asarray(spectrum.at(nm))))


def _pairs(plugin: Plugin, pairs: Any) -> NDArray[np.float64]:
    try:
        table = np.array(pairs, dtype=np.float64)
    except (TypeError, ValueError):
        table = np.empty(0)
    if table.ndim != 2 or table.shape[1] != 2 or not np.isfinite(table).all() or not len(table):
        plugin.fail("value must be one number, or pairs of a wavelength and a number")
    return table


def _numbers(plugin: Plugin, name: str) -> NDArray[np.float64]:
    given = plugin.take(name, ())
    try:
        array = np.array(given.replace(",", " ").split() if isinstance(given, str) else given, np.float64)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 1 or len(array) < 2 or not np.isfinite(array).all():
        plugin.fail(f"{name} must be two or more finite numbers")
    return array


def _of_file(plugin: Plugin, path: Path) -> NDArray[np.float64]:
    """Read lines of a wavelength and a value; lines that begin with # are comments."""
    lines = (line.split("#")[0].split() for line in path.read_text(encoding="utf-8").splitlines())
    try:
        table = np.array([[float(number) for number in line] for line in lines if line], np.float64)
    except ValueError:
        table = np.empty(0)
    if table.ndim != 2 or table.shape[1] != 2 or not np.isfinite(table).all():
        plugin.fail(f"{path.name} must have a wavelength and a number in each line")
    return table


def _spectrum(plugin: Plugin, nm: NDArray[np.float64], values: NDArray[np.float64]) -> Spectrum:
    if len(nm) < 2 or (np.diff(nm) <= 0).any():
        plugin.fail("wavelengths must be two or more, and rise")
    if len(values) != len(nm):
        plugin.fail(f"values must have length {len(nm)} like wavelengths, got {len(values)}")
    if (values < 0).any():
        plugin.fail(f"values must be at least 0, got {values.min():g}")
    return Spectrum(nm, values)


def _triple(array: Any) -> Triple:
    red, green, blue = (float(x) for x in array)
    return red, green, blue
