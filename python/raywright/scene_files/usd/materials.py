"""Materials of a USD stage: UsdPreviewSurface."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ...materials import Dielectric, Diffuse, Mask, Material, MetallicRough, Mix, NormalMap
from ...textures import ImageTexture, ProductTexture, VertexColors
from ...textures.texture import Texture, Value
from .nodes import Link, Node
from .primvars import constant
from .reading import Reading
from .textures import Picture, Textures

Triple = tuple[float, float, float]
_BLACK: Triple = (0.0, 0.0, 0.0)
_GRAY: Triple = (0.5, 0.5, 0.5)


class Surface(NamedTuple):
    """A material, its emission, and its primvars: of coordinates, and of colors if it needs them."""

    material: Material
    emission: Value | None = None
    uv: str | None = None
    colors: str | None = None
    missing: Triple = _BLACK


PLAIN = Surface(Diffuse(_GRAY))


def bound(prim: Any, reading: Reading, color: Triple | None = None) -> Surface | None:
    """Return the surface of the material that a prim is bound to; None if it is bound to none.

    Parameters
    ----------
    prim : Usd.Prim
        The prim.
    reading : Reading
        The stage.
    color : 3 floats, optional
        The color of the prim, if it is the same everywhere, which is used for colors of vertices.
    """
    from pxr import UsdShade

    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    if not material:
        return None
    key = str(material.GetPath()), color
    if key not in reading.surfaces:
        shader = material.ComputeSurfaceSource()[0]
        reading.surfaces[key] = PLAIN
        if not shader or shader.GetShaderId() != "UsdPreviewSurface":
            reading.notes.tell("materials other than UsdPreviewSurface are shown as gray")
        else:
            reading.surfaces[key] = _Reader(Node(shader, reading), reading, color).surface()
    return reading.surfaces[key]  # type: ignore[no-any-return]


def own_surface(prim: Any, reading: Reading) -> Surface:
    """Return the surface of a prim without a material, which has one color."""
    return colored(own_color(prim, reading), opacity(prim, reading))


def own_color(prim: Any, reading: Reading) -> Triple:
    """Return the displayColor of all of a prim; gray if it has none."""
    given = constant(prim, "displayColor", reading, 3)
    red, green, blue = (float(x) for x in (_GRAY if given is None else given.clip(0, 1)))
    return red, green, blue


def opacity(prim: Any, reading: Reading) -> float:
    """Return the displayOpacity of all of a prim."""
    given = constant(prim, "displayOpacity", reading, 1)
    return 1.0 if given is None else float(given[0].clip(0, 1))


def colored(color: Triple | None, opacity: float = 1.0) -> Surface:
    """Return the surface of a prim that has colors of its own, or one for all of it, and no material."""
    made: Material = Diffuse(VertexColors() if color is None else color)
    made = made if opacity == 1 else Mask(made, opacity)
    return Surface(made, colors="displayColor" if color is None else None)


class _Reader:
    """A UsdPreviewSurface, as far as it is read."""

    def __init__(self, node: Node, reading: Reading, color: Triple | None) -> None:
        self._node, self._reading, self._vertex = node, reading, color
        self._tell = reading.notes.tell
        self._textures = Textures(reading)
        self._uv: dict[str, None] = {}
        self._colors: str | None = None
        self._missing = _BLACK

    def surface(self) -> Surface:
        self._tell_what_is_left_out()
        made: Material = MetallicRough(
            self._color("diffuseColor", 0.18, 1.0),
            self._number("metallic", 0.0),
            self._number("roughness", 0.5),
        )
        made = self._cut(made)
        link = self._node.link("normal")
        if link is not None and (normal := self._normal(link)) is not None:
            made = NormalMap(made, normal)
        shine = self._color("emissiveColor", 0.0, None)
        if len(self._uv) > 1:
            self._tell(f"textures of one material are placed by one primvar: {next(iter(self._uv))}")
        emission = None if shine == _BLACK else _times(shine, self._reading.exposure)
        return Surface(made, emission, next(iter(self._uv), None), self._colors, self._missing)

    def _tell_what_is_left_out(self) -> None:
        node = self._node
        if node.value("useSpecularWorkflow", 0):
            self._tell("the specular workflow of UsdPreviewSurface is approximated by that of metals")
        for name in ("clearcoat", "displacement"):
            if node.link(name) is not None or node.value(name, 0.0):
                self._tell(f"the {name} of UsdPreviewSurface is left out")
        if node.link("occlusion") is not None or node.value("occlusion", 1.0) != 1:
            self._tell("the occlusion of UsdPreviewSurface is left out: it is traced")
        for name in ("ior", "opacityThreshold", "useSpecularWorkflow", "opacityMode"):
            if node.link(name) is not None:
                self._tell(f"the {name} of UsdPreviewSurface is left out where it varies")

    def _cut(self, made: Material) -> Material:
        """Return a material with the opacity of the surface."""
        node = self._node
        threshold = float(node.value("opacityThreshold", 0.0))
        opacity = self._number("opacity", 1.0, threshold)
        ior = float(node.value("ior", 1.5))
        clear = not isinstance(opacity, Texture) and opacity < 1 and threshold <= 0
        presence = str(node.value("opacityMode", "transparent")) == "presence"
        if isinstance(opacity, Texture) or (clear and presence):
            return Mask(made, opacity)
        if not clear:
            if ior != 1.5 and opacity > 0:
                self._tell("the ior of opaque surfaces is left out")
            return made if opacity == 1 or opacity >= threshold > 0 else Mask(made, 0.0)
        # The share of the surface that is not glass.
        glass = Dielectric(ior, self._number("roughness", 0.5))
        return glass if opacity == 0 else Mix(made, glass, 1 - opacity)

    def _normal(self, link: Link) -> ImageTexture | None:
        if link.node.kind != "UsdUVTexture":
            self._left_out("normal")
            return None
        found = self._textures.normal(link)
        return None if found is None else self._placed(found)  # type: ignore[return-value]

    def _color(self, name: str, default: float, limit: float | None) -> Value:
        link = self._node.link(name)
        if link is not None:
            if link.node.kind == "UsdUVTexture":
                return self._placed(self._textures.read(link, False, limit))
            if link.node.kind == "UsdPrimvarReader_float3":
                return self._of_vertices(link)
            self._left_out(name)
        given = np.broadcast_to(np.array(self._node.value(name, default), np.float64), 3)
        cut = given.clip(0.0, limit)
        if (cut != given).any() and np.isfinite(given).all():
            self._tell(f"a {name} of {_told(given)} is taken as {_told(cut)}")
            given = cut
        red, green, blue = (float(x) for x in given)
        return red, green, blue

    def _of_vertices(self, link: Link) -> Value:
        if self._vertex is not None:
            return self._vertex
        self._colors = str(link.node.value("varname") or "displayColor")
        red, green, blue = (float(x) for x in link.node.value("fallback", _BLACK))
        self._missing = red, green, blue
        return VertexColors()

    def _number(self, name: str, default: float, threshold: float = 0.0) -> Any:
        link = self._node.link(name)
        if link is not None:
            if link.node.kind == "UsdUVTexture":
                made = self._placed(self._textures.read(link, True, 1.0, threshold))
                return made if isinstance(made, Texture) else made[0]
            self._left_out(name)
        given = float(self._node.value(name, default))
        cut = min(max(given, 0.0), 1.0)
        if cut != given and np.isfinite(given):
            self._tell(f"a {name} of {given:g} is taken as {cut:g}")
            return cut
        return given

    def _placed(self, picture: Picture) -> Value:
        if picture.uv is not None:
            self._uv.setdefault(picture.uv)
        return picture.value

    def _left_out(self, name: str) -> None:
        self._tell(f"the connection of {name} is left out: it is not a UsdUVTexture")


def _times(value: Value, factor: float) -> Value:
    if factor == 1:
        return value
    if isinstance(value, Texture):
        return ProductTexture(value, factor)
    red, green, blue = (factor * x for x in value)
    return red, green, blue


def _told(values: Any) -> str:
    return "(" + ", ".join(f"{x:g}" for x in values) + ")"
