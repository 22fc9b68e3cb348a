"""EXR files for tests: written by OpenEXR, or put together byte by byte."""

import struct

import numpy as np
import OpenEXR

MAGIC = b"v/1\x01"


def write(path, channels, method="ZIP", tile=None, **header):
    """Write channels, arrays or `OpenEXR.Channel`, by OpenEXR."""
    header |= {"compression": getattr(OpenEXR, f"{method}_COMPRESSION"), "type": OpenEXR.scanlineimage}
    if tile is not None:
        header["type"] = OpenEXR.tiledimage
        header["tiles"] = OpenEXR.TileDescription()
        header["tiles"].xSize, header["tiles"].ySize = tile
        header["tiles"].mode = OpenEXR.ONE_LEVEL
    # OpenEXR adds its own channels to the dictionary.
    with OpenEXR.File(header, dict(channels)) as file:
        file.write(str(path))


def stored(path, names, part=0):
    """What OpenEXR reads of some channels, (H, W, C) float32."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = file.parts[part].channels
        return np.stack([channels[name].pixels.astype(np.float32) for name in names], -1)


def attribute(name, kind, value):
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value


def head(width, height, names="RGB", kind=2, compression=0, flags=0, sampling=1, more=b""):
    """All of a file up to its table of chunks."""
    each = b"\0" + struct.pack("<4i", kind, 0, sampling, sampling)
    listed = b"".join(c.encode() + each for c in sorted(names))
    box = struct.pack("<4i", 0, 0, width - 1, height - 1)
    found = attribute("channels", "chlist", listed + b"\0")
    found += attribute("compression", "compression", bytes([compression]))
    found += attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box)
    found += attribute("lineOrder", "lineOrder", b"\0")
    found += attribute("pixelAspectRatio", "float", struct.pack("<f", 1))
    found += attribute("screenWindowCenter", "v2f", bytes(8))
    found += attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + more
    return MAGIC + struct.pack("<I", 2 | flags) + found + b"\0"


def with_chunks(before, chunks, starts=None):
    """A file of what comes before its table, and chunks; the table has all, or those numbered in `starts`."""
    offsets, at = [], len(before) + 8 * (len(chunks) if starts is None else len(starts))
    for chunk in chunks:
        offsets.append(at)
        at += len(chunk)
    table = offsets if starts is None else [offsets[k] for k in starts]
    return before + struct.pack(f"<{len(table)}Q", *table) + b"".join(chunks)


def rows(y, data):
    """A chunk of scan lines."""
    return struct.pack("<ii", y, len(data)) + data


def tile(x, y, level, data):
    """A chunk of a tile."""
    return struct.pack("<5i", x, y, *level, len(data)) + data
