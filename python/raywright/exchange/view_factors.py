"""View factors: which share of the light that leaves one surface comes to another."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, get_args

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import SeedLike, choice, integer, positive, seed_number, thread_limit
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import Scene, SceneLike, as_scene
from ..shapes import Plane
from ..shapes.mesh import Mesh
from .coincident import Covered, merged
from .copies import LaidOut, laid_out
from .reciprocal import reciprocal
from .view_factor_matrix import Per, ViewFactors

# For more faces, the matrix of all pairs takes more than 0.8 GB and is sparse instead.
_MOST_DENSE = 10_000
# First number of rays per pair, and the target error relative to the greatest factor of either row.
_RAYS = 16
_RELATIVE = 0.006
# A row by rays covers all faces in view, so it takes more rays than a pair.
_CURVED_RAYS = 4096
_FACE_RAYS = 16
_MOST_RAYS = 2**26


def view_factors(
    scene: SceneLike,
    per: Per = "face",
    rays: int | None = None,
    error: float | None = None,
    seed: SeedLike = 0,
    threads: int | None = None,
    progress: BuildProgress = True,
) -> ViewFactors:
    """Compute view factors: the share of the diffuse light leaving one surface that arrives at another.

    Every surface sends and receives on its front only, the side of its normal, for any material, `TwoSided`
    included. Occluders block from either side. Two triangles with a clear view, which their shaft proves,
    have a closed form with a relative error of 1e-9. For other pairs, stratified rays estimate the difference
    from the closed form. Curved shapes send rays.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Meshes, and shapes other than `Plane`. Each face of each copy of an `Instance` is a face of its own;
        copies must stand still.
    per : {"face", "shape"}
        Rows of the matrix: faces, or shapes with all of their faces.
    rays : int, optional
        Number of rays between two faces with a possible occluder, up to 2**20. A curved shape sends 4096
        times as many, up to 2**26; in a scene of more than 10,000 faces, each face sends 16 times as many. If
        neither this nor `error` is given: 16, then as many as needed for a standard error below 1 % of the
        greatest factor of either row, up to 33 million in all. A curved shape then sends up to 2**20, and
        each of more than 10,000 faces sends 256, for any error.
    error : float, optional
        Target for the standard error of every view factor between faces. Rays are added until it is reached,
        up to 2**20 for a pair.
    seed : int, Generator or SeedSequence
        Seed of the random numbers, 0 to 2**64 - 1.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.
    progress : bool or callable
        As for `Scene.build`.

    Returns
    -------
    ViewFactors

    Raises
    ------
    ValueError
        If the scene has no faces, a face with a corner that is not finite, a shape without end, or copies
        that move; if `per` or a number is out of its range.
    TypeError
        If an argument has another type.
    KeyboardInterrupt
        At once, when Ctrl-C is pressed.

    Warns
    -----
    RuntimeWarning
        If faces coincide: they count as one face. If they overlap only in part, or one is a curved shape, the
        exchange of the common part counts twice.

    See Also
    --------
    radiosity : Solves for light.
    radiative_exchange : Solves for heat.

    Notes
    -----
    The exchange A_i F_ij of each pair is computed once, so A_i F_ij = A_j F_ji except for the last digit.
    Faces without area have factors of 0. In a closed room each row adds up to 1 within 1e-9: estimates are
    adjusted to that sum by weighted least squares, between 0 and the factor of an unblocked pair. A room
    counts as closed if all of at least 65,536 rays from its sampled faces hit a front. Otherwise the share
    that each row loses is estimated too. Standard errors are those before the adjustment, and so are upper
    bounds.

    If flat faces touch front to front, as a box or the cap of a cylinder and the floor beneath do, all light
    from the covered part of one arrives at the other. For two triangles it is their common area; for a curved
    shape it is sampled, like its row. An `Implicit` is assumed to have no flat parts.

    More than 10,000 faces have a sparse matrix (``pip install 'raywright[sparse]'``), sampled by rays even if
    little is hidden: the rows of two faces are combined into one estimate of their exchange, and rows are
    scaled so that they add up to 1 in a closed room. It has at most about twice as many entries in a row as a
    face has rays, of 12 bytes each, and as many of its errors: 100,000 faces of 256 rays take some 1.2 GB,
    and twice that while they are made.

    Closed forms: contour integrals, Schröder and Hanrahan (1993), Mitalas and Stephenson (1966). Shafts:
    Haines and Wallace (1991).

    Examples
    --------
    Opposite faces of a cube exchange 0.1998 (Siegel and Howell):

    >>> floor = rw.Mesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    >>> ceiling = rw.Mesh([[0, 0, 1], [0, 1, 1], [1, 1, 1], [1, 0, 1]], [[0, 1, 2], [0, 2, 3]])
    >>> found = rw.view_factors([floor, ceiling], per="shape", progress=False)
    >>> round(found.matrix[0, 1].item(), 4), found.rays
    (0.1998, 0)
    """
    scene = as_scene(scene)
    choice("per", per, get_args(Per))
    start = _RAYS if rays is None else integer("rays", rays, 1, 2**20)
    aim = None if error is None else positive("error", error)
    number = seed_number(seed)
    workers = thread_limit(threads)
    check_progress(progress)
    laid = laid_out(scene)
    first = _first_faces(laid)
    laid, covered = merged(replace(laid, scene=_exact(laid.scene)))
    core = laid.scene._compiled()
    with watcher(progress) as report:
        if first[-1] > _MOST_DENSE:
            found = _by_rows(core, covered, start * _FACE_RAYS, aim, number, workers, report)
        else:
            aims = aim, _RELATIVE if rays is None and aim is None else None
            each = start, min(start * _CURVED_RAYS, _MOST_RAYS)
            found = _dense(core, covered, each, aims, number, workers, report)
    return found if per == "face" else _of_shapes(found, covered, first)


def _first_faces(laid: LaidOut) -> NDArray[np.int64]:
    """Return the number of the first face of each shape, and of all faces; check that all can send."""
    start = 0
    for shape in laid.scene.shapes:
        # An empty mesh needs no check.
        i = int(laid.shape[min(start, len(laid.shape) - 1)]) if len(laid.shape) else 0
        start += len(shape.faces) if isinstance(shape, Mesh) else 1
        if isinstance(shape, Plane):
            raise ValueError(f"shapes[{i}] must have a finite area, got a Plane: give a Mesh")
    first = np.cumsum([0, *laid.counts])
    if first[-1] == 0:
        raise ValueError("the scene has no faces, and so no view factors")
    _check_finite(laid)
    return first


def _check_finite(laid: LaidOut) -> None:
    """Refuse a scene without a face of finite corners; single faces that are not finite are dropped."""
    for shape in laid.scene.shapes:
        if (
            not isinstance(shape, Mesh)
            or np.isfinite(shape.vertices).all(axis=1)[shape.faces].all(axis=1).any()
        ):
            return
    i = int(laid.shape[0])
    raise ValueError(f"face {int(laid.face[0])} of shapes[{i}] has a non-finite corner")


def _exact(scene: Scene) -> Scene:
    """Return the scene with all digits of its vertices, unless float32 was asked for or has them all."""

    def loses(shape: object) -> bool:
        return isinstance(shape, Mesh) and not np.array_equal(
            shape.vertices, shape.vertices.astype(np.float32)
        )

    if scene.precision == "auto" and any(map(loses, scene.shapes)):
        return scene.replace(precision="double")
    return scene


def _dense(core: _core.CompiledScene, covered: Covered, rays: tuple[int, int], *how: Any) -> ViewFactors:
    areas, matrix, (pairs, errors), counts, sent, closed = _core.view_factor_matrix(core, rays, *how)
    one, other = pairs.T
    with np.errstate(divide="ignore", invalid="ignore"):
        there, back = (np.nan_to_num((errors / areas[of]) ** 2) for of in (one, other))
    two = one != other
    rows, columns, values = (
        np.concatenate(both) for both in ((one, other[two]), (other, one[two]), (there, back[two]))
    )
    if len(covered):
        matrix[covered.faces] = covered.means(matrix)
        closed[covered.faces] = covered.means(closed.astype(np.float64)) > 1.0 - 1e-9
        squares = np.zeros(matrix.shape)
        squares[rows, columns] = values
        squares[covered.faces] = covered.means(squares, 2)
        rows, columns = np.nonzero(squares)
        values = squares[rows, columns]
    dropped = int(np.count_nonzero(areas == 0))
    variance = rows, columns, values
    return ViewFactors(matrix, areas, "face", *counts, sent, dropped, variance, closed)


def _by_rows(core: _core.CompiledScene, covered: Covered, rays: int, *how: Any) -> ViewFactors:
    sparse = _sparse()
    areas, (starts, faces, factors, errors), sent = _core.view_factor_rows(core, rays, *how)
    shape = (len(areas), len(areas))
    matrix = sparse((factors, faces, starts), shape=shape)
    variance = sparse((errors.astype(np.float64) ** 2, faces.copy(), starts.copy()), shape=shape)
    del factors, faces, starts, errors
    matrix, variance = reciprocal(matrix, variance, areas)
    if len(covered):
        kept = np.setdiff1d(np.arange(len(areas)), covered.faces)
        sizes = np.diff(np.append(covered.starts, len(covered.by)))
        rows, columns = (
            np.concatenate(of) for of in ((kept, np.repeat(covered.faces, sizes)), (kept, covered.by))
        )
        shares = np.concatenate([np.ones(len(kept)), covered.shares])
        matrix = sparse((shares, (rows, columns)), shape=shape) @ matrix
        variance = sparse((shares**2, (rows, columns)), shape=shape) @ variance
    count = (matrix.nnz + len(areas)) // 2
    dropped = int(np.count_nonzero(areas == 0))
    closed = np.zeros(len(areas), np.bool_)
    return ViewFactors(matrix, areas, "face", 0, 0, count, sent, dropped, variance, closed)


def _sparse() -> Any:
    try:
        from scipy.sparse import csr_array
    except ImportError as missing:
        raise ImportError("sparse view factors need scipy: pip install 'raywright[sparse]'") from missing
    return csr_array


def _of_shapes(faces: ViewFactors, covered: Covered, first: NDArray[np.int64]) -> ViewFactors:
    """Add up the faces of each shape, weighted by area."""
    count = len(first) - 1
    of = np.repeat(np.arange(count), np.diff(first))
    areas = np.bincount(of, faces.areas, count).astype(np.float64, copy=False)
    # A shape all of whose faces coincide with others has their row, by their areas.
    weights = faces.areas.copy()
    if len(covered):
        weights[covered.faces] = np.where(areas[of[covered.faces]] > 0, 0.0, covered.means(faces.areas))
    whole = np.bincount(of, weights, count)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.nan_to_num(weights / whole[of])
    counts = faces.closed, faces.hidden, faces.sampled, faces.rays, faces.dropped
    if isinstance(faces._variance, tuple):
        used = np.flatnonzero(np.diff(first))
        from_faces = np.add.reduceat(faces.matrix, first[used], axis=1) * shares[:, None]
        matrix = np.zeros((count, count))
        matrix[np.ix_(used, used)] = np.add.reduceat(from_faces, first[used], axis=0)
        rows, columns, values = faces._variance
        cells = of[rows] * count + of[columns]
        summed = np.bincount(cells, values * shares[rows] ** 2, count * count).astype(np.float64)
        summed = summed.reshape(count, count)
    else:
        sparse = _sparse()
        ends = np.arange(len(of) + 1)
        columns = sparse((np.ones(len(of)), of, ends), shape=(len(of), count))
        seen: Any = faces.matrix
        matrix = (columns.T @ (seen.multiply(shares[:, None]).tocsr() @ columns)).toarray()
        summed = (columns.T @ (faces._variance.multiply(shares[:, None] ** 2).tocsr() @ columns)).toarray()
    # Within a shape, both entries of a pair are one estimate, with one error.
    summed[np.diag_indices(count)] *= 2.0
    where = np.nonzero(summed)
    closed = np.ones(count, np.bool_)
    np.logical_and.at(closed, of[faces.areas > 0], faces._closed[faces.areas > 0])
    variance = *where, summed[where]
    return ViewFactors(matrix, areas, "shape", *counts, variance, closed)
