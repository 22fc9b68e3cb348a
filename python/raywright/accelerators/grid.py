"""Grids of cells."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

from ..arrays import choice, integer, positive

Mailbox = Literal["stamps", "cache", "none"]
_MOST_CELLS = 4096
_MOST_CELLS_IN_ALL = 2**27
_GREATEST_DENSITY = 1000.0


@dataclass(frozen=True)
class Grid:
    """A uniform grid, walked from cell to cell (Amanatides and Woo 1987, "A fast voxel traversal algorithm").

    Fast to build, small, and fast to trace where primitives have about one size and are evenly spread. A
    single resolution does not suit a scene with fine detail in a small part: see `NestedGrid`.

    Parameters
    ----------
    resolution : int or 3 ints, optional
        Number of cells along the longest side, with the others in proportion, or along x, y and z; 1 to 4096
        each and at most 2^27 together. It follows from `density` if not given. There are fewer if they would
        be thinner than the resolution of rays (about 1/20,000 of the scene), or if references to primitives
        would exhaust the memory.
    density : float
        Cells for each primitive, more than 0 and at most 1000, by the cube-root rule (Cleary and Wyvill 1988,
        "Analysis of an algorithm for fast ray tracing using uniform space subdivision"), or by a square root
        if the scene is flat.
    mailbox : {"stamps", "cache", "none"}
        Method to avoid testing a primitive again in another cell: a stamp for each primitive (Amanatides and
        Woo 1987), a small hashed cache (Benthin 2006, "Realtime ray tracing on current CPU architectures"),
        or none. Hits are the same.

    Raises
    ------
    ValueError
        If a value is outside its range or the mailbox is not known.
    TypeError
        If a value is not a number.

    See Also
    --------
    NestedGrid : Grids in grids.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.accelerators.Grid(density=2))
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    resolution: int | tuple[int, int, int] | None = None
    density: float = 0.5
    mailbox: Mailbox = "stamps"

    def __post_init__(self) -> None:
        object.__setattr__(self, "resolution", _resolution(self.resolution))
        object.__setattr__(self, "density", _density(self.density))
        choice("mailbox", self.mailbox, get_args(Mailbox))


@dataclass(frozen=True)
class NestedGrid:
    """Grids in the dense cells of a grid (Jevans and Wyvill 1989, "Adaptive voxel subdivision").

    For scenes with much finer detail in some places than in others. A cell gets its own grid, around its
    primitives, if that lowers the cost by the surface area heuristic.

    Parameters
    ----------
    resolution : int or 3 ints, optional
        Cells of the outermost grid, as for `Grid`; by `density` if not given.
    density : float
        Cells for each primitive in every grid, more than 0 and at most 1000, by the cube-root rule.
    leaf : int
        Maximum number of primitives of a cell without a grid; at least 1.
    depth : int
        Maximum number of nested levels, 1 to 16.
    mailbox : {"stamps", "cache", "none"}
        Mailbox against testing a primitive again in another cell, as for `Grid`.

    Raises
    ------
    ValueError
        If a value is outside its range or the mailbox is not known.
    TypeError
        If a value is not a number.

    See Also
    --------
    Grid : One grid.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> scene = rw.Scene(knot, accelerator=rw.accelerators.NestedGrid())
    >>> same = rw.Scene(knot, accelerator=rw.BruteForce())
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> bool((scene.intersect(*rays).t == same.intersect(*rays).t).all())
    True
    """

    resolution: int | tuple[int, int, int] | None = None
    density: float = 1.0
    leaf: int = 8
    depth: int = 5
    mailbox: Mailbox = "stamps"

    def __post_init__(self) -> None:
        object.__setattr__(self, "resolution", _resolution(self.resolution))
        object.__setattr__(self, "density", _density(self.density))
        object.__setattr__(self, "leaf", integer("leaf", self.leaf, 1, 2**31 - 1))
        object.__setattr__(self, "depth", integer("depth", self.depth, 1, 16))
        choice("mailbox", self.mailbox, get_args(Mailbox))


def _resolution(value: object) -> int | tuple[int, int, int] | None:
    """Return the cells of a grid, one number or three, as plain integers within what a grid can have."""
    if value is None:
        return None
    if isinstance(value, str) or not hasattr(value, "__len__"):
        return integer("resolution", value, 1, _MOST_CELLS)  # type: ignore[arg-type]
    if len(value) != 3:
        raise ValueError(f"resolution must be one integer or 3, got {len(value)}")
    x, y, z = (integer("resolution", cells, 1, _MOST_CELLS) for cells in value)  # type: ignore[attr-defined]
    if math.prod((x, y, z)) > _MOST_CELLS_IN_ALL:
        raise ValueError(f"resolution must make at most {_MOST_CELLS_IN_ALL} cells, got {x} x {y} x {z}")
    return x, y, z


def _density(value: float) -> float:
    density = positive("density", value)
    if density > _GREATEST_DENSITY:
        raise ValueError(f"density must be at most {_GREATEST_DENSITY:g}, got {value}")
    return density
