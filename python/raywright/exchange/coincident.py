"""Coincident faces: they are one surface, and the first listed counts."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..io.quiet import warn_caller
from ..scene.instance import AnyShape
from ..shapes import Shape
from ..shapes.mesh import Mesh
from .copies import LaidOut

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

# A face coincides with others if they leave a smaller share of it uncovered.
_LEFT = 1e-3
# Fields of a shape that do not affect its geometry.
_LOOKS = {"material", "emission", "name"}


@dataclass(frozen=True)
class Covered:
    """Coincident faces, and the shares by which others stand for them.

    Attributes
    ----------
    faces : (D,) int64
        The faces, in rising order.
    starts : (D,) int64
        Where the part of each starts in `by` and `shares`.
    by, shares : (K,)
        Faces in whose places they lie, and the shares of their areas; each face's add up to 1.
    areas : (D,) float64
        Areas of the faces.
    turned : (D,) bool
        True if it faces the other way: its front is the back of the faces in whose places it lies.
    before : LaidOut, optional
        The scene with them, where some are turned.
    """

    faces: Integers
    starts: Integers
    by: Integers
    shares: Floats
    areas: Floats
    turned: NDArray[np.bool_]
    before: LaidOut | None = None

    def __len__(self) -> int:
        return len(self.faces)

    def means(self, values: Floats, power: int = 1) -> Floats:
        """Return for each face the sum of shares, to a power, times values (F, ...) of others, (D, ...)."""
        weights = self.shares.reshape(-1, *[1] * (values.ndim - 1)) ** power
        return np.asarray(np.add.reduceat(values[self.by] * weights, self.starts))

    def sides(self, values: list[Floats]) -> list[Floats]:
        """Return for each face and side the means of values of the faces that stand for it.

        `values` are those of all fronts, (F, ...), and of all backs, if these take part.
        """
        means = [self.means(of) for of in values]
        turned = self.turned.reshape(-1, *[1] * (values[0].ndim - 1))
        return [np.where(turned, other, own) for own, other in zip(means, means[::-1], strict=True)]

    def with_backs(self, values: Floats) -> Floats:
        """Return values of all fronts and then all backs, (2 F, ...), as one face with two sides has them.

        The back of a face that stands for turned ones has the mean of their fronts.
        """
        if not self.turned.any():
            return values
        fronts, backs = np.split(values.astype(np.float64), 2)
        sizes = np.diff(np.append(self.starts, len(self.by)))
        turned = np.repeat(self.turned, sizes)
        one, other = self.by[turned], np.repeat(self.faces, sizes)[turned]
        weights = self.shares[turned] * np.repeat(self.areas, sizes)[turned]
        sums, whole = np.zeros_like(fronts), np.zeros(len(fronts))
        np.add.at(sums, one, (fronts[other].T * weights).T)
        np.add.at(whole, one, weights)
        stands = whole > 0
        backs[stands] = (sums[stands].T / whole[stands]).T
        gone = self.faces[self.turned]
        fronts[gone], backs[gone] = (of[self.turned] for of in self.sides([fronts, backs]))
        return np.concatenate([fronts, backs])

    @classmethod
    def of(
        cls,
        parts: dict[int, list[tuple[int, float]]],
        own: Floats,
        turned: set[int] | frozenset[int] = frozenset(),
    ) -> Covered:
        """Return faces by the areas that each has in common with others, and the areas of all faces."""
        faces = sorted(parts)
        sizes = [len(parts[face]) for face in faces]
        by = [other for face in faces for other, _ in parts[face]]
        areas = [[area for _, area in parts[face]] for face in faces]
        shares = [area / sum(of) for of in areas for area in of]
        starts = np.cumsum([0, *sizes])[:-1]
        rows = np.array(faces, np.int64)
        is_turned = np.array([face in turned for face in faces], np.bool_)
        return cls(rows, starts, np.array(by, np.int64), np.array(shares, np.float64), own[rows], is_turned)


NOTHING = Covered.of({}, np.zeros(0))


def merged(laid: LaidOut, both: bool = False) -> tuple[LaidOut, Covered]:
    """Return a scene in which each place has one face that exchanges light, and the faces that do not.

    A face all of whose area lies in faces before it, which look the same way, is shrunk to a point. If both
    sides of faces take part, so are faces that look the other way, where these and those before them cover
    each other: they are the backs of those.

    Warns
    -----
    RuntimeWarning
        If faces that look the same way coincide, in part or as a whole.
    """
    curved = _same_shapes(laid)
    pairs, areas, same, touch, own = _core.coincident_faces(laid.scene._compiled(), both)
    is_mesh = np.concatenate([np.zeros(0, np.bool_), *(_is_mesh(shape) for shape in laid.scene.shapes)])
    flat = is_mesh[pairs].all(axis=1)
    shapes_too = pairs[same & ~flat]
    pairs, areas, same, touch = pairs[flat], areas[flat], same[flat], touch[flat]
    order = np.lexsort((pairs[:, 0], pairs[:, 1]))
    parts: dict[int, list[tuple[int, float]]] = {face: [(twin, 1.0)] for face, twin in curved.items()}
    partly: set[int] = set()
    for face, found in _by_second(pairs[order[same[order]]], areas[order[same[order]]]):
        before = [(other, area) for other, area in found if other not in parts]
        if sum(area for _, area in before) >= (1.0 - _LEFT) * own[face]:
            parts[face] = before
        elif before:
            partly.add(face)
    partly |= {other for one, other in shapes_too.tolist() if one not in parts and other not in parts}
    if partly:
        warn_caller(
            f"{len(partly)} of {len(own)} faces partly overlap coplanar faces, "
            f"{_named(laid, min(partly))} first: their exchange there counts twice"
        )
    if parts:
        first = min(parts)
        warn_caller(
            f"{len(parts)} of {len(own)} faces coincide with others and are counted once with them: "
            f"{_named(laid, first)} first, with {_named(laid, parts[first][0][0])}"
        )
    sheets = ~same & ~touch
    turned = _backs(pairs[sheets], areas[sheets], own, set(parts)) if both else {}
    if not parts and not turned:
        return laid, NOTHING
    covered = Covered.of(parts | turned, own, set(turned))
    if turned:
        covered = replace(covered, before=laid)
    gone = np.zeros(len(own), np.bool_)
    gone[covered.faces] = True
    shapes: list[AnyShape] = []
    start = 0
    for shape in laid.scene.shapes:
        count = len(shape.faces) if isinstance(shape, Mesh) else 1
        shapes.append(_shrunk(shape, gone[start : start + count]))
        start += count
    return replace(laid, scene=laid.scene.replace(shapes=shapes)), covered


def _backs(pairs: Integers, areas: Floats, own: Floats, gone: set[int]) -> dict[int, list[tuple[int, float]]]:
    """Return faces that are backs of others, and which these are, with the areas in common.

    Groups of faces that look one way or the other, and that all lie in each other, are sheets: those that
    look as the first of them does remain.
    """
    opposed: dict[int, list[tuple[int, float]]] = {}
    for (one, other), area in zip(pairs.tolist(), areas.tolist(), strict=True):
        if one not in gone and other not in gone:
            opposed.setdefault(one, []).append((other, area))
            opposed.setdefault(other, []).append((one, area))
    backs: dict[int, list[tuple[int, float]]] = {}
    seen: set[int] = set()
    for first in sorted(opposed):
        if first in seen:
            continue
        seen.add(first)
        group, waiting = {first: False}, [first]
        while waiting:
            face = waiting.pop()
            for other, _ in opposed[face]:
                if other not in seen:
                    seen.add(other)
                    group[other] = not group[face]
                    waiting.append(other)
        if all(sum(area for _, area in opposed[face]) >= (1.0 - _LEFT) * own[face] for face in group):
            backs |= {face: opposed[face] for face, is_back in group.items() if is_back}
    return backs


def _named(laid: LaidOut, face: int | np.int64) -> str:
    return f"face {laid.face[face]} of shapes[{laid.shape[face]}]"


def _by_second(pairs: Integers, areas: Floats) -> list[tuple[int, list[tuple[int, float]]]]:
    """Return for each second face of sorted pairs the first ones, and the areas in common."""
    ends = np.flatnonzero(np.diff(pairs[:, 1])) + 1
    groups = zip(np.split(pairs, ends), np.split(areas, ends), strict=True)
    return [
        (int(some[0, 1]), list(zip(some[:, 0].tolist(), of.tolist(), strict=True)))
        for some, of in groups
        if len(some)
    ]


def _same_shapes(laid: LaidOut) -> dict[int, int]:
    """Return faces of shapes that are not meshes and are listed before, and which these are."""
    places: dict[Any, int] = {}
    found, start = {}, 0
    for shape in laid.scene.shapes:
        if isinstance(shape, Shape):
            first = places.setdefault(_place(shape), start)
            if first != start:
                found[start] = first
        start += len(shape.faces) if isinstance(shape, Mesh) else 1
    return found


def _place(shape: Shape) -> tuple[Any, ...]:
    values = {part.name: getattr(shape, part.name) for part in fields(shape) if part.name not in _LOOKS}
    return type(shape), *((name, np.asarray(value).tobytes()) for name, value in values.items())


def _is_mesh(shape: AnyShape) -> NDArray[np.bool_]:
    """Return for each face of a shape whether it is one of a mesh."""
    return np.ones(len(shape.faces), np.bool_) if isinstance(shape, Mesh) else np.zeros(1, np.bool_)


def _shrunk(shape: AnyShape, gone: NDArray[np.bool_]) -> AnyShape:
    """Return a shape some of whose faces are points."""
    if not gone.any():
        return shape
    if not isinstance(shape, Mesh):
        return Mesh(np.zeros((1, 3)), [[0, 0, 0]])
    faces = np.where(gone[:, None], shape.faces[:, :1], shape.faces)
    return Mesh(
        shape.vertices,
        faces,
        shape.normals,
        shape.uv,
        shape.material,
        shape.emission,
        shape.colors,
        shape.name,
    )
