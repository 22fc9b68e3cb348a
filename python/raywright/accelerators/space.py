"""Structures that part space by planes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from ..arrays import choice, integer, number, positive

KdBuilder = Literal["sah", "median", "middle", "cycle"]
KdTraversal = Literal["stack", "restart"]
_MOST_LEVELS = 60


@dataclass(frozen=True)
class KdTree:
    """A kD-tree: space parted by planes across its axes, in nodes of 8 bytes.

    A primitive is in every leaf that it overlaps; a ray still tests it only once.

    Parameters
    ----------
    builder : {"sah", "median", "middle", "cycle"}
        Placement of planes. All clip primitives to the cell.

        - ``"sah"``: where the surface area heuristic expects the least work, among all ends of clipped
          primitives, in n log n (Wald and Havran 2006, "On building fast kd-trees for ray tracing, and on
          doing that in O(N log N)").
        - ``"median"``: across the cell's longest axis, at the median of the primitives' centers.
        - ``"middle"``: in the middle of the cell's longest axis.
        - ``"cycle"``: across one axis after the other, at the median (Bentley 1975, "Multidimensional
          binary search trees used for associative searching").
    traversal : {"stack", "restart"}
        Traversal: with a stack (Hapala and Havran 2011, "Review: Kd-tree traversal algorithms for ray
        tracing"), or without, from the top again after each leaf (Foley and Sugerman 2005; Horn et al. 2007;
        Laine 2010, "Restart trail for stackless BVH traversal"). Both visit the same leaves in the same
        order.
    traversal_cost, intersection_cost : float
        Cost of visiting a node and of testing a primitive; only their ratio matters. For ``"sah"``.
    empty_bonus : float
        Reduction of the cost of a plane with nothing on one side, 0 to 1. For ``"sah"``.
    max_depth : int, optional
        Maximum depth below the root, 0 to 60; 8 + 1.3 log2(n) for n primitives if not given.
    leaf_size : int
        Maximum number of primitives of a leaf that is not split.

    Raises
    ------
    ValueError
        If a value is outside its range, or the builder or the traversal is not known.
    TypeError
        If a value is not a number.

    See Also
    --------
    BSP : Planes in any direction.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.accelerators.KdTree(builder="median"))
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    builder: KdBuilder = "sah"
    traversal: KdTraversal = "stack"
    traversal_cost: float = 1.0
    intersection_cost: float = 0.1
    empty_bonus: float = 0.2
    max_depth: int | None = None
    leaf_size: int = 8

    def __post_init__(self) -> None:
        choice("builder", self.builder, get_args(KdBuilder))
        choice("traversal", self.traversal, get_args(KdTraversal))
        bonus = number("empty_bonus", self.empty_bonus)
        if not 0 <= bonus <= 1:
            raise ValueError(f"empty_bonus must be between 0 and 1, got {self.empty_bonus}")
        object.__setattr__(self, "empty_bonus", bonus)
        _keep_costs(self, self.traversal_cost, self.intersection_cost)
        _keep_limits(self, self.max_depth, _MOST_LEVELS, self.leaf_size)


@dataclass(frozen=True)
class Octree:
    """An octree: cells halved across all axes at once, in nodes of 4 bytes.

    Traversal follows the parameters at which a ray meets the planes of cells; those of children are halfway
    between (Revelles, Urena and Lastra 2000, "An efficient parametric algorithm for octree traversal").

    Parameters
    ----------
    max_depth : int
        Maximum depth below the root, 0 to 18.
    leaf_size : int
        Maximum number of primitives of a leaf that is not split. A node is not split if that would save no
        tests.

    Raises
    ------
    ValueError
        If a value is outside its range.
    TypeError
        If a value is not an integer.

    See Also
    --------
    KdTree : One plane a node.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.accelerators.Octree())
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    max_depth: int = 12
    leaf_size: int = 8

    def __post_init__(self) -> None:
        object.__setattr__(self, "max_depth", integer("max_depth", self.max_depth, 0, 18))
        object.__setattr__(self, "leaf_size", integer("leaf_size", self.leaf_size, 1))


@dataclass(frozen=True)
class BSP:
    """A binary space partition: a tree of planes in any direction, taken from the polygons.

    After Fuchs, Kedem and Naylor (1980, "On visible surface generation by a priori tree structures") and,
    for rays, Ize, Wald and Parker (2008, "Ray tracing with the BSP tree"): each cell tries planes of a few
    of its polygons, its own plane, three through its edges and six across axes, and takes the plane of least
    cost by the surface area heuristic. Polygons that straddle it are cut.

    Parameters
    ----------
    candidates : int
        Number of polygons of a cell that give planes, 1 to 1024.
    traversal_cost, intersection_cost : float
        Cost of visiting a node and of testing a primitive; only their ratio matters.
    max_depth : int, optional
        Maximum depth below the root, 0 to 60; 8 + 1.3 log2(n) for n primitives if not given.
    leaf_size : int
        Maximum number of primitives of a leaf that is not split.

    Raises
    ------
    ValueError
        If a value is outside its range.
    TypeError
        If a value is not a number.

    See Also
    --------
    KdTree : Planes across the axes.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.accelerators.BSP(candidates=2))
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    candidates: int = 4
    traversal_cost: float = 1.0
    intersection_cost: float = 1.0
    max_depth: int | None = None
    leaf_size: int = 2

    def __post_init__(self) -> None:
        object.__setattr__(self, "candidates", integer("candidates", self.candidates, 1, 1024))
        _keep_costs(self, self.traversal_cost, self.intersection_cost)
        _keep_limits(self, self.max_depth, _MOST_LEVELS, self.leaf_size)


def _keep_costs(owner: object, traversal: float, intersection: float) -> None:
    object.__setattr__(owner, "traversal_cost", positive("traversal_cost", traversal))
    object.__setattr__(owner, "intersection_cost", positive("intersection_cost", intersection))


def _keep_limits(owner: object, depth: int | None, most: int, leaf_size: int) -> None:
    if depth is not None:
        object.__setattr__(owner, "max_depth", integer("max_depth", depth, 0, most))
    object.__setattr__(owner, "leaf_size", integer("leaf_size", leaf_size, 1))
