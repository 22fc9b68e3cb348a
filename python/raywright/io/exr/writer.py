"""Arrays as EXR files: one part of scan lines, packed by ZIP."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .codecs import deflate
from .header import LONG_NAMES, MAGIC
from .threads import each

# ZIP compression: its number, and the rows in a chunk.
_ZIP, _ROWS = 3, 16


def write_exr(path: Path, channels: Mapping[str, NDArray[Any]], attributes: Mapping[str, str]) -> None:
    """Write channels as 32-bit floats, those of integers as 32-bit integers without a sign.

    Parameters
    ----------
    path : Path
        The file.
    channels : mapping of str to (H, W) array
        Contents of each channel, rows from the top.
    attributes : mapping of str to str
        Other attributes of the header.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    # Readers expect channels in the order of their names.
    ordered = {name: channels[name] for name in sorted(channels, key=str.encode)}
    height, width = next(iter(ordered.values())).shape
    packed_as = [np.dtype("<f4" if array.dtype.kind == "f" else "<u4") for array in ordered.values()]

    def pack(row: int) -> bytes:
        rows = [
            np.ascontiguousarray(array[row : row + _ROWS], dtype).view(np.uint8)
            for array, dtype in zip(ordered.values(), packed_as, strict=True)
        ]
        return deflate(np.concatenate(rows, axis=1).ravel())

    firsts = range(0, height, _ROWS)
    starts = []
    with path.open("wb") as file:
        kinds = {name: 2 if dtype.kind == "f" else 0 for name, dtype in zip(ordered, packed_as, strict=True)}
        file.write(_header(width, height, kinds, attributes))
        table = file.tell()
        file.write(bytes(8 * len(firsts)))
        packed = each(pack, firsts, 4 * width * height * len(ordered))
        for row, chunk in zip(firsts, packed, strict=True):
            starts.append(file.tell())
            file.write(struct.pack("<ii", row, len(chunk)) + chunk)
        file.seek(table)
        file.write(struct.pack(f"<{len(starts)}Q", *starts))


def _header(width: int, height: int, kinds: Mapping[str, int], attributes: Mapping[str, str]) -> bytes:
    listed = b"".join(
        name.encode() + b"\0" + struct.pack("<iB3x2i", kind, 0, 1, 1) for name, kind in kinds.items()
    )
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    found = {
        "channels": ("chlist", listed + b"\0"),
        "compression": ("compression", bytes([_ZIP])),
        "dataWindow": ("box2i", window),
        "displayWindow": ("box2i", window),
        "lineOrder": ("lineOrder", b"\0"),
        "pixelAspectRatio": ("float", struct.pack("<f", 1)),
        "screenWindowCenter": ("v2f", struct.pack("<2f", 0, 0)),
        "screenWindowWidth": ("float", struct.pack("<f", 1)),
        "type": ("string", b"scanlineimage"),
        **{name: ("string", told.encode()) for name, told in attributes.items()},
    }
    # A flag announces names of more than 31 bytes, up to 255.
    flags = LONG_NAMES if max(len(name.encode()) for name in (*found, *kinds)) > 31 else 0
    head = MAGIC + struct.pack("<I", 2 | flags)
    for name, (kind, value) in sorted(found.items()):
        head += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    return head + b"\0"
