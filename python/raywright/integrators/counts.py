"""Parameters that integrators have in common."""

from __future__ import annotations

from ..arrays import integer, number

MOST_SAMPLES = 1024
MOST_PHOTONS = 2**31 - 1


def samples(name: str, value: int) -> int:
    """Return how often something is drawn at one point, 1 to 1024."""
    return integer(name, value, 1, MOST_SAMPLES)


def depth(name: str, value: int) -> int:
    """Return a number of bounces."""
    return integer(name, value, 0, 2**32 - 1)


def contribution(value: float) -> float:
    """Return the share of a pixel's light below which rays are not followed."""
    share = number("contribution", value)
    if not 0 <= share < 1:
        raise ValueError(f"contribution must be at least 0 and below 1, got {value!r}")
    return share
