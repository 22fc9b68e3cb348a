"""Choice of the structure that finds hits."""

from .brute import BruteForce
from .bvh import BVH, Builder, Optimiser, Traversal, Volume
from .choices import Accelerator, every, name_of
from .grid import Grid, Mailbox, NestedGrid
from .space import BSP, KdBuilder, KdTraversal, KdTree, Octree

__all__ = [
    "BSP",
    "BVH",
    "Accelerator",
    "BruteForce",
    "Builder",
    "Grid",
    "KdBuilder",
    "KdTraversal",
    "KdTree",
    "Mailbox",
    "NestedGrid",
    "Octree",
    "Optimiser",
    "Traversal",
    "Volume",
    "every",
    "name_of",
]
