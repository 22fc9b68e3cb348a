"""Sensors to cameras, and their films."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from ...cameras import AnyCamera, Camera, Orthographic, ThinLens
from ...scene.scene import Scene
from .errors import SceneError
from .plugin import Plugin
from .transforms import Matrix, frame, straightened

TYPES = ("perspective", "thinlens", "orthographic", "radiancemeter", "distant")
# Other sensors that Mitsuba has or had.
OTHERS = (
    "batch",
    "fluencemeter",
    "irradiancemeter",
    "perspective_rdist",
    "spherical",
    "telecentric",
)
FILMS = ("hdrfilm", "ldrfilm")


class Crop(NamedTuple):
    """The part of a film that is rendered, in its pixels."""

    size: tuple[int, int]
    part: tuple[int, int]
    offset: tuple[int, int]

    @property
    def whole(self) -> bool:
        """True if it is the whole picture."""
        return self.size == self.part and self.offset == (0, 0)

    @property
    def centered(self) -> bool:
        """True if it is the picture's middle, in the same proportions."""
        (w, h), (a, b), (x, y) = self
        return w - a == 2 * x and h - b == 2 * y and a * h == b * w


def camera(plugin: Plugin, film: Plugin | None, scene: Scene) -> AnyCamera:
    """Return the camera that a sensor stands for.

    Parameters
    ----------
    plugin : Plugin
        The sensor, whose film, filter and sampler are taken.
    film : Plugin, optional
        Its film; Mitsuba's own of 768 by 576 if there is none.
    scene : Scene
        What is seen.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    readers: dict[str, Callable[[Plugin, Crop], AnyCamera]] = {
        "perspective": _perspective,
        "thinlens": _thin_lens,
        "orthographic": _orthographic,
        "radiancemeter": _radiance_meter,
        "distant": lambda plugin, crop: _distant(plugin, crop, scene),
    }
    plugin.ignore("near_clip", "far_clip", "shutter_open", "shutter_close")
    if plugin.type != "thinlens":
        plugin.ignore("focus_distance")
    try:
        result = readers[plugin.type](plugin, _crop(film))
    except SceneError:
        raise
    except (ValueError, TypeError) as error:
        raise SceneError(f"{plugin}: {error}") from error
    plugin.done()
    return result


def _crop(film: Plugin | None) -> Crop:
    if film is None:
        return Crop((768, 576), (768, 576), (0, 0))
    size = film.integer("width", 768), film.integer("height", 576)
    part = film.integer("crop_width", size[0]), film.integer("crop_height", size[1])
    offset = film.integer("crop_offset_x", 0), film.integer("crop_offset_y", 0)
    film.ignore(
        "file_format", "pixel_format", "component_format", "sample_border", "banner", "compensate", "filename"
    )
    film.done()
    inside = all(o >= 0 and p >= 1 and o + p <= s for s, p, o in zip(size, part, offset, strict=True))
    if not inside:
        film.fail(f"a part of {part} pixels at {offset} must lie within its {size}")
    return Crop(size, part, offset)


def _perspective(plugin: Plugin, crop: Crop) -> Camera:
    fov, axis = field_of_view(plugin)
    shift = [plugin.number(f"principal_point_offset_{name}", 0.0) for name in "xy"]
    width, height = crop.part
    if crop.whole and shift == [0.0, 0.0]:
        return Camera.from_matrix(
            straightened(plugin.to_world()), "mitsuba", fov=fov, fov_axis=axis, width=width, height=height
        )
    # Principal point and focal length of the whole film, in pixels of the crop.
    length = {"x": crop.size[0], "y": crop.size[1], "diagonal": math.hypot(*crop.size)}
    length |= {"smaller": min(crop.size), "larger": max(crop.size)}
    focal = 0.5 * length[axis] / math.tan(math.radians(0.5 * fov))
    x, y = (
        size * (0.5 - part) - offset for size, part, offset in zip(crop.size, shift, crop.offset, strict=True)
    )
    return Camera.from_matrix(
        straightened(plugin.to_world()),
        "mitsuba",
        focal_length_px=(focal, focal),
        principal_point=(x, y),
        width=width,
        height=height,
    )


def _thin_lens(plugin: Plugin, crop: Crop) -> ThinLens:
    fov, axis = field_of_view(plugin)
    if not crop.centered:
        plugin.fail("of a thin lens only the middle of the film can be rendered")
    # The crop is the same share of both axes, so the axis of the field of view does not matter.
    fov = 2 * math.degrees(math.atan(math.tan(math.radians(0.5 * fov)) * crop.part[0] / crop.size[0]))
    for name in "xy":
        if plugin.number(f"principal_point_offset_{name}", 0.0) != 0.0:
            plugin.fail(f"principal_point_offset_{name} is not supported")
    return ThinLens.from_matrix(
        straightened(plugin.to_world()),
        "mitsuba",
        fov=fov,
        fov_axis=axis,
        aperture_radius=plugin.number("aperture_radius", 0.0),
        focus_distance=plugin.number("focus_distance", plugin.number("far_clip", 1e4)),
        width=crop.part[0],
        height=crop.part[1],
    )


def _orthographic(plugin: Plugin, crop: Crop) -> Orthographic:
    matrix = plugin.to_world()
    across, down = (float(np.linalg.norm(matrix[:3, k])) for k in range(2))
    if abs(across - down) > 1e-6 * across:
        plugin.fail("to_world must scale x and y alike")
    # In camera space the film spans two units, from +x on the left to -x.
    (w, h), (a, b), (x, y) = crop
    unit = 2.0 / w
    shift: Matrix = np.eye(4)
    shift[:2, 3] = (0.5 * (w - a) - x) * unit, (0.5 * (h - b) - y) * unit
    return Orthographic.from_matrix(
        straightened(matrix @ shift), "mitsuba", scale=a * unit * across, scale_axis="x", width=a, height=b
    )


def _radiance_meter(plugin: Plugin, crop: Crop) -> Orthographic:
    if plugin.has("to_world"):
        plugin.ignore("origin", "direction")
        matrix = plugin.to_world()
        return _one_ray(plugin, crop, matrix[:3, 3], matrix[:3, 2])
    if plugin.has("origin") != plugin.has("direction"):
        plugin.fail("origin and direction must be given together")
    place, way = plugin.vector("origin", (0.0, 0.0, 0.0)), plugin.vector("direction", (0.0, 0.0, 1.0))
    return _one_ray(plugin, crop, place, way)


def _distant(plugin: Plugin, crop: Crop, scene: Scene) -> Orthographic:
    """Return what sees one point from far away."""
    if plugin.has("direction") and plugin.has("to_world"):
        plugin.fail("either direction or to_world must be given, got both")
    given = plugin.take("target")
    if given is None or isinstance(given, Mapping):
        plugin.fail(
            "target must be a point; the mean over a shape, or over the whole scene, is not supported"
        )
    target = plugin.vector("target", (0.0, 0.0, 0.0))
    way = plugin.vector("direction", (0.0, 0.0, 1.0)) if plugin.has("direction") else plugin.to_world()[:3, 2]
    bounds = scene.bounds
    corners = target[None] if bounds is None else np.where(np.isfinite(bounds), bounds, target)
    # Twice the farthest distance, plus 1 so that rays do not start on the scene.
    away = 2 * float(np.linalg.norm(corners - target, axis=1).max()) + 1.0
    return _one_ray(plugin, crop, target - way / np.linalg.norm(way) * away, way)


def _one_ray(plugin: Plugin, crop: Crop, place: Matrix, way: Matrix) -> Orthographic:
    if crop.part != (1, 1):
        plugin.fail(f"its film must be of 1 by 1 pixels, got {crop.part[0]} by {crop.part[1]}")
    if not np.linalg.norm(way) > 0:
        plugin.fail("its direction must have a length")
    # A film so small that all rays coincide.
    scale = 1e-9 * max(1.0, float(np.abs(place).max()))
    up = frame(way / np.linalg.norm(way))[1]
    return Orthographic(place, direction=way, up=up, scale=scale, width=1, height=1)


def field_of_view(plugin: Plugin) -> tuple[float, str]:
    """Return an angle of view in degrees, and its axis."""
    if plugin.has("fov"):
        if plugin.has("focal_length"):
            plugin.fail("either fov or focal_length must be given, got both")
        axes = ("x", "y", "smaller", "larger", "diagonal")
        return plugin.number("fov", 50.0), plugin.choice("fov_axis", "x", axes)
    plugin.ignore("fov_axis")
    given = plugin.take("focal_length", "50mm")
    try:
        length = float(str(given).removesuffix("mm"))
    except ValueError:
        length = 0.0
    if not length > 0:
        plugin.fail(f"focal_length must be millimeters of a 35 mm film, as '50mm', got {given!r}")
    return 2 * math.degrees(math.atan(math.hypot(36, 24) / (2 * length))), "diagonal"
