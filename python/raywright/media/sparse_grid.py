"""Numbers on a grid that is mostly empty."""

from __future__ import annotations

import operator
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol, final

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _core
from ..arrays import real_array

# Points of a block along each axis.
BLOCK = 8


class Sliced(Protocol):
    """An object with a shape that gives its slabs by slices, as arrays and datasets of h5py and zarr do."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Three axes, or four, the last with three entries."""

    def __getitem__(self, slab: slice, /) -> Any:
        """Give some planes across the first axis."""


@final
class SparseGrid:
    """A sparse grid: numbers on a regular grid, in which zeros take next to no memory.

    Blocks of 8 by 8 by 8 points that are all 0 are not kept. `GridMedium` takes it in place of an array, and
    the compiled scene uses its blocks directly: 512³ numbers above 0 take 541 MB in all, half of an array and
    its copy.

    Parameters
    ----------
    shape : 3 or 4 int
        (X, Y, Z), the first axis being x, or (X, Y, Z, 3) for a number each of red, green and blue.
    parts : iterable of (3 int, array)
        Origins of parts, with their numbers, finite and at least 0, which are kept as float32. Later parts
        overwrite earlier ones; the rest is 0.

    Raises
    ------
    ValueError
        If a part reaches beyond the grid, a number is negative or not finite, or something has another shape.
    TypeError
        If numbers are not real.

    See Also
    --------
    GridMedium : Takes it.
    SparseGrid.of : The grid of an array.

    Examples
    --------
    >>> grid = rw.media.SparseGrid((64, 64, 64), [((8, 8, 8), np.ones((4, 4, 4)))])
    >>> grid.shape, grid.max(), grid.nbytes < 64**3 * 4
    ((64, 64, 64), 1.0, True)
    """

    __slots__ = ("_blocks", "shape")

    shape: tuple[int, ...]

    def __init__(self, shape: Sequence[int], parts: Iterable[tuple[Sequence[int], ArrayLike]] = ()) -> None:
        self.shape = _shape("shape", shape)
        self._blocks = _core.GridBlocks(self.shape[:3], len(self.shape) == 4, self._checked(parts))

    def _checked(
        self, parts: Iterable[tuple[Sequence[int], ArrayLike]]
    ) -> Iterator[tuple[tuple[int, ...], NDArray[np.float32]]]:
        for origin, numbers in parts:
            found = real_array("numbers", numbers)
            if found.ndim != len(self.shape) or found.shape[3:] != self.shape[3:]:
                raise ValueError(f"numbers of a grid of shape {self.shape} cannot have shape {found.shape}")
            begins = _integers("origin of a part", origin)
            if len(begins) != 3 or any(
                a < 0 or a + n > most for a, n, most in zip(begins, found.shape, self.shape, strict=False)
            ):
                raise ValueError(
                    f"a part of shape {found.shape} at {begins} is outside the grid of shape {self.shape}"
                )
            # Overflow to infinity is reported later.
            with np.errstate(over="ignore"):
                yield begins, np.ascontiguousarray(found, np.float32)

    @classmethod
    def of(cls, numbers: ArrayLike | Sliced) -> SparseGrid:
        """Return the sparse grid of an array, read a few planes at a time.

        Parameters
        ----------
        numbers : array_like, or object with a shape that gives slabs by slices
            (X, Y, Z) or (X, Y, Z, 3), finite and at least 0: an array, a memory map such as
            ``np.load(path, mmap_mode="r")``, or a dataset of h5py or zarr.

        Returns
        -------
        SparseGrid

        Raises
        ------
        ValueError
            If it is empty or of another shape, or a number is negative or not finite.
        TypeError
            If numbers are not real.

        See Also
        --------
        SparseGrid.dense : The inverse.

        Examples
        --------
        >>> numbers = np.zeros((32, 32, 32))
        >>> numbers[3, 4, 5] = 2.0
        >>> grid = rw.media.SparseGrid.of(numbers)
        >>> grid.max(), len(list(grid.parts))
        (2.0, 1)
        """
        sliced: Any = numbers if hasattr(numbers, "shape") else real_array("numbers", numbers)
        _shape("numbers", sliced.shape)
        slabs = (((x, 0, 0), sliced[x : x + BLOCK]) for x in range(0, sliced.shape[0], BLOCK))
        return cls(sliced.shape, slabs)

    @property
    def nbytes(self) -> int:
        """The memory held."""
        return self._blocks.bytes()

    @property
    def parts(self) -> Iterator[tuple[tuple[int, int, int], NDArray[np.float32]]]:
        """Origins of the blocks that are not all 0, with their numbers."""
        for low, high in self._blocks.kept().tolist():
            size = [b - a for a, b in zip(low, high, strict=True)]
            yield tuple(low), self._blocks.part(low, high).reshape(*size, *self.shape[3:])

    def dense(self) -> NDArray[np.float32]:
        """Return all numbers as an array.

        Returns
        -------
        (X, Y, Z) or (X, Y, Z, 3) float32 array

        See Also
        --------
        SparseGrid.of : The inverse.

        Examples
        --------
        >>> grid = rw.media.SparseGrid((9, 9, 9), [((1, 1, 1), np.ones((1, 1, 2)))])
        >>> np.argwhere(grid.dense()).tolist()
        [[1, 1, 1], [1, 1, 2]]
        """
        return self._blocks.part((0, 0, 0), self.shape[:3]).reshape(self.shape)

    def max(self) -> float:
        """Return the greatest number.

        Returns
        -------
        float

        Examples
        --------
        >>> rw.media.SparseGrid((9, 9, 9)).max()
        0.0
        """
        return self._blocks.greatest()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError("a sparse grid cannot become an array without a copy")
        return self.dense().astype(dtype or np.float32, copy=False)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, SparseGrid):
            return NotImplemented
        return self.shape == other.shape and self._blocks.same(other._blocks)

    def __hash__(self) -> int:
        return hash((self.shape, self.nbytes, self.max()))

    def __reduce__(self) -> tuple[Any, ...]:
        return SparseGrid, (self.shape, list(self.parts))

    def __repr__(self) -> str:
        return f"SparseGrid(<{' x '.join(map(str, self.shape))}>, {self.nbytes / 1e6:.3g} MB)"


def _shape(name: str, given: Sequence[int]) -> tuple[int, ...]:
    shape = _integers(name, given)
    if len(shape) not in (3, 4) or shape[3:] not in ((), (3,)) or min(shape) < 1:
        kind = "be" if name == "shape" else "have shape"
        raise ValueError(f"{name} must {kind} (X, Y, Z) or (X, Y, Z, 3), and not be empty, got {shape}")
    return shape


def _integers(name: str, given: Sequence[int]) -> tuple[int, ...]:
    try:
        return tuple(operator.index(n) for n in given)
    except TypeError:
        raise TypeError(f"{name} must be integers, got {given!r}") from None
