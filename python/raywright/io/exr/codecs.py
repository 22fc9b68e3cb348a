"""Chunks of EXR files, packed and unpacked by whole arrays; what goes symbol by symbol is in the core."""

import zlib
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..._core import exr_piz, exr_run_lengths
from .header import Channel, Part

Octets: TypeAlias = NDArray[np.uint8]
Words: TypeAlias = NDArray[np.uint16]
Plane: TypeAlias = NDArray[Any]


class Block(NamedTuple):
    """Pixels that are packed together."""

    part: Part
    width: int
    rows: int

    @property
    def size(self) -> int:
        """Number of bytes unpacked."""
        return self.width * self.rows * self.part.pixel_bytes


def planes(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Return the samples of some channels of a packed block, each (rows, width) of the channel's own type.

    Raises
    ------
    ValueError
        If `packed` does not hold them.
    """
    # What does not get shorter is stored as it is, whatever the method.
    unpack = _rows if len(packed) == block.size else _METHODS[block.part.compression]
    return unpack(packed, block, wanted)


def deflate(raw: Octets) -> bytes:
    """Return bytes as the method ZIP packs them; as they are if that is no longer."""
    halves = np.concatenate([raw[0::2], raw[1::2]])
    halves[1:] -= halves[:-1] + np.uint8(128)
    # The level that OpenEXR takes.
    packed = zlib.compress(halves.tobytes(), 4)
    return packed if len(packed) < raw.size else raw.tobytes()


def inflate(packed: bytes, size: int) -> Octets:
    """Undo zlib, to just so many bytes.

    Raises
    ------
    ValueError
        If it is broken, or there are fewer or more.
    """
    inflater = zlib.decompressobj()
    try:
        raw = inflater.decompress(packed, size)
        # The end, with its check sum, may still be to come.
        more = b"" if inflater.eof else inflater.decompress(inflater.unconsumed_tail, 1)
    except zlib.error as error:
        raise ValueError(str(error)) from error
    if len(raw) != size or more or not inflater.eof:
        raise ValueError("it is not as long as it should be")
    return np.frombuffer(raw, np.uint8)


def integrate(coded: Octets) -> Octets:
    """Undo the differences of ZIP and RLE, and bring the even bytes, which come first, among the odd ones."""
    # Each difference has 128 added: an odd number of them is the highest bit, for there the sum is modulo 256.
    summed: Octets = np.add.accumulate(coded, dtype=np.uint8)
    summed.view("<u2")[...] ^= 0x8000
    half = len(summed) // 2
    words = summed[half:].astype("<u2")
    words <<= 8
    words |= summed[:half]
    return words.view(np.uint8)


def _rows(raw: bytes | Octets, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Cut bytes into channels: row by row, each row channel by channel."""
    if len(raw) != block.size:
        raise ValueError("it is not as long as it should be")
    rows = np.frombuffer(raw, np.uint8).reshape(block.rows, -1)
    found = []
    for channel in wanted:
        begin = block.width * channel.start
        found.append(rows[:, begin : begin + block.width * channel.dtype.itemsize].view(channel.dtype))
    return found


def _rle(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    return _rows(integrate(exr_run_lengths(packed, block.size)), block, wanted)


def _zip(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    return _rows(integrate(inflate(packed, block.size)), block, wanted)


def _piz(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    words = [channel.dtype.itemsize // 2 for channel in block.part.channels]
    samples = exr_piz(packed, block.width, block.rows, words).astype("<u2", copy=False)
    found = []
    for channel in wanted:
        begin, end = (
            block.width * block.rows * n // 2
            for n in (channel.start, channel.start + channel.dtype.itemsize)
        )
        found.append(samples[begin:end].view(channel.dtype).reshape(block.rows, block.width))
    return found


def _pxr24(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Sum the differences along each row, whose highest bytes come first; floats have lost their lowest one."""
    begins = [0]
    for channel in block.part.channels:
        begins.append(begins[-1] + block.width * (4, 2, 3)[channel.kind])
    rows = inflate(packed, begins[-1] * block.rows).reshape(block.rows, -1)
    found = []
    for channel in wanted:
        number = block.part.channels.index(channel)
        octets = rows[:, begins[number] : begins[number + 1]].reshape(block.rows, -1, block.width)
        unsigned = np.dtype("<u2") if channel.kind == 1 else np.dtype("<u4")
        differences = np.zeros((block.rows, block.width), unsigned)
        for k in range(octets.shape[1]):
            differences |= octets[:, k].astype(unsigned) << unsigned.type(8 * (unsigned.itemsize - 1 - k))
        found.append(np.add.accumulate(differences, axis=1, dtype=unsigned).view(channel.dtype))
    return found


def _b44(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Unpack half channels from 4 x 4 samples in 14 bytes, or 3 where all are the same; others are as they are."""
    found = {}
    samples = block.width * block.rows
    across, down = -(-block.width // 4), -(-block.rows // 4)
    # A block of 3 bytes may be the last, and is read as 14.
    octets = np.frombuffer(packed + bytes(11), np.uint8)
    at = 0
    for channel in block.part.channels:
        if channel.kind != 1:
            end = at + 4 * samples
            if end > len(packed):
                raise ValueError("it is cut short")
            found[channel.name] = np.frombuffer(packed[at:end], channel.dtype).reshape(block.rows, block.width)
        else:
            starts, end = _starts_of_4x4(packed, at, across * down)
            if channel in wanted:
                values = _values_of_4x4(octets, starts).reshape(down, across, 4, 4)
                plane = values.transpose(0, 2, 1, 3).reshape(4 * down, 4 * across)[: block.rows, : block.width]
                plane = _from_perceptual()[plane] if channel.is_perceptual else plane
                found[channel.name] = np.ascontiguousarray(plane, "<u2").view(channel.dtype)
        at = end
    return [found[channel.name] for channel in wanted]


def _starts_of_4x4(packed: bytes, at: int, count: int) -> tuple[NDArray[np.int64], int]:
    """Find where each of `count` blocks begins from `at` on, and where the last ends."""
    starts = []
    try:
        for _ in range(count):
            starts.append(at)
            # A shift of 13 or more bits marks a block of one value.
            at += 3 if packed[at + 2] >= 52 else 14
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
    # By column and row: the first field is the shift, the others are what is added, on the way down the first column
    # and from each of its samples to the right.
    steps = (fields.astype(np.int32) - 32 << np.minimum(shift, 12).astype(np.int32)).astype(np.uint16)
    steps[shift[:, 0, 0] >= 13] = 0
    steps[:, 0, 0] = blocks[:, 0].astype(np.uint16) << np.uint16(8) | blocks[:, 1]
    steps[:, 0] = np.add.accumulate(steps[:, 0], axis=1, dtype=np.uint16)
    ordered: Words = np.add.accumulate(steps, axis=1, dtype=np.uint16).transpose(0, 2, 1).reshape(-1, 16)
    # The bits of negative numbers were turned, so that all are in order.
    return np.where(ordered & 0x8000, ordered & 0x7FFF, ~ordered)


@cache
def _from_perceptual() -> Words:
    """Return, by the bits of a half x, those of 8 log(x): what B44 stores of channels that are perceptually linear."""
    x = np.arange(65536, dtype=np.uint16).view(np.float16).astype(np.float32)
    with np.errstate(all="ignore"):
        logs = (8 * np.log(x.astype(np.float64))).astype(np.float16)
    return np.where(np.isfinite(x) & (x >= 0), logs, np.float16(0)).view(np.uint16)


_Method: TypeAlias = Callable[[bytes, Block, Sequence[Channel]], list[Plane]]
_METHODS: tuple[_Method, ...] = (_rows, _rle, _zip, _zip, _piz, _pxr24, _b44, _b44)
