"""Shapes of a USD stage."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import choice
from ...scene.instance import Instance
from ...shapes import Box, Cone, Cylinder, Sphere
from ...shapes.mesh import Mesh
from .materials import PLAIN, Surface, bound, coloured
from .notes import Notes, told_of

Matrix = NDArray[np.float64]


def shapes(
    prim: Any, matrix: Matrix, time: Any, notes: Notes, kept: dict[str, Surface] | None = None
) -> list[Any]:
    """Return the shapes that a prim is; none if it is something else."""
    from pxr import UsdGeom

    kept = {} if kept is None else kept
    if prim.IsA(UsdGeom.Mesh):
        return _mesh(UsdGeom.Mesh(prim), matrix, time, notes, kept)
    if prim.IsA(UsdGeom.PointInstancer):
        return _copies(UsdGeom.PointInstancer(prim), matrix, time, notes)
    kind = str(prim.GetTypeName())
    if kind not in ("Sphere", "Cube", "Cylinder", "Cone"):
        if prim.IsA(UsdGeom.Gprim):
            notes.tell(f"shapes of type {kind} are left out")
        return []
    surface = bound(prim, notes, kept) or PLAIN
    look: dict[str, Any] = {"transform": matrix, "material": surface.material, "emission": surface.emission}

    def number(name: str) -> float:
        return float(prim.GetAttribute(name).Get(time))

    if kind == "Sphere":
        return [Sphere(radius=number("radius"), **look)]
    if kind == "Cube":
        half = 0.5 * number("size")
        return [Box((-half,) * 3, (half,) * 3, **look)]
    axis = str(prim.GetAttribute("axis").Get(time))
    choice("axis", axis, ("X", "Y", "Z"))
    end = np.zeros(3)
    end["XYZ".index(axis)] = 0.5 * number("height")
    if kind == "Cylinder":
        return [Cylinder(-end, end, number("radius"), **look)]
    return [Cone(-end, end, number("radius"), 0.0, **look)]


def _mesh(mesh: Any, matrix: Matrix, time: Any, notes: Notes, kept: dict[str, Surface]) -> list[Mesh]:
    from pxr import UsdGeom, UsdShade

    prim = mesh.GetPrim()
    # What has no value has none of them.
    points = np.array(mesh.GetPointsAttr().Get(time) or (), np.float64).reshape(-1, 3)
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(time) or (), np.int64).reshape(-1)
    indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(time) or (), np.int64).reshape(-1)
    if (
        (counts < 0).any()
        or counts.sum() != len(indices)
        or (len(indices) and not (indices.min() >= 0 and indices.max() < len(points)))
    ):
        raise ValueError(f"{prim.GetPath()} has faces that do not fit its points")
    scheme = mesh.GetSubdivisionSchemeAttr()
    if scheme.HasAuthoredValue() and scheme.Get(time) != "none":
        notes.tell("meshes that are to be subdivided are shown as they are")
    corner, face = _fans(counts)
    surface = bound(prim, notes, kept)
    parts = [(surface, np.ones(len(counts), np.bool_))]
    for subset in UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets():
        own = bound(subset.GetPrim(), notes, kept)
        chosen = np.zeros(len(counts), np.bool_)
        chosen[_numbers(subset.GetIndicesAttr().Get(time), len(counts), f"{subset.GetPath()} has faces")] = (
            True
        )
        parts[0] = parts[0][0], parts[0][1] & ~chosen
        parts.append((own, chosen))
    if mesh.GetOrientationAttr().Get(time) == "leftHanded":
        corner = corner[:, ::-1]
    normals = _values(mesh, "normals", time, counts, indices, 3)
    colours = None
    shown = UsdGeom.PrimvarsAPI(prim).GetPrimvar("displayColor")
    if shown and shown.HasValue():
        colours = _primvar(shown, time, counts, indices, 3)
    found = []
    for one, chosen in parts:
        corners = corner[chosen[face]]
        if not len(corners):
            continue
        look = one or (coloured() if colours is not None else PLAIN)
        uv = UsdGeom.PrimvarsAPI(prim).GetPrimvar(look.uv)
        coordinates = _primvar(uv, time, counts, indices, 2) if uv and uv.HasValue() else None
        given = {
            "normals": normals,
            "uv": coordinates,
            "colors": None if colours is None else colours.clip(0, 1),
        }
        flat = corners.reshape(-1)
        if any(values is not None for values in given.values()):
            # Corners may differ from face to face: each has its own.
            arrays = {name: None if values is None else values[flat] for name, values in given.items()}
            faces = np.arange(len(flat)).reshape(-1, 3)
            made = Mesh(
                points[indices[flat]],
                faces,
                material=look.material,
                emission=look.emission,
                name=prim.GetName(),
                **arrays,
            )
        else:
            made = Mesh(
                points,
                indices[flat].reshape(-1, 3),
                material=look.material,
                emission=look.emission,
                name=prim.GetName(),
            )
        found.append(made.transformed(matrix))
    return found


def _fans(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return triangles of polygons as numbers of corners, (T, 3), and which polygon each is of."""
    starts = np.cumsum(counts) - counts
    pieces = np.maximum(counts - 2, 0)
    face = np.repeat(np.arange(len(counts)), pieces)
    place = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    first = starts[face]
    return np.stack([first, first + place + 1, first + place + 2], -1), face


def _values(mesh: Any, name: str, time: Any, counts: Any, indices: Any, columns: int) -> Matrix | None:
    """Return normals at the corners of faces."""
    from pxr import UsdGeom

    primvar = UsdGeom.PrimvarsAPI(mesh.GetPrim()).GetPrimvar(name)
    if primvar and primvar.HasValue():
        return _primvar(primvar, time, counts, indices, columns)
    values = mesh.GetNormalsAttr().Get(time)
    if values is None or not len(values):
        return None
    return _corners(np.array(values, np.float64), str(mesh.GetNormalsInterpolation()), counts, indices)


def _primvar(primvar: Any, time: Any, counts: Any, indices: Any, columns: int) -> Matrix | None:
    values = np.array(primvar.ComputeFlattened(time), np.float64).reshape(-1, columns)
    return _corners(values, str(primvar.GetInterpolation()), counts, indices)


def _corners(values: Matrix, how: str, counts: Any, indices: Any) -> Matrix | None:
    """Return values at the corners of faces; None where they do not fit."""
    if how == "constant":
        return np.repeat(values[:1], len(indices), axis=0)
    at = {"uniform": np.repeat(np.arange(len(counts)), counts), "faceVarying": np.arange(len(indices))}.get(
        how, indices
    )
    return values[at] if len(at) == 0 or at.max() < len(values) else None


def _numbers(given: Any, count: int, what: str) -> NDArray[np.int64]:
    """Return numbers of things, of which there are so many."""
    numbers = np.array(given or (), np.int64).reshape(-1)
    if len(numbers) and not (numbers.min() >= 0 and numbers.max() < count):
        wrong = numbers[(numbers < 0) | (numbers >= count)][0]
        raise ValueError(f"{what} that are not there: number {wrong} of {count}")
    return numbers


def _copies(instancer: Any, matrix: Matrix, time: Any, notes: Notes) -> list[Instance]:
    from pxr import Usd, UsdGeom

    stage = instancer.GetPrim().GetStage()
    targets = instancer.GetPrototypesRel().GetTargets()
    which = _numbers(instancer.GetProtoIndicesAttr().Get(time), len(targets), "protoIndices has prototypes")
    positions = instancer.GetPositionsAttr().Get(time) or ()
    if len(positions) != len(which):
        raise ValueError(f"it has {len(which)} protoIndices, but {len(positions)} positions")
    places = instancer.ComputeInstanceTransformsAtTime(time, time)
    found = []
    for number, path in enumerate(targets):
        root = stage.GetPrimAtPath(path)
        if not root:
            raise ValueError(f"there is no prototype {path}")
        placed = UsdGeom.XformCache(time)
        # The root's own transform is in what is computed for each copy.
        home = np.linalg.inv(np.array(placed.GetLocalToWorldTransform(root), np.float64).T)
        parts: list[Any] = []
        for prim in Usd.PrimRange(root, Usd.TraverseInstanceProxies()):
            own = home @ np.array(placed.GetLocalToWorldTransform(prim), np.float64).T
            with told_of(prim):
                parts += shapes(prim, own, time, notes)
        there = [matrix @ np.array(places[int(k)], np.float64).T for k in np.flatnonzero(which == number)]
        if parts and there:
            found.append(Instance(parts, np.stack(there)))
    return found
