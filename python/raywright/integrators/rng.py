"""Random numbers of a batch of samples."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import SeedLike, seed_number


class Rng:
    """The random numbers of a batch of samples: functions of seed, pixel, sample and dimension alone.

    Each call takes the next dimension for the whole batch, so a picture has the same bits for any division of
    its pixels and samples into batches, if the integrator makes the same calls in the same order.

    Parameters
    ----------
    seed : int, Generator or SeedSequence
        Seed of the picture.
    pixel, sample : (N,) uint32
        Pixel and sample index of each entry.

    See Also
    --------
    Integrator : Gets one for each batch.

    Examples
    --------
    >>> rng = rw.integrators.Rng(0, np.arange(4, dtype=np.uint32), np.zeros(4, np.uint32))
    >>> rng.next_1d().shape, rng.next_2d().shape
    ((4,), (4, 2))

    Batches may be split:

    >>> whole = rw.integrators.Rng(0, np.arange(4, dtype=np.uint32), np.zeros(4, np.uint32)).next_1d()
    >>> part = rw.integrators.Rng(0, np.arange(2, 4, dtype=np.uint32), np.zeros(2, np.uint32)).next_1d()
    >>> bool((part == whole[2:]).all())
    True
    """

    def __init__(self, seed: SeedLike, pixel: NDArray[np.uint32], sample: NDArray[np.uint32]) -> None:
        self._seed = seed_number(seed)
        self._pixel = pixel
        self._sample = sample
        self._dimension = 0

    def __len__(self) -> int:
        return len(self._pixel)

    def next_1d(self, which: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return a number in [0, 1), of 53 bits, for each entry: (N,), or (K,) for the entries in `which`.

        Parameters
        ----------
        which : (K,) integer or (N,) bool array, optional
            Entries of the batch; all if not given. A call with fewer entries takes the same dimensions.

        Returns
        -------
        (N,) or (K,) float64 array

        See Also
        --------
        Rng.next_2d : Pairs of numbers.

        Examples
        --------
        >>> rng = rw.integrators.Rng(7, np.zeros(3, np.uint32), np.arange(3, dtype=np.uint32))
        >>> numbers = rng.next_1d()
        >>> bool((0 <= numbers).all() and (numbers < 1).all())
        True
        >>> rng.next_1d([True, False, True]).shape
        (2,)
        """
        return self._next(which, False)

    def next_2d(self, which: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return two numbers in (0, 1), of 32 bits each, for each entry: (N, 2), or (K, 2) with `which`.

        Parameters
        ----------
        which : (K,) integer or (N,) bool array, optional
            As for `next_1d`.

        Returns
        -------
        (N, 2) or (K, 2) float64 array

        See Also
        --------
        Rng.next_1d : Single numbers.

        Examples
        --------
        >>> rng = rw.integrators.Rng(7, np.zeros(3, np.uint32), np.arange(3, dtype=np.uint32))
        >>> rng.next_2d().shape, rng.next_2d([0, 2]).shape
        ((3, 2), (2, 2))
        """
        return self._next(which, True)

    def _next(self, which: ArrayLike | None, pair: bool) -> NDArray[np.float64]:
        pixel, sample = self._pixel, self._sample
        if which is not None:
            chosen = np.asarray(which)
            pixel, sample = pixel[chosen], sample[chosen]
        dimension = self._dimension
        self._dimension += 1
        return _core.random_numbers(self._seed, pixel, sample, dimension, pair)

    def __repr__(self) -> str:
        return f"Rng({len(self)} samples, {self._dimension} dimensions taken)"
