"""Materials, emission and colours from what trimesh calls visuals."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple
from ..materials import Diffuse, Mask, Material, MetallicRough, NormalMap
from ..textures import ImageTexture, ProductTexture, VertexColors
from ..textures.texture import Texture, Value


class Look(NamedTuple):
    """How a mesh looks; None where nothing is said of it."""

    material: Material | None = None
    emission: Value | None = None
    colors: NDArray[np.float64] | None = None


def look_of(visual: Any, count: int) -> Look:
    """Return what a visual of a mesh with `count` vertices says.

    Colours of vertices are kept where they differ; of colours of faces the main one is taken. Of glTF's
    material there is base colour, metalness, roughness, normals, emission and alpha; of others the diffuse
    colour or picture.
    """
    material = getattr(visual, "material", None)
    if material is None:
        return _coloured(visual, count)
    if hasattr(material, "baseColorFactor"):
        return _metallic_rough(material)
    image = getattr(material, "image", None)
    if image is not None:
        return Look(Diffuse(ImageTexture(_pixels(image))))
    from trimesh.visual.color import DEFAULT_COLOR

    rgba = material.main_color
    return Look(None if np.array_equal(rgba, DEFAULT_COLOR) else Diffuse(tuple(_linear(rgba[:3]))))


def _coloured(visual: Any, count: int) -> Look:
    kind = getattr(visual, "kind", None)
    if kind == "vertex":
        rgba = np.asarray(visual.vertex_colors)
        if rgba.shape == (count, 4) and len(rgba) and (rgba[:, :3] != rgba[0, :3]).any():
            return Look(Diffuse(VertexColors()), colors=_linear(rgba[:, :3]))
    return Look(Diffuse(tuple(_linear(visual.main_color[:3]))) if kind in ("face", "vertex") else None)


def _metallic_rough(given: Any) -> Look:
    """Return the material of glTF 2.0, 3.9; None where nothing is said that it does not have by itself."""
    factor = given.baseColorFactor
    picture, metal_rough = given.baseColorTexture, given.metallicRoughnessTexture
    # 3.9.2: factors are linear already, unlike every other colour here.
    rgba = np.ones(4) if factor is None else np.asarray(factor, np.float64) / 255
    base: Value = _triple(rgba[:3])
    alpha: Texture | float = float(rgba[3]) if len(rgba) == 4 else 1.0
    if picture is not None:
        pixels = _pixels(picture)
        base = _times(ImageTexture(pixels), base)
        if pixels.shape[2] in (2, 4):
            alpha = _masked(given, pixels, alpha)
    known = (factor, picture, metal_rough, given.metallicFactor, given.roughnessFactor)
    material: Material | None = None
    if any(one is not None for one in known):
        metallic, roughness = (1.0 if one is None else float(one) for one in known[3:])
        if metal_rough is None:
            material = MetallicRough(base, metallic, roughness)
        else:
            both = _pixels(metal_rough)
            material = MetallicRough(
                base,
                _times(ImageTexture(both, linear=True, channel="b"), (metallic,) * 3),
                _times(ImageTexture(both, linear=True, channel="g"), (roughness,) * 3),
            )
    if given.normalTexture is not None:
        normals = ImageTexture(_pixels(given.normalTexture), linear=True)
        material = NormalMap(material or MetallicRough(), normals)
    if given.alphaMode in ("MASK", "BLEND") and alpha != 1.0:
        if given.alphaMode == "MASK" and not isinstance(alpha, Texture):
            alpha = float(alpha >= _cutoff(given))
        material = Mask(material or MetallicRough(), alpha)
    return Look(material, _emission(given))


def _emission(given: Any) -> Value | None:
    factor = given.emissiveFactor
    if factor is None or not np.any(factor):
        return None
    radiance = _triple(np.asarray(factor, np.float64))
    picture = given.emissiveTexture
    return radiance if picture is None else _times(ImageTexture(_pixels(picture)), radiance)


def _masked(given: Any, pixels: NDArray[Any], factor: Any) -> Texture:
    """Return the alpha of a picture, which for a mask is cut to 0 and 1."""
    if given.alphaMode != "MASK":
        return _alpha(ImageTexture(pixels, channel="a"), factor)
    kept = pixels[..., -1] * (factor / 255) >= _cutoff(given)
    return ImageTexture(kept.astype(np.uint8) * np.uint8(255), linear=True)


def _alpha(texture: Texture, factor: float) -> Texture:
    return texture if factor == 1.0 else ProductTexture(texture, factor)


def _cutoff(given: Any) -> float:
    return 0.5 if given.alphaCutoff is None else float(given.alphaCutoff)


def _times(texture: Texture, factor: Value) -> Texture:
    return texture if factor == (1.0, 1.0, 1.0) else ProductTexture(texture, factor)


def _pixels(image: Any) -> NDArray[Any]:
    """Return a picture of Pillow's as an (H, W, C) array."""
    if image.mode not in ("L", "LA", "RGB", "RGBA"):
        image = image.convert("RGBA" if "transparency" in image.info else "RGB")
    array = np.array(image)
    return array if array.ndim == 3 else array[..., np.newaxis]


def _triple(numbers: NDArray[np.float64]) -> Triple:
    red, green, blue = numbers.tolist()
    return red, green, blue


def _linear(rgb: Any) -> NDArray[np.float64]:
    """Red, green and blue of 8 bits to linear (IEC 61966-2-1)."""
    c = np.asarray(rgb, np.float64) / 255
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
