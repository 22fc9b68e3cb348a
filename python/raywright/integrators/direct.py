"""Direct light."""

from dataclasses import dataclass

from . import counts


@dataclass(frozen=True)
class Direct:
    """What shines, and what is lit by it: one bounce.

    Lights and surfaces are both sampled and combined by multiple importance sampling (Veach and Guibas 1995).
    It is ``Path(max_depth=1)`` with a choice of how often each is sampled.

    Parameters
    ----------
    light_samples : int
        Light samples at each point seen, from equal shares of the lights: 1 to 1024.
    surface_samples : int
        Directions drawn from the scattering there, 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If it is not an integer.
    """

    light_samples: int = 1
    surface_samples: int = 1

    def __post_init__(self) -> None:
        for name in ("light_samples", "surface_samples"):
            object.__setattr__(self, name, counts.samples(name, getattr(self, name)))
