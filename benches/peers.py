"""The same rays through every engine that is installed, from numpy arrays to numpy arrays.

    python benches/peers.py                       # a noisy torus and a room of long thin triangles
    python benches/peers.py --mesh bunny.ply      # any mesh that trimesh reads
    python benches/peers.py --triangles 1000000 --threads 1

Engines take turns on each set of rays, so that a noisy machine is noisy for all of them; what is printed are
medians, as a Markdown table. Before anything is timed, hits are compared: `disagree` counts the rays, per
million, on which an engine says hit where raywright says miss or the other way round, or differs in t by more
than a ten-thousandth.

Engines: raywright; embreex (one thread only); open3d (set OMP_NUM_THREADS for fewer threads than cores).
"""

import argparse
import os
import statistics
import time

import numpy as np

import raywright as rw


def torus(triangles, rng):
    """Return a torus with a rough surface: (V,3) vertices, (F,3) faces."""
    n = round((triangles / 2) ** 0.5)
    u, v = np.meshgrid(np.arange(n) * 2 * np.pi / n, np.arange(n) * 2 * np.pi / n, indexing="ij")
    radius = 0.4 + 0.4 / n * rng.normal(size=u.shape)
    ring = 1 + radius * np.cos(v)
    vertices = np.stack([ring * np.cos(u), radius * np.sin(v), ring * np.sin(u)], axis=-1).reshape(-1, 3)
    i, j = (x.reshape(-1) for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a, b, c, d = (i % n * n + j % n for i, j in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
    return vertices, np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])


def room(triangles, rng):
    """Return a room of beams and panels, cut into triangles that are long and thin."""
    count = max(triangles // 12, 1)
    size = np.abs(rng.normal(size=(count, 3))) * [0.02, 0.02, 0.02] + 0.002
    size[np.arange(count), rng.integers(3, size=count)] = rng.uniform(0.3, 1.5, count)
    centre = rng.uniform(-2, 2, (count, 3))
    unit = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    quads = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    vertices = centre[:, None] + unit * size[:, None] / 2
    return vertices.reshape(-1, 3), (faces + 8 * np.arange(count)[:, None, None]).reshape(-1, 3)


def given(path):
    """Return all triangles of a mesh file as one mesh."""
    shapes = rw.Scene(path).shapes
    starts = np.cumsum([0] + [len(s.vertices) for s in shapes])
    vertices = np.concatenate([s.vertices for s in shapes])
    return vertices, np.concatenate(
        [s.faces.astype(np.int64) + start for s, start in zip(shapes, starts, strict=False)]
    )


def ray_sets(scene, vertices, side, rng):
    """Return named sets of float32 rays: name -> (origins, directions, t_max, whether any hit will do)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    eye = centre + radius * 2.0 * np.array([0.45, 0.5, 0.74])
    camera = rw.Camera(eye, centre, fov=50, width=side, height=side)
    origins, directions = camera.rays()
    hits = scene.intersect(origins, directions)
    found = np.flatnonzero(hits.hit)
    chosen = found[rng.integers(len(found), size=side * side)]
    normal = hits.normal.reshape(-1, 3)[chosen]
    point = hits.position.reshape(-1, 3)[chosen]
    towards = directions.reshape(-1, 3)[chosen]
    normal *= -np.sign(np.sum(normal * towards, axis=1, keepdims=True))
    point = point + 1e-4 * radius * normal
    scattered = rng.normal(size=point.shape)
    scattered = normal + scattered / np.linalg.norm(scattered, axis=1, keepdims=True)
    lamp = centre + radius * np.array([1.2, 2.2, 0.4])
    inside = centre + (high - low) * 1.5 * (rng.random(point.shape) - 0.5)
    anywhere = rng.normal(size=point.shape)
    sets = {
        "primary": (origins, directions, np.inf, False),
        "diffuse": (point, scattered, np.inf, False),
        "random": (inside, anywhere, np.inf, False),
        "shadow any": (point, lamp - point, 1.0, True),
        "diffuse any": (point, scattered, np.inf, True),
        "random any": (inside, anywhere, np.inf, True),
    }
    return {
        name: (np.ascontiguousarray(o, np.float32), np.ascontiguousarray(d, np.float32), t_max, any_hit)
        for name, (o, d, t_max, any_hit) in sets.items()
    }


class Raywright:
    """raywright, with so many threads."""

    def __init__(self, vertices, faces, threads):
        self.scene = rw.Scene(rw.Mesh(vertices, faces))
        self.threads = threads
        self.build_seconds = self.scene.accelerator.build_seconds

    def trace(self, origins, directions, t_max, any_hit):
        """Return whether each ray hits and, for closest hits, t."""
        if any_hit:
            return self.scene.occluded(origins, directions, t_max=t_max, threads=self.threads), None
        hits = self.scene.intersect(origins, directions, threads=self.threads)
        return hits.hit, hits.t


class Embreex:
    """Embree 2 through embreex, as trimesh uses it: one thread, unit directions, no t_max."""

    def __init__(self, vertices, faces, threads):
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        start = time.perf_counter()
        self.scene = EmbreeScene()
        TriangleMesh(self.scene, vertices[faces].astype(np.float32))
        self.scene.run(np.zeros((1, 3), np.float32), np.ones((1, 3), np.float32))
        self.build_seconds = time.perf_counter() - start

    def trace(self, origins, directions, t_max, any_hit):
        """Return whether each ray hits and, for closest hits, t."""
        origins, directions = origins.reshape(-1, 3), directions.reshape(-1, 3)
        if any_hit:
            dists = None if np.isinf(t_max) else np.full(len(origins), t_max, np.float32)
            return self.scene.run(origins, directions, dists=dists, query="OCCLUDED") >= 0, None
        found = self.scene.run(origins, directions, output=True)
        return found["primID"] >= 0, found["tfar"]


class Open3D:
    """Embree 4 through Open3D."""

    def __init__(self, vertices, faces, threads):
        import open3d as o3d

        self.tensor = o3d.core.Tensor
        start = time.perf_counter()
        self.scene = o3d.t.geometry.RaycastingScene()
        self.scene.add_triangles(
            self.tensor(vertices.astype(np.float32)), self.tensor(faces.astype(np.uint32))
        )
        self.scene.cast_rays(self.tensor(np.ones((1, 6), np.float32)))
        self.build_seconds = time.perf_counter() - start

    def trace(self, origins, directions, t_max, any_hit):
        """Return whether each ray hits and, for closest hits, t."""
        rays = np.concatenate([origins, directions], axis=-1)
        if any_hit:
            return self.scene.test_occlusions(self.tensor(rays), tfar=float(t_max)).numpy(), None
        t = self.scene.cast_rays(self.tensor(rays))["t_hit"].numpy()
        return np.isfinite(t), t


def engines(vertices, faces, threads):
    """Return the engines that are installed, by name."""
    made = {"raywright": Raywright(vertices, faces, threads)}
    for name, engine in (("embreex", Embreex), ("open3d", Open3D)):
        try:
            made[name] = engine(vertices, faces, threads)
        except ImportError:
            print(f"({name} is not installed)")
    return made


def disagreements(reference, other):
    """Return the rays on which two answers differ, per million."""
    (hit, t), (other_hit, other_t) = reference, other
    hit, other_hit = hit.reshape(-1), other_hit.reshape(-1)
    wrong = hit != other_hit
    if t is not None and other_t is not None:
        both = hit & other_hit
        difference = np.abs(t.reshape(-1)[both] - other_t.reshape(-1)[both])
        wrong[both] |= difference > 1e-4 * t.reshape(-1)[both]
    return 1e6 * wrong.mean()


def compare(name, vertices, faces, options, rng):
    """Print one table: a row for each set of rays, a column for each engine."""
    made = engines(vertices, faces, options.threads)
    scene = made["raywright"].scene
    size = scene.bytes / len(faces)
    print(f"\n### {name}: {len(faces)} triangles, {size:.0f} bytes a triangle in all\n")
    built = ", ".join(f"{n} {e.build_seconds:.3f} s" for n, e in made.items())
    print(f"Built in: {built}\n")
    others = [n for n in made if n != "raywright"]
    head = ["Mrays/s", *made, *(f"ratio to {n}" for n in others), *(f"{n} disagree" for n in others)]
    print("| " + " | ".join(head) + " |")
    print("|" + "---|" * len(head))
    for kind, rays in ray_sets(scene, vertices, options.side, rng).items():
        answers = {n: engine.trace(*rays) for n, engine in made.items()}
        seconds = {n: [] for n in made}
        for _ in range(options.repeat):
            for n, engine in made.items():
                start = time.perf_counter()
                engine.trace(*rays)
                seconds[n].append(time.perf_counter() - start)
        count = rays[0].size / 3
        cells = [f"{count / statistics.median(seconds[n]) / 1e6:.1f}" for n in made]
        for n in others:
            ratios = [a / b for a, b in zip(seconds[n], seconds["raywright"], strict=True)]
            cells.append(f"{statistics.median(ratios):.2f}")
        cells += [f"{disagreements(answers['raywright'], answers[n]):.0f}" for n in others]
        print(f"| {kind} | " + " | ".join(cells) + " |", flush=True)


def main():
    """Run the comparison that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", action="append", default=[], help="a mesh file; may be given several times")
    parser.add_argument("--triangles", type=int, default=70_000, help="size of the meshes that are made")
    parser.add_argument("--threads", type=int, default=None, help="threads of raywright (default: all cores)")
    parser.add_argument("--side", type=int, default=1024, help="square root of the number of rays")
    parser.add_argument("--repeat", type=int, default=7, help="turns that each engine gets")
    options = parser.parse_args()
    rng = np.random.default_rng(0)
    print(f"raywright at {rw.simd()}, {options.threads or os.cpu_count()} threads")
    meshes = {path: given(path) for path in options.mesh}
    if not meshes:
        meshes = {
            "noisy torus": torus(options.triangles, rng),
            "room": room(options.triangles, rng),
        }
    for name, (vertices, faces) in meshes.items():
        compare(name, vertices, faces, options, rng)


if __name__ == "__main__":
    main()
