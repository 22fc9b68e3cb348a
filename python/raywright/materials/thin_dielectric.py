"""Panes of glass."""

from dataclasses import dataclass

from ..arrays import integer
from ..media.medium import Medium
from ..media.medium import medium as checked
from .dispersion import one_index
from .material import Material


@dataclass(frozen=True, init=False)
class ThinDielectric(Material):
    """A clear sheet too thin to bend what is seen through it: a window, or a flask of smoke.

    Parameters
    ----------
    ior : float
        The index of refraction within the sheet, above 0.
    interior : Homogeneous or GridMedium, optional
        What it encloses; its normals point out of that.
    priority : int
        Where several things overlap that are filled, the one of the greatest priority is there.

    Raises
    ------
    ValueError
        If `ior` is not greater than 0, or `priority` is out of range.
    TypeError
        If something is not of the kinds above.
    """

    ior: float
    interior: Medium | None
    priority: int

    def __init__(
        self,
        ior: float = 1.5,
        *,
        interior: Medium | None = None,
        priority: int = 0,
    ) -> None:
        self._set(
            ior=one_index(ior, "a pane sends all colours straight on"),
            interior=checked("interior", interior),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
        )
