"""Radiance's picture files: .hdr, of four bytes per pixel, three mantissas and an exponent they share."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

_MAGIC = (b"#?RADIANCE", b"#?RGBE", b"#?AUTOPANO")
_SIZE = re.compile(rb"([+-][XY])[ \t]+([0-9]+)[ \t]+([+-][XY])[ \t]+([0-9]+)[ \t\r]*\n")


def read_hdr(path: Path) -> NDArray[np.float32]:
    """Return the linear colors of an .hdr file, (H, W, 3) from the top row on (Ward, "Real Pixels", 1991).

    Colors are radiances: they are divided by the product of all lines EXPOSURE of the header, and of all
    lines COLORCORR.

    Raises
    ------
    ValueError
        If it is not a file of this kind, is cut short, or has colors other than red, green and blue.
    """
    data = path.read_bytes()
    header = re.match(rb".*?\n[ \t\r]*\n", data[: 2**16], re.DOTALL)
    size = _SIZE.match(data, header.end()) if header else None
    if not (data.startswith(_MAGIC) and header and size):
        raise ValueError("it is not a Radiance picture")
    if b"32-bit_rle_xyze" in header[0]:
        raise ValueError("it must hold red, green and blue, got X, Y and Z")
    outer, inner = (int(size[k]) if len(size[k]) < 10 else -1 for k in (2, 4))
    if size[1][1:] == size[3][1:]:
        raise ValueError("it is not a Radiance picture")
    try:
        rgbe = _pixels(data[size.end() :], inner, outer)
    except (ValueError, IndexError):
        raise ValueError("it is cut short, or not a Radiance picture") from None
    exponent = rgbe[..., 3:].astype(np.int32) - 136
    colors = np.ldexp(rgbe[..., :3].astype(np.float32), exponent)
    colors = np.where(rgbe[..., 3:] > 0, colors, np.float32(0)).astype(np.float32)
    with np.errstate(over="ignore"):
        exposed = (colors / _exposure(header[0])).astype(np.float32)
    return _upright(exposed, size[1], size[3])


def _exposure(header: bytes) -> NDArray[np.float64]:
    """Return the factor of red, green and blue in the file."""
    total = np.ones(3)
    for name, rest in re.findall(rb"^(EXPOSURE|COLORCORR)[ \t]*=([^\n]*)", header, re.MULTILINE):
        try:
            factors = np.array([float(word) for word in rest.split()])
        except ValueError:
            factors = np.zeros(1)
        if len(factors) not in (1, 3) or not (np.isfinite(factors) & (factors > 0)).all():
            raise ValueError(
                f"its {name.decode()} must be positive numbers, got {rest[:20].decode('latin-1')!r}"
            )
        total *= factors
    return total


def _upright(image: NDArray[np.float32], rows: bytes, columns: bytes) -> NDArray[np.float32]:
    """Return a picture from the top row on, left to right, whose pixels go as its size line says."""
    if rows[1:] == b"X":
        image, rows, columns = image.transpose(1, 0, 2), columns, rows
    # +Y means that rows run upwards.
    image = image[::-1] if rows == b"+Y" else image
    return np.ascontiguousarray(image[:, ::-1] if columns == b"-X" else image)


def _pixels(body: bytes, width: int, height: int) -> NDArray[np.uint8]:
    """Return the four bytes of each pixel, in rows that are run-length encoded or not."""
    # 255 equal bytes take 4 bytes in the old encoding; 127 take 2 in the new one.
    least = min(4 * -(-width // 255), 4 + 8 * -(-width // 127))
    if min(width, height) < 1 or len(body) < height * min(least, 4 * width):
        raise ValueError
    result = np.empty((height, width, 4), np.uint8)
    at = 0
    for number, row in enumerate(result):
        if 8 <= width <= 32767 and body[at : at + 4] == bytes((2, 2, width >> 8, width & 255)):
            at = _new_row(body, at + 4, row)
        else:
            before = None if number == 0 else result[number - 1, -1]
            at = _old_row(body, at, row, before)
    return result


def _new_row(body: bytes, at: int, row: NDArray[np.uint8]) -> int:
    """Read a row whose channels have runs of their own, and return where the next one begins."""
    width = len(row)
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
    return at


def _old_row(body: bytes, at: int, row: NDArray[np.uint8], before: NDArray[np.uint8] | None) -> int:
    """Read a row of pixels, in which 1, 1, 1 and n repeat the last n times, and return the start of the next.

    Each further such pixel in a row counts 256 times as much as the one before it.
    """
    width = len(row)
    plain = np.frombuffer(body, np.uint8, min(4 * width, (len(body) - at) // 4 * 4), at).reshape(-1, 4)
    is_run = (plain[:, :3] == 1).all(axis=1)
    if len(plain) == width and not is_run.any():
        row[:] = plain
        return at + 4 * width
    column, shift = 0, 0
    while column < width:
        pixel = body[at : at + 4]
        at += 4
        if len(pixel) < 4:
            raise ValueError
        if pixel[:3] == b"\1\1\1":
            last = row[column - 1] if column else before
            count = pixel[3] << shift
            if last is None or column + count > width:
                raise ValueError
            row[column : column + count] = last
            column += count
            shift += 8
            if shift > 32:
                raise ValueError
        else:
            row[column] = np.frombuffer(pixel, np.uint8)
            column += 1
            shift = 0
    return at
