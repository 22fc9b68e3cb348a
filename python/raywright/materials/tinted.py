"""Glass with a color at its surface."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .dielectric import Dielectric
from .material import Material
from .thin_dielectric import ThinDielectric


@dataclass(frozen=True, init=False)
class Tinted(Material):
    """Glass or a pane with a color at its surface: stained glass, a painted window, a slide.

    One factor applies to each transmission through the surface, and another to each reflection. The
    `transmittance` of a `Dielectric` acts over the length of the path inside; this tint does not depend on
    thickness, and may be a texture. Light that passes in and out of a solid crosses its surface twice; that
    through a pane once.

    Parameters
    ----------
    base : Dielectric or ThinDielectric
        Clear material without the color. Its interior, roughness and priority are unchanged; a pane must
        enclose nothing.
    transmittance : float, 3 floats, Spectrum or Texture
        Factor of transmitted light, in [0, 1].
    reflectance : float, 3 floats, Spectrum or Texture
        Factor of reflected light, in [0, 1].

    Raises
    ------
    ValueError
        If a share is outside [0, 1] or not finite, or a pane encloses something.
    TypeError
        If an argument has another type.

    See Also
    --------
    Dielectric : Takes a `transmittance` of its inside.

    Examples
    --------
    >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> window = rw.materials.Tinted(rw.ThinDielectric(1.5), transmittance=(1, 0.5, 0))
    >>> met = rw.Scene(rw.Plane(material=window)).interactions(rays)
    >>> met.refracted().weight.round(4).tolist()
    [[0.9231, 0.4615, 0.0]]
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
            raise ValueError("base must have no interior: give the interior to a MediumInterface")
        self._set(
            base=base,
            transmittance=value("transmittance", transmittance, most=1.0),
            reflectance=value("reflectance", reflectance, most=1.0),
        )
