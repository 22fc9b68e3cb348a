"""Headers of EXR files and the tables of their chunks, checked before pixels are allocated."""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import BinaryIO, NamedTuple

import numpy as np
from numpy.typing import NDArray

MAGIC = b"v/1\x01"
TILED, LONG_NAMES, DEEP, PARTS = 0x200, 0x400, 0x800, 0x1000
# 16384 x 8192.
MOST_POINTS = 2**27
_MOST_HEADER = 2**24
_MOST_CHANNELS = 2**14
_MOST_SAMPLING = 64
# By the number of the compression: rows in a chunk, and a bound on the bytes that one packed byte expands to.
# Deflate expands 2 bits to 258 bytes (1032), and PXR24 omits one byte of four before it. A run of RLE is 128
# bytes in 2, a run of PIZ 255 words in 9 bits, a flat block of B44 32 bytes in 3. DWA deflates runs, and
# blocks of up to 256 bytes that take 4.
_ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_MOST_RATIO = (1, 64, 1032, 1032, 464, 1376, 11, 11, 2**17, 2**17)


class Channel(NamedTuple):
    """A channel of unsigned integers (0), half (1) or float (2).

    Attributes
    ----------
    name : str
    kind : int
    is_perceptual : bool
    start : int
        The bytes of a pixel before it, where all channels have all pixels.
    sampling : 2 ints
        It has the pixels of every such column and row.
    """

    name: str
    kind: int
    is_perceptual: bool
    start: int
    sampling: tuple[int, int] = (1, 1)

    @property
    def dtype(self) -> np.dtype[np.generic]:
        """The type of its samples in the file."""
        return np.dtype(("<u4", "<f2", "<f4")[self.kind])


class Part(NamedTuple):
    """A picture of the file: its size and channels, and how its pixels are cut into chunks.

    Attributes
    ----------
    number : int
    width, height, left, top : int
        The window of its pixels.
    shown : 4 ints
        Left, top, right and bottom of the window that is the picture, black where it has no pixels.
    chromaticities : 8 floats, optional
        x and y of red, green, blue and white, if the file has them.
    """

    number: int
    width: int
    height: int
    left: int
    top: int
    shown: tuple[int, int, int, int]
    chromaticities: tuple[float, ...] | None
    compression: int
    tile: tuple[int, int] | None
    channels: tuple[Channel, ...]

    @property
    def pixel_bytes(self) -> int:
        """Bytes of all channels of a pixel."""
        return self.channels[-1].start + self.channels[-1].dtype.itemsize

    @property
    def is_whole(self) -> bool:
        """True if all channels have all pixels."""
        return all(channel.sampling == (1, 1) for channel in self.channels)

    @property
    def block(self) -> tuple[int, int]:
        """Width and rows of a chunk."""
        return self.tile or (self.width, _ROWS[self.compression])


class Chunk(NamedTuple):
    """A chunk: its packed bytes in the file, and the pixels that they hold."""

    start: int
    length: int
    x: int
    y: int
    width: int
    rows: int


def read_header(file: BinaryIO, size: int) -> tuple[Part, int, bool]:
    """Return the first part that is not deep, the start of its table, and whether chunks name their part.

    Raises
    ------
    ValueError
        If the header is broken, or announces unsupported features.
    """
    magic, flags = struct.unpack("<4sI", _exactly(file, 8))
    if magic != MAGIC:
        raise ValueError("it is not an EXR file")
    numbered = bool(flags & PARTS)
    headers = [_attributes(file)]
    while numbered and (more := _attributes(file)):
        headers.append(more)
    table = file.tell()
    for number, found in enumerate(headers):
        kind = found.get(b"type", b"")
        if not kind.startswith(b"deep") and not (flags & DEEP and not numbered):
            tiled = kind == b"tiledimage" if numbered else bool(flags & TILED)
            return _part(number, found, tiled), table, numbered
        count = found.get(b"chunkCount", b"")
        if len(count) != 4:
            break
        table += 8 * int.from_bytes(count, "little")
        if table > size:
            raise ValueError(f"it is cut short: its table of chunks begins at byte {table} of {size}")
    raise ValueError("it has deep pixels, which are not supported")


def find_chunks(data: bytes, part: Part, table: int, numbered: bool) -> list[Chunk]:
    """Find every chunk of the largest level, each pixel in exactly one of them.

    Raises
    ------
    ValueError
        If the file is cut short, or a chunk is missing, given twice, or too short for its pixels.
    """
    size = len(data)
    width, rows = part.block
    across, down = -(-part.width // width), -(-part.height // rows)
    count = across * down
    if size - table < 8 * count:
        raise ValueError(f"it is cut short: it has {count} chunks by its header, in {size} bytes")
    starts = np.frombuffer(data, "<u8", count, table)
    # Number of the part, then row, or column and row of a tile and its level, then length.
    fields = numbered + (5 if part.tile else 2)
    _refuse(
        starts > max(size - 4 * fields, 0),
        lambda n: f"it is cut short: chunk {n} begins at byte {starts[n]} of {size}",
    )
    at = starts.astype(np.int64)
    octets = np.frombuffer(data, np.uint8)
    read = [octets[(at + 4 * k)[:, np.newaxis] + np.arange(4)].view("<i4")[:, 0] for k in range(fields)]
    length = read[-1].astype(np.int64)
    begin = at + 4 * fields
    broken = (length < 1) | (begin + length > size)
    _refuse(broken, lambda n: f"it is cut short or broken: chunk {n} does not end within it")
    if part.tile:
        column, row = (one.astype(np.int64) for one in read[numbered : numbered + 2])
        misplaced = (read[-3] != 0) | (read[-2] != 0) | (column < 0) | (column >= across)
    else:
        offset = read[numbered].astype(np.int64) - part.top
        column, row, misplaced = np.zeros_like(offset), offset // rows, offset % rows != 0
    misplaced |= (row < 0) | (row >= down)
    if numbered:
        misplaced |= read[0] != part.number
    places = row * across + column
    is_first = np.zeros(count, bool)
    is_first[np.unique(places, return_index=True)[1]] = True
    _refuse(misplaced | ~is_first, lambda n: f"it is broken: chunk {n} is in no place of its own")
    x, y = column * width, row * rows
    widths, heights = np.minimum(width, part.width - x), np.minimum(rows, part.height - y)
    # As floats: sizes of a hostile header may exceed 64 bits. A subsampled channel may have one sample for
    # four pixels.
    fewest = 1.0 if part.is_whole else 1 / max(a * b for a, b in (c.sampling for c in part.channels))
    _refuse(
        widths * heights * float(part.pixel_bytes) * fewest > length * float(_MOST_RATIO[part.compression]),
        lambda n: f"it is cut short or broken: chunk {n} has {length[n]} bytes, too few for its points",
    )
    columns = (one.tolist() for one in (begin, length, x, y, widths, heights))
    return [Chunk(*one) for one in zip(*columns, strict=True)]


def _refuse(broken: NDArray[np.bool_], message: Callable[[int], str]) -> None:
    if broken.any():
        raise ValueError(message(int(broken.argmax())))


def _part(number: int, found: dict[bytes, bytes], tiled: bool) -> Part:
    window, compression = found.get(b"dataWindow", b""), found.get(b"compression", b"")
    if len(window) != 16 or len(compression) != 1:
        raise ValueError("its header has no size")
    left, top, right, bottom = struct.unpack("<4i", window)
    width, height = right - left + 1, bottom - top + 1
    if width < 1 or height < 1:
        raise ValueError(f"it has {width} x {height} points by its header")
    if width * height > MOST_POINTS:
        raise ValueError(f"it has {width} x {height} points by its header, and {MOST_POINTS} are read")
    if compression[0] >= len(_ROWS):
        raise ValueError(f"its compression is number {compression[0]}, and 0 to {len(_ROWS) - 1} are read")
    tile = None
    if tiled:
        tiles = found.get(b"tiles", b"")
        tile = struct.unpack("<2I", tiles[:8]) if len(tiles) == 9 else (0, 0)
        if min(tile) < 1:
            raise ValueError("its header has no tile size")
        tile = (min(tile[0], width), min(tile[1], height))
    channels = _channels(found.get(b"channels", b""))
    for channel in channels:
        across, down = channel.sampling
        if tiled and channel.sampling != (1, 1):
            raise ValueError(f"its channel {channel.name} is subsampled, which is not supported with tiles")
        if left % across or top % down or width % across or height % down:
            raise ValueError(
                f"its channel {channel.name} is subsampled by {across} x {down}, "
                "which does not divide its window"
            )
    shown, colors = _shown(found, (left, top, right, bottom)), _chromaticities(found)
    return Part(number, width, height, left, top, shown, colors, compression[0], tile, channels)


def _shown(found: dict[bytes, bytes], data: tuple[int, int, int, int]) -> tuple[int, int, int, int]:
    """Return the window of the picture, that of its pixels if it has none."""
    window = found.get(b"displayWindow", b"")
    if len(window) != 16:
        return data
    left, top, right, bottom = struct.unpack("<4i", window)
    width, height = right - left + 1, bottom - top + 1
    if width < 1 or height < 1:
        return data
    if width * height > MOST_POINTS:
        raise ValueError(f"it has {width} x {height} points by its header, and {MOST_POINTS} are read")
    return left, top, right, bottom


def _chromaticities(found: dict[bytes, bytes]) -> tuple[float, ...] | None:
    told = found.get(b"chromaticities", b"")
    return struct.unpack("<8f", told) if len(told) == 32 else None


def _channels(data: bytes) -> tuple[Channel, ...]:
    found: list[Channel] = []
    at = start = 0
    while data[at : at + 1] not in (b"", b"\0"):
        end = data.find(b"\0", at)
        if end < 0 or end + 17 > len(data):
            raise ValueError("its header is broken")
        if len(found) == _MOST_CHANNELS:
            raise ValueError(f"it has more than {_MOST_CHANNELS} channels")
        name = data[at:end].decode("utf-8", "replace")
        kind, is_perceptual, *sampling = struct.unpack_from("<iB3x2i", data, end + 1)
        if not 0 <= kind <= 2:
            raise ValueError(f"its channel {name} has an unknown type")
        if not 1 <= min(sampling) <= max(sampling) <= _MOST_SAMPLING:
            raise ValueError(f"its channel {name} is subsampled by {sampling[0]} x {sampling[1]}")
        found.append(Channel(name, kind, bool(is_perceptual), start, (sampling[0], sampling[1])))
        start += found[-1].dtype.itemsize
        at = end + 17
    if not found:
        raise ValueError("it has no channels")
    return tuple(found)


def _attributes(file: BinaryIO) -> dict[bytes, bytes]:
    """Read the attributes of a header, up to the byte after its end."""
    found: dict[bytes, bytes] = {}
    while name := _name(file):
        _name(file)
        (length,) = struct.unpack("<i", _exactly(file, 4))
        if not 0 <= length <= _MOST_HEADER or file.tell() > _MOST_HEADER:
            raise ValueError("its header is broken")
        found[name] = _exactly(file, length)
    return found


def _name(file: BinaryIO) -> bytes:
    found = b""
    while (byte := _exactly(file, 1)) != b"\0":
        found += byte
        if len(found) > 255:
            raise ValueError("its header is broken")
    return found


def _exactly(file: BinaryIO, count: int) -> bytes:
    data = file.read(count)
    if len(data) != count:
        raise ValueError("it is cut short within its header")
    return data
