"""Faces in solid cones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import real_array, same, sealed
from .rays import Floats, ray_arguments, spread
from .tabular import Tabular

ConeArguments: TypeAlias = tuple[
    Floats,
    Floats,
    float | NDArray[np.float64],
    float | NDArray[np.float64],
    tuple[int, ...],
    int | None,
]


@dataclass(frozen=True, eq=False, repr=False)
class ConeFaces(Tabular):
    """Faces touched by each cone, in one list: by cone, then distance, then (shape_id, primitive_id).

    There are K faces for N cones in all. Those of cone i, with cones counted in C order, are from
    ``cone_splits[i]`` to ``cone_splits[i + 1]``. All arrays are read-only.

    Attributes
    ----------
    cone_splits : (N + 1,) int64
        Index of each cone's first face, and at the end the total number of faces.
    shape_id : (K,) int32
        Index in ``scene.shapes``.
    primitive_id : (K,) int32
        Face of that shape.
    distance : (K,) float64
        Distance from the apex to the nearest point of the face that is in the cone, in the scene's unit of
        length.
    shape : tuple of int
        Leading shape of the cones.

    See Also
    --------
    Scene.faces_in_cone : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
    >>> touches = scene.faces_in_cone([[0, 0, 4], [9, 9, 4]], [0, 0, -1], half_angle=5)
    >>> touches.cone_splits.tolist(), touches.count.tolist()
    ([0, 1, 1], [1, 0])
    """

    cone_splits: NDArray[np.int64]
    shape_id: NDArray[np.int32]
    primitive_id: NDArray[np.int32]
    distance: NDArray[np.float64]
    shape: tuple[int, ...]

    @cached_property
    def cone(self) -> NDArray[np.int64]:
        """Index of the cone of each touch, along the cones in C order: (K,) int64."""
        return sealed(np.repeat(np.arange(len(self.cone_splits) - 1), np.diff(self.cone_splits)))

    @cached_property
    def count(self) -> NDArray[np.int64]:
        """Number of faces that each cone touches: (...) int64."""
        return sealed(np.diff(self.cone_splits).reshape(self.shape))

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each face, with the index of its cone.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> scene = rw.Scene(rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]))
        >>> list(scene.faces_in_cone([0, 0, 4], [0, 0, -1], half_angle=5).to_dict())
        ['cone', 'shape_id', 'primitive_id', 'distance']
        """
        names = ("cone", "shape_id", "primitive_id", "distance")
        return {name: getattr(self, name) for name in names}

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ConeFaces):
            return NotImplemented
        names = ("cone_splits", "shape_id", "primitive_id", "distance")
        return self.shape == other.shape and all(same(getattr(self, n), getattr(other, n)) for n in names)

    __hash__ = None  # type: ignore[assignment]

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        return f"ConeFaces(shape={self.shape}, {len(self)} touches of {len(self.cone_splits) - 1} cones)"


class ConeCoverage(NamedTuple):
    """Covered share of solid cones.

    See Also
    --------
    Scene.cone_coverage : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere((0, 0, 2), radius=1))
    >>> seen = scene.cone_coverage([0, 0, 0], [0, 0, 1], half_angle=60)
    >>> round(seen.solid_angle.item() / (2 * np.pi), 6)
    0.133975
    """

    solid_angle: NDArray[np.float64]
    """Of what is covered, in steradians: (...) float64."""
    share: NDArray[np.float64]
    """The same over the cone's own, from 0 to 1: (...) float64."""


def cone_solid_angle(half_angle: float | NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the solid angle of cones of these half angles, in degrees, above 0.

    Raises
    ------
    ValueError
        If one is 0.
    """
    angles = np.asarray(half_angle)
    if not np.all(angles > 0):
        raise ValueError("half_angle must be above 0 for coverage, got 0")
    return np.asarray(4 * np.pi * np.sin(np.radians(angles) / 2) ** 2)


def cone_arguments(
    origins: ArrayLike,
    directions: ArrayLike,
    half_angle: ArrayLike,
    t_max: ArrayLike,
    threads: int | None,
) -> ConeArguments:
    """Return checked, broadcast arguments of cone queries for the core.

    Returns
    -------
    origins, directions, half_angle, t_max, shape, threads
        `shape` is the leading shape of the cones; each array has one row, or one for each cone.
    """
    angles = real_array("half_angle", half_angle).astype(np.float64, copy=False)
    wrong = ~((angles >= 0) & (angles < 90))
    if wrong.any():
        came = angles[wrong][0] if angles.ndim else angles
        raise ValueError(f"half_angle must be at least 0 and less than 90 degrees, got {came}")
    starts, ways, _, most, lead, threads, _ = ray_arguments(origins, directions, 0.0, t_max, threads)
    if not angles.ndim:
        starts, ways, most = _whole(starts, ways, most, lead)
        return starts, ways, float(angles), most, lead, threads
    try:
        shape = np.broadcast_shapes(lead, angles.shape)
    except ValueError:
        told = f"cones {lead}, half_angle {angles.shape}"
        raise ValueError(f"leading shapes do not broadcast: {told}") from None
    starts, ways, most = _whole(starts, ways, most, shape)
    return starts, ways, spread(angles, shape), most, shape, threads


def _whole(
    starts: Floats, ways: Floats, most: float | NDArray[np.float64], shape: tuple[int, ...]
) -> tuple[Floats, Floats, float | NDArray[np.float64]]:
    """Return apexes, axes and distances with one row, or one for each cone."""
    far = spread(most, shape) if isinstance(most, np.ndarray) else most
    return spread(starts, shape, (3,)), spread(ways, shape, (3,)), far
