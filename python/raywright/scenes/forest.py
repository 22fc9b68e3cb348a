"""A forest: a few trees, and where they stand, again and again."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import SeedLike, integer, positive, seed_number
from ..materials import Diffuse
from ..scene.instance import Instance
from ..shapes.mesh import Mesh

Array = NDArray[np.float64]

_SIDES = 5
# Children per branch, their relative length and thickness, and their lean away from it.
_CHILDREN, _LONG, _THICK, _LEAN = 3, 0.72, 0.6, 0.65
_LEVELS = 4


class Forest(NamedTuple):
    """A forest: unique trees, and the transforms of their copies.

    Attributes
    ----------
    trees : list of Mesh
        The unique ones, each with its foot in the origin and y up.
    tree : (N,) int64
        Index of the unique tree of each copy.
    transforms : (N, 4, 4) float64
        Transforms of the trees: each acts on column vectors (x, y, z, 1).

    See Also
    --------
    scenes.forest : Makes it.

    Examples
    --------
    >>> forest = rw.scenes.forest(count=9, unique=2, triangles=500)
    >>> len(forest.trees), forest.tree.shape, forest.triangles
    (2, (9,), 4500)
    """

    trees: list[Mesh]
    tree: NDArray[np.int64]
    transforms: Array

    @property
    def triangles(self) -> int:
        """Number of triangles, each instance counted."""
        sizes = np.array([len(tree.faces) for tree in self.trees])
        return int(sizes[self.tree].sum())

    def instances(self) -> list[Instance]:
        """Return the forest as instances, one for each unique tree.

        Returns
        -------
        list of Instance
            One for each unique tree.

        See Also
        --------
        Forest.meshes : Meshes of their own.

        Examples
        --------
        >>> forest = rw.scenes.forest(count=9, unique=2, triangles=500)
        >>> len(rw.Scene(forest.instances()).shapes)
        2
        """
        places = [self.transforms[self.tree == i] for i in range(len(self.trees))]
        return [Instance(tree, where) for tree, where in zip(self.trees, places, strict=True) if len(where)]

    def meshes(self) -> list[Mesh]:
        """Return the forest as meshes, one for each copy; for small forests.

        Returns
        -------
        list of Mesh
            One for each tree.

        See Also
        --------
        Forest.instances : Copies.

        Examples
        --------
        >>> forest = rw.scenes.forest(count=9, unique=2, triangles=500)
        >>> len(forest.meshes())
        9
        """
        return [
            self.trees[i].transformed(matrix)
            for i, matrix in zip(self.tree.tolist(), self.transforms, strict=True)
        ]


def forest(
    count: int = 100_000,
    unique: int = 10,
    triangles: int = 10_000,
    spacing: float = 6.0,
    seed: SeedLike = 0,
) -> Forest:
    """Return a forest of many copies of a few unique trees: by default 10⁹ triangles from 10⁵ unique ones.

    Each square of a grid around the origin has one tree, at a random place, rotated about the y axis and
    scaled by 0.7 to 1.3. A tree has a trunk of 3 m that branches into three, three times, with 400 triangles;
    all others are leaves around the twigs.

    Parameters
    ----------
    count : int
        Number of trees.
    unique : int
        Number of unique trees.
    triangles : int
        Triangles of each unique tree, exactly; more than 400.
    spacing : float
        Side of the squares, in meters.
    seed : int, Generator or SeedSequence
        Seed of trees and places.

    Returns
    -------
    Forest

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    Instance : Copies of shapes.

    Examples
    --------
    >>> forest = rw.scenes.forest(count=100, unique=2, triangles=500)
    >>> forest.triangles, len(rw.Scene(forest.instances()).shapes)
    (50000, 2)
    """
    count, unique = integer("count", count, 1), integer("unique", unique, 1)
    triangles = integer("triangles", triangles, 2 * _SIDES * _branches() + 1)
    spacing = positive("spacing", spacing)
    rng = np.random.default_rng(seed_number(seed, None))
    trees = [_tree(rng, triangles) for _ in range(unique)]
    side = int(np.ceil(count**0.5))
    cell = np.stack(np.divmod(np.arange(count), side), axis=1)
    place = spacing * (cell + rng.random((count, 2)) - side / 2)
    angle, size = rng.uniform(0, 2 * np.pi, count), rng.uniform(0.7, 1.3, count)
    transforms = np.zeros((count, 4, 4))
    transforms[:, 0, 0] = transforms[:, 2, 2] = size * np.cos(angle)
    transforms[:, 0, 2] = size * np.sin(angle)
    transforms[:, 2, 0] = -transforms[:, 0, 2]
    transforms[:, 1, 1] = size
    transforms[:, 0, 3], transforms[:, 2, 3] = place.T
    transforms[:, 3, 3] = 1
    return Forest(trees, rng.integers(unique, size=count), transforms)


def _branches() -> int:
    return sum(_CHILDREN**level for level in range(_LEVELS))


def _tree(rng: np.random.Generator, triangles: int) -> Mesh:
    """Return a tree of so many triangles: tapered tubes, and leaves at random places on the last of them."""
    feet, ways, radii = np.zeros((1, 3)), np.array([[0.0, 3.0, 0.0]]), np.array([0.18])
    wood = []
    for level in range(_LEVELS):
        wood.append(_tubes(feet, ways, radii))
        if level + 1 < _LEVELS:
            feet, ways, radii = _parted(rng, feet, ways, radii)
    vertices = np.concatenate(wood)
    # Each tube has a ring at its base and one at its tip.
    ring, tubes = np.arange(_SIDES), len(vertices) // (2 * _SIDES)
    after = (ring + 1) % _SIDES
    one = np.concatenate(
        [np.stack([ring, ring + _SIDES, after], 1), np.stack([after, ring + _SIDES, after + _SIDES], 1)]
    )
    faces = (one + 2 * _SIDES * np.arange(tubes)[:, np.newaxis, np.newaxis]).reshape(-1, 3)
    leaves = _leaves(rng, feet, ways, triangles - len(faces))
    more = np.arange(leaves.size // 3).reshape(-1, 3) + len(vertices)
    vertices = np.concatenate([vertices, leaves.reshape(-1, 3)])
    return Mesh(vertices, np.concatenate([faces, more]), material=Diffuse((0.2, 0.3, 0.1)))


def _parted(rng: np.random.Generator, feet: Array, ways: Array, radii: Array) -> tuple[Array, Array, Array]:
    """Return the branches that begin where others end."""
    count = len(feet) * _CHILDREN
    tips, ways, radii = (np.repeat(a, _CHILDREN, axis=0) for a in (feet + ways, ways, radii))
    a, b = _across(ways)
    # Around the branch, about a third of a turn apart.
    turn = 2 * np.pi * (np.arange(count) % _CHILDREN + rng.uniform(-0.3, 0.3, count)) / _CHILDREN
    aside = np.cos(turn)[:, np.newaxis] * a + np.sin(turn)[:, np.newaxis] * b
    length = np.linalg.norm(ways, axis=1, keepdims=True)
    lean = _LEAN * rng.uniform(0.6, 1.4, (count, 1))
    new = ways / length + lean * aside
    new *= length * _LONG * rng.uniform(0.8, 1.2, (count, 1)) / np.linalg.norm(new, axis=1, keepdims=True)
    return tips, new, radii * _THICK


def _tubes(feet: Array, ways: Array, radii: Array) -> Array:
    """Return corners of tapered tubes: a ring at the foot of each, then one at its tip."""
    a, b = _across(ways)
    angle = 2 * np.pi * np.arange(_SIDES) / _SIDES
    ring = np.cos(angle)[:, np.newaxis] * a[:, np.newaxis] + np.sin(angle)[:, np.newaxis] * b[:, np.newaxis]
    wide = radii[:, np.newaxis, np.newaxis] * ring
    low = feet[:, np.newaxis] + wide
    high = (feet + ways)[:, np.newaxis] + _THICK * wide
    return np.stack([low, high], axis=1).reshape(-1, 3)


def _leaves(rng: np.random.Generator, feet: Array, ways: Array, count: int) -> Array:
    """Return triangles around twigs: (count, 3, 3), the smaller the more there are."""
    twig = rng.integers(len(feet), size=count)
    middle = feet[twig] + rng.uniform(0.2, 1.1, (count, 1)) * ways[twig] + rng.normal(0, 0.12, (count, 3))
    size = min(0.9 * count**-0.25, 0.25)
    spokes = rng.normal(size=(count, 3, 3))
    spokes *= size * rng.uniform(0.4, 1.0, (count, 3, 1)) / np.linalg.norm(spokes, axis=2, keepdims=True)
    return np.asarray(middle[:, np.newaxis] + spokes)


def _across(ways: Array) -> tuple[Array, Array]:
    """Return two unit vectors across each way, so that the three are right-handed: first, second, way."""
    unit = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    # The axis of the direction's smallest component is never parallel to it.
    axis = np.eye(3)[np.abs(unit).argmin(axis=1)]
    a = np.cross(axis, unit)
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    return a, np.cross(unit, a)
