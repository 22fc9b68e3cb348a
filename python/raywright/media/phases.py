"""Into which directions media scatter light."""

from dataclasses import dataclass
from typing import Any, TypeAlias

from ..arrays import number


@dataclass(frozen=True)
class Isotropic:
    """The same into every direction."""


@dataclass(frozen=True)
class Rayleigh:
    """As what is much smaller than a wavelength scatters, such as air: 3 (1 + cos²) / 16π (Rayleigh 1871).

    That short waves are scattered more than long ones is said by the coefficients of a medium, which go with
    the inverse fourth power of the wavelength.
    """


@dataclass(frozen=True, init=False)
class HenyeyGreenstein:
    """By the mean cosine of the angle that light turns by (Henyey and Greenstein 1941).

    Parameters
    ----------
    g : float
        That mean, between -1 and 1, both excluded: above 0 light mostly goes on, as in clouds (about 0.85)
        and milk (about 0.9); below 0 it mostly turns back; at 0 it goes everywhere alike.

    Raises
    ------
    ValueError
        If it is not between -1 and 1.
    TypeError
        If it is no number.
    """

    g: float

    def __init__(self, g: float = 0.0) -> None:
        result = number("g", g)
        if not -1 < result < 1:
            raise ValueError(f"g must be between -1 and 1, both excluded, got {g}")
        object.__setattr__(self, "g", result)


Phase: TypeAlias = HenyeyGreenstein | Isotropic | Rayleigh


def phase(name: str, given: Any) -> Phase:
    """Return a phase function as it is.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(given, HenyeyGreenstein | Isotropic | Rayleigh):
        kinds = "HenyeyGreenstein, Isotropic or Rayleigh"
        raise TypeError(f"{name} must be one of {kinds}, got {type(given).__name__}")
    return given
