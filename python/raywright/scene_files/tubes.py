"""Curves with a radius, as meshes: straight ones with round joints, and cubic B-splines."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

# Faces around a tube: they deviate from the circle by at most 0.22 % of its radius, 1 - cos(π / 48).
_SIDES = 48
# For more triangles, the number of faces is halved repeatedly, down to the fewest.
_MOST_TRIANGLES, _FEWEST = 4_000_000, 6
# Pieces per segment of a B-spline. Chords deviate from the axis by at most 1/8 of its second difference over
# the square of their number, the bound in `_pieces`.
_MOST_PIECES = 64
_BENDS = 1e-3


class Tube(NamedTuple):
    """The surface of curves: (V, 3), (F, 3), (V, 3) normals and (V, 2) coordinates."""

    vertices: Floats
    faces: NDArray[np.int64]
    normals: Floats
    uv: Floats


# Offset of a ball's coordinate into its segment, so that rounding does not put it before a change of pattern.
_BEYOND = 2e-7


def linear(curves: list[Floats]) -> Tube:
    """Return what a ball sweeps that goes straight from point to point, its radius changing evenly."""
    segments = sum(len(curve) - 1 for curve in curves)
    sides = _sides(segments, 2)
    parts = []
    first = 0
    for curve in curves:
        for k, (a, b) in enumerate(pairwise(curve)):
            span = (first + k) / segments, (first + k + 1) / segments
            if (tube := _cone(a, b, sides, span)) is not None:
                parts.append(tube)
        for k, point in enumerate(curve):
            # Takes the coordinates around the preceding segment.
            a, b = curve[max(k, 1) - 1 : max(k, 1) + 1, :3]
            parts.append(_ball(point, b - a, sides, (first + k) / segments + _BEYOND))
        first += len(curve) - 1
    return _joined(parts)


def b_spline(curves: list[Floats]) -> Tube:
    """Return the tubes about uniform cubic B-splines, open at their ends."""
    segments = sum(len(curve) - 3 for curve in curves)
    pieces = _pieces(curves)
    sides = _sides(segments, pieces)
    parts = []
    first = 0
    for curve in curves:
        own = len(curve) - 3
        at = np.linspace(0.0, own, own * pieces + 1)
        parts.append(_swept(*_spline(curve, at), sides, (first + at) / segments))
        first += own
    return _joined(parts)


def _sides(segments: int, pieces: int) -> int:
    sides = _SIDES
    while sides > _FEWEST and 2 * sides * pieces * segments > _MOST_TRIANGLES:
        sides //= 2
    return sides


def _pieces(curves: list[Floats]) -> int:
    """Return in how many straight pieces segments are cut, which then stray by 1e-3 of the radius."""
    bend = 1e-30
    for curve in curves:
        second = np.linalg.norm(np.diff(curve[:, :3], 2, axis=0), axis=1).max()
        hop = np.linalg.norm(np.diff(curve[:, :3], axis=0), axis=1).max()
        size = max(curve[:, 3].max(), 0.05 * hop)
        bend = max(bend, second / size if size > 0 else 0.0)
    return int(np.clip(np.ceil(np.sqrt(bend / (8 * _BENDS))), 2, _MOST_PIECES))


def _spline(curve: Floats, at: Floats) -> tuple[Floats, Floats, Floats]:
    """Return points of a spline with their radii, and its first and second derivatives, (N, 4) each."""
    which = np.minimum(at.astype(np.int64), len(curve) - 4)
    t = (at - which)[:, None]
    a, b, c, d = (curve[which + k] for k in range(4))
    points = (
        (1 - t) ** 3 * a + (3 * t**3 - 6 * t**2 + 4) * b + (-3 * t**3 + 3 * t**2 + 3 * t + 1) * c + t**3 * d
    ) / 6
    first = (-((1 - t) ** 2) * a + (3 * t**2 - 4 * t) * b + (-3 * t**2 + 2 * t + 1) * c + t**2 * d) / 2
    second = (1 - t) * a + (3 * t - 2) * b + (1 - 3 * t) * c + t * d
    return points, first, second


def _frames(axes: Floats) -> tuple[Floats, Floats]:
    """Return two directions across each axis, the first as near to +z as can be: from there angles count."""
    guide = np.array([0.0, 0.0, 1.0])
    rot = guide - axes * (axes @ guide)[:, None]
    length = np.linalg.norm(rot, axis=1, keepdims=True)
    rot = np.where(length > 1e-12, rot / np.maximum(length, 1e-300), (0.0, 1.0, 0.0))
    return rot, np.cross(rot, axes)


def _swept(points: Floats, first: Floats, second: Floats, sides: int, along: Floats) -> Tube:
    """Return the circles about a line, at right angles to it, joined."""
    lengths = np.linalg.norm(first[:, :3], axis=1)
    axes = first[:, :3] / np.maximum(lengths, 1e-300)[:, None]
    rot, rad = _frames(axes)
    turn = 2 * np.pi * np.arange(sides + 1) / sides
    out = np.cos(turn)[None, :, None] * rad[:, None] + np.sin(turn)[None, :, None] * rot[:, None]
    offset = points[:, None, 3:] * out
    # The normal of a tube that bends and widens.
    bend = (lengths**2)[:, None] - (offset * second[:, None, :3]).sum(-1)
    normals = bend[..., None] * out - first[:, None, 3:] * first[:, None, :3]
    uv = np.stack(np.broadcast_arrays(np.arange(sides + 1)[None] / sides, along[:, None]), -1)
    return _grid(points[:, None, :3] + offset, normals, uv)


def _cone(a: Floats, b: Floats, sides: int, span: tuple[float, float]) -> Tube | None:
    """Return what touches two balls all around; None where one holds the other."""
    axis = b[:3] - a[:3]
    length = float(np.linalg.norm(axis))
    grows = float(b[3] - a[3])
    if length <= abs(grows):
        return None
    axis = axis / length
    # Cosine and sine of the angle between the normal and the plane across.
    sin = -grows / length
    cos = np.sqrt(1 - sin * sin)
    rot, rad = (one[0] for one in _frames(axis[None]))
    turn = 2 * np.pi * np.arange(sides + 1) / sides
    out = np.cos(turn)[:, None] * rad + np.sin(turn)[:, None] * rot
    normals = np.broadcast_to(cos * out + sin * axis, (2, sides + 1, 3))
    ends = np.stack([a[:3] + a[3] * normals[0], b[:3] + b[3] * normals[1]])
    uv = np.stack(np.broadcast_arrays(np.arange(sides + 1)[None] / sides, np.array(span)[:, None]), -1)
    return _grid(ends, normals, uv)


def _ball(point: Floats, axis: Floats, sides: int, along: float) -> Tube:
    length = float(np.linalg.norm(axis))
    axis = axis / length if length > 0 else np.array([0.0, 0.0, 1.0])
    rot, rad = (one[0] for one in _frames(axis[None]))
    rings = max(sides // 2, 3)
    polar = np.pi * np.arange(rings + 1) / rings
    turn = 2 * np.pi * np.arange(sides + 1) / sides
    out = np.cos(turn)[:, None] * rad + np.sin(turn)[:, None] * rot
    normals = np.sin(polar)[:, None, None] * out + np.cos(polar)[:, None, None] * axis
    uv = np.stack(np.broadcast_arrays(np.arange(sides + 1)[None] / sides, np.full((rings + 1, 1), along)), -1)
    # Rows run from pole to pole, which reverses the winding of the grid.
    return _grid(point[:3] + point[3] * normals, normals, uv, flipped=True)


def _grid(points: Floats, normals: Floats, uv: Floats, flipped: bool = False) -> Tube:
    """Return the mesh of a grid of points, (N, M, 3): what turns from row to row has its front outside."""
    rows, columns = points.shape[:2]
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, 1:], corner[1:, :-1]
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)], axis=-1).reshape(-1, 3)
    lengths = np.linalg.norm(normals, axis=-1, keepdims=True)
    normals = normals / np.maximum(lengths, 1e-300)
    if flipped:
        faces = faces[:, ::-1]
    return Tube(points.reshape(-1, 3), faces, normals.reshape(-1, 3), uv.reshape(-1, 2))


def _joined(parts: list[Tube]) -> Tube:
    starts = np.cumsum([0, *(len(part.vertices) for part in parts[:-1])])
    return Tube(
        np.concatenate([part.vertices for part in parts]),
        np.concatenate([part.faces + start for part, start in zip(parts, starts, strict=True)]),
        np.concatenate([part.normals for part in parts]),
        np.concatenate([part.uv for part in parts]),
    )
