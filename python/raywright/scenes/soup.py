"""Triangles without any order."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, positive, seed_number
from ..shapes.mesh import Mesh


def soup(triangles: int = 10_000, size: float | None = None, seed: SeedLike = 0) -> list[Mesh]:
    """Return random triangles in the unit cube, at any angle: a scene without structure.

    Parameters
    ----------
    triangles : int
        Number of triangles.
    size : float, optional
        Maximum distance of corners from the middle of their triangle. If not given, it decreases with their
        number, such that a ray sees about a third of the cube's edge.
    seed : int, Generator or SeedSequence
        Seed of the triangles.

    Returns
    -------
    list of Mesh
        One mesh, which may extend beyond the cube by `size`.

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
    >>> soup = rw.scenes.soup(triangles=100)
    >>> len(soup[0].faces)
    100
    """
    count = integer("triangles", triangles, 1)
    # Hits per unit length equal projected area per unit volume: half the area of a triangle, 0.26 of the
    # squared size on average.
    reach = (23 / count) ** 0.5 if size is None else positive("size", size)
    rng = np.random.default_rng(seed_number(seed, None))
    spokes = rng.normal(size=(count, 3, 3))
    spokes *= rng.uniform(0.25, 1, (count, 3, 1)) * reach / np.linalg.norm(spokes, axis=2, keepdims=True)
    vertices = rng.random((count, 1, 3)) + spokes
    return [Mesh(vertices.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))]
