"""Bounding volume hierarchies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from ..arrays import choice, integer, number, positive

Builder = Literal["binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"]
Optimizer = Literal["reinsertion", "treelet"]
Traversal = Literal[
    "wide", "wide4", "wide8", "stack", "threaded", "packets4", "packets64", "flat", "stackless"
]
Volume = Literal["box", "oriented", "slabs"]
_MOST_BUDGET = 8.0
# Builders that use each option; the others would ignore it.
_BINS, _BUDGET, _RADIUS = ("binned", "spatial"), ("spatial",), ("ploc",)


@dataclass(frozen=True)
class BVH:
    """A bounding volume hierarchy: a binary tree, optionally optimized, and its traversal.

    Parameters
    ----------
    builder : {"binned", "sweep", "spatial", "morton", "ploc", "midpoint", "median", "mean"}
        Construction of the binary tree.

        - ``"binned"``: by the surface area heuristic at a few planes on each axis (Wald 2007, "On fast
          construction of SAH-based bounding volume hierarchies").
        - ``"sweep"``: by the surface area heuristic at every possible split along an axis (MacDonald and
          Booth 1990, "Heuristics for ray tracing using space subdivision").
        - ``"spatial"``: by the surface area heuristic with spatial splits, which divide primitives that
          straddle a plane (Stich, Friedrich and Dietrich 2009, "Spatial splits in bounding volume
          hierarchies"). If many primitives are long and diagonal, they are first cut into pieces (Ernst and
          Greiner 2007, "Early split clipping for bounding volume hierarchies"). `Scene.refit` has to rebuild
          such a tree.
        - ``"morton"``: a linear tree in the order of Morton codes of 63 bits (Lauterbach et al. 2009, "Fast
          BVH construction on GPUs").
        - ``"ploc"``: from the bottom up (Meister and Bittner 2018, "Parallel locally-ordered clustering for
          bounding volume hierarchy construction").
        - ``"midpoint"``, ``"median"``, ``"mean"``: halves along the longest axis of the centers (Kay and
          Kajiya 1986, "Ray tracing complex scenes").
    bins : int, optional
        Bins for each axis, 2 to 64; chosen by the scene's ``quality`` if not given. For ``"binned"`` and
        ``"spatial"``.
    traversal_cost, intersection_cost : float
        Cost of visiting a node and of testing a leaf's block of primitives; only their ratio matters. They
        decide between leaf and split.
    budget : float, optional
        Number of references that cuts and spatial splits may add, over the number of primitives, 0 to 8; 4 if
        not given. They add none if they gain little. For ``"spatial"``.
    radius : int, optional
        Search radius of clusters in the order of Morton codes, 1 to 128; 14 if not given. For ``"ploc"``.
    optimize : {"reinsertion", "treelet"} or a tuple of these, optional
        Optimizations of the tree, in turn. ``"reinsertion"`` moves subtrees to places of less cost (Meister
        and Bittner 2018, "Parallel reinsertion for bounding volume hierarchy optimization"). ``"treelet"``
        restructures treelets of seven leaves (Karras and Aila 2013, "Fast parallel construction of
        high-quality bounding volume hierarchies"). If not given, the scene's ``quality`` chooses for
        ``"binned"``, and the other builders have none; ``()`` disables all. For long and diagonal geometry,
        the quality may also choose spatial splits, or cutting into pieces first.
    traversal : {"wide", "wide4", "wide8", "stack", "threaded", "packets4", "packets64", "flat", "stackless"}
        Traversal of the tree. Hits are the same.

        - ``"wide"``: the tree is collapsed to one of 8 children a node, or 4 where the processor has no AVX2
          (Wald, Benthin and Boulos 2008, "Getting rid of packets"), which packets or waves of rays traverse,
          depending on the batch. The fastest.
        - ``"wide4"``, ``"wide8"``: the same with that width. 8 needs AVX2.
        - ``"stack"``: the binary tree, one ray after the other, the nearer child first and the other on a
          stack with its distance (Kay and Kajiya 1986). Any-hit queries sort nothing, and take the
          larger child first.
        - ``"threaded"``: without a stack: each node has a link for a hit and one for a miss (Smits 1998,
          "Efficiency issues for ray tracing"), for each of several directions (Hachisuka 2015, "Implementing
          a photorealistic rendering system using GLSL").
        - ``"packets4"``: with a stack, four rays together (Wald et al. 2001, "Interactive rendering with
          coherent ray tracing").
        - ``"packets64"``: with a stack, 64 rays together, with the first and the last active one known, and
          an interval test of all of them (Wald, Boulos and Shirley 2007, "Ray tracing deformable
          scenes using dynamic bounding volume hierarchies"; Overbeck, Ramamoorthi and Mark 2008, "Large ray
          packets for real-time Whitted ray tracing"). For coherent rays.
        - ``"flat"``: the tree as arrays without pointers, as `Scene.gpu_arrays` has it, with a stack.
        - ``"stackless"``: the same without a stack: each node has the index of the next node if its box is
          missed (Smits 1998), in one order for all rays.

        The wide traversals keep triangles and other shapes in separate trees, all others in one.
    orders : {6, 8}, optional
        Number of orders of ``"threaded"``: one for each half of each axis, or one for each octant; 8 if not
        given. Each takes 8 bytes per node.
    bounds : {"box", "oriented", "slabs"}
        Bounds of nodes besides their boxes, for ``"stack"``: none; oriented boxes, if these have less surface
        (Gottschalk, Lin and Manocha 1996, "OBBTree"); or slabs along ten diagonals (Kay and Kajiya 1986).
        They save tests of diagonal geometry, but cost up to 80 bytes and a longer test for each node, and a
        longer build.

    Raises
    ------
    ValueError
        If a value is outside its range, a name is not known, or the builder or the traversal does not have an
        option that is given. A scene raises it for ``"wide8"`` where there is no AVX2.
    TypeError
        If a value is not a number.

    See Also
    --------
    report.accelerators : Compare accelerators.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.BVH(builder="sweep"))
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    builder: Builder = "binned"
    bins: int | None = None
    traversal_cost: float = 1.0
    intersection_cost: float = 1.0
    budget: float | None = None
    radius: int | None = None
    optimize: Optimizer | tuple[Optimizer, ...] | None = None
    traversal: Traversal = "wide"
    orders: Literal[6, 8] | None = None
    bounds: Volume = "box"

    # Values of other options that each option requires.
    needs: ClassVar[dict[str, dict[str, str]]] = {"bounds": {"traversal": "stack"}}

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
        if self.optimize is not None:
            self._keep("optimize", _optimizers(self.optimize))
        choice("traversal", self.traversal, get_args(Traversal))
        if self.orders is not None:
            orders = integer("orders", self.orders, 6, 8)
            if orders == 7:
                raise ValueError(f"orders must be 6 or 8, got {self.orders}")
            if self.traversal != "threaded":
                raise ValueError(f"orders is for traversal 'threaded', got traversal {self.traversal!r}")
            self._keep("orders", orders)
        choice("bounds", self.bounds, get_args(Volume))
        if self.bounds != "box" and self.traversal != "stack":
            raise ValueError(f"bounds is for traversal 'stack', got traversal {self.traversal!r}")

    def _keep(self, name: str, value: object, builders: tuple[str, ...] | None = None) -> None:
        if builders is not None and self.builder not in builders:
            allowed = " or ".join(map(repr, builders))
            raise ValueError(f"{name} is for builder {allowed}, got builder {self.builder!r}")
        object.__setattr__(self, name, value)


def _optimizers(value: object) -> tuple[str, ...]:
    """Return one name or several as a tuple of names, each at most once."""
    names = (value,) if isinstance(value, str) else value
    if not isinstance(names, tuple | list):
        raise TypeError(f"optimize must be a name or a tuple of names, got {value!r}")
    for name in names:
        choice("optimize", name, get_args(Optimizer))
    if len(set(names)) != len(names):
        raise ValueError(f"optimize must name each optimizer at most once, got {value!r}")
    return tuple(names)
