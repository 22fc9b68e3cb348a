"""Pictures of a glTF file, and how its textures lay them on surfaces (glTF 2.0, 3.8)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import decode
from ...io.quiet import reason
from ...textures import UvTransform
from ...textures.image import Wrap
from ..pbr import Picture
from .document import Document
from .part import Part

_FORMATS = ("PNG", "JPEG", "WEBP")
_WRAPS: dict[int, Wrap] = {33071: "clamp", 33648: "mirror", 10497: "repeat"}
_NEAREST = 9728
# Maps v of glTF, which starts at the top, to ours, and back.
_FLIP = np.array([(1.0, 0, 0), (0, -1, 1), (0, 0, 1)])


class Pictures:
    """The textures of a document; what several of them share is decoded once."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._textures = document.root.parts("textures")
        self._images = document.root.parts("images")
        self._samplers = document.root.parts("samplers")
        self._decoded: dict[int, NDArray[Any]] = {}

    def of(self, info: Part) -> Picture | None:
        """Return the picture that a material names, None if its file is of a kind that is not read."""
        texture = self._textures[info.reference("index", "textures", len(self._textures))]
        webp = texture.extension("EXT_texture_webp")
        source = webp if webp is not None else texture
        if "source" not in source:
            self._document.tell("pictures of kinds other than PNG, JPEG and WebP are left out")
            return None
        index = source.reference("source", "images", len(self._images))
        if index not in self._decoded:
            self._decoded[index] = self._decode(self._images[index])
        sampler = self._sampler(texture)
        return Picture(
            self._decoded[index],
            (_wrap(sampler, "wrapS"), _wrap(sampler, "wrapT")),
            "nearest" if sampler.integer("magFilter", 0) == _NEAREST else "trilinear",
            _transform(info),
        )

    def _sampler(self, texture: Part) -> Part:
        if "sampler" not in texture:
            return Part({}, "sampler")
        return self._samplers[texture.reference("sampler", "samplers", len(self._samplers))]

    def _decode(self, image: Part) -> NDArray[Any]:
        if "bufferView" in image:
            data, _ = self._document.view(image)
        else:
            data = memoryview(self._document.bytes_at(image))
        try:
            return decode(bytes(data), _FORMATS)
        except Exception as error:
            # Pillow raises any exception on bad bytes.
            raise ValueError(f"{image.place} cannot be read: {reason(error)}") from error


def coordinates(info: Part) -> int:
    """Return which of a mesh's sets of texture coordinates a texture lies on."""
    transform = info.extension("KHR_texture_transform")
    if transform is not None and "texCoord" in transform:
        return transform.integer("texCoord")
    return info.integer("texCoord", 0)


def _wrap(sampler: Part, name: str) -> Wrap:
    code = sampler.integer(name, 10497)
    if code not in _WRAPS:
        raise ValueError(f"{sampler.at(name)} must be one of {', '.join(map(str, _WRAPS))}, and is {code}")
    return _WRAPS[code]


def _transform(info: Part) -> UvTransform | None:
    """Return what KHR_texture_transform says: scaled, then turned, then moved, with v downwards."""
    part = info.extension("KHR_texture_transform")
    if part is None:
        return None
    turn = part.number("rotation", 0.0)
    across, down = part.numbers("scale", 2, (1.0, 1.0))
    cos, sin = np.cos(turn), np.sin(turn)
    # Anticlockwise in the picture: the sign is reversed because v runs down.
    matrix = np.eye(3)
    matrix[:2, :2] = [(cos * across, sin * down), (-sin * across, cos * down)]
    matrix[:2, 2] = part.numbers("offset", 2, (0.0, 0.0))
    return UvTransform(matrix=(_FLIP @ matrix @ _FLIP)[:2])
