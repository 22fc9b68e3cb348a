"""Hills with grass on them: much detail, evenly spread."""

from __future__ import annotations

import numpy as np

from ..arrays import SeedLike, integer, seed_number
from ..materials import Diffuse
from ..shapes.mesh import Mesh
from .boxes import Array

_WIDTH = 100.0
_HEIGHT = 6.0


def terrain(side: int = 160, blades: int = 50_000, seed: SeedLike = 0) -> list[Mesh]:
    """Return hills with evenly spread blades of grass: a scene that suits grids.

    The ground is a square of 100 m around the y axis, which is up. Its heights are random waves whose power
    falls with the fourth power of their frequency, scaled to 6 m from the lowest point to the highest. A
    blade of grass is one thin triangle, tilted at random. Blades are jittered: at most one in each cell of a
    grid with about as many cells as blades.

    Parameters
    ----------
    side : int
        Number of squares along each side of the ground, with two triangles each.
    blades : int
        Number of blades of grass; 0 leaves the ground bare.
    seed : int, Generator or SeedSequence
        Seed of the hills and of the grass.

    Returns
    -------
    list of Mesh
        The ground, and the grass if there is some.

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.forest : Trees.

    Examples
    --------
    >>> ground, grass = rw.scenes.terrain(side=4, blades=10)
    >>> len(ground.faces), len(grass.faces)
    (32, 10)
    """
    side, blades = integer("side", side, 1), integer("blades", blades, 0)
    rng = np.random.default_rng(seed_number(seed, None))
    heights = _heights(rng, side + 1)
    line = _WIDTH * (np.arange(side + 1) / side - 0.5)
    x, z = np.meshgrid(line, line, indexing="ij")
    vertices = np.stack([x, heights, z], axis=-1).reshape(-1, 3)
    i, j = (a.reshape(-1) for a in np.meshgrid(np.arange(side), np.arange(side), indexing="ij"))
    a, b, c, d = (p * (side + 1) + q for p, q in ((i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)))
    faces = np.stack([a, b, c, a, c, d], axis=1).reshape(-1, 3)
    ground = Mesh(vertices, faces, material=Diffuse((0.35, 0.28, 0.2)))
    return [ground, _grass(rng, heights, blades)] if blades else [ground]


def _heights(rng: np.random.Generator, points: int) -> Array:
    """Random waves on a grid of points, from 0 to the height of the hills."""
    frequency = np.hypot(np.fft.fftfreq(points)[:, np.newaxis], np.fft.rfftfreq(points))
    # Amplitude falls with the square of the frequency, power with the fourth. The mean does not matter.
    amplitude = np.divide(1.0, frequency**2, out=np.zeros_like(frequency), where=frequency > 0)
    waves = np.fft.rfft2(rng.normal(size=(points, points))) * amplitude
    heights = np.fft.irfft2(waves, s=(points, points))
    heights -= heights.min()
    return np.asarray(heights * (_HEIGHT / heights.max()))


def _grass(rng: np.random.Generator, heights: Array, blades: int) -> Mesh:
    """Blades that stand on the ground, each a triangle."""
    cells = int(np.ceil(blades**0.5))
    chosen = np.sort(rng.permutation(cells * cells)[:blades])
    place = np.stack(np.divmod(chosen, cells), axis=1)
    # In squares of the ground.
    where = (place + rng.random((blades, 2))) * ((len(heights) - 1) / cells)
    foot = np.stack(
        [
            _WIDTH * (where[:, 0] / (len(heights) - 1) - 0.5),
            _on(heights, where),
            _WIDTH * (where[:, 1] / (len(heights) - 1) - 0.5),
        ],
        axis=1,
    )
    angle = rng.uniform(0, 2 * np.pi, blades)
    across = np.stack([np.cos(angle), np.zeros(blades), np.sin(angle)], axis=1)
    # A sixth of the available room wide, and several times as high.
    wide = _WIDTH / cells / 6
    lean = rng.uniform(-0.5, 0.5, (blades, 3)) * [1, 0, 1] + [0, 1, 0]
    tip = foot + wide * rng.uniform(6, 18, (blades, 1)) * lean
    corners = np.stack([foot - wide / 2 * across, foot + wide / 2 * across, tip], axis=1)
    faces = np.arange(3 * blades).reshape(-1, 3)
    return Mesh(corners.reshape(-1, 3), faces, material=Diffuse((0.2, 0.45, 0.1)))


def _on(heights: Array, where: Array) -> Array:
    """Heights of the ground's triangles at places in squares of the ground."""
    cell = np.minimum(where.astype(np.int64), len(heights) - 2)
    u, v = (where - cell).T
    i, j = cell.T
    a, b, c, d = heights[i, j], heights[i, j + 1], heights[i + 1, j + 1], heights[i + 1, j]
    # The diagonal of each square runs from (0, 0) to (1, 1).
    return np.asarray(np.where(v >= u, a + v * (b - a) + u * (c - b), a + u * (d - a) + v * (c - d)))
