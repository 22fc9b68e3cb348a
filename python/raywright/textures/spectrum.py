"""Spectra by their values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..arrays import Triple, color, number, real_array
from .texture import Texture


@dataclass(frozen=True, init=False)
class Spectrum(Texture):
    """A spectrum of reflectance or of light: linear between its values, and 0 beyond them.

    Every color parameter also accepts a spectrum. A scene with one is rendered by wavelength (see
    `Scene.plan`). As a reflectance, its values are shares of light. As a radiance, intensity or irradiance
    they have the unit of a color channel: a value of 1 at all wavelengths has the luminance of the white (1,
    1, 1), 1. Such a constant spectrum looks reddish, because white is daylight (CIE D65).

    Parameters
    ----------
    wavelengths : (N,) array_like
        Wavelengths in nm, two or more, rising. Visible light is between 360 and 830.
    values : (N,) array_like
        Value at each wavelength, at least 0.

    Raises
    ------
    ValueError
        If there are not as many values as wavelengths, wavelengths do not rise, or a number is negative or
        not finite.
    TypeError
        If an argument is not a number.

    See Also
    --------
    illuminants : Standard illuminants by name.
    Blackbody : Light by its temperature.

    Examples
    --------
    >>> even = rw.Spectrum([360, 830], [1, 1])
    >>> round(even.luminance, 6)
    1.0
    >>> filter = rw.Spectrum([360, 550, 551, 830], [0, 0, 0.9, 0.9])
    >>> filter.at([500, 600]).tolist()
    [0.0, 0.9]
    """

    _is_number: ClassVar[bool] = False

    wavelengths: tuple[float, ...]
    values: tuple[float, ...]

    def __init__(self, wavelengths: ArrayLike, values: ArrayLike) -> None:
        nm, found = (
            real_array(name, given).astype(np.float64)
            for name, given in (("wavelengths", wavelengths), ("values", values))
        )
        if nm.ndim != 1 or len(nm) < 2 or not np.isfinite(nm).all() or not (np.diff(nm) > 0).all():
            raise ValueError(
                f"wavelengths must be two or more finite, increasing numbers, got {wavelengths!r}"
            )
        if found.shape != nm.shape:
            raise ValueError(f"values must have length {len(nm)} like wavelengths, got shape {found.shape}")
        if not (np.isfinite(found).all() and (found >= 0).all()):
            raise ValueError(f"values must be finite and at least 0, got {values!r}")
        self._set(wavelengths=tuple(nm.tolist()), values=tuple(found.tolist()))

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Least and greatest value, the same for red, green and blue."""
        low, high = min(self.values), max(self.values)
        return (low, low, low), (high, high, high)

    def at(self, wavelengths: ArrayLike) -> Any:
        """Return the values of the spectrum at wavelengths.

        Parameters
        ----------
        wavelengths : array_like
            Wavelengths in nm, in an array of any shape.

        Returns
        -------
        float or (...) float64

        Raises
        ------
        TypeError
            If wavelengths are not real numbers.

        Examples
        --------
        >>> ramp = rw.Spectrum([400, 800], [0, 1])
        >>> ramp.at(500), ramp.at([300, 400, 600]).tolist()
        (0.25, [0.0, 0.0, 0.5])
        """
        asked = real_array("wavelengths", wavelengths)
        found = np.interp(asked, self.wavelengths, self.values, left=0.0, right=0.0)
        return found if np.ndim(found) else float(found)

    @property
    def rgb(self) -> Triple:
        """Linear red, green and blue (Rec. 709) of the spectrum as light (CIE 1931 observer).

        For colors outside the gamut, the negative component is 0.
        """
        return self._rgb(emits=True)

    @property
    def reflected_rgb(self) -> Triple:
        """Linear red, green and blue (Rec. 709) of the spectrum as a reflectance, in daylight (CIE D65)."""
        return self._rgb(emits=False)

    @property
    def luminance(self) -> float:
        """Luminance of the spectrum as light: 1 for a value of 1 at all wavelengths."""
        return _core.spectrum_luminance(self._rows())

    def __mul__(self, factor: float) -> Spectrum:
        """Return so many times as much of it."""
        return Spectrum(self.wavelengths, np.multiply(self.values, number("factor", factor)))

    __rmul__ = __mul__

    def _rows(self) -> list[list[float]]:
        return [list(row) for row in zip(self.wavelengths, self.values, strict=True)]

    def _rgb(self, emits: bool) -> Triple:
        red, green, blue = np.maximum(_core.spectrum_rgb(self._rows(), not emits), 0.0).tolist()
        return red, green, blue


def color_or_spectrum(name: str, value: ArrayLike | Spectrum) -> Triple | Spectrum:
    """Return a spectrum as it is, or one number or three as three floats, each finite and at least 0.

    Raises
    ------
    ValueError
        If a number is negative or not finite, or there are neither 1 nor 3 of them.
    TypeError
        If `value` is not a number.
    """
    return value if isinstance(value, Spectrum) else color(name, value)
