"""Lighting, framing and a floor for files that lack them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..arrays import integer
from ..cameras import AnyCamera
from ..lights import Emission, Light
from ..lights.emission import Emitted
from ..mesh_files.look import linear
from ..rendering.render_setup import RenderSetup
from ..scene.framing import framed
from ..scene.instance import AnyShape, Instance, meshes
from ..scene.scene import Scene
from ..scenes.studio import lit, studio
from ..shapes.mesh import Mesh
from ..textures import ImageTexture, ProductTexture
from ..textures.texture import Value, ends

# Least mean radiance of all surfaces for a scene to count as lit. A closed room of such surfaces would have
# about this radiance times the reflectance of its walls.
_ENOUGH = 0.02
WIDTH, HEIGHT = 640, 480


def shown(
    shapes: Any,
    lights: Sequence[Light] = (),
    camera: AnyCamera | None = None,
    up: Literal["y", "z"] = "y",
    width: int | None = None,
    height: int | None = None,
) -> RenderSetup:
    """Return a shot of a file's contents.

    Everything is shown as it is if there is light: if there are lights, if anything shines and there is a
    camera, which is an author's, and without a camera if emission gives off enough. All else is put in a
    `studio`, or, where there is a camera, in the light of one. A file without a camera is framed.

    Parameters
    ----------
    shapes : Mesh, another shape, Instance, or list of these
        Shapes of the file.
    lights : sequence of lights
        Lights without a surface.
    camera : Camera or another kind, optional
        If the file has one.
    up
        As in `framed`, for files without a camera.
    width, height : int, optional
        Size of the picture, as in `load`.

    Raises
    ------
    ValueError
        If there is nothing to show, or a number is out of range.
    TypeError
        If a size is not an integer.
    """
    parts = meshes(shapes)
    radiance = own_radiance(parts)
    if camera is not None:
        scene = Scene(parts, lights) if lights or radiance > 0 else lit(parts, camera)
        return RenderSetup(scene, camera).resized(width, height)
    size = size_of(width, height)
    if lights or radiance >= _ENOUGH:
        return RenderSetup(Scene(parts, lights), framed(parts, up, *size))
    return RenderSetup(*studio(parts, up, *size))


def size_of(width: int | None, height: int | None) -> tuple[int, int]:
    """Return the size of a picture without a camera: if one side is given, the other keeps the proportions.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If an argument is not an integer.
    """
    if width is None and height is None:
        return WIDTH, HEIGHT
    if width is None:
        assert height is not None
        return max(round(integer("height", height, 1) * WIDTH / HEIGHT), 1), height
    return width, max(round(integer("width", width, 1) * HEIGHT / WIDTH), 1) if height is None else height


def own_radiance(shapes: Sequence[AnyShape]) -> float:
    """Return the radiance that meshes, and copies of them, give off on average over all their surface."""
    area, power = _measured(shapes)
    return power / area if area > 0 else 0.0


def _measured(shapes: Sequence[AnyShape]) -> tuple[float, float]:
    """Return the area of meshes and copies of them, and area times radiance."""
    total = np.zeros(2)
    for shape in shapes:
        if isinstance(shape, Instance):
            sizes = np.abs(np.linalg.det(shape.transform.reshape(-1, 4, 4)[:, :3, :3])) ** (2 / 3)
            total += np.array(_measured(shape.shapes)) * sizes.sum()
        elif isinstance(shape, Mesh):
            area = _area(shape)
            total += area, 0.0 if shape.emission is None else area * _mean(shape.emission)
    return float(total[0]), float(total[1])


def _area(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]].astype(np.float64) for i in range(3))
    with np.errstate(all="ignore"):
        doubled = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    return float(doubled[np.isfinite(doubled)].sum() / 2)


def _mean(emitted: Emitted) -> float:
    """Return the mean of a radiance, over a whole picture and over red, green and blue."""
    return float(_mean_value(emitted.radiance if isinstance(emitted, Emission) else emitted).mean())


def _mean_value(value: Value) -> NDArray[np.float64]:
    if isinstance(value, ProductTexture):
        return np.asarray(_mean_value(value.a) * _mean_value(value.b))
    if not isinstance(value, ImageTexture):
        low, high = ends(value)
        return np.asarray((np.array(low) + np.array(high)) / 2)
    counted = value.image[..., list(value.channels)]
    if counted.dtype != np.uint8:
        return np.asarray(counted.mean(axis=(0, 1), dtype=np.float64))
    levels = linear(np.arange(256) / 255) if value.decoded else np.arange(256) / 255
    each = np.moveaxis(counted, 2, 0).reshape(len(value.channels), -1)
    shares = [np.bincount(one, minlength=256) @ levels for one in each]
    return np.asarray(np.array(shares) / each.shape[1], np.float64)
