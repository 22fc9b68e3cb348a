"""Choice of the structure that finds hits."""

from .brute import BruteForce
from .bvh import BVH, Builder, Optimiser
from .choices import Accelerator, every, name_of
from .grid import Grid, Mailbox, NestedGrid

__all__ = [
    "BVH",
    "Accelerator",
    "BruteForce",
    "Builder",
    "Grid",
    "Mailbox",
    "NestedGrid",
    "Optimiser",
    "every",
    "name_of",
]
