"""Mitsuba's own mesh files: ``serialized``, one or several meshes, each compressed by itself."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError

Floats = NDArray[np.float64]

_MAGIC = 0x041C
_NORMALS, _COORDINATES, _COLORS, _DOUBLE = 0x0001, 0x0002, 0x0008, 0x2000
# Longest name to read.
_LONGEST_NAME = 4096
# Zeros inflate a thousandfold, so a file may claim any size; a larger one is not a mesh.
_MOST = 2**33


class Stored(NamedTuple):
    """A mesh of a file: (V, 3), (F, 3), and if there are any (V, 3) normals and (V, 2) coordinates."""

    vertices: Floats
    faces: NDArray[np.int64]
    normals: Floats | None
    uv: Floats | None


def read_serialized(path: Path, index: int) -> Stored:
    """Read one mesh of a file of version 3 or 4, as Mitsuba 0.5 to 3 write them.

    Parameters
    ----------
    path : Path
        The file.
    index : int
        Index of the mesh, from 0.

    Raises
    ------
    ValueError
        If it is not a file of this kind, is of another version, is cut short, or has no such mesh.
    """
    data = path.read_bytes()
    try:
        return _mesh(data, _start(path, data, index), path)
    except (struct.error, zlib.error, IndexError) as error:
        raise SceneError(f"{path} is not a serialized mesh that can be read ({error})") from error


def _start(path: Path, data: bytes, index: int) -> tuple[int, int]:
    """Return where a mesh begins after its magic number, and the version."""
    magic, version = struct.unpack_from("<HH", data)
    if magic != _MAGIC:
        raise SceneError(f"{path} is not a serialized mesh")
    if version not in (3, 4):
        raise SceneError(f"{path} is a serialized mesh of version {version}; 3 and 4 are read")
    if index == 0:
        return 4, version
    # Offsets of all meshes are at the end of the file, followed by their number.
    (count,) = struct.unpack_from("<I", data, len(data) - 4)
    if not 0 <= index < count:
        raise SceneError(f"{path} has no mesh {index}: it has {count}")
    kind = "<Q" if version == 4 else "<I"
    size = struct.calcsize(kind)
    (start,) = struct.unpack_from(kind, data, len(data) - 4 - size * (count - index))
    return start + 4, version


def _mesh(data: bytes, place: tuple[int, int], path: Path) -> Stored:
    start, version = place
    stream = _Inflated(data[start:], path)
    (flags,) = stream.unpack("<I")
    if version == 4:
        for _ in range(_LONGEST_NAME):
            if stream.take(1) == b"\0":
                break
    vertex_count, face_count = stream.unpack("<QQ")
    number = np.dtype("<f8" if flags & _DOUBLE else "<f4")
    vertices = stream.array(number, vertex_count, 3)
    normals = stream.array(number, vertex_count, 3) if flags & _NORMALS else None
    uv = stream.array(number, vertex_count, 2) if flags & _COORDINATES else None
    if flags & _COLORS:
        stream.array(number, vertex_count, 3)
    faces = stream.array(np.dtype("<u4"), face_count, 3).astype(np.int64)
    if len(faces) and faces.max() >= vertex_count:
        raise SceneError(f"{path} has {vertex_count} vertices, and a face of vertex {faces.max()}")
    return Stored(
        vertices.astype(np.float64),
        faces,
        None if normals is None else normals.astype(np.float64),
        None if uv is None else uv.astype(np.float64),
    )


class _Inflated:
    """Decompressed data, on demand."""

    def __init__(self, data: bytes, path: Path) -> None:
        self._inflate = zlib.decompressobj()
        self._left, self._path = data, path
        self._ready = b""

    def take(self, count: int) -> bytes:
        if count > _MOST:
            raise SceneError(f"{self._path} says that it holds {count} bytes in one piece")
        parts, held = [self._ready], len(self._ready)
        while held < count:
            part = self._inflate.decompress(self._left, max(count - held, 1 << 16))
            self._left = self._inflate.unconsumed_tail
            if not part:
                raise SceneError(f"{self._path} is cut short")
            parts.append(part)
            held += len(part)
        whole = b"".join(parts)
        self._ready = whole[count:]
        return whole[:count]

    def unpack(self, layout: str) -> tuple[int, ...]:
        return struct.unpack(layout, self.take(struct.calcsize(layout)))

    def array(self, number: np.dtype, rows: int, columns: int) -> NDArray:  # type: ignore[type-arg]
        data = self.take(number.itemsize * rows * columns)
        return np.frombuffer(data, number).reshape(rows, columns)
