"""PLY files (Turk, "The PLY Polygon File Format", 1994) of meshes with all their values."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .exported import face_values, srgb

_TYPES = {
    "b1": "uchar",
    "i1": "char",
    "u1": "uchar",
    "i2": "short",
    "u2": "ushort",
    "i4": "int",
    "u4": "uint",
    "f4": "float",
    "f8": "double",
}
# Property names with a meaning of their own, if a whole row is present.
_MEANINGS = (
    *(("x", "y", "z"), ("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z")),
    *(("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t")),
    *(("red", "green", "blue"), ("r", "g", "b"), ("diffuse_red", "diffuse_green", "diffuse_blue")),
    *(("vertex_index",), ("vertex_indices",), ("texcoord",)),
)

Column = tuple[str, NDArray[Any]]


def write_ply(mesh: Any, path: Path) -> None:
    """Write a mesh with its normals, coordinates, colors, attributes and cells as bytes.

    Raises
    ------
    ValueError
        If an attribute has the name of something else in PLY files, or integers that no type of PLY holds.
    """
    vertices: list[Column] = _named(mesh.vertices, ("x", "y", "z"))
    vertices += [] if mesh.normals is None else _named(mesh.normals, ("nx", "ny", "nz"))
    vertices += [] if mesh.uv is None else _named(mesh.uv, ("u", "v"))
    if mesh.colors is not None:
        vertices += _named(srgb(mesh.colors).astype(np.float32), ("red", "green", "blue"))
    vertices += _columns("vertex_attributes", mesh.vertex_attributes, vertices)
    faces: list[Column] = [("vertex_indices", np.asarray(mesh.faces))]
    faces += _columns("face_attributes", face_values(mesh), faces)
    header = ["ply", "format binary_little_endian 1.0"]
    header += [f"element vertex {len(mesh.vertices)}", *map(_property, vertices)]
    header += [f"element face {len(mesh.faces)}", *map(_property, faces), "end_header\n"]
    with path.open("wb") as file:
        file.write("\n".join(header).encode())
        file.write(_rows(vertices, len(mesh.vertices)).tobytes())
        file.write(_rows(faces, len(mesh.faces)).tobytes())


def _named(array: NDArray[Any], names: tuple[str, ...]) -> list[Column]:
    return [(name, array[:, k]) for k, name in enumerate(names)]


def meant(names: Iterable[str]) -> set[str]:
    """Return which of the properties of an element, in small letters, have a meaning of their own."""
    known = set(names)
    found = {name for row in _MEANINGS if known.issuperset(row) for name in row}
    return found | ({"alpha"} & known if "red" in found else set())


def _columns(what: str, attributes: Any, others: list[Column]) -> list[Column]:
    """Return attributes as columns; of those with several numbers per row, one each."""
    found: list[Column] = []
    told = [name for name, _ in others]
    for name, array in attributes.items():
        flat = (
            array.reshape(len(array), -1) if len(array) else array.reshape(0, int(np.prod(array.shape[1:])))
        )
        plain = re.sub(r"\s+", "_", name.strip())
        names = [plain] if array.ndim == 1 else [f"{plain}_{k}" for k in range(flat.shape[1])]
        for k, one in enumerate(names):
            if not one or one.lower() in told or meant([*told, one.lower()]) & {one.lower()}:
                raise ValueError(f"{what} has {name!r}, which is a reserved name in a PLY file")
            told.append(one.lower())
            found.append((one, _held(f"{what}[{name!r}]", flat[:, k])))
    return found


def _held(what: str, column: NDArray[Any]) -> NDArray[Any]:
    """Return numbers as a type that PLY files have."""
    if column.dtype.str[1:] in _TYPES:
        return column
    if column.dtype.kind == "f":
        return column.astype(np.float32 if column.dtype.itemsize < 4 else np.float64)
    for kind in (np.int32, np.uint32):
        limits = np.iinfo(kind)
        if not len(column) or (int(column.min()) >= limits.min and int(column.max()) <= limits.max):
            return column.astype(kind)
    raise ValueError(f"{what} must be between -2^31 and 2^32 - 1 in a PLY file, got up to {column.max()}")


def _property(column: Column) -> str:
    name, array = column
    kind = _TYPES[array.dtype.str[1:]]
    return f"property list uchar {kind} {name}" if array.ndim == 2 else f"property {kind} {name}"


def _rows(columns: list[Column], count: int) -> NDArray[Any]:
    """Return the rows of an element."""
    fields: list[Any] = []
    for k, (_, array) in enumerate(columns):
        code = "u1" if array.dtype.kind == "b" else f"<{array.dtype.str[1:]}"
        if array.ndim == 2:
            fields += [(f"count{k}", "u1"), (f"value{k}", code, array.shape[1])]
        else:
            fields.append((f"value{k}", code))
    rows = np.zeros(count, np.dtype(fields))
    for k, (_, array) in enumerate(columns):
        rows[f"value{k}"] = array
        if array.ndim == 2:
            rows[f"count{k}"] = array.shape[1]
    return rows
