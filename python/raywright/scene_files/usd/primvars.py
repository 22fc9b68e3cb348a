"""Primvars of a USD stage: values at the corners of faces, or the same everywhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .reading import Reading

Floats = NDArray[np.float64]


def found(prim: Any, name: str) -> Any:
    """Return a primvar with values, of the prim or inherited; None if there is none."""
    from pxr import UsdGeom

    primvar = UsdGeom.PrimvarsAPI(prim).FindPrimvarWithInheritance(name)
    return primvar if primvar and primvar.HasValue() else None


def constant(prim: Any, name: str, reading: Reading, columns: int) -> Floats | None:
    """Return the value of a primvar for all of a prim, (columns,): the mean, which is noted, if it varies."""
    primvar = found(prim, name)
    if primvar is None:
        return None
    values = _values(primvar, reading, columns)
    if not len(values):
        return None
    if len(values) > 1 and (values != values[0]).any():
        reading.notes.tell(f"a {name} that varies over a {prim.GetTypeName()} is taken as its mean")
    return np.asarray(values.mean(axis=0))


class Corners:
    """The corners of the faces of a mesh, and values at them.

    Parameters
    ----------
    prim : Usd.Prim
        The mesh.
    reading : Reading
        The stage.
    counts, indices : int arrays
        Number of corners of each face, and their points.
    """

    def __init__(
        self, prim: Any, reading: Reading, counts: NDArray[np.int64], indices: NDArray[np.int64]
    ) -> None:
        self._prim, self._reading, self._counts, self._indices = prim, reading, counts, indices

    def primvar(self, name: str, columns: int) -> Floats | None:
        """Return a primvar at each corner, (C, columns); None if there is none, or if it does not fit."""
        primvar = found(self._prim, name)
        if primvar is None:
            return None
        values = _values(primvar, self._reading, columns)
        return self._at_corners(name, values, str(primvar.GetInterpolation())) if len(values) else None

    def normals(self, mesh: Any) -> Floats | None:
        """Return the normal at each corner, (C, 3); None if there is none, or if they do not fit."""
        primvar = found(self._prim, "normals")
        if primvar is not None:
            return self.primvar("normals", 3)
        values = rows("normals", self._reading.value(mesh.GetNormalsAttr()), 3)
        return (
            self._at_corners("normals", values, str(mesh.GetNormalsInterpolation())) if len(values) else None
        )

    def _at_corners(self, name: str, values: Floats, how: str) -> Floats | None:
        if how == "constant":
            at = np.zeros(len(self._indices), np.int64)
        elif how == "uniform":
            at = np.repeat(np.arange(len(self._counts)), self._counts)
        elif how == "faceVarying":
            at = np.arange(len(self._indices))
        else:
            at = self._indices
        if len(at) and at.max() >= len(values):
            self._reading.notes.tell(f"{name} of meshes that have too few values are left out")
            return None
        return values[at]


def _values(primvar: Any, reading: Reading, columns: int) -> Floats:
    return rows(str(primvar.GetPrimvarName()), primvar.ComputeFlattened(reading.time), columns)


def rows(name: str, given: Any, columns: int) -> Floats:
    """Return values as rows of numbers, (N, columns).

    Raises
    ------
    ValueError
        If they are something else.
    """
    try:
        values = np.array(() if given is None else given, np.float64)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name} must be rows of {columns} numbers") from error
    # A single value counts as an array of one.
    if values.shape == (columns,) or (columns == 1 and values.ndim < 2):
        values = values.reshape(-1, columns)
    if values.size and (values.ndim != 2 or values.shape[1] != columns):
        raise ValueError(f"{name} must be rows of {columns} numbers, got shape {values.shape}")
    return values.reshape(-1, columns)
