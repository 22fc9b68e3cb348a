"""Choice of the structure that finds hits."""

from dataclasses import dataclass
from typing import Literal

from .arrays import integer, positive

Builder = Literal["binned"]
_BUILDERS = ("binned",)


@dataclass(frozen=True)
class BVH:
    """A bounding volume hierarchy built by the surface area heuristic.

    Parameters
    ----------
    builder : {"binned"}
        How the tree is built. ``"binned"`` tries a few planes on each axis (Wald 2007, "On fast construction
        of SAH-based bounding volume hierarchies").
    bins : int
        Bins for each axis, 2 to 64.
    traversal_cost, intersection_cost : float
        Cost of visiting a node and of testing a primitive, in any one unit; only their ratio matters.

    Raises
    ------
    ValueError
        If a value is outside its range or the builder is not known.
    TypeError
        If a value is not a number.
    """

    builder: Builder = "binned"
    bins: int = 16
    traversal_cost: float = 1.0
    intersection_cost: float = 1.0

    def __post_init__(self) -> None:
        if self.builder not in _BUILDERS:
            raise ValueError(
                f"builder must be one of {', '.join(map(repr, _BUILDERS))}, got {self.builder!r}"
            )
        object.__setattr__(self, "bins", integer("bins", self.bins, 2, 64))
        object.__setattr__(self, "traversal_cost", positive("traversal_cost", self.traversal_cost))
        object.__setattr__(self, "intersection_cost", positive("intersection_cost", self.intersection_cost))


@dataclass(frozen=True)
class BruteForce:
    """No structure at all: every ray is tested against every primitive. The oracle for the others."""


Accelerator = BVH | BruteForce
