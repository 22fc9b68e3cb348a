"""Integrators: estimators of the radiance along rays."""

from __future__ import annotations

from typing import TypeAlias

from ..public_names import public_names
from .ambient_occlusion import AmbientOcclusion
from .base import CoreIntegrator, Integrator
from .beam_traced import BeamTraced
from .bidirectional import Bidirectional
from .cone_traced import ConeTraced
from .direct import Direct
from .distributed import Distributed
from .light_traced import LightTraced
from .path import Path
from .photon_maps import PhotonMap, ProgressivePhotonMap
from .radiosity import Radiosity
from .ray_cast import RayCast
from .rng import Rng
from .whitted import Whitted

AnyIntegrator: TypeAlias = CoreIntegrator | Integrator

__all__ = [
    "AmbientOcclusion",
    "AnyIntegrator",
    "BeamTraced",
    "Bidirectional",
    "ConeTraced",
    "Direct",
    "Distributed",
    "Integrator",
    "LightTraced",
    "Path",
    "PhotonMap",
    "ProgressivePhotonMap",
    "Radiosity",
    "RayCast",
    "Rng",
    "Whitted",
]
__dir__ = public_names(__name__)


def check_integrator(name: str, value: object) -> None:
    """Refuse other objects than integrators.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(value, CoreIntegrator | Integrator):
        raise TypeError(f"{name} must be a raywright.Path, got {type(value).__name__}")
