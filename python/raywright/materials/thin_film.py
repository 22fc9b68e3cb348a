"""Films of the colors of their thickness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import positive, real_array
from ..textures.texture import Number, Texture, scalar
from .conductor import Conductor, metal_index
from .dielectric import Dielectric
from .dispersion import Dispersion, one_index
from .material import Material


class _Film(Material):
    """The base class of thin films."""

    thickness: Number
    ior: float

    def reflectance(self, wavelength: ArrayLike, degrees: ArrayLike = 0.0, *, outside: float = 1.0) -> Any:
        """Return the share of unpolarized light that the film reflects at one wavelength.

        It is Airy's sum over all reflections within the film, of both polarizations, without tables. The rest
        goes through, or into the metal. For a rough base it is the share of each facet.

        Parameters
        ----------
        wavelength : array_like
            Wavelength in vacuum, nm, above 0; for a named metal, from 360 to 830.
        degrees : array_like
            The angle of incidence, 0 to 90. It broadcasts against `wavelength`.
        outside : float
            The index of refraction around the film, above 0.

        Returns
        -------
        float or (...) float64
            From 0 to 1.

        Raises
        ------
        ValueError
            If `thickness` is a texture, `eta` or `k` of the base is one or differs by channel, or a number is
            out of range.
        TypeError
            If an argument is not a number.

        See Also
        --------
        ThinFilm, SoapFilm

        Examples
        --------
        A quarter-wave coat of magnesium fluoride on glass:

        >>> coat = rw.materials.ThinFilm(550 / 4 / 1.38, ior=1.38, base=rw.Dielectric(1.52))
        >>> round(coat.reflectance(550), 4), round(((1.52 - 1.38**2) / (1.52 + 1.38**2)) ** 2, 4)
        (0.0126, 0.0126)
        """
        nm = real_array("wavelength", wavelength).astype(np.float64)
        bad = ~(np.isfinite(nm) & (nm > 0))
        if bad.any():
            raise ValueError(f"wavelength must be finite and greater than 0, got {nm[bad].ravel()[0]}")
        angle = real_array("degrees", degrees).astype(np.float64)
        bad = ~((angle >= 0) & (angle <= 90))
        if bad.any():
            raise ValueError(f"degrees must be between 0 and 90, got {angle[bad].ravel()[0]}")
        outside = positive("outside", outside)
        if isinstance(self.thickness, Texture):
            raise ValueError("thickness must be one number to have one reflectance, got a texture")
        base = self._base_index(nm, outside)
        columns = (nm, self.thickness, np.cos(np.radians(angle)), outside, self.ior, base.real, base.imag)
        rows = np.stack(np.broadcast_arrays(*columns), axis=-1)
        found = np.reshape(_core.film_reflectance(rows.reshape(-1, 7).tolist()), rows.shape[:-1])
        return found if found.ndim else float(found)

    def _base_index(self, nm: NDArray[np.float64], outside: float) -> NDArray[np.complex128]:
        """Return the index of refraction below the film, which has `outside` above it."""
        raise NotImplementedError


@dataclass(frozen=True, init=False)
class ThinFilm(_Film):
    """A thin film on glass, water or metal, with interference colors: oil on water, a coated lens, oxide.

    Light from both faces of the film interferes: Airy's sum over all reflections within it, of both
    polarizations, integrated over the wavelengths of daylight (CIE D65) as the standard observer sees them
    (CIE 1931), in linear Rec. 709, at each angle. Incident light is unpolarized. The film absorbs nothing:
    other light is transmitted, or enters the metal. At a thickness of 0 the base is bare.

    A color may be outside the gamut of red, green and blue. Each channel of the reflectance is then cut off
    at 0, and of clear bases at 1, by some thousandths of the light (0.005 for a soap film): no light is
    negative, and reflectance and transmittance add up to 1. A channel of named metals may exceed 1, as in
    `Conductor`.

    The indices of the film and of clear bases are the same at all wavelengths, those of a named metal as
    measured, and `eta` and `k` of others the same for all wavelengths of their channel. For clear bases, and
    metals by `eta` and `k`, the reflectance is the integral to within 1e-5; for named metals, tables over
    angle hold it to 5e-5, and if the film's thickness varies, tables over that too, to 3e-4 up to 66 degrees
    and to 5e-3 near grazing incidence. Films thicker than some 6 µm hardly show any fringes: those of path
    differences above 48 µm are left out.

    On a rough base each facet has the film. Multiple scattering between facets uses the bare base, and so, on
    a clear base, does light that a facet reflects or refracts into other facets. So a rough film conserves
    energy as a bare base does.

    Parameters
    ----------
    thickness : float or Texture
        Thickness in nanometers, not negative. For textures with colors, it is the mean of the channels.
    ior : float
        The index of refraction within the film, above 0: 1.33 for water, 1.38 for magnesium fluoride, 1.47
        for oil, 2.5 for the oxide of titanium.
    base : Dielectric or Conductor
        Material under the film. Its interior, roughness and priority are unchanged.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If an argument has another type.

    See Also
    --------
    SoapFilm : A film with air on both sides.

    Examples
    --------
    >>> oil = rw.materials.ThinFilm(350, ior=1.47, base=rw.Dielectric(1.33))
    >>> oil.reflectance([450, 550, 650]).round(4).tolist()
    [0.0429, 0.0259, 0.0543]
    """

    thickness: Number
    ior: float
    base: Dielectric | Conductor

    def __init__(
        self,
        thickness: float | Texture,
        ior: float = 1.33,
        *,
        base: Dielectric | Conductor,
    ) -> None:
        if not isinstance(base, (Dielectric, Conductor)):
            raise TypeError(f"base must be a Dielectric or a Conductor, got {type(base).__name__}")
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colors"),
            base=base,
        )

    def _base_index(self, nm: NDArray[np.float64], outside: float) -> NDArray[np.complex128]:
        base = self.base
        if isinstance(base, Dielectric):
            index = base.ior.index(nm / 1000) if isinstance(base.ior, Dispersion) else base.ior
            return np.asarray(index, np.complex128)
        if base.metal is not None:
            if not ((nm >= 360) & (nm <= 830)).all():
                raise ValueError(f"wavelength must be from 360 to 830 nm on a named metal, got {nm}")
            measured = metal_index(base.metal)
            eta, k = (np.interp(nm, measured.wavelengths, part) for part in (measured.eta, measured.k))
            return np.asarray(eta + 1j * k)
        for name, part in (("eta", base.eta), ("k", base.k)):
            if isinstance(part, Texture) or len({*part}) != 1:  # type: ignore[misc]
                raise ValueError(f"{name} of the base must be one number at one wavelength, got {part}")
        return np.asarray(complex(base.eta[0], base.k[0]))  # type: ignore[index]


@dataclass(frozen=True, init=False)
class SoapFilm(_Film):
    """The skin of a soap bubble: a thin film with air on both sides, which shows interference colors.

    Light passes straight through it, as through a `ThinDielectric`, and it encloses no medium. Its colors
    are those of a `ThinFilm`: black where it is much thinner than a wave, then white, yellow, magenta, blue
    and green in turn, paler the thicker it is. A film too thick for colors is a `ThinDielectric`.

    Parameters
    ----------
    thickness : float or Texture
        Thickness in nanometers, not negative. For textures with colors, it is the mean of the channels.
    ior : float
        The index of refraction within the film, above 0.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If an argument has another type.

    See Also
    --------
    ThinFilm : A film on glass, water or metal.

    Examples
    --------
    >>> rw.materials.SoapFilm(0.0).reflectance(550)
    0.0

    Two faces in phase reflect four times as much as one, but for multiple reflections:

    >>> round(rw.materials.SoapFilm(550 / 4 / 1.33).reflectance(550), 4)
    0.0771
    """

    thickness: Number
    ior: float

    def __init__(
        self,
        thickness: float | Texture,
        ior: float = 1.33,
    ) -> None:
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colors"),
        )

    def _base_index(self, nm: NDArray[np.float64], outside: float) -> NDArray[np.complex128]:
        return np.asarray(outside, np.complex128)
