"""Ray casting."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, colour
from . import counts


@dataclass(frozen=True, init=False)
class RayCast:
    """Ray casting with shadows (Appel 1968): lights, by the scattering of what is seen, and ambient light.

    Nothing is followed further: mirrors and glass are black.

    Parameters
    ----------
    ambient : float or 3 floats
        Radiance that arrives from everywhere, unshadowed. Surfaces reflect their ambient share of it: `Phong`
        and `BlinnPhong` one of their own, smooth ones none, others about what they reflect of white light.
    shadows : bool
        Whether what lies on the way to a light shadows it.
    light_samples : int
        Light samples at each point seen, from equal shares of the lights: 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument is of the wrong kind.
    """

    ambient: Triple
    shadows: bool
    light_samples: int

    def __init__(self, ambient: ArrayLike = 0.0, shadows: bool = True, light_samples: int = 1) -> None:
        if not isinstance(shadows, bool):
            raise TypeError(f"shadows must be True or False, got {shadows!r}")
        object.__setattr__(self, "ambient", colour("ambient", ambient))
        object.__setattr__(self, "shadows", shadows)
        object.__setattr__(self, "light_samples", counts.samples("light_samples", light_samples))
