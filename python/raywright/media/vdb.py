"""Grids of floats from OpenVDB's files, of the versions that OpenVDB has written since 2013 (222 to 225).

A tree has a root, two levels of nodes of 32³ and 16³ children, and leaves of 8³ numbers (Museth, "VDB:
High-Resolution Sparse Volumes with Dynamic Topology", 2013). A node with one value throughout is a tile.
"""

from __future__ import annotations

import importlib
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .sparse_grid import SparseGrid

_MAGIC = 0x56444220
_VERSIONS = range(222, 226)
_FLOATS = ("Tree_float_5_4_3", "Tree_float_5_4_3_HalfFloat")
# Flags of compression.
_ZIP, _ACTIVE_MASK, _BLOSC = 1, 2, 4
# Codes for the inactive values of a node, which its data omits.
_ONE_VALUE, _MASK, _MASK_AND_ONE, _MASK_AND_TWO, _ALL = 2, 3, 4, 5, 6
# From the root down: log2 of the children along an axis, and the values of one child along it.
_LEVELS = ((5, 128), (4, 8))
_LEAF = 8
# Most values in tiles: 4 GB.
_MOST = 2**30


class _Grid(NamedTuple):
    matrix: NDArray[np.float64]
    parts: list[tuple[tuple[int, int, int], NDArray[np.float32]]]


def read_vdb(path: Path, names: tuple[str, ...]) -> tuple[dict[str, SparseGrid], dict[str, Any]]:
    """Return grids of a file by name, all over the same box, and where that lies: bounds and a transform.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ImportError
        If it is compressed by Blosc, and the package numcodecs is not installed.
    ValueError
        If it is not a file of this kind, has no such grid or one of another kind, or is damaged.
    """
    try:
        file = _Reader(path.read_bytes())
        found = _grids(file, names)
    except (struct.error, IndexError, UnicodeDecodeError, zlib.error) as error:
        raise ValueError(f"{path} cannot be read: it is cut short or damaged ({error})") from error
    except ValueError as error:
        raise ValueError(f"{path} cannot be read: {error}") from error
    first = found[names[0]].matrix
    for name, grid in found.items():
        if not np.array_equal(grid.matrix, first):
            raise ValueError(f"{path}: the grid {name!r} has another transform than {names[0]!r}")
    parts = [part for grid in found.values() for part in grid.parts]
    if not parts:
        raise ValueError(f"{path}: no voxel is active in {', '.join(map(repr, names))}")
    low = np.min([origin for origin, _ in parts], axis=0)
    high = np.max([np.add(origin, numbers.shape) for origin, numbers in parts], axis=0)
    try:
        grids = {
            name: SparseGrid(high - low, ((np.subtract(origin, low), part) for origin, part in grid.parts))
            for name, grid in found.items()
        }
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
    # Values lie in the middle of their cells.
    corners = np.array([low, high]) - 0.5
    scale = np.diag(first)[:3]
    if np.array_equal(first[:3, :3], np.diag(scale)) and (scale > 0).all():
        return grids, {"bounds": corners * scale + first[:3, 3]}
    return grids, {"bounds": corners, "transform": first}


def _grids(file: _Reader, names: tuple[str, ...]) -> dict[str, _Grid]:
    if file.one("q") != _MAGIC:
        raise ValueError("it does not begin as an OpenVDB file does")
    version = file.one("I")
    if version not in _VERSIONS:
        raise ValueError(f"it is of version {version}, expected one from {_VERSIONS[0]} to {_VERSIONS[-1]}")
    # The library's version, whether grids have offsets, and the UUID of the file.
    file.many("II")
    if not file.one("?"):
        raise ValueError("it is a stream, expected a file with offsets")
    file.take(36)
    _skip_metadata(file)
    found, seen = {}, []
    for _ in range(file.one("I")):
        name, kind, parent = file.text().split("\x1e")[0], file.text(), file.text()
        start, _, end = file.many("qqq")
        seen.append(name)
        if name in names and name not in found:
            if kind not in _FLOATS or parent:
                raise ValueError(f"the grid {name!r} is a {kind or parent}, expected floats")
            begin, file.place = file.place, start
            found[name] = _grid(file, kind.endswith("HalfFloat"))
            file.place = begin
        file.place = end
    for name in names:
        if name not in found:
            raise ValueError(f"it has no grid {name!r} among {', '.join(map(repr, seen)) or 'none'}")
    return found


def _grid(file: _Reader, is_half: bool) -> _Grid:
    compression = file.one("I")
    _skip_metadata(file)
    matrix = _transform(file)
    if file.one("I") != 1:
        raise ValueError("a tree has several buffers")
    background = file.one("f")
    if background != 0:
        raise ValueError(f"a grid is {background:g} where nothing is active, expected 0")
    numbers = _Numbers(file, compression, is_half)
    tiles, children = file.many("II")
    parts: list[Any] = []
    for _ in range(tiles):
        origin, value, active = file.many("iii"), file.one("f"), file.one("?")
        if active and value != 0:
            raise ValueError(f"a tile of 4096³ at {origin} is {value:g}")
    # The topology of all nodes comes first, then the values of leaves in the same order.
    leaves: list[tuple[int, int, int]] = []
    for _ in range(children):
        _node(file, numbers, file.many("iii"), 0, leaves, parts)
    for leaf in leaves:
        mask = file.take(64)
        parts.append((leaf, numbers.read(_LEAF**3, mask).reshape(_LEAF, _LEAF, _LEAF)))
    return _Grid(matrix, parts)


def _node(
    file: _Reader, numbers: _Numbers, origin: Any, level: int, leaves: list[Any], parts: list[Any]
) -> None:
    """Read what is in a node, but for the numbers of its leaves: those come later."""
    power, side = _LEVELS[level]
    count = 1 << (3 * power)
    children, active = file.take(count // 8), file.take(count // 8)
    values = numbers.read(count, active)
    tiles = values * ~_bits(children)
    if np.count_nonzero(tiles) * side**3 > _MOST:
        raise ValueError(f"it has {np.count_nonzero(tiles)} tiles of {side}³ that are not 0")
    for index in np.flatnonzero(tiles):
        parts.append((_corner(origin, index, power, side), np.broadcast_to(tiles[index], (side,) * 3)))
    for index in np.flatnonzero(_bits(children)):
        corner = _corner(origin, index, power, side)
        if level + 1 < len(_LEVELS):
            _node(file, numbers, corner, level + 1, leaves, parts)
        else:
            file.take(64)
            leaves.append(corner)


def _corner(origin: Any, index: Any, power: int, side: int) -> tuple[int, int, int]:
    places = (int(index) >> (2 * power), int(index) >> power, int(index))
    x, y, z = (
        begin + (place & ((1 << power) - 1)) * side for begin, place in zip(origin, places, strict=True)
    )
    return x, y, z


def _bits(mask: bytes) -> NDArray[np.bool_]:
    return np.unpackbits(np.frombuffer(mask, np.uint8), bitorder="little").astype(bool)


def _transform(file: _Reader) -> NDArray[np.float64]:
    """Return the matrix that takes the places of numbers to the world."""
    kind = file.text()
    matrix = np.eye(4)
    if kind in ("UniformScaleMap", "ScaleMap"):
        matrix[[0, 1, 2], [0, 1, 2]] = file.many("15d")[:3]
    elif kind in ("UniformScaleTranslateMap", "ScaleTranslateMap"):
        told = file.many("18d")
        matrix[:3, 3], matrix[[0, 1, 2], [0, 1, 2]] = told[:3], told[3:6]
    elif kind == "TranslationMap":
        matrix[:3, 3] = file.many("3d")
    elif kind in ("AffineMap", "UnitaryMap"):
        # The file stores matrices for row vectors.
        matrix = np.array(file.many("16d")).reshape(4, 4).T
    else:
        raise ValueError(f"its transform is a {kind}, expected an affine one")
    return matrix


def _skip_metadata(file: _Reader) -> None:
    for _ in range(file.one("I")):
        for _ in range(2):
            file.text()
        file.take(file.one("I"))


class _Reader:
    """Bytes from first to last."""

    def __init__(self, data: bytes) -> None:
        self._data = memoryview(data)
        self.place = 0

    def take(self, count: int) -> bytes:
        if count < 0 or self.place < 0 or self.place + count > len(self._data):
            raise IndexError(f"{count} bytes at {self.place}, of {len(self._data)}")
        self.place += count
        return bytes(self._data[self.place - count : self.place])

    def many(self, kinds: str) -> tuple[Any, ...]:
        return struct.unpack(f"<{kinds}", self.take(struct.calcsize(f"<{kinds}")))

    def one(self, kind: str) -> Any:
        return self.many(kind)[0]

    def text(self) -> str:
        return self.take(self.one("I")).decode("utf-8")


class _Numbers:
    """The numbers of nodes, in which inactive ones may be left out, and the rest compressed."""

    def __init__(self, file: _Reader, compression: int, is_half: bool) -> None:
        self._file = file
        self._is_masked = bool(compression & _ACTIVE_MASK)
        self._type = np.dtype("<f2" if is_half else "<f4")
        self._unpack: Callable[[bytes, int], bytes] | None = None
        if compression & _BLOSC:
            self._unpack = _blosc
        elif compression & _ZIP:
            self._unpack = _unzipped

    def read(self, count: int, active: bytes) -> NDArray[np.float32]:
        """Return the numbers of a node, active ones from the file, the others by its rule."""
        file = self._file
        said = file.one("b")
        rest = [np.float32(0), np.float32(0)]
        if said in (_ONE_VALUE, _MASK_AND_ONE, _MASK_AND_TWO):
            rest[0] = np.float32(file.one("f"))
        if said == _MASK_AND_TWO:
            rest[1] = np.float32(file.one("f"))
        chosen = file.take(count // 8) if said in (_MASK, _MASK_AND_ONE, _MASK_AND_TWO) else None
        if not self._is_masked or said == _ALL:
            return self._data(count)
        is_active = _bits(active)
        if chosen is None:
            found = np.full(count, rest[0], np.float32)
        else:
            found = np.where(_bits(chosen), rest[1], rest[0]).astype(np.float32)
        found[is_active] = self._data(int(np.count_nonzero(is_active)))
        return found

    def _data(self, count: int) -> NDArray[np.float32]:
        size = count * self._type.itemsize
        # Empty arrays of half precision are not written at all.
        if size == 0 and self._type.itemsize == 2:
            return np.empty(0, np.float32)
        if self._unpack is None:
            data = self._file.take(size)
        else:
            packed = self._file.one("q")
            # A negative size marks data that compression would not shrink.
            data = self._file.take(-packed) if packed <= 0 else self._unpack(self._file.take(packed), size)
        if len(data) != size:
            raise ValueError(f"a node has {len(data)} bytes, expected {size}")
        return np.frombuffer(data, self._type).astype(np.float32)


def _unzipped(data: bytes, size: int) -> bytes:
    return zlib.decompressobj().decompress(data, size)


def _blosc(data: bytes, size: int) -> bytes:
    """Decompress one chunk of Blosc 1, whose header states `size` bytes."""
    try:
        codec = importlib.import_module("numcodecs.blosc").Blosc()
    except ImportError as error:
        raise ImportError(
            "this OpenVDB file is compressed by Blosc, which wants: pip install 'raywright[vdb]'"
        ) from error
    # Sizes before and after. The decoder trusts the header and would read and write that far.
    if len(data) < 16 or struct.unpack_from("<I4xI", data, 4) != (size, len(data)):
        raise ValueError(f"a node is not a Blosc chunk of {size} bytes")
    if size == 0:
        # OpenVDB writes empty chunks, which the decoder rejects.
        return b""
    try:
        return bytes(codec.decode(data))
    except Exception as error:
        raise ValueError(f"a node cannot be decompressed: {error}") from error
