"""The same scenes rendered by raywright and by Mitsuba 3: error against run time.

    python benches/render_peers.py [--scene NAME ...] [--side 256] [--samples 64] [--repeat 5] [--mesh FILE]

Both render the same scenes in turns, on all cores, raywright as it does by itself and with what it could have
chosen named; of Mitsuba the sampler counts that gets the least error times seconds, error being relMSE
against a long picture of its own. Before anything is timed, the long pictures of both have to agree. Mitsuba
wants LLVM: name Debian's libLLVM in DRJIT_LIBLLVM_PATH.

What a picture needs is error times seconds: with independent samples the one falls as the other grows. The
last column is how much of the time of the best of Mitsuba raywright takes to the same error.
"""

import argparse
import importlib.util
import math
import statistics
import subprocess
import sys
import time
from itertools import product

import numpy as np
from render_peers_mitsuba import SAMPLERS, Mitsuba, by_constants

import raywright as rw

# Side in pixels of the blocks for comparing means.
BLOCK = 16

# Side in pixels of the patches that share paths.
REUSE = 8


class Raywright:
    """raywright on all cores; what is not named is chosen."""

    def __init__(self, scene, camera, integrator, sampler=None):
        if sampler is None:
            self.name = "raywright"
        else:
            ways = " reuse" * (integrator.reuse > 1) + f" {integrator.guiding}" * (
                integrator.guiding != "none"
            )
            self.name = f"raywright {type(sampler).__name__.lower()}{ways}"
        self.sampler = sampler
        self.scene, self.camera, self.integrator = scene, camera, integrator

    def render(self, samples, seed):
        """Return a picture and the seconds that it took."""
        start = time.perf_counter()
        image = rw.render(
            self.scene,
            self.camera,
            self.integrator,
            samples=samples,
            seed=seed,
            sampler=self.sampler,
            progress=False,
        )
        return image.rgb.astype(np.float64), time.perf_counter() - start


def scenes(mesh, side):
    """Scenes by name: each a function that gives scene, camera, and the greatest number of bounces."""

    def in_environment():
        shape = rw.Mesh(*_torus_arrays()) if mesh is None else mesh
        scene, camera = rw.scenes.studio(shape, width=side, height=side)
        return rw.Scene(scene.shapes[:-2], environment=1.0), camera, None

    def plates():
        return *by_constants(*rw.scenes.veach_plates(width=side, height=side)), 1

    return {
        "cornell": lambda: (*rw.scenes.cornell_box(width=side, height=side), None),
        "plates": plates,
        "mesh": in_environment,
        "spheres": lambda: (*rw.scenes.glass_spheres(width=side, height=side), None),
    }


def _torus_arrays(around=706, along=353):
    """Return a bumpy torus of 498,436 triangles."""
    u, v = np.meshgrid(
        np.arange(around) * 2 * np.pi / around, np.arange(along) * 2 * np.pi / along, indexing="ij"
    )
    radius = 0.4 + 0.03 * np.sin(11 * u) * np.sin(7 * v)
    ring = 1 + radius * np.cos(v)
    vertices = np.stack([ring * np.cos(u), radius * np.sin(v), ring * np.sin(u)], axis=-1).reshape(-1, 3)
    i, j = (x.reshape(-1) for x in np.meshgrid(np.arange(around), np.arange(along), indexing="ij"))
    at = lambda a, b: (a % around) * along + b % along  # noqa: E731
    quads = np.stack([at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)], axis=-1)
    return vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def relmse(picture, reference):
    """Return the mean over pixels and channels of (x - ref)² / (ref² + 0.01)."""
    return float(np.mean((picture - reference) ** 2 / (reference**2 + 0.01)))


def reference(engine, samples, seeds):
    """Return a long picture with its own relMSE, its blocks' means, and the standard errors of these."""
    pictures = [engine.render(samples, 1_000_000 + seed)[0] for seed in range(seeds)]
    blocks = np.stack([_blocks(picture) for picture in pictures])
    mean = np.mean(pictures, axis=0)
    noise = float(np.mean(np.var(pictures, axis=0, ddof=1) / seeds / (mean**2 + 0.01)))
    return (mean, noise), blocks.mean(axis=0), blocks.std(axis=0, ddof=1) / math.sqrt(seeds)


def _blocks(picture):
    height, width = (n // BLOCK * BLOCK for n in picture.shape[:2])
    cut = picture[:height, :width].reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3)
    return cut.mean(axis=(1, 3))


def contest(name, make, arguments):
    """Render a scene by all in turns; returns lines of a table."""
    scene, camera, depth = make()
    plain = {"reuse": 1, "guiding": "none"}
    ways = plain, plain | {"reuse": REUSE}, plain | {"guiding": "photons"}
    kinds = [(rw.rendering.Independent(), plain)] + [(rw.rendering.Sobol(), way) for way in ways]
    ours = [Raywright(scene, camera, rw.Path(max_depth=depth))]
    ours += [Raywright(scene, camera, rw.Path(max_depth=depth, **way), sampler) for sampler, way in kinds]
    with_mitsuba = importlib.util.find_spec("mitsuba") is not None
    others = [Mitsuba(scene, camera, depth, sampler) for sampler in SAMPLERS] if with_mitsuba else []
    mine, blocks, errors = reference(ours[-1], arguments.reference, 8)
    truths = {engine.name: mine for engine in ours}
    if others:
        theirs, other_blocks, other_errors = reference(others[0], arguments.reference, 8)
        # Blocks in the tails of t with 7 degrees of freedom: beyond 8 standard errors, one in 10,000.
        off = np.abs(blocks - other_blocks) / np.maximum(np.hypot(errors, other_errors), 1e-6)
        print(
            f"{name}: the pictures differ by {np.median(off):.2f} standard errors in the middle, "
            f"{off.max():.1f} at most"
        )
        truths |= {other.name: theirs for other in others}
    records = {engine.name: ([], []) for engine in (*ours, *others)}
    for engine in (*ours, *others):
        engine.render(arguments.samples, 0)
    for turn, engine in product(range(arguments.repeat), (*ours, *others)):
        picture, seconds = engine.render(arguments.samples, turn + 1)
        records[engine.name][0].append(seconds)
        # Subtracts the noise of the reference, which is independent of the other picture's.
        truth, noise = truths[engine.name]
        records[engine.name][1].append(relmse(picture, truth) - noise)
    rows = {}
    for engine, (seconds, wrong) in records.items():
        rows[engine] = (statistics.median(seconds), statistics.mean(wrong))
    best = min((math.prod(rows[other.name]) for other in others), default=math.nan)
    for engine, (seconds, wrong) in rows.items():
        ratio = f"{seconds * wrong / best:.2f}" if others else "-"
        yield f"| {name} | {engine} | {seconds:.3f} | {wrong:.2e} | {seconds * wrong:.2e} | {ratio} |"


START = """
import raywright as rw
scene, camera = rw.scenes.cornell_box(width=256, height=256)
rw.render(scene, camera, samples=16, progress=False)
"""


def start_to_end(repeat):
    """Seconds from the start of a process to the end of its first Cornell picture of 16 samples."""
    seconds = []
    for _ in range(repeat):
        start = time.perf_counter()
        subprocess.run([sys.executable, "-c", START], check=True)
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds)


def main():
    """Render and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", help="which; all if not given")
    parser.add_argument("--side", type=int, default=256, help="pixels on a side")
    parser.add_argument("--samples", type=int, default=64, help="of each pixel")
    parser.add_argument(
        "--reference", type=int, default=1024, help="samples of each of the eight long pictures"
    )
    parser.add_argument("--repeat", type=int, default=5, help="turns")
    parser.add_argument("--mesh", help="a file, for the scene `mesh`")
    arguments = parser.parse_args()
    known = scenes(arguments.mesh, arguments.side)
    print(f"First picture, from the start of the process: {start_to_end(arguments.repeat):.2f} s\n")
    table = [
        "| scene | engine | seconds | relMSE | seconds by relMSE | of the best of Mitsuba |",
        "|---|---|---|---|---|---|",
    ]
    for name in arguments.scene or known:
        if name not in known:
            parser.error(f"--scene is {name!r}, expected one of {', '.join(known)}")
        table += contest(name, known[name], arguments)
    print("\n" + "\n".join(table))


if __name__ == "__main__":
    main()
