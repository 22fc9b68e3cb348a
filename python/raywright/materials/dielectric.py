"""Glass, water, diamond."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import color, integer, positive
from ..media.homogeneous import Homogeneous
from ..media.medium import Medium
from ..media.medium import medium as checked
from ..textures.spectrum import Spectrum
from .dispersion import Dispersion
from .material import Material, Rough, facets, rough


@dataclass(frozen=True, init=False)
class Dielectric(Material):
    """A clear solid, smooth or rough, whose surface reflects and refracts.

    Normals point outwards; the inside is filled.

    Parameters
    ----------
    ior : float, Cauchy or Sellmeier
        The index of refraction within, above 0: 1.5 for glass, 1.33 for water, 2.42 for diamond. An index by
        wavelength, such as those of `glasses`, disperses light.
    roughness : float or Texture, optional
        Roughness from 0, smooth, to 1. Its square is the alpha of its facets' distribution, as in glTF. 0 if
        not given.
    alpha : float or Texture, optional
        Alpha, in place of `roughness`.
    priority : int
        Priority among overlapping solids; the greatest one counts (Schmidt and Budge, "Simple Nested
        Dielectrics in Ray Traced Images", 2002): a drink may reach into its glass.
    distribution : {"ggx", "beckmann"}
        Distribution of facet slopes: "ggx" with long tails (Walter et al., "Microfacet Models for Refraction
        through Rough Surfaces", 2007), or "beckmann", a normal distribution (Beckmann and Spizzichino 1963),
        whose highlights have no glow around them.
    multiple_scattering : bool
        True to include multiple scattering between facets. False omits that light, so rougher surfaces are
        darker, and treats masking and shadowing as independent: the model of Walter et al., which many
        renderers use.

    interior : Homogeneous or GridMedium, optional
        Medium inside, which absorbs and scatters light there.
    transmittance : float, 3 floats or Spectrum, optional
        Tint of the inside, in place of `interior`: the share of light that remains after the length
        `distance` inside, above 0 and at most 1 (Bouguer 1729; Beer 1852). It is stored as an `interior` with
        the absorption -ln(transmittance) / distance; there is none if all light remains. A spectrum, such as
        makers of filters publish, must be above 0 from 360 to 830 nm.
    distance : float, optional
        Length that `transmittance` refers to, above 0, in units of the world. 1 if not given.

    Raises
    ------
    ValueError
        If `ior` or `distance` is not greater than 0, a roughness is outside [0, 1], there is no such
        distribution, `transmittance` is not above 0 and at most 1, or is given with `interior`, or `distance`
        is given without it.
    TypeError
        If an argument has another type.

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
    left = color("transmittance", transmittance, most=1.0)
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
