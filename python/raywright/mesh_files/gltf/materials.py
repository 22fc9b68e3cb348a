"""Materials of a glTF file (glTF 2.0, 3.9, and extensions)."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np

from ...arrays import Triple
from ...lights.emission import Emitted
from ...materials import Material
from ..pbr import IOR, Pbr, Picture
from .clear import film, within
from .document import Document
from .glossy import of_glossy
from .part import Part
from .pictures import Pictures, coordinates


class Surface(NamedTuple):
    """Material of a primitive.

    Attributes
    ----------
    material : Material, optional
        Its material; None if it has none.
    emission : Emitted, optional
        Its emission.
    coordinates : int, optional
        Set of texture coordinates of its pictures; None if it has no pictures.
    alpha_mode : str
        ``"OPAQUE"``, or ``"MASK"`` or ``"BLEND"``, for which alpha counts.
    alpha : float
        Factor of the alpha of vertices and pictures.
    cutoff : float
        Of a mask: the least alpha that is there.
    """

    material: Material | None
    emission: Emitted | None
    coordinates: int | None = None
    alpha_mode: str = "OPAQUE"
    alpha: float = 1.0
    cutoff: float = 0.5


class Vertices(NamedTuple):
    """Contribution of vertex colors to a material.

    Attributes
    ----------
    colored : bool
        True if each vertex has a color.
    tint : 3 floats
        The color that all of them have, otherwise.
    alpha : float or str
        The alpha of all of them, or its source: ``"u"`` in texture coordinates, ``"colors"`` in place of
        their colors.
    """

    colored: bool = False
    tint: Triple = (1.0, 1.0, 1.0)
    alpha: float | Literal["u", "colors"] = 1.0


class Materials:
    """The materials of a document, each made once for those with colors of vertices and once for others."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._all = document.root.parts("materials")
        self._pictures = Pictures(document)
        self._made: dict[tuple[int, Vertices], Surface] = {}

    def of(self, primitive: Part, vertices: Vertices) -> Surface:
        """Return the material that a primitive names."""
        if "material" not in primitive:
            return Surface(Pbr(colored=vertices.colored).material(), None)
        key = primitive.reference("material", "materials", len(self._all)), vertices
        if key not in self._made:
            self._made[key] = self._surface(self._all[key[0]], vertices)
        return self._made[key]

    def _surface(self, part: Part, vertices: Vertices) -> Surface:
        unlit = part.extension("KHR_materials_unlit") is not None
        if unlit:
            self._document.tell("unlit materials are matte here")
        seen = _Seen(self._document, self._pictures)
        clear = part.extension("KHR_materials_transmission")
        strength = part.extension("KHR_materials_emissive_strength")
        factor = 1.0 if strength is None else strength.number("emissiveStrength", 1.0, 0.0)
        normals = part.part("normalTexture")
        made = _model(part, seen)._replace(
            normal_picture=seen.picture(part, "normalTexture"),
            normal_scale=normals.number("scale", 1.0),
            emission=part.numbers("emissiveFactor", 3, (0.0, 0.0, 0.0), 0) * factor,
            emission_picture=seen.picture(part, "emissiveTexture"),
            alpha_mode=_alpha_mode(part),
            alpha_cutoff=part.number("alphaCutoff", 0.5, 0),
            both_sides=part.flag("doubleSided"),
            colored=vertices.colored,
            vertex_alpha=vertices.alpha,
            ior=self._ior(part),
            transmission=0.0 if clear is None else clear.number("transmissionFactor", 0.0, 0, 1),
            transmission_picture=None if clear is None else seen.picture(clear, "transmissionTexture"),
            within=within(part),
            film=film(part, seen.picture),
            unlit=unlit,
        )
        if vertices.tint != (1, 1, 1):
            color = np.ones(4) if made.color is None else made.color
            made = made._replace(color=color * (*vertices.tint, *[1.0] * (len(color) - 3)))
        self._tell_of_glass(made)
        alpha = 1.0 if made.color is None or len(made.color) < 4 else float(made.color[3])
        return Surface(
            made.material(),
            made.emitted(),
            seen.coordinates,
            made.alpha_mode or "OPAQUE",
            alpha,
            0.5 if made.alpha_cutoff is None else made.alpha_cutoff,
        )

    def _ior(self, part: Part) -> float:
        given = part.extension("KHR_materials_ior")
        ior = IOR if given is None else given.number("ior", IOR, 0)
        if 0 < ior < 1:
            raise ValueError(f"{part.place} must have an ior of 0 or at least 1, and has {ior:g}")
        if ior == 0:
            self._document.tell("an ior of 0, which reflects all light, is left out")
            return IOR
        return ior

    def _tell_of_glass(self, made: Pbr) -> None:
        """Report the features of clear materials and of films that are not supported."""
        tell = self._document.tell
        if made.film is not None and made.transmission > 0 and made.is_tinted:
            tell("light through clear materials with films is not tinted by their base color")
        if made.film is not None and made.transmission == 0 and made.filmed != "all":
            colored = "films are left out of metals with colors of vertices and of opaque nonmetals"
            tell(colored if made.colored else "films are left out of opaque nonmetals")
        if made.transmission > 0:
            if made.within is None and (made.roughness is None or made.roughness > 0):
                tell("thin clear materials are smooth here, whatever their roughness")
        elif made.ior != IOR and made.metallic != 0.0:
            tell("the ior is left out of opaque materials that are metallic")


def _model(part: Part, seen: _Seen) -> Pbr:
    """Return the color of a material, and how metallic and how rough it is."""
    glossy = part.extension("KHR_materials_pbrSpecularGlossiness")
    if glossy is not None:
        pictures = (seen.picture(glossy, name) for name in ("diffuseTexture", "specularGlossinessTexture"))
        return of_glossy(glossy, *pictures)
    rough = part.part("pbrMetallicRoughness")
    return Pbr(
        color=rough.numbers("baseColorFactor", 4, None, 0, 1) if "baseColorFactor" in rough else None,
        # Meshes keep one set of texture coordinates: that of the base color, which is read first.
        color_picture=seen.picture(rough, "baseColorTexture"),
        metallic=rough.number("metallicFactor", None, 0, 1) if "metallicFactor" in rough else None,
        roughness=rough.number("roughnessFactor", None, 0, 1) if "roughnessFactor" in rough else None,
        rough_picture=seen.picture(rough, "metallicRoughnessTexture"),
    )


class _Seen:
    """The pictures of one material, which must lie on one set of texture coordinates."""

    def __init__(self, document: Document, pictures: Pictures) -> None:
        self._document = document
        self._pictures = pictures
        self.coordinates: int | None = None

    def picture(self, part: Part, name: str) -> Picture | None:
        if name not in part:
            return None
        info = part.part(name)
        wanted = coordinates(info)
        if self.coordinates is None:
            self.coordinates = wanted
        elif wanted != self.coordinates:
            self._document.tell(
                "materials with pictures on several sets of texture coordinates keep those on the first"
            )
            return None
        return self._pictures.of(info)


def _alpha_mode(part: Part) -> str:
    mode = part.text("alphaMode", "OPAQUE")
    if mode not in ("OPAQUE", "MASK", "BLEND"):
        raise ValueError(f"{part.at('alphaMode')} must be OPAQUE, MASK or BLEND, and is {mode[:20]!r}")
    return mode
