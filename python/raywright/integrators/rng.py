"""Random numbers of a batch of samples."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import SeedLike, seed_number


class Rng:
    """The random numbers of a batch of samples: functions of seed, pixel, sample and dimension alone.

    Each call takes the next dimension for the whole batch, so a picture has the same bits however its pixels
    and samples are split into batches, as long as an integrator makes the same calls in the same order.

    Parameters
    ----------
    seed : int, Generator or SeedSequence
        That of the picture.
    pixel, sample : (N,) uint32
        Of which pixel each entry is a sample, and which of its samples.
    """

    def __init__(self, seed: SeedLike, pixel: NDArray[np.uint32], sample: NDArray[np.uint32]) -> None:
        self._seed = seed_number(seed)
        self._pixel = pixel
        self._sample = sample
        self._dimension = 0

    def __len__(self) -> int:
        return len(self._pixel)

    def one(self, which: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return a number in [0, 1), of 53 bits, for each entry: (N,), or (K,) for those that `which` picks.

        Parameters
        ----------
        which : (K,) integer or (N,) bool array, optional
            Entries of the batch; all if not given. Calls with fewer entries take as many dimensions.
        """
        return self._next(which, False)

    def two(self, which: ArrayLike | None = None) -> NDArray[np.float64]:
        """Return two numbers in (0, 1), of 32 bits each, for each entry: (N, 2), or (K, 2). As `one`."""
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
