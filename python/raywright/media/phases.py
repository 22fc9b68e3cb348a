"""Into which directions media scatter light."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from ..arrays import number


@dataclass(frozen=True)
class Isotropic:
    """The isotropic phase function: the same in all directions.

    See Also
    --------
    HenyeyGreenstein, Rayleigh

    Examples
    --------
    >>> rw.Homogeneous(scattering=1.0).phase
    Isotropic()
    """


@dataclass(frozen=True)
class Rayleigh:
    """Rayleigh's phase function (1871) of particles far below a wavelength, as of air: 3 (1 + cos²) / 16π.

    The greater scattering of short waves is in the coefficients of a medium, which go with the inverse fourth
    power of the wavelength.

    See Also
    --------
    Isotropic, HenyeyGreenstein

    Examples
    --------
    >>> air = rw.Homogeneous(scattering=(0.01, 0.02, 0.05), phase=rw.media.Rayleigh())
    >>> air.phase
    Rayleigh()
    """


@dataclass(frozen=True, init=False)
class HenyeyGreenstein:
    """The phase function of Henyey and Greenstein (1941), by the mean cosine of the scattering angle.

    Parameters
    ----------
    g : float
        Mean cosine, between -1 and 1, both excluded: above 0 scattering is mostly forward, as in clouds
        (about 0.85) and milk (about 0.9); below 0 mostly backward; at 0 isotropic.

    Raises
    ------
    ValueError
        If it is not between -1 and 1.
    TypeError
        If `g` is not a number.

    See Also
    --------
    Isotropic, Rayleigh

    Examples
    --------
    >>> cloud = rw.Homogeneous(scattering=2.0, phase=rw.HenyeyGreenstein(0.85))
    >>> cloud.phase
    HenyeyGreenstein(g=0.85)
    """

    g: float

    def __init__(self, g: float = 0.0) -> None:
        result = number("g", g)
        if not -1 < result < 1:
            raise ValueError(f"g must be between -1 and 1, both excluded, got {g}")
        object.__setattr__(self, "g", result)


Phase: TypeAlias = HenyeyGreenstein | Isotropic | Rayleigh


def phase(name: str, given: Any) -> Phase:
    """Return a checked phase function.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(given, HenyeyGreenstein | Isotropic | Rayleigh):
        kinds = "HenyeyGreenstein, Isotropic or Rayleigh"
        raise TypeError(f"{name} must be one of {kinds}, got {type(given).__name__}")
    return given
