"""The end of a medium that has no surface."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import integer
from ..media.medium import Medium
from ..media.medium import medium as checked
from .material import Material


@dataclass(frozen=True, init=False)
class MediumInterface(Material):
    """An index-matched boundary of a medium, as of smoke or a cloud: light passes straight.

    Its normals point out of the medium. `Scene.intersect` and the like hit the shape.

    Parameters
    ----------
    interior : Homogeneous or GridMedium
        The medium inside.
    priority : int
        Priority among overlapping filled shapes; the greatest one counts. Among equal priorities, the shape
        with the greater index of refraction counts, so glass displaces smoke; then the later one in the
        scene. Media do not add up.

    Raises
    ------
    ValueError
        If `priority` is out of range.
    TypeError
        If an argument has another type.

    See Also
    --------
    Dielectric : A boundary that refracts, with an `interior`.

    Examples
    --------
    >>> smoke = rw.Homogeneous(scattering=1.0)
    >>> scene = rw.Scene(rw.Sphere(material=rw.MediumInterface(smoke)))
    >>> round(scene.transmittance([0, 0, 5], [0, 0, -1])[0].item(), 4)
    0.1353
    """

    interior: Medium
    priority: int

    def __init__(self, interior: Medium, priority: int = 0) -> None:
        within = checked("interior", interior)
        if within is None:
            raise TypeError("interior must be a raywright medium, got None")
        self._set(interior=within, priority=integer("priority", priority, -(2**31), 2**31 - 1))
