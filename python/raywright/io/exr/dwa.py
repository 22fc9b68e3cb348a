"""DWAA and DWAB: colors as quantized cosines of 8 x 8 samples, other channels without loss.

After internal_dwa_decoder.h of OpenEXR, whose cosines differ between processors by the rounding of a float.
So do ours: 1 of 3000 samples is another half, as its stored value is rounded to the other neighbor.
"""

from __future__ import annotations

import struct
from collections.abc import Sequence
from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..._core import exr_huffman, exr_integrate, exr_run_lengths
from .codecs import Block, Plane, Words, inflate
from .header import Channel

_STORED, _COSINES, _RUNS = range(3)
# Zigzag index of each sample of a block, row by row.
_ZIGZAG = np.array(
    [
        (0, 1, 5, 6, 14, 15, 27, 28),
        (2, 4, 7, 13, 16, 26, 29, 42),
        (3, 8, 12, 17, 25, 30, 41, 43),
        (9, 11, 18, 24, 31, 40, 44, 53),
        (10, 19, 23, 32, 39, 45, 52, 54),
        (20, 22, 33, 38, 46, 51, 55, 60),
        (21, 34, 37, 47, 50, 56, 59, 61),
        (35, 36, 48, 49, 57, 58, 62, 63),
    ]
).ravel()
# cos(k pi / 16) / 2, the first divided by the root of 2, rounded as in OpenEXR: exact ones change 1 of 600
# samples.
_HALF_COSINES = (0.3535536, 0.4903927, 0.4619398, 0.4157349, 0.3535536, 0.2777855, 0.1913422, 0.09754573, 0)
_HEAD = struct.Struct("<11Q")
# OpenEXR writes up to 15.
_MOST_RULES = 64


class _Sizes(NamedTuple):
    """The head of a chunk."""

    version: int
    stored: int
    stored_packed: int
    cosines_packed: int
    means_packed: int
    runs_packed: int
    run_tokens: int
    runs: int
    cosines: int
    means: int
    cosines_method: int


class _Rule(NamedTuple):
    """The scheme of channels of one type and suffix, and whether they are red, green or blue (1 to 3)."""

    suffix: str
    kind: int
    scheme: int
    color: int
    ignores_case: bool

    def fits(self, channel: Channel) -> bool:
        """Return whether the rule applies to a channel."""
        suffix = channel.name.rpartition(".")[2]
        same = suffix.lower() == self.suffix.lower() if self.ignores_case else suffix == self.suffix
        return same and channel.kind == self.kind


def unpack_dwa(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Return the samples of some channels of a packed block, each (rows, width) of the channel's own type.

    Raises
    ------
    ValueError
        If `packed` does not hold them.
    """
    if not block.part.is_whole:
        raise ValueError("subsampled channels are not supported with DWA compression")
    if len(packed) < _HEAD.size:
        raise ValueError("it is cut short")
    sizes = _Sizes(*_HEAD.unpack_from(packed))
    rules, at = _read_rules(packed, _HEAD.size) if sizes.version >= 2 else (_old_rules(), _HEAD.size)
    sections = []
    for length in sizes[2:6]:
        if length > len(packed) - at:
            raise ValueError("it is cut short")
        sections.append(packed[at : at + length])
        at += length
    channels = block.part.channels
    schemes, groups = _classify(channels, rules)
    samples = block.width * block.rows
    found: dict[str, Plane] = {}

    for scheme, count in ((_STORED, sizes.stored), (_RUNS, sizes.runs)):
        of_scheme = [c for c, one in zip(channels, schemes, strict=True) if one == scheme]
        size = samples * sum(c.dtype.itemsize for c in of_scheme)
        if count != size:
            raise ValueError("its length is wrong")
        if size == 0:
            continue
        if scheme == _STORED:
            raw = inflate(sections[0], size)
        elif sizes.run_tokens > 2 * size:
            raise ValueError("its runs are too long")
        else:
            raw = exr_run_lengths(inflate(sections[3], sizes.run_tokens), size)
        begin = 0
        for channel in of_scheme:
            end = begin + samples * channel.dtype.itemsize
            octets = np.frombuffer(raw[begin:end], np.uint8)
            if scheme == _RUNS:
                # Bytes are stored in planes: all first bytes, then all second ones, and so on.
                octets = np.ascontiguousarray(octets.reshape(-1, samples).T)
            found[channel.name] = octets.ravel().view(channel.dtype).reshape(block.rows, block.width)
            begin = end

    if groups:
        found |= _cosine_planes(sections[1], sections[2], sizes, block, groups)
    return [found[channel.name] for channel in wanted]


def _cosine_planes(
    cosines: bytes, means: bytes, sizes: _Sizes, block: Block, groups: Sequence[tuple[Channel, ...]]
) -> dict[str, Plane]:
    across, down = -(-block.width // 8), -(-block.rows // 8)
    blocks = across * down
    count = blocks * sum(map(len, groups))
    if sizes.means != count or sizes.cosines > 63 * count or sizes.cosines_method > 1:
        raise ValueError("its length is wrong")
    averages = exr_integrate(inflate(means, 2 * count)).view("<u2")
    if sizes.cosines_method == 0:
        tokens = exr_huffman(cosines, sizes.cosines)
    else:
        tokens = np.frombuffer(inflate(cosines, 2 * sizes.cosines), "<u2")
    coefficients = _coefficients(tokens, count)
    found = {}
    at = 0
    for group in groups:
        # Averages come channel by channel, the others block by block.
        part = coefficients[at : at + blocks * len(group)].reshape(blocks, len(group), 64)
        part[..., 0] = averages[at : at + blocks * len(group)].reshape(len(group), blocks).T
        at += blocks * len(group)
        values = part.view(np.float16).astype(np.float32) @ _cosine_matrix()
        if len(group) == 3:
            luma, blue, red = values.transpose(1, 0, 2)
            green = luma - np.float32(0.1873) * blue - np.float32(0.4682) * red
            red, blue = luma + np.float32(1.5747) * red, luma + np.float32(1.8556) * blue
            values = np.stack([red, green, blue], axis=1)
        coded = values.astype(np.float16).view(np.uint16).reshape(down, across, len(group), 8, 8)
        rows = coded.transpose(2, 0, 3, 1, 4).reshape(len(group), 8 * down, 8 * across)
        for channel, plane in zip(group, rows[:, : block.rows, : block.width], strict=True):
            is_linear = channel.is_perceptual and len(group) == 1
            halves = (plane.copy() if is_linear else _to_linear()[plane]).view(np.float16)
            found[channel.name] = halves.astype(channel.dtype)
    return found


def _coefficients(tokens: Words, blocks: int) -> Words:
    """Return 64 coefficients a block, the first one 0. 0xff00 ends a block, 0xffNN stands for NN zeros."""
    is_run = tokens >= 0xFF00
    steps = np.where(is_run, tokens & 0xFF, 1).astype(np.int64)
    ends = tokens == 0xFF00
    # Positions as if no block ended early; then data after an early end moves to the start of the next block.
    place = np.cumsum(steps) - steps
    early = np.flatnonzero(ends)
    lengths = np.diff(place[early], prepend=0)
    moved = np.cumsum((lengths // 63 + 1) * 63 - lengths)
    place += np.concatenate([[0], moved])[np.cumsum(ends) - ends]
    last = place[-1] + (63 - place[-1] % 63 if ends[-1] else steps[-1]) if len(tokens) else 0
    crosses = place % 63 + steps > 63
    if last != 63 * blocks or crosses.any():
        raise ValueError("its number of cosine coefficients is wrong")
    found = np.zeros((blocks, 64), np.uint16)
    literal = ~is_run
    found[place[literal] // 63, place[literal] % 63 + 1] = tokens[literal]
    return found


@cache
def _cosine_matrix() -> NDArray[np.float32]:
    """Return the inverse transform of a block's coefficients, in zigzag order, to its samples row by row."""
    # cos(n (2 k + 1) pi / 16) by row n and column k, folded into a quarter of its period.
    step = np.outer(np.arange(8), 2 * np.arange(8) + 1) % 32
    step = np.minimum(step, 32 - step)
    waves = np.where(step > 8, -1, 1) * np.array(_HALF_COSINES)[np.minimum(step, 16 - step)]
    matrix = np.zeros((64, 64))
    matrix[_ZIGZAG] = np.kron(waves, waves)
    return matrix.astype(np.float32)


@cache
def _to_linear() -> Words:
    """Return a table of the bits of samples by those of the halves that are stored."""
    x = np.arange(65536, dtype=np.uint16).view(np.float16).astype(np.float64)
    with np.errstate(all="ignore"):
        size = np.abs(x)
        linear = np.where(size <= 1, size**2.2, 9.02501329156 ** (size - 1))
        halves = np.copysign(linear, x).astype(np.float16)
    return np.where(np.isfinite(x), halves, np.float16(0)).view(np.uint16)


@lru_cache(maxsize=16)
def _classify(
    channels: tuple[Channel, ...], rules: tuple[_Rule, ...]
) -> tuple[list[int], list[tuple[Channel, ...]]]:
    """Return the scheme of each channel, and groups of those that are cosines: triples of colors first."""
    schemes = []
    colors: dict[str, dict[int, int]] = {}
    for number, channel in enumerate(channels):
        slots = colors.setdefault(channel.name[: channel.name.rfind(".") + 1], {})
        scheme = _STORED
        for rule in rules:
            if rule.fits(channel):
                scheme = rule.scheme
                if rule.color:
                    slots[rule.color] = number
        if scheme == _COSINES and channel.kind == 0:
            raise ValueError("its cosine coefficients are integers")
        schemes.append(scheme)
    threes = [
        [slots[k] for k in (1, 2, 3)]
        for slots in colors.values()
        if len(slots) == 3 and all(schemes[n] == _COSINES for n in slots.values())
    ]
    taken = {n for three in threes for n in three}
    ones = [[n] for n, scheme in enumerate(schemes) if scheme == _COSINES and n not in taken]
    return schemes, [tuple(channels[n] for n in group) for group in threes + ones]


def _read_rules(packed: bytes, at: int) -> tuple[tuple[_Rule, ...], int]:
    end = at + int.from_bytes(packed[at : at + 2], "little")
    if not at + 2 <= end <= len(packed):
        raise ValueError("it is cut short")
    rest = packed[at + 2 : end]
    rules: list[_Rule] = []
    while rest:
        suffix, _, rest = rest.partition(b"\0")
        if len(rest) < 2 or rest[0] >> 4 > 3 or rest[0] >> 2 & 3 > 2 or len(rules) == _MOST_RULES:
            raise ValueError("its channel rules are broken")
        flags, kind = rest[:2]
        rules.append(
            _Rule(suffix.decode("utf-8", "replace"), kind, flags >> 2 & 3, flags >> 4, bool(flags & 1))
        )
        rest = rest[2:]
    return tuple(rules), end


def _old_rules() -> tuple[_Rule, ...]:
    """Return the rules of chunks that have none."""
    names = ("y by ry", "r red", "g grn green", "b blu blue")
    lossy = [
        _Rule(suffix, kind, _COSINES, color, True)
        for color, suffixes in enumerate(names)
        for suffix in suffixes.split()
        for kind in (1, 2)
    ]
    return (*lossy, *(_Rule("a", kind, _RUNS, 0, True) for kind in range(3)))
