"""How the index of refraction of what is clear goes with wavelength."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import number, positive, real_array

# Fraunhofer's lines F, d and C, micrometres; glass catalogues state dispersion by them.
BLUE, YELLOW, RED = 0.4861327, 0.5875618, 0.6562725


class Dispersion(ABC):
    """An index of refraction that goes with wavelength: a `Cauchy` or a `Sellmeier`."""

    __slots__ = ()

    def index(self, micrometres: ArrayLike = YELLOW) -> Any:
        """Return the index of refraction in vacuum's wavelengths.

        Parameters
        ----------
        micrometres : array_like
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
            If wavelengths are no real numbers.
        """
        wavelengths = real_array("micrometres", micrometres).astype(np.float64)
        bad = ~(np.isfinite(wavelengths) & (wavelengths > 0))
        if bad.any():
            raise ValueError(
                f"micrometres must be finite and greater than 0, got {wavelengths[bad].ravel()[0]}"
            )
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            found = self._index(wavelengths**2)
        bad = ~(np.isfinite(found) & (found > 0))
        if bad.any():
            wrong = wavelengths[bad].ravel()[0]
            raise ValueError(f"micrometres must be where the formula holds: at {wrong} it gives no index")
        return found if found.ndim else float(found)

    @property
    def abbe(self) -> float:
        """The number of Abbe, (n_d - 1) / (n_F - n_C): how little it disperses.

        From 20, much, to 95; infinite if the index is the same everywhere.
        """
        blue, yellow, red = (self.index(line) for line in (BLUE, YELLOW, RED))
        return float(np.inf) if blue == red else float((yellow - 1) / (blue - red))

    @abstractmethod
    def _index(self, squares: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the index of wavelengths, told by their squares."""


@dataclass(frozen=True)
class Cauchy(Dispersion):
    """Cauchy's index of refraction (1836), n = B + C / λ².

    It holds for what is seen, and is less exact than a `Sellmeier`: for glass to some 1e-4.

    Parameters
    ----------
    B : float
        The index of the longest waves, above 0.
    C : float
        How much greater it gets, square micrometres: 0.0042 for the glass BK7. Beware of tables in nm².

    Raises
    ------
    ValueError
        If a number is not finite, or `B` not above 0.
    TypeError
        If one is no number.
    """

    B: float
    C: float

    def __post_init__(self) -> None:
        object.__setattr__(self, "B", positive("B", self.B))
        object.__setattr__(self, "C", number("C", self.C))

    @classmethod
    def from_abbe(cls, nd: float, Vd: float) -> "Cauchy":
        """Return the one that has this index at the line d and this number of Abbe.

        Parameters
        ----------
        nd : float
            The index at 0.5875618 micrometres, above 0.
        Vd : float
            Abbe's number, (n_d - 1) / (n_F - n_C), above 0: as in catalogues of glass.
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
        How strong resonances are: as many as there are, three for most glass.
    C : sequence of float
        The squares of their wavelengths, square micrometres, at least 0.

    Raises
    ------
    ValueError
        If they are not as many, none, not finite, or one of `C` is below 0.
    TypeError
        If they are no numbers.
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
            raise ValueError(f"B and C must be as many, got {len(self.B)} and {len(self.C)}")
        if min(self.C) < 0:
            raise ValueError(f"C must be at least 0, got {min(self.C)}")

    def _index(self, squares: NDArray[np.float64]) -> NDArray[np.float64]:
        terms = (b * squares / (squares - c) for b, c in zip(self.B, self.C, strict=True))
        return np.asarray(np.sqrt(1 + sum(terms)))


def one_index(given: Any, why: str) -> float:
    """Return an index of refraction of what has the same for all wavelengths.

    Raises
    ------
    ValueError
        If it is not finite and above 0.
    TypeError
        If it is no number; of one that goes with wavelength, tells why that is none.
    """
    if isinstance(given, Dispersion):
        kind = type(given).__name__
        raise TypeError(f"ior must be one number, got a {kind}: {why}; its index() is that of yellow light")
    return positive("ior", given)
