"""Queries of rays and points, and their results."""

from __future__ import annotations

from ..public_names import public_names
from .all_hits import AllHits
from .closest_points import ClosestPoints
from .cones import ConeCoverage, ConeFaces
from .gpu_arrays import GpuArrays
from .hits import Hits
from .interactions import Interactions
from .mis_weights import power_heuristic
from .photons import Photons
from .ray_batch import Rays
from .scattering_samples import BsdfSamples, LightSamples
from .spawned_rays import SpawnedRays
from .surface import Surface
from .traversal_cost import TraversalCost
from .trees import TreeBoxes

__all__ = [
    "AllHits",
    "BsdfSamples",
    "ClosestPoints",
    "ConeCoverage",
    "ConeFaces",
    "GpuArrays",
    "Hits",
    "Interactions",
    "LightSamples",
    "Photons",
    "Rays",
    "SpawnedRays",
    "Surface",
    "TraversalCost",
    "TreeBoxes",
    "power_heuristic",
]
__dir__ = public_names(__name__)
