"""Surfaces given by an expression."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from .._core import implicit_trouble
from ..arrays import Triple, triple
from ..lights.emission import EmissionLike
from ..materials import Material
from .shape import Shape


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Implicit(Shape):
    """All points of a box where an expression in x, y and z is zero; outside is where it is positive.

    The expression is compiled, not run by Python. Along a ray its zeros are isolated by interval arithmetic
    with outward rounding, so that none in the box is missed (Moore, "Interval Analysis", 1966; Mitchell,
    "Robust Ray Intersection with Interval Arithmetic", 1990).

    Parameters
    ----------
    expression : str
        Expression in Python's notation, with x, y, z, numbers, ``+ - * / **``, parentheses, pi, e, abs, sqrt,
        exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, pow, min and max. A power whose
        exponent is not an integer literal is defined for a base of at least 0.
    min, max : 3 floats
        The least and the greatest corner of the box. The surface is cut open where the box ends.
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
        If the expression does not parse or names something unknown (the error gives the column and the known
        names), or the box is not finite or has no volume. If the transform is not a finite affine (4, 4)
        matrix, or has no inverse.
    TypeError
        If the expression is not a string, or a number or a material is something else.

    See Also
    --------
    Torus, Ellipsoid

    Notes
    -----
    Values that float64 cannot tell from zero count as zero: two roots closer than rounding count as one
    tangent hit. A stretch of a ray along which the expression is zero is hit once, at its start. A pole or a
    jump is not a root. After some thousand intervals the roots found so far are returned, so no expression
    hangs.

    ``u`` and ``v`` are the position in the box along two axes: those that follow the axis nearest to the
    normal, in the order x, y, z, x. `area` is measured by many thousand lines, to about a thousandth.

    Examples
    --------
    >>> ball = rw.shapes.Implicit("x**2 + y**2 + z**2 - 1", min=(-2, -2, -2), max=(2, 2, 2))
    >>> rw.Scene(ball).intersect_all([0, 0, 5], [0, 0, -1]).t.round(9).tolist()
    [4.0, 6.0]
    """

    expression: str
    min: Triple
    max: Triple

    def __init__(
        self,
        expression: str,
        min: ArrayLike = (-1.0, -1.0, -1.0),
        max: ArrayLike = (1.0, 1.0, 1.0),
        *,
        transform: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        name: str | None = None,
    ) -> None:
        if not isinstance(expression, str):
            raise TypeError(f"expression must be a string, got {expression!r}")
        low, high = triple("min", min), triple("max", max)
        trouble = implicit_trouble(expression, low, high)
        if trouble is not None:
            raise ValueError(trouble)
        self._set(transform, material, emission, name, expression=expression, min=low, max=high)
