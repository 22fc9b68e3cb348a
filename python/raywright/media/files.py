"""Numbers on grids from files."""

from __future__ import annotations

import struct
from collections.abc import Mapping
from os import PathLike, fspath
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..io.quiet import reason

Bounds = tuple[tuple[float, ...], tuple[float, ...]]
# Magic, version, encoding, size along x, y and z, channels, and the box: all little-endian.
_VOL = struct.Struct("<3sBiiiii6f")


class Found(NamedTuple):
    """Contents of a file: grids by purpose, bounds, and where in cells the numbers are."""

    grids: dict[str, Any]
    place: dict[str, Any]
    told: dict[str, Any]


def read_grids(path: str | PathLike[str], names: Mapping[str, str]) -> Found:
    """Return the grids of a file by purpose, each by one of these names, if the file has names.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ImportError
        If it wants a package that is not installed.
    ValueError
        If it cannot be read, and why.
    TypeError
        If the path is none.
    """
    if isinstance(path, str | PathLike) and Path(fspath(path)).suffix == ".vdb":
        # Imported here, because few files need it (import time).
        from .vdb import read_vdb

        grids, place = read_vdb(Path(fspath(path)), tuple(dict.fromkeys(names.values())))
        return Found({kind: grids[name] for kind, name in names.items()}, place, {"at": "centers"})
    if named := [kind for kind in names if kind != "density"]:
        raise ValueError(f"{named[0]} must be numbers: only OpenVDB's files have grids with names")
    density, bounds = read_density(path)
    if bounds is None:
        return Found({"density": density}, {}, {})
    return Found({"density": density}, {"bounds": bounds}, {"at": "centers"})


def read_density(path: str | PathLike[str]) -> tuple[NDArray[Any], Bounds | None]:
    """Return the numbers of a file, x first, and the box that it gives for them, if it gives one.

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it cannot be read, and why.
    TypeError
        If the path is none.
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path must be a str or a path, got {type(path).__name__}")
    name = Path(fspath(path))
    if name.suffix == ".vol":
        return read_vol(name)
    if name.suffix != ".npy":
        raise ValueError(f"{name} must be a .npy, a .vol or a .vdb file")
    try:
        # A memory map cannot exceed the file, whatever its header claims.
        array = np.load(name, mmap_mode="r", allow_pickle=False)
    except (OSError, MemoryError):
        raise
    except Exception as error:
        # numpy parses headers as Python literals, which raises any exception.
        raise ValueError(f"{name} cannot be read: {reason(error)}") from error
    if not isinstance(array, np.ndarray):
        raise ValueError(f"{name} holds several arrays, expected one")
    return np.array(array), None


def read_vol(name: Path) -> tuple[NDArray[np.float32], Bounds]:
    """Return the numbers of one of Mitsuba's grid volumes, x first, and the box that it gives for them.

    Of three channels they are (X, Y, Z, 3).

    Raises
    ------
    FileNotFoundError
        If there is no such file.
    ValueError
        If it is not a file of this kind, is of another version, or is cut short.
    """
    data = name.read_bytes()
    if len(data) < _VOL.size or data[:3] != b"VOL":
        raise ValueError(f"{name} cannot be read: it does not begin as a .vol file does")
    _, version, encoding, x, y, z, channels, *box = _VOL.unpack_from(data)
    if version != 3 or encoding != 1 or channels not in (1, 3):
        raise ValueError(
            f"{name} must be of version 3, float32 (1) and one or three channels, "
            f"got version {version}, encoding {encoding} and {channels} channels"
        )
    rest = len(data) - _VOL.size
    if min(x, y, z) < 1 or rest != 4 * x * y * z * channels:
        said = f"{x} x {y} x {z}" + f" x {channels}" * (channels > 1)
        raise ValueError(f"{name} says {said} numbers, but holds {rest / 4:g}")
    numbers = np.frombuffer(data, "<f4", offset=_VOL.size).reshape(z, y, x, channels)
    turned = numbers.transpose(2, 1, 0, 3)
    return turned if channels == 3 else turned[..., 0], (tuple(box[:3]), tuple(box[3:]))
