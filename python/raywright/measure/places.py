"""Where it is measured: points on surfaces, and rays that leave them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import last_axis
from ..query.closest_points import ClosestPoints
from ..query.surface_points import SurfacePoints
from ..scene.scene import Scene, SceneLike, as_scene
from ..shapes.mesh import Mesh

Floats: TypeAlias = NDArray[np.float64]

# Rays start at this multiple of the error of their point off the surface, as in `Hits.spawn_rays`.
_SAFETY = 8.0
# Tolerances for points on a surface, in multiples of that error: 2**-40 of the largest coordinate of the
# face, or 2**-22 if vertices were rounded to float32. Points in float32 add 2**-22 of their own coordinates.
_DOUBLE, _SINGLE, _NARROW = 2.0**9, 2.0**27, 2.0**-22
# A normal steeper to the nearest face belongs to another face, across an edge.
_STEEP = 0.125
# Search radius for the surface below a point, relative to the largest coordinate.
_REACH = 2.0**-10


def scene_of(scene: SceneLike) -> Scene:
    """Return the scene, or one of the shapes, with corners welded that rounding has moved."""
    return as_scene(scene).welded()


def vectors(name: str, given: ArrayLike) -> Floats:
    """Return finite vectors, (..., 3) float64."""
    array = np.asarray(last_axis(name, given, 3), np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, got NaN or infinity")
    return array


def units(name: str, given: ArrayLike) -> Floats:
    """Return the unit vectors of given directions, (..., 3) float64."""
    array = vectors(name, given)
    # Divided by the largest coordinate first, so that no square overflows.
    size = np.abs(array).max(axis=-1, keepdims=True, initial=0.0)
    if not (size > 0).all():
        raise ValueError(f"{name} must not contain zero vectors")
    scaled: Floats = array / size
    unit: Floats = scaled / np.linalg.norm(scaled, axis=-1, keepdims=True)
    return unit


def unit(name: str, given: ArrayLike) -> Floats:
    """Return the unit vector of one direction."""
    way = units(name, given)
    if way.shape != (3,):
        raise ValueError(f"{name} must be 3 numbers, got shape {way.shape}")
    return way


@dataclass(frozen=True)
class Places:
    """Points where something is measured, in a row, and which way is up there.

    Attributes
    ----------
    origins : (N, 3) float64
        Off the surface, on the side of the normals; NaN where there is no point.
    normals : (N, 3) float64
        Unit vectors.
    shape : tuple of int
        Leading shape of the points.
    """

    origins: Floats
    normals: Floats
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.origins)


def places(
    scene: Scene,
    points: SurfacePoints | ArrayLike | None,
    normals: ArrayLike | None,
    offset: float | None,
    threads: int | None = None,
) -> Places:
    """Check points and normals, and find the origins of rays that leave them; all faces' middles if None.

    Raises
    ------
    ValueError
        If shapes do not fit, a number is not finite, a normal has no length, or there is none where points
        are numbers.
    """
    if points is None:
        points = middles(scene)
    if isinstance(points, SurfacePoints):
        return _of_surface(points, normals)
    if normals is None:
        raise ValueError("normals must be given, unless points are hits or closest points")
    starts, ways = vectors("points", points), units("normals", normals)
    lead = common({"points": starts.shape[:-1], "normals": ways.shape[:-1]})
    ways = np.broadcast_to(ways, (*lead, 3))
    if offset is None:
        starts = touching(scene, points, threads).spread(starts.shape[:-1], lead).off(starts, ways)
    elif np.isfinite(away := float(offset)) and away >= 0:
        starts = starts + away * ways
    else:
        raise ValueError(f"offset must be finite and at least 0, got {offset}")
    return Places(starts.reshape(-1, 3), ways.reshape(-1, 3), lead)


def middles(scene: Scene) -> ClosestPoints:
    """Return the middle of every face of all shapes, in order, as points of the surface.

    Raises
    ------
    ValueError
        If a shape is not a mesh.
    """
    for i, shape in enumerate(scene.shapes):
        if not isinstance(shape, Mesh):
            raise ValueError(f"points must be given: shape {i} is a {type(shape).__name__}, not a mesh")
    counts = [len(shape.faces) for shape in scene.shapes if isinstance(shape, Mesh)]
    shape_id = np.repeat(np.arange(len(counts), dtype=np.int32), counts)
    primitive_id = np.concatenate(
        [np.arange(0, dtype=np.int32), *(np.arange(n, dtype=np.int32) for n in counts)]
    )
    uv = np.full((len(primitive_id), 2), 1 / 3)
    core = scene._compiled()
    position = core.positions(shape_id, primitive_id, uv)
    return ClosestPoints(np.zeros(len(primitive_id)), position, shape_id, primitive_id, uv, None, core)


@dataclass(frozen=True)
class Touching:
    """Surfaces at the points, for those that lie on one to within rounding; all is 0 for the others.

    Attributes
    ----------
    error : (...) float64
        Bound on how far each coordinate of a surface's point is off.
    distance : (...) float64
        From the point to the surface.
    away : (..., 3) float64
        From the nearest point of the surface to the point.
    normal : (..., 3) float64
        Of the surface; NaN if its face has no area.
    """

    error: Floats
    distance: Floats
    away: Floats
    normal: Floats

    def spread(self, shape: tuple[int, ...], lead: tuple[int, ...]) -> Touching:
        """Return the same of points of leading shape `shape`, broadcast to another."""
        numbers = (np.broadcast_to(part.reshape(shape), lead) for part in (self.error, self.distance))
        each = (np.broadcast_to(part.reshape(*shape, 3), (*lead, 3)) for part in (self.away, self.normal))
        return Touching(*numbers, *each)

    def lift(self, ways: Floats) -> tuple[Floats, Floats]:
        """Return unit normals on the side of directions, and how far points are below their safe height."""
        side = np.where((self.normal * ways).sum(axis=-1) < 0, -1.0, 1.0)
        normal: Floats = side[..., None] * self.normal
        return normal, np.maximum(0.0, _SAFETY * self.error - (normal * self.away).sum(axis=-1))

    def slack(self) -> Floats:
        """Return how far along rays that leave the points hits are still of the surface that they leave."""
        return _SAFETY / _STEEP * self.error + self.distance

    def beside(self, points: Floats, ways: Floats) -> Floats:
        """Return origins of rays along directions, as in `Hits.spawn_rays`."""
        normal, lift = self.lift(ways)
        starts: Floats = points + np.where((lift > 0)[..., None], lift[..., None] * normal, 0.0)
        return starts

    def off(self, points: Floats, ways: Floats) -> Floats:
        """Return where rays start that leave to the side of unit vectors: beyond errors, and no farther."""
        normal, lift = self.lift(ways)
        cosine = (normal * ways).sum(axis=-1)
        is_flat = cosine >= _STEEP
        along = np.where(is_flat, lift / np.where(is_flat, cosine, 1.0), self.slack())
        starts: Floats = points + along[..., None] * ways
        return starts


def touching(scene: Scene, points: ArrayLike, threads: int | None = None) -> Touching:
    """Find how points, as they were given, lie to the surfaces that they are meant to lie on, in a row.

    That depends on each point and the surface nearest to it alone, not on other points, nor on how large the
    scene is.
    """
    given = last_axis("points", points, 3)
    place = np.asarray(given, np.float64).reshape(-1, 3)
    core = scene._compiled()
    most = np.abs(place).max(axis=-1, initial=0.0)
    reach = (
        np.inf
        if core.curved
        else _REACH * (most + np.abs(np.zeros(1) if core.bounds is None else core.bounds).max())
    )
    near = scene.closest_point(place, max_distance=reach, threads=threads)
    error = np.where(near.found, near._error, 0.0)
    rounding = (_SINGLE if core.is_rounded else _DOUBLE) * error
    if given.dtype == np.float32:
        rounding = rounding + _NARROW * most
    is_on = near.found & (near.distance <= rounding)
    away = np.where(is_on[:, None], place - np.where(is_on[:, None], near.position, 0.0), 0.0)
    normal = np.where(is_on[:, None], near.normal, 0.0)
    return Touching(np.where(is_on, error, 0.0), np.where(is_on, near.distance, 0.0), away, normal)


def _of_surface(points: SurfacePoints, normals: ArrayLike | None) -> Places:
    lead = points.primitive_id.shape
    ways = points.normal if normals is None else np.broadcast_to(units("normals", normals), (*lead, 3))
    starts = points.spawn_rays(np.where(np.isfinite(ways), ways, 1.0)).origins
    return Places(starts.reshape(-1, 3), ways.reshape(-1, 3), lead)


def common(shapes: dict[str, tuple[int, ...]]) -> tuple[int, ...]:
    """Return the shape that leading shapes broadcast to.

    Raises
    ------
    ValueError
        If they do not.
    """
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        told = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"leading shapes do not broadcast: {told}") from None


def frames(normals: Floats) -> tuple[Floats, Floats]:
    """Return two unit vectors at right angles to each normal and each other.

    They depend on the normal without a branch but for its sign (Duff et al., "Building an Orthonormal Basis,
    Revisited", 2017).
    """
    x, y, z = np.moveaxis(normals, -1, 0)
    sign = np.copysign(1.0, z)
    a = -1.0 / (sign + z)
    b = x * y * a
    first = np.stack([1.0 + sign * x * x * a, sign * b, -sign * x], axis=-1)
    return first, np.stack([b, sign + y * y * a, -y], axis=-1)
