"""Glass, water, diamond."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import colour, integer, positive
from ..media.homogeneous import Homogeneous
from ..media.medium import Medium
from ..media.medium import medium as checked
from ..textures.spectrum import Spectrum
from .dispersion import Dispersion
from .material import Material, Rough, facets, rough


@dataclass(frozen=True, init=False)
class Dielectric(Material):
    """The surface of something clear, smooth or rough, which reflects and refracts.

    Normals point outwards; the inside is filled.

    Parameters
    ----------
    ior : float, Cauchy or Sellmeier
        The index of refraction within, above 0: 1.5 for glass, 1.33 for water, 2.42 for diamond. One that
        goes with wavelength, as those of `glasses`, spreads light into its colours.
    roughness : float or Texture, optional
        Roughness from 0, smooth, to 1. Its square is the alpha of its facets' distribution, as in glTF. 0 if
        not given.
    alpha : float or Texture, optional
        Alpha itself, in place of `roughness`.
    priority : int
        Priority among overlapping solids; the greatest one counts (Schmidt and Budge, "Simple Nested
        Dielectrics in Ray Traced Images", 2002): a drink may reach into its glass.
    distribution : {"ggx", "beckmann"}
        Distribution of facet slopes: "ggx" with long tails (Walter et al., "Microfacet Models for Refraction
        through Rough Surfaces", 2007), or "beckmann", normal (Beckmann and Spizzichino, 1963), which makes
        highlights without a glow around them.
    multiple_scattering : bool
        True to include multiple scattering between facets. If not, that light is lost, so that a surface is
        the darker the rougher it is, and masking and shadowing are independent: the model of Walter et al.,
        which many renderers use.

    interior : Homogeneous or GridMedium, optional
        Medium inside, which absorbs and scatters light there.
    transmittance : float, 3 floats or Spectrum, optional
        Tint of the inside, in place of `interior`: the share of light, one number or red, green and blue,
        above 0 and at most 1, that is left after a way of length `distance` inside (Bouguer, 1729; Beer,
        1852). It is kept as an `interior` of the absorption -ln(transmittance) / distance; where all is left,
        there is none. One by wavelength, such as makers of filters publish, must be above 0 from 360 to 830
        nm.
    distance : float, optional
        The length of that way, above 0, in units of the world. 1 if not given.

    Raises
    ------
    ValueError
        If `ior` or `distance` is not greater than 0, a roughness is outside [0, 1], there is no such
        distribution, `transmittance` is not above 0 and at most 1 or comes with `interior`, or `distance`
        comes without it.
    TypeError
        If something is not of the kinds above.

    See Also
    --------
    ThinDielectric : A pane.
    Tinted : A color at the surface.
    glasses : Indices of refraction by name.

    Examples
    --------
    >>> glass = rw.Dielectric(1.5, transmittance=(0.9, 0.95, 0.9), distance=10)
    >>> glass.ior
    1.5
    >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> met = rw.Scene(rw.Sphere(material=glass)).interactions(rays)
    >>> met.reflected().weight[0, 0].round(4).item()
    0.04
    """

    ior: float | Dispersion
    roughness: Rough | None
    alpha: Rough | None
    priority: int
    distribution: str
    multiple_scattering: bool
    interior: Medium | None

    def __init__(
        self,
        ior: float | Dispersion = 1.5,
        roughness: Any = None,
        alpha: Any = None,
        priority: int = 0,
        *,
        distribution: str = "ggx",
        multiple_scattering: bool = True,
        interior: Medium | None = None,
        transmittance: ArrayLike | Spectrum | None = None,
        distance: float | None = None,
    ) -> None:
        if transmittance is not None and interior is not None:
            raise ValueError("only one of interior and transmittance can be given: the tint is an interior")
        if transmittance is None and distance is not None:
            raise ValueError(f"distance requires transmittance, got {distance!r}")
        self._set(
            ior=ior if isinstance(ior, Dispersion) else positive("ior", ior),
            **rough(roughness, alpha, pair=False),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
            **facets(distribution, multiple_scattering),
            interior=checked("interior", interior)
            if transmittance is None
            else _tint(transmittance, distance),
        )


def _tint(transmittance: ArrayLike | Spectrum, distance: float | None) -> Homogeneous | None:
    """Return the medium of a transmittance over a distance, or None if that is 1."""
    length = positive("distance", 1.0 if distance is None else distance)
    if isinstance(transmittance, Spectrum):
        return _tint_by_wavelength(transmittance, length)
    left = colour("transmittance", transmittance, most=1.0)
    if min(left) == 0:
        raise ValueError(
            f"transmittance must be above 0, got {transmittance!r}: no finite distance absorbs all light"
        )
    # 0 - x, since -ln(1) is the negative zero.
    absorption = [0.0 - math.log(share) / length for share in left]
    if not math.isfinite(max(absorption)):
        raise ValueError(
            f"distance is too small, as -ln(transmittance) / distance is infinite: "
            f"{distance!r} for {transmittance!r}"
        )
    return Homogeneous(absorption) if max(absorption) > 0 else None


def _tint_by_wavelength(transmittance: Spectrum, length: float) -> Homogeneous | None:
    seen = np.arange(360.0, 831.0)
    told = np.asarray(transmittance.wavelengths)
    # Absorption is not linear where transmittance is, so it is tabulated at each nm.
    nm = np.union1d(seen, told[(told >= seen[0]) & (told <= seen[-1])])
    left = np.asarray(transmittance.at(nm))
    if left.min() <= 0 or left.max() > 1:
        where = nm[(left <= 0) | (left > 1)][0]
        raise ValueError(
            "transmittance must be above 0 and at most 1 from 360 to 830 nm, got "
            f"{transmittance.at(where):g} at {where:g} nm (a Spectrum is 0 beyond its wavelengths)"
        )
    absorption = 0.0 - np.log(left) / length
    if not np.isfinite(absorption).all():
        raise ValueError(f"distance is too small, as -ln(transmittance) / distance is infinite: {length!r}")
    return Homogeneous(Spectrum(nm, absorption)) if absorption.max() > 0 else None
