"""Frames a second from Python: a camera moves around a mesh, with a ray and a shadow ray for each pixel.

    python benches/frames.py                                  # a sphere, a torus and a room, 800 by 600
    python benches/frames.py --mesh bunny.npz --mesh room --threads 1,2 --frames 120

A frame is all that an interactive ray tracer does but show the picture: a new camera, its rays as float32
arrays, their closest hits, the rays from there to a lamp, whether these are blocked, and grey values by
Lambert's law. Arrays of the frame before are used again. It is checked once that lit pixels are what closest
hits of the shadow rays say.

The table has medians over the frames, in milliseconds a frame for each part, and frames a second for all
parts together.
"""

import argparse
import os
import statistics
import time

# numpy's arithmetic would start its own threads otherwise.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from peers_meshes import MADE, given

import raywright as rw

PARTS = ("rays", "closest", "towards the lamp", "blocked", "grey")


class Shots:
    """Pictures of a scene, with arrays that each takes over from the one before."""

    def __init__(self, scene, subject, size, threads):
        self.scene, self.subject, self.size, self.threads = scene, subject, size, threads
        self.lamp = subject.lamp.astype(np.float32)
        self.hits = self.blocked = None
        shape = (size[1], size[0])
        self.points, self.ways, self.normals = (np.empty((*shape, 3), np.float32) for _ in range(3))
        self.t, self.squares, self.grey = (np.empty(shape, np.float32) for _ in range(3))

    def frame(self, turn):
        """Fill `grey` with a picture from a place on the way around, and return the seconds of each part."""
        marks = [time.perf_counter()]

        def done():
            marks.append(time.perf_counter())

        subject, size, threads = self.subject, self.size, self.threads
        cos, sin = np.cos(turn), np.sin(turn)
        x, y, z = subject.eye - subject.target
        eye = subject.target + np.array([cos * x + sin * z, y, cos * z - sin * x])
        camera = rw.Camera(eye, subject.target, fov=50, width=size[0], height=size[1])
        origins, directions = camera.rays(dtype=np.float32)
        done()
        hits = self.hits = self.scene.intersect(origins, directions, threads=threads, out=self.hits)
        done()
        # Shadow rays end just before the surface; for a miss t is infinite, and the ray tests nothing.
        points, ways = self.points, self.ways
        np.multiply(hits.t, 1 - 1e-4, out=self.t, casting="same_kind")
        np.multiply(directions, self.t[..., None], out=points)
        np.add(points, origins, out=points)
        np.subtract(self.lamp, points, out=ways)
        done()
        self.blocked = self.scene.occluded(points, ways, t_max=1.0, threads=threads, out=self.blocked)
        done()
        np.copyto(self.normals, hits.normal, casting="same_kind")
        np.einsum("...k,...k->...", self.normals, ways, out=self.grey)
        np.einsum("...k,...k->...", ways, ways, out=self.squares)
        np.divide(np.abs(self.grey, out=self.grey), np.sqrt(self.squares, out=self.squares), out=self.grey)
        self.grey[~hits.hit | self.blocked] = 0.0
        done()
        return np.diff(marks)


def check(shots):
    """Fail where shadow rays are not blocked by what they hit first."""
    shots.frame(0.3)
    first = shots.scene.intersect(shots.points, shots.ways, t_max=1.0)
    lit = shots.hits.hit & ~shots.blocked
    if not np.array_equal(first.hit, shots.blocked) or not lit.any() or not (shots.grey[lit] > 0).all():
        raise SystemExit("shadow rays and closest hits disagree, or nothing is lit")


def main():
    """Print a table for each mesh and number of threads."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--mesh", action="append", help=f"{', '.join(MADE)}, or a file; all made ones")
    parser.add_argument("--triangles", type=int, default=100_000, help="of meshes that are made here")
    parser.add_argument("--size", default="800x600", help="of the picture")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--threads", default=str(os.cpu_count()), help="numbers of threads, as in 1,2")
    told = parser.parse_args()
    size = tuple(int(side) for side in told.size.split("x"))
    rng = np.random.default_rng(1)
    print(f"| mesh | triangles | threads | frames/s | {' | '.join(f'{part}, ms' for part in PARTS)} |")
    print("|---" * (4 + len(PARTS)) + "|")
    for name in told.mesh or MADE:
        subject = MADE[name](told.triangles, rng) if name in MADE else given(name)
        scene = rw.Scene(rw.Mesh(subject.vertices, subject.faces))
        check(Shots(scene, subject, size, None))
        for threads in map(int, told.threads.split(",")):
            turns = np.linspace(0, 2 * np.pi, told.frames, endpoint=False)
            shots = Shots(scene, subject, size, threads)
            parts = np.array([shots.frame(turn) for turn in turns])
            rate = 1 / statistics.median(parts.sum(axis=1))
            cells = " | ".join(f"{1e3 * ms:.1f}" for ms in np.median(parts, axis=0))
            print(f"| {subject.name} | {len(subject.faces):,} | {threads} | {rate:.1f} | {cells} |")


if __name__ == "__main__":
    main()
