"""Meshes of a USD stage."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...mesh_files.triangulation import polygon_of, triangulate
from ...shapes.mesh import Mesh
from .materials import Surface, bound, colored, opacity, own_surface
from .primvars import Corners, found
from .reading import Reading, numbers

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

UNPOSED = "skeletons and blend shapes are left out: meshes are shown unposed"


def meshes(mesh: Any, reading: Reading, matrix: Floats) -> list[Mesh]:
    """Return a mesh where a matrix puts it: one for each of its materials."""
    prim = mesh.GetPrim()
    points, counts, indices = _faces(mesh, reading)
    _tell_what_is_left_out(mesh, reading)
    corner, face = triangulate(points, indices, counts), polygon_of(counts)
    # Holes are missing faces.
    holes = numbers(reading.value(mesh.GetHoleIndicesAttr()), len(counts), f"{prim.GetPath()} has holes")
    if len(holes):
        kept = ~np.isin(face, holes)
        corner, face = corner[kept], face[kept]
    if reading.value(mesh.GetOrientationAttr()) == "leftHanded":
        corner = corner[:, ::-1]
    corners = Corners(prim, reading, counts, indices)
    normals = corners.normals(mesh)
    own = _own(prim, reading)
    result = []
    for surface, chosen in _parts(prim, reading, len(counts)):
        flat = corner[chosen[face]].reshape(-1)
        if not len(flat):
            continue
        look = surface or own
        uv = corners.primvar(look.uv or "st", 2)
        if look.uv is not None and uv is None:
            reading.notes.tell(f"textures on meshes without the coordinates {look.uv!r} are placed by others")
        values = {"normals": normals, "uv": uv, "colors": _colors(corners, look, len(indices))}
        made = _mesh(points, indices, flat, values, look, str(prim.GetName()))
        result.append(made.transformed(matrix))
    return result


def _colors(corners: Corners, surface: Surface, count: int) -> Floats | None:
    """Return the colors that a surface needs at each corner, (C, 3); None if it needs none."""
    if surface.colors is None:
        return None
    given = corners.primvar(surface.colors, 3)
    return np.broadcast_to(surface.missing, (count, 3)) if given is None else given.clip(0, 1)


def _faces(mesh: Any, reading: Reading) -> tuple[Floats, Integers, Integers]:
    """Return points, how many corners each face has, and the points of the corners."""
    # Attributes without a value are empty.
    points = np.array(reading.value(mesh.GetPointsAttr(), ()), np.float64).reshape(-1, 3)
    counts = np.array(reading.value(mesh.GetFaceVertexCountsAttr(), ()), np.int64).reshape(-1)
    indices = np.array(reading.value(mesh.GetFaceVertexIndicesAttr(), ()), np.int64).reshape(-1)
    if (
        (counts < 0).any()
        or counts.sum() != len(indices)
        or (len(indices) and not (indices.min() >= 0 and indices.max() < len(points)))
    ):
        raise ValueError(f"{mesh.GetPath()} has face counts or indices that do not match its points")
    return points, counts, indices


def _tell_what_is_left_out(mesh: Any, reading: Reading) -> None:
    prim, tell = mesh.GetPrim(), reading.notes.tell
    scheme = mesh.GetSubdivisionSchemeAttr()
    if scheme.HasAuthoredValue() and reading.value(scheme) != "none":
        tell("subdivision is not applied to meshes")
    skinned = prim.GetAttribute("primvars:skel:jointIndices"), prim.GetRelationship("skel:blendShapes")
    if (skinned[0] and skinned[0].HasAuthoredValue()) or (skinned[1] and skinned[1].GetTargets()):
        tell(UNPOSED)


def _own(prim: Any, reading: Reading) -> Surface:
    """Return the surface of meshes without a material: gray, or of their colors."""
    primvar = found(prim, "displayColor")
    if primvar is not None and str(primvar.GetInterpolation()) != "constant":
        return colored(None, opacity(prim, reading))
    return own_surface(prim, reading)


def _parts(prim: Any, reading: Reading, count: int) -> list[tuple[Surface | None, NDArray[np.bool_]]]:
    """Return the surfaces of a mesh, None for its own, and which of its faces have each."""
    from pxr import UsdShade

    parts = [(bound(prim, reading), np.ones(count, np.bool_))]
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        surface = bound(subset.GetPrim(), reading)
        chosen = np.zeros(count, np.bool_)
        chosen[numbers(reading.value(subset.GetIndicesAttr()), count, f"{subset.GetPath()} has faces")] = True
        parts[0] = parts[0][0], parts[0][1] & ~chosen
        parts.append((surface, chosen))
    return parts


def _mesh(
    points: Floats,
    indices: Integers,
    flat: Integers,
    values: dict[str, Floats | None],
    look: Surface,
    name: str,
) -> Mesh:
    """Return a mesh of some corners."""
    common: dict[str, Any] = {"material": look.material, "emission": look.emission, "name": name}
    if all(one is None for one in values.values()):
        return Mesh(points, indices[flat].reshape(-1, 3), **common)
    # Values may differ between faces at one vertex, so each corner becomes its own vertex.
    arrays: dict[str, Any] = {name: None if one is None else one[flat] for name, one in values.items()}
    return Mesh(points[indices[flat]], np.arange(len(flat)).reshape(-1, 3), **arrays, **common)
