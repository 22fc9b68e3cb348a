"""Lights: light sources without surface, environments, and emission of surfaces."""

from collections.abc import Sequence
from typing import TypeAlias, cast, get_args

from numpy.typing import ArrayLike

from .constant import ConstantEnvironment
from .directional import DirectionalLight
from .emission import Emission
from .environment_map import EnvironmentMap
from .point import PointLight
from .projector import ProjectorLight
from .spot import SpotLight
from .sun_sky import SunSky

Light: TypeAlias = PointLight | SpotLight | DirectionalLight | ProjectorLight
Environment: TypeAlias = ConstantEnvironment | EnvironmentMap | SunSky

__all__ = [
    "ConstantEnvironment",
    "DirectionalLight",
    "Emission",
    "Environment",
    "EnvironmentMap",
    "Light",
    "PointLight",
    "ProjectorLight",
    "SpotLight",
    "SunSky",
    "environments",
    "lights",
]


def lights(value: object) -> tuple[Light, ...]:
    """Return one light or a sequence of them as a tuple, having checked that they are."""
    given = tuple(value) if isinstance(value, list | tuple) else (value,)
    for light in given:
        if not isinstance(light, get_args(Light)):
            raise TypeError(f"lights must be raywright lights, got {type(light).__name__}")
    return given


def environments(
    value: "Environment | Sequence[Environment] | ArrayLike | None",
) -> "Environment | tuple[Environment, ...] | None":
    """Return an environment: numbers as a constant radiance, and several environments as a tuple."""
    kinds = get_args(Environment)
    if value is None or isinstance(value, kinds):
        return value
    if isinstance(value, list | tuple) and any(isinstance(one, kinds) for one in value):
        for one in value:
            if not isinstance(one, kinds):
                raise TypeError(
                    f"environment must be environments only, if several, got {type(one).__name__}"
                )
        return tuple(value)
    return ConstantEnvironment(cast(ArrayLike, value))
