"""Metals."""

from dataclasses import dataclass
from typing import Any

from numpy.typing import ArrayLike

from .. import _core
from ..textures.texture import Texture, Value, value
from .material import Material, Rough, rough


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
        the GGX distribution, as in glTF. 0 if not given.
    alpha : float, Texture, or a pair of them, optional
        That alpha itself, in place of `roughness`.

    Attributes
    ----------
    eta, k : tuple of 3 floats, or Texture
        The index of refraction, of a name too.

    Raises
    ------
    ValueError
        If the name is not known, there is neither a name nor both `eta` and `k`, or a number is out of range.
    TypeError
        If something is not of the kinds above.
    """

    eta: Value
    k: Value
    roughness: Rough | None
    alpha: Rough | None

    def __init__(
        self,
        metal: str | None = None,
        *,
        eta: "ArrayLike | Texture | None" = None,
        k: "ArrayLike | Texture | None" = None,
        roughness: Any = None,
        alpha: Any = None,
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
