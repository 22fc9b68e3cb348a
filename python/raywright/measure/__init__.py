"""Measurements with rays: sky and sun, laser scans, lines of sight, wall thickness and cross sections."""

from __future__ import annotations

from ..public_names import public_names
from .cracks import Topology, topology
from .cuts import CrossSection, cross_section
from .hemispheres import Estimate, ambient_visibility, sky_view
from .plots import plot
from .scanners import RasterLidar, SpinningLidar
from .scans import Lidar, LidarScan, lidar
from .sight import LineOfSight, line_of_sight
from .sun import SolarExposure, solar_exposure, sun_directions
from .walls import thickness

__all__ = [
    "CrossSection",
    "Estimate",
    "Lidar",
    "LidarScan",
    "LineOfSight",
    "RasterLidar",
    "SolarExposure",
    "SpinningLidar",
    "Topology",
    "ambient_visibility",
    "cross_section",
    "lidar",
    "line_of_sight",
    "plot",
    "sky_view",
    "solar_exposure",
    "sun_directions",
    "thickness",
    "topology",
]
__dir__ = public_names(__name__)
