"""Copies of a USD stage: point instancers."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...scene.instance import Instance
from .lights import is_light
from .notes import told_of
from .reading import Reading, numbers, seen
from .shapes import shapes


def placed(prim: Any, reading: Reading, matrix: NDArray[np.float64]) -> list[Any]:
    """Return the shapes that a prim is, or the copies that it places; none if it is something else."""
    from pxr import UsdGeom

    if prim.IsA(UsdGeom.PointInstancer):
        return list(_copies(UsdGeom.PointInstancer(prim), reading, matrix))
    return shapes(prim, reading, matrix)


def _copies(instancer: Any, reading: Reading, matrix: NDArray[np.float64]) -> list[Instance]:
    """Return the copies that a point instancer places where a matrix puts it, but for those that it hides."""
    from pxr import UsdGeom

    stage = instancer.GetPrim().GetStage()
    targets = instancer.GetPrototypesRel().GetTargets()
    which = numbers(
        reading.value(instancer.GetProtoIndicesAttr()), len(targets), "protoIndices has prototypes"
    )
    positions = reading.value(instancer.GetPositionsAttr(), ())
    if len(positions) != len(which):
        raise ValueError(f"it has {len(which)} protoIndices, but {len(positions)} positions")
    kind = UsdGeom.PointInstancer
    places = instancer.ComputeInstanceTransformsAtTime(
        reading.time, reading.time, kind.IncludeProtoXform, kind.IgnoreMask
    )
    mask = np.array(instancer.ComputeMaskAtTime(reading.time), np.bool_)
    if not len(mask):
        mask = np.ones(len(which), np.bool_)
    found = []
    for number, path in enumerate(targets):
        root = stage.GetPrimAtPath(path)
        if not root:
            raise ValueError(f"there is no prototype {path}")
        # The matrix of each copy already includes the root's own transform.
        home = np.asarray(np.linalg.inv(reading.matrix(root)), np.float64)
        parts: list[Any] = []
        for prim in seen(root, reading):
            with told_of(prim):
                if is_light(prim):
                    reading.notes.tell("lights that are copied by instancers are left out")
                else:
                    parts += placed(prim, reading, home @ reading.matrix(prim))
        there = [
            matrix @ np.array(places[int(k)], np.float64).T for k in np.flatnonzero((which == number) & mask)
        ]
        if parts and there:
            found.append(Instance(parts, np.stack(there)))
    return found
