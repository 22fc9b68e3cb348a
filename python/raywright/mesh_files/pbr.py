"""The material of glTF 2.0, made of this library's materials: metal and matt, clear, cut out, and shining."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple
from ..lights import Emission
from ..lights.emission import Emitted
from ..materials import (
    Cauchy,
    Conductor,
    Dielectric,
    Diffuse,
    Mask,
    Material,
    MetallicRough,
    Mix,
    NormalMap,
    Plastic,
    SoapFilm,
    ThinDielectric,
    ThinFilm,
    Tinted,
)
from ..textures import ImageTexture, MixTexture, ProductTexture, UvTransform, VertexColors
from ..textures.image import Channel, Filter, Wrap
from ..textures.texture import Number, Texture, Value
from .look import linear

_WHITE = (1.0, 1.0, 1.0)
# Reflects 4 % at normal incidence, as in the model of glTF (3.9.6, and KHR_materials_ior).
IOR = 1.5


class Picture(NamedTuple):
    """A picture, and how it lies on a surface: what an `ImageTexture` is made of.

    Attributes
    ----------
    pixels : (H, W, C) array
        Rows from the top.
    wrap, filter, transform
        As in `ImageTexture`.
    """

    pixels: NDArray[Any]
    wrap: tuple[Wrap, Wrap] = ("repeat", "repeat")
    filter: Filter = "trilinear"
    transform: UvTransform | None = None

    @property
    def has_alpha(self) -> bool:
        """True if its last channel is alpha."""
        return self.pixels.shape[2] in (2, 4)

    def texture(self, linear: bool = False, channel: Channel | None = None) -> ImageTexture:
        """Return it as a texture, sRGB unless it is linear."""
        return ImageTexture(self.pixels, linear, channel, self.filter, self.wrap, self.transform)


class Within(NamedTuple):
    """Interiors of clear materials (KHR_materials_volume, KHR_materials_dispersion).

    Attributes
    ----------
    share : 3 floats
        Transmittance after a way of the length of `distance`, above 0.
    distance : float
        That way, in units of the world; infinite where nothing is lost.
    abbe : float, optional
        Abbe's number, where the index of refraction goes with wavelength.
    """

    share: Triple
    distance: float
    abbe: float | None


class Film(NamedTuple):
    """A film of the colors of its thickness (KHR_materials_iridescence).

    Attributes
    ----------
    share : float
        Of the surface that has it.
    picture : Picture, optional
        Of that share, in red.
    ior : float
        Its index of refraction.
    least, most : float
        Its thickness in nanometers where its picture is 0, and where it is 1 or there is none.
    thickness : Picture, optional
        Of the thickness, in green.
    """

    share: float
    picture: Picture | None
    ior: float
    least: float
    most: float
    thickness: Picture | None


class Pbr(NamedTuple):
    """A material of glTF (3.9, and extensions); None where it says nothing.

    Attributes
    ----------
    color : (3,) or (4,) array, optional
        Linear base color, and alpha.
    color_picture, rough_picture, normal_picture, emission_picture : Picture, optional
        Of base color, of roughness in green and metalness in blue, of normals, and of emission.
    metallic, roughness : float, optional
        1 if not given, where something else is.
    normal_scale : float
        Strength of normals.
    emission : (3,) array, optional
        Radiance.
    alpha_mode : str, optional
        ``"MASK"`` and ``"BLEND"`` make alpha count.
    alpha_cutoff : float, optional
        Of a mask: the least alpha that is there; 0.5 if not given.
    both_sides : bool
        True if the back shines too.
    colored : bool
        True if vertex colors count.
    vertex_alpha : float or str
        Their alpha, or its source: ``"u"`` along the picture that stands for it, for meshes without others,
        ``"colors"`` in place of their colors, for blended ones.
    ior : float
        Index of refraction.
    transmission : float
        Share of light that goes through where it is not a metal (KHR_materials_transmission).
    transmission_picture : Picture, optional
        Of that share, in red.
    within : Within, optional
        Its interior, unless it is a thin sheet.
    film : Film, optional
        Its film, on clear materials or metal; a partly metallic one has it on the metal.
    unlit : bool
        True if it is to be shown without light (KHR_materials_unlit); it is matt here.
    """

    color: NDArray[np.float64] | None = None
    color_picture: Picture | None = None
    metallic: float | None = None
    roughness: float | None = None
    rough_picture: Picture | None = None
    normal_picture: Picture | None = None
    normal_scale: float = 1.0
    emission: NDArray[np.float64] | None = None
    emission_picture: Picture | None = None
    alpha_mode: str | None = None
    alpha_cutoff: float | None = None
    both_sides: bool = False
    colored: bool = False
    vertex_alpha: float | str = 1.0
    ior: float = IOR
    transmission: float = 0.0
    transmission_picture: Picture | None = None
    within: Within | None = None
    film: Film | None = None
    unlit: bool = False

    def material(self) -> Material | None:
        """Return the material, None where nothing is said that is to be seen."""
        made = self._body()
        if self.transmission > 0:
            made = self._clear(made or MetallicRough())
        if self.normal_picture is not None:
            normals = self.normal_picture.texture(linear=True)
            made = NormalMap(made or MetallicRough(), normals, self.normal_scale)
        alpha = self._alpha()
        return made if alpha == 1.0 else Mask(made or MetallicRough(), alpha)

    def emitted(self) -> Emitted | None:
        """Return what it gives off, None if that is nothing."""
        if self.emission is None or not self.emission.any():
            return None
        radiance: Value = _triple(self.emission)
        if self.emission_picture is not None:
            radiance = _times(self.emission_picture.texture(), radiance)
        return Emission(radiance, both_sides=True) if self.both_sides else radiance

    @property
    def is_tinted(self) -> bool:
        """True if its base color is not white."""
        tinted = self.color_picture is not None or self.colored
        return tinted or (self.color is not None and bool((self.color[:3] != 1).any()))

    @property
    def filmed(self) -> str:
        """Share of the opaque part that shows its film: "all", "metal", or "nothing"."""
        metallic, _ = self._shares()
        if metallic == 0.0 or self.colored:
            return "nothing"
        return "all" if metallic == 1.0 else "metal"

    def _body(self) -> Material | None:
        """Return what it is without holes, and as if nothing went through."""
        known = (self.color, self.color_picture, self.metallic, self.roughness, self.rough_picture)
        if all(one is None for one in known) and not self.unlit:
            return Diffuse(VertexColors()) if self.colored else None
        color = self._color()
        if self.unlit:
            return Diffuse(color)
        metallic, roughness = self._shares()
        if self.ior != IOR and self.ior >= 1 and metallic == 0.0:
            return Plastic(color, self.ior, roughness)
        body = MetallicRough(color, metallic, roughness)
        if self.film is None or self.filmed == "nothing":
            return body
        metal = self._filmed(
            body if metallic == 1.0 else MetallicRough(color, 1.0, roughness),
            Conductor(eta=self._indices(), k=0.0, roughness=roughness),
        )
        return metal if metallic == 1.0 else Mix(MetallicRough(color, 0.0, roughness), metal, metallic)

    def _indices(self) -> Value:
        """Return the indices of refraction for which metal reflects its base color, picture and all."""
        factor = np.array(_WHITE if self.color is None else self.color[:3])
        picture = self.color_picture
        if picture is None:
            return _triple(_index(factor))
        colors = picture.pixels[..., : -1 if picture.has_alpha else None]
        full = _full(colors)
        shares = linear(np.arange(full + 1) / full)[colors] if colors.dtype.kind == "u" else colors
        return picture._replace(pixels=_index(shares * factor).astype(np.float32)).texture(linear=True)

    def _filmed(self, bare: Material, base: Dielectric | Conductor | None) -> Material:
        """Return what has the film on it, as far as that covers it; without a base the film is by itself."""
        film = self.film
        assert film is not None
        thickness: Number = film.most
        if film.thickness is not None:
            thickness = MixTexture(film.least, film.most, film.thickness.texture(linear=True, channel="g"))
        made: Material = (
            SoapFilm(thickness, film.ior) if base is None else ThinFilm(thickness, film.ior, base=base)
        )
        share: Number = film.share
        if film.picture is not None:
            share = _scaled(film.picture.texture(linear=True, channel="r"), film.share)
        return made if share == 1.0 else Mix(bare, made, share)

    def _color(self) -> Value:
        color: Value = _WHITE if self.color is None else _triple(self.color[:3])
        if self.color_picture is not None:
            color = _times(self.color_picture.texture(), color)
        return _times(VertexColors(), color) if self.colored else color

    def _shares(self) -> tuple[Number, Number]:
        """Return how metallic and how rough it is."""
        metallic = 1.0 if self.metallic is None else self.metallic
        roughness = 1.0 if self.roughness is None else self.roughness
        if self.rough_picture is None:
            return metallic, roughness
        # With a factor of 0, the picture has no effect.
        blue = self.rough_picture.texture(linear=True, channel="b") if metallic else None
        green = self.rough_picture.texture(linear=True, channel="g")
        return (0.0 if blue is None else _scaled(blue, metallic)), _scaled(green, roughness)

    def _clear(self, body: Material) -> Material:
        """Return a material that light goes through where it is not a metal."""
        metallic, roughness = self._shares()
        clear: Material = self._glass(roughness)
        share: Number = self.transmission
        if self.transmission_picture is not None:
            share = _scaled(self.transmission_picture.texture(linear=True, channel="r"), self.transmission)
        if isinstance(metallic, Texture):
            share = ProductTexture(MixTexture(1.0, 0.0, metallic), share)
        elif metallic:
            share = _share_of(share, 1 - metallic)
        return clear if share == 1.0 else Mix(body, clear, share)

    def _glass(self, roughness: Number) -> Material:
        """Return what is clear, with its color, or with the film on it."""
        within = self.within
        pane: Dielectric | ThinDielectric
        if within is None:
            pane = ThinDielectric(self.ior)
        else:
            ior = self.ior if within.abbe is None else Cauchy.from_abbe(self.ior, within.abbe)
            takes = math.isfinite(within.distance) and within.distance > 0
            share, distance = (within.share, within.distance) if takes else (None, None)
            pane = Dielectric(ior, roughness, transmittance=share, distance=distance)
        if self.film is not None:
            return self._filmed(pane, pane if isinstance(pane, Dielectric) else None)
        return Tinted(pane, self._color()) if self.is_tinted else pane

    def _alpha(self) -> Number:
        """Return how much of it is there."""
        factor = 1.0 if self.color is None or len(self.color) < 4 else float(self.color[3])
        if self.alpha_mode not in ("MASK", "BLEND"):
            return 1.0
        if self.vertex_alpha == "u":
            pixels = np.array([[[0], [255]]], np.uint8)
            filter: Filter = "bilinear" if self.alpha_mode == "BLEND" else "nearest"
            return Picture(pixels, ("clamp", "clamp"), filter).texture(linear=True)
        if self.vertex_alpha == "colors":
            return self._blended(VertexColors(), factor)
        factor *= float(self.vertex_alpha)
        picture = self.color_picture
        cutoff = 0.5 if self.alpha_cutoff is None else self.alpha_cutoff
        if picture is None or not picture.has_alpha:
            return float(factor >= cutoff) if self.alpha_mode == "MASK" else factor
        if self.alpha_mode == "BLEND":
            return self._blended(None, factor)
        kept = picture.pixels[..., -1] * (factor / _full(picture.pixels)) >= cutoff
        cut = picture._replace(pixels=(kept.astype(np.uint8) * np.uint8(255))[..., np.newaxis])
        return cut.texture(linear=True)

    def _blended(self, of_vertices: Texture | None, factor: float) -> Number:
        """Return the product of the alpha of vertices, of the picture, and a factor."""
        picture = self.color_picture
        of_picture = picture.texture(channel="a") if picture is not None and picture.has_alpha else None
        made = of_vertices or of_picture
        assert made is not None
        if of_vertices is not None and of_picture is not None:
            made = ProductTexture(of_vertices, of_picture)
        return _scaled(made, factor)


def _full(pixels: NDArray[Any]) -> int:
    """Return the number of a picture's that is 1."""
    return int(np.iinfo(pixels.dtype).max) if pixels.dtype.kind == "u" else 1


def _times(texture: Texture, factor: Value) -> Texture:
    return texture if factor == _WHITE else ProductTexture(texture, factor)


def _scaled(texture: Texture, factor: float) -> Texture:
    return texture if factor == 1.0 else ProductTexture(texture, factor)


def _share_of(share: Number, factor: float) -> Number:
    return _scaled(share, factor) if isinstance(share, Texture) else share * factor


def _index(shares: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the indices of refraction with these reflectances at normal incidence."""
    root = np.sqrt(np.clip(shares, 0.0, 0.9999))
    return np.asarray((1 + root) / (1 - root))


def _triple(numbers: NDArray[np.float64]) -> Triple:
    red, green, blue = numbers.tolist()
    return red, green, blue
