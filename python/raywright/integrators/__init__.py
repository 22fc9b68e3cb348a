"""What turns rays into radiance."""

from typing import TypeAlias, get_args

from .ambient_occlusion import AmbientOcclusion
from .base import Integrator
from .direct import Direct
from .distributed import Distributed
from .light_traced import LightTraced
from .path import Path
from .photon_maps import PhotonMap, ProgressivePhotonMap
from .ray_cast import RayCast
from .whitted import Whitted

AnyIntegrator: TypeAlias = (
    Path
    | LightTraced
    | PhotonMap
    | ProgressivePhotonMap
    | Direct
    | RayCast
    | Whitted
    | Distributed
    | AmbientOcclusion
    | Integrator
)

__all__ = [
    "AmbientOcclusion",
    "AnyIntegrator",
    "Direct",
    "Distributed",
    "LightTraced",
    "Path",
    "PhotonMap",
    "ProgressivePhotonMap",
    "RayCast",
    "Whitted",
    "check_integrator",
]


def check_integrator(name: str, value: object) -> None:
    """Refuse what is no integrator.

    Raises
    ------
    TypeError
        If it is none.
    """
    if not isinstance(value, get_args(AnyIntegrator)):
        raise TypeError(f"{name} must be a raywright.Path, got {type(value).__name__}")
