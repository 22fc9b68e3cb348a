"""What turns rays into radiance."""

from typing import TypeAlias, get_args

from .ambient_occlusion import AmbientOcclusion
from .base import Integrator
from .beam_traced import BeamTraced
from .direct import Direct
from .distributed import Distributed
from .light_traced import LightTraced
from .path import Path
from .ray_cast import RayCast
from .whitted import Whitted

AnyIntegrator: TypeAlias = (
    Path | LightTraced | Direct | RayCast | Whitted | Distributed | BeamTraced | AmbientOcclusion | Integrator
)

__all__ = [
    "AmbientOcclusion",
    "AnyIntegrator",
    "BeamTraced",
    "Direct",
    "Distributed",
    "LightTraced",
    "Path",
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
