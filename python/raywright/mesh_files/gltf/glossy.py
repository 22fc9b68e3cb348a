"""Older materials of glTF files, KHR_materials_pbrSpecularGlossiness, by trimesh."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...io.pictures import pixels_of
from ...io.quiet import quiet
from ..pbr import Pbr, Picture
from .part import Part


def of_glossy(part: Part, diffuse: Picture | None, glossy: Picture | None) -> Pbr:
    """Return the metallic-roughness model of a diffuse and a specular color and a glossiness.

    Parameters
    ----------
    part : Part
        Contents of the extension.
    diffuse, glossy : Picture, optional
        Its two pictures. Where both are there, the first says how they lie on a surface.
    """
    from trimesh.visual.gloss import specular_to_pbr

    with quiet():
        made = specular_to_pbr(
            diffuseFactor=part.numbers("diffuseFactor", 4, (1.0, 1.0, 1.0, 1.0), 0, 1),
            specularFactor=part.numbers("specularFactor", 3, (1.0, 1.0, 1.0), 0, 1),
            glossinessFactor=part.number("glossinessFactor", 1.0, 0, 1),
            diffuseTexture=_image(diffuse),
            specularGlossinessTexture=_image(glossy),
        )
    lies = diffuse or glossy

    def picture(name: str) -> Picture | None:
        if lies is None or name not in made:
            return None
        return lies._replace(pixels=pixels_of(made[name]))

    color = made.get("baseColorFactor")
    return Pbr(
        color=None if color is None else np.clip(np.asarray(color, np.float64), 0, 1),
        color_picture=picture("baseColorTexture"),
        metallic=_share(made.get("metallicFactor")),
        roughness=_share(made.get("roughnessFactor")),
        rough_picture=picture("metallicRoughnessTexture"),
    )


def _image(picture: Picture | None) -> Any:
    from PIL import Image

    if picture is None:
        return None
    pixels = picture.pixels
    return Image.fromarray(pixels[..., 0] if pixels.shape[2] == 1 else pixels)


def _share(value: Any) -> float | None:
    return None if value is None else min(max(float(value), 0.0), 1.0)
