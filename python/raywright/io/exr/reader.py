"""EXR files as arrays."""

import os
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .codecs import Block
from .header import Channel, Chunk, find_chunks, read_header
from .methods import unpack
from .threads import each


def read_exr(path: Path, choose: Callable[[list[str]], Sequence[str]]) -> NDArray[np.float32]:
    """Read channels of the first part that is not deep, rows from the top; of tiles, the largest level.

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
        If the file is cut short or broken, or has deep pixels, channels of fewer points than the picture,
        more than `header.MOST_POINTS` points, or a compression after DWAB (HTJ2K).
    """
    with path.open("rb") as file:
        size = os.fstat(file.fileno()).st_size
        part, table, numbered = read_header(file, size)
        by_name: dict[str, Channel] = {}
        for channel in part.channels:
            by_name.setdefault(channel.name, channel)
        wanted = [by_name[name] for name in choose(list(by_name))]
        file.seek(0)
        data = file.read()
    chunks = find_chunks(data, part, table, numbered)
    pixels = np.empty((part.height, part.width, len(wanted)), np.float32)

    def place_chunk(item: tuple[int, Chunk]) -> None:
        number, chunk = item
        packed = data[chunk.start : chunk.start + chunk.length]
        try:
            found = unpack(packed, Block(part, chunk.width, chunk.rows), wanted)
        except ValueError as error:
            raise ValueError(f"chunk {number} is broken: {error}") from error
        place = pixels[chunk.y : chunk.y + chunk.rows, chunk.x : chunk.x + chunk.width]
        # A NaN of any bits is a NaN.
        with np.errstate(invalid="ignore"):
            for k, plane in enumerate(found):
                place[..., k] = plane

    for _ in each(place_chunk, list(enumerate(chunks)), part.width * part.height * part.pixel_bytes):
        pass
    return pixels
