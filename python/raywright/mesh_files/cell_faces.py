"""Faces of the cells of finite elements, numbered as VTK and meshio number them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .corners import distinct

Integers: TypeAlias = NDArray[np.int64]
Parts: TypeAlias = tuple[tuple[int, ...], ...]

# Cells that are polygons already.
FLAT = ("triangle", "quad", "polygon")
# Odd multipliers with random bits (Steele, Lea and Flood, "Fast splittable pseudorandom number generators",
# 2014).
_FACTORS = (0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB, 0xD6E8FEB86659FD93)
# Nodes along a perimeter of six and of eight, corners and middles of edges in turn, as polygons.
_OF_PERIMETER: dict[int, Parts] = {
    6: ((0, 1, 5), (1, 2, 3), (5, 3, 4), (1, 3, 5)),
    8: ((0, 1, 7), (1, 2, 3), (3, 4, 5), (5, 6, 7), (1, 3, 5, 7)),
}


def _along(perimeter: tuple[int, ...]) -> Parts:
    return tuple(tuple(perimeter[i] for i in part) for part in _OF_PERIMETER[len(perimeter)])


# Cells with curved edges, as polygons through all nodes.
FLAT_PARTS: dict[str, Parts] = {
    "triangle6": _along((0, 3, 1, 4, 2, 5)),
    "quad8": _along((0, 4, 1, 5, 2, 6, 3, 7)),
    "quad9": ((0, 4, 8, 7), (4, 1, 5, 8), (8, 5, 2, 6), (7, 8, 6, 3)),
}

_TETRA: Parts = ((0, 1, 3), (1, 2, 3), (2, 0, 3), (0, 2, 1))
_HEXAHEDRON: Parts = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
_TETRA_EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
_HEXAHEDRON_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
)


def _curved(faces: Parts, edges: Sequence[tuple[int, int]], corners: int) -> Parts:
    """Return the perimeters of faces whose edges have nodes in their middles, numbered after the corners."""
    middle = {frozenset(edge): corners + i for i, edge in enumerate(edges)}
    return tuple(
        tuple(
            node
            for a, b in zip(face, (*face[1:], face[0]), strict=True)
            for node in (a, middle[frozenset((a, b))])
        )
        for face in faces
    )


# Perimeters of the faces of volume cells. The middle of a cell decides their orientation, since programs
# number prisms both ways.
VOLUME: dict[str, Parts] = {
    "tetra": _TETRA,
    "pyramid": ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
    "wedge": ((0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (1, 4, 5, 2), (2, 5, 3, 0)),
    "hexahedron": _HEXAHEDRON,
    "tetra10": _curved(_TETRA, _TETRA_EDGES, 4),
    "hexahedron20": _curved(_HEXAHEDRON, _HEXAHEDRON_EDGES, 8),
}


def boundary(
    volumes: Sequence[tuple[str, Integers, Integers]],
    points: NDArray[Any],
    corners: Integers,
    counts: Integers,
) -> tuple[Integers, Integers, Integers]:
    """Return the faces that one volume cell alone has, and that are none of the given polygons.

    Parameters
    ----------
    volumes : sequence of (kind, (N, K) nodes, (N,) numbers of the cells)
    points : (V, 3) array
    corners : (C,) int array
        Vertices of polygons that are there already, one polygon after the other.
    counts : (P,) int array
        Number of corners of each of them.

    Returns
    -------
    corners : (D,) int64 array
        Vertices of the faces, wound so that normals point out of the cells.
    counts, cells : (Q,) int64 arrays
        Number of corners of each, and the cell that it is of.
    """
    faces = list(_faces(volumes))
    given = list(_of_size(corners, counts))
    keys = np.concatenate([_keys(own[:, :: _step(own)]) for own, *_ in faces] + [_keys(own) for own in given])
    total = sum(len(own) for own, *_ in faces)
    is_outer = _alone(keys)[:total]
    found: list[tuple[Integers, Integers, Integers]] = []
    at = 0
    for own, nodes, ids in faces:
        outer = is_outer[at : at + len(own)]
        at += len(own)
        found += _parts(_outwards(own[outer], nodes[outer], points), ids[outer])
    return (
        np.concatenate([np.empty(0, np.int64), *(part[0] for part in found)]),
        np.concatenate([np.empty(0, np.int64), *(part[1] for part in found)]),
        np.concatenate([np.empty(0, np.int64), *(part[2] for part in found)]),
    )


def _faces(
    volumes: Sequence[tuple[str, Integers, Integers]],
) -> Iterator[tuple[Integers, Integers, Integers]]:
    """Yield perimeters with the nodes and numbers of their cells: a face of each kind of cell at a time."""
    for kind, nodes, ids in volumes:
        for face in VOLUME[kind]:
            yield nodes[:, face], nodes, ids


def _of_size(corners: Integers, counts: Integers) -> Iterator[Integers]:
    """Yield the triangles, and the quads, of polygons."""
    starts = np.cumsum(counts) - counts
    for size in (3, 4):
        yield corners[starts[counts == size][:, None] + np.arange(size)]


def _step(perimeter: Integers) -> int:
    """Return the step from corner to corner."""
    return 2 if perimeter.shape[1] > 4 else 1


def _keys(faces: Integers) -> Integers:
    """Return four numbers that are equal for faces with the same corners."""
    keys = np.full((len(faces), 4), -1, np.int64)
    keys[:, : faces.shape[1]] = np.sort(faces, axis=1)
    return keys


def _alone(keys: Integers) -> NDArray[np.bool_]:
    """Return which rows occur once."""
    # Sorting one hash per row takes a quarter of the time of sorting rows.
    factors = np.array(_FACTORS, np.uint64)
    mixed = (keys.astype(np.uint64) * factors).sum(axis=1, dtype=np.uint64)
    order = np.argsort(mixed)
    same = np.flatnonzero(mixed[order[1:]] == mixed[order[:-1]])
    before, after = order[same], order[same + 1]
    result = np.ones(len(keys), np.bool_)
    if (keys[before] != keys[after]).any():
        # Different rows have the same hash: never seen so far.
        _, place = distinct(list(keys.T))
        return np.asarray(np.bincount(place)[place] == 1)
    result[before] = result[after] = False
    return result


def _outwards(perimeter: Integers, nodes: Integers, points: NDArray[Any]) -> Integers:
    """Return perimeters that turn anticlockwise seen from outside of their cells."""
    flat = perimeter[:, :: _step(perimeter)]
    places = points[flat].astype(np.float64)
    # Twice the vector area, of triangles as of quads.
    normal = np.cross(places[:, 2] - places[:, 0], places[:, -1] - places[:, 1])
    if flat.shape[1] == 3:
        normal = np.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
    out = places.mean(axis=1) - points[nodes].astype(np.float64).mean(axis=1)
    inwards = (normal * out).sum(axis=1) < 0
    # Reversed, from the same first corner.
    turned = np.concatenate([perimeter[:, :1], perimeter[:, :0:-1]], axis=1)
    return np.where(inwards[:, None], turned, perimeter)


def _parts(perimeter: Integers, ids: Integers) -> list[tuple[Integers, Integers, Integers]]:
    """Return polygons that faces consist of: corners, their numbers, and cells."""
    size = perimeter.shape[1]
    parts = _OF_PERIMETER[size] if size > 4 else (tuple(range(size)),)
    return [
        (perimeter[:, part].reshape(-1), np.full(len(ids), len(part), np.int64), ids.astype(np.int64))
        for part in parts
    ]
