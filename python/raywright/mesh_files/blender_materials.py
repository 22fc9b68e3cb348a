"""Materials of Blender, by the shader that their nodes end in."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..textures.image import Wrap
from .pbr import IOR, Pbr, Picture, Within
from .polygons import LeftOut

_WRAPS: dict[str, Wrap] = {"REPEAT": "repeat", "EXTEND": "clamp", "CLIP": "clamp", "MIRROR": "mirror"}
# Inputs of the principled shader without effect here; values other than 0 are reported.
_UNUSED = ("Subsurface Weight", "Coat Weight", "Sheen Weight", "Thin Film Thickness", "Anisotropic")


def pbr_of(material: Any, left_out: LeftOut) -> Pbr:
    """Return what a bpy.types.Material says: of its principled, diffuse or emission shader, or its color.

    Parameters
    ----------
    material : bpy.types.Material
    left_out : LeftOut
        Warned of: every feature without effect.
    """
    shader = _shader(material)
    kind = None if shader is None else shader.type
    told = f"of material {material.name!r}"
    if kind == "BSDF_PRINCIPLED":
        return _principled(shader, told, left_out)
    if kind == "BSDF_DIFFUSE":
        color, picture = _color(shader, ("Color",), told, left_out)
        return Pbr(color=color, color_picture=picture, metallic=0.0, unlit=True)
    if kind == "EMISSION":
        color, picture = _color(shader, ("Color",), told, left_out)
        strength = _number(shader, ("Strength",), 1.0, told, left_out)
        radiance = np.ones(3) if color is None else color[:3]
        black = np.zeros(3)
        return Pbr(
            color=black, unlit=True, emission=strength * radiance, emission_picture=picture, both_sides=True
        )
    if kind is not None:
        left_out.add(f"the {kind.lower()} shader {told}, for whose plain color it stands")
    color = np.array(material.diffuse_color, np.float64)[:3]
    metallic, roughness = float(material.metallic), float(material.roughness)
    return Pbr(color=color, metallic=metallic, roughness=roughness)


def _shader(material: Any) -> Any:
    """Return the node that the surface of a material is linked to; None without nodes."""
    tree = getattr(material, "node_tree", None)
    outputs = [] if tree is None else [node for node in tree.nodes if node.type == "OUTPUT_MATERIAL"]
    active = next((node for node in outputs if getattr(node, "is_active_output", True)), None)
    return None if active is None else _linked(active, "Surface")


def _linked(node: Any, name: str) -> Any:
    """Return the node that an input is linked to; None if it is not, or there is no such input."""
    socket = node.inputs.get(name)
    return None if socket is None or not len(socket.links) else socket.links[0].from_node


def _principled(node: Any, told: str, left_out: LeftOut) -> Pbr:
    for name in _UNUSED:
        if _linked(node, name) is not None or _default(node, name, 0.0):
            left_out.add(f"{name!r} {told}")
    color, picture = _color(node, ("Base Color",), told, left_out)
    metallic = _number(node, ("Metallic",), 0.0, told, left_out)
    roughness = _number(node, ("Roughness",), 0.5, told, left_out)
    transmission = _number(node, ("Transmission Weight", "Transmission"), 0.0, told, left_out)
    alpha = _number(node, ("Alpha",), 1.0, told, left_out, is_image_fine=True)
    is_cut = _linked(node, "Alpha") is not None and picture is not None and picture.has_alpha
    strength = _number(node, ("Emission Strength",), 0.0, told, left_out)
    emission, emission_picture = None, None
    if strength > 0:
        emission, emission_picture = _color(node, ("Emission Color", "Emission"), told, left_out)
        emission = strength * (np.ones(3) if emission is None else emission[:3])
    normals, scale = _normals(node, told, left_out)
    if alpha < 1.0:
        color = np.append(np.ones(3) if color is None else color[:3], alpha)
    return Pbr(
        color=color,
        color_picture=picture,
        metallic=metallic,
        roughness=roughness,
        normal_picture=normals,
        normal_scale=scale,
        emission=emission,
        emission_picture=emission_picture,
        alpha_mode="BLEND" if alpha < 1.0 or is_cut else None,
        both_sides=True,
        ior=_number(node, ("IOR",), IOR, told, left_out),
        transmission=transmission,
        # Transmission in Blender is through a solid.
        within=Within((1.0, 1.0, 1.0), float("inf"), None) if transmission > 0 else None,
    )


def _color(
    node: Any, names: tuple[str, ...], told: str, left_out: LeftOut
) -> tuple[NDArray[np.float64] | None, Picture | None]:
    """Return the linear color of an input, or the picture that it is linked to."""
    name = next((name for name in names if node.inputs.get(name) is not None), names[0])
    source = _linked(node, name)
    if source is not None:
        picture = _picture(source, told, left_out)
        if picture is not None:
            return None, picture
        left_out.add(f"the {source.type.lower()} node for {name!r} {told}")
    return np.array(_default(node, name, (0.8, 0.8, 0.8)), np.float64)[:3], None


def _number(
    node: Any,
    names: tuple[str, ...],
    otherwise: float,
    told: str,
    left_out: LeftOut,
    is_image_fine: bool = False,
) -> float:
    """Return the number of an input."""
    for name in names:
        source = _linked(node, name)
        if source is not None and not (is_image_fine and source.type == "TEX_IMAGE"):
            left_out.add(f"the {source.type.lower()} node for {name!r} {told}")
        if node.inputs.get(name) is not None:
            return 1.0 if source is not None and is_image_fine else float(_default(node, name, otherwise))
    return otherwise


def _default(node: Any, name: str, otherwise: Any) -> Any:
    socket = node.inputs.get(name)
    return otherwise if socket is None else socket.default_value


def _normals(node: Any, told: str, left_out: LeftOut) -> tuple[Picture | None, float]:
    """Return the picture of tangent-space normals, and its strength."""
    source = _linked(node, "Normal")
    if source is None:
        return None, 1.0
    image = _linked(source, "Color") if source.type == "NORMAL_MAP" else None
    picture = None if image is None else _picture(image, told, left_out)
    if picture is None or getattr(source, "space", "TANGENT") != "TANGENT":
        left_out.add(f"the {source.type.lower()} node for 'Normal' {told}")
        return None, 1.0
    return picture, float(_default(source, "Strength", 1.0))


def _picture(node: Any, told: str, left_out: LeftOut) -> Picture | None:
    """Return the picture of an image node; None if the node is of another kind or has none."""
    image = node.image if node.type == "TEX_IMAGE" else None
    if image is None or not len(image.pixels):
        return None
    mapping = _linked(node, "Vector")
    if mapping is not None and mapping.type not in ("UVMAP", "TEX_COORD"):
        left_out.add(f"the {mapping.type.lower()} node of a picture {told}")
    width, height = image.size[:2]
    numbers = np.empty(width * height * image.channels, np.float32)
    if hasattr(image.pixels, "foreach_get"):
        image.pixels.foreach_get(numbers)
    else:
        numbers[:] = image.pixels
    # Blender's first row of pixels is the lowest.
    pixels: NDArray[Any] = numbers.reshape(height, width, image.channels)[::-1]
    if not image.is_float and image.colorspace_settings.name == "sRGB":
        pixels = np.rint(np.clip(pixels, 0.0, 1.0) * 255).astype(np.uint8)
    wrap = _WRAPS.get(node.extension, "repeat")
    return Picture(pixels, (wrap, wrap), "nearest" if node.interpolation == "Closest" else "trilinear")
