"""Light while the camera moves: of all lamps one, for one shadow ray per pixel, and one color of the sky."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..cameras import AnyCamera
from ..lights import (
    ConstantEnvironment,
    DirectionalLight,
    EnvironmentMap,
    PointLight,
    ProjectorLight,
    SpotLight,
    SunSky,
)
from ..scene.scene import Scene
from ..shapes.mesh import Mesh

# Direction to the lamp, over the viewer's right shoulder.
_RIGHT, _UP = 0.5, 0.8
# A clear sky, if its colors are unknown.
_SKY = (0.25, 0.4, 0.65)


def lamp(scene: Scene, camera: AnyCamera) -> dict[str, Any]:
    """Return where light mostly comes from.

    Returns
    -------
    dict
        ``"place"``, 3 floats, and ``"far"``, True if that is a direction to the light rather than a point: of
        the sun, or a lamp, or the middle of the largest emissive mesh, the first that there is; otherwise
        over the viewer's shoulder.
    """
    around = scene.environment
    all_around = around if isinstance(around, tuple) else (around,)
    for one in (*scene.lights, *all_around):
        if isinstance(one, DirectionalLight):
            return {"place": (-np.asarray(one.direction, float)).tolist(), "far": True}
        if isinstance(one, SunSky):
            return {"place": np.asarray(one.sun, float).tolist(), "far": True}
        if isinstance(one, PointLight | SpotLight | ProjectorLight):
            return {"place": np.asarray(one.position, float).tolist(), "far": False}
    shining = [shape for shape in scene.shapes if isinstance(shape, Mesh) and shape.emission is not None]
    if shining:
        boxes = [(points.min(axis=0), points.max(axis=0)) for points in (m.used_vertices() for m in shining)]
        low, high = max(boxes, key=lambda box: float(np.linalg.norm(box[1] - box[0])))
        return {"place": (0.5 * (low + high)).tolist(), "far": False}
    forward, up = np.array(camera.forward), np.array(camera.up) / np.linalg.norm(camera.up)
    right = np.cross(forward, up)
    return {"place": (_RIGHT * right + _UP * up - forward).tolist(), "far": True}


def preview_light(scene: Scene, camera: AnyCamera) -> PointLight | list[float]:
    """Return `lamp` as `Scene.preview` takes it."""
    found = lamp(scene, camera)
    place: list[float] = found["place"]
    return place if found["far"] else PointLight(place, 1.0)


def behind(scene: Scene) -> list[float]:
    """Return the radiance that surrounds a scene, everywhere the same: of a picture the mean."""
    sums = np.zeros(3)
    around = scene.environment
    for one in around if isinstance(around, tuple) else (around,):
        if isinstance(one, EnvironmentMap):
            sums += one.scale * one.image.mean(axis=(0, 1), dtype=float)
        elif isinstance(one, ConstantEnvironment) and isinstance(one.radiance, tuple):
            sums += one.radiance
        elif one is not None:
            sums += _SKY
    return sums.tolist()
