"""Patches: the faces of a scene, cut into pieces that exchange light."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import positive
from ..materials import Diffuse, Material, TwoSided
from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene, SceneLike, as_scene
from ..shapes.mesh import Mesh
from .copies import LaidOut

PATCH = np.dtype(
    [("shape", np.int32), ("copy", np.int32), ("face", np.int32), ("cell", np.int32), ("side", np.int8)]
)
# The patches of a face with this many strips still fit int32 indices.
_MOST = 2**15


def exchanging(scene: SceneLike, diffuse: bool = True) -> Scene:
    """Return the scene, or that of some shapes, if its surfaces can exchange light.

    Raises
    ------
    TypeError
        If no scene is made of it.
    ValueError
        If it is empty or filled by a medium, or something in it scatters otherwise than diffusely, where that
        counts.
    """
    scene = as_scene(scene)
    if not scene.shapes:
        raise ValueError("scene has no shapes: nothing exchanges light")
    if scene.medium is not None:
        raise ValueError(
            "scene must have no medium, as surfaces exchange light through empty space: give medium=None"
        )
    for number, shape in enumerate(scene.shapes):
        other = _not_diffuse(shape) if diffuse else None
        if other is not None:
            raise ValueError(
                f"shape {number} is of {type(other).__name__}: only Diffuse, and TwoSided of it, have one "
                "radiosity for all directions"
            )
    return scene


def _not_diffuse(shape: AnyShape) -> Material | None:
    """Return a material of a shape, or of one in an instance, that is not diffuse."""
    if isinstance(shape, Instance):
        return next((other for part in shape.shapes if (other := _not_diffuse(part)) is not None), None)
    return None if _is_diffuse(shape.material) else shape.material


def _is_diffuse(material: Material) -> bool:
    if isinstance(material, TwoSided):
        return _is_diffuse(material.front) and _is_diffuse(material.back)
    return isinstance(material, Diffuse)


def cut(scene: Scene, patch_size: float | None) -> NDArray[np.uint32]:
    """Return into how many strips each primitive is cut, (F,): patches are no longer than a size."""
    size = None if patch_size is None else positive("patch_size", patch_size)
    parts = []
    for shape in scene.shapes:
        if size is None or not isinstance(shape, Mesh):
            parts.append(np.ones(len(shape.faces) if isinstance(shape, Mesh) else 1, np.uint32))
            continue
        corners = shape.vertices[shape.faces].astype(np.float64)
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1, initial=0.0)
        # A side of a whole number of sizes is cut into that number, despite rounding.
        strips = np.ceil(np.where(np.isfinite(sides), sides, 0.0) / size * (1.0 - 1e-9))
        if strips.size and not strips.max() < _MOST:
            raise ValueError(
                f"patch_size {size:g} splits an edge into more than {_MOST} parts: give a larger one"
            )
        parts.append(np.maximum(strips, 1.0).astype(np.uint32))
    return np.concatenate(parts)


def named(laid: LaidOut, cuts: NDArray[np.uint32], both: bool) -> NDArray[Any]:
    """Return shape, copy, face, cell and side of each row of a solution."""
    counts = cuts.astype(np.int64) ** 2
    rows = np.empty(int(counts.sum()), PATCH)
    for part in ("shape", "copy", "face"):
        rows[part] = np.repeat(getattr(laid, part), counts)
    rows["cell"] = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    rows["side"] = 1
    if not both:
        return rows
    backs = rows.copy()
    backs["side"] = -1
    return np.concatenate([rows, backs])
