"""Bounding volume hierarchies."""

from dataclasses import dataclass
from typing import Literal, get_args

from ..arrays import choice, integer, number, positive

Builder = Literal["binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"]
Optimiser = Literal["reinsertion", "treelet"]
_MOST_BUDGET = 8.0
# Which builders an option is for; the others would ignore it.
_BINS, _BUDGET, _RADIUS = ("binned", "spatial"), ("spatial",), ("ploc",)


@dataclass(frozen=True)
class BVH:
    """A bounding volume hierarchy: a binary tree, improved if that is wanted, and made wide for the rays.

    Parameters
    ----------
    builder : {"binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"}
        How the binary tree is built.

        - ``"binned"``: by the surface area heuristic at a few planes on each axis (Wald 2007, "On fast
          construction of SAH-based bounding volume hierarchies").
        - ``"sweep"``: by the surface area heuristic wherever a set can be parted along an axis (MacDonald and
          Booth 1990, "Heuristics for ray tracing using space subdivision").
        - ``"spatial"``: by the surface area heuristic with spatial splits, which part what straddles a plane
          (Stich, Friedrich and Dietrich 2009, "Spatial splits in bounding volume hierarchies"), after what
          is long and diagonal has been cut to pieces (Ernst and Greiner 2007, "Early split clipping for
          bounding volume hierarchies"). A scene that moves has to build it again.
        - ``"morton"``: a linear tree in the order of Morton codes of 63 bits (Lauterbach et al. 2009, "Fast
          BVH construction on GPUs").
        - ``"ploc"``: from the bottom up (Meister and Bittner 2018, "Parallel locally-ordered clustering for
          bounding volume hierarchy construction").
        - ``"midpoint"``, ``"median"``, ``"mean"``: halves along the longest axis of the centres (Kay and
          Kajiya 1986, "Ray tracing complex scenes").
    bins : int, optional
        Bins for each axis, 2 to 64; as many as suit the scene's ``quality`` if not given. For ``"binned"``
        and ``"spatial"``.
    traversal_cost, intersection_cost : float
        Cost of visiting a node and of testing a leaf's block of primitives, in any one unit; only their ratio
        matters. They decide what becomes a leaf.
    budget : float, optional
        How many references cuts and spatial splits may add, over the number of primitives, 0 to 8; 4 if not
        given. Where they gain little they add none. For ``"spatial"``.
    radius : int, optional
        How far off in the order of Morton codes clusters seek each other, 1 to 128; 14 if not given. For
        ``"ploc"``.
    optimise : {"reinsertion", "treelet"} or a tuple of these, optional
        What improves the tree, in turn. ``"reinsertion"`` moves subtrees to where they cost less (Meister and
        Bittner 2018, "Parallel reinsertion for bounding volume hierarchy optimization"). ``"treelet"`` puts
        treelets of seven leaves together anew (Karras and Aila 2013, "Fast parallel construction of
        high-quality bounding volume hierarchies"). If not given, what suits the scene's ``quality`` for
        ``"binned"``, and nothing for the others; with ``()`` nothing at all. What suits the quality may be,
        for long and diagonal geometry, that it is cut to pieces first.

    Raises
    ------
    ValueError
        If a value is outside its range, a name is not known, or the builder does not have an option that is
        given.
    TypeError
        If a value is not a number.
    """

    builder: Builder = "binned"
    bins: int | None = None
    traversal_cost: float = 1.0
    intersection_cost: float = 1.0
    budget: float | None = None
    radius: int | None = None
    optimise: Optimiser | tuple[Optimiser, ...] | None = None

    def __post_init__(self) -> None:
        choice("builder", self.builder, get_args(Builder))
        if self.bins is not None:
            self._keep("bins", integer("bins", self.bins, 2, 64), _BINS)
        self._keep("traversal_cost", positive("traversal_cost", self.traversal_cost))
        self._keep("intersection_cost", positive("intersection_cost", self.intersection_cost))
        if self.budget is not None:
            budget = number("budget", self.budget)
            if not 0 <= budget <= _MOST_BUDGET:
                raise ValueError(f"budget must be between 0 and {_MOST_BUDGET:g}, got {self.budget}")
            self._keep("budget", budget, _BUDGET)
        if self.radius is not None:
            self._keep("radius", integer("radius", self.radius, 1, 128), _RADIUS)
        if self.optimise is not None:
            self._keep("optimise", _optimisers(self.optimise))

    def _keep(self, name: str, value: object, builders: tuple[str, ...] | None = None) -> None:
        if builders is not None and self.builder not in builders:
            allowed = " or ".join(map(repr, builders))
            raise ValueError(f"{name} is for builder {allowed}, got builder {self.builder!r}")
        object.__setattr__(self, name, value)


def _optimisers(value: object) -> tuple[str, ...]:
    """Return one name or several as a tuple of names, each at most once."""
    names = (value,) if isinstance(value, str) else value
    if not isinstance(names, tuple | list):
        raise TypeError(f"optimise must be a name or a tuple of names, got {value!r}")
    for name in names:
        choice("optimise", name, get_args(Optimiser))
    if len(set(names)) != len(names):
        raise ValueError(f"optimise must name each optimiser at most once, got {value!r}")
    return tuple(names)
