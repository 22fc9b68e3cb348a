"""The torus."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, positive, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape, direction


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Torus(Shape):
    """All points at one distance from a circle: a ring, or a horn.

    No root of its quartic is missed: critical points isolate the roots, with 32 digits. A line that misses
    the tube by less than 1e-28 of the major radius touches it.

    Parameters
    ----------
    center : 3 floats
        Center of the circle.
    axis : 3 floats
        Axis, at right angles to the circle's plane; of any length but 0.
    major_radius, minor_radius : float
        The circle's radius and the distance from it, each from 1e-140 to 1e140. The minor one is at most the
        major one; where they are equal, the surface touches itself in the center.
    transform : (4, 4) array, optional
        An affine matrix that acts on column vectors (x, y, z, 1), from the shape's own space to the world.
        Rays are transformed to the shape's own space and rounded there once.
    material : Material, optional
        Material of the surface; ``Diffuse()`` if not given.
    emission : float, 3 floats, Texture or Emission, optional
        Radiance that the outer side emits, in W·sr⁻¹·m⁻²; None, the default, for a shape without emission.
    name : str, optional
        Name that `Hits.names` returns.

    Raises
    ------
    ValueError
        If a radius is out of its range, the minor one the larger, so that the surface would pass through
        itself, the axis has no length, or a number is not finite.
        If the transform is not a finite affine (4, 4) matrix, or has no inverse.
    TypeError
        If an argument has another type.

    See Also
    --------
    Implicit : Other surfaces.

    Notes
    -----
    ``u`` is the angle about the axis, in turns; ``v`` that about the tube, from the outermost circle towards
    where the axis points. A tangent ray is a hit, but not a crossing.

    Examples
    --------
    >>> ring = rw.Torus(major_radius=2, minor_radius=0.5)
    >>> round(ring.area / np.pi**2, 9)
    4.0
    >>> rw.Scene(ring).intersect_all([5, 0, 0], [-1, 0, 0]).t.round(9).tolist()
    [2.5, 3.5, 6.5, 7.5]
    """

    center: Triple
    axis: Triple
    major_radius: float
    minor_radius: float

    def __init__(
        self,
        center: ArrayLike = (0.0, 0.0, 0.0),
        axis: ArrayLike = (0.0, 0.0, 1.0),
        major_radius: float = 1.0,
        minor_radius: float = 0.25,
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        radii = positive("major_radius", major_radius), positive("minor_radius", minor_radius)
        for name, radius in zip(("major_radius", "minor_radius"), radii, strict=True):
            if not 1e-140 <= radius <= 1e140:
                raise ValueError(f"{name} must be between 1e-140 and 1e140, got {radius}")
        if radii[1] > radii[0]:
            raise ValueError(
                f"minor_radius must be at most major_radius = {radii[0]}, got {radii[1]}: "
                "the surface would pass through itself"
            )
        self._set(
            transform,
            material,
            emission,
            name,
            center=triple("center", center),
            axis=direction("axis", axis),
            major_radius=radii[0],
            minor_radius=radii[1],
        )
