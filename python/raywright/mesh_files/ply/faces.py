"""Faces of PLY files: polygons, or strips of triangles, with the corners that they have."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..corners import distinct
from ..elements import Data, Lists
from ..triangulation import polygon_of, triangulate

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

_INDICES = ("vertex_indices", "vertex_index")


class Faces(NamedTuple):
    """Triangles of a PLY file.

    Attributes
    ----------
    faces : (F, 3) array
        Indices of `used`.
    used : (V,) array
        The vertex of the file that each vertex is.
    polygon : (F,) array, optional
        The polygon of the file that each face is part of; None for strips.
    uv : (V, 2) array, optional
        Texture coordinates, if faces rather than vertices have them.
    """

    faces: Integers
    used: Integers
    polygon: Integers | None
    uv: Floats | None = None


def faces_of(elements: dict[str, Data], points: Floats) -> Faces | None:
    """Return the triangles of a file, None if it has no faces.

    Raises
    ------
    ValueError
        If a face has a vertex that is not there.
    """
    everything = np.arange(len(points))
    if "face" in elements and (polygons := indices_of(elements["face"])) is not None:
        corners = _checked(polygons.values, len(points))
        triangles = triangulate(points, corners, polygons.counts)
        polygon = polygon_of(polygons.counts)
        uv = _corner_uv(elements["face"], polygons.counts)
        if uv is None:
            return Faces(corners[triangles], everything, polygon)
        _, which = np.unique(uv, axis=0, return_inverse=True)
        used, place = distinct([corners, which.reshape(-1)])
        return Faces(place[triangles], corners[used], polygon, uv[used])
    if "tristrips" in elements and (strips := indices_of(elements["tristrips"])) is not None:
        faces = _strips(strips)
        _checked(faces, len(points))
        return Faces(faces, everything, None)
    return None


def indices_of(faces: Data) -> Lists | None:
    """Return the list of vertices: the one of that name, or else the first whose name says nothing else."""
    for name in _INDICES:
        if name in faces.lists:
            return faces.lists[name]
    others = [held for name, held in faces.lists.items() if name != "texcoord"]
    return others[0] if others else None


def _checked(given: NDArray[np.generic], count: int) -> Integers:
    with np.errstate(invalid="ignore"):
        indices = given.astype(np.int64)
    outside = (indices < 0) | (indices >= count)
    if outside.any():
        raise ValueError(f"a face has vertex {indices[outside][0]}, but there are {count} vertices")
    return indices


def _corner_uv(faces: Data, counts: Integers) -> Floats | None:
    """Return texture coordinates of all corners, (0, 0) where a face has none; None if no face has any."""
    given = faces.lists.get("texcoord")
    if given is None or not (given.counts > 0).any():
        return None
    known = (given.counts == 2 * counts) & (counts > 0)
    uv = np.zeros((int(counts.sum()), 2))
    uv[np.repeat(known, counts)] = given.values[np.repeat(known, given.counts)].reshape(-1, 2)
    return uv


def _strips(strips: Lists) -> Integers:
    """Return the triangles of strips, which begin anew after -1, and turn alternately."""
    indices = strips.values.astype(np.int64)
    begins = np.zeros(len(indices) + 1, np.bool_)
    begins[np.cumsum(strips.counts)] = True
    begins[0] = True
    begins[1:] |= indices == -1
    at = np.arange(len(indices))
    # Number of preceding corners in the same strip.
    first = np.maximum.accumulate(np.where(begins[:-1], at, 0))
    within = at - first
    last = at[(indices != -1) & (within >= 2)]
    faces = np.stack([indices[last - 2], indices[last - 1], indices[last]], axis=1)
    turned = within[last] % 2 == 1
    faces[turned] = faces[turned][:, [1, 0, 2]]
    return faces
