"""Materials of a USD stage: UsdPreviewSurface and its pictures."""

from typing import Any, NamedTuple

import numpy as np

from ...io.pictures import read
from ...materials import Dielectric, Diffuse, Mask, Material, MetallicRough, Mix, NormalMap
from ...textures import ImageTexture, MixTexture, ProductTexture, UvTransform, VertexColors
from ...textures.texture import Texture, Value
from .notes import Notes

_WRAPS = {"clamp": "clamp", "mirror": "mirror", "black": "clamp", "repeat": "repeat", "useMetadata": "repeat"}


class Surface(NamedTuple):
    """What a material looks like, what it gives off, and the set of coordinates of its pictures."""

    material: Material
    emission: Value | None
    uv: str


PLAIN = Surface(Diffuse(0.5), None, "st")


def bound(prim: Any, notes: Notes, kept: dict[str, Surface]) -> Surface | None:
    """Return the surface of the material that a prim is bound to; None if it is to none."""
    from pxr import UsdShade

    material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
    if not material:
        return None
    key = str(material.GetPath())
    if key not in kept:
        shader = material.ComputeSurfaceSource()[0]
        kept[key] = PLAIN
        if not shader or shader.GetShaderId() != "UsdPreviewSurface":
            notes.tell("materials that are no UsdPreviewSurface are shown as grey ones")
        else:
            kept[key] = _Reader(shader, notes).surface()
    return kept[key]


def coloured() -> Surface:
    """Return the surface of what has colours of its own and no material."""
    return Surface(Diffuse(VertexColors()), None, "st")


class _Reader:
    """A UsdPreviewSurface, as far as it is read."""

    def __init__(self, shader: Any, notes: Notes) -> None:
        self._shader, self._notes = shader, notes
        self._uv = "st"

    def surface(self) -> Surface:
        colour = self._colour("diffuseColor", 0.18)
        rough = self._number("roughness", 0.5)
        if self._plain("useSpecularWorkflow", 0):
            self._notes.tell("the specular workflow of UsdPreviewSurface is approximated by that of metals")
        if self._plain("clearcoat", 0.0):
            self._notes.tell("the clearcoat of UsdPreviewSurface is left out")
        if self._plain("displacement", 0.0):
            self._notes.tell("the displacement of UsdPreviewSurface is left out")
        made: Material = MetallicRough(colour, self._number("metallic", 0.0), rough)
        opacity, threshold = self._number("opacity", 1.0), float(self._plain("opacityThreshold", 0.0))
        if isinstance(opacity, Texture):
            made = Mask(made, opacity)
        elif opacity < 1:
            if threshold > 0:
                made = Mask(made, 0.0 if opacity < threshold else 1.0)
            elif self._mode() == "presence":
                made = Mask(made, opacity)
            else:
                # Opacity says how much is not glass.
                ior = float(self._plain("ior", 1.5))
                glass = Dielectric(ior, rough)
                made = glass if opacity == 0 else Mix(made, glass, 1 - opacity)
        normal = self._texture("normal", raw=True)
        if isinstance(normal, ImageTexture):
            made = NormalMap(made, normal)
        shine = self._colour("emissiveColor", 0.0)
        return Surface(made, None if shine == (0.0, 0.0, 0.0) else shine, self._uv)

    def _mode(self) -> str:
        return str(self._plain("opacityMode", "transparent"))

    def _plain(self, name: str, default: Any) -> Any:
        given = self._shader.GetInput(name)
        value = given.Get() if given else None
        return default if value is None else value

    def _colour(self, name: str, default: float) -> Value:
        made = self._texture(name)
        if made is not None:
            return made
        red, green, blue = (float(x) for x in np.broadcast_to(np.array(self._plain(name, default)), 3))
        return red, green, blue

    def _number(self, name: str, default: float) -> Any:
        made = self._texture(name, number=True)
        return float(self._plain(name, default)) if made is None else made

    def _texture(self, name: str, number: bool = False, raw: bool = False) -> Texture | None:
        from pxr import UsdShade

        given = self._shader.GetInput(name)
        if not given or not given.HasConnectedSource():
            return None
        source, output, _ = given.GetConnectedSource()
        shader = UsdShade.Shader(source.GetPrim())
        kind = shader.GetShaderId() if shader else None
        if kind == "UsdPrimvarReader_float3" and not number:
            return VertexColors()
        if kind != "UsdUVTexture":
            self._notes.tell(f"what {name} is connected to is left out: it is no UsdUVTexture")
            return None
        file = shader.GetInput("file").Get()
        if not file:
            return None
        array = read(file.resolvedPath or file.path)
        space = shader.GetInput("sourceColorSpace")
        space = space.Get() if space else None
        linear = raw or space == "raw" or (space != "sRGB" and number)
        wraps = [shader.GetInput(axis) for axis in ("wrapS", "wrapT")]
        wrap = tuple(_WRAPS.get(str(one.Get()), "repeat") if one else "repeat" for one in wraps)
        channel = output if number and output in ("r", "g", "b", "a") else None
        if channel == "a" and array.shape[2] not in (2, 4):
            return None
        image = ImageTexture(
            array if number or raw else array[..., : 3 if array.shape[2] > 2 else 1],
            linear=linear,
            channel=channel,
            wrap=wrap,  # type: ignore[arg-type]
            transform=self._placed(shader),
        )
        if raw:
            return image
        return self._scaled(image, shader, channel)

    def _scaled(self, image: Texture, shader: Any, channel: str | None) -> Texture:
        place = "rgba".index(channel) if channel else None
        scale, bias = (
            self._four(shader, name, place, default) for name, default in (("scale", 1.0), ("bias", 0.0))
        )
        if scale != (1.0, 1.0, 1.0):
            image = ProductTexture(image, scale)
        # A sum is twice a mean.
        return image if bias == (0.0, 0.0, 0.0) else ProductTexture(MixTexture(image, bias, 0.5), 2.0)

    def _four(self, shader: Any, name: str, place: int | None, default: float) -> tuple[float, float, float]:
        given = shader.GetInput(name)
        value = given.Get() if given else None
        four = np.full(4, default) if value is None else np.array(value, np.float64)
        red, green, blue = (float(x) for x in (four[:3] if place is None else np.repeat(four[place], 3)))
        return red, green, blue

    def _placed(self, shader: Any) -> UvTransform:
        """Return where coordinates come from, which are kept by the name of their set."""
        from pxr import UsdShade

        given = shader.GetInput("st")
        transform = UvTransform()
        for _ in range(8):
            if not given or not given.HasConnectedSource():
                break
            source = UsdShade.Shader(given.GetConnectedSource()[0].GetPrim())
            if source.GetShaderId() == "UsdTransform2d":
                parts = {name: source.GetInput(name) for name in ("scale", "rotation", "translation")}
                values = {name: one.Get() if one else None for name, one in parts.items()}
                transform = UvTransform(
                    tuple(values["scale"] or (1.0, 1.0)),
                    float(values["rotation"] or 0.0),
                    tuple(values["translation"] or (0.0, 0.0)),
                )
                given = source.GetInput("in")
            else:
                name = source.GetInput("varname")
                self._uv = str((name.Get() if name else None) or "st")
                break
        return transform
