"""The base class of shapes that are not meshes."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import matrix_trouble, shape_area, shape_bounds
from ..arrays import Triple, frozen, label, real_array, triple
from ..descriptions import restored, state
from ..lights.emission import EmissionLike, Emitted
from ..lights.emission import emission as checked_emission
from ..materials import Diffuse, Material


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Shape:
    """A shape with a transform, a material and an emission. Its subclasses give the geometry.

    Shapes compare, hash, print and pickle by their parameters. The transform is kept as a read-only copy.
    """

    transform: NDArray[np.float64] | None
    material: Material
    emission: Emitted | None
    name: str | None

    def _set(
        self,
        transform: ArrayLike | None,
        material: Material | None,
        emission: EmissionLike | None,
        name: str | None,
        **parameters: Any,
    ) -> None:
        """Store the parameters and the checked attributes of every shape."""
        if material is None:
            material = Diffuse()
        elif not isinstance(material, Material):
            raise TypeError(f"material must be a raywright material, got {type(material).__name__}")
        values = {
            **parameters,
            "transform": None if transform is None else affine("transform", transform),
            "material": material,
            "emission": checked_emission(emission),
            "name": label("name", name),
        }
        for name, kept in values.items():
            object.__setattr__(self, name, kept)

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Least and greatest corner of the transformed shape, (2, 3) float64, rounded outwards.

        Tight to a few units in the last place. Infinite along an axis where the shape is.
        """
        return np.array(shape_bounds(self))

    @property
    def area(self) -> float:
        """Area of the transformed shape's surface; infinite where it is.

        A closed form or, of a cylinder, a cone or a paraboloid that a transform stretches unevenly, a sum
        that is right to about 1e-9 of itself.
        """
        return shape_area(self)

    def _values(self) -> tuple[Any, ...]:
        return tuple(
            part.tobytes() if isinstance(part, np.ndarray) else part
            for part in (getattr(self, field.name) for field in fields(self))
        )

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self) or not isinstance(other, Shape):
            return NotImplemented
        return self._values() == other._values()

    def __hash__(self) -> int:
        return hash((type(self), self._values()))

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (type(self), state(self))

    def __repr__(self) -> str:
        parts = [
            f"{field.name}={part.tolist() if isinstance(part, np.ndarray) else part!r}"
            for field in sorted(fields(self), key=lambda field: field.name in _COMMON)
            if (part := getattr(self, field.name)) is not None
        ]
        return f"{type(self).__name__}({', '.join(parts)})"


_COMMON = ("transform", "material", "emission", "name")


def affine(name: str, given: ArrayLike) -> NDArray[np.float64]:
    """Return a read-only copy of a finite affine (4, 4) matrix that has an inverse.

    Raises
    ------
    ValueError
        If the matrix has another shape, is not finite, is not affine, or is singular (the error gives the
        determinant).
    """
    matrix = frozen(real_array(name, given).astype(np.float64))
    if matrix.shape != (4, 4):
        raise ValueError(f"{name} must have shape (4, 4), got {matrix.shape}")
    if not np.isfinite(matrix).all():
        row, column = np.argwhere(~np.isfinite(matrix))[0]
        raise ValueError(f"{name} must be finite, got {matrix[row, column]} in row {row}, column {column}")
    # -0.0 and 0.0 transform alike, and must compare equal.
    matrix = frozen(matrix + 0.0)
    if not np.array_equal(matrix[3], (0, 0, 0, 1)):
        raise ValueError(
            f"{name} must be affine, with (0, 0, 0, 1) as its last row, got {matrix[3].tolist()}"
        )
    trouble = matrix_trouble(matrix.tolist())
    if trouble is not None:
        raise ValueError(f"{name} must have an inverse, but {trouble}")
    return matrix


def segment(names: tuple[str, str], base: ArrayLike, tip: ArrayLike) -> tuple[Triple, Triple]:
    """Return two points that differ."""
    a, b = triple(names[0], base), triple(names[1], tip)
    if a == b:
        raise ValueError(f"{names[0]} and {names[1]} must differ for an axis between them, both are {a}")
    return a, b


def direction(name: str, given: ArrayLike) -> Triple:
    """Return a vector that has a length."""
    vector = triple(name, given)
    if vector == (0, 0, 0):
        raise ValueError(f"{name} must not be zero, got {vector}")
    return vector


def switch(name: str, given: bool) -> bool:
    """Return a bool."""
    if not isinstance(given, bool | np.bool_):
        raise TypeError(f"{name} must be True or False, got {given!r}")
    return bool(given)
