"""Wall thickness."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import choice
from ..query.closest_points import ClosestPoints
from ..query.surface_points import SurfacePoints
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene, SceneLike
from .places import Floats, Places, middles, places, scene_of

Method = Literal["ray", "sphere"]
# A ball shrinks towards its last size geometrically; no ball in tests took this many steps.
_STEPS = 60
# Relative precision of balls among curved shapes.
_EXACT = 1e-9
# Points per batch, between reports of progress.
_TOGETHER = 1 << 17


def thickness(
    scene: SceneLike,
    points: SurfacePoints | ArrayLike | None = None,
    normals: ArrayLike | None = None,
    method: Method = "ray",
    offset: float | None = None,
    progress: BuildProgress | None = None,
    threads: int | None = None,
) -> Floats:
    """Find the thickness of a body at points of its surface.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        The body; normals point out of it.
    points : Hits, ClosestPoints or (..., 3) array, optional
        Points on the surface. By default the centers of all faces; the scene must then consist of meshes.
    normals : (..., 3) array, optional
        Outward normals, of any length; those of the surfaces if not given, for hits only.
    method : {"ray", "sphere"}
        "ray" is the distance along the inward normal to the next surface. "sphere" is the diameter of the
        largest ball inside that touches the surface at the point; it is never larger, does not depend on the
        tilt of the far side, and needs closest points.
    offset : float, optional
        Distance along the normal from plain points to the rays' origins, as for `sky_view`.
    progress : bool or callable, optional
        As for `sky_view`.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.

    Returns
    -------
    (...) float64
        In the scene's unit, of the leading shape of the points, or (F,) of all faces of all shapes in order;
        inf without an opposite surface, NaN without a point.

    Raises
    ------
    ValueError
        If shapes do not broadcast, a number is not finite, a vector has no length, normals are missing, or
        `method` is not a known method; without points, if something in the scene is not a mesh; for "sphere",
        if something in it has no closest points.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Scene.signed_distance : The distance to the surface from inside.

    Notes
    -----
    The ball of "sphere" starts with the diameter of "ray" and shrinks until nothing is nearer to its center
    than the point (Ma, Bae and Choi, "3D Medial Axis Point Approximation Using Nearest Neighbors and the
    Normal Field", 2012), at a convex edge to nothing. Among meshes a tree of boxes and slabs finds the
    nearest obstacle, to 1e-6 of the ball; for other shapes, closest points do. Both measure the actual
    surface: for a mesh of a round shape, its facets.

    Examples
    --------
    >>> import trimesh
    >>> plate = trimesh.creation.box((4, 4, 0.5))
    >>> rw.measure.thickness(plate, [[0.1, 0.2, 0.25]], [[0, 0, 1]]).tolist()
    [0.5]
    >>> rw.measure.thickness(plate, [[0.1, 0.2, 0.25]], [[0, 0, 1]], method="sphere").round(4).tolist()
    [0.5]
    """
    choice("method", method, get_args(Method))
    if progress is not None:
        check_progress(progress)
    scene = scene_of(scene)
    found = middles(scene) if points is None else points
    out = places(scene, found, normals, offset, threads)
    sites, starts = _inward(scene, found, out, offset, threads)
    result = np.empty(len(out))
    with watcher(progress, "thickness") as report:
        for first in range(0, len(out), _TOGETHER):
            some = slice(first, first + _TOGETHER)
            points, ways = sites[some], -out.normals[some]
            # Rays start slightly inside.
            skipped = np.linalg.norm(starts[some] - points, axis=1)
            across = scene.intersect(starts[some], ways, threads=threads).t + skipped
            if method == "sphere":
                across = _balls(scene, points, ways, across, threads)
            result[some] = np.where(np.isfinite(points).all(axis=1), across, np.nan)
            if report is not None:
                report(min(1.0, some.stop / len(out)))
    return result.reshape(out.shape)


def _inward(
    scene: Scene, found: SurfacePoints | ArrayLike, out: Places, offset: float | None, threads: int | None
) -> tuple[Floats, Floats]:
    """Return the points, and where rays start that go in."""
    ways = -out.normals.reshape(*out.shape, 3)
    if isinstance(found, SurfacePoints):
        starts = found.spawn_rays(np.where(np.isfinite(ways), ways, 1.0)).origins
        return found.position.reshape(-1, 3), starts.reshape(-1, 3)
    points = np.broadcast_to(np.asarray(found, np.float64), ways.shape)
    return points.reshape(-1, 3), places(scene, found, ways, offset, threads).origins


def _balls(scene: Scene, points: Floats, ways: Floats, across: Floats, threads: int | None) -> Floats:
    """Return the diameters of the largest balls inside that touch the surface, from where ways go in."""
    known = np.isfinite(points).all(axis=1) & np.isfinite(across)
    radius = across / 2.0
    # Given points may lie slightly off the surface; balls touch the surface.
    near = scene.closest_point(points[known], threads=threads)
    core = scene._compiled()
    if core.curved:
        radius[known] = _shrunk(scene, near, ways[known], radius[known], threads)
    else:
        radius[known] = core.tangent_balls(near.position, ways[known], radius[known], threads)
    return 2.0 * radius


def _shrunk(scene: Scene, touch: ClosestPoints, ways: Floats, radius: Floats, threads: int | None) -> Floats:
    """Return the radii of balls that touch the surface at points, shrunk until nothing is inside."""
    open_ = np.arange(len(radius))
    for _ in range(_STEPS):
        if not len(open_):
            break
        point, r = touch.position[open_], radius[open_]
        # A point that touches the ball, to within its error, does not count, so the search ends before it.
        most = np.maximum(r - _EXACT * r - 2.0 * touch._error[open_], 0.0)
        near = scene.closest_point(point + r[:, None] * ways[open_], max_distance=most, threads=threads)
        is_near = near.found & (near.distance < most)
        away = np.where(is_near[:, None], near.position - point, 0.0)
        # Radius of the ball that touches the surface at p and passes through the nearest point q:
        # |q - p|^2 / 2 w·(q - p).
        depth = (away * ways[open_]).sum(axis=1)
        smaller = np.divide((away * away).sum(axis=1), 2.0 * depth, out=r.copy(), where=depth > 0)
        is_less = smaller < r - _EXACT * r
        radius[open_] = np.where(is_less, smaller, r)
        open_ = open_[is_less]
    return radius
