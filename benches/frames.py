"""Frames a second: a camera moves around a mesh, with a ray and a shadow ray for each pixel.

    python benches/frames.py                                  # a sphere and a torus, 800 by 600
    python benches/frames.py --mesh bunny.npz --threads 1,2 --frames 120

A frame is all that an interactive ray tracer does but show the picture. It is drawn in two ways.
`Scene.preview` is one call. The other way is numpy between two calls: a new camera, its rays as float32
arrays, their closest hits, the rays from there to a lamp, whether these are blocked, and gray values by
Lambert's law. Both write to the arrays of the frame before.

Before anything is timed, the preview of a frame is compared with `intersect`, `leave` and `occluded` in
numpy, pixel by pixel; and lit pixels of the numpy way with the closest hits of its shadow rays.

The table has medians over the frames: frames a second of both ways, milliseconds of processor time a
frame of the preview, over all threads, and milliseconds a frame of each part of the numpy way.
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

# In the others nothing is lit from the camera's way.
DEFAULT = ("sphere", "torus")
PARTS = ("rays", "closest", "towards the lamp", "blocked", "gray")
# The greatest t of a segment to a lamp: a little before its end.
_END = 1 - 2.0**-45


class Shots:
    """Pictures of a scene, with arrays that each takes over from the one before."""

    def __init__(self, scene, subject, size, threads):
        self.scene, self.subject, self.size, self.threads = scene, subject, size, threads
        self.lamp = subject.lamp.astype(np.float32)
        self.hits = self.blocked = None
        shape = (size[1], size[0])
        self.points, self.ways, self.normals = (np.empty((*shape, 3), np.float32) for _ in range(3))
        self.t, self.squares, self.gray = (np.empty(shape, np.float32) for _ in range(3))

        self.picture = np.empty((*shape, 3), np.uint8)
        self.light = rw.PointLight(subject.lamp, 1)

    def camera(self, turn):
        """Return the camera at a place on the way around."""
        cos, sin = np.cos(turn), np.sin(turn)
        x, y, z = self.subject.eye - self.subject.target
        eye = self.subject.target + np.array([cos * x + sin * z, y, cos * z - sin * x])
        return rw.Camera(eye, self.subject.target, fov=50, width=self.size[0], height=self.size[1])

    def preview(self, turn):
        """Fill `picture` by one call, and return its seconds, and those of all processors."""
        start, busy = time.perf_counter(), time.process_time()
        self.scene.preview(self.camera(turn), self.light, out=self.picture, threads=self.threads)
        return time.perf_counter() - start, time.process_time() - busy

    def frame(self, turn):
        """Fill `gray` with a picture from a place on the way around, and return the seconds of each part."""
        marks = [time.perf_counter()]

        def done():
            marks.append(time.perf_counter())

        threads = self.threads
        camera = self.camera(turn)
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
        np.einsum("...k,...k->...", self.normals, ways, out=self.gray)
        np.einsum("...k,...k->...", ways, ways, out=self.squares)
        np.divide(np.abs(self.gray, out=self.gray), np.sqrt(self.squares, out=self.squares), out=self.gray)
        self.gray[~hits.hit | self.blocked] = 0.0
        done()
        return np.diff(marks)


def check(shots):
    """Fail where shadow rays are not blocked by what they hit first, or a preview differs from numpy's."""
    shots.frame(0.3)
    first = shots.scene.intersect(shots.points, shots.ways, t_max=1.0)
    lit = shots.hits.hit & ~shots.blocked
    if not np.array_equal(first.hit, shots.blocked) or not lit.any() or not (shots.gray[lit] > 0).all():
        raise SystemExit("shadow rays and closest hits disagree, or nothing is lit")
    camera = shots.camera(0.3)
    origins, directions = camera.rays()
    hits = shots.scene.intersect(origins, directions)
    facing = np.where(np.sum(hits.normal * directions, axis=-1, keepdims=True) <= 0, 1, -1) * hits.normal
    lamp = np.array(shots.light.position)
    ways = lamp - hits.position
    starts = hits.spawn_rays(ways).origins
    blocked = shots.scene.occluded(starts, lamp - starts, t_max=_END)
    cosine = np.sum(facing * ways, axis=-1) / np.linalg.norm(ways, axis=-1)
    gray = np.where(hits.hit & ~blocked & (cosine > 0), cosine, 0.0)
    (albedo,) = {shape.material.reflectance for shape in shots.scene.shapes}
    wanted = gray[..., None] * np.array(albedo)
    found = shots.scene.preview(camera, shots.light, dtype=np.float32)
    if not np.allclose(found, wanted, rtol=1e-6, atol=1e-6):
        worst = np.abs(found - wanted).max(axis=-1)
        raise SystemExit(f"{np.count_nonzero(worst > 1e-6)} pixels of a preview differ, by {worst.max():.2g}")


def main():
    """Print a table for each mesh and number of threads."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--mesh", action="append", help=f"{', '.join(MADE)}, or a file; {' and '.join(DEFAULT)}"
    )
    parser.add_argument("--triangles", type=int, default=100_000, help="of meshes that are made here")
    parser.add_argument("--size", default="800x600", help="of the picture")
    parser.add_argument("--frames", type=int, default=60)
    parser.add_argument("--threads", default=str(os.cpu_count()), help="numbers of threads, as in 1,2")
    told = parser.parse_args()
    size = tuple(int(side) for side in told.size.split("x"))
    rng = np.random.default_rng(1)
    heads = ("mesh", "triangles", "threads", "preview, frames/s", "processor, ms", "numpy, frames/s")
    print(f"| {' | '.join([*heads, *(f'{part}, ms' for part in PARTS)])} |")
    print("|---" * (len(heads) + len(PARTS)) + "|")
    for name in told.mesh or DEFAULT:
        subject = MADE[name](told.triangles, rng) if name in MADE else given(name)
        scene = rw.Scene(rw.Mesh(subject.vertices, subject.faces))
        check(Shots(scene, subject, size, None))
        for threads in map(int, told.threads.split(",")):
            turns = np.linspace(0, 2 * np.pi, told.frames, endpoint=False)
            shots = Shots(scene, subject, size, threads)
            wall, busy = np.median([shots.preview(turn) for turn in turns], axis=0)
            parts = np.array([shots.frame(turn) for turn in turns])
            rate = 1 / statistics.median(parts.sum(axis=1))
            cells = " | ".join(f"{1e3 * ms:.1f}" for ms in np.median(parts, axis=0))
            row = f"{threads} | {1 / wall:.1f} | {1e3 * busy:.1f} | {rate:.1f} | {cells}"
            print(f"| {subject.name} | {len(subject.faces):,} | {row} |")


if __name__ == "__main__":
    main()
