"""Films of the colours of their thickness."""

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
    """What reflects by a film, whatever that lies on."""

    thickness: Number
    ior: float

    def reflectance(self, wavelength: ArrayLike, degrees: ArrayLike = 0.0, *, outside: float = 1.0) -> Any:
        """Return the share of unpolarised light that the film reflects at one wavelength.

        It is Airy's sum over all reflections within the film, of both polarisations, without tables. The
        rest goes through, or into the metal. Of a rough base it is the share of each facet.

        Parameters
        ----------
        wavelength : array_like
            In vacuum, nm, above 0; of a named metal, from 360 to 830.
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
            If something is no number.
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
        """Return the index of refraction of what is below the film, which has `outside` above it."""
        raise NotImplementedError


@dataclass(frozen=True, init=False)
class ThinFilm(_Film):
    """A film on glass, water or metal, of the colours of its thickness: oil on water, a lens's coat, oxide.

    What both faces of the film reflect interferes: Airy's sum over all reflections within it, of both
    polarisations, integrated over the wavelengths of daylight (CIE D65) as the standard observer sees them
    (CIE 1931), in linear Rec. 709, at each angle. Light comes to it unpolarised. What does not go back goes
    through, or into the metal: a film absorbs nothing. Where it has no thickness, what it lies on is bare.

    A colour may be too pure for red, green and blue to mix: each channel of what is reflected is then cut off
    at 0, and of what is clear at 1, by some thousandths of the light (0.005 of a soap film), so that no light
    is negative, and what is reflected and what goes through are together all that came. Of named metals a
    channel may exceed 1, as `Conductor` says.

    The indices of the film and of what is clear are the same at all wavelengths, those of a named metal as
    they were measured, and `eta` and `k` of others the same for all wavelengths of their channel. Of what is
    clear, and of metals by `eta` and `k`, the share reflected is that of the integral to within 1e-5; of
    named metals, by tables over angle, to 5e-5, and where their film's thickness varies, by tables over that
    too, to 3e-4 up to 66 degrees and to 5e-3 near grazing incidence. Of films thicker than some 6 µm hardly
    any fringes are seen: of light that is more than 48 µm behind, they are left out.

    On a rough base each facet has the film. What facets throw on each other goes by the bare base, and of a
    clear one so does that part of a facet from which other facets stop light, be it reflected or refracted:
    so a rough one keeps all light that a bare one does.

    Parameters
    ----------
    thickness : float or Texture
        How thick it is, in nanometres, not negative. Of a texture with colours, the mean of the channels.
    ior : float
        The index of refraction within the film, above 0: 1.33 for water, 1.38 for magnesium fluoride, 1.47
        for oil, 2.5 for the oxide of titanium.
    base : Dielectric or Conductor
        What it lies on. What that encloses, how rough it is and its priority stay as they are.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If something is not of the kinds above.
    """

    thickness: Number
    ior: float
    base: Dielectric | Conductor

    def __init__(
        self,
        thickness: "float | Texture",
        ior: float = 1.33,
        *,
        base: Dielectric | Conductor,
    ) -> None:
        if not isinstance(base, (Dielectric, Conductor)):
            raise TypeError(f"base must be a Dielectric or a Conductor, got {type(base).__name__}")
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colours"),
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
    """The skin of a soap bubble: a film with the same around it on both sides, of its thickness's colours.

    Light goes through it straight, as through a `ThinDielectric`, and it encloses nothing. Its colours are
    those of a `ThinFilm`: black where it is much thinner than a wave, then white, yellow, magenta, blue and
    green in turn, paler the thicker it is. What is so thick that no colours are left is a `ThinDielectric`.

    Parameters
    ----------
    thickness : float or Texture
        How thick it is, in nanometres, not negative. Of a texture with colours, the mean of the channels.
    ior : float
        The index of refraction within the film, above 0.

    Raises
    ------
    ValueError
        If `thickness` is negative or not finite, or `ior` is not greater than 0.
    TypeError
        If something is not of the kinds above.
    """

    thickness: Number
    ior: float

    def __init__(
        self,
        thickness: "float | Texture",
        ior: float = 1.33,
    ) -> None:
        self._set(
            thickness=scalar("thickness", thickness),
            ior=one_index(ior, "films have the same for all colours"),
        )

    def _base_index(self, nm: NDArray[np.float64], outside: float) -> NDArray[np.complex128]:
        return np.asarray(outside, np.complex128)
