"""Textures of a USD material: UsdUVTexture."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...textures import ImageTexture, MixTexture, ProductTexture, UvTransform
from ...textures.texture import Texture, Value, ends
from .nodes import Link, Node
from .reading import Reading

_WRAPS = {"clamp": "clamp", "mirror": "mirror", "repeat": "repeat", "useMetadata": "repeat"}
# Replaces an unreadable picture without a fallback.
_BLACK = (0.0, 0.0, 0.0, 1.0)
_Four = tuple[float, float, float, float]
# Scale and bias that decode a stored normal.
_HALVED, _LOWERED = (2.0, 2.0, 2.0), (-1.0, -1.0, -1.0)


class Picture(NamedTuple):
    """The texture of an input, and the primvar that has its coordinates; a constant has none."""

    value: Value
    uv: str | None


class Textures:
    """The textures of a stage.

    Parameters
    ----------
    reading : Reading
        The stage.
    """

    def __init__(self, reading: Reading) -> None:
        self._reading = reading

    def normal(self, link: Link) -> Picture | None:
        """Return a normal map, from 0 to 1; None if it cannot be read, which is noted."""
        node = link.node
        if (array := self._array(node)) is None:
            return None
        transform, uv = self._placed(node)
        given = node.is_given("scale") or node.is_given("bias")
        scale, bias = _four(node, "scale", 1.0)[:3], _four(node, "bias", 0.0)[:3]
        if (
            (scale, bias) == (_HALVED, _LOWERED)
            or array.shape[2] < 3
            or not (given or array.dtype.kind == "f")
        ):
            # Decoded as usual. Integers cannot store -1 to 1, so that is the default for them.
            return Picture(self._image(node, array, True, None, transform), uv)
        values = _decoded(array[..., :3], True, None) * scale + bias
        stored = (0.5 + 0.5 * values).clip(0, 1).astype(np.float32)
        return Picture(self._image(node, stored, True, None, transform, ("normal", scale, bias)), uv)

    def read(self, link: Link, number: bool, limit: float | None, threshold: float = 0.0) -> Picture:
        """Return a texture, or a constant where its picture cannot be read.

        Parameters
        ----------
        link : Link
            A UsdUVTexture, and which of its outputs counts.
        number : bool
            True for a single number.
        limit : float, optional
            Its maximum; the minimum is 0.
        threshold : float
            Numbers that are below it become 0, and others 1, if it is above 0.
        """
        node, output = link
        channel = output if number and output in ("r", "g", "b", "a") else None
        place = None if channel is None else "rgba".index(channel)
        scale, bias = (
            _picked(_four(node, name, default), place) for name, default in (("scale", 1.0), ("bias", 0.0))
        )
        bounds = 0.0, np.inf if limit is None else limit
        array = self._array(node)
        if array is None:
            return _constant(_picked(_four(node, "fallback", _BLACK), place), bounds, threshold)
        if channel == "a" and array.shape[2] not in (2, 4):
            return _constant([a + b for a, b in zip(scale, bias, strict=True)], bounds, threshold)
        if channel in ("r", "g", "b") and array.shape[2] < 3:
            array, channel = array[..., :1], None
        space = str(node.value("sourceColorSpace", "auto"))
        # By default, pictures of 8 bits with three channels or four are sRGB.
        plain = number or array.shape[2] < 3 or array.dtype != np.uint8
        linear = space == "raw" or (space != "sRGB" and plain)
        transform, uv = self._placed(node)
        how = linear, channel, scale, bias
        made: Texture
        if threshold > 0:
            kept = _decoded(array, linear, channel) * scale[0] + bias[0] >= threshold
            cut = kept.astype(np.uint8) * np.uint8(255)
            return Picture(self._image(node, cut, True, None, transform, (*how, "cut", threshold)), uv)
        if channel is None:
            array = array[..., : 3 if array.shape[2] > 2 else 1]
        made = _scaled(self._image(node, array, linear, channel, transform), scale, bias)
        low, high = ends(made)
        if min(low) < bounds[0] or max(high) > bounds[1]:
            values = (_decoded(array, linear, channel) * scale + bias).clip(*bounds).astype(np.float32)
            made = self._image(node, values, True, None, transform, (*how, "clipped", bounds))
        return Picture(made, uv)

    def _array(self, node: Node) -> NDArray[Any] | None:
        """Return the picture of a node; None if it cannot be read and there is a fallback, which is noted."""
        file = node.value("file")
        if not file or not file.path:
            self._reading.notes.tell("textures without a file are shown by their fallback")
            return None
        asset = self._tile(file)
        try:
            return self._reading.pictures.read(asset)
        except FileNotFoundError:
            if node.value("fallback") is None:
                raise
            self._reading.notes.tell(f"there is no picture {file.path}: its fallback is shown")
            return None

    def _tile(self, file: Any) -> Any:
        """Return the first of the tiles of a picture, or the picture itself."""
        from pxr import Sdf, UsdShade

        name = str(file.resolvedPath or file.path)
        if "<UDIM>" not in name:
            return file
        tiles = UsdShade.UdimUtils.ResolveUdimTilePaths(name, None)
        if not tiles:
            return file
        self._reading.notes.tell("of pictures in tiles (UDIM) the first is shown")
        return Sdf.AssetPath(tiles[0][0], tiles[0][0])

    def _image(
        self,
        node: Node,
        array: NDArray[Any],
        linear: bool,
        channel: Any,
        transform: UvTransform,
        how: Any = None,
    ) -> ImageTexture:
        """Return an image texture of an array; one that has been made of the same picture is shared."""
        wraps = [str(node.value(axis, "useMetadata")) for axis in ("wrapS", "wrapT")]
        if "black" in wraps:
            self._reading.notes.tell("pictures with wrap mode black are clamped at their edges")
        across, up = (_WRAPS.get(one, "clamp" if one == "black" else "repeat") for one in wraps)
        file = node.value("file")
        key = str(file.resolvedPath or file.path), array.shape[2], linear, channel, across, up, transform, how
        made = self._reading.textures.get(key)
        if made is None:
            made = ImageTexture(
                array,
                linear=linear,
                channel=channel,
                wrap=(across, up),  # type: ignore[arg-type]
                transform=transform,
            )
            self._reading.textures[key] = made
        return made

    def _placed(self, node: Node) -> tuple[UvTransform, str | None]:
        """Return where coordinates come from, and the primvar that has them; None if there is one point."""
        transform, source, name = UvTransform(), node, "st"
        for _ in range(8):
            link = source.link(name)
            if link is None:
                # A constant coordinate, by default the picture's lower left corner.
                across, up = (float(x) for x in source.value(name, (0.0, 0.0)))
                return _after(transform, UvTransform(matrix=((0, 0, across), (0, 0, up)))), None
            source, name = link.node, "in"
            if source.kind != "UsdTransform2d":
                if not source.kind.startswith("UsdPrimvarReader"):
                    kind = source.kind or "no shader"
                    self._reading.notes.tell(f"coordinates of textures by {kind} are left out")
                return transform, str(source.value("varname") or "st")
            own = UvTransform(
                tuple(source.value("scale", (1.0, 1.0))),
                float(source.value("rotation", 0.0)),
                tuple(source.value("translation", (0.0, 0.0))),
            )
            transform = _after(transform, own)
        return transform, "st"


def _after(outer: UvTransform, inner: UvTransform) -> UvTransform:
    """Return a map of coordinates that follows another."""
    if outer == UvTransform():
        return inner
    a, b = (np.vstack([one.matrix, (0, 0, 1)]) for one in (outer, inner))
    return UvTransform(matrix=(a @ b)[:2])


def _constant(given: Any, bounds: tuple[float, float], threshold: float) -> Picture:
    red, green, blue = (float(x) for x in np.clip(given, *bounds))
    if threshold > 0:
        red, green, blue = (float(x >= threshold) for x in (red, green, blue))
    return Picture((red, green, blue), None)


def _decoded(array: NDArray[Any], linear: bool, channel: str | None) -> NDArray[np.float64]:
    """Return the points of a picture as amounts of light: of one channel or of three."""
    if channel is not None:
        place = -1 if channel == "a" else "rgb".index(channel)
        array = array[..., [place]]
    if array.dtype.kind == "f":
        return array.astype(np.float64)
    shares = array / np.iinfo(array.dtype).max
    if linear or channel == "a":
        return np.asarray(shares)
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)


def _scaled(image: Texture, scale: tuple[float, ...], bias: tuple[float, ...]) -> Texture:
    if scale != (1.0, 1.0, 1.0):
        image = ProductTexture(image, scale)
    # A sum is twice a mean.
    return image if bias == (0.0, 0.0, 0.0) else ProductTexture(MixTexture(image, bias, 0.5), 2.0)


def _four(node: Node, name: str, default: float | _Four) -> tuple[float, ...]:
    found = np.broadcast_to(np.array(node.value(name, default), np.float64), 4)
    return tuple(float(x) for x in found)


def _picked(four: tuple[float, ...], place: int | None) -> tuple[float, ...]:
    return four[:3] if place is None else (four[place],) * 3
