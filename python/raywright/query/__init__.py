"""Queries of rays and points, and their results."""

from __future__ import annotations

from .all_hits import AllHits
from .cones import ConeCoverage, ConeFaces
from .gpu_arrays import GpuArrays
from .hits import ClosestPoints, Hits, TraversalCost
from .interactions import BsdfSamples, Interactions, LightSamples, Rays, power_heuristic
from .photons import Photons
from .spawned_rays import SpawnedRays
from .surface import Surface
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
