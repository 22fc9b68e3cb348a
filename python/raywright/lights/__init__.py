"""Lights: light sources without surface, environments, and emission of surfaces."""

from __future__ import annotations

from collections.abc import Sequence
from typing import cast

from numpy.typing import ArrayLike

from ..public_names import public_names
from .constant import ConstantEnvironment
from .directional import DirectionalLight
from .emission import Emission
from .environment_map import EnvironmentMap
from .light import Environment as Environment
from .light import Light as Light
from .point import PointLight
from .projector import ProjectorLight
from .spot import SpotLight
from .sun_sky import SunSky

__all__ = [
    "ConstantEnvironment",
    "DirectionalLight",
    "Emission",
    "EnvironmentMap",
    "PointLight",
    "ProjectorLight",
    "SpotLight",
    "SunSky",
]
__dir__ = public_names(__name__)


def lights(value: object) -> tuple[Light, ...]:
    """Return one light or a sequence of them as a tuple, having checked that they are."""
    given = tuple(value) if isinstance(value, list | tuple) else (value,)
    for light in given:
        if not isinstance(light, Light):
            raise TypeError(f"lights must be raywright lights, got {type(light).__name__}")
    return given


def environments(
    value: Environment | Sequence[Environment] | ArrayLike | None,
) -> Environment | tuple[Environment, ...] | None:
    """Return what surrounds a scene: numbers as a constant radiance, and several environments as a tuple."""
    if value is None or isinstance(value, Environment):
        return value
    if isinstance(value, list | tuple) and any(isinstance(one, Environment) for one in value):
        for one in value:
            if not isinstance(one, Environment):
                raise TypeError(
                    f"environment must be one environment or a sequence of them, got {type(one).__name__}"
                )
        return tuple(value)
    return ConstantEnvironment(cast(ArrayLike, value))
