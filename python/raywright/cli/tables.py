"""Results of a measurement as a file: a table, arrays, or a mesh with values."""

from __future__ import annotations

import csv
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh

Columns = Mapping[str, NDArray[Any]]
SUFFIXES = (".csv", ".npy", ".npz", ".ply")


def write(path: Path | None, columns: Columns, value: NDArray[Any], mesh: Mesh) -> None:
    """Write a file of the kind that its suffix says; a table of CSV to stdout without a path.

    Parameters
    ----------
    path : Path, optional
        ``.csv`` and ``.npz`` have all columns by name, ``.npy`` has the value, ``.ply`` has the mesh.
    columns : dict of (N,) arrays
    value : array
    mesh : Mesh
        With the results as its attributes; without faces it is a cloud of points.
    """
    if path is None:
        _table(sys.stdout, columns)
        return
    suffix = path.suffix.lower()
    if suffix == ".csv":
        with path.open("w", encoding="utf-8", newline="") as file:
            _table(file, columns)
    elif suffix == ".npy":
        np.save(path, value)
    elif suffix == ".npz":
        arrays: dict[str, Any] = dict(columns)
        np.savez(path, **arrays)
    else:
        mesh.save(path)


def _table(file: Any, columns: Columns) -> None:
    rows = csv.writer(file, lineterminator="\n")
    rows.writerow(columns)
    # Python's own floats print the fewest digits that round-trip.
    rows.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
