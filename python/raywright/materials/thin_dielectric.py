"""Panes of glass."""

from dataclasses import dataclass

from ..arrays import positive
from .material import Material


@dataclass(frozen=True, init=False)
class ThinDielectric(Material):
    """A clear sheet too thin to bend what is seen through it: a window. It encloses nothing.

    Parameters
    ----------
    ior : float
        The index of refraction within the sheet, above 0.

    Raises
    ------
    ValueError
        If `ior` is not greater than 0.
    TypeError
        If something is not of the kinds above.
    """

    ior: float

    def __init__(
        self,
        ior: float = 1.5,
    ) -> None:
        self._set(
            ior=positive("ior", ior),
        )
