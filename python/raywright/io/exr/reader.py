"""EXR files as arrays."""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .codecs import Block
from .colors import of_luminance, to_rec_709, upsampled
from .header import Channel, Chunk, Part, find_chunks, read_header
from .methods import unpack
from .threads import each


def read_exr(path: Path, choose: Callable[[list[str]], Sequence[str]]) -> NDArray[np.float32]:
    """Read channels of the first part that is not deep, rows from the top; of tiles, the largest level.

    The picture is that of the display window, black where there are no pixels. The first three channels are
    linear colors in Rec. 709 if they are R, G and B, or Y, RY and BY, of luminance and chroma.

    Parameters
    ----------
    path : Path
        The file.
    choose : callable
        Returns the names of the channels to read, given those of all that there are.

    Returns
    -------
    (H, W, C) float32 array
        The channels, in the order of their names.

    Raises
    ------
    ValueError
        If the file is cut short or broken, or has deep pixels, more than `header.MOST_POINTS` points,
        channels of fewer points than the picture in tiles or in DWA, or a compression after DWAB (HTJ2K).
    """
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        part, table, numbered = read_header(file, size)
        by_name: dict[str, Channel] = {}
        for channel in part.channels:
            by_name.setdefault(channel.name, channel)
        names = list(choose(list(by_name)))
        wanted = [by_name[name] for name in names]
        file.seek(0)
        data = file.read()
    pixels = _shown(_pixels(data, part, find_chunks(data, part, table, numbered), wanted), part)
    if names[:3] == ["Y", "RY", "BY"]:
        pixels[..., :3] = of_luminance(pixels[..., :3], part.chromaticities)
    if names[:3] in (["Y", "RY", "BY"], ["R", "G", "B"]):
        pixels[..., :3] = to_rec_709(pixels[..., :3], part.chromaticities)
    return pixels


def _pixels(data: bytes, part: Part, chunks: list[Chunk], wanted: list[Channel]) -> NDArray[np.float32]:
    """Return all pixels of channels, (H, W, C)."""
    pixels = np.empty((part.height, part.width, len(wanted)), np.float32)
    # A subsampled channel has fewer samples than the picture has pixels.
    planes = [
        pixels[..., k]
        if channel.sampling == (1, 1)
        else np.empty((part.height // channel.sampling[1], part.width // channel.sampling[0]), np.float32)
        for k, channel in enumerate(wanted)
    ]

    def place_chunk(item: tuple[int, Chunk]) -> None:
        number, chunk = item
        packed = data[chunk.start : chunk.start + chunk.length]
        try:
            found = unpack(packed, Block(part, chunk.width, chunk.rows, part.top + chunk.y), wanted)
        except ValueError as error:
            raise ValueError(f"chunk {number} is broken: {error}") from error
        # Signalling NaNs raise no warning.
        with np.errstate(invalid="ignore"):
            for channel, plane, own in zip(wanted, planes, found, strict=True):
                across, down = channel.sampling
                y, x = -(-chunk.y // down), chunk.x // across
                plane[y : y + own.shape[0], x : x + own.shape[1]] = own

    for _ in each(place_chunk, list(enumerate(chunks)), part.width * part.height * part.pixel_bytes):
        pass
    for k, (channel, plane) in enumerate(zip(wanted, planes, strict=True)):
        if channel.sampling != (1, 1):
            pixels[..., k] = upsampled(plane, *channel.sampling)
    return pixels


def _shown(pixels: NDArray[np.float32], part: Part) -> NDArray[np.float32]:
    """Return the part of all pixels within the display window."""
    left, top, right, bottom = part.shown
    if (left, top, right - left + 1, bottom - top + 1) == (part.left, part.top, part.width, part.height):
        return pixels
    shown = np.zeros((bottom - top + 1, right - left + 1, pixels.shape[2]), np.float32)
    x, y = max(left, part.left), max(top, part.top)
    own = pixels[y - part.top : bottom + 1 - part.top, x - part.left : right + 1 - part.left]
    if own.size and y <= bottom and x <= right:
        shown[y - top : y - top + own.shape[0], x - left : x - left + own.shape[1]] = own
    return shown
