"""Rough matt surfaces."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Number, Texture, Value, scalar, value
from .material import Material


@dataclass(frozen=True, init=False)
class OrenNayar(Material):
    """A surface of matt facets, brighter towards the light: clay, plaster, the moon.

    The model of Oren and Nayar (1994) in a form that conserves energy (Portsmouth, Kutz and Hill, 2024). Both
    sides reflect.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        Share of the light that a facet reflects, in [0, 1].
    roughness : float or Texture
        Roughness from 0, Lambert's law, to 1. It is not a GGX alpha.

    Raises
    ------
    ValueError
        If a number is outside [0, 1] or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    Diffuse : Lambert's law.

    Examples
    --------
    >>> clay = rw.materials.OrenNayar((0.6, 0.4, 0.3), roughness=0.8)
    >>> clay.roughness
    0.8
    """

    reflectance: Value
    roughness: Number

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 0.5,
        roughness: float | Texture = 0.5,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
            roughness=scalar("roughness", roughness, most=1.0),
        )
