"""Textures, and values that may be textures or constants."""

from __future__ import annotations

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read
from ...textures import Checker, ImageTexture, MixTexture, ProductTexture, UvTransform
from ...textures.texture import Number, Texture, Value, ends
from .parameters import Parameters
from .spectra import color

_WRAPS = {"repeat": "repeat", "clamp": "clamp", "mirror": "mirror", "octahedralsphere": "clamp"}
_FILTERS = ("point", "bilinear", "trilinear", "ewa")
# Formats with linear values, where no encoding applies.
_LINEAR = (".exr", ".hdr", ".pfm", ".npy")


class Textures:
    """The textures of a scene by name: of colors, and of numbers.

    Parameters
    ----------
    folder : Path
        Folder of files.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._colors: dict[str, Value] = {}
        self._numbers: dict[str, Number] = {}

    def add(self, name: str, of: str, kind: str, parameters: Parameters) -> None:
        """Keep a texture.

        Raises
        ------
        ValueError
            If its type, or a parameter of it, is not supported; the error names it.
        """
        if of not in ("spectrum", "float"):
            parameters.fail(f"a texture must be of spectrum or float, got {of!r}")
        made = self._made(kind, of == "spectrum", parameters)
        if of == "spectrum":
            self._colors[name] = made
        else:
            self._numbers[name] = made if isinstance(made, Texture) else made[0]
        parameters.done()

    def value(self, parameters: Parameters, name: str, default: float | tuple[float, float, float]) -> Value:
        """Return a parameter that is a color or a texture of colors."""
        found = parameters.given.get(name)
        if found is not None and found[0] == "texture":
            key = parameters.text(name)
            if key not in self._colors:
                parameters.fail(f"{name}: there is no texture of colors {key!r}")
            return self._colors[key]
        return color(parameters, name, default)

    def number(self, parameters: Parameters, name: str, default: float) -> Number:
        """Return a parameter that is a number or a texture of numbers."""
        found = parameters.given.get(name)
        if found is not None and found[0] == "texture":
            key = parameters.text(name)
            if key not in self._numbers:
                parameters.fail(f"{name}: there is no texture of numbers {key!r}")
            return self._numbers[key]
        return parameters.number(name, default)

    def _made(self, kind: str, colored: bool, parameters: Parameters) -> Value:
        def part(name: str, default: float) -> Value:
            if colored:
                return self.value(parameters, name, default)
            number = self.number(parameters, name, default)
            return number if isinstance(number, Texture) else (number,) * 3

        if kind == "constant":
            return part("value", 1.0)
        if kind == "scale":
            share = self.number(parameters, "scale", 1.0)
            return _scaled(part("tex", 1.0), share if isinstance(share, Texture) else (share,) * 3)
        if kind == "mix":
            amount = self.number(parameters, "amount", 0.5)
            return MixTexture(part("tex1", 0.0), part("tex2", 1.0), amount)
        if kind == "checkerboard":
            if parameters.integer("dimension", 2) != 2:
                parameters.fail("a checkerboard must have 2 dimensions")
            return Checker(part("tex1", 1.0), part("tex2", 0.0), _placed(parameters))
        if kind == "imagemap":
            return self._picture(colored, parameters)
        parameters.fail(f"a texture {kind!r} is not supported")

    def _picture(self, colored: bool, parameters: Parameters) -> Value:
        path = self.folder / parameters.text("filename")
        wrap = _WRAPS.get(parameters.text("wrap", "repeat"))
        if wrap is None:
            parameters.fail("wrap must be repeat, clamp or mirror")
        filtered = parameters.text("filter", "bilinear")
        if filtered.lower() not in _FILTERS:
            parameters.fail(f"filter must be one of {', '.join(_FILTERS)}, got {filtered!r}")
        parameters.ignore("maxanisotropy")
        scale, inverted = parameters.number("scale", 1.0), parameters.switch("invert", False)
        texels, linear = image_map(read(path), self._gamma(path, parameters), colored)
        if inverted:
            # The scale applies before inversion, and negative results become 0.
            decoded = texels if texels.dtype.kind == "f" else decode(texels, 1.0 if linear else None)
            texels = np.maximum(1 - scale * decoded, 0.0).astype(np.float32)
        made = ImageTexture(
            texels,
            linear=linear,
            filter="nearest" if filtered == "point" else "trilinear",
            wrap=wrap,  # type: ignore[arg-type]
            transform=_placed(parameters),
        )
        return made if inverted else _scaled(made, (scale,) * 3)

    def _gamma(self, path: Path, parameters: Parameters) -> float | None:
        """Return the decoding exponent of a picture's integers; None if they are sRGB."""
        encoding = parameters.text("encoding", "sRGB")
        if encoding == "sRGB":
            return None
        if encoding == "linear":
            gamma = 1.0
        else:
            word, _, value = encoding.strip().partition(" ")
            try:
                gamma = float(value) if word == "gamma" else math.nan
            except ValueError:
                gamma = math.nan
            if not 0 < gamma < math.inf:
                parameters.fail(f"encoding must be sRGB, linear or gamma and a number, got {encoding!r}")
        if path.suffix.lower() != ".png" and path.suffix.lower() not in _LINEAR:
            parameters.notes.tell(
                f"the encoding of {path.name} is taken as sRGB: pbrt decodes PNG alone by it"
            )
            return None
        return gamma


def image_map(picture: NDArray[Any], gamma: float | None, colored: bool) -> tuple[NDArray[Any], bool]:
    """Return the texels of a picture, of one channel or of three, and whether their integers are linear.

    Parameters
    ----------
    picture : (H, W, C) array
        The picture.
    gamma : float, optional
        Decoding exponent of integers; sRGB if not given.
    colored : bool
        True if its colors count. If not, its alpha does where it has one that is not 1 everywhere, and the
        mean of its colors elsewhere.
    """
    channels = picture.shape[2]
    if colored or channels == 1:
        texels = picture[..., : 3 if channels > 2 else 1]
    elif channels == 4 and (picture[..., 3] != _one(picture.dtype)).any():
        # pbrt decodes alpha like the colors, too.
        texels = picture[..., 3:]
    else:
        texels = picture[..., : 3 if channels > 2 else 1]
        if (texels == texels[..., :1]).all():
            texels = texels[..., :1]
        else:
            texels = decode(texels, gamma).mean(axis=2, keepdims=True).astype(np.float32)
    if texels.dtype.kind == "u" and gamma not in (None, 1.0):
        texels = decode(texels, gamma).astype(np.float32)
    return texels, gamma is not None


def decode(texels: NDArray[Any], gamma: float | None) -> NDArray[Any]:
    """Return integers as amounts of light: by an exponent, or from sRGB. Floats stay as they are."""
    if texels.dtype.kind != "u":
        return texels
    shares = texels / np.iinfo(texels.dtype).max
    return _from_srgb(shares) if gamma is None else shares**gamma


def _one(dtype: Any) -> float:
    return 1.0 if dtype.kind == "f" else float(np.iinfo(dtype).max)


def _placed(parameters: Parameters) -> UvTransform:
    if parameters.text("mapping", "uv") != "uv":
        parameters.fail("mapping must be uv")
    scale = [parameters.number(name, 1.0) for name in ("uscale", "vscale")]
    shift = [parameters.number(name, 0.0) for name in ("udelta", "vdelta")]
    return UvTransform(scale, offset=shift)


def _scaled(given: Value, share: Value) -> Value:
    if share == (1.0, 1.0, 1.0):
        return given
    if not isinstance(given, Texture) and not isinstance(share, Texture):
        red, green, blue = (a * b for a, b in zip(given, share, strict=True))
        return red, green, blue
    return ProductTexture(given, share)


def bounded(given: Value, name: str) -> Value:
    """Return a share of light that is nowhere more than 1, as pbrt cuts it; tells that it is."""
    if max(ends(given)[1]) <= 1:
        return given
    if isinstance(given, Texture):
        most = max(ends(given)[1])
        warnings.warn(
            f"{name} has values up to {most:.3g}, and is scaled to at most 1", RuntimeWarning, stacklevel=2
        )
        return ProductTexture(given, 1 / most)
    red, green, blue = (min(x, 1.0) for x in given)
    return red, green, blue


def _from_srgb(shares: Any) -> Any:
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
