"""Phong's model."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Number, Texture, Value, scalar, value
from .material import Material, shares


@dataclass(frozen=True, init=False)
class Phong(Material):
    """A matt surface with highlights about the mirror direction, on both sides.

    Phong's model (1975), in the form that conserves energy (Lafortune and Willems, 1994).

    Parameters
    ----------
    diffuse : float, 3 floats or Texture
        Share of the light that is reflected diffusely, in [0, 1].
    specular : float, 3 floats or Texture
        Share that makes highlights, in [0, 1]. Numbers must add up to at most 1 with `diffuse`; where
        textures do not, highlights leave the rest to what is diffuse.
    exponent : float or Texture
        How sharp highlights are, at least 0: the power of a cosine.
    ambient : float, 3 floats or Texture, optional
        Share of ambient light that is reflected, for integrators that know of it; `diffuse` if not given.

    Raises
    ------
    ValueError
        If a number is out of range, or the two shares add up to more than 1.
    TypeError
        If something is not of the kinds above.
    """

    diffuse: Value
    specular: Value
    exponent: Number
    ambient: Value

    def __init__(
        self,
        diffuse: ArrayLike | Texture = 0.5,
        specular: ArrayLike | Texture = 0.25,
        exponent: "float | Texture" = 32.0,
        ambient: "ArrayLike | Texture | None" = None,
    ) -> None:
        matt, shiny = shares(diffuse, specular)
        self._set(
            diffuse=matt,
            specular=shiny,
            exponent=scalar("exponent", exponent),
            ambient=matt if ambient is None else value("ambient", ambient),
        )
