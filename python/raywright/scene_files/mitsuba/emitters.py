"""Emitters that are no surfaces: lights within a scene, and what surrounds it."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read_linear
from ...lights import (
    ConstantEnvironment,
    DirectionalLight,
    Environment,
    EnvironmentMap,
    Light,
    PointLight,
    SpotLight,
)
from .errors import SceneError
from .plugin import Plugin
from .textures import picture
from .transforms import Matrix, straightened
from .values import colour

TYPES = ("point", "spot", "directional", "constant", "envmap")

# Rows to which smaller environment maps are refined.
_ROWS = 1024
# In Mitsuba's maps the middle is seen along +z, in raywright's along -z.
_HALF_TURN: Matrix = np.diag([-1.0, 1.0, -1.0])


def emitter(plugin: Plugin) -> Light | Environment:
    """Return the light or the environment that a plugin stands for.

    Raises
    ------
    FileNotFoundError
        If its file is missing.
    ValueError
        If its type, or a parameter of it, is not supported; tells which.
    """
    readers: dict[str, Callable[[Plugin], Light | Environment]] = {
        "point": _point,
        "spot": _spot,
        "directional": _directional,
        "constant": _constant,
        "envmap": _map,
    }
    plugin.ignore("sampling_weight")
    try:
        result = readers[plugin.type](plugin)
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{plugin}: {error}") from error
    plugin.done()
    return result


def _point(plugin: Plugin) -> PointLight:
    if plugin.has("position"):
        if plugin.has("to_world"):
            plugin.fail("either position or to_world must be given, got both")
        position = plugin.vector("position", (0.0, 0.0, 0.0))
    else:
        position = plugin.to_world()[:3, 3]
    return PointLight(position, colour(plugin, "intensity", 1.0, emits=True))


def _spot(plugin: Plugin) -> SpotLight:
    if plugin.has("texture"):
        plugin.fail("a texture is not supported")
    matrix = plugin.to_world()
    cutoff = plugin.number("cutoff_angle", 20.0)
    beam = min(plugin.number("beam_width", 0.75 * cutoff), cutoff)
    return SpotLight(
        matrix[:3, 3],
        matrix[:3, 3] + _unit(matrix[:3, 2]),
        colour(plugin, "intensity", 1.0, emits=True),
        cutoff,
        cutoff - beam,
        "linear",
    )


def _directional(plugin: Plugin) -> DirectionalLight:
    if plugin.has("direction"):
        if plugin.has("to_world"):
            plugin.fail("either direction or to_world must be given, got both")
        direction = plugin.vector("direction", (0.0, 0.0, 1.0))
    else:
        direction = plugin.to_world()[:3, 2]
    return DirectionalLight(direction, colour(plugin, "irradiance", 1.0, emits=True))


def _constant(plugin: Plugin) -> ConstantEnvironment:
    return ConstantEnvironment(colour(plugin, "radiance", 1.0, emits=True))


def _map(plugin: Plugin) -> EnvironmentMap:
    if plugin.has("bitmap"):
        array = picture(plugin)[0]
        if array.dtype.kind != "f":
            plugin.fail(f"bitmap must hold floats, got {array.dtype}")
        image: NDArray[Any] = np.broadcast_to(array, (*array.shape[:2], 3))
    else:
        image = read_linear(plugin.path())
    plugin.ignore("mis_compensation")
    # Lengths of the axes do not count, as directions are all that is asked.
    linear = straightened(plugin.to_world())[:3, :3]
    return EnvironmentMap(_rows(image), linear @ _HALF_TURN, plugin.number("scale", 1.0))


def _rows(image: NDArray[Any]) -> NDArray[Any]:
    """Return a picture whose rows lie evenly from pole to pole with their middles within, as raywright's do.

    Mitsuba has the first and the last at the poles themselves. Pictures of fewer rows than `_ROWS` are
    interpolated to more, so that they stay the same; of others the rows move by half a row at most.
    """
    height = len(image)
    if height < 2 or height >= _ROWS:
        return image
    # A whole number of rows to each of the picture's, so that between them they are as even.
    count = (height - 1) * math.ceil(_ROWS / (height - 1))
    at = (np.arange(count) + 0.5) / count * (height - 1)
    above = np.minimum(at.astype(np.int64), height - 2)
    share = (at - above)[:, None, None]
    return np.asarray(image[above] * (1 - share) + image[above + 1] * share, np.float32)


def _unit(vector: Matrix) -> Matrix:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else vector
