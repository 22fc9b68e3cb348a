"""Participating media: smoke, haze, milk, clouds."""

from __future__ import annotations

from ..public_names import public_names
from .grid import GridMedium
from .homogeneous import Homogeneous
from .medium import Medium
from .medium import medium as medium
from .phases import HenyeyGreenstein, Isotropic, Phase, Rayleigh
from .sparse_grid import SparseGrid

__all__ = [
    "GridMedium",
    "HenyeyGreenstein",
    "Homogeneous",
    "Isotropic",
    "Medium",
    "Phase",
    "Rayleigh",
    "SparseGrid",
]
__dir__ = public_names(__name__)
