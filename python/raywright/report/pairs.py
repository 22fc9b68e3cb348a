"""Families of (ray, triangle) pairs that a routine is tried on: the ordinary, and the extremes of scenes.

In each family half of the rays hit and half miss, as far as float32 can aim: up to eight times as many pairs
are drawn as are wanted, and a rough decision in float64 chooses among them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Pairs drawn at a time, and the most drawn, as a multiple of those wanted.
_BATCH = 4096
_PATIENCE = 8

Array = NDArray[np.float64]
Generator = np.random.Generator


@dataclass(frozen=True, eq=False)
class Pairs:
    """N rays, and a triangle for each.

    Attributes
    ----------
    origins, directions : (N, 3) float32
    corners : (N, 3, 3) float32
    """

    origins: NDArray[np.float32]
    directions: NDArray[np.float32]
    corners: NDArray[np.float32]

    def __len__(self) -> int:
        return len(self.origins)

    def __getitem__(self, chosen: Any) -> Pairs:
        return Pairs(self.origins[chosen], self.directions[chosen], self.corners[chosen])


def ordinary(rng: Generator, count: int) -> Pairs:
    """Triangles without small angles, seen from nearby and from no flatter than 12°, clear of the edges."""
    corners, normal, along = _triangles(rng, count)
    target = _weighted(corners, _weights(rng, count, 0.05))
    sine = rng.uniform(0.2, 1.0, (count, 1))
    return _aimed(target - rng.uniform(1, 4, (count, 1)) * _slanted(normal, along, sine), target, corners)


def slivers(rng: Generator, count: int) -> Pairs:
    """Needles a thousand to a hundred million times as long as they are wide."""
    corners, normal, along = _triangles(rng, count)
    across = np.cross(normal, along)
    width = 10 ** -rng.uniform(3, 8, (count, 1))
    # The short edge is at the origin, where float32 can resolve its ends.
    near = width * (rng.uniform(-1, 1, (count, 1)) * along - across / 2)
    corners = np.stack([near, near + width * across, rng.uniform(0.5, 2, (count, 1)) * along], axis=1)
    target = _weighted(corners, _weights(rng, count, 0.0))
    sine = rng.uniform(0.2, 1.0, (count, 1))
    return _aimed(target - rng.uniform(1, 4, (count, 1)) * _slanted(normal, across, sine), target, corners)


def grazing(rng: Generator, count: int) -> Pairs:
    """Rays that meet the plane at a sine of 1e-7 to 1e-3."""
    corners, normal, along = _triangles(rng, count)
    target = _weighted(corners, _weights(rng, count, 0.05))
    sine = 10 ** rng.uniform(-7, -3, (count, 1))
    return _aimed(target - rng.uniform(1, 4, (count, 1)) * _slanted(normal, along, sine), target, corners)


def far(rng: Generator, count: int) -> Pairs:
    """Rays that start a thousand to a hundred million sizes of the triangle away."""
    corners, normal, along = _triangles(rng, count)
    target = _weighted(corners, _weights(rng, count, 0.05))
    distance = 10 ** rng.uniform(3, 8, (count, 1))
    return _aimed(
        target - distance * _slanted(normal, along, rng.uniform(0.2, 1.0, (count, 1))), target, corners
    )


def borders(rng: Generator, count: int) -> Pairs:
    """Rays at a vertex or at a point on an edge: a third exactly, the others as float32 happens to round."""
    third = count // 3
    exact = rng.integers(-8, 9, (third, 3, 3)).astype(np.float64)
    rounded, normal, along = _triangles(rng, count - third)
    rounded = rounded.astype(np.float32).astype(np.float64)
    # Sixteenths of small integers: float32 represents them and all their products.
    first, second = exact[:, 0], exact[:, 1]
    target = first + (second - first) * rng.integers(0, 17, (third, 1)) / 16
    on_lattice = _aimed(rng.integers(-32, 33, (third, 3)).astype(np.float64), target, exact, unit=False)
    first, second = rounded[:, 0], rounded[:, 1]
    share = np.where(rng.random((count - third, 1)) < 0.3, 0.0, rng.random((count - third, 1)))
    target = first + (second - first) * share
    sine = rng.uniform(0.2, 1.0, (count - third, 1))
    start = target - rng.uniform(1, 4, (count - third, 1)) * _slanted(normal, along, sine)
    return _turned(rng, _joined([on_lattice, _aimed(start, target, rounded)]))


def scales(rng: Generator, count: int) -> Pairs:
    """Ordinary triangles and rays, 1e-18 to 1e18 times as large."""
    pairs = ordinary(rng, count)
    scale = 10 ** rng.uniform(-18, 18, (count, 1))
    single = np.float32
    return Pairs(
        (pairs.origins * scale).astype(single),
        pairs.directions,
        (pairs.corners * scale[..., None]).astype(single),
    )


FAMILIES: dict[str, Callable[[Generator, int], Pairs]] = {
    "ordinary": ordinary,
    "slivers": slivers,
    "grazing": grazing,
    "far origins": far,
    "edges, vertices": borders,
    "huge and tiny": scales,
}
"""By the names that reports have for them."""


def family(name: str, count: int, seed: int) -> Pairs:
    """Return `count` pairs of a family, half hits and half misses as far as can be."""
    rng = np.random.default_rng([seed, list(FAMILIES).index(name)])
    drawn: list[Pairs] = []
    decided: list[NDArray[np.bool_]] = []
    hits = misses = 0
    # For an odd count, hits are one more.
    half = (count + 1) // 2
    while hits + misses < count or (min(hits, misses) < half and hits + misses < _PATIENCE * count):
        drawn.append(FAMILIES[name](rng, _BATCH))
        decided.append(_roughly(drawn[-1]))
        hits += int(decided[-1].sum())
        misses += int((~decided[-1]).sum())
    hit = np.concatenate(decided)
    taken = min(max(half, count - misses), hits)
    chosen = np.concatenate([np.flatnonzero(hit)[:taken], np.flatnonzero(~hit)[: count - taken]])
    return _joined(drawn)[rng.permutation(chosen)]


def _triangles(rng: Generator, count: int) -> tuple[Array, Array, Array]:
    """Triangles about as wide as high (N,3,3), their unit normals, and unit vectors in their planes."""
    normal = _units(rng.normal(size=(count, 3)))
    along = _units(np.cross(normal, rng.normal(size=(count, 3))))
    angle = np.array([0, 1, 2]) * (2 * np.pi / 3) + rng.uniform(-0.5, 0.5, (count, 3))
    radius = rng.uniform(0.5, 1.0, (count, 3))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    spokes = x[..., None] * along[:, None] + y[..., None] * np.cross(normal, along)[:, None]
    return rng.uniform(-1, 1, (count, 1, 3)) + spokes, normal, along


def _weights(rng: Generator, count: int, margin: float) -> Array:
    """Weights (N,3) that add up to 1: about half all above `margin`, half with one below minus it."""
    weights = margin + (1 - 3 * margin) * rng.dirichlet([1, 1, 1], count)
    outside = rng.random(count) < 0.5
    weights[outside, 0] = -rng.uniform(margin, 1, outside.sum())
    rest = weights[outside, 1:]
    weights[outside, 1:] = rest / rest.sum(axis=1, keepdims=True) * (1 - weights[outside, :1])
    return rng.permuted(weights, axis=1)


def _weighted(corners: Array, weights: Array) -> Array:
    return np.asarray(np.einsum("ni,nij->nj", weights, corners))


def _slanted(normal: Array, along: Array, sine: Array) -> Array:
    """Return unit directions that meet a plane at an angle whose sine is given."""
    return sine * normal + np.sqrt(1 - sine**2) * along


def _aimed(origins: Array, targets: Array, corners: Array, unit: bool = True) -> Pairs:
    """Rays from where float32 puts their origins, in the direction of their targets as in float32."""
    starts = origins.astype(np.float32)
    ways = targets - starts
    return Pairs(starts, (_units(ways) if unit else ways).astype(np.float32), corners.astype(np.float32))


def _units(vectors: Array) -> Array:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0))


def _joined(parts: list[Pairs]) -> Pairs:
    return Pairs(
        np.concatenate([part.origins for part in parts]),
        np.concatenate([part.directions for part in parts]),
        np.concatenate([part.corners for part in parts]),
    )


def _turned(rng: Generator, pairs: Pairs) -> Pairs:
    """Return the same in random order, each triangle from any of its corners and wound either way."""
    order = rng.permutation(len(pairs))
    corners = rng.permuted(np.broadcast_to([0, 1, 2], (len(pairs), 3)), axis=1)
    shuffled = pairs[order]
    turned = np.take_along_axis(shuffled.corners, corners[..., None], axis=1)
    return Pairs(shuffled.origins, shuffled.directions, turned)


def _roughly(pairs: Pairs) -> NDArray[np.bool_]:
    """Return whether each ray hits, in float64."""
    corners = pairs.corners.astype(np.float64) - pairs.origins[:, None]
    after, before = np.roll(corners, -1, axis=1), np.roll(corners, -2, axis=1)
    direction = pairs.directions.astype(np.float64)[:, None]
    volumes = (direction * np.cross(after - before, after + before)).sum(axis=2)
    return np.asarray(((volumes >= 0).all(axis=1) | (volumes <= 0).all(axis=1)) & (volumes != 0).any(axis=1))
