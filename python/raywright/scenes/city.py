"""A city of blocks, towers and streets."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, seed_number
from ..materials import Diffuse
from ..shapes.mesh import Mesh
from .boxes import boxes

_BLOCK, _STREET = 60.0, 18.0
_FLOOR = 3.5


def city(blocks: int = 12, seed: SeedLike = 0) -> list[Mesh]:
    """Return a city: a ground with blocks of houses, which are higher towards the center.

    Blocks are squares of 60 m with streets of 18 m between. Each has 3 by 3 plots with one house or two
    stacked ones, and some smaller boxes on every roof. y is up, the ground is at y = 0, and the center over
    the origin.

    Parameters
    ----------
    blocks : int
        Number of blocks along each side of the city.
    seed : int, Generator or SeedSequence
        Seed of the houses.

    Returns
    -------
    list of Mesh
        The ground, two triangles; then the houses, 60 triangles a plot.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.classics : All scenes for accelerators.

    Examples
    --------
    >>> ground, *houses = rw.scenes.city(blocks=1)
    >>> len(ground.faces), sum(len(house.faces) for house in houses) // 60
    (2, 9)
    """
    blocks = integer("blocks", blocks, 1)
    rng = np.random.default_rng(seed_number(seed, None))
    pitch, plots = _BLOCK + _STREET, 3 * blocks
    edge = pitch * blocks / 2
    # Centers of plots along a side: three in a block, then a street.
    plot = np.arange(plots)
    line = pitch * (plot // 3) + _BLOCK * (plot % 3 + 0.5) / 3 + _STREET / 2 - edge
    x, z = (a.reshape(-1) for a in np.meshgrid(line, line, indexing="ij"))
    count = len(x)
    tall = 1 + 7 * np.exp(-(x**2 + z**2) / (0.35 * edge) ** 2)
    height = _FLOOR * np.ceil(tall * np.exp(rng.normal(1.0, 0.45, count)))
    wide = _BLOCK / 6 * rng.uniform(0.75, 0.97, (count, 2))
    # Towers have stories above the setback; flat houses have a low one.
    upper = _FLOOR * np.ceil(rng.uniform(0.1, 0.6, count) * height / _FLOOR)
    narrow = wide * rng.uniform(0.5, 0.85, (count, 1))
    parts = [(x, z, np.zeros(count), wide, height), (x, z, height, narrow, upper)]
    top = height + upper
    for _ in range(3):
        small = np.minimum(rng.uniform(0.6, 2.0, (count, 2)), 0.4 * narrow)
        shift = (narrow - small) * rng.uniform(-1, 1, (count, 2))
        parts.append((x + shift[:, 0], z + shift[:, 1], top, small, rng.uniform(1.0, 4.0, count)))
    centers = [np.stack([px, base + high / 2, pz], axis=1) for px, pz, base, _, high in parts]
    halves = [np.stack([half[:, 0], high / 2, half[:, 1]], axis=1) for *_, half, high in parts]
    vertices, faces = boxes(np.stack(centers, 1).reshape(-1, 3), np.stack(halves, 1).reshape(-1, 3))
    ground = np.array([[-edge, 0, edge], [edge, 0, edge], [edge, 0, -edge], [-edge, 0, -edge]])
    return [
        Mesh(ground, [[0, 1, 2], [0, 2, 3]], material=Diffuse(0.25)),
        Mesh(vertices, faces, material=Diffuse(0.6)),
    ]
