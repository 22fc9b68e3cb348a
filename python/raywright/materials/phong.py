"""Phong's model."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Number, Texture, Value
from .material import Material, highlights


@dataclass(frozen=True, init=False)
class Phong(Material):
    """A matt surface with highlights around the mirror direction, on both sides.

    Phong's model (1975), in the form that conserves energy (Lafortune and Willems, 1994).

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
    BlinnPhong : Highlights by the half vector.

    Examples
    --------
    >>> shiny = rw.materials.Phong(diffuse=0.4, specular=0.4, exponent=100)
    >>> rw.materials.Phong(diffuse=0.8, specular=0.4)
    Traceback (most recent call last):
        ...
    ValueError: diffuse and specular must add up to at most 1, got 1.2
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
