"""Meshes from the objects of VTK, and so of pyvista."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..materials import Diffuse
from ..shapes.mesh import Mesh
from ..textures import ImageTexture
from .look import Look, color_look
from .polygons import LeftOut, mesh_of_polygons

Integers = NDArray[np.integer[Any]]

# Arrays added by the surface filter, and by VTK itself.
_CELLS = "raywright cells"
_OWN = (_CELLS, "vtkGhostType")
# Point arrays that hold colors, by the names of VTK's readers and of `Mesh.to_pyvista`.
_COLORS = ("RGB", "RGBA", "Colors", "colors")


def of_vtk(data: Any) -> Iterator[Mesh]:
    """Yield the surface of a data set, or of each block of a composite one, with point and cell data.

    Polygons keep their order, and strips come after them. Points and lines are left out.

    Raises
    ------
    ValueError
        If it has points or lines alone.
    TypeError
        If it is neither a data set nor composite, such as a table.

    Warns
    -----
    RuntimeWarning
        Once, for all that is left out.
    """
    left_out = LeftOut(type(data).__name__)
    # Blocks of points only have no surface.
    found = [mesh for name, one in _data_sets(data, None) if (mesh := _mesh(one, name, left_out)) is not None]
    if not found:
        raise ValueError(f"a {type(data).__name__} must have faces to become a mesh, got {left_out.told()}")
    left_out.warn()
    yield from found


def _data_sets(data: Any, name: str | None) -> Iterator[tuple[str | None, Any]]:
    if data.IsA("vtkDataSet"):
        yield name, data
    elif data.IsA("vtkMultiBlockDataSet"):
        from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet

        for i in range(data.GetNumberOfBlocks()):
            block = data.GetBlock(i)
            if block is not None:
                told = data.GetMetaData(i) if data.HasMetaData(i) else None
                own = told.Get(vtkCompositeDataSet.NAME()) if told is not None else None
                yield from _data_sets(block, own or name)
    elif data.IsA("vtkPartitionedDataSet"):
        for i in range(data.GetNumberOfPartitions()):
            yield from _data_sets(data.GetPartition(i), name)
    else:
        raise TypeError(f"shapes must be data sets of VTK with a surface, got {data.GetClassName()}")


def _mesh(data: Any, name: str | None, left_out: LeftOut) -> Mesh | None:
    is_surface = data.IsA("vtkPolyData")
    surface = data if is_surface else _surface(data)
    count = surface.GetNumberOfCells()
    if not count:
        return Mesh([], [], name=name)
    corners, counts, ids = _polygons(surface, left_out)
    if not len(counts):
        return None
    points, of_points = _array(surface.GetPoints().GetData()), surface.GetPointData()
    of_polygons = {key: array[ids] for key, array in _values(surface.GetCellData(), count, left_out).items()}
    if not is_surface:
        cells = _array(surface.GetCellData().GetArray(_CELLS))[ids]
    else:
        # None where all cells are polygons.
        cells = None if len(counts) == count and isinstance(ids, slice) else np.arange(count)[ids]
    normals, uv = of_points.GetNormals(), of_points.GetTCoords()
    of_vertices = _values(of_points, len(points), left_out)
    look = _look(data, of_vertices)
    return mesh_of_polygons(
        points,
        corners,
        counts,
        cells,
        of_polygons,
        of_vertices,
        normals=None if normals is None else _array(normals),
        uv=None if uv is None or uv.GetNumberOfComponents() != 2 else _array(uv),
        material=look.material,
        colors=look.colors,
        name=name,
    )


def _look(data: Any, of_vertices: dict[str, NDArray[Any]]) -> Look:
    """Return the look by the texture that pyvista has kept with a mesh, or by colors among point data."""
    # pyvista before 0.43 had textures; to_array has rows from the top.
    textures = list(dict(getattr(data, "textures", None) or {}).values())
    if textures:
        return Look(Diffuse(ImageTexture(np.asarray(textures[0].to_array()))))
    for name in _COLORS:
        array = of_vertices.get(name)
        if array is None or array.ndim != 2 or array.shape[1] not in (3, 4) or not len(array):
            continue
        is_share = array.dtype.kind == "f" and float(array.min()) >= 0 and float(array.max()) <= 1
        if array.dtype == np.uint8 or is_share:
            return color_look(array)
    return Look()


def _surface(data: Any) -> Any:
    """Return the outer faces of a data set of volume cells, with the numbers of their cells."""
    from vtkmodules.vtkFiltersGeometry import vtkDataSetSurfaceFilter

    surface = vtkDataSetSurfaceFilter()
    surface.SetInputData(data)
    surface.PassThroughCellIdsOn()
    surface.SetOriginalCellIdsName(_CELLS)
    surface.Update()
    return surface.GetOutput()


def _polygons(surface: Any, left_out: LeftOut) -> tuple[Integers, Integers, Any]:
    """Return the corners of all polygons, how many each has, and which cells they are."""
    for kind, cells in (("points", surface.GetVerts()), ("lines", surface.GetLines())):
        if cells.GetNumberOfCells():
            left_out.add(kind)
    # Cells are numbered in this order.
    first = surface.GetNumberOfVerts() + surface.GetNumberOfLines()
    corners, counts = _lists(surface.GetPolys())
    strips, lengths = _lists(surface.GetStrips())
    if not len(lengths):
        return corners, counts, slice(first, first + len(counts))
    ids = np.arange(first, first + len(counts))
    own = np.repeat(np.arange(len(lengths)), np.maximum(lengths - 2, 0))
    # Every second triangle of a strip has reversed winding.
    place = np.arange(len(own)) - (np.cumsum(lengths - 2) - (lengths - 2))[own]
    start = (np.cumsum(lengths) - lengths)[own] + place
    odd = place % 2
    faces = np.stack([strips[start], strips[start + 1 + odd], strips[start + 2 - odd]], axis=1)
    counts = np.concatenate([counts, np.full(len(faces), 3)])
    corners = np.concatenate([corners, faces.reshape(-1)])
    return corners, counts, np.concatenate([ids, first + len(ids) + own])


def _lists(cells: Any) -> tuple[Integers, Integers]:
    """Return the points of all cells, one cell after the other, and how many each has."""
    if cells is None or not cells.GetNumberOfCells():
        return np.empty(0, np.int64), np.empty(0, np.int64)
    offsets = _array(cells.GetOffsetsArray())
    return _array(cells.GetConnectivityArray()), np.diff(offsets)


def _values(data: Any, count: int, left_out: LeftOut) -> dict[str, NDArray[Any]]:
    """Return the arrays of a data set by name."""
    found = {}
    for i in range(data.GetNumberOfArrays()):
        name = data.GetArrayName(i)
        if name not in _OWN:
            # Arrays of text have no numbers.
            array = data.GetArray(i)
            found[name or f"array_{i}"] = None if array is None else _array(array)
    return left_out.values(found, count, "array")


def _array(data: Any) -> NDArray[Any]:
    """Return an array of VTK as one of numpy, which shares its memory."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    found: NDArray[Any] = vtk_to_numpy(data)
    return found
