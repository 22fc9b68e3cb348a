"""Radiance's picture files: .hdr, of four bytes a pixel, three mantissas and an exponent they share."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray


def read_hdr(path: Path) -> NDArray[np.float32]:
    """Return the linear colours of an .hdr file, (H, W, 3) from the top row on (Ward, "Real Pixels", 1991).

    Raises
    ------
    ValueError
        If it is no such file, is cut short, or is stored in another order than rows from the top.
    """
    data = path.read_bytes()
    header, blank, rest = data.partition(b"\n\n")
    line, newline, body = rest.partition(b"\n")
    words = line.split()
    if not (data.startswith((b"#?RADIANCE", b"#?RGBE")) and blank and newline and len(words) == 4):
        raise ValueError("it is no Radiance picture")
    if b"32-bit_rle_xyze" in header or (words[0], words[2]) != (b"-Y", b"+X"):
        raise ValueError("it must hold red, green and blue in rows from the top, left to right")
    try:
        height, width = int(words[1]), int(words[3])
        rgbe = _pixels(body, width, height)
    except (ValueError, IndexError):
        raise ValueError("it is cut short, or no Radiance picture") from None
    exponent = rgbe[..., 3:].astype(np.int32) - 136
    colours = np.ldexp(rgbe[..., :3].astype(np.float32), exponent)
    return np.where(rgbe[..., 3:] > 0, colours, np.float32(0)).astype(np.float32)


def _pixels(body: bytes, width: int, height: int) -> NDArray[np.uint8]:
    """Return the four bytes of each pixel, of rows that are run-length encoded or not."""
    encoded = 8 <= width <= 32767
    # 127 times the same number takes 2 bytes, at least.
    least = 4 + 8 * -(-width // 127) if encoded else 4 * width
    if min(width, height) < 1 or len(body) < height * least:
        raise ValueError
    result = np.empty((height, width, 4), np.uint8)
    at = 0
    for row in result:
        if not encoded or body[at : at + 4] != bytes((2, 2, width >> 8, width & 255)):
            row[:] = np.frombuffer(body, np.uint8, 4 * width, at).reshape(width, 4)
            at += 4 * width
            continue
        at += 4
        for channel in range(4):
            column = 0
            while column < width:
                count = body[at]
                if count > 128:
                    count -= 128
                    row[column : column + count, channel] = body[at + 1]
                    at += 2
                else:
                    row[column : column + count, channel] = np.frombuffer(body, np.uint8, count, at + 1)
                    at += 1 + count
                if count == 0 or column + count > width:
                    raise ValueError
                column += count
    return result
