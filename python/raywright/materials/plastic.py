"""Plastic, glaze, varnish."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .material import Material, Rough, number_from, rough


@dataclass(frozen=True, init=False)
class Plastic(Material):
    """Something matt under a clear coat, smooth or rough; both sides are alike.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        Share of the light that reaches what is under the coat and leaves it again, in [0, 1].
    ior : float
        The coat's index of refraction, at least 1.
    roughness : float or Texture, optional
        How rough it is, from 0, smooth, to 1. Its square is the alpha of the GGX distribution, as in glTF. 0
        if not given.
    alpha : float or Texture, optional
        That alpha itself, in place of `roughness`.

    Raises
    ------
    ValueError
        If a share or a roughness is outside [0, 1], or `ior` is below 1.
    TypeError
        If something is not of the kinds above.
    """

    reflectance: Value
    ior: float
    roughness: Rough | None
    alpha: Rough | None

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 0.5,
        ior: float = 1.5,
        roughness: Any = None,
        alpha: Any = None,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
            ior=number_from("ior", ior, 1.0),
            **rough(roughness, alpha, pair=False),
        )
