"""Values of vertices and faces of PLY files, by name."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...shapes.ply_writer import meant
from ..elements import Data

_PART = re.compile(r"(.+)_(\d+)")


def attributes(data: Data) -> dict[str, NDArray[Any]]:
    """Return the numbers of an element that have no other meaning.

    Properties ``name_0``, ``name_1``, ... of one type are one attribute.
    """
    taken = meant(name.lower() for name in data.numbers)
    own = {name: values for name, values in data.numbers.items() if name.lower() not in taken}
    found: dict[str, NDArray[Any]] = {}
    for name in own:
        told = _PART.fullmatch(name)
        parts = _parts(own, told[1]) if told else []
        if told is None or len(parts) < 2 or int(told[2]) >= len(parts) or told[1] in own:
            found[name] = own[name]
        elif told[2] == "0":
            found[told[1]] = np.stack(parts, axis=1)
    return found


def _parts(own: dict[str, NDArray[Any]], name: str) -> list[NDArray[Any]]:
    """Return columns with a name and a number, from 0 to the first that is missing or of another type."""
    parts: list[NDArray[Any]] = []
    while (part := own.get(f"{name}_{len(parts)}")) is not None:
        if parts and part.dtype != parts[0].dtype:
            return []
        parts.append(part)
    return parts
