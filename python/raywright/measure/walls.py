"""How thick walls are."""

import math
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import choice
from ..query.hits import ClosestPoints, SurfacePoints
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .places import Floats, Places, SceneLike, places, scene_of, sealed, size_of

Method = Literal["ray", "sphere"]
# A ball shrinks towards its last size geometrically; so many steps are more than any took that was tried.
_STEPS = 60
# Points are asked so many at a time, between which progress is told.
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
    """Find how thick a body is at points of its surface.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that a Scene is made of
        The body; normals point out of it.
    points : Hits, ClosestPoints or (..., 3) array, optional
        Where. The middle of every face if not given, which only meshes have.
    normals : (..., 3) array, optional
        Outward normals, of any length; those of the surfaces if not given, which only what was hit has.
    method : {"ray", "sphere"}
        "ray" goes straight in, against the normal, to where the surface is met next. "sphere" is the diameter
        of the largest ball inside that touches the surface at the point, which is never more, does not depend
        on how the far side is tilted, and needs closest points.
    offset : float, optional
        How far from plain points rays start; a millionth of the scene's size if not given.
    progress : bool or callable, optional
        As for `sky_view`.
    threads : int, optional
        How many to use; all cores if not given. The answer does not depend on it.

    Returns
    -------
    (...) float64
        In the scene's unit, of the leading shape of the points, or (F,) of all faces of all shapes in order;
        inf where there is no other side, NaN where there is no point. Read-only.

    Raises
    ------
    ValueError
        If shapes do not broadcast, a number is not finite, a vector has no length, normals are missing, or
        `method` is no such method; without points, if something in the scene is no mesh; for "sphere", if
        something in it has no closest points.
    TypeError
        If something is of the wrong type.

    Notes
    -----
    The ball shrinks from the one that the ray allows until nothing is nearer to its centre than the point
    (Ma, Bae and Choi, "3D Medial Axis Point Approximation Using Nearest Neighbors and the Normal Field",
    2012), to 1e-9 of itself or of the scene's size, at a convex edge to nothing. Rays and balls are exact
    for the surface as it is: where a mesh stands for something round, its facets are what is measured.
    """
    choice("method", method, get_args(Method))
    if progress is not None:
        check_progress(progress)
    scene = scene_of(scene)
    found = _middles(scene) if points is None else points
    out = places(scene, found, normals, offset)
    inside = _left(found, out) if isinstance(found, SurfacePoints) else _inner(scene, found, out, offset)
    result = np.empty(len(out))
    with watcher(progress, "thickness") as report:
        for start in range(0, len(out), _TOGETHER):
            some = slice(start, start + _TOGETHER)
            result[some] = _of(scene, inside, some, method, threads)
            if report is not None:
                report(min(1.0, (start + _TOGETHER) / len(out)))
    return sealed(result.reshape(out.shape))


def _middles(scene: Scene) -> ClosestPoints:
    """Return the middle of every face as a point of the surface."""
    for i, shape in enumerate(scene.shapes):
        if not isinstance(shape, Mesh):
            raise ValueError(f"points must be given: shape {i} is no mesh but a {type(shape).__name__}")
    counts = [len(shape.faces) for shape in scene.shapes if isinstance(shape, Mesh)]
    shape_id = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    primitive = np.concatenate(
        [np.arange(0, dtype=np.int32), *(np.arange(n, dtype=np.int32) for n in counts)]
    )
    uv = np.full((len(primitive), 2), 1 / 3)
    core = scene._compiled()
    position = core.positions(shape_id, primitive, uv)
    return ClosestPoints(np.zeros(len(primitive)), position, shape_id, primitive, uv, core)


def _left(found: SurfacePoints, out: Places) -> Places:
    """Return the same places, from where rays go in."""
    starts = found.leave(np.where(np.isfinite(out.normals), -out.normals, 1.0).reshape(*out.shape, 3)).origins
    return Places(starts.reshape(-1, 3), out.normals, out.shape)


def _inner(scene: Scene, found: ArrayLike, out: Places, offset: float | None) -> Places:
    """Return the same of points that are plain numbers."""
    inward = places(scene, found, -out.normals.reshape(*out.shape, 3), offset)
    return Places(inward.origins, out.normals, out.shape)


def _of(scene: Scene, inside: Places, some: slice, method: Method, threads: int | None) -> Floats:
    starts, normals = inside.origins[some], inside.normals[some]
    across = scene.intersect(starts, -normals, threads=threads).t
    lost = ~np.isfinite(starts).all(axis=1)
    if method == "sphere":
        across = _balls(scene, starts, normals, across, threads)
    return np.where(lost, np.nan, across)


def _balls(scene: Scene, starts: Floats, normals: Floats, across: Floats, threads: int | None) -> Floats:
    """Return the diameters of the largest balls inside that touch the surface where rays start."""
    least = 1e-9 * size_of(scene, starts[np.isfinite(starts).all(axis=1)])
    bounds = scene.bounds
    # A ball that is larger than the scene is met by nothing that a smaller one is not.
    most = math.inf if bounds is None else float(np.linalg.norm(bounds[1] - bounds[0]))
    radius = np.minimum(across, 2.0 * most) / 2.0
    open_ = np.flatnonzero(np.isfinite(radius) & np.isfinite(starts).all(axis=1))
    for _ in range(_STEPS):
        if not len(open_):
            break
        point, normal, r = starts[open_], normals[open_], radius[open_]
        near = scene.closest_point(point - r[:, None] * normal, threads=threads)
        away = point - near.position
        # The ball through the point that also touches the nearest one: |p - q|^2 / 2 n·(p - q).
        depth = np.maximum((away * normal).sum(axis=1), 0.0)
        square = (away * away).sum(axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            smaller = np.where(depth > 0, square / (2.0 * depth), r)
        is_less = (near.distance < r - least) & (smaller < r - np.maximum(least, 1e-9 * r))
        radius[open_] = np.where(is_less, smaller, r)
        open_ = open_[is_less]
    return np.where(np.isfinite(across), 2.0 * radius, across)
