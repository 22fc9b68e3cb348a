"""Plastic, glaze, varnish."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .dispersion import one_index
from .material import Material, Rough, facets, number_from, rough


@dataclass(frozen=True, init=False)
class Plastic(Material):
    """Something matt under a clear coat, smooth or rough; both sides are alike.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        Reflectance of the base under the coat, in [0, 1].
    ior : float
        The coat's index of refraction, at least 1.
    roughness : float or Texture, optional
        Roughness from 0, smooth, to 1. Its square is the alpha of its facets' distribution, as in glTF. 0 if
        not given.
    alpha : float or Texture, optional
        Alpha itself, in place of `roughness`.
    distribution : {"ggx", "beckmann"}
        Distribution of facet slopes: "ggx" with long tails (Walter et al., "Microfacet Models for Refraction
        through Rough Surfaces", 2007), or "beckmann", normal (Beckmann and Spizzichino, 1963), which makes
        highlights without a glow around them.
    multiple_scattering : bool
        True to include multiple scattering between facets. If not, that light is lost, so that a surface is
        the darker the rougher it is, and masking and shadowing are independent: the model of Walter et al.,
        which many renderers use.

    Raises
    ------
    ValueError
        If a share or a roughness is outside [0, 1], `ior` is below 1, or there is no such distribution.
    TypeError
        If something is not of the kinds above.

    See Also
    --------
    Diffuse : Without a coat.
    Principled : More parameters.

    Examples
    --------
    >>> ball = rw.Plastic((0.7, 0.1, 0.1), ior=1.5, roughness=0.2)
    >>> ball.reflectance
    (0.7, 0.1, 0.1)
    """

    reflectance: Value
    ior: float
    roughness: Rough | None
    alpha: Rough | None
    distribution: str
    multiple_scattering: bool

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 0.5,
        ior: float = 1.5,
        roughness: Any = None,
        alpha: Any = None,
        *,
        distribution: str = "ggx",
        multiple_scattering: bool = True,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
            ior=number_from("ior", one_index(ior, "what has been under a coat has lost its direction"), 1.0),
            **rough(roughness, alpha, pair=False),
            **facets(distribution, multiple_scattering),
        )
