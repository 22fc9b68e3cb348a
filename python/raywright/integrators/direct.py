"""Direct light."""

from __future__ import annotations

from dataclasses import dataclass

from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True)
class Direct(CoreIntegrator):
    """Direct lighting: emitters, and surfaces that they light in one bounce.

    Lights and surfaces are both sampled and combined by multiple importance sampling (Veach and Guibas 1995).
    It is ``Path(max_depth=1)`` with a choice of both numbers of samples.

    Parameters
    ----------
    light_samples : int
        Light samples at each visible point, stratified over the lights: 1 to 1024.
    surface_samples : int
        BSDF samples at each visible point, 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If it is not an integer.

    See Also
    --------
    Path : All bounces.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 1), intensity=np.pi)])
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
    >>> image = rw.render(scene, camera, rw.Direct(), samples=4, progress=False)
    >>> print(image.rgb[0, 0].round(3))
    [0.5 0.5 0.5]
    """

    light_samples: int = 1
    surface_samples: int = 1

    def __post_init__(self) -> None:
        for name in ("light_samples", "surface_samples"):
            object.__setattr__(self, name, counts.samples(name, getattr(self, name)))
