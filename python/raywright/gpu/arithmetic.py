"""A test whether a device computes as WGSL promises."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_ULP = 2.0**-23
_LEAST = 2.0**-126
# Names for the results of probe.wgsl, in their order.
_CALLED = (
    *("a sum", "a difference", "a product", "a quotient"),
    *("a sum that cancels", "a minimum", "a maximum", "a magnitude"),
    *("a cross product", "a dot product", "an order", "a number that was held"),
)


def pairs(count: int = 8192, seed: int = 0) -> NDArray[np.float32]:
    """Return pairs of numbers, (count, 2): of all sizes, nearly equal, with tiny products, and equal to 0."""
    random = np.random.default_rng(seed)
    numbers = random.uniform(1, 2, (count, 2)) * random.choice([-1.0, 1.0], (count, 2))
    numbers *= 2.0 ** random.integers(-60, 60, (count, 2))
    part = count // 8
    close, near, tiny, zero = (slice(i * part, (i + 1) * part) for i in range(4))
    numbers[close, 1] = -numbers[close, 0] * (1 + random.integers(-8, 9, part) * _ULP)
    numbers[near, 0] = np.sign(numbers[near, 0]) * np.abs(numbers[near, 0]) ** 0.5
    numbers[near, 1] = numbers[near, 0] * 2.0 ** random.integers(-26, 27, part)
    numbers[tiny] *= 2.0**-60 / np.abs(numbers[tiny])
    numbers[tiny] *= 2.0 ** random.integers(-10, -1, (part, 2))
    numbers[zero, 0] = 0.0
    return np.asarray(numbers, np.float32)


def trouble(given: NDArray[np.float32], results: NDArray[np.float32]) -> str | None:
    """Return the error of a device that makes these results, (N, 12), of pairs; None if nothing is."""
    x, y = given.astype(np.float64).T
    sizes = np.abs(x), np.abs(y)
    exact = np.stack(
        [
            *(x + y, x - y, x * y, x / y),
            *(y, np.minimum(x, y), np.maximum(x, y), np.abs(x)),
            *(x - y * y, 2 * x * y + x, (x < y) + 2.0 * (x > y), x),
        ],
        axis=1,
    )
    zero = np.zeros_like(x)
    # Magnitudes of the rounded terms, in the worst order.
    allowed = np.stack(
        [
            *(np.abs(x + y), np.abs(x - y), np.abs(x * y), 2.5 * np.abs(x / y)),
            *(np.abs(x + y) + sizes[1] * 1.001, zero, zero, zero),
            *(2 * (sizes[0] + y * y), 3 * (2 * np.abs(x * y) + sizes[0]), zero, zero),
        ],
        axis=1,
    )
    # The relative 2⁻²⁰ and the last term cover the rounding of this check itself.
    room = allowed * _ULP * (1 + 2.0**-20) + np.where(allowed > 0, 4 * _LEAST, 0.0)
    with np.errstate(invalid="ignore"):
        wrong = ~(np.abs(results.astype(np.float64) - exact) <= room)
    if not wrong.any():
        return None
    row, column = (int(i[0]) for i in np.nonzero(wrong))
    return (
        f"{_CALLED[column]} of {x[row]:.9g} and {y[row]:.9g} is {results[row, column]:.9g}, "
        f"expected {exact[row, column]:.9g}"
    )
