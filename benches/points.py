"""Closest points, signed distances and insides beside trimesh, Open3D and libigl: rates and differences.

    python benches/points.py [--triangles 70000] [--points 100000] [--mesh torus --mesh bunny.ply]

Half of the points are near the surface and half anywhere in 1.5 times its box. Each engine gets all cores,
and is asked in turns with raywright, as `peers.py` asks for rays. trimesh gets a hundredth of the points,
as it is slow. Trees that an engine keeps are not timed; libigl builds one in each call.
"""

import argparse
import statistics
import time

import numpy as np
from peers import version_of
from peers_meshes import MADE, given
from peers_tables import head, line

import raywright as rw


class Raywright:
    """raywright on all cores."""

    name = package = "raywright"
    share = 1.0

    def build(self, vertices, faces):
        """Make the scene."""
        self.scene = rw.Scene(rw.Mesh(vertices, faces))
        self.scene.build()

    def closest(self, points):
        """Return the distance to the closest point of each of (N, 3) points."""
        return self.scene.closest_point(points).distance

    def signed(self, points):
        """Return distances that are negative inside."""
        return self.scene.signed_distance(points)

    def inside(self, points):
        """Return whether each point is inside."""
        return self.scene.contains(points)


class Open3D(Raywright):
    """Open3D's RaycastingScene."""

    name = package = "open3d"

    def __init__(self):
        import open3d

        self.tensor, self.new_scene = open3d.core.Tensor, open3d.t.geometry.RaycastingScene

    def build(self, vertices, faces):
        """Make the scene; the first query commits it."""
        self.scene = self.new_scene()
        self.scene.add_triangles(self.tensor(vertices), self.tensor(faces.astype(np.uint32)))
        self.signed(np.zeros((1, 3), np.float32))

    def closest(self, points):
        """Ask for closest points."""
        found = self.scene.compute_closest_points(self.tensor(points))["points"].numpy()
        return np.linalg.norm(points - found, axis=1)

    def signed(self, points):
        """Ask for signed distances."""
        return self.scene.compute_signed_distance(self.tensor(points)).numpy()

    def inside(self, points):
        """Ask for what a ray's crossings say."""
        return self.scene.compute_occupancy(self.tensor(points)).numpy()


class Libigl(Raywright):
    """libigl, which has one tree a call; with the sign of the winding number, as for any closed mesh."""

    name, package = "libigl", "igl"

    def __init__(self):
        import igl

        self.igl = igl

    def build(self, vertices, faces):
        """Keep the mesh in the types that it wants."""
        self.mesh = vertices.astype(np.float64), faces.astype(np.int64)

    def closest(self, points):
        """Ask for squared distances."""
        return np.sqrt(self.igl.point_mesh_squared_distance(points.astype(np.float64), *self.mesh)[0])

    def signed(self, points):
        """Ask for signed distances."""
        return self.igl.signed_distance(points.astype(np.float64), *self.mesh)[0]

    def inside(self, points):
        """Ask for fast winding numbers (Barill et al. 2018)."""
        return self.igl.fast_winding_number(*self.mesh, points.astype(np.float64)) > 0.5


class Trimesh(Raywright):
    """trimesh's proximity queries, by rtree."""

    name = package = "trimesh"
    share = 0.01

    def __init__(self):
        import rtree  # noqa: F401
        import trimesh

        self.trimesh = trimesh

    def build(self, vertices, faces):
        """Make the mesh and its tree."""
        self.mesh = self.trimesh.Trimesh(vertices, faces, process=False)
        self.signed(np.zeros((1, 3)))

    def closest(self, points):
        """Ask for closest points."""
        return self.trimesh.proximity.closest_point(self.mesh, points)[1]

    def signed(self, points):
        """Ask for signed distances, which are positive inside there."""
        return -self.trimesh.proximity.signed_distance(self.mesh, points)

    def inside(self, points):
        """Ask for what rays' crossings say."""
        return self.mesh.contains(points)


def installed():
    """Return the engines that are there, raywright first."""
    engines = []
    for make in (Raywright, Open3D, Libigl, Trimesh):
        try:
            engines.append(make())
        except ImportError as error:
            print(f"({make.name} is left out: {error})")
    return engines


def some_points(vertices, faces, count, rng):
    """Return (count, 3) float32 points: near the surface, and anywhere in 1.5 times its box."""
    low, high = vertices[faces].min(axis=(0, 1)), vertices[faces].max(axis=(0, 1))
    near = vertices[faces[rng.integers(len(faces), size=count // 2)]].mean(axis=1)
    near = near + rng.normal(size=near.shape) * 0.01 * np.linalg.norm(high - low)
    anywhere = (low + high) / 2 + (high - low) * 1.5 * (rng.random((count - len(near), 3)) - 0.5)
    return rng.permutation(np.concatenate([near, anywhere])).astype(np.float32)


def measured(subject, count, repeat, seed=1):
    """Return a record for each engine and query: points a second, ratio to raywright, difference."""
    engines = installed()
    ours = engines[0]
    points = some_points(subject.vertices, subject.faces, count, np.random.default_rng(seed))
    size = float(np.ptp(subject.vertices, axis=0).max())
    for engine in engines:
        engine.build(subject.vertices, subject.faces)
    records = []
    for query in ("closest", "signed", "inside"):
        expected = np.asarray(getattr(ours, query)(points), np.float64)
        for engine in engines:
            few = points[: max(round(engine.share * count), 1)]
            found = np.asarray(getattr(engine, query)(few), np.float64)
            own, theirs = [], []
            for turn in range(repeat):
                for asked, seconds in ((ours, own), (engine, theirs))[:: 1 if turn % 2 else -1]:
                    start = time.perf_counter()
                    getattr(asked, query)(points if asked is ours else few)
                    seconds.append(time.perf_counter() - start)
            rates = count / statistics.median(own), len(few) / statistics.median(theirs)
            off = np.abs(np.abs(found) - np.abs(expected[: len(few)])) / size
            records.append(
                {
                    "mesh": subject.name,
                    "triangles": len(subject.faces),
                    "query": query,
                    "engine": engine.name,
                    "version": version_of(engine.package),
                    "points_per_second": rates[1],
                    "ratio": rates[0] / rates[1],
                    "greatest_difference": float(off.max()),
                    "other_sign_per_million": 1e6 * other_side(query, found, expected[: len(few)]),
                }
            )
    return records


def other_side(query, found, expected):
    """Return the part of points that two engines see on different sides."""
    return float(np.mean(found != expected if query == "inside" else found * expected < 0))


def table(records):
    """Return what was measured: a row for each query and engine."""
    rows = [
        head(
            [
                "query",
                "engine",
                "version",
                "points/s",
                "raywright is faster by",
                "differs by",
                "other sign, per million",
            ]
        )
    ]
    names = {"closest": "closest point", "signed": "signed distance", "inside": "inside"}
    for r in records:
        sign = f"{r['other_sign_per_million']:,.0f}" if r["query"] != "closest" else "-"
        off = f"{r['greatest_difference']:.0e}" if r["query"] != "inside" else "-"
        ratio = f"{r['ratio']:.1f}"
        own = r["engine"] == "raywright"
        rows.append(
            line(
                [
                    names[r["query"]],
                    r["engine"],
                    r["version"],
                    f"{r['points_per_second']:,.0f}",
                    *(("-", "-", "-") if own else (ratio, off, sign)),
                ]
            )
        )
    return "\n".join(rows)


def main():
    """Measure, and print a table for each mesh."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", action="append", help=f"{', '.join(MADE)} or a file")
    parser.add_argument("--triangles", type=int, default=70_000, help="size of meshes that are made, about")
    parser.add_argument("--points", type=int, default=100_000, help="points of each query")
    parser.add_argument("--repeat", type=int, default=3, help="turns that each engine gets")
    options = parser.parse_args()
    for mesh in options.mesh or ["torus"]:
        subject = MADE[mesh](options.triangles, np.random.default_rng(0)) if mesh in MADE else given(mesh)
        print(f"\n{subject.name}: {len(subject.faces):,} triangles\n")
        print(table(measured(subject, options.points, options.repeat)))


if __name__ == "__main__":
    main()
