"""Wrong answers per million rays, of every engine, where float32 arithmetic decides badly.

    python benches/stress.py [--rays 10000] [--engines embreex,open3d]

Each case is a mesh and rays, all of them float32, so that every engine is given the same numbers. The truth
is that of exact rational arithmetic (`tests/python/helpers/exact_hits.py`), which shares no code with the
core.
Wrong is an answer "hit" or "miss" that is not the exact one, and a hit that is off from the closest exact
one by more than a ten-thousandth of the way to it and of the size of the mesh: it is then of another
surface.
"""

import argparse
import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
import trimesh
from peers import ENGINES, chosen, installed
from peers_rays import Rays, unit
from peers_tables import head, line

sys.path.append(str(Path(__file__).parents[1] / "tests" / "python" / "helpers"))
from exact_hits import candidates

# A hit farther off than this share of the ray and of the mesh belongs to another surface.
_APART = 1e-4


class Stress(NamedTuple):
    """A case: its name, (V, 3) float32 vertices, (F, 3) faces, and rays."""

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    rays: Rays


def cases(count, seed=0):
    """Yield all cases, each with so many rays."""
    rng = np.random.default_rng(seed)
    ball = trimesh.creation.icosphere(subdivisions=2)
    for make in (_random, _aimed, _inside, _in_faces, _far, _slivers, _tiny, _leaving):
        name, vertices, faces, origins, directions = make(rng, count, ball)
        origins, directions = (np.ascontiguousarray(x, np.float32) for x in (origins, directions))
        rays = Rays(origins, directions, np.inf, False)
        yield Stress(name, vertices.astype(np.float32), np.asarray(faces, np.int64), rays)


def _soup(rng, count):
    centers = rng.uniform(-1, 1, (count, 1, 3))
    corners = (centers + rng.uniform(-0.5, 0.5, (count, 3, 3))).astype(np.float32)
    return corners.reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def _targets(rng, vertices, faces, count):
    """Return places on a mesh, a third each at vertices, on edges and within faces."""
    a, b, c = np.moveaxis(vertices[faces[rng.integers(len(faces), size=count)]].astype(np.float64), 1, 0)
    kind, along = rng.integers(3, size=(count, 1)), rng.uniform(0, 1, (count, 1))
    return np.where(kind == 0, a, np.where(kind == 1, a + (b - a) * along, (a + b + c) / 3))


def _random(rng, count, ball):
    vertices, faces = _soup(rng, 80)
    return (
        "random rays at random triangles",
        vertices,
        faces,
        rng.uniform(-1.5, 1.5, (count, 3)),
        rng.normal(size=(count, 3)),
    )


def _aimed(rng, count, ball):
    vertices, faces = _soup(rng, 80)
    origins = rng.uniform(-3, 3, (count, 3)).astype(np.float32)
    return (
        "aimed at vertices and edges",
        vertices,
        faces,
        origins,
        _targets(rng, vertices, faces, count) - origins,
    )


def _inside(rng, count, ball):
    """Nothing leaves a closed mesh: each miss is a leak."""
    origins = rng.uniform(-0.3, 0.3, (count, 3)).astype(np.float32)
    vertices = ball.vertices.astype(np.float32)
    directions = _targets(rng, vertices, ball.faces, count) - origins
    return "leaks of a closed mesh", vertices, ball.faces, origins, directions


def _in_faces(rng, count, ball):
    """Rays on a grid of halves: in the faces of boxes, along their edges, through their corners."""
    corners = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])
    places = np.array([(x, y, z) for x in range(3) for y in range(3) for z in range(3)]) * 2
    vertices = (places[:, None] + corners).reshape(-1, 3)
    faces = (8 * np.arange(len(places))[:, None, None] + faces).reshape(-1, 3)
    directions = rng.integers(-1, 2, (count, 3))
    directions[~directions.any(axis=1)] = 1, 0, 0
    return "in faces, along edges", vertices, faces, rng.integers(-4, 15, (count, 3)) / 2, directions


def _far(rng, count, ball):
    """From ten thousand times the size of the mesh, at its edges."""
    origins = (1e4 * unit(rng.normal(size=(count, 3)))).astype(np.float32)
    vertices = ball.vertices.astype(np.float32)
    return (
        "from far away",
        vertices,
        ball.faces,
        origins,
        _targets(rng, vertices, ball.faces, count) - origins,
    )


def _slivers(rng, count, ball, aspect=1e4):
    a, along = rng.uniform(-1, 1, (60, 3)), unit(rng.normal(size=(60, 3)))
    across = rng.normal(size=(60, 3))
    across = unit(across - along * np.sum(across * along, axis=1, keepdims=True))
    corners = np.stack([a, a + along, a + along / 2 + across / aspect], axis=1).astype(np.float32)
    origins = rng.uniform(-3, 3, (count, 3)).astype(np.float32)
    weights = rng.dirichlet([0.5, 0.5, 0.5], count)
    targets = np.einsum("ni,nij->nj", weights, corners[rng.integers(60, size=count)].astype(np.float64))
    return "slivers", corners.reshape(-1, 3), np.arange(180).reshape(-1, 3), origins, targets - origins


def _tiny(rng, count, ball):
    """Return a model that measures a micrometer, in meters."""
    scale = 1e-6
    vertices = (ball.vertices * scale).astype(np.float32)
    origins = (rng.uniform(-2, 2, (count, 3)) * scale).astype(np.float32)
    targets = _targets(rng, vertices, ball.faces, count)
    return "a model of a micrometer", vertices, ball.faces, origins, (targets - origins) / scale


def _leaving(rng, count, ball):
    """From points of a surface, rounded to float32: which side they are on is decided by rounding alone."""
    vertices = ball.vertices.astype(np.float32)
    corners = vertices[ball.faces[rng.integers(len(ball.faces), size=count)]].astype(np.float64)
    places = np.einsum("ni,nij->nj", rng.dirichlet([1, 1, 1], count), corners)
    return "leaving a surface", vertices, ball.faces, places, unit(rng.normal(size=(count, 3)))


def truth(case):
    """Return the t of the closest exact hit of each ray; inf where there is none."""
    origins, directions = (x.astype(np.float64) for x in case.rays[:2])
    triangles = case.vertices.astype(np.float64)[case.faces]
    found = candidates(triangles, origins, directions)
    return np.array([min((c.nearest for c in ray if c.t >= 0), default=np.inf) for ray in found])


def wrong(case, t, exact):
    """Return per million rays: wrong answers "hit" or "miss", and hits of another surface."""
    t, hit, should = np.asarray(t, np.float64), np.isfinite(t), np.isfinite(exact)
    both = hit & should
    # In units of the direction's length, like t.
    size = np.ptp(case.vertices, axis=0).max() / np.linalg.norm(case.rays.directions[both], axis=1)
    elsewhere = np.abs(t[both] - exact[both]) > _APART * (exact[both] + size)
    return 1e6 * float(np.mean(hit != should)), 1e6 * float(np.sum(elsewhere)) / len(t)


def measured(engines, count, threads=1):
    """Return a record for each case and engine; the worst of an engine's modes."""
    records = []
    for case in cases(count):
        exact = truth(case)
        for engine in engines:
            engine.build(case.vertices, case.faces)
            engine.use(min(threads, engine.most_threads or threads))
            answers = [engine.trace(case.rays, mode) for mode in engine.modes]
            pairs = [wrong(case, np.where(hit, t, np.inf), exact) for hit, t in answers]
            decided, elsewhere = max(pairs, key=sum)
            record = {"case": case.name, "engine": engine.name, "rays": count}
            records.append(record | {"wrong_hit_or_miss": decided, "another_surface": elsewhere})
    return records


def table(records):
    """Return a table of wrong answers per million: cases in rows, engines in columns."""
    engines = list(dict.fromkeys(r["engine"] for r in records))
    rows = [head(["wrong per million", *engines])]
    for case in dict.fromkeys(r["case"] for r in records):
        of = {r["engine"]: r for r in records if r["case"] == case}
        cells = [of[e]["wrong_hit_or_miss"] + of[e]["another_surface"] for e in engines]
        rows.append(line([case, *(f"{cell:,.0f}" for cell in cells)]))
    return "\n".join(rows)


def main():
    """Count, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rays", type=int, default=10_000, help="rays of each case")
    parser.add_argument("--engines", type=chosen(ENGINES), default=ENGINES, help=f"of {', '.join(ENGINES)}")
    options = parser.parse_args()
    names = ["raywright", *(name for name in options.engines if name != "raywright")]
    print(table(measured(installed(names), options.rays)))


if __name__ == "__main__":
    main()
