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
    """A diffuse base under a smooth or rough clear coat; both sides are alike.

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
        Alpha, in place of `roughness`.
    distribution : {"ggx", "beckmann"}
        Distribution of facet slopes: "ggx" with long tails (Walter et al., "Microfacet Models for Refraction
        through Rough Surfaces", 2007), or "beckmann", a normal distribution (Beckmann and Spizzichino 1963),
        whose highlights have no glow around them.
    multiple_scattering : bool
        True to include multiple scattering between facets. False omits that light, so rougher surfaces are
        darker, and treats masking and shadowing as independent: the model of Walter et al., which many
        renderers use.

    Raises
    ------
    ValueError
        If a share or a roughness is outside [0, 1], `ior` is below 1, or there is no such distribution.
    TypeError
        If an argument has another type.

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
