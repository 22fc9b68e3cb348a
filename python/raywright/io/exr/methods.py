"""The decoder of each method of compression."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

from .codecs import (
    Block,
    Plane,
    unpack_b44,
    unpack_piz,
    unpack_pxr24,
    unpack_rle,
    unpack_stored,
    unpack_zip,
)
from .dwa import unpack_dwa
from .header import Channel

_Method: TypeAlias = Callable[[bytes, Block, Sequence[Channel]], list[Plane]]
# By the number of the compression: none, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB.
_METHODS: tuple[_Method, ...] = (
    unpack_stored,
    unpack_rle,
    unpack_zip,
    unpack_zip,
    unpack_piz,
    unpack_pxr24,
    unpack_b44,
    unpack_b44,
    unpack_dwa,
    unpack_dwa,
)


def unpack(packed: bytes, block: Block, wanted: Sequence[Channel]) -> list[Plane]:
    """Return the samples of some channels of a packed block, each (rows, width) of the channel's own type.

    Raises
    ------
    ValueError
        If `packed` does not hold them.
    """
    # Chunks that would not shrink are stored raw.
    method = unpack_stored if len(packed) == block.size else _METHODS[block.part.compression]
    return method(packed, block, wanted)
