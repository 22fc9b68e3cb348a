"""Dispersion: the index of refraction by wavelength."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import number, positive, real_array

# Fraunhofer's lines F, d and C, micrometers; glass catalogs state dispersion by them.
BLUE, YELLOW, RED = 0.4861327, 0.5875618, 0.6562725


class Dispersion(ABC):
    """An index of refraction by wavelength: a `Cauchy` or a `Sellmeier`.

    See Also
    --------
    Cauchy, Sellmeier

    Examples
    --------
    >>> isinstance(rw.materials.Cauchy(1.5046, 0.0042), rw.materials.Dispersion)
    True
    """

    __slots__ = ()

    def index(self, micrometers: ArrayLike = YELLOW) -> Any:
        """Return the index of refraction at wavelengths in vacuum.

        Parameters
        ----------
        micrometers : array_like
            Wavelengths, of any shape; 0.5875618, the yellow line d of helium, if not given.

        Returns
        -------
        float or (...) float64

        Raises
        ------
        ValueError
            If a wavelength is not greater than 0, or if the formula does not hold there: it gives no index
            above 0.
        TypeError
            If wavelengths are not real numbers.

        See Also
        --------
        Dielectric : Takes the formula.

        Examples
        --------
        >>> bk7 = rw.materials.glasses["N-BK7"]
        >>> round(bk7.index(), 4), bk7.index([0.4861, 0.6563]).round(4).tolist()
        (1.5168, [1.5224, 1.5143])
        """
        wavelengths = real_array("micrometers", micrometers).astype(np.float64)
        bad = ~(np.isfinite(wavelengths) & (wavelengths > 0))
        if bad.any():
            raise ValueError(
                f"micrometers must be finite and greater than 0, got {wavelengths[bad].ravel()[0]}"
            )
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = self._index(wavelengths**2)
        bad = ~(np.isfinite(found) & (found > 0))
        if bad.any():
            wrong = wavelengths[bad].ravel()[0]
            raise ValueError(f"micrometers must be in the range of the formula: it has no index at {wrong}")
        return found if found.ndim else float(found)

    @property
    def abbe(self) -> float:
        """The Abbe number, (n_d - 1) / (n_F - n_C), which falls with dispersion.

        Glasses have 20 (strong dispersion) to 95 (weak); infinite without dispersion.
        """
        blue, yellow, red = (self.index(line) for line in (BLUE, YELLOW, RED))
        return float(np.inf) if blue == red else float((yellow - 1) / (blue - red))

    @abstractmethod
    def _index(self, squares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the index at wavelengths, given by their squares."""


@dataclass(frozen=True)
class Cauchy(Dispersion):
    """Cauchy's index of refraction (1836), n = B + C / λ².

    It holds for visible light, and is less exact than a `Sellmeier`: for glass to some 1e-4.

    Parameters
    ----------
    B : float
        The index of the longest waves, above 0.
    C : float
        Dispersion, in square micrometers: 0.0042 for the glass BK7. Beware of tables in nm².

    Raises
    ------
    ValueError
        If a number is not finite, or `B` not above 0.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Sellmeier : More exact.

    Examples
    --------
    >>> glass = rw.materials.Cauchy(1.5046, 0.0042)
    >>> round(glass.index(0.5876), 4), round(glass.abbe, 1)
    (1.5168, 64.4)
    """

    B: float
    C: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "B", positive("B", self.B))
        object.__setattr__(self, "C", number("C", self.C))

    @classmethod
    def from_abbe(cls, nd: float, Vd: float) -> Cauchy:
        """Return the Cauchy formula with a given index at the d line and a given Abbe number.

        Parameters
        ----------
        nd : float
            The index at 0.5875618 micrometers, above 0.
        Vd : float
            Abbe's number, (n_d - 1) / (n_F - n_C), above 0: as in catalogs of glass.

        Returns
        -------
        Cauchy

        Raises
        ------
        ValueError
            If a number is not above 0 or not finite.
        TypeError
            If an argument is not a number.

        See Also
        --------
        Cauchy.abbe : The number of Abbe of any formula.

        Examples
        --------
        >>> flint = rw.materials.Cauchy.from_abbe(1.62, 36.4)
        >>> round(flint.index(), 6), round(flint.abbe, 6)
        (1.62, 36.4)
        """
        nd, Vd = positive("nd", nd), positive("Vd", Vd)
        slope = (nd - 1) / (Vd * (BLUE**-2 - RED**-2))
        return cls(nd - slope / YELLOW**2, slope)

    def _index(self, squares: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(self.B + self.C / squares)


@dataclass(frozen=True)
class Sellmeier(Dispersion):
    """Sellmeier's index of refraction (1871), n² = 1 + Σ B λ² / (λ² - C).

    Parameters
    ----------
    B : sequence of float
        Strengths of the resonances, three for most glass.
    C : sequence of float
        The squares of their wavelengths, square micrometers, at least 0.

    Raises
    ------
    ValueError
        If `B` and `C` differ in length, are empty or not finite, or `C` is below 0.
    TypeError
        If they are not numbers.

    See Also
    --------
    Cauchy : Simpler.
    glasses : Formulas of known glasses.

    Examples
    --------
    >>> silica = rw.materials.Sellmeier((0.6961663, 0.4079426, 0.8974794), (0.00467914826, 0.0135120631,
    ... 97.9340025))
    >>> round(silica.index(), 4)
    1.4585
    """

    B: tuple[float, ...]
    C: tuple[float, ...]

    def __post_init__(self) -> None:
        for name in ("B", "C"):
            values = real_array(name, getattr(self, name)).astype(np.float64)
            if values.ndim != 1 or not values.size or not np.isfinite(values).all():
                raise ValueError(f"{name} must be one or more finite numbers, got {getattr(self, name)!r}")
            object.__setattr__(self, name, tuple(values.tolist()))
        if len(self.B) != len(self.C):
            raise ValueError(f"B and C must have equal lengths, got {len(self.B)} and {len(self.C)}")
        if min(self.C) < 0:
            raise ValueError(f"C must be at least 0, got {min(self.C)}")

    def _index(self, squares: NDArray[np.float64]) -> NDArray[np.float64]:
        terms = (b * squares / (squares - c) for b, c in zip(self.B, self.C, strict=True))
        return np.asarray(np.sqrt(1 + sum(terms)))


def one_index(given: Any, why: str) -> float:
    """Return an index of refraction without dispersion.

    Raises
    ------
    ValueError
        If it is not finite and above 0.
    TypeError
        If an argument is not a number; for a dispersive one, with the reason.
    """
    if isinstance(given, Dispersion):
        kind = type(given).__name__
        raise TypeError(f"ior must be one number, got a {kind}: {why}; its index() is that of yellow light")
    return positive("ior", given)
