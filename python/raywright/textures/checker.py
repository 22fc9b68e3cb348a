"""Cells of two kinds in turn."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, value
from .transform import Transform, UvTransform, placed


@dataclass(frozen=True, init=False)
class Checker(Texture):
    """A checkerboard of unit squares, or cubes. Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values of the cells; the one at the lower left is `a`.
    transform : UvTransform, ObjectTransform or float, optional
        Map to the texture: squares in texture coordinates, or cubes in the space of the shape. A number is
        the number of squares per unit of texture coordinates.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    Stripes : Stripes.

    Notes
    -----
    On a flat surface exactly between two layers of cubes, rounding decides which layer shows; an offset in
    the transform avoids this.

    Examples
    --------
    >>> floor = rw.Plane(material=rw.Diffuse(rw.Checker(0.2, 0.8, transform=2)))
    >>> rays = rw.query.Rays(np.array([[0.1, 0.1, 1.0], [0.6, 0.1, 1]]), np.array([[0, 0, -1.0]] * 2),
    ... np.zeros(2))
    >>> rw.Scene(floor).interactions(rays).albedo[:, 0].round(6).tolist()
    [0.2, 0.8]
    """

    a: Value
    b: Value
    transform: Transform

    def __init__(
        self,
        a: ArrayLike | Texture = 0.2,
        b: ArrayLike | Texture = 0.8,
        transform: Transform | float | None = None,
    ) -> None:
        self._set(
            a=value("a", a, -float("inf")),
            b=value("b", b, -float("inf")),
            transform=placed(transform, UvTransform),
        )

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return either(self.a, self.b)
