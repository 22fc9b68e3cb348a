"""Of faces that are equally close to a point, the one that faces it."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import NDArray

from ...query.closest_points import ClosestPoints

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_closest: Any = trimesh.triangles.closest_point

# Relative tolerance for equal squared distances.
_EQUAL = 1e-8
# Tolerance for equal barycentric weights and equal cosines.
_ROUNDING = 1e-9
# Pairs of a point and a face per batch: some 500 MB.
_MOST = 2_000_000


class Neighbors:
    """The faces at each edge and each corner of a mesh; corners in one place are one.

    Parameters
    ----------
    triangles : (F, 3, 3) array
        The corners of each face.
    """

    def __init__(self, triangles: Floats) -> None:
        self.triangles = triangles
        # Turns minus zero into zero.
        places = np.ascontiguousarray(triangles.reshape(-1, 3) + 0.0)
        rows = places.view([("", places.dtype)] * 3).reshape(-1)
        self.corners = np.unique(rows, return_inverse=True)[1].reshape(-1, 3).astype(np.int64)
        pairs = np.sort(np.stack((self.corners, np.roll(self.corners, -1, axis=1)), axis=-1), axis=-1)
        keys = pairs[..., 0] * (int(self.corners.max()) + 1) + pairs[..., 1]
        # The edge from each corner to the next.
        self.edges = np.unique(keys.reshape(-1), return_inverse=True)[1].reshape(-1, 3)
        self._at_corner, self._at_edge = _Lists(self.corners), _Lists(self.edges)

    def count(self, face: Ints, corner: Ints) -> Ints:
        """Return how many faces there are at the edges of each face and at its corner, -1 for none."""
        count = self._at_edge.count(self.edges[face].T).sum(axis=0)
        has = corner >= 0
        count[has] += self._at_corner.count(self.corners[face[has], corner[has]])
        return np.asarray(count)

    def at_edges(self, face: Ints) -> tuple[Ints, Ints]:
        """Return the faces that share an edge with each face: whose, and which."""
        lists = [self._at_edge.of(self.edges[face, k]) for k in range(3)]
        of, faces = (np.concatenate(parts) for parts in zip(*lists, strict=True))
        return of, faces

    def at_corner(self, face: Ints, corner: Ints) -> tuple[Ints, Ints]:
        """Return the faces that share a corner with each face that has one: whose, and which."""
        has = np.flatnonzero(corner >= 0)
        at, which = self._at_corner.of(self.corners[face[has], corner[has]])
        return has[at], which


class _Lists:
    """The faces of each number that stands in a table of (F, 3)."""

    def __init__(self, table: Ints) -> None:
        flat = table.reshape(-1)
        self._faces = np.argsort(flat, kind="stable") // 3
        self._begins = np.concatenate(([0], np.cumsum(np.bincount(flat)))).astype(np.int64)

    def count(self, numbers: Ints) -> Ints:
        return np.asarray(self._begins[numbers + 1] - self._begins[numbers])

    def of(self, numbers: Ints) -> tuple[Ints, Ints]:
        """Return the place of each number, once for each of its faces, and the face."""
        count = self.count(numbers)
        place = np.repeat(np.arange(len(numbers)), count)
        first = np.cumsum(count) - count
        return place, self._faces[self._begins[numbers][place] + np.arange(len(place)) - first[place]]


def facing(
    neighbors: Neighbors, normals: Floats, points: Floats, found: ClosestPoints, position: Floats, face: Ints
) -> None:
    """Put a neighbor that is as close, and faces the point more, in place of the closest face.

    `position` and `face` are written to.
    """
    asked = np.flatnonzero(found.found & (found.distance > 0))
    if not len(asked):
        return
    cosine = _cosines(points[asked], position[asked], normals[face[asked]])
    # A face with a cosine of 1 already faces its point; no other can do better.
    asked, cosine = asked[cosine < 1 - _ROUNDING], cosine[cosine < 1 - _ROUNDING]
    uv = found.uv[asked]
    weights = np.column_stack((1 - uv.sum(axis=1), uv))
    corner = np.where(weights.max(axis=1) > 1 - _ROUNDING, weights.argmax(axis=1), -1)
    ends = np.cumsum(neighbors.count(face[asked], corner))
    begin = 0
    while begin < len(asked):
        before = ends[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(ends, before + _MOST, "right")))
        part = slice(begin, end)
        _replace(neighbors, normals, points, found, (asked[part], corner[part], cosine[part]), position, face)
        begin = end


def _replace(
    neighbors: Neighbors,
    normals: Floats,
    points: Floats,
    found: ClosestPoints,
    some: tuple[Ints, Ints, Floats],
    position: Floats,
    face: Ints,
) -> None:
    asked, corner, own = some
    at, best = points[asked].astype(np.float64), found.distance[asked] ** 2 * (1 + _EQUAL)
    of, faces = neighbors.at_edges(face[asked])
    near = _closest(neighbors.triangles[faces], at[of])
    equal = ((at[of] - near) ** 2).sum(axis=1) <= best[of]
    of, faces, near = of[equal], faces[equal], near[equal]
    # All faces at the corner share this closest point.
    others, which = neighbors.at_corner(face[asked], corner)
    of, faces, near = (
        np.concatenate(parts) for parts in ((of, others), (faces, which), (near, position[asked[others]]))
    )
    cosine = _cosines(at[of], near, normals[faces])
    better = cosine > own[of] + _ROUNDING
    of, faces, near, cosine = of[better], faces[better], near[better], cosine[better]
    # The last entry of each point faces it most; among equals, the first face.
    order = np.lexsort((-faces, cosine, of))
    last = order[np.append(of[order][1:] != of[order][:-1], True)] if len(order) else order
    face[asked[of[last]]] = faces[last]
    position[asked[of[last]]] = near[last]


def _cosines(points: Floats, closest: Floats, normals: Floats) -> Floats:
    """Return the cosines between the normals and the ways to the points."""
    way = points - closest
    length = np.linalg.norm(way, axis=1)
    dots = np.einsum("ij,ij->i", way, normals)
    return np.asarray(np.divide(dots, length, out=np.full(len(dots), -1.0), where=length > 0))
