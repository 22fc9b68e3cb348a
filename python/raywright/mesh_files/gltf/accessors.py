"""Numbers of a glTF file: arrays from its accessors (glTF 2.0, 3.6.2)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .document import Document
from .part import Part

_KINDS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_INDICES = ("|u1", "<u2", "<u4")
# Most bytes of zeros that an accessor without data may have.
_MOST_ZEROS = 2**27


class Accessors:
    """The arrays of a document, each checked to lie within its view, and read as it is asked for."""

    def __init__(self, document: Document) -> None:
        self._document = document
        self._all = document.root.parts("accessors")
        self._read: dict[int, NDArray[Any]] = {}
        self._decompressed: dict[int, NDArray[Any]] = {}

    def hold(self, part: Part, name: str, array: NDArray[Any]) -> None:
        """Take the numbers of the accessor that a part names from elsewhere: an (N, columns) array."""
        accessor = self._named(part, name)
        expected = (accessor.integer("count", least=1), _columns(accessor))
        if array.shape != expected:
            raise ValueError(f"{accessor.place} has {expected} numbers, and {array.shape} are compressed")
        self._decompressed[accessor.index] = array.astype(_kind(accessor), copy=False)

    def vectors(self, part: Part, name: str, *columns: int) -> NDArray[np.floating[Any]]:
        """Return the (N, columns) finite numbers of the accessor that a part names.

        They are float32 as in the file, or float64 if stored as integers. (N, 16) are matrices, column by
        column.
        """
        accessor = self._named(part, name)
        # Some programs share vertices among thousands of primitives.
        if accessor.index not in self._read:
            array = self._array(accessor)
            if array.dtype.kind != "f":
                array = _shared(array, accessor.flag("normalized"))
            finite = np.isfinite(array)
            if not finite.all():
                row = int(np.argmin(finite.all(axis=1)))
                raise ValueError(f"{accessor.place}, {name}, holds NaN or infinity in element {row}")
            self._read[accessor.index] = array
        array = self._read[accessor.index]
        if array.shape[1] not in columns:
            wanted = " or ".join(map(str, columns))
            raise ValueError(f"{accessor.place} must have {wanted} numbers an element for {name}")
        return array

    def integers(self, part: Part, name: str, columns: int = 1) -> NDArray[np.unsignedinteger[Any]]:
        """Return the (N, columns) unsigned integers of the accessor that a part names."""
        accessor = self._named(part, name)
        array = self._array(accessor)
        if array.dtype.kind != "u" or array.shape[1] != columns:
            raise ValueError(f"{accessor.place} must be unsigned integers, {columns} an element, for {name}")
        return array

    def _named(self, part: Part, name: str) -> Part:
        return self._all[part.reference(name, "accessors", len(self._all))]

    def _array(self, accessor: Part) -> NDArray[Any]:
        kind, columns = _kind(accessor), _columns(accessor)
        count = accessor.integer("count", least=1)
        if accessor.index in self._decompressed:
            array = self._decompressed[accessor.index]
        elif "bufferView" in accessor:
            array = self._elements(accessor, kind, columns, count)
        elif count * columns * kind.itemsize > _MOST_ZEROS:
            raise ValueError(f"{accessor.place} has {count} elements without data in the file")
        else:
            array = np.zeros((count, columns), kind)
        if "sparse" in accessor:
            array = self._replaced(array, accessor.part("sparse"))
        return array

    def _elements(self, part: Part, kind: np.dtype[Any], columns: int, count: int) -> NDArray[Any]:
        """Return so many elements of the view that a part names, without a copy."""
        view, stride = self._document.view(part)
        start = part.integer("byteOffset", 0)
        size = kind.itemsize * columns
        step = size if stride is None else stride
        if step < size:
            raise ValueError(f"{part.place} has elements of {size} bytes, {step} apart")
        end = start + (count - 1) * step + size
        if end > len(view):
            raise ValueError(f"{part.place} ends at byte {end} of a view of {len(view)}")
        return np.ndarray((count, columns), kind, view, start, (step, kind.itemsize))

    def _replaced(self, array: NDArray[Any], sparse: Part) -> NDArray[Any]:
        """Return an array some of whose elements are others (3.6.2.3)."""
        count = sparse.integer("count", least=1, most=len(array))
        places, values = sparse.part("indices"), sparse.part("values")
        kind = _kind(places)
        if kind.str not in _INDICES:
            raise ValueError(f"{places.place} must be unsigned integers")
        rows = self._elements(places, kind, 1, count)[:, 0].astype(np.int64)
        if rows.max() >= len(array):
            raise ValueError(f"{places.place} holds {rows.max()}, and there are {len(array)} elements")
        result = array.copy()
        result[rows] = self._elements(values, array.dtype, array.shape[1], count)
        return result


def _kind(part: Part) -> np.dtype[Any]:
    code = part.integer("componentType")
    if code not in _KINDS:
        raise ValueError(f"{part.at('componentType')} must be one of {', '.join(map(str, _KINDS))}: {code}")
    return np.dtype(_KINDS[code])


def _columns(accessor: Part) -> int:
    name = accessor.text("type")
    if name not in _COLUMNS:
        raise ValueError(f"{accessor.at('type')} must be one of {', '.join(_COLUMNS)}: {name[:20]!r}")
    return _COLUMNS[name]


def _shared(array: NDArray[Any], normalized: bool) -> NDArray[np.float64]:
    """Return what integers stand for: themselves, or shares of the greatest of their kind (3.6.2.2)."""
    numbers = array.astype(np.float64)
    return np.maximum(numbers / np.iinfo(array.dtype).max, -1.0) if normalized else numbers
