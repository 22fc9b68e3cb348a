"""Textures, and what may be a texture or the same everywhere."""

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from ...io.pictures import read
from ...textures import Checker, ImageTexture, MixTexture, ProductTexture, UvTransform
from ...textures.texture import Number, Texture, Value, ends
from .parameters import Parameters
from .spectra import colour

_WRAPS = {"repeat": "repeat", "clamp": "clamp", "mirror": "mirror", "octahedralsphere": "clamp"}


class Textures:
    """The textures of a scene by name: of colours, and of numbers.

    Parameters
    ----------
    folder : Path
        Where files are looked for.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._colours: dict[str, Value] = {}
        self._numbers: dict[str, Number] = {}

    def add(self, name: str, of: str, kind: str, parameters: Parameters) -> None:
        """Keep a texture.

        Raises
        ------
        ValueError
            If its type, or a parameter of it, is not supported; tells which.
        """
        if of not in ("spectrum", "float"):
            parameters.fail(f"a texture must be of spectrum or float, got {of!r}")
        made = self._made(kind, of == "spectrum", parameters)
        if of == "spectrum":
            self._colours[name] = made
        else:
            self._numbers[name] = made if isinstance(made, Texture) else made[0]
        parameters.done()

    def value(self, parameters: Parameters, name: str, default: float | tuple[float, float, float]) -> Value:
        """Return a parameter that is a colour or a texture of colours."""
        found = parameters.given.get(name)
        if found is not None and found[0] == "texture":
            key = parameters.text(name)
            if key not in self._colours:
                parameters.fail(f"{name}: there is no texture of colours {key!r}")
            return self._colours[key]
        return colour(parameters, name, default)

    def number(self, parameters: Parameters, name: str, default: float) -> Number:
        """Return a parameter that is a number or a texture of numbers."""
        found = parameters.given.get(name)
        if found is not None and found[0] == "texture":
            key = parameters.text(name)
            if key not in self._numbers:
                parameters.fail(f"{name}: there is no texture of numbers {key!r}")
            return self._numbers[key]
        return parameters.number(name, default)

    def _made(self, kind: str, coloured: bool, parameters: Parameters) -> Value:
        def part(name: str, default: float) -> Value:
            if coloured:
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
            place = _placed(parameters)
            # Two cells of it are one unit here.
            halved = UvTransform(matrix=0.5 * np.array(place.matrix))
            return Checker(part("tex1", 1.0), part("tex2", 0.0), halved)
        if kind == "imagemap":
            return self._picture(coloured, parameters)
        parameters.fail(f"a texture {kind!r} is not supported")

    def _picture(self, coloured: bool, parameters: Parameters) -> Value:
        path = self.folder / parameters.text("filename")
        array = read(path)
        encoding = parameters.text("encoding", "sRGB")
        wrap = _WRAPS.get(parameters.text("wrap", "repeat"))
        if wrap is None:
            parameters.fail("wrap must be repeat, clamp or mirror")
        nearest = parameters.text("filter", "bilinear") == "point"
        parameters.ignore("maxanisotropy")
        if parameters.switch("invert", False):
            if array.dtype.kind == "u":
                shares = array[..., : 3 if array.shape[2] > 2 else 1] / np.iinfo(array.dtype).max
                linear = shares if encoding == "linear" else _decoded(shares)
                array = (1 - linear).astype(np.float32)
            else:
                array = 1 - array
        made = ImageTexture(
            array[..., : 3 if array.shape[2] > 2 else 1],
            linear=encoding == "linear",
            filter="nearest" if nearest else "trilinear",
            wrap=wrap,  # type: ignore[arg-type]
            transform=_placed(parameters),
        )
        scale = parameters.number("scale", 1.0)
        return _scaled(made, (scale,) * 3)


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
        warnings.warn(f"{name} is up to {most:.3g}, and is made darker by that", RuntimeWarning, stacklevel=2)
        return ProductTexture(given, 1 / most)
    red, green, blue = (min(x, 1.0) for x in given)
    return red, green, blue


def _decoded(shares: Any) -> Any:
    return np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
