"""Codecs of EXR chunks on whole arrays; codes that are read symbol by symbol are decoded in the core."""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from functools import cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..._core import exr_integrate, exr_piz, exr_run_lengths
from .header import Channel, Part

Octets: TypeAlias = NDArray[np.uint8]
Words: TypeAlias = NDArray[np.uint16]
Plane: TypeAlias = NDArray[Any]

# The least third byte of a flat block of B44; other blocks have a shift of up to 12 there.
_FLAT = 13 << 2


class Block(NamedTuple):
    """Pixels that are packed together; `top` is the first of their rows."""

    part: Part
    width: int
    rows: int
    top: int = 0

    @property
    def size(self) -> int:
        """Number of bytes unpacked."""
        if self.part.is_whole:
            return self.width * self.rows * self.part.pixel_bytes
        sizes = ((self.shape(channel), channel.dtype.itemsize) for channel in self.part.channels)
        return sum(rows * width * size for (rows, width), size in sizes)

    def shape(self, channel: Channel) -> tuple[int, int]:
        """Return the numbers of rows and columns that a channel has."""
        return len(self.rows_of(channel)), self.width // channel.sampling[0]

    def rows_of(self, channel: Channel) -> range:
        """Return the rows that a channel has, counted from the first."""
        down = channel.sampling[1]
        return range(-self.top % down, self.rows, down)


def deflate(raw: Octets) -> bytes:
    """Return bytes as the method ZIP packs them, or as they are if that is not longer."""
    halves = np.concatenate([raw[0::2], raw[1::2]])
    halves[1:] -= halves[:-1] + np.uint8(128)
    # Level 4, OpenEXR's own, gains 0 to 8 % (of smooth pictures) and takes 1.2 to 2.6 times as long.
    packed = zlib.compress(halves.tobytes(), 1)
    return packed if len(packed) < raw.size else raw.tobytes()


def inflate(packed: bytes, size: int) -> bytes:
    """Undo zlib, to exactly `size` bytes.

    Raises
    ------
    ValueError
        If it is broken, or there are fewer or more.
    """
    # zlib takes 0 for no bound at all.
    if size < 1:
        raise ValueError("its length is wrong")
    inflater = zlib.decompressobj()
    try:
        raw = inflater.decompress(packed, size)
        # The end of the stream, with its checksum, may still be to come.
        more = b"" if inflater.eof else inflater.decompress(inflater.unconsumed_tail, 1)
    except zlib.error as error:
        raise ValueError("its zlib stream is broken") from error
    if len(raw) != size or more or not inflater.eof:
        raise ValueError("its length is wrong")
    return raw


def unpack_stored(raw: bytes | Octets, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Cut bytes into channels: row by row, each row channel by channel."""
    if len(raw) != block.size:
        raise ValueError("its length is wrong")
    sizes = [channel.dtype.itemsize for channel in block.part.channels]
    cut = _cut_rows(np.frombuffer(raw, np.uint8), block, sizes, wanted)
    return [octets.view(c.dtype).reshape(block.shape(c)) for c, octets in zip(wanted, cut, strict=True)]


def _cut_rows(raw: Octets, block: Block, sizes: Sequence[int], wanted: Sequence[Channel]) -> list[Octets]:
    """Return the bytes of channels that come row by row, given the bytes of a sample of each channel."""
    if block.part.is_whole:
        rows = raw.reshape(block.rows, -1)
        ends = block.width * np.cumsum(sizes)
        numbers = [block.part.channels.index(channel) for channel in wanted]
        return [rows[:, ends[k] - block.width * sizes[k] : ends[k]] for k in numbers]
    cut: dict[str, list[Octets]] = {channel.name: [] for channel in block.part.channels}
    has_row = [
        (channel, block.rows_of(channel), size)
        for channel, size in zip(block.part.channels, sizes, strict=True)
    ]
    at = 0
    for row in range(block.rows):
        for channel, own, size in has_row:
            if row in own:
                end = at + block.width // channel.sampling[0] * size
                cut[channel.name].append(raw[at:end])
                at = end
    return [np.concatenate([np.empty(0, np.uint8), *cut[channel.name]]) for channel in wanted]


def unpack_rle(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Undo run lengths and differences."""
    return unpack_stored(exr_integrate(exr_run_lengths(packed, block.size)), block, wanted)


def unpack_zip(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Undo zlib and differences."""
    return unpack_stored(exr_integrate(inflate(packed, block.size)), block, wanted)


def unpack_piz(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Undo Huffman codes and the wavelet, which the core does; channels come one after the other."""
    shapes = [block.shape(channel) for channel in block.part.channels]
    words = [channel.dtype.itemsize // 2 for channel in block.part.channels]
    sizes = [(width, rows, n) for (rows, width), n in zip(shapes, words, strict=True)]
    samples = exr_piz(packed, sizes).astype("<u2", copy=False)
    ends = np.cumsum([rows * width * n for rows, width, n in sizes])
    found = []
    for channel in wanted:
        number = block.part.channels.index(channel)
        own = samples[ends[number] - np.prod(sizes[number]) : ends[number]]
        found.append(own.view(channel.dtype).reshape(shapes[number]))
    return found


def unpack_pxr24(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Sum differences along each row. Their highest bytes come first; floats lack their lowest byte."""
    sizes = [(4, 2, 3)[channel.kind] for channel in block.part.channels]
    count = sum(np.prod(block.shape(c)) * n for c, n in zip(block.part.channels, sizes, strict=True))
    raw = np.frombuffer(inflate(packed, int(count)), np.uint8)
    found = []
    for channel, cut in zip(wanted, _cut_rows(raw, block, sizes, wanted), strict=True):
        rows, width = block.shape(channel)
        octets = cut.reshape(rows, (4, 2, 3)[channel.kind], width)
        # Bytes of a sample from the highest to the lowest.
        differences = np.zeros((rows, width, channel.dtype.itemsize), np.uint8)
        for k in range(octets.shape[1]):
            differences[..., -1 - k] = octets[:, k]
        unsigned = f"<u{channel.dtype.itemsize}"
        summed = np.add.accumulate(differences.view(unsigned)[..., 0], axis=1, dtype=unsigned)
        found.append(summed.view(channel.dtype))
    return found


def unpack_b44(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Unpack half channels from 4 x 4 samples in 14 bytes, or in 3 where all are equal; copy the others."""
    found = {}
    # A 3-byte block may be the last, but 14 bytes are read.
    octets = np.frombuffer(packed + bytes(11), np.uint8)
    at = 0
    for channel in block.part.channels:
        rows, width = block.shape(channel)
        across, down = -(-width // 4), -(-rows // 4)
        if channel.kind != 1:
            end = at + 4 * rows * width
            if end > len(packed):
                raise ValueError("it is cut short")
            stored = np.frombuffer(packed[at:end], channel.dtype)
            found[channel.name] = stored.reshape(rows, width)
        else:
            starts, end = _starts_of_4x4(packed, at, across * down)
            if channel in wanted:
                values = _values_of_4x4(octets, starts).reshape(down, across, 4, 4)
                whole = values.transpose(0, 2, 1, 3).reshape(4 * down, 4 * across)
                plane = whole[:rows, :width]
                plane = _from_perceptual()[plane] if channel.is_perceptual else plane
                found[channel.name] = np.ascontiguousarray(plane, "<u2").view(channel.dtype)
        at = end
    return [found[channel.name] for channel in wanted]


def _starts_of_4x4(packed: bytes, at: int, count: int) -> tuple[NDArray[np.int64], int]:
    """Find where each of `count` blocks begins from `at` on, and where the last ends."""
    end = at + 14 * count
    if end <= len(packed) and max(packed[at + 2 : end : 14]) < _FLAT:
        return np.arange(at, end, 14).astype(np.int64), end
    starts = []
    try:
        for _ in range(count):
            starts.append(at)
            at += 3 if packed[at + 2] >= _FLAT else 14
    except IndexError:
        at = len(packed) + 1
    if at > len(packed):
        raise ValueError("it is cut short")
    return np.array(starts, np.int64), at


def _values_of_4x4(octets: Octets, starts: NDArray[np.int64]) -> Words:
    """Return the bits of the halves of blocks, (blocks, 16), row by row."""
    blocks = octets[starts[:, np.newaxis] + np.arange(14)]
    triples = blocks[:, 2:].reshape(-1, 4, 3).astype(np.uint32) @ np.array([1 << 16, 1 << 8, 1], np.uint32)
    fields = triples[..., np.newaxis] >> np.array([18, 12, 6, 0], np.uint32) & np.uint32(63)
    shift = fields[:, :1, :1]
    # By column and row. The first field is the shift. The others are differences down the first column, and
    # to the right from each of its samples.
    steps = (fields.astype(np.int32) - 32 << np.minimum(shift, 12).astype(np.int32)).astype(np.uint16)
    steps[shift[:, 0, 0] >= 13] = 0
    steps[:, 0, 0] = blocks[:, 0].astype(np.uint16) << np.uint16(8) | blocks[:, 1]
    # Whole-array additions are faster than `accumulate` along an axis of four.
    for k in range(1, 4):
        steps[:, 0, k] += steps[:, 0, k - 1]
    for k in range(1, 4):
        steps[:, k] += steps[:, k - 1]
    ordered: Words = steps.transpose(0, 2, 1).reshape(-1, 16)
    # Bits of negative numbers are flipped, so that the order of words is that of the numbers.
    return np.where(ordered & 0x8000, ordered & 0x7FFF, ~ordered)


@cache
def _from_perceptual() -> Words:
    """Return a table of 8 log(x) by the bits of x: B44 stores exp(x / 8) of perceptually linear channels."""
    x = np.arange(65536, dtype=np.uint16).view(np.float16).astype(np.float32)
    with np.errstate(all="ignore"):
        logs = (8 * np.log(x.astype(np.float64))).astype(np.float16)
    table: Words = np.where(np.isfinite(x) & (x >= 0), logs, np.float16(0)).view(np.uint16)
    # The only entry where OpenEXR's table is not the nearest half.
    table[7544] = 53564
    return table
