"""Radiosity by the matrix of view factors."""

import numpy as np

from ..scene.instance import AnyShape
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .problem import EMITTED, ESCAPED, REPLICATES, Problem
from .solution import Floats, RadiositySolution
from .view_factors import view_factors

# The matrix and its factors take 24 bytes an entry: 1.6 GB.
_MOST = 8192
# Rays of a replicate to the lights, of a patch.
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
        raise ValueError(
            f"method='matrix' is for {_MOST} patches at most, these are {count}: use 'stochastic'"
        )
    factors = view_factors(
        _of_patches(problem),
        error=error,
        seed=problem.seed,
        threads=problem.threads,
        progress=False,
    )
    matrix, spread = (
        np.asarray(_dense(part), np.float64) for part in (factors.matrix, factors.standard_error)
    )
    light, light_error, books = _first_light(problem, rays)
    emission, reflectance = problem.emission, problem.reflectance
    irradiance, errors = np.empty_like(light), np.empty_like(light)
    for channel in range(3):
        rho = reflectance[:, channel]
        system = np.eye(count) - rho[:, None] * matrix
        radiosity = np.linalg.solve(system, emission[:, channel] + rho * light[:, channel])
        irradiance[:, channel] = matrix @ radiosity + light[:, channel]
        books[ESCAPED, channel] = (problem.areas * radiosity * np.asarray(factors.rest)).sum()
        # What is off in a row of the matrix, and in its first light, comes to all by what they reflect.
        own = spread**2 @ radiosity**2 + light_error[:, channel] ** 2
        if own.any():
            carried = matrix @ np.linalg.solve(system, np.diag(rho)) + np.eye(count)
            errors[:, channel] = np.sqrt(carried**2 @ own)
        else:
            errors[:, channel] = 0.0
    problem.note_end(problem.core.rays if problem.has_lamps else 0)
    return problem.solved("matrix", irradiance, errors, books)


def _dense(part: object) -> object:
    return part.toarray() if hasattr(part, "toarray") else part


def _first_light(problem: Problem, rays: int | None) -> tuple[Floats, Floats, Floats]:
    """Return the irradiance by lights that are no surfaces, its error, and the books so far."""
    mine = _LIGHT_RAYS * len(problem.areas) if rays is None else max(rays // REPLICATES, 1)
    problem.begin(0, mine)
    arrived = problem.core.arrived / problem.areas[:, None]
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
