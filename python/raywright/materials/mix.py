"""Two materials at once."""

from __future__ import annotations

from dataclasses import dataclass

from ..textures.texture import Number, Texture, scalar
from .material import Material, material


@dataclass(frozen=True, init=False)
class Mix(Material):
    """A blend of two materials by share.

    The interior is that of the first material with one.

    Parameters
    ----------
    a, b : Material
        The two materials.
    amount : float or Texture
        Share of `b`, in [0, 1].

    Raises
    ------
    ValueError
        If `amount` is outside [0, 1].
    TypeError
        If an argument has another type.

    See Also
    --------
    TwoSided : One material on each side.
    Mask : Holes.

    Examples
    --------
    >>> rust = rw.Mix(rw.Conductor("iron"), rw.Diffuse((0.4, 0.2, 0.1)), amount=rw.textures.FBm())
    >>> type(rust.a).__name__
    'Conductor'
    """

    a: Material
    b: Material
    amount: Number

    def __init__(
        self,
        a: Material,
        b: Material,
        amount: float | Texture = 0.5,
    ) -> None:
        self._set(
            a=material("a", a),
            b=material("b", b),
            amount=scalar("amount", amount, most=1.0),
        )
