"""Frames a second from Python: a camera moves around a mesh, with a ray and a shadow ray for each pixel.

    python benches/frames.py                                  # a sphere, a torus and a room, 800 by 600
    python benches/frames.py --mesh bunny.npz --mesh room --threads 1,2 --frames 120

A frame is all that an interactive ray tracer does but show the picture: a new camera, its rays as float32
arrays, their closest hits, the rays from there to a lamp, whether these are blocked, and grey values by
Lambert's law. It is checked once that lit pixels are what closest hits of the shadow rays say.

The table has medians over the frames, in milliseconds a frame for each part, and frames a second for all
parts together.
"""

import argparse
import os
import statistics
import time

# numpy's arithmetic would have threads of its own otherwise.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from peers_meshes import MADE, given

import raywright as rw

PARTS = ("rays", "closest", "towards the lamp", "blocked", "grey")


def frame(scene, subject, turn, size, threads):
    """Return a picture from a place on the way around, the seconds of each part, and what was asked."""
    marks = [time.perf_counter()]

    def done():
        marks.append(time.perf_counter())

    cos, sin = np.cos(turn), np.sin(turn)
    x, y, z = subject.eye - subject.target
    eye = subject.target + np.array([cos * x + sin * z, y, cos * z - sin * x])
    camera = rw.Camera(eye, subject.target, fov=50, width=size[0], height=size[1])
    origins, directions = camera.rays(dtype=np.float32)
    done()
    hits = scene.intersect(origins, directions, threads=threads)
    done()
    # A little before the surface; where nothing was hit, t is infinite and the ray asks for nothing.
    points = origins + directions * (hits.t * (1 - 1e-4)).astype(np.float32)[..., None]
    ways = subject.lamp.astype(np.float32) - points
    done()
    blocked = scene.occluded(points, ways, t_max=1.0, threads=threads)
    done()
    facing = np.abs(np.einsum("...k,...k->...", hits.normal, ways)) / np.linalg.norm(ways, axis=-1)
    grey = np.where(hits.hit & ~blocked, facing, 0.0)
    done()
    return grey, np.diff(marks), (hits, points, ways, blocked)


def check(scene, hits, points, ways, blocked):
    """Fail where shadow rays are not blocked by what they hit first."""
    first = scene.intersect(points, ways, t_max=1.0)
    if not np.array_equal(first.hit, blocked) or not (hits.hit & ~blocked).any():
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
        check(scene, *frame(scene, subject, 0.3, size, None)[2])
        for threads in map(int, told.threads.split(",")):
            turns = np.linspace(0, 2 * np.pi, told.frames, endpoint=False)
            parts = np.array([frame(scene, subject, turn, size, threads)[1] for turn in turns])
            rate = 1 / statistics.median(parts.sum(axis=1))
            cells = " | ".join(f"{1e3 * ms:.1f}" for ms in np.median(parts, axis=0))
            print(f"| {subject.name} | {len(subject.faces):,} | {threads} | {rate:.1f} | {cells} |")


if __name__ == "__main__":
    main()
