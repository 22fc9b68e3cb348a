"""Panes of glass."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import integer
from ..media.medium import Medium
from ..media.medium import medium as checked
from .dispersion import one_index
from .material import Material


@dataclass(frozen=True, init=False)
class ThinDielectric(Material):
    """A clear sheet too thin to shift the view: a window, or a flask of smoke.

    Parameters
    ----------
    ior : float
        The index of refraction within the sheet, above 0.
    interior : Homogeneous or GridMedium, optional
        Medium that it encloses; normals point out of it.
    priority : int
        Priority among overlapping filled shapes; the greatest one counts.

    Raises
    ------
    ValueError
        If `ior` is not greater than 0, or `priority` is out of range.
    TypeError
        If an argument has another type.

    See Also
    --------
    Dielectric : A solid, which refracts.
    SoapFilm : A pane with interference colors.

    Examples
    --------
    >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> met = rw.Scene(rw.Plane(material=rw.ThinDielectric(1.5))).interactions(rays)
    >>> met.refracted().direction.tolist(), met.refracted().weight[0, 0].round(4).item()
    ([[0.0, 0.0, -1.0]], 0.9231)
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
            ior=one_index(ior, "a pane sends all colors straight on"),
            interior=checked("interior", interior),
            priority=integer("priority", priority, -(2**31), 2**31 - 1),
        )
