"""Cells of two kinds in turn."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple
from .texture import Texture, Value, either, value
from .transform import Transform, UvTransform, placed


@dataclass(frozen=True, init=False)
class Checker(Texture):
    """Unit squares, or cubes, of two kinds in turn. Detail finer than a pixel is averaged.

    Parameters
    ----------
    a, b : float, 3 floats or Texture
        Values of the cells; the one at the lower left is `a`.
    transform : UvTransform, ObjectTransform or float, optional
        Map to the texture: squares in texture coordinates, or cubes in the space of the shape. A number is
        how many squares there are to a unit of texture coordinates.

    Raises
    ------
    ValueError
        If a number is not finite.
    TypeError
        If something is not of the kinds above.

    See Also
    --------
    Stripes : Stripes.

    Notes
    -----
    A flat surface that lies exactly between two layers of cubes shows one or the other as rounding has it:
    an offset of the transform puts it within one.

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
        """The least and the greatest that it may be, in red, green and blue."""
        return either(self.a, self.b)
