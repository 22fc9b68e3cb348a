"""Meshes from the objects of Blender."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh
from ..shapes.mesh_changes import continued
from ..shapes.sources import named
from .blender_materials import pbr_of
from .pbr import Pbr
from .polygons import LeftOut, mesh_of_polygons
from .textured import by_number, split_corners

# Kinds of objects that have surfaces.
_SURFACES = ("MESH", "CURVE", "SURFACE", "META", "FONT")
# By type of attribute: the property with its value, and the number of components.
_VALUES = {
    "FLOAT": ("value", 1),
    "INT": ("value", 1),
    "BOOLEAN": ("value", 1),
    "INT8": ("value", 1),
    "FLOAT2": ("vector", 2),
    "FLOAT_VECTOR": ("vector", 3),
    "FLOAT_COLOR": ("color", 4),
    "BYTE_COLOR": ("color", 4),
}
_DTYPES = {"INT": np.int32, "INT8": np.int32, "BOOLEAN": np.bool_}


def of_objects(given: Any) -> Iterator[Mesh]:
    """Yield the meshes of a collection of Blender, of a scene of it, or of ``bpy.data.objects``.

    Lights, cameras and other objects without a surface are left out, and so are nodes of materials that are
    not known.

    Warns
    -----
    RuntimeWarning
        Once, for all that is left out.
    """
    objects = next(
        (getattr(given, name) for name in ("all_objects", "objects") if hasattr(given, name)), given
    )
    left_out = LeftOut("the objects of Blender")
    found = [mesh for one in objects for mesh in _evaluated(one, left_out)]
    left_out.warn()
    yield from found


def of_object(given: Any) -> Iterator[Mesh]:
    """Yield a mesh for each material of an object of Blender, with modifiers, named, and in its place.

    Warns
    -----
    RuntimeWarning
        Once, if it is a light, a camera or another object without a surface, and left out, and of parts of
        its materials without an effect.
    """
    left_out = LeftOut("the objects of Blender")
    found = list(_evaluated(given, left_out))
    left_out.warn()
    yield from found


def _evaluated(given: Any, left_out: LeftOut) -> Iterator[Mesh]:
    kind = getattr(given, "type", "MESH")
    if kind not in _SURFACES:
        left_out.add(f"{given.name!r}, a {kind.lower()}")
        return
    import bpy

    evaluated = given.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    try:
        if mesh is None:
            return
        found = list(_by_material(mesh, left_out))
    finally:
        evaluated.to_mesh_clear()
    matrix = np.array(evaluated.matrix_world, np.float64).reshape(4, 4)
    is_moved = not np.array_equal(matrix, np.eye(4))
    for one in found:
        yield named(one.transformed(matrix) if is_moved else one, given.name)


def of_mesh(mesh: Any) -> Iterator[Mesh]:
    """Yield a mesh for each material of a bpy.types.Mesh, with attributes of points and faces.

    Warns
    -----
    RuntimeWarning
        Once, for parts of materials without an effect.
    """
    left_out = LeftOut("the objects of Blender")
    found = list(_by_material(mesh, left_out))
    left_out.warn()
    yield from found


def _by_material(mesh: Any, left_out: LeftOut) -> Iterator[Mesh]:
    points = _numbers(mesh.vertices, "co", 3, np.float32)
    corners = _numbers(mesh.loops, "vertex_index", 1, np.int32)
    counts = _numbers(mesh.polygons, "loop_total", 1, np.int32)
    starts = _numbers(mesh.polygons, "loop_start", 1, np.int32)
    if not np.array_equal(starts, np.cumsum(counts) - counts):
        corners = np.concatenate([corners[s : s + n] for s, n in zip(starts, counts, strict=True)])
    of_points, of_faces = _attributes(mesh, "POINT"), _attributes(mesh, "FACE")
    slots = [None if one is None else pbr_of(one, left_out) for one in getattr(mesh, "materials", ())]
    uv = _uv(mesh, len(corners)) if any(map(_has_picture, slots)) else None
    if uv is not None:
        sources, corners, uv = split_corners(corners, uv, len(points))
        points, of_points = points[sources], {name: array[sources] for name, array in of_points.items()}
    numbers = _numbers(mesh.polygons, "material_index", 1, np.int32) if len(slots) > 1 else 0 * counts
    for i, (number, which) in enumerate(by_number(numbers, len(slots))):
        pbr = slots[number] if number >= 0 else None
        is_all = isinstance(which, slice)
        made = mesh_of_polygons(
            points,
            corners if is_all else corners[np.repeat(np.isin(np.arange(len(counts)), which), counts)],
            counts[which],
            None if is_all else which,
            {name: array[which] for name, array in of_faces.items()},
            of_points,
            uv=uv,
            material=None if pbr is None else pbr.material(),
            emission=None if pbr is None else pbr.emitted(),
            name=mesh.name,
        )
        yield continued(made) if i else made


def _uv(mesh: Any, count: int) -> NDArray[Any] | None:
    """Return the active texture coordinates of corners; None if there are none."""
    layer = getattr(getattr(mesh, "uv_layers", None), "active", None)
    return None if layer is None or len(layer.data) != count else _numbers(layer.data, "uv", 2, np.float32)


def _has_picture(pbr: Pbr | None) -> bool:
    return pbr is not None and any(
        one is not None for one in (pbr.color_picture, pbr.normal_picture, pbr.emission_picture)
    )


def _attributes(mesh: Any, domain: str) -> dict[str, NDArray[Any]]:
    """Return the values of points or of faces by name, without those of Blender's own use."""
    found = {}
    for one in getattr(mesh, "attributes", ()):
        is_own = one.name.startswith(".") or one.name in ("position", "sharp_face", "material_index")
        if one.domain == domain and one.data_type in _VALUES and not is_own:
            found[one.name] = _numbers(
                one.data, *_VALUES[one.data_type], _DTYPES.get(one.data_type, np.float32)
            )
    return found


def _numbers(sequence: Any, name: str, columns: int, dtype: Any) -> NDArray[Any]:
    """Return a property of each of a sequence of Blender's: (N,), or (N, columns) if it is a vector."""
    array = np.empty(len(sequence) * columns, dtype)
    if hasattr(sequence, "foreach_get"):
        sequence.foreach_get(name, array)
    else:
        array[:] = np.array([getattr(one, name) for one in sequence], dtype).reshape(-1)
    return array if columns == 1 else array.reshape(-1, columns)
