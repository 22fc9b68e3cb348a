"""Where a measure is taken: the faces or the vertices of a mesh, or points of a file."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..query.surface_points import SurfacePoints
from ..scene.scene import Scene
from ..scene_files.mitsuba.mesh_files import smooth_normals
from ..shapes.mesh import Mesh

Floats: TypeAlias = NDArray[np.float64]
# File formats for tables of points.
SUFFIXES = (".csv", ".tsv", ".txt", ".xyz", ".npy", ".npz")
_PLACE, _NORMAL = ("x", "y", "z"), ("nx", "ny", "nz")


@dataclass(frozen=True)
class Sites:
    """Points at which something is measured, and their normals.

    Attributes
    ----------
    position, normal : (N, 3) float64
        NaN where there is none.
    exact : SurfacePoints or None
        The same points as those of a surface, which rays leave exactly.
    """

    position: Floats
    normal: Floats
    exact: SurfacePoints | None = None

    @property
    def known(self) -> NDArray[np.bool_]:
        """Mask of sites with a position and a normal: (N,)."""
        has_normal = np.isfinite(self.normal).all(axis=1) & (self.normal != 0).any(axis=1)
        return np.asarray(has_normal & np.isfinite(self.position).all(axis=1))


def of_faces(scene: Scene) -> Sites:
    """Return the middle of every face."""
    from ..measure.places import middles

    found = middles(scene)
    return Sites(found.position, found.normal, found)


def of_vertices(mesh: Mesh) -> Sites:
    """Return every vertex, with its own normal, or that of the faces around, weighted by their angles."""
    position = mesh.vertices.astype(np.float64)
    if mesh.normals is not None:
        return Sites(position, mesh.normals.astype(np.float64))
    faces = mesh.faces[np.isfinite(position[mesh.faces]).all(axis=(1, 2))]
    return Sites(position, smooth_normals(position, faces.astype(np.int64)))


def of_file(path: Path, scene: Scene, normal: Sequence[float] | None) -> Sites:
    """Return the points of a file, with its normals, the one given, or those of the nearest faces.

    Raises
    ------
    ValueError
        If the file is none of the kinds that are read, or has no columns x, y and z.
    OSError
        If it cannot be read.
    """
    position, own = _read(path)
    if normal is not None:
        own = np.broadcast_to(np.asarray(normal, np.float64), position.shape)
    return Sites(position, scene.closest_point(position).normal if own is None else own)


def _read(path: Path) -> tuple[Floats, Floats | None]:
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"{path}: points are read from {', '.join(SUFFIXES)}")
    if suffix == ".npy":
        return _columns(path, np.load(path))
    if suffix == ".npz":
        with np.load(path) as arrays:
            return _named(path, {name.lower(): arrays[name] for name in arrays.files})
    return _table(path)


def _columns(path: Path, array: NDArray[Any]) -> tuple[Floats, Floats | None]:
    """Return points and normals of a plain array: the first three columns, and three more if it has six."""
    if array.ndim != 2 or array.shape[1] < 3 or array.dtype.kind not in "iuf":
        raise ValueError(
            f"{path} must hold real numbers of shape (N, 3) or (N, 6), got {array.dtype} of {array.shape}"
        )
    numbers = array.astype(np.float64)
    return numbers[:, :3], numbers[:, 3:6] if array.shape[1] == 6 else None


def _named(path: Path, columns: dict[str, Any]) -> tuple[Floats, Floats | None]:
    """Return points and normals of columns by their names in small letters."""
    if not set(_PLACE) <= set(columns):
        told = ", ".join(columns) or "none"
        raise ValueError(f"{path} must have columns x, y, z (and nx, ny, nz for normals), got {told}")
    place = np.stack([np.asarray(columns[name], np.float64) for name in _PLACE], axis=-1)
    has_normals = set(_NORMAL) <= set(columns)
    normals = (
        np.stack([np.asarray(columns[name], np.float64) for name in _NORMAL], axis=-1)
        if has_normals
        else None
    )
    return place, normals


def _table(path: Path) -> tuple[Floats, Floats | None]:
    """Return points and normals of a text: with a heading by its names, without one by their order."""
    text = path.read_text(encoding="utf-8-sig")
    sign = next((sign for sign in "\t;," if sign in text.partition("\n")[0]), None)
    rows = csv.reader(text.splitlines(), delimiter=sign) if sign else (r.split() for r in text.splitlines())
    lines = [
        (number, row)
        for number, row in enumerate(rows, 1)
        if any(cell.strip() for cell in row) and not row[0].lstrip().startswith("#")
    ]
    if not lines:
        raise ValueError(f"{path} holds no points")
    heading = [cell.strip().strip('"').lower() for cell in lines[0][1]]
    if any(map(_is_number, heading)):
        width = len(heading)
        names = (*_PLACE, *_NORMAL)[: 6 if width == 6 else 3]
        heading = [*names, *map(str, range(width - len(names)))][:width]
    else:
        lines = lines[1:]
    wanted = [name for name in (*_PLACE, *_NORMAL) if name in heading]
    places = [heading.index(name) for name in wanted]
    numbers = [[_cell(path, number, row, at) for at in places] for number, row in lines]
    array = np.array(numbers, np.float64).reshape(len(lines), len(wanted))
    if not set(_PLACE) <= set(wanted):
        return _named(path, dict.fromkeys(heading))
    return _named(path, dict(zip(wanted, array.T, strict=True)))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _cell(path: Path, number: int, row: list[str], at: int) -> float:
    if at >= len(row) or not _is_number(row[at]):
        told = f"{row[at]!r}" if at < len(row) else f"{len(row)} columns"
        raise ValueError(f"{path}, line {number}: must have a number in column {at + 1}, got {told}")
    return float(row[at])
