"""Where it is measured: points on surfaces, and rays that leave them."""

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import last_axis
from ..query.hits import SurfacePoints
from ..scene.instance import Shapes
from ..scene.scene import Scene

SceneLike: TypeAlias = Scene | Shapes
Floats: TypeAlias = NDArray[np.float64]

# How far from a surface rays start, as a part of the scene's size, where no more is known of the points:
# farther than vertices are moved by being rounded to float32.
_OFFSET = 1e-6


def scene_of(scene: SceneLike) -> Scene:
    """Return the scene, or one of the shapes."""
    return scene if isinstance(scene, Scene) else Scene(scene)


def vectors(name: str, given: ArrayLike) -> Floats:
    """Return finite vectors, (..., 3) float64."""
    array = np.asarray(last_axis(name, given, 3), np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{name} must be finite, and has NaN or infinity")
    return array


def units(name: str, given: ArrayLike) -> Floats:
    """Return the unit vectors of given directions, (..., 3) float64."""
    array = vectors(name, given)
    # Divided by the largest coordinate first, so that no square overflows.
    size = np.abs(array).max(axis=-1, keepdims=True, initial=0.0)
    if not (size > 0).all():
        raise ValueError(f"{name} must have a length, and one is 0")
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
        Leading shape of what was given.
    """

    origins: Floats
    normals: Floats
    shape: tuple[int, ...]

    def __len__(self) -> int:
        return len(self.origins)


def places(
    scene: Scene, points: SurfacePoints | ArrayLike, normals: ArrayLike | None, offset: float | None
) -> Places:
    """Check points and normals, and tell where rays start that leave them.

    Raises
    ------
    ValueError
        If shapes do not fit, a number is not finite, a normal has no length, or there is none where points
        are numbers.
    """
    if isinstance(points, SurfacePoints):
        return _of_surface(points, normals)
    if normals is None:
        raise ValueError("normals must be given, unless points are what rays have hit or closest points")
    starts, ways = vectors("points", points), units("normals", normals)
    lead = common({"points": starts.shape[:-1], "normals": ways.shape[:-1]})
    starts, ways = np.broadcast_to(starts, (*lead, 3)), np.broadcast_to(ways, (*lead, 3))
    away = _OFFSET * size_of(scene, starts) if offset is None else float(offset)
    if not (np.isfinite(away) and away >= 0):
        raise ValueError(f"offset must be finite and at least 0, got {offset}")
    return Places((starts + away * ways).reshape(-1, 3), ways.reshape(-1, 3), lead)


def _of_surface(points: SurfacePoints, normals: ArrayLike | None) -> Places:
    lead = points.primitive.shape
    ways = points.normal if normals is None else np.broadcast_to(units("normals", normals), (*lead, 3))
    starts = points.leave(np.where(np.isfinite(ways), ways, 1.0)).origins
    return Places(starts.reshape(-1, 3), ways.reshape(-1, 3), lead)


def size_of(scene: Scene, points: Floats) -> float:
    """Return the length of the diagonal of the box around a scene and points."""
    bounds = scene.bounds
    ends = [points.reshape(-1, 3)] + ([] if bounds is None else [bounds])
    every = np.concatenate(ends)
    return float(np.linalg.norm(every.max(axis=0) - every.min(axis=0))) if len(every) else 0.0


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


def sealed(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, which can be read only from now on."""
    array.setflags(write=False)
    return array
