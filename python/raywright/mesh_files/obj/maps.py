"""Pictures of material libraries, and the options of the statements that name them."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read
from ...io.quiet import reason
from ...textures import ImageTexture, UvTransform
from ...textures.image import Channel, Wrap
from ..beside import beside
from ..pbr import Picture
from .mtl import UNREADABLE, Description
from .text import told

LOST = "pictures are left out"
LEFT_OUT = "what is not shown here is left out"
# By option: least and greatest number of words after it; optional words must be numbers.
_OPTIONS = {
    **dict.fromkeys(("-blendu", "-blendv", "-cc", "-clamp", "-imfchan", "-type"), (1, 1)),
    **dict.fromkeys(("-bm", "-boost", "-texres"), (1, 1)),
    **dict.fromkeys(("-o", "-s", "-t"), (1, 3)),
    "-mm": (2, 2),
}
# Options and values without effect on a picture.
_NOTHING = {
    "-blendu": ("on",),
    "-blendv": ("on",),
    "-cc": ("off",),
    "-mm": ("0", "1"),
    "-t": ("0", "0", "0"),
    "-type": ("sphere",),
}
_CHANNELS: dict[str, Channel | None] = {"r": "r", "g": "g", "b": "b", "m": "a", "l": None}
# The greatest sensible number in an option, and the greatest radiance, which is summed in 32 bits.
_MOST = 1e6
BRIGHTEST = 1e30


class Map(NamedTuple):
    """A picture as a statement lays it on a surface.

    Attributes
    ----------
    picture : Picture
        The picture.
    channel : str, optional
        The channel that counts where a number is asked for, if the statement says which.
    multiplier : float
        Of bumps.
    textures : dict
        Textures made of the file's pictures so far: materials share them.
    """

    picture: Picture
    channel: Channel | None
    multiplier: float
    textures: dict[Any, ImageTexture]

    def texture(self, linear: bool = False, channel: Channel | None = None) -> ImageTexture:
        """Return it as a texture, of the channel that the statement names if none is asked for."""
        channel = channel or self.channel
        pixels, wrap, _, transform = self.picture
        key = id(pixels), wrap, transform, linear, channel
        if key not in self.textures:
            self.textures[key] = self.picture.texture(linear, channel)
        return self.textures[key]

    @property
    def is_of_normals(self) -> bool:
        """True if it looks like a picture of normals: mostly straight ones, (½, ½, 1)."""
        pixels = self.picture.pixels
        if pixels.shape[2] < 3:
            return False
        red, green, blue = pixels[..., :3].mean(axis=(0, 1), dtype=np.float64) / _full(pixels)
        return bool(abs(red - 0.5) < 0.15 and abs(green - 0.5) < 0.15 and blue > 0.7)

    @property
    def alpha(self) -> Channel | None:
        """The channel that tells how much is there: alpha where that differs from place to place."""
        pixels = self.picture.pixels
        if self.channel is not None or not self.picture.has_alpha:
            return self.channel
        return "a" if (pixels[..., -1] < _full(pixels)).any() else None


class Pictures:
    """Pictures beside an OBJ file, or in folders within its own, each read once.

    Parameters
    ----------
    folder : Path, optional
        The file's; None where nothing is known of any files.
    held : dict, optional
        The pixels of pictures that are there already, by the keywords of their statements.
    """

    def __init__(self, folder: Path | None, held: dict[str, NDArray[Any]] | None = None) -> None:
        self._folder = folder
        self._held = held or {}
        self._read: dict[tuple[Path, bool], NDArray[Any] | str] = {}
        self._textures: dict[Any, ImageTexture] = {}

    def of(self, said: Description, keyword: str) -> Map | None:
        """Return the picture that a statement names, None where there is none."""
        rest = said.text(keyword)
        if rest is None:
            return None
        options, name = _options(said, rest)
        held = self._held.get(keyword)
        # Only emission may be brighter than white.
        pixels = self._pixels(name, keyword == "map_Ke") if held is None else held
        if isinstance(pixels, str):
            said.note(LOST, f"{told(name)} ({pixels})")
            return None
        return self._laid(said, keyword, pixels, options)

    def _pixels(self, name: str, bright: bool) -> NDArray[Any] | str:
        """Return the pixels of a file, or why there are none; `bright`, if they may be above 1."""
        if self._folder is None:
            return "it came without its file"
        path = beside(self._folder, name)
        if path is None:
            return "it is not beside the file"
        if (path, bright) not in self._read:
            try:
                self._read[path, bright] = _checked(read(path), BRIGHTEST if bright else 1.0)
            except MemoryError:
                raise
            except Exception as error:
                # Readers raise any exception on bad bytes, with the path in its message.
                why = reason(error, 300).replace(f"{path} is not a picture that can be read ", "")
                self._read[path, bright] = why.strip("()") or "it cannot be read"
        return self._read[path, bright]

    def _laid(
        self, said: Description, keyword: str, pixels: NDArray[Any], options: dict[str, tuple[str, ...]]
    ) -> Map | None:
        scale, offset = _numbers(said, "-s", options, 1.0), _numbers(said, "-o", options, 0.0)
        wrap: Wrap = "clamp" if options.get("-clamp") == ("on",) else "repeat"
        still = (scale[:2] == 1).all() and (offset[:2] == 0).all()
        transform = None if still else UvTransform(scale[:2], offset=offset[:2])
        channel = _CHANNELS.get(options.get("-imfchan", ("l",))[0])
        if channel == "a" and pixels.shape[2] not in (2, 4):
            channel = None
        for option, words in options.items():
            usual = _NOTHING.get(option, ("",))
            if option not in ("-s", "-o", "-bm", "-clamp", "-imfchan") and words != usual[: len(words)]:
                said.note(LEFT_OUT, f"{option} of {keyword}")
        multiplier = float(_numbers(said, "-bm", options, 1.0)[0])
        laid = Picture(pixels, (wrap, wrap), "trilinear", transform)
        return Map(laid, channel, multiplier, self._textures)


def _checked(pixels: NDArray[Any], most: float) -> NDArray[Any]:
    """Return what a file holds if it can be a picture; of floats, what is not finite is black."""
    if pixels.ndim != 3 or not 1 <= pixels.shape[2] <= 4 or 0 in pixels.shape:
        raise ValueError(f"it has shape {pixels.shape}")
    if pixels.dtype.kind != "f" and pixels.dtype not in (np.uint8, np.uint16):
        raise ValueError(f"it has numbers of type {pixels.dtype}")
    if pixels.dtype.kind == "f":
        return np.asarray(np.clip(np.nan_to_num(pixels, nan=0.0, posinf=0.0, neginf=0.0), 0.0, most))
    return pixels


def _options(said: Description, rest: str) -> tuple[dict[str, tuple[str, ...]], str]:
    """Return the options of a statement, and the name of its file, which may have spaces in it."""
    words = [(match[0], match.start()) for match in re.finditer(r"\S+", rest)]
    options: dict[str, tuple[str, ...]] = {}
    at = 0
    while at < len(words) and words[at][0].lower() in _OPTIONS:
        option = words[at][0].lower()
        least, most = _OPTIONS[option]
        end = at + 1 + least
        # A file name may begin like a number, and the last word belongs to the name.
        while end < min(at + 1 + most, len(words) - 1) and _is_number(words[end][0]):
            end += 1
        options[option] = tuple(word for word, _ in words[at + 1 : end])
        at = end
    return options, rest[words[at][1] :] if at < len(words) else ""


def _numbers(
    said: Description, option: str, options: dict[str, tuple[str, ...]], usual: float
) -> NDArray[np.float64]:
    """Return three numbers of an option; those that are not there are as usual."""
    words = options.get(option, ())
    result = np.full(3, usual)
    for i, word in enumerate(words):
        if not _is_number(word) or not abs(float(word)) <= _MOST:
            said.note(UNREADABLE, told(" ".join((option, *words))))
            return np.full(3, usual)
        result[i] = float(word)
    return result


def _is_number(word: str) -> bool:
    try:
        return math.isfinite(float(word))
    except ValueError:
        return False


def _full(pixels: NDArray[Any]) -> float:
    """Return what stands for 1 in a picture."""
    return float(np.iinfo(pixels.dtype).max) if pixels.dtype.kind == "u" else 1.0
