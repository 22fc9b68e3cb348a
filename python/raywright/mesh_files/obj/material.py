"""Materials of a material library, made of this library's materials.

The models are those of the format's own illum (Alias|Wavefront, 1995): a matt surface; highlights by the
formula of Blinn (1977); mirrors; panes; and glass that refracts. Statements for physically based rendering
(Pr, Pm) take precedence. Blender, which fits a material of another kind to these numbers, is read by its rule
of writing.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...lights import Emission
from ...materials import (
    BlinnPhong,
    BumpMap,
    Dielectric,
    Diffuse,
    Mask,
    Material,
    MetallicRough,
    Mirror,
    Mix,
    NormalMap,
    ThinDielectric,
)
from ...textures import ImageTexture, MixTexture, ProductTexture
from ...textures.texture import Number, Texture, Value
from ..look import Look
from .maps import BRIGHTEST, LEFT_OUT, Map, Pictures
from .mtl import Description
from .text import told_keyword

_GRAY = np.full(3, 0.5)
_HARDEST = 1e9
# MeshLab and trimesh write an exponent of 0 or 1 for no highlight.
_NO_HIGHLIGHT = 1.0
_MATT, _MIRRORS, _PANE = (0, 1), (3, 5), 4
# Height of a bump map from black to white, relative to its width (a length of the mesh).
_BUMP = 0.01


def look_of_mtl(said: Description, pictures: Pictures, span: float | None) -> Look:
    """Return the appearance of a surface from a material library.

    Parameters
    ----------
    said : Description
        Its statements.
    pictures : Pictures
        Folder of its pictures.
    span : float, optional
        Length on the surface of 1 in texture coordinates; None where there are none.
    """
    look = _Reading(said, pictures, span).look()
    # Ambient light is not simulated, and antialiasing of pictures has no effect.
    said.take("Ka", "map_Ka", "map_aat", "sharpness", "Ni", "Ns")
    said.unless_zero("Ps", "Pc", "aniso", "anisor")
    if "Pc" not in said.left:
        said.take("Pcr")
    for keyword in said.left:
        said.note(LEFT_OUT, told_keyword(keyword))
    return look


class _Reading:
    """The state of reading a material."""

    def __init__(self, said: Description, pictures: Pictures, span: float | None) -> None:
        self._said = said
        self._pictures = pictures
        self._span = span
        illum = said.number("illum", 0, 10)
        self._illum = None if illum is None else int(illum)
        if self._illum == 10:
            said.note(LEFT_OUT, "illum 10")

    def look(self) -> Look:
        said = self._said
        emission = self._emission()
        opacity = self._opacity()
        body = self._glass()
        if body is not None:
            # Glass transmits by refraction, so opacity does not apply.
            opacity = 1.0
        elif any(keyword in said for keyword in ("Pr", "map_Pr", "Pm", "map_Pm")):
            body = self._metallic_rough()
        elif said.blender is not None:
            body = self._principled(said.blender)
        else:
            body = self._mirror() or self._highlights()
        body = self._raised(body)
        if opacity != 1.0:
            body = self._seen_through(body or Diffuse(), opacity)
        return Look(body, emission)

    def _picture(self, keyword: str) -> Map | None:
        if self._span is None:
            if keyword in self._said:
                self._said.take(keyword)
                self._said.note("pictures are left out where there are no texture coordinates", keyword)
            return None
        return self._pictures.of(self._said, keyword)

    def _color(self, keyword: str) -> NDArray[np.float64] | ImageTexture | None:
        """Return a color; a picture stands in place of the one beside it, in many files gray or black."""
        color, found = self._said.color(keyword), self._picture(f"map_{keyword}")
        return color if found is None else found.texture()

    def _share(self, keyword: str) -> Number | None:
        """Return a number in [0, 1]; a picture stands in place of the one beside it."""
        number, found = self._said.number(keyword), self._picture(f"map_{keyword}")
        return number if found is None else found.texture(linear=True)

    def _emission(self) -> Emission | None:
        """Return what it gives off: Ke times its picture, to both sides, as the format tells of none."""
        color, found = self._said.color("Ke", BRIGHTEST), self._picture("map_Ke")
        factor = None if color is None or not color.any() else _triple(color)
        if found is None:
            return None if factor is None else Emission(factor, both_sides=True)
        # Programs that write either the factor or the picture leave the factor black beside a picture.
        texture = found.texture()
        return Emission(texture if factor is None else ProductTexture(texture, factor), both_sides=True)

    def _opacity(self) -> Number:
        """Return how much of it is there: d, or else 1 - Tr, times its picture."""
        said = self._said
        if (said.text("d") or "").lower().startswith("-halo"):
            said.note(LEFT_OUT, "d -halo")
            there = None
        else:
            there = said.number("d")
        through = said.number("Tr")
        if there is None:
            # No program writes invisible materials: MeshLab wrote 1 for opaque ones.
            there = 1.0 if through in (None, 1.0) else 1 - (through or 0.0)
        found = self._picture("map_d")
        if found is None:
            return there
        return _times(found.texture(True, found.alpha), there)

    def _glass(self) -> Material | None:
        """Return a clear solid, where light is said to be bent."""
        said = self._said
        filters = said.color("Tf")
        # A white filter has no effect, and a black one only repeats that the material is opaque.
        plain = filters is None or not filters.any() or bool((filters == 1).all())
        if not plain:
            said.note(LEFT_OUT, "Tf")
        # Blender writes illum 6 for partly transparent metal.
        bends = self._illum == 7 or (self._illum == 6 and said.blender is None)
        ior = self._ior() if bends and (filters is None or filters.any()) else None
        if ior is None:
            return None
        said.take("Kd", "map_Kd", "Ks", "map_Ks", "Ns", "map_Ns", "Pm", "map_Pm", "map_d")
        rough = self._share("Pr")
        return Dielectric(ior, 0.0 if rough is None else rough)

    def _ior(self) -> float | None:
        """Return the index of refraction where it is not that of air; within what the format allows."""
        ior = self._said.number("Ni", 0.001, 10)
        return None if ior == 1 else ior

    def _metallic_rough(self) -> Material:
        """Return what Pr and Pm say, in the words of glTF's model; highlights say the same in other words."""
        self._said.take("Ks", "map_Ks", "map_Ns")
        rough, metal = self._share("Pr"), self._share("Pm")
        if rough is None:
            exponent = self._said.number("Ns", 0, _HARDEST)
            # Lobes have the same width if alpha, roughness squared, is sqrt(2 / (Ns + 2)) (Walter et al.,
            # 2007).
            rough = 1.0 if exponent is None else (2 / (exponent + 2)) ** 0.25
        return MetallicRough(self._base(), 0.0 if metal is None else metal, rough)

    def _principled(self, smoothest: float) -> Material | None:
        """Return what Blender means by Ns: roughness, by Ka: metalness, and by map_refl: its picture."""
        said = self._said
        level, exponent, metals = said.color("Ks"), said.number("Ns", 0, _HARDEST), said.color("Ka")
        metal: Number = float(metals.mean()) if metals is not None and self._illum in (3, 6) else 0.0
        roughs, found = self._picture("map_Ns"), self._picture("map_refl")
        if found is not None:
            metal = found.texture(linear=True)
        if metal == 0.0 and level is not None and not level.any():
            return self._matt()
        rough: Number = 1 - math.sqrt(min(exponent or 0.0, smoothest) / smoothest)
        if roughs is not None:
            rough = roughs.texture(linear=True)
        return MetallicRough(self._base(), metal, rough)

    def _mirror(self) -> Material | None:
        """Return a matt surface with a mirror of reflectance Ks, brighter towards its edge with illum 5."""
        if self._illum not in _MIRRORS:
            return None
        shiny = self._color("Ks")
        if shiny is None or (not isinstance(shiny, Texture) and not shiny.any()):
            return None
        if isinstance(shiny, Texture):
            share: Number = shiny
            mirrored: Value = (1.0, 1.0, 1.0)
        else:
            share = float(shiny.max())
            mirrored = _triple(shiny / share)
        mirror: Material = Mirror(mirrored) if self._illum == 3 else MetallicRough(mirrored, 1.0, 0.0)
        base = self._color("Kd")
        if share == 1.0:
            return mirror
        if base is None or (not isinstance(base, Texture) and not base.any()):
            matt: Material = Diffuse(0.0)
        elif isinstance(base, Texture) or isinstance(share, Texture):
            matt = Diffuse(base)
        else:
            # Together they reflect no more light than arrives.
            matt = Diffuse(np.minimum(base / (1 - share), 1.0))
        return Mix(matt, mirror, share)

    def _highlights(self) -> Material | None:
        """Return a matt surface with highlights as bright as the format has them: Ks cos(h)^Ns.

        They are to Kd as the formula has it, ``(Kd + Ks cos(h)^Ns) / π``, and BlinnPhong has the share that
        such highlights reflect at normal incidence. The rest can be matt.
        """
        said = self._said
        if self._illum in _MATT:
            said.take("Ks", "map_Ks", "Ns", "map_Ns")
            return self._matt()
        shiny, exponent = self._color("Ks"), said.number("Ns", 0, _HARDEST)
        found = self._picture("map_Ns")
        if shiny is None or (not isinstance(shiny, Texture) and not shiny.any()):
            return self._matt()
        if exponent is None:
            said.note(LEFT_OUT, "Ks without Ns")
            return self._matt()
        if exponent <= _NO_HIGHLIGHT:
            return self._matt()
        if found is None:
            sharp: Number = exponent
            share: Value = _scaled(shiny, _highlight(exponent))
        else:
            varied = found.texture(linear=True)
            sharp = ProductTexture(varied, exponent)
            share = ProductTexture(_shares(found, exponent), _value(shiny))
        base = self._color("Kd")
        if base is None:
            base = _GRAY
        if not isinstance(base, Texture) and not isinstance(share, Texture):
            base = np.minimum(base, 1 - np.array(share))
        return BlinnPhong(_value(base), share, sharp)

    def _matt(self) -> Material | None:
        base = self._color("Kd")
        return None if base is None else Diffuse(_value(base))

    def _base(self) -> Value:
        base = self._color("Kd")
        return _value(_GRAY if base is None else base)

    def _raised(self, body: Material | None) -> Material | None:
        """Return a material with bumps, or with the normals of a picture."""
        normals = self._picture("norm")
        bumps = [found for keyword in ("map_bump", "bump") if (found := self._picture(keyword)) is not None]
        found = normals or (bumps[0] if bumps else None)
        if found is None or self._span is None:
            return body
        if normals is not None or found.is_of_normals:
            return NormalMap(body or Diffuse(), found.texture(linear=True), found.multiplier)
        height = found.texture(linear=True)
        (a, b, _), (c, d, _) = height.transform.matrix
        turns = math.sqrt(abs(a * d - b * c))
        width = self._span / turns if turns else 0.0
        return BumpMap(body or Diffuse(), height, _BUMP * width * found.multiplier)

    def _seen_through(self, body: Material, opacity: Number) -> Material:
        """Return a partly transparent material: with a pane for the rest (illum 4), or a hole."""
        ior = self._ior() if self._illum == _PANE and self._said.blender is None else None
        if ior is None:
            return Mask(body, opacity)
        rest = MixTexture(1.0, 0.0, opacity) if isinstance(opacity, Texture) else 1 - opacity
        return Mix(body, ThinDielectric(ior), rest)


def _highlight(exponent: Any) -> Any:
    """Return what a lobe of ``cos(h)^n / π`` reflects of light that comes straight down."""
    n = np.asarray(exponent, np.float64)
    return 8 * (np.exp2(-n / 2) + n) / ((n + 2) * (n + 4))


def _shares(found: Map, exponent: float) -> ImageTexture:
    """Return, from place to place, what highlights reflect whose exponent is a picture times a number."""
    pixels = found.picture.pixels
    full = np.iinfo(pixels.dtype).max if pixels.dtype.kind == "u" else 1.0
    if found.channel is not None:
        place = "rgb".find(found.channel) if pixels.shape[2] > 2 else 0
        pixels = pixels[..., [place if found.channel != "a" else -1]]
    counted = pixels[..., : 1 if pixels.shape[2] < 3 else 3].mean(axis=2, keepdims=True) / full
    shares = _highlight(exponent * counted).astype(np.float32)
    return found.picture._replace(pixels=shares).texture(linear=True)


def _times(texture: Texture, factor: float) -> Texture:
    return texture if factor == 1.0 else ProductTexture(texture, factor)


def _scaled(value: Any, factor: float) -> Value:
    if isinstance(value, Texture):
        return ProductTexture(value, factor)
    return _triple(np.asarray(value) * factor)


def _value(value: Any) -> Value:
    return value if isinstance(value, Texture) else _triple(value)


def _triple(numbers: NDArray[np.float64]) -> tuple[float, float, float]:
    red, green, blue = numbers.tolist()
    return red, green, blue
