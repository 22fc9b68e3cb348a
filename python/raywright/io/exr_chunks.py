"""Whether an EXR file holds all that its header promises, found out before anything is made of it."""

import struct
from pathlib import Path
from typing import BinaryIO, NamedTuple

# 16384 x 8192.
MOST_POINTS = 2**27

_MAGIC = b"v/1\x01"
# Files of tiles, of depths, or of several parts, by a flag each.
_OTHER = 0x200 | 0x800 | 0x1000
# Rows in a chunk, by the number of the compression.
_ROWS = (1, 1, 1, 16, 32, 16, 32, 32, 32, 256)
_MOST_HEADER = 2**24


class _Header(NamedTuple):
    width: int
    height: int
    first_row: int
    compression: int


def check_exr(path: Path) -> None:
    """Refuse a file that is cut short, or too large by its header.

    Of files in tiles or in several parts it is the size that is checked; the library does the rest.

    Raises
    ------
    ValueError
        If it is.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        magic, flags = struct.unpack("<4sI", _exactly(file, 8))
        if magic != _MAGIC:
            raise ValueError("it is no EXR file")
        header = _header(file)
        if header.width < 1 or header.height < 1:
            raise ValueError(f"it has {header.width} x {header.height} points by its header")
        if header.width * header.height > MOST_POINTS:
            raise ValueError(
                f"it has {header.width} x {header.height} points by its header, and {MOST_POINTS} are read"
            )
        if flags & _OTHER or header.compression >= len(_ROWS):
            return
        rows = _ROWS[header.compression]
        count = -(-header.height // rows)
        if size - file.tell() < 8 * count:
            raise ValueError(f"it is cut short: it has {count} chunks by its header, in {size} bytes")
        for number, start in enumerate(struct.unpack(f"<{count}Q", file.read(8 * count))):
            if start + 8 > size:
                raise ValueError(f"it is cut short: chunk {number} begins at byte {start} of {size}")
            file.seek(start)
            row, length = struct.unpack("<ii", _exactly(file, 8))
            if not 0 <= row - header.first_row < header.height or length < 1 or start + 8 + length > size:
                raise ValueError(f"it is cut short or broken: chunk {number} does not end within it")


def _header(file: BinaryIO) -> _Header:
    """Read the attributes of the first header, up to the byte after its end."""
    found: dict[bytes, bytes] = {}
    while name := _name(file):
        _name(file)
        (length,) = struct.unpack("<i", _exactly(file, 4))
        if not 0 <= length <= _MOST_HEADER or file.tell() > _MOST_HEADER:
            raise ValueError("its header is broken")
        found[name] = _exactly(file, length)
    window, compression = found.get(b"dataWindow", b""), found.get(b"compression", b"")
    if len(window) != 16 or len(compression) != 1:
        raise ValueError("its header has no size")
    left, top, right, bottom = struct.unpack("<4i", window)
    return _Header(right - left + 1, bottom - top + 1, top, compression[0])


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
