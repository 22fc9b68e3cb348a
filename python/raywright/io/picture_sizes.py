"""How large a picture says that it is, before any of it is decoded."""

import struct
from pathlib import Path

# More than 16384 by 16384.
MOST_PIXELS = 300_000_000
# As far as the headers are read that say it; what is said later is not believed.
_HEADER = 65536


def refuse_huge(path: Path) -> None:
    """Refuse a picture whose header tells of more pixels than there is reason for.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is an EXR, an HDR or a PNG of more than `MOST_PIXELS`, or one whose header says nothing. Others
        are for those to refuse who read them.
    """
    with open(path, "rb") as file:
        head = file.read(_HEADER)
    readers = {".exr": _exr, ".hdr": _hdr, ".png": _png}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        return
    try:
        width, height = reader(head)
    except (ValueError, struct.error):
        raise ValueError(f"{path} is not a picture that can be read (its header has no size)") from None
    if width * height > MOST_PIXELS:
        told = f"{width} x {height} pixels, and at most {MOST_PIXELS:,} are read"
        raise ValueError(f"{path} is not a picture that can be read (it says that it has {told})")


def _exr(head: bytes) -> tuple[int, int]:
    """Read the data window: an attribute is a name, a type, a length and that many bytes (OpenEXR)."""
    at = head.index(b"dataWindow\0box2i\0") + 17
    length, *corners = struct.unpack_from("<I4i", head, at)
    left, top, right, bottom = corners
    if length != 16 or right < left or bottom < top:
        raise ValueError
    return right - left + 1, bottom - top + 1


def _hdr(head: bytes) -> tuple[int, int]:
    _, blank, rest = head.partition(b"\n\n")
    words = rest.partition(b"\n")[0].split()
    if not blank or len(words) != 4:
        raise ValueError
    return int(words[3]), int(words[1])


def _png(head: bytes) -> tuple[int, int]:
    if head[12:16] != b"IHDR":
        raise ValueError
    width, height = struct.unpack_from(">2I", head, 16)
    return width, height
