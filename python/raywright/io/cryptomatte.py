"""Layers of the shapes that cover a pixel, for compositing: Cryptomatte 1.2 (Friedman and Jones, 2015)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

LAYER = "CryptoObject"


def murmur3(name: bytes) -> int:
    """Return the MurmurHash3 (x86, 32 bits, seed 0; Appleby, 2011) of some bytes."""
    mask = 0xFFFFFFFF

    def scrambled(k: int) -> int:
        k = k * 0xCC9E2D51 & mask
        return ((k << 15 | k >> 17) & mask) * 0x1B873593 & mask

    whole = len(name) // 4 * 4
    h = 0
    for i in range(0, whole, 4):
        h ^= scrambled(int.from_bytes(name[i : i + 4], "little"))
        h = ((h << 13 | h >> 19) & mask) * 5 + 0xE6546B64 & mask
    h ^= scrambled(int.from_bytes(name[whole:], "little")) ^ len(name)
    h = (h ^ h >> 16) * 0x85EBCA6B & mask
    h = (h ^ h >> 13) * 0xC2B2AE35 & mask
    return h ^ h >> 16


def identity(name: str) -> int:
    """Return the bits of the float32 that stands for a name: finite and normal, by one bit if need be."""
    bits = murmur3(name.encode())
    return bits ^ 1 << 23 if bits >> 23 & 255 in (0, 255) else bits


def name_of(shape: int) -> str:
    """Return the name of a shape."""
    return f"shape {shape}"


def layers(ranked: NDArray[np.float32]) -> tuple[dict[str, NDArray[np.float32]], dict[str, str]]:
    """Return channels and header of the shapes of each pixel, (H, W, ranks, 2): their numbers and shares."""
    shapes = ranked[..., 0].astype(np.int64)
    numbers = np.unique(shapes[shapes >= 0])
    bits = np.array([0, *(identity(name_of(n)) for n in numbers.tolist())], np.uint32).view(np.float32)
    ids = bits[np.where(shapes >= 0, np.searchsorted(numbers, shapes) + 1, 0)]
    channels = {}
    for rank in range(ranked.shape[2]):
        pair = "RG" if rank % 2 == 0 else "BA"
        for name, array in zip(pair, (ids[..., rank], ranked[..., rank, 1]), strict=True):
            channels[f"{LAYER}{rank // 2:02}.{name}"] = np.ascontiguousarray(array, np.float32)
    return channels, _header(map(name_of, numbers.tolist()))


def _header(names: Iterable[str]) -> dict[str, str]:
    import json

    key = f"cryptomatte/{murmur3(LAYER.encode()):08x}"[: len("cryptomatte/") + 7]
    return {
        f"{key}/name": LAYER,
        f"{key}/hash": "MurmurHash3_32",
        f"{key}/conversion": "uint32_to_float32",
        f"{key}/manifest": json.dumps({name: f"{identity(name):08x}" for name in names}),
    }
