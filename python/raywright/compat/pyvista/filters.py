"""Filters of pyvista's meshes."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...arrays import choice, triple
from ...measure.cracks import topology
from ...shapes.mesh import Mesh
from ..trimesh_proximity.closest import signed
from .surfaces import surface_of

Ints = NDArray[np.int64]


def ray_trace(
    mesh: Any,
    origin: ArrayLike,
    end_point: ArrayLike,
    first_point: bool = False,
    plot: bool = False,
    off_screen: bool | None = None,
) -> tuple[NDArray[Any], Ints]:
    """Find where a segment crosses a surface.

    Parameters
    ----------
    mesh : pyvista.PolyData
        The surface; other polygons than triangles are triangulated.
    origin, end_point : 3 numbers
        The ends of the segment, which count.
    first_point : bool
        True to return only the first of the points.
    plot : bool
        Whether to show a picture of it.
    off_screen : bool, optional
        True to make the picture off screen.

    Returns
    -------
    intersection_points : (n, 3) array
        The points, in order along the segment and of the dtype of ``mesh.points``; (3,) with `first_point`.
    intersection_cells : (n,) int64
        The cell of each. All of them, with `first_point` too, as in pyvista.

    Raises
    ------
    ValueError
        If an end is not 3 finite numbers.
    TypeError
        If `mesh` is not a pyvista.PolyData, or an end does not hold real numbers.

    See Also
    --------
    multi_ray_trace : Many rays.

    Examples
    --------
    >>> import pyvista
    >>> from raywright.compat.pyvista import ray_trace
    >>> points, cells = ray_trace(pyvista.Cube(), [0.1, 0.2, 5], [0.1, 0.2, -5])
    >>> print(points.round(4))
    [[ 0.1  0.2  0.5]
     [ 0.1  0.2 -0.5]]
    """
    start, end = np.array(triple("origin", origin)), np.array(triple("end_point", end_point))
    surface = surface_of("mesh", mesh)
    hits = surface.intersector._scene.intersect_all(start, end - start, t_max=1.0)
    # A segment along an edge enters several faces at one point; pyvista returns that point once.
    is_new = np.diff(hits.t, prepend=-1.0) > 0
    points, cells = hits.position[is_new].astype(mesh.points.dtype), surface.cells[hits.primitive_id[is_new]]
    if first_point and len(points):
        points = points[0]
    if plot:
        _show(mesh, start, end, points, off_screen)
    return points, cells


def multi_ray_trace(
    mesh: Any, origins: ArrayLike, directions: ArrayLike, first_point: bool = False, retry: bool = False
) -> tuple[NDArray[np.float64], Ints, Ints]:
    """Find where rays hit a surface.

    Parameters
    ----------
    mesh : pyvista.PolyData
        The surface; other polygons than triangles are triangulated.
    origins, directions : (n, 3) arrays
        The rays.
    first_point : bool
        True to return only the first hit of each ray.
    retry : bool
        Changes nothing: no hit is lost.

    Returns
    -------
    intersection_points : (m, 3) float64
        The points. First hits of all rays come first, then second ones, and so on.
    intersection_rays : (m,) int64
        The ray of each.
    intersection_cells : (m,) int64
        The cell of each.

    Raises
    ------
    ValueError
        If an array is not (n, 3), or the two differ in shape.
    TypeError
        If `mesh` is not a pyvista.PolyData, or an array does not hold real numbers.

    See Also
    --------
    ray_trace : One segment.

    Examples
    --------
    >>> import pyvista
    >>> from raywright.compat.pyvista import multi_ray_trace
    >>> points, rays, cells = multi_ray_trace(pyvista.Cube(), [[0.1, 0.2, 5], [9, 9, 5]], [[0, 0, -1]] * 2)
    >>> points.round(4).tolist(), rays.tolist()
    ([[0.1, 0.2, 0.5], [0.1, 0.2, -0.5]], [0, 0])
    """
    surface = surface_of("mesh", mesh)
    points, rays, faces = surface.intersector.intersects_location(origins, directions, not first_point)
    return points, rays, surface.cells[faces]


def select_interior_points(
    mesh: Any,
    surface: Any,
    *,
    method: Literal["signed_distance", "cell_locator"] = "signed_distance",
    inside_out: bool = False,
    check_surface: bool = True,
    locator_tolerance: float | None = None,
) -> Any:
    """Mark the points of a mesh that are inside a closed surface.

    Parameters
    ----------
    mesh : pyvista.DataSet
        The mesh.
    surface : pyvista.PolyData
        The enclosing surface; points on it are inside.
    method : {"signed_distance", "cell_locator"}
        Changes nothing: either way the side is decided exactly.
    inside_out : bool
        Whether to mark the points outside instead; those on the surface too.
    check_surface : bool
        Whether to refuse a surface with open edges. Above and below an open surface, points are inside
        where its normals point away from them.
    locator_tolerance : float, optional
        Changes nothing.

    Returns
    -------
    pyvista.DataSet
        A shallow copy of `mesh` with the bools as active scalars, ``point_data["selected_points"]``.

    Raises
    ------
    RuntimeError
        If the surface is not closed, unless `check_surface` is False.
    ValueError
        If `method` is none of these.
    TypeError
        If `surface` is not a pyvista.PolyData.

    See Also
    --------
    Scene.contains : Raywright's own query.

    Examples
    --------
    >>> import pyvista
    >>> from raywright.compat.pyvista import select_interior_points
    >>> points = pyvista.PolyData([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0]])
    >>> select_interior_points(points, pyvista.Sphere())["selected_points"].astype(bool).tolist()
    [True, False]
    """
    choice("method", method, ("signed_distance", "cell_locator"))
    intersector = surface_of("surface", surface).intersector

    def is_closed() -> bool:
        return topology(Mesh(intersector.mesh.vertices, intersector.mesh.faces)).is_closed

    if check_surface and not intersector._kept("is closed", is_closed):
        raise RuntimeError("surface must be closed, or check_surface be False: it has open edges")
    distance = signed(intersector, np.asarray(mesh.points), 0.0)
    marked = mesh.copy(deep=False)
    marked["selected_points"] = distance <= 0 if inside_out else distance >= 0
    marked.set_active_scalars("selected_points")
    return marked


def _show(mesh: Any, start: NDArray[Any], end: NDArray[Any], points: NDArray[Any], off_screen: Any) -> None:
    import pyvista

    plotter = pyvista.Plotter(off_screen=off_screen)
    plotter.add_mesh(mesh, label="Test Mesh")
    plotter.add_lines(np.stack([start, end]), color="b", label="Ray Segment")
    if points.size:
        met = pyvista.PolyData(points.reshape(-1, 3))
        plotter.add_mesh(met, color="r", point_size=10, label="Intersection Points")
    plotter.add_legend()
    plotter.add_axes()
    plotter.show()
