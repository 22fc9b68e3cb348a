"""What turns rays into radiance."""

from typing import TypeAlias, get_args

from .ambient_occlusion import AmbientOcclusion
from .base import Integrator
from .bidirectional import Bidirectional
from .direct import Direct
from .distributed import Distributed
from .light_traced import LightTraced
from .path import Path
from .ray_cast import RayCast
from .whitted import Whitted

AnyIntegrator: TypeAlias = (
    Path
    | Bidirectional
    | LightTraced
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
    "Bidirectional",
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
