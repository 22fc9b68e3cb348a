"""Glass, water, diamond."""

from dataclasses import dataclass
from typing import Any

from ..arrays import integer, positive
from ..media.medium import Medium
from ..media.medium import medium as checked
from .material import Material, Rough, facets, rough


@dataclass(frozen=True, init=False)
class Dielectric(Material):
    """The surface of something clear, smooth or rough, which reflects and refracts.

    Its normals point out of what is clear; whatever it encloses is filled.

    Parameters
    ----------
    ior : float
        The index of refraction within, above 0: 1.5 for glass, 1.33 for water, 2.42 for diamond.
    roughness : float or Texture, optional
        How rough it is, from 0, smooth, to 1. Its square is the alpha of its facets' distribution, as in
        glTF. 0 if not given.
    alpha : float or Texture, optional
        That alpha itself, in place of `roughness`.
    priority : int
        Where several such solids overlap, the one of the greatest priority is there (Schmidt and Budge,
        "Simple Nested Dielectrics in Ray Traced Images", 2002): a drink may reach into its glass.
    distribution : {"ggx", "beckmann"}
        How the slopes of its facets are spread: with long tails (Walter et al., "Microfacet Models for
        Refraction through Rough Surfaces", 2007), or normally (Beckmann and Spizzichino, 1963), which makes
        highlights without a glow around them.
    multiple_scattering : bool
        Whether light that facets throw on each other goes on. If not, it is lost, so that a surface is the
        darker the rougher it is, and what is hidden from either side is independent of the other: the model
        of Walter et al., which many renderers have as it stands.

    interior : Homogeneous or GridMedium, optional
        What is within, if it is not clear: what dims and scatters light there.

    Raises
    ------
    ValueError
        If `ior` is not greater than 0, a roughness is outside [0, 1], or there is no such distribution.
    TypeError
        If something is not of the kinds above.
    """

    ior: float
    roughness: Rough | None
    alpha: Rough | None
    priority: int
    distribution: str
    multiple_scattering: bool
    interior: Medium | None

    def __init__(
        self,
        ior: float = 1.5,
        roughness: Any = None,
        alpha: Any = None,
        priority: int = 0,
        *,
        distribution: str = "ggx",
        multiple_scattering: bool = True,
        interior: Medium | None = None,
    ) -> None:
        self._set(
            ior=positive("ior", ior),
            **rough(roughness, alpha, pair=False),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
            **facets(distribution, multiple_scattering),
            interior=checked("interior", interior),
        )
