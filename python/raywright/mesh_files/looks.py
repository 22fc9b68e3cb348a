"""Materials, emission and colors from trimesh's visuals."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..io.pictures import pixels_of
from ..materials import Diffuse
from ..textures import ImageTexture, VertexColors
from .look import Look, linear
from .pbr import Pbr, Picture


def look_of(visual: Any, count: int) -> Look:
    """Return what a visual of a mesh with `count` vertices says.

    Colors of vertices are kept where they differ; of colors of faces the main one is taken. Of glTF's
    material there is base color, metalness, roughness, normals, emission and alpha; of those of OBJ files
    all that trimesh keeps; of others the diffuse color or picture.
    """
    material = getattr(visual, "material", None)
    if material is None:
        return _colored(visual, count)
    if hasattr(material, "baseColorFactor"):
        pbr = _pbr(material)
        return Look(pbr.material(), pbr.emitted())
    if getattr(material, "kwargs", None):
        from .obj.held import is_held, look_of_held

        if is_held(material):
            return look_of_held(material)
    image = getattr(material, "image", None)
    if image is not None:
        return Look(Diffuse(ImageTexture(pixels_of(image))))
    from trimesh.visual.color import DEFAULT_COLOR

    rgba = material.main_color
    return Look(None if np.array_equal(rgba, DEFAULT_COLOR) else Diffuse(tuple(_linear(rgba[:3]))))


def _colored(visual: Any, count: int) -> Look:
    kind = getattr(visual, "kind", None)
    if kind == "vertex":
        rgba = np.asarray(visual.vertex_colors)
        if rgba.shape == (count, 4) and len(rgba) and (rgba[:, :3] != rgba[0, :3]).any():
            return Look(Diffuse(VertexColors()), colors=_linear(rgba[:, :3]))
    return Look(Diffuse(tuple(_linear(visual.main_color[:3]))) if kind in ("face", "vertex") else None)


def _pbr(given: Any) -> Pbr:
    """Return what a PBRMaterial of trimesh says."""
    factor, emission = given.baseColorFactor, given.emissiveFactor
    return Pbr(
        # glTF 2.0, 3.9.2: factors are linear already, unlike all other colors here.
        color=None if factor is None else np.asarray(factor, np.float64) / 255,
        color_picture=_picture(given.baseColorTexture),
        metallic=None if given.metallicFactor is None else float(given.metallicFactor),
        roughness=None if given.roughnessFactor is None else float(given.roughnessFactor),
        rough_picture=_picture(given.metallicRoughnessTexture),
        normal_picture=_picture(given.normalTexture),
        emission=None if emission is None else np.asarray(emission, np.float64),
        emission_picture=_picture(given.emissiveTexture),
        alpha_mode=given.alphaMode,
        alpha_cutoff=None if given.alphaCutoff is None else float(given.alphaCutoff),
        both_sides=bool(given.doubleSided),
    )


def _picture(image: Any) -> Picture | None:
    return None if image is None else Picture(pixels_of(image))


def _linear(rgb: Any) -> NDArray[np.float64]:
    """Red, green and blue of 8 bits to linear."""
    return linear(np.asarray(rgb, np.float64) / 255)
