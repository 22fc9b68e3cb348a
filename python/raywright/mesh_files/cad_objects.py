"""Meshes from shapes of CadQuery, build123d and Open CASCADE.

Each face of a shape becomes triangles with corners of its own; those along an edge that two faces share are
in the same places. `Mesh.cells` are the faces of the shape, in its order.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..materials import Diffuse, Material
from ..shapes.mesh import Mesh
from .polygons import LeftOut

# Open CASCADE's linear deflection, as a share of the diagonal of the shape's box, and its angular deflection.
_TOLERANCE = 1e-3
_RADIANS = 0.2


def of_topology(shape: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield the mesh of a TopoDS_Shape of Open CASCADE.

    Raises
    ------
    ValueError
        If it has no faces.
    """
    found = _mesh(shape, tolerance, None, None)
    if found is None:
        raise ValueError(f"a shape must have faces to become a mesh, got {_kind(shape)} without")
    yield found


def of_shape(shape: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield the mesh of a cadquery.Shape, named by its label."""
    yield from _labeled(shape, tolerance)


def of_workplane(workplane: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield a mesh for each shape on the stack of a cadquery.Workplane.

    Raises
    ------
    ValueError
        If none has faces.

    Warns
    -----
    RuntimeWarning
        Once, for shapes without faces.
    """
    shapes = [value for value in workplane.vals() if hasattr(value, "wrapped") and hasattr(value, "Faces")]
    yield from _several([(shape.wrapped, None, None) for shape in shapes], tolerance, workplane)


def of_assembly(assembly: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield a mesh for each shape of a cadquery.Assembly, in its place, with its color.

    Names are paths within the assembly, such as ``gear/tooth``.

    Raises, Warns
    -------------
    As `of_workplane`.
    """
    parts = []
    # Each entry already includes the places, names and colors of its parents.
    for shape, name, place, color in assembly:
        # An assembly without a name gets a long random one.
        parts.append((shape.moved(place).wrapped, name.removeprefix(f"{assembly.name}/"), color))
    yield from _several(parts, tolerance, assembly)


def of_labeled(shape: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield a mesh for each leaf of a build123d.Shape, with its label and color.

    Raises, Warns
    -------------
    As `of_workplane`.
    """
    # An empty shape raises if queried further.
    leaves = tuple(shape.leaves) if shape else ()
    if not leaves:
        raise ValueError(f"a shape must have faces to become a mesh, got an empty {type(shape).__name__}")
    if leaves == (shape,):
        yield from _labeled(shape, tolerance)
        return
    parts = [(leaf.wrapped, leaf.label or None, _inherited(leaf)) for leaf in leaves]
    yield from _several(parts, tolerance, shape)


def of_builder(builder: Any, tolerance: float | None) -> Iterator[Mesh]:
    """Yield the meshes of a BuildPart or BuildSketch of build123d.

    Raises
    ------
    ValueError
        If it has built nothing with faces.
    """
    built = next((getattr(builder, name) for name in ("part", "sketch") if hasattr(builder, name)), None)
    if built is None:
        raise ValueError(f"a {type(builder).__name__} has built nothing with faces")
    yield from of_labeled(built, tolerance)


def _labeled(shape: Any, tolerance: float | None) -> Iterator[Mesh]:
    found = _mesh(shape.wrapped, tolerance, shape.label or None, getattr(shape, "color", None))
    if found is None:
        raise ValueError(f"a shape must have faces to become a mesh, got {type(shape).__name__} without")
    yield found


def _several(parts: list[Any], tolerance: float | None, whole: Any) -> Iterator[Mesh]:
    left_out = LeftOut(type(whole).__name__)
    found = []
    for shape, name, color in parts:
        mesh = _mesh(shape, tolerance, name, color)
        if mesh is None:
            left_out.add(f"{_kind(shape)} without faces")
        else:
            found.append(mesh)
    if not found:
        raise ValueError(f"shapes of a {type(whole).__name__} must have faces to become meshes, got none")
    left_out.warn()
    yield from found


def _inherited(shape: Any) -> Any:
    """Return the color of a shape of build123d, or of its parent."""
    while shape is not None:
        if shape.color is not None:
            return shape.color
        shape = shape.parent
    return None


def _kind(shape: Any) -> str:
    return str(shape.ShapeType()).rsplit("_", 1)[-1].lower()


def _material(color: Any) -> Material | None:
    """Return what a color shows; Open CASCADE has linear red, green and blue."""
    if color is None:
        return None
    rgb = color.wrapped.GetRGB()
    return Diffuse((rgb.Red(), rgb.Green(), rgb.Blue()))


def _mesh(shape: Any, tolerance: float | None, name: str | None, color: Any) -> Mesh | None:
    """Return the mesh of a TopoDS_Shape; None if it has no faces."""
    if shape is None or next(_faces(shape), None) is None:
        return None
    from OCP.BRepBuilderAPI import BRepBuilderAPI_Copy
    from OCP.BRepMesh import BRepMesh_IncrementalMesh

    distance = _TOLERANCE * _diagonal(shape) if tolerance is None else tolerance
    # A shape keeps its finest triangulation; that of a copy depends on the tolerance alone.
    shape = BRepBuilderAPI_Copy(shape, False, False).Shape()
    BRepMesh_IncrementalMesh(shape, distance, False, _RADIANS, True)
    points, corners, cells = [np.empty((0, 3))], [np.empty((0, 3), np.int64)], [np.empty(0, np.int64)]
    start = 0
    for i, face in enumerate(_faces(shape)):
        found = _triangles(face)
        if found is None:
            continue
        points.append(found[0])
        corners.append(found[1] + start)
        cells.append(np.full(len(found[1]), i))
        start += len(found[0])
    places, triples, owner = (np.concatenate(part) for part in (points, corners, cells))
    return Mesh(places, triples, material=_material(color), name=name, cells=owner)


def _faces(shape: Any) -> Iterator[Any]:
    from OCP.TopAbs import TopAbs_FACE
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    cast = getattr(TopoDS, "Face_s", None) or TopoDS.Face
    explorer = TopExp_Explorer(shape, TopAbs_FACE)
    while explorer.More():
        yield cast(explorer.Current())
        explorer.Next()


def _diagonal(shape: Any) -> float:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(shape, box)
    return float(np.sqrt(box.SquareExtent())) or 1.0


def _triangles(face: Any) -> tuple[NDArray[np.float64], NDArray[np.int64]] | None:
    """Return the corners and triangles of a face that is triangulated; None if it could not be."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    place = TopLoc_Location()
    found = BRep_Tool.Triangulation_s(face, place)
    if found is None:
        return None
    moved = place.Transformation()
    points = np.array([found.Node(i).Coord() for i in range(1, found.NbNodes() + 1)], np.float64)
    if not place.IsIdentity():
        matrix = np.array([[moved.Value(row, k) for k in (1, 2, 3, 4)] for row in (1, 2, 3)])
        points = points @ matrix[:, :3].T + matrix[:, 3]
    triangles = np.array([found.Triangle(i).Get() for i in range(1, found.NbTriangles() + 1)], np.int64) - 1
    triangles = triangles.reshape(-1, 3)
    if (face.Orientation() == TopAbs_REVERSED) != moved.IsNegative():
        triangles = triangles[:, [0, 2, 1]]
    return points.reshape(-1, 3), triangles
