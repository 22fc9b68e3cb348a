"""Cross sections."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import triple
from .places import Floats, SceneLike, frames, scene_of, sealed, unit
from .triangles import triangles


@dataclass(frozen=True, eq=False, repr=False)
class CrossSection:
    """Where a plane cuts meshes.

    Attributes
    ----------
    lines : tuple of (K, 3) float64
        Polylines, read-only; the last point of a closed one is the first again. Seen against the plane's
        normal, closed ones of a body whose normals point out turn anticlockwise, and those of its holes
        clockwise.
    closed : tuple of bool
        Whether each is closed: all are, where meshes are.
    area : float
        What closed lines enclose, holes subtracted; negative where normals point in.
    length : float
        Of all lines.
    """

    lines: tuple[Floats, ...]
    closed: tuple[bool, ...]
    area: float
    length: float

    def __len__(self) -> int:
        return len(self.lines)

    def __repr__(self) -> str:
        loops = sum(self.closed)
        return f"CrossSection({loops} closed and {len(self) - loops} open lines, area={self.area:g})"


def cross_section(scene: SceneLike, point: ArrayLike, normal: ArrayLike) -> CrossSection:
    """Cut meshes with a plane.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that a Scene is made of
        Meshes, and copies of them that stand still.
    point : 3 floats
        Through which the plane goes.
    normal : 3 floats
        Of the plane, of any length.

    Returns
    -------
    CrossSection
        Its polylines; none where the plane passes the meshes by.

    Raises
    ------
    ValueError
        If something in the scene is no mesh or moves, a number is not finite, or the normal has no length.
    TypeError
        If something is no number.

    Notes
    -----
    On which side of the plane a corner lies is decided once for all faces that share it, and a corner exactly
    on it counts as above (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990): so lines of closed
    meshes close, whatever the plane goes through, and a face that lies in the plane is cut along its edge if
    at all. Equal corners are one. Each point is computed once, on its edge, and is right to a few units in
    the last place of the corners. Vertices are those of the meshes, not rounded as a scene may round them.
    """
    origin, way = np.array(triple("point", point)), unit("normal", normal)
    corners, faces = triangles(scene_of(scene))
    height = (corners - origin) @ way
    above = height >= 0
    sides = above[faces].sum(axis=1)
    cut = faces[(sides == 1) | (sides == 2)]
    # Each face is turned so that its first corner is the one that is alone on its side.
    alone = above[cut] == (above[cut].sum(axis=1) == 1)[:, None]
    turn = (np.argmax(alone, axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(cut, turn, axis=1).T
    # A line goes on with the inside on its left: from edge ab to ca if a is above, else the other way.
    first, second = _edges(a, b), _edges(a, c)
    is_up = above[a][:, None]
    edges = np.concatenate([np.where(is_up, first, second), np.where(is_up, second, first)])
    names, ends = np.unique(edges, axis=0, return_inverse=True)
    points = _crossings(corners, height, names)
    lines, closed = _chained(points, ends.reshape(2, -1))
    across = np.stack(frames(way), axis=-1)
    loops = [line for line, is_closed in zip(lines, closed, strict=True) if is_closed]
    area = sum(_area((line - origin) @ across) for line in loops)
    length = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)
    return CrossSection(lines, closed, float(area), length)


def _edges(a: NDArray[np.int64], b: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the ends of edges, the lesser first, so that both faces of an edge know it by the same."""
    return np.stack([np.minimum(a, b), np.maximum(a, b)], axis=-1)


def _crossings(corners: Floats, height: Floats, edges: NDArray[np.int64]) -> Floats:
    """Return where edges are cut whose ends lie on different sides."""
    a, b = edges.T
    share = (height[a] / (height[a] - height[b]))[:, None]
    points: Floats = corners[a] * (1.0 - share) + corners[b] * share
    return points


def _chained(points: Floats, ends: NDArray[np.int64]) -> tuple[tuple[Floats, ...], tuple[bool, ...]]:
    """Join segments, from one point to another each, to lines: open ones first."""
    starts, stops = ends.tolist()
    leaving: dict[int, list[int]] = {}
    for start, stop in zip(starts, stops, strict=True):
        leaving.setdefault(start, []).append(stop)
    # An open line begins where more segments leave than arrive.
    spare = np.bincount(ends[0], minlength=len(points)) - np.bincount(ends[1], minlength=len(points))
    begins = np.repeat(np.arange(len(points)), np.maximum(spare, 0)).tolist()
    lines, closed = [], []
    for begin in [*begins, *starts]:
        line = [begin]
        while following := leaving.get(line[-1]):
            line.append(following.pop())
        if len(line) > 1:
            lines.append(sealed(points[line]))
            closed.append(line[0] == line[-1])
    return tuple(lines), tuple(closed)


def _area(flat: Floats) -> float:
    """Return what a closed line in a plane encloses, by the shoelace formula about its first point."""
    x, y = (flat - flat[0]).T
    return 0.5 * float((x[:-1] * y[1:] - x[1:] * y[:-1]).sum())
