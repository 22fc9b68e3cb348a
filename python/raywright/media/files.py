"""Densities from files."""

import struct
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Bounds = tuple[tuple[float, ...], tuple[float, ...]]
# Magic, version, encoding, size along x, y and z, channels, and the box: all little-endian.
_VOL = struct.Struct("<3sBiiiii6f")


def read_density(path: str | PathLike[str]) -> tuple[NDArray[Any], Bounds | None]:
    """Return the numbers of a file, x first, and the box that it gives for them, if it gives one.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it cannot be read, and why.
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path must be a str or a path, got {type(path).__name__}")
    name = Path(fspath(path))
    if name.suffix == ".vol":
        return read_vol(name)
    if name.suffix != ".npy":
        raise ValueError(f"{name} must be a .npy or a .vol file")
    try:
        array = np.load(name, allow_pickle=False)
    except (ValueError, EOFError) as error:
        raise ValueError(f"{name} cannot be read: {error}") from error
    if not isinstance(array, np.ndarray):
        raise ValueError(f"{name} holds several arrays, expected one")
    return array, None


def read_vol(name: Path) -> tuple[NDArray[np.float32], Bounds]:
    """Return the numbers of one of Mitsuba's grid volumes, x first, and the box that it gives for them.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is no such file, is of another version, or is cut short.
    """
    data = name.read_bytes()
    if len(data) < _VOL.size or data[:3] != b"VOL":
        raise ValueError(f"{name} cannot be read: it does not begin as a .vol file does")
    _, version, encoding, x, y, z, channels, *box = _VOL.unpack_from(data)
    if version != 3 or encoding != 1 or channels != 1:
        raise ValueError(
            f"{name} must be of version 3, float32 (1) and one channel, "
            f"got version {version}, encoding {encoding} and {channels} channels"
        )
    rest = len(data) - _VOL.size
    if min(x, y, z) < 1 or rest != 4 * x * y * z:
        raise ValueError(f"{name} says {x} x {y} x {z} numbers, but holds {rest / 4:g}")
    numbers = np.frombuffer(data, "<f4", offset=_VOL.size).reshape(z, y, x)
    return numbers.transpose(2, 1, 0), (tuple(box[:3]), tuple(box[3:]))
