"""Indices of refraction by name."""

from __future__ import annotations

from .plugin import Plugin

# At 589 nm and 0 to 20 °C; Hecht, "Optics", and for glasses their makers.
_BY_NAME = {
    "vacuum": 1.0,
    "helium": 1.000036,
    "hydrogen": 1.000132,
    "air": 1.000277,
    "carbon dioxide": 1.00045,
    "water": 1.3330,
    "acetone": 1.36,
    "ethanol": 1.361,
    "carbon tetrachloride": 1.461,
    "glycerol": 1.4729,
    "benzene": 1.501,
    "silicone oil": 1.52045,
    "bromine": 1.661,
    "water ice": 1.31,
    "fused quartz": 1.458,
    "pyrex": 1.470,
    "acrylic glass": 1.49,
    "polypropylene": 1.49,
    "bk7": 1.5046,
    "sodium chloride": 1.544,
    "amber": 1.55,
    "pet": 1.5750,
    "diamond": 2.419,
}


def relative(plugin: Plugin, within: str) -> float:
    """Return the index of refraction below a surface over that above it.

    Parameters
    ----------
    plugin : Plugin
        With ``int_ior`` and ``ext_ior``, numbers or names; air outside if not given.
    within : str
        The default name of the inside.
    """
    return _index(plugin, "int_ior", within) / _index(plugin, "ext_ior", "air")


def _index(plugin: Plugin, name: str, default: str) -> float:
    value = plugin.take(name, default)
    if isinstance(value, str):
        if value.lower() not in _BY_NAME:
            plugin.fail(f"{name} must be a number or one of {', '.join(_BY_NAME)}, got {value!r}")
        return _BY_NAME[value.lower()]
    index = plugin.number(name, 1.0)
    if index <= 0:
        plugin.fail(f"{name} must be greater than 0, got {index:g}")
    return index
