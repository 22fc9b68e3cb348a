"""Emitters that are not surfaces: lights within a scene, and environments."""

from __future__ import annotations

import math
from collections.abc import Callable
from datetime import datetime, timedelta, timezone
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
    ProjectorLight,
    SpotLight,
    SunSky,
)
from . import thrown
from .errors import SceneError
from .plugin import Plugin, Triple
from .sensors import field_of_view
from .textures import picture
from .transforms import Matrix, straightened
from .values import UNIFORM, color, shade

TYPES = ("point", "spot", "projector", "directional", "constant", "envmap", "sunsky")

# Pixels across the picture of a textured spot, and its greatest angle: pixels are too far apart beyond.
_FEWEST, _MOST, _WIDEST = 512, 2048, 80.0
# Mitsuba divides the luminance of the sky, in cd/m² over 683 lm/W, by this: the integral of the observer's
# green over wavelengths in nm (CIE 1931).
_SKY = 106.856895

# Smaller environment maps are refined to this number of rows.
_ROWS = 1024
# Mitsuba's maps have their middle along +z, raywright's along -z.
_HALF_TURN: Matrix = np.diag([-1.0, 1.0, -1.0])


def emitter(plugin: Plugin) -> Light | Environment:
    """Return the light or the environment that a plugin stands for.

    Raises
    ------
    FileNotFoundError
        If its file is missing.
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    readers: dict[str, Callable[[Plugin], Light | Environment]] = {
        "point": _point,
        "spot": _spot,
        "projector": _projector,
        "directional": _directional,
        "constant": _constant,
        "envmap": _map,
        "sunsky": _daylight,
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


def _in_world(plugin: Plugin, name: str, column: int) -> NDArray[np.float64]:
    """Return a vector that is given by name, or as a column of the plugin's transformation."""
    if not plugin.has(name):
        return plugin.to_world()[:3, column]
    if plugin.has("to_world"):
        plugin.fail(f"either {name} or to_world must be given, got both")
    return plugin.vector(name, (0.0, 0.0, 0.0))


def _point(plugin: Plugin) -> PointLight:
    return PointLight(_in_world(plugin, "position", 3), shade(plugin, "intensity", 1.0, emits=True))


def _spot(plugin: Plugin) -> SpotLight | ProjectorLight:
    matrix = plugin.to_world()
    cutoff = plugin.number("cutoff_angle", 20.0)
    beam = min(plugin.number("beam_width", 0.75 * cutoff), cutoff)
    texture = plugin.child("texture")
    if texture is not None and texture.type not in UNIFORM:
        return _picture_spot(plugin, texture, matrix, (cutoff, beam))
    return SpotLight(
        matrix[:3, 3],
        matrix[:3, 3] + _unit(matrix[:3, 2]),
        shade(plugin, "intensity", 1.0, emits=True),
        cutoff,
        cutoff - beam,
        "linear",
    )


def _picture_spot(
    plugin: Plugin, texture: Plugin, matrix: Matrix, angles: tuple[float, float]
) -> ProjectorLight:
    """Return a spot with a texture as a projector, in whose picture the spot's fall-off is."""
    cutoff, beam = angles
    if not 0 < cutoff <= _WIDEST:
        plugin.fail(f"cutoff_angle must be above 0 and at most {_WIDEST:g} with a texture, got {cutoff:g}")
    # A multiple of the texture's pixels where possible, so that interpolation does not change the pattern.
    side = max(thrown.size_of(texture))
    count = min(side * max(-(-_FEWEST // side), 1), _MOST)
    tangent = math.tan(math.radians(cutoff))
    # From the left of the picture, at +x, to its right, and from its top, at +y.
    plane = 1 - 2 * (np.arange(count) + 0.5) / count
    x, y = plane[None, :], plane[:, None]
    cosine = 1 / np.sqrt(1 + tangent**2 * (x * x + y * y))
    angle = np.degrees(np.arccos(cosine))
    fading = (cutoff - angle) / (cutoff - beam) if beam < cutoff else np.ones_like(angle)
    share = np.where(angle <= beam, 1.0, np.where(angle < cutoff, fading, 0.0))
    u, v = np.broadcast_arrays(0.5 + 0.5 * x, 0.5 + 0.5 * y)
    image = thrown.at(texture, u, v) * (share * cosine**3)[..., None]
    return _thrown(image, matrix, 2 * cutoff, color(plugin, "intensity", 1.0, emits=True))


def _projector(plugin: Plugin) -> ProjectorLight:
    texture = plugin.child("irradiance")
    width, height = (1, 1) if texture is None else thrown.size_of(texture)
    axes = {"x": width, "y": height, "diagonal": math.hypot(width, height)}
    axes |= {"smaller": min(width, height), "larger": max(width, height)}
    fov, axis = field_of_view(plugin)
    tall = 2 * math.degrees(math.atan(math.tan(math.radians(0.5 * fov)) * height / axes[axis]))
    scale = math.pi * plugin.number("scale", 1.0)
    if texture is None:
        image = np.broadcast_to(color(plugin, "irradiance", 1.0, emits=True), (1, 1, 3))
    else:
        # A multiple of the picture's pixels, or enough for the edges of a checkerboard. At its border Mitsuba
        # continues the texture, and a projector here is constant over half a pixel.
        finer = max(-(-_FEWEST // max(width, height)), 1)
        width, height = width * finer, height * finer
        u, v = np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
        image = thrown.at(texture, u, v)
    return _thrown(image, plugin.to_world(), tall, (scale, scale, scale))


def _thrown(image: NDArray[Any], matrix: Matrix, tall: float, intensity: Triple) -> ProjectorLight:
    place, ahead, up = matrix[:3, 3], _unit(matrix[:3, 2]), _unit(matrix[:3, 1])
    if np.linalg.det(matrix[:3, :3]) < 0:
        image = image[:, ::-1]
    return ProjectorLight(image, place, place + ahead, up, tall, intensity)


def _directional(plugin: Plugin) -> DirectionalLight:
    return DirectionalLight(_in_world(plugin, "direction", 2), shade(plugin, "irradiance", 1.0, emits=True))


def _constant(plugin: Plugin) -> ConstantEnvironment:
    return ConstantEnvironment(shade(plugin, "radiance", 1.0, emits=True))


def _map(plugin: Plugin) -> EnvironmentMap:
    if plugin.has("bitmap"):
        array = picture(plugin)[0]
        if array.dtype.kind != "f":
            plugin.fail(f"bitmap must hold floats, got {array.dtype}")
        image: NDArray[Any] = np.broadcast_to(array, (*array.shape[:2], 3))
    else:
        image = read_linear(plugin.path())
    plugin.ignore("mis_compensation")
    # Only directions count, so the lengths of the axes do not matter.
    linear = straightened(plugin.to_world())[:3, :3]
    return EnvironmentMap(_rows(image), linear @ _HALF_TURN, plugin.number("scale", 1.0))


def _daylight(plugin: Plugin) -> SunSky:
    plugin.warn("its sky is approximated by that of Preetham et al. (1999), which is brighter")
    plugin.ignore("complex_sun", "sun_aperture")
    matrix = straightened(plugin.to_world())[:3, :3]
    when = ("year", 2010), ("month", 7), ("day", 10), ("hour", 15.0), ("minute", 0.0), ("second", 0.0)
    numbers = [plugin.number(name, default) for name, default in when]
    place = plugin.number("latitude", 35.689), plugin.number("longitude", 139.6917)
    zone = timedelta(hours=plugin.number("timezone", 9.0))
    if plugin.has("sun_direction"):
        sun = plugin.vector("sun_direction", (0.0, 0.0, 1.0))
    else:
        year, month, day = (int(one) for one in numbers[:3])
        hour, minute, second = numbers[3:]
        clock = timedelta(hours=hour, minutes=minute, seconds=second)
        time = datetime(year, month, day, tzinfo=timezone(zone)) + clock
        south, east, up = SunSky.at(time, *place, up=(0.0, 0.0, 1.0), north=(1.0, 0.0, 0.0)).sun
        # Mitsuba (3.9) has x to the south and y to the west.
        sun = np.array([-south, east, up])
    turbidity = plugin.number("turbidity", 3.0)
    if turbidity < 2:
        plugin.warn("a turbidity below 2 is taken as 2")
    return SunSky(
        matrix @ sun,
        max(turbidity, 2.0),
        color(plugin, "albedo", 0.3),
        matrix[:, 2],
        plugin.number("sun_scale", 1.0) / _SKY,
        plugin.number("sky_scale", 1.0) / _SKY,
    )


def _rows(image: NDArray[Any]) -> NDArray[Any]:
    """Return a picture whose rows lie evenly from pole to pole with their middles within, as raywright's do.

    Mitsuba has the first and the last at the poles themselves. Pictures of fewer rows than `_ROWS` are
    interpolated to more, so that they stay the same; of others the rows move by half a row at most.
    """
    height = len(image)
    if height < 2 or height >= _ROWS:
        return image
    # A multiple of the picture's steps, so that interpolation stays linear between its rows.
    count = (height - 1) * math.ceil(_ROWS / (height - 1))
    at = (np.arange(count) + 0.5) / count * (height - 1)
    above = np.minimum(at.astype(np.int64), height - 2)
    share = (at - above)[:, None, None]
    return np.asarray(image[above] * (1 - share) + image[above + 1] * share, np.float32)


def _unit(vector: Matrix) -> Matrix:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else vector
