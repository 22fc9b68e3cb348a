"""Radiosity by the matrix of view factors."""

from __future__ import annotations

import numpy as np

from ..scene.instance import AnyShape
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .problem import EMITTED, ESCAPED, REPLICATES, Problem
from .solution import Floats, RadiositySolution
from .view_factor_matrix import ViewFactors
from .view_factors import view_factors

# The matrix and its factors take 24 bytes per entry: 1.6 GB.
_MOST = 8192
# Rays per replicate and patch towards the lights.
_LIGHT_RAYS = 256


def solve(problem: Problem, error: float | None, rays: int | None) -> RadiositySolution:
    """Return the solution by view factors and Gauss's elimination, with errors of first order.

    Raises
    ------
    ValueError
        If there are more than 8192 patches.
    """
    count = len(problem.areas)
    if count > _MOST:
        raise ValueError(f"method='matrix' supports at most {_MOST} patches, got {count}: use 'stochastic'")
    factors = view_factors(
        _of_patches(problem),
        error=error,
        seed=problem.seed,
        threads=problem.threads,
        progress=False,
    )
    matrix = np.asarray(factors.matrix)
    light, light_error, books = _first_light(problem, rays)
    emission, reflectance = problem.emission, problem.reflectance
    irradiance, errors = np.empty_like(light), np.empty_like(light)
    for channel in range(3):
        rho = reflectance[:, channel]
        system = np.eye(count) - rho[:, None] * matrix
        radiosity = np.linalg.solve(system, emission[:, channel] + rho * light[:, channel])
        irradiance[:, channel] = matrix @ radiosity + light[:, channel]
        books[ESCAPED, channel] = (problem.areas * radiosity * np.asarray(factors.to_surroundings)).sum()
        errors[:, channel] = _error(factors, radiosity, light_error[:, channel], system, rho)
    problem.note_end(problem.core.rays if problem.has_lamps else 0)
    return problem.solved("matrix", irradiance, errors, books)


def _error(
    factors: ViewFactors, radiosity: Floats, light_error: Floats, system: Floats, rho: Floats
) -> Floats:
    """Return the standard error of the irradiance.

    An error in a row of the matrix, and in its first light, reaches all faces through their reflectances. The
    exchange of two faces is one estimate: its error is in both of their rows.
    """
    own, both = factors._centered(radiosity)
    squares = (own**2).sum(axis=1) + light_error**2
    if not squares.any():
        return np.zeros(len(rho))
    carried = np.asarray(factors.matrix) @ np.linalg.solve(system, np.diag(rho)) + np.eye(len(rho))
    variance: Floats = carried**2 @ squares + ((carried @ both) * carried).sum(axis=1)
    return np.asarray(np.sqrt(np.maximum(variance, 0.0)), np.float64)


def _first_light(problem: Problem, rays: int | None) -> tuple[Floats, Floats, Floats]:
    """Return the irradiance by lights that are not surfaces, its error, and the books so far."""
    mine = _LIGHT_RAYS * len(problem.areas) if rays is None else max(rays // REPLICATES, 1)
    problem.begin(0, mine)
    arrived = problem.per_area(problem.core.arrived)
    books = np.zeros((4, 3))
    books[EMITTED] = problem.core.books.mean(axis=0)[EMITTED]
    return arrived.mean(axis=0), arrived.std(axis=0, ddof=1) / np.sqrt(REPLICATES), books


def _of_patches(problem: Problem) -> Scene:
    """Return a scene whose faces are the patches, in their order."""
    scene = problem.laid.scene
    if (problem.cuts == 1).all():
        return scene
    shapes: list[AnyShape] = []
    corners, start, first = problem.core.corners, 0, 0
    for shape in scene.shapes:
        if not isinstance(shape, Mesh):
            shapes.append(shape)
            start, first = start + 1, first + 1
            continue
        count = int((problem.cuts[first : first + len(shape.faces)].astype(np.int64) ** 2).sum())
        places = corners[start : start + count].reshape(-1, 3)
        shapes.append(Mesh(places, np.arange(len(places)).reshape(-1, 3), material=shape.material))
        start, first = start + count, first + len(shape.faces)
    return Scene(shapes, precision="double")
