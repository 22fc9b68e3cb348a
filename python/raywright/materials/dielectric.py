"""Glass, water, diamond."""

from dataclasses import dataclass
from typing import Any

from ..arrays import integer, positive
from .material import Material, Rough, rough


@dataclass(frozen=True, init=False)
class Dielectric(Material):
    """The surface of something clear, smooth or rough, which reflects and refracts.

    Its normals point out of what is clear; whatever it encloses is filled.

    Parameters
    ----------
    ior : float
        The index of refraction within, above 0: 1.5 for glass, 1.33 for water, 2.42 for diamond.
    roughness : float or Texture, optional
        How rough it is, from 0, smooth, to 1. Its square is the alpha of the GGX distribution, as in glTF. 0
        if not given.
    alpha : float or Texture, optional
        That alpha itself, in place of `roughness`.
    priority : int
        Where several such solids overlap, the one of the greatest priority is there (Schmidt and Budge,
        "Simple Nested Dielectrics in Ray Traced Images", 2002): a drink may reach into its glass.

    Raises
    ------
    ValueError
        If `ior` is not greater than 0, or a roughness is outside [0, 1].
    TypeError
        If something is not of the kinds above.
    """

    ior: float
    roughness: Rough | None
    alpha: Rough | None
    priority: int

    def __init__(
        self,
        ior: float = 1.5,
        roughness: Any = None,
        alpha: Any = None,
        priority: int = 0,
    ) -> None:
        self._set(
            ior=positive("ior", ior),
            **rough(roughness, alpha, pair=False),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
        )
