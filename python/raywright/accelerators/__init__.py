"""Choice of the structure that finds hits."""

from __future__ import annotations

from .._core import AcceleratorInfo
from ..public_names import public_names
from .brute import BruteForce
from .bvh import BVH, Builder, Optimizer, Traversal, Volume
from .choices import Accelerator
from .choices import every as every
from .choices import name_of as name_of
from .grid import Grid, Mailbox, NestedGrid
from .space import BSP, KdBuilder, KdTraversal, KdTree, Octree

__all__ = [
    "BSP",
    "BVH",
    "Accelerator",
    "AcceleratorInfo",
    "BruteForce",
    "Builder",
    "Grid",
    "KdBuilder",
    "KdTraversal",
    "KdTree",
    "Mailbox",
    "NestedGrid",
    "Octree",
    "Optimizer",
    "Traversal",
    "Volume",
]
__dir__ = public_names(__name__)
