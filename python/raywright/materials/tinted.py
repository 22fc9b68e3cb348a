"""Glass with a colour at its surface."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .dielectric import Dielectric
from .material import Material
from .thin_dielectric import ThinDielectric


@dataclass(frozen=True, init=False)
class Tinted(Material):
    """Glass or a pane with a colour at its surface: stained glass, a painted window, a slide.

    Of what goes through the surface a share is left, each time it does, and another of what it reflects.
    Unlike the `transmittance` of a `Dielectric`, which is of what is within and grows with the way there, it
    does not depend on how thick what is clear is, and may be a texture. Light that passes in and out of a
    solid crosses its surface twice; that through a pane once.

    Parameters
    ----------
    base : Dielectric or ThinDielectric
        What it is without its colour. What that encloses, how rough it is and its priority stay as they are;
        a pane must enclose nothing.
    transmittance : float, 3 floats, Spectrum or Texture
        The share that is left of what goes through, in [0, 1].
    reflectance : float, 3 floats, Spectrum or Texture
        The share that is left of what is reflected, in [0, 1].

    Raises
    ------
    ValueError
        If a share is outside [0, 1] or not finite, or a pane encloses something.
    TypeError
        If something is not of the kinds above.
    """

    base: Dielectric | ThinDielectric
    transmittance: Value
    reflectance: Value

    def __init__(
        self,
        base: Dielectric | ThinDielectric,
        transmittance: ArrayLike | Texture = 1.0,
        reflectance: ArrayLike | Texture = 1.0,
    ) -> None:
        if not isinstance(base, (Dielectric, ThinDielectric)):
            raise TypeError(f"base must be a Dielectric or a ThinDielectric, got {type(base).__name__}")
        if isinstance(base, ThinDielectric) and base.interior is not None:
            raise ValueError(
                "base must be a pane that encloses nothing, and has an interior: give that to a Boundary"
            )
        self._set(
            base=base,
            transmittance=value("transmittance", transmittance, most=1.0),
            reflectance=value("reflectance", reflectance, most=1.0),
        )
