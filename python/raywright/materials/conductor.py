"""Metals."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from .. import _core
from ..textures.texture import Texture, Value, value
from .material import Material, Rough, facets, rough


@dataclass(frozen=True, init=False)
class Conductor(Material):
    """A metal, smooth or rough, which may be brushed: rougher along one direction than across.

    Light that facets throw on facets is made up for (Kulla and Conty, 2017). Both sides reflect.

    Parameters
    ----------
    metal : str, optional
        Its name or symbol, as ``"gold"`` or ``"Au"``; `metals` tells all that are known.
    eta, k : float, 3 floats or Texture, optional
        Real and imaginary part of its index of refraction, in place of a name: above 0, and at least 0.
    roughness : float, Texture, or a pair of them, optional
        How rough it is, from 0, smooth, to 1; along u and along v if they are two. Its square is the alpha of
        its facets' distribution, as in glTF. 0 if not given.
    alpha : float, Texture, or a pair of them, optional
        That alpha itself, in place of `roughness`.
    distribution : {"ggx", "beckmann"}
        How the slopes of its facets are spread: with long tails (Walter et al., "Microfacet Models for
        Refraction through Rough Surfaces", 2007), or normally (Beckmann and Spizzichino, 1963), which makes
        highlights without a glow around them.
    multiple_scattering : bool
        Whether light that facets throw on each other goes on. If not, it is lost, so that a surface is the
        darker the rougher it is, and what is hidden from either side is independent of the other: the model
        of Walter et al., which many renderers have as it stands.

    Attributes
    ----------
    eta, k : tuple of 3 floats, or Texture
        The index of refraction, of a name too.

    Raises
    ------
    ValueError
        If the name is not known, there is neither a name nor both `eta` and `k`, a number is out of range, or there is
        no such distribution.
    TypeError
        If something is not of the kinds above.
    """

    eta: Value
    k: Value
    roughness: Rough | None
    alpha: Rough | None
    distribution: str
    multiple_scattering: bool

    def __init__(
        self,
        metal: str | None = None,
        *,
        eta: "ArrayLike | Texture | None" = None,
        k: "ArrayLike | Texture | None" = None,
        roughness: Any = None,
        alpha: Any = None,
        distribution: str = "ggx",
        multiple_scattering: bool = True,
    ) -> None:
        if metal is not None:
            if eta is not None or k is not None:
                raise ValueError("only one of metal and (eta, k) can be given")
            if not isinstance(metal, str):
                raise TypeError(f"metal must be a name, got {type(metal).__name__}")
            eta, k = _index(metal)
        elif eta is None or k is None:
            raise ValueError("metal must be given, or both eta and k")
        self._set(
            eta=value("eta", eta, above=True),
            k=value("k", k),
            **rough(roughness, alpha),
            **facets(distribution, multiple_scattering),
        )


def metals() -> tuple[str, ...]:
    """Return the names of the metals that `Conductor` knows."""
    return tuple(name for _, name, _, _ in _core.metals())


def _index(metal: str) -> tuple[tuple[float, ...], tuple[float, ...]]:
    wanted = metal.casefold()
    for symbol, name, eta, k in _core.metals():
        if wanted in (symbol.casefold(), name):
            return eta, k
    raise ValueError(f"metal must be one of {', '.join(metals())}, got {metal!r}")
