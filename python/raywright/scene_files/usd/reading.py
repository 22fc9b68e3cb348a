"""State that all readers of a stage share."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..notes import Notes
from .pictures import Pictures

# Purposes of prims that are not rendered.
_UNSEEN = ("guide", "proxy")


@dataclass
class Reading:
    """A stage while it is read.

    Parameters
    ----------
    time : Usd.TimeCode
        When its values are looked up.
    notes : Notes
        Notes about the file.
    pictures : Pictures
        The pictures that it names.
    exposure : float
        Exposure factor of the camera.
    surfaces : dict
        Surfaces that have been read, by material.
    textures : dict
        Textures that have been made, by all that they are made of.
    unseen : Counter
        Number of skipped prims, by reason.
    """

    time: Any
    notes: Notes
    pictures: Pictures = field(default_factory=Pictures)
    exposure: float = 1.0
    surfaces: dict[Any, Any] = field(default_factory=dict)
    textures: dict[Any, Any] = field(default_factory=dict)
    unseen: Counter[str] = field(default_factory=Counter)
    _placed: Any = field(init=False)

    def __post_init__(self) -> None:
        from pxr import UsdGeom

        self._placed = UsdGeom.XformCache(self.time)

    def value(self, attribute: Any, default: Any = None) -> Any:
        """Return the value of an attribute at the time, or the default if it has none."""
        found = attribute.Get(self.time) if attribute else None
        return default if found is None else found

    def matrix(self, prim: Any) -> NDArray[np.float64]:
        """Return the (4, 4) matrix of a prim to the world, which acts on columns."""
        return np.array(self._placed.GetLocalToWorldTransform(prim), np.float64).T


def first_time(stage: Any) -> Any:
    """Return the time at which a stage starts: that of its first samples, if it does not say so."""
    from pxr import Usd

    if stage.HasAuthoredMetadata("startTimeCode"):
        return Usd.TimeCode(stage.GetStartTimeCode())
    return Usd.TimeCode.EarliestTime()


def seen(root: Any, reading: Reading) -> Iterator[Any]:
    """Yield a prim and those below it that are seen, those of instances too.

    Prims below a point instancer are passed over: it places copies of them.
    """
    from pxr import Usd, UsdGeom

    walk = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies()))
    for prim in walk:
        if prim.IsPseudoRoot():
            continue
        shown = UsdGeom.Imageable(prim)
        why = None
        if shown and reading.value(shown.GetVisibilityAttr()) == "invisible":
            why = "invisible"
        elif shown and (purpose := shown.GetPurposeAttr().Get()) in _UNSEEN:
            why = f"of purpose {purpose}"
        if why is not None:
            reading.unseen[why] += 1
            walk.PruneChildren()
            continue
        yield prim
        if prim.IsA(UsdGeom.PointInstancer):
            walk.PruneChildren()


def numbers(given: Any, count: int, what: str) -> NDArray[np.int64]:
    """Return `count` numbers of things."""
    found = np.array(() if given is None else given, np.int64).reshape(-1)
    if len(found) and not (found.min() >= 0 and found.max() < count):
        wrong = found[(found < 0) | (found >= count)][0]
        raise ValueError(f"{what} that are not there: number {wrong} of {count}")
    return found
