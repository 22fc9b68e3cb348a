"""Media: what fills shapes, and the space around them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ... import _core
from ...materials import Dielectric, Mask, Material, MediumInterface, ThinDielectric, Tinted
from ...media import GridMedium, HenyeyGreenstein, Homogeneous, Isotropic, Medium, Phase, Rayleigh
from ...media.files import read_density
from ...textures import Spectrum
from .errors import SceneError
from .plugin import Plugin, Triple
from .values import color, shade

TYPES = ("homogeneous", "heterogeneous")
PHASES = ("isotropic", "hg", "rayleigh")
VOLUMES = ("constvolume", "gridvolume")
WRAPS = ("clamp", "repeat")
# Most cells of a grid that repeats as far as its shape extends.
_MOST_CELLS = 2**26
# The least and the greatest corner, (2, 3).
Box = NDArray[np.float64]

# Keys under which the plugins of a scene share their media.
_WITHIN, _AROUND = "media within", "media around"


def filled(plugin: Plugin, material: Material | None, box: Box | None = None) -> Material | None:
    """Return the material of a shape, with its interior; None if it has none.

    `box` is the least and the greatest corner of the shape, where that is known: grids repeat as far.

    Raises
    ------
    ValueError
        If a medium, or a parameter of it, is not supported; the error names it.
    """
    is_null = False
    for null in plugin.children("null"):
        null.done()
        is_null = True
    interior, exterior = _side(plugin, "interior", box), _side(plugin, "exterior")
    kept = plugin.context.kept
    if exterior is not None:
        kept.setdefault(_AROUND, []).append(exterior)
    if interior is not None:
        kept.setdefault(_WITHIN, []).append(interior)
    if (interior is not None or is_null) and plugin.values.get("flip_normals"):
        plugin.fail("flip_normals with a medium within, or a null BSDF, is not supported")
    if is_null:
        # A null BSDF without a medium is a hole.
        return Mask(Dielectric(), 0.0) if interior is None else MediumInterface(interior)
    if interior is not None and isinstance(material, Tinted):
        if isinstance(material.base, ThinDielectric):
            plugin.fail("a medium within a pane of specular_transmittance other than 1 is not supported")
        return replace(material, base=replace(material.base, interior=interior))
    if interior is None or not isinstance(material, Dielectric | ThinDielectric):
        # The inside of an opaque shape is invisible.
        return material
    return replace(material, interior=interior)


def around(scene: Plugin, eye: Plugin) -> Medium | None:
    """Return what fills the space around all shapes: what a sensor or a shape says is outside.

    Raises
    ------
    ValueError
        If several media are.
    """
    kept = scene.context.kept
    found = list(kept.get(_AROUND, ()))
    # The sensor may be inside a shape.
    seen = (medium(inner) for inner in eye.children(*TYPES))
    found += [one for one in seen if one not in kept.get(_WITHIN, ())]
    # Media inside other shapes are none of the surroundings.
    outside = [one for one in found if one not in kept.get(_WITHIN, ())]
    if any(one != outside[0] for one in outside):
        scene.fail("several media surround shapes; only one can fill the space")
    return outside[0] if outside else None


def _side(plugin: Plugin, name: str, box: Box | None = None) -> Medium | None:
    inner = plugin.child(name)
    if inner is None:
        return None
    if inner.type not in TYPES:
        plugin.fail(f"{name} must be one of {', '.join(TYPES)}, got {inner.type}")
    return medium(inner, box)


def medium(plugin: Plugin, box: Box | None = None) -> Medium:
    """Return the medium that a plugin stands for, within a box if that is known.

    Raises
    ------
    FileNotFoundError
        If its file is missing.
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    key = ("medium", id(plugin.values), None if box is None else box.tobytes())
    if key in plugin.context.kept:
        kept: Medium = plugin.context.kept[key]
        return kept
    try:
        result = _read(plugin, box)
    except (SceneError, FileNotFoundError):
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{plugin}: {error}") from error
    plugin.ignore("has_spectral_extinction", "sample_emitters")
    plugin.done()
    plugin.context.kept[key] = result
    return result


def _read(plugin: Plugin, box: Box | None) -> Medium:
    scale, phase = plugin.number("scale", 1.0), _phase(plugin)
    if plugin.type == "homogeneous":
        shares = plugin.child("albedo")
        if shares is not None and shares.type == "gridvolume":
            if box is None:
                plugin.fail("albedo on a grid is read within meshes only")
            extinction = scale * np.array(color(plugin, "sigma_t", 1.0))
            return _shared(plugin, grid(shares, WRAPS), box, extinction, phase)
        albedo = _constant(plugin, "albedo", 0.75)
        return Homogeneous(*_parts(_constant(plugin, "sigma_t", 1.0), albedo, scale), phase)
    # No medium exists outside the volume of the extinction.
    dimmed = _volume(plugin, "sigma_t", 1.0)
    scattered = _volume(plugin, "albedo", 0.75)
    extinction = scale * dimmed.color
    placed = {"bounds": dimmed.bounds, "transform": dimmed.transform, "at": "centers", "phase": phase}
    if scattered.numbers is None:
        absorption, scattering = extinction * (1 - scattered.color), extinction * scattered.color
        return GridMedium(dimmed.density, absorption=absorption, scattering=scattering, **placed)
    if scattered.bounds != dimmed.bounds or not np.array_equal(scattered.transform, dimmed.transform):
        plugin.fail("sigma_t and albedo must lie in the same place")
    return GridMedium(dimmed.density, extinction=extinction, albedo=scattered.numbers, **placed)


def _shared(
    plugin: Plugin, albedo: Volume, box: Box, extinction: NDArray[np.float64], phase: Phase
) -> GridMedium:
    """Return what has one extinction all over, and an albedo that goes on beyond its grid as that wraps."""
    assert albedo.numbers is not None
    size = np.array(albedo.numbers.shape[:3])
    low, high = (np.zeros(3), np.ones(3)) if albedo.bounds is None else np.array(albedo.bounds, np.float64)
    corners = np.stack(np.meshgrid(*box.T, indexing="ij"), -1).reshape(-1, 3)
    inverse = np.linalg.inv(albedo.transform)
    # In cells of the grid, plus one on either side for interpolation.
    cells = ((corners @ inverse[:3, :3].T + inverse[:3, 3]) - low) / (high - low) * size
    first, last = np.floor(cells.min(axis=0)).astype(int) - 1, np.ceil(cells.max(axis=0)).astype(int) + 1
    if np.prod((last - first).astype(float)) > _MOST_CELLS:
        plugin.fail(f"albedo on a grid reaches over more than {_MOST_CELLS} cells in its shape")
    each = [np.arange(a, b) for a, b in zip(first, last, strict=True)]
    where = [
        at % count if albedo.repeats else np.clip(at, 0, count - 1)
        for at, count in zip(each, size, strict=True)
    ]
    bounds = low + (high - low) * np.stack([first, last]) / size
    return GridMedium(
        np.ones((1, 1, 1)),
        bounds,
        transform=albedo.transform,
        at="centers",
        phase=phase,
        extinction=extinction,
        albedo=albedo.numbers[np.ix_(*where)],
    )


def _parts(extinction: Triple | Spectrum, albedo: Triple | Spectrum, scale: float) -> tuple[Any, Any]:
    """Return absorption and scattering, by wavelength if either is."""
    told = [one for one in (extinction, albedo) if isinstance(one, Spectrum)]
    if not told:
        all_of, share = scale * np.array(extinction), np.array(albedo)
        return all_of * (1 - share), all_of * share
    nm = np.unique(np.concatenate([np.arange(360.0, 831.0), *(one.wavelengths for one in told)]))
    all_of, share = scale * _at(extinction, nm, False), _at(albedo, nm, True)
    return Spectrum(nm, all_of * (1 - share)), Spectrum(nm, all_of * share)


def _at(told: Triple | Spectrum, nm: NDArray[np.float64], is_share: bool) -> NDArray[np.float64]:
    """Return values at wavelengths: for red, green and blue by a smooth spectrum."""
    if isinstance(told, Spectrum):
        return np.asarray(told.at(nm))
    if len({*told}) == 1:
        return np.full(nm.shape, told[0])
    return np.asarray(_core.smooth_spectrum(told, is_share, False, nm.tolist()))


def _constant(plugin: Plugin, name: str, default: float) -> Triple | Spectrum:
    inner = plugin.child(name)
    if inner is None or inner.type not in VOLUMES:
        return shade(plugin, name, default)
    if inner.type == "gridvolume":
        plugin.fail(f"{name} on a grid is not supported")
    result = shade(inner, "value", 1.0)
    inner.ignore("to_world")
    inner.done()
    return result


class Volume(NamedTuple):
    """Numbers over the unit cube, or bounds, wherever a transform takes these; else a color."""

    color: NDArray[np.float64]
    numbers: NDArray[Any] | None = None
    bounds: Any = None
    transform: Any = None
    repeats: bool = False

    @property
    def density(self) -> NDArray[Any]:
        """Its density: 1 if it has no numbers."""
        return np.ones((1, 1, 1)) if self.numbers is None else self.numbers


def _volume(medium: Plugin, name: str, default: float) -> Volume:
    plugin = medium.child(name)
    if plugin is None or plugin.type not in VOLUMES:
        return Volume(np.array(color(medium, name, default)), transform=np.eye(4))
    if plugin.type == "constvolume":
        value, transform = np.array(color(plugin, "value", 1.0)), plugin.to_world()
        plugin.done()
        return Volume(value, transform=transform)
    return grid(plugin, ("clamp",))


def grid(plugin: Plugin, wraps: tuple[str, ...]) -> Volume:
    """Return what a plugin of a grid holds, which may go on beyond its ends in some ways."""
    if not plugin.has("filename"):
        plugin.fail("a grid must be given by its filename")
    plugin.choice("filter_type", "trilinear", ("trilinear",))
    repeats = plugin.choice("wrap_mode", "clamp", wraps) == "repeat"
    plugin.ignore("raw", "accel", "max_value")
    numbers, box = read_density(plugin.path())
    placed = plugin.switch("use_grid_bbox", False)
    transform = plugin.to_world()
    plugin.done()
    return Volume(np.ones(3), numbers, box if placed else None, transform, repeats)


def _phase(plugin: Plugin) -> Phase:
    found: Phase = Isotropic()
    for inner in plugin.children(*PHASES):
        if inner.type == "hg":
            found = HenyeyGreenstein(inner.number("g", 0.8))
        elif inner.type == "rayleigh":
            found = Rayleigh()
        inner.done()
    return found
