"""Blinn's form of Phong's model."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Number, Texture, Value
from .material import Material, highlights


@dataclass(frozen=True, init=False)
class BlinnPhong(Material):
    """A matt surface with highlights around the half vector of light and viewer.

    Blinn's model (1977), normalized so that `specular` is the share reflected at normal incidence. Both sides
    reflect.

    Parameters
    ----------
    diffuse : float, 3 floats or Texture
        Share of the light that is reflected diffusely, in [0, 1].
    specular : float, 3 floats or Texture
        Share that makes highlights, in [0, 1]. Numbers must add up to at most 1 with `diffuse`; if textures
        exceed it, the diffuse share is reduced.
    exponent : float or Texture
        Exponent of the cosine, at least 0: highlights get sharper with it.
    ambient : float, 3 floats or Texture, optional
        Share of ambient light that is reflected, for integrators with ambient light; `diffuse` if not given.

    Raises
    ------
    ValueError
        If a number is out of range, or the two shares add up to more than 1.
    TypeError
        If an argument has another type.

    See Also
    --------
    Phong : Highlights about the mirror direction.
    Plastic : A coat with facets.

    Examples
    --------
    >>> shiny = rw.materials.BlinnPhong(diffuse=(0.4, 0.1, 0.1), specular=0.3, exponent=50)
    >>> shiny.diffuse, shiny.exponent
    ((0.4, 0.1, 0.1), 50.0)
    """

    diffuse: Value
    specular: Value
    exponent: Number
    ambient: Value

    def __init__(
        self,
        diffuse: ArrayLike | Texture = 0.5,
        specular: ArrayLike | Texture = 0.25,
        exponent: float | Texture = 32.0,
        ambient: ArrayLike | Texture | None = None,
    ) -> None:
        self._set(**highlights(diffuse, specular, exponent, ambient))
