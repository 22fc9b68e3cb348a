"""Blackbody radiation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import number, positive
from .spectrum import Spectrum


def planck(wavelengths: NDArray[np.float64], kelvin: float) -> NDArray[np.float64]:
    """Return the radiance of a black body at wavelengths in nm (Planck, 1900), W·sr⁻¹·m⁻²·nm⁻¹."""
    meters = wavelengths * 1e-9
    # 2 h c², and h c over Boltzmann's constant (SI, 2019).
    with np.errstate(over="ignore"):
        return 1e-9 * 1.1910429723971884e-16 / meters**5 / np.expm1(0.014387768775039337 / (meters * kelvin))


@dataclass(frozen=True, init=False, repr=False)
class Blackbody(Spectrum):
    """The spectrum of a black body at a temperature (Planck 1900), scaled to a given luminance.

    Parameters
    ----------
    kelvin : float
        Temperature in kelvin, at least 500: about 1900 for a candle, 2800 for a light bulb, 5800 for the sun.
    luminance : float
        Luminance, at least 0; 1 is the luminance of white light, (1, 1, 1). `radiance` returns the physical
        radiance instead.

    Raises
    ------
    ValueError
        If `kelvin` is below 500, where nothing is visible, or a number is not finite.
    TypeError
        If an argument is not a number.

    See Also
    --------
    illuminants : Standard illuminants by name.

    Examples
    --------
    >>> red, green, blue = rw.Blackbody(1900).rgb
    >>> red > green > blue, round(rw.Blackbody(1900, luminance=2).luminance, 6)
    (True, 2.0)
    """

    kelvin: float

    def __init__(self, kelvin: float, luminance: float = 1.0) -> None:
        temperature = positive("kelvin", kelvin)
        if temperature < 500:
            raise ValueError(f"kelvin must be at least 500, got {kelvin}: colder bodies are not visible")
        if number("luminance", luminance) < 0:
            raise ValueError(f"luminance must be at least 0, got {luminance}")
        wavelengths = np.arange(360.0, 831.0, 5.0)
        told = planck(wavelengths, temperature)
        # Relative to the maximum, so that no temperature overflows.
        plain = Spectrum(wavelengths, told / told.max())
        values = np.asarray(plain.values) * (luminance / plain.luminance)
        self._set(kelvin=temperature, wavelengths=plain.wavelengths, values=tuple(values.tolist()))

    def radiance(self) -> Spectrum:
        """Return the physical spectral radiance of the body, W·sr⁻¹·m⁻²·nm⁻¹.

        Returns
        -------
        Spectrum

        Examples
        --------
        Planck's law at 500 nm:

        >>> told = rw.Blackbody(5800).radiance().at(500)
        >>> h, c, k = 6.62607015e-34, 299792458, 1.380649e-23
        >>> planck = 2 * h * c**2 / 500e-9**5 / np.expm1(h * c / (500e-9 * k * 5800)) * 1e-9
        >>> round(float(told / planck), 5)
        1.0
        """
        wavelengths = np.asarray(self.wavelengths)
        return Spectrum(wavelengths, planck(wavelengths, self.kelvin))

    def __repr__(self) -> str:
        return f"Blackbody(kelvin={self.kelvin:g}, luminance={self.luminance:.6g})"
