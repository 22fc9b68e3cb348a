"""Reports on cost and error against time."""

from __future__ import annotations

from ..public_names import public_names
from .accelerators import AcceleratorReport, accelerators, rays_per_build
from .contest import Measured
from .convergence import ConvergenceReport, Fit, convergence
from .first_hits import first_hits
from .heatmap import Heatmap, heatmap
from .per_build import BuildRow, RaysPerBuild
from .ray_sets import Rays, typical_rays
from .table import Chart, Column, Table
from .time_share import TimeShare, time_share
from .tree import tree
from .triangle_kernels import KernelReport, KernelRow, kernels

__all__ = [
    "AcceleratorReport",
    "BuildRow",
    "Chart",
    "Column",
    "ConvergenceReport",
    "Fit",
    "Heatmap",
    "KernelReport",
    "KernelRow",
    "Measured",
    "Rays",
    "RaysPerBuild",
    "Table",
    "TimeShare",
    "accelerators",
    "convergence",
    "first_hits",
    "heatmap",
    "kernels",
    "rays_per_build",
    "time_share",
    "tree",
    "typical_rays",
]
__dir__ = public_names(__name__)
