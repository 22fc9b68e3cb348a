"""Materials, lights and appearance of faces as arrays for `shading.wgsl`.

All numbers are little-endian, without gaps, and lengths in box units (see `GpuArrays`). Unsupported features
are reported by name: `LeftError`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..lights import ConstantEnvironment, DirectionalLight, Emission, EnvironmentMap, PointLight
from ..materials import Dielectric
from ..query.gpu_arrays import GpuArrays
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .material_table import LeftError, Looks, constant

# 112 bytes per face, by primitive number: a corner and two edges in the winding of the mesh. `material` is
# that of the front, followed by that of the back. `light` is its light, or NO. `has` is 1 for normals plus 2
# for texture coordinates, which are u_a, u_b, u_c and v.
FACE = np.dtype(
    [
        ("corner", "<f4", 3),
        ("material", "<u4"),
        ("edge", "<f4", 3),
        ("light", "<u4"),
        ("other", "<f4", 3),
        ("has", "<u4"),
        ("normal_a", "<f4", 3),
        ("u_a", "<f4"),
        ("normal_b", "<f4", 3),
        ("u_b", "<f4"),
        ("normal_c", "<f4", 3),
        ("u_c", "<f4"),
        ("v", "<f4", 3),
        ("reserved", "<f4"),
    ]
)
# 48 bytes per light. `kind` is 0 for an emitting face, 1 for a point, 2 for a direction. `radiance` is that,
# the intensity (in box units) or the irradiance. `share` is the probability to draw this light rather than
# another, without the sky; `until` is the cumulative one.
LIGHT = np.dtype(
    [
        ("radiance", "<f4", 3),
        ("kind", "<u4"),
        ("place", "<f4", 3),
        ("face", "<u4"),
        ("until", "<f4"),
        ("share", "<f4"),
        ("area", "<f4"),
        ("sides", "<u4"),
    ]
)
# 80 bytes, once: see `Lit` of shading.wgsl.
LIT = np.dtype(
    [
        ("sky", "<f4", 3),
        ("lights", "<u4"),
        ("to_picture_x", "<f4", 3),
        ("sky_kind", "<u4"),
        ("to_picture_y", "<f4", 3),
        ("sky_width", "<u4"),
        ("to_picture_z", "<f4", 3),
        ("sky_height", "<u4"),
        ("sky_colors", "<u4"),
        ("sky_shares", "<u4"),
        ("sky_share", "<f4"),
        ("reserved", "<u4"),
    ]
)
NO = 0xFFFFFFFF
_LAMP, _POINT, _DIRECTION = 0, 1, 2
_FRONT, _BACK = 1, 2
# In box units: float32 does not resolve details of smaller scenes where rays leave them.
_TINY = 1e-3
# Probability to draw the sky if there are lights too.
_SKY_SHARE = 0.5


@dataclass(frozen=True)
class Packed:
    """A scene as `shading.wgsl` reads it.

    Attributes
    ----------
    faces : (P,) structured, 112 bytes each
        Appearance of faces, by their numbers among all primitives.
    materials : (2 M,) structured, 80 bytes each
        Fronts and backs by turns (`looks.MATERIAL`).
    lights : (L,) structured, 48 bytes each
        Lights that are sampled, except for the sky.
    numbers : (N,) float32
        Pictures and tables, where others say that they begin.
    lit : () structured, 80 bytes
        The sky, and where its numbers are.
    """

    faces: NDArray[np.void]
    materials: NDArray[np.void]
    lights: NDArray[np.void]
    numbers: NDArray[np.float32]
    lit: NDArray[np.void]


def known_lit(lit: NDArray[np.void]) -> str:
    """Return the features of a `Lit` as WGSL for the kernels: missing ones are not compiled.

    A driver in software (llvmpipe of Mesa 22.3) makes another kernel of one that branches by numbers of a
    uniform each time that it is bound, and keeps them all.
    """
    has_lights = "true" if lit["lights"] else "false"
    return f"const SKY_KIND = {int(lit['sky_kind'])}u;\nconst HAS_LIGHTS = {has_lights};\n"


def packed(scene: Scene, flat: GpuArrays) -> Packed:
    """Pack a scene.

    Parameters
    ----------
    scene : Scene
        The scene.
    flat : GpuArrays
        Its arrays.

    Raises
    ------
    LeftError
        If the kernels do not support a feature, with its name.
    """
    looks = Looks()
    faces = np.zeros(max(int(flat.first[-1]), 1), FACE)
    faces["light"] = NO
    lamps: list[NDArray[np.void]] = []
    glasses: list[Mesh] = []
    for number, shape in enumerate(scene.shapes):
        first, end = int(flat.first[number]), int(flat.first[number + 1])
        if not isinstance(shape, Mesh):
            raise LeftError(f"shape {number} is a {type(shape).__name__}")
        bounds = shape.bounds
        if bounds is not None and (bounds[1] - bounds[0]).max() * flat.scale < _TINY:
            raise LeftError(f"shape {number} is too small relative to the scene")
        if end - first != len(shape.faces):
            raise LeftError(f"shape {number} has faces that are never hit")
        some = faces[first:end]
        _lay(some, shape, flat)
        if isinstance(shape.material, Dielectric):
            glasses.append(shape)
        some["material"] = looks.number(shape.material, f"shape {number}")
        if shape.emission is not None:
            lamps.append(_shining(shape, some, first, f"shape {number}"))
    _check_closed(glasses)
    lights = np.concatenate([*lamps, _delta(scene, flat)])
    lit = np.zeros((), LIT)
    _sky(scene, lit, looks)
    _share(lights, lit, faces)
    return Packed(faces, looks.array(), lights, looks.numbers(), lit)


def _check_closed(glasses: list[Mesh]) -> None:
    """Raise a LeftError if paths may need their medium, which only closed shapes that are apart rule out."""
    if len(glasses) > 1 and not all(map(_is_closed, glasses)):
        raise LeftError("the scene has several glass shapes, and not all are closed")


def _is_closed(mesh: Mesh) -> bool:
    """Return whether each edge of a mesh has two faces; corners are one that are next to each other."""
    points = mesh.vertices.astype(np.float64)
    points = np.round(
        (points - points.min(axis=0)) * (1e6 / max(float(np.ptp(points, axis=0).max()), 1e-300))
    )
    numbers = np.unique(points, axis=0, return_inverse=True)[1].reshape(-1)
    faces = numbers[mesh.faces]
    edges = np.sort(np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]]), axis=1)
    return bool((np.unique(edges, axis=0, return_counts=True)[1] == 2).all())


def _lay(faces: NDArray[np.void], mesh: Mesh, flat: GpuArrays) -> None:
    """Write the corners of faces and their attributes."""
    corners = (mesh.vertices.astype(np.float64)[mesh.faces] - flat.center) * flat.scale
    faces["corner"] = corners[:, 0]
    faces["edge"], faces["other"] = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    if mesh.normals is not None:
        faces["has"] |= 1
        for i, name in enumerate(("normal_a", "normal_b", "normal_c")):
            faces[name] = mesh.normals[mesh.faces[:, i]]
    if mesh.uv is not None:
        faces["has"] |= 2
        for i, name in enumerate(("u_a", "u_b", "u_c")):
            faces[name] = mesh.uv[mesh.faces[:, i], 0]
        faces["v"] = mesh.uv[mesh.faces, 1]


def _shining(mesh: Mesh, faces: NDArray[np.void], first: int, where: str) -> NDArray[np.void]:
    """Return the lights that faces are."""
    given = mesh.emission
    side = given.side if isinstance(given, Emission) else "front"
    radiance = constant(given.radiance if isinstance(given, Emission) else given, f"the emission of {where}")
    lights = np.zeros(len(faces), LIGHT)
    lights["kind"], lights["radiance"] = _LAMP, radiance
    lights["face"] = first + np.arange(len(faces))
    across = np.cross(faces["edge"].astype(np.float64), faces["other"].astype(np.float64))
    lights["area"] = 0.5 * np.linalg.norm(across, axis=1)
    lights["sides"] = {"front": _FRONT, "back": _BACK, "both": _FRONT | _BACK}[side]
    return lights[(lights["area"] > 0) & (max(radiance) > 0)]


def _delta(scene: Scene, flat: GpuArrays) -> NDArray[np.void]:
    """Return the lights without extent."""
    lights = np.zeros(len(scene.lights), LIGHT)
    lights["face"] = NO
    for light, given in zip(lights, scene.lights, strict=True):
        what = f"the {type(given).__name__}"
        if isinstance(given, PointLight):
            light["kind"], light["place"] = _POINT, (np.array(given.position) - flat.center) * flat.scale
            light["radiance"] = np.array(constant(given.intensity, what)) * flat.scale**2
        elif isinstance(given, DirectionalLight):
            way = np.array(given.direction)
            light["kind"], light["place"] = _DIRECTION, -way / np.linalg.norm(way)
            light["radiance"] = constant(given.irradiance, what)
        else:
            raise LeftError(f"the scene has a {type(given).__name__}")
    return lights


def _share(lights: NDArray[np.void], lit: NDArray[np.void], faces: NDArray[np.void]) -> None:
    """Distribute draws among lights by about their power, and give faces the index of their light."""
    strength = lights["radiance"].astype(np.float64).max(axis=1, initial=0.0)
    # Lights without extent: the power through a ball of the size of a box unit.
    reach = np.full(len(lights), 4 * np.pi)
    lamp = lights["kind"] == _LAMP
    sides = np.where(lights["sides"][lamp] == (_FRONT | _BACK), 2, 1)
    reach[lamp] = np.pi * lights["area"][lamp] * sides
    power = strength * reach
    total = power.sum()
    # Cumulative shares are rounded first and shares are their differences, so that sampled and stated
    # probabilities agree.
    until = (np.cumsum(power) / (total if total > 0 else 1.0)).astype(np.float32)
    if len(until):
        until[-1] = 1.0
    lights["until"], lights["share"] = until, np.diff(until, prepend=np.float32(0))
    lit["lights"] = len(lights) if total > 0 else 0
    lit["sky_share"] = 0.0 if lit["sky_kind"] == 0 else _SKY_SHARE if total > 0 else 1.0
    lamps = np.flatnonzero(lights["kind"] == _LAMP)
    faces["light"][lights["face"][lamps]] = lamps


def _sky(scene: Scene, lit: NDArray[np.void], looks: Looks) -> None:
    """Write the environment of a scene."""
    given: Any = scene.environment
    if isinstance(given, tuple):
        if len(given) > 1:
            raise LeftError("the scene has several environments")
        given = given[0] if given else None
    if given is None:
        return
    if isinstance(given, ConstantEnvironment):
        radiance = constant(given.radiance, "the environment")
        if max(radiance) > 0:
            lit["sky"], lit["sky_kind"] = radiance, 1
        return
    if not isinstance(given, EnvironmentMap):
        raise LeftError(f"the environment is a {type(given).__name__}")
    image = given.image
    if not (image > 0).any() or given.scale == 0:
        return
    height, width = image.shape[:2]
    for i, axis in enumerate("xyz"):
        lit[f"to_picture_{axis}"] = given.to_world[:, i]
    lit["sky"], lit["sky_kind"] = given.scale, 2
    lit["sky_width"], lit["sky_height"] = width, height
    lit["sky_colors"], lit["sky_shares"] = looks.add(image), looks.add(_shares(image))


def _shares(image: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the shares of light of rows up to each, and in each row of columns up to each, in one array."""
    height = image.shape[0]
    light = image.max(axis=2).astype(np.float64)
    # The light within a texel is interpolated from its neighbors.
    beside = np.pad(np.pad(light, ((1, 1), (0, 0)), "edge"), ((0, 0), (1, 1)), "wrap")
    across = (beside[:, :-2] + 6 * beside[:, 1:-1] + beside[:, 2:]) / 8
    mean = (across[:-2] + 6 * across[1:-1] + across[2:]) / 8
    ends = np.cos(np.pi * np.arange(height + 1) / height)
    weights = mean * (ends[:-1] - ends[1:])[:, None]
    rows = weights.sum(axis=1)
    up_to_row = np.cumsum(rows) / rows.sum()
    columns = np.cumsum(weights, axis=1) / np.where(rows > 0, rows, 1)[:, None]
    up_to_row[-1], columns[:, -1] = 1, 1
    return np.concatenate([up_to_row.astype(np.float32), columns.astype(np.float32).ravel()])
