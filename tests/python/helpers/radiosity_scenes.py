"""Enclosures with known radiosities, that tests share."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh

import raywright as rw

# Corners of a unit cube's faces, anticlockwise as seen from inside: floor, ceiling, then walls.
CUBE = [
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
    [(0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)],
    [(0, 0, 0), (0, 0, 1), (1, 0, 1), (1, 0, 0)],
    [(0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1)],
    [(0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1)],
    [(1, 0, 0), (1, 0, 1), (1, 1, 1), (1, 1, 0)],
]


def radiance(emitted: float) -> float | None:
    """The radiance of a radiosity by emission."""
    return emitted / np.pi if emitted else None


def cube(reflectance: Sequence[float], emitted: Sequence[float]) -> rw.Scene:
    """A closed room of six squares, each one patch."""
    return rw.Scene(
        [
            rw.Polygon(corners, material=rw.Diffuse(rho), emission=radiance(e))
            for corners, rho, e in zip(CUBE, reflectance, emitted, strict=True)
        ]
    )


def room(reflectance: Any = 0.6, emitted: Sequence[float] = (1,) * 6) -> rw.Scene:
    """The same of two triangles a side."""
    return rw.Scene(
        [
            rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(reflectance), emission=radiance(e))
            for corners, e in zip(CUBE, emitted, strict=True)
        ]
    )


def square(
    height: float, up: bool, reflectance: float = 0.5, emitted: float = 0.0, size: float = 1.0
) -> rw.Mesh:
    """A square across z, of two triangles."""
    half = size / 2
    corners = [(-half, -half, height), (half, -half, height), (half, half, height), (-half, half, height)]
    faces = [(0, 1, 2), (0, 2, 3)] if up else [(0, 2, 1), (0, 3, 2)]
    return rw.Mesh(corners, faces, material=rw.Diffuse(reflectance), emission=radiance(emitted))


def turned(profile: Sequence[tuple[float, float]], around: int) -> trimesh.Trimesh:
    """What a line of (radius, z) sweeps around z: what goes up looks inwards, what goes outwards up."""
    angles = 2 * np.pi * np.arange(around) / around
    # The same area as the circle's polygon: slightly larger radii.
    grown = np.sqrt(2 * np.pi / around / np.sin(2 * np.pi / around))
    rings = [
        np.column_stack([r * grown * np.cos(angles), r * grown * np.sin(angles), np.full(around, z)])
        for r, z in profile
    ]
    faces = []
    for ring in range(len(profile) - 1):
        for i in range(around):
            a, b = ring * around + i, ring * around + (i + 1) % around
            c, d = a + around, b + around
            faces += [(a, d, b), (a, c, d)]
    vertices = np.concatenate(rings)
    corners = vertices[np.array(faces)]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return trimesh.Trimesh(vertices, np.array(faces)[area > 1e-12], process=False)


def swept(
    profile: Sequence[tuple[float, float]], around: int, reflectance: float, emitted: float = 0.0
) -> rw.Mesh:
    """The same as a diffuse mesh."""
    mesh = turned(profile, around)
    return rw.Mesh(mesh.vertices, mesh.faces, material=rw.Diffuse(reflectance), emission=radiance(emitted))


def zone(start: float, end: float, strips: int) -> list[tuple[float, float]]:
    """The profile of a unit sphere between two heights, from low to high, in strips of equal angles."""
    angles = np.linspace(np.arccos(start), np.arccos(end), strips + 1)
    return [(float(np.sin(a)), float(np.cos(a))) for a in angles]


def mean(solution: rw.exchange.RadiositySolution, what: np.ndarray, shape: int, side: int = 1) -> float:
    """The mean by area of the red channel of a shape."""
    rows = (solution.patches["shape"] == shape) & (solution.patches["side"] == side)
    return float(np.average(what[rows, 0], weights=solution.areas[rows]))
