"""BSDFs to materials. Most of Mitsuba's scatter on the side of the normals only: the other is black."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...materials import (
    BumpMap,
    Dielectric,
    Diffuse,
    Mask,
    Material,
    Mix,
    NormalMap,
    Plastic,
    ThinDielectric,
    Tinted,
    TwoSided,
)
from . import coats
from .errors import SceneError
from .facets import SMOOTH, conductor, dielectric, facets, tinted
from .iors import relative
from .plugin import Plugin
from .principled import principled, principled_thin
from .textures import TYPES as TEXTURES
from .textures import normals, numbers, scalar, value
from .uv import Uv
from .values import color

BLACK = Diffuse(0.0)


class Sides(NamedTuple):
    """A material, and whether only the side of the normals has it."""

    material: Material
    front_only: bool

    def closed(self) -> Material:
        """Return the material of both sides."""
        return TwoSided(self.material, BLACK) if self.front_only else self.material


def material(plugin: Plugin, uv: Uv) -> Material:
    """Return the material that a BSDF stands for, of both sides.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    return sides(plugin, uv).closed()


def sides(plugin: Plugin, uv: Uv) -> Sides:
    """Return the material that a BSDF stands for, and whether it has one side only."""
    key = (id(plugin.values), id(uv))
    if key in plugin.context.kept:
        kept: Sides = plugin.context.kept[key]
        return kept
    try:
        result = _READERS[plugin.type](plugin, uv)
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        # Errors of a material name the plugin that needs it.
        raise SceneError(f"{plugin}: {error}") from error
    plugin.done()
    plugin.context.kept[key] = result
    return result


def turned_round(given: Material, plugin: Plugin) -> Material:
    """Return a material as it is on a surface whose normals point the other way.

    Raises
    ------
    ValueError
        If it has bumps, or normals of its own: tells it of the plugin whose surface it is.
    """
    if isinstance(given, BumpMap | NormalMap):
        plugin.fail("flip_normals with bumps or a normal map is not supported")
    if isinstance(given, TwoSided):
        return TwoSided(turned_round(given.back, plugin), turned_round(given.front, plugin))
    if isinstance(given, Mask):
        return Mask(turned_round(given.material, plugin), given.opacity)
    if isinstance(given, Mix):
        return Mix(turned_round(given.a, plugin), turned_round(given.b, plugin), given.amount)
    if isinstance(given, Tinted):
        base = turned_round(given.base, plugin)
        return replace(given, base=base) if isinstance(base, Dielectric) else given
    if isinstance(given, Dielectric) and isinstance(given.ior, float):
        return replace(given, ior=1 / given.ior)
    return given


def _diffuse(plugin: Plugin, uv: Uv) -> Sides:
    return Sides(Diffuse(value(plugin, "reflectance", 0.5, uv)), True)


def _dielectric(plugin: Plugin, uv: Uv) -> Sides:
    return Sides(dielectric(plugin, uv), False)


def _thin_dielectric(plugin: Plugin, uv: Uv) -> Sides:
    return Sides(tinted(ThinDielectric(relative(plugin, "bk7")), plugin, uv), False)


def _conductor(plugin: Plugin, uv: Uv) -> Sides:
    return Sides(conductor(plugin, uv), True)


def _plastic(plugin: Plugin, uv: Uv) -> Sides:
    ior = relative(plugin, "polypropylene")
    rough = facets(plugin, uv) if plugin.type == "roughplastic" else SMOOTH
    if not isinstance(rough.alpha, float):
        plugin.fail("alpha must be one number")
    # Internal reflectance of the coat: as in Mitsuba, and as it is here.
    own = theirs = coats.smooth(ior)
    if rough is not SMOOTH:
        own, theirs = coats.rough(ior, rough.alpha, rough.distribution)
    nonlinear = plugin.switch("nonlinear", False)

    def change(colors: NDArray[np.float64]) -> NDArray[np.float64]:
        # The result c has c / (1 - own c) equal Mitsuba's r / (1 - theirs), or r / (1 - theirs r) if
        # nonlinear.
        trapped = theirs * (colors if nonlinear else 1.0)
        return np.minimum(colors / (1 - trapped + own * colors), 1.0)

    if color(plugin, "specular_reflectance", 1.0) != (1.0, 1.0, 1.0):
        plugin.fail("specular_reflectance must be 1")
    reflectance = value(plugin, "diffuse_reflectance", 0.5, uv, change=change)
    return Sides(Plastic(reflectance, ior, **rough.arguments()), True)


def _two_sided(plugin: Plugin, uv: Uv) -> Sides:
    inner = _inner(plugin, uv, 1, 2)
    if len(inner) == 1:
        return Sides(inner[0].material, False)
    return Sides(TwoSided(inner[0].material, inner[1].material), False)


def _mask(plugin: Plugin, uv: Uv) -> Sides:
    (inner,) = _inner(plugin, uv, 1)
    return Sides(Mask(inner.closed(), scalar(plugin, "opacity", 0.5, uv)), False)


def _blend(plugin: Plugin, uv: Uv) -> Sides:
    a, b = _inner(plugin, uv, 2)
    amount = scalar(plugin, "weight", 0.5, uv)
    if a.front_only and b.front_only:
        return Sides(Mix(a.material, b.material, amount), True)
    return Sides(Mix(a.closed(), b.closed(), amount), False)


def _bump_map(plugin: Plugin, uv: Uv) -> Sides:
    (inner,) = _inner(plugin, uv, 1)
    _bent(plugin)
    textures = list(plugin.children(*TEXTURES))
    if len(textures) != 1:
        plugin.fail(f"one texture must be within, got {len(textures)}")
    height = numbers(textures[0], uv)
    return inner._replace(material=BumpMap(inner.material, height, plugin.number("scale", 1.0)))


def _normal_map(plugin: Plugin, uv: Uv) -> Sides:
    (inner,) = _inner(plugin, uv, 1)
    _bent(plugin)
    given = plugin.child("normalmap")
    if given is None:
        plugin.fail("normalmap must be given")
    return inner._replace(material=NormalMap(inner.material, normals(given, uv)))


def _bent(plugin: Plugin) -> None:
    for name in ("flip_invalid_normals", "use_shadowing_function"):
        if not plugin.switch(name, True):
            plugin.warn(f"{name} is on")


def _inner(plugin: Plugin, uv: Uv, *counts: int) -> list[Sides]:
    found = [sides(inner, uv) for inner in plugin.children(*_READERS)]
    if len(found) not in counts:
        expected = " or ".join(map(str, counts))
        plugin.fail(f"{expected} BSDF{'' if counts == (1,) else 's'} must be within, got {len(found)}")
    return found


_READERS: dict[str, Callable[[Plugin, Uv], Sides]] = {
    "diffuse": _diffuse,
    "dielectric": _dielectric,
    "roughdielectric": _dielectric,
    "thindielectric": _thin_dielectric,
    "conductor": _conductor,
    "roughconductor": _conductor,
    "plastic": _plastic,
    "roughplastic": _plastic,
    "principled": lambda plugin, uv: Sides(*principled(plugin, uv)),
    "principledthin": lambda plugin, uv: Sides(principled_thin(plugin, uv), False),
    "twosided": _two_sided,
    "mask": _mask,
    "blendbsdf": _blend,
    "bumpmap": _bump_map,
    "normalmap": _normal_map,
}
TYPES = tuple(_READERS)
