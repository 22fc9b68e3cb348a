"""Ambient occlusion."""

import math
from dataclasses import dataclass

from ..arrays import positive
from . import counts


@dataclass(frozen=True)
class AmbientOcclusion:
    """How open the surroundings of what is seen are: the share of directions in which nothing is near.

    After Zhukov, Iones and Kronin (1998). Where nothing is seen, the picture is white.

    Parameters
    ----------
    radius : float
        How near what occludes has to be, in the scene's unit, above 0; infinite for anything.
    cosine : bool
        Whether directions count by their cosine, as even light does, or all alike.
    samples : int
        Directions that each camera ray asks, 1 to 1024.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument is of the wrong kind.
    """

    radius: float = math.inf
    cosine: bool = True
    samples: int = 1

    def __post_init__(self) -> None:
        if not isinstance(self.cosine, bool):
            raise TypeError(f"cosine must be True or False, got {self.cosine!r}")
        if self.radius != math.inf:
            object.__setattr__(self, "radius", positive("radius", self.radius))
        object.__setattr__(self, "samples", counts.samples("samples", self.samples))
