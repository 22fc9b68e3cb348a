"""Choice of the structure that finds hits."""

from dataclasses import dataclass
from typing import Literal

from .arrays import choice, integer, positive

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
    bins : int, optional
        Bins for each axis, 2 to 64; as many as suit the scene's ``quality`` if not given.
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
    bins: int | None = None
    traversal_cost: float = 1.0
    intersection_cost: float = 1.0

    def __post_init__(self) -> None:
        choice("builder", self.builder, _BUILDERS)
        if self.bins is not None:
            object.__setattr__(self, "bins", integer("bins", self.bins, 2, 64))
        object.__setattr__(self, "traversal_cost", positive("traversal_cost", self.traversal_cost))
        object.__setattr__(self, "intersection_cost", positive("intersection_cost", self.intersection_cost))


@dataclass(frozen=True)
class BruteForce:
    """No structure at all: every ray is tested against every primitive. The oracle for the others."""


Accelerator = BVH | BruteForce
