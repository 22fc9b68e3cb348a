"""Compare the options that a pilot chooses with all others: error by run time.

    python benches/choices.py [--scene NAME ...] [--side 128] [--samples 64] [--repeat 3] [--reference 2048]

Each scene is rendered as `rw.render` does it by itself, and in every way that paths can go, in turns and with
the same sampler. Error is relMSE against a long picture of the way that errs least. What a picture needs is
error times seconds; the last column is that over the least of all ways, and nothing chosen should be above
1.1. Photons are sent once for a scene, before anything is timed; pilots are part of the time.
"""

import argparse
import statistics
import time
from itertools import product

import numpy as np

import raywright as rw

WAYS = [
    {"reuse": reuse, "guiding": guiding} for guiding in ("none", "photons", "learned") for reuse in (1, 4, 8)
]


def mirror_room(side):
    """Return a ball of silver in a Cornell box, and its camera."""
    scene, camera = rw.scenes.cornell_box(width=side, height=side)
    ball = rw.Sphere((195.0, 440.0, 195.0), 100.0, material=rw.Conductor("silver"))
    return rw.Scene([*scene.shapes, ball], scene.lights, scene.environment), camera


def mesh(side):
    """Return a torus knot under an even sky, and its camera."""
    scene, camera = rw.scenes.studio(rw.scenes.torus_knot(), width=side, height=side)
    return rw.Scene(scene.shapes[:-2], environment=1.0), camera


def scenes(side):
    """Scenes by name: each a function that gives scene and camera."""
    size = {"width": side, "height": side}
    return {
        "cornell": lambda: rw.scenes.cornell_box(**size),
        "plates": lambda: rw.scenes.veach_plates(**size),
        "mesh": lambda: mesh(side),
        "spheres": lambda: rw.scenes.glass_spheres(**size),
        "whitted": lambda: rw.scenes.whitted_spheres(**size),
        "many lights": lambda: rw.scenes.many_lights(**size),
        "ball": lambda: rw.scenes.material_ball(**size),
        "mirror room": lambda: mirror_room(side),
    }


def told(way):
    """Return the name of a way."""
    return f"reuse {way['reuse']}, guiding {way['guiding']}"


def relmse(picture, truth):
    """Return the mean over pixels and channels of (x - truth)² / (truth² + 0.01)."""
    return float(np.mean((picture - truth) ** 2 / (truth**2 + 0.01)))


def long_picture(scene, camera, samples):
    """Return a picture of many samples, as two halves that tell its own error."""
    path = rw.Path(reuse=8, guiding="photons")
    seeds = 1_000_000, 1_000_001
    halves = [
        rw.render(scene, camera, path, samples=samples, seed=seed, progress=False).rgb for seed in seeds
    ]
    mean = np.mean(halves, axis=0, dtype=np.float64)
    return mean, relmse(halves[0], mean)


def contest(name, scene, camera, arguments):
    """Render a scene in all ways, in turns; returns lines of a table."""
    truth, noise = long_picture(scene, camera, arguments.reference)
    ways = [rw.Path(), *(rw.Path(**way) for way in WAYS)]
    records = [([], []) for _ in ways]
    plan = rw.render(scene, camera, samples=arguments.samples, progress=False).plan
    for turn, (way, (seconds, wrong)) in product(
        range(arguments.repeat), list(zip(ways, records, strict=True))
    ):
        start = time.perf_counter()
        image = rw.render(scene, camera, way, samples=arguments.samples, seed=turn, progress=False)
        seconds.append(time.perf_counter() - start)
        wrong.append(relmse(image.rgb.astype(np.float64), truth) - noise)
    rows = [(statistics.median(seconds), statistics.mean(wrong)) for seconds, wrong in records]
    best = min(seconds * wrong for seconds, wrong in rows[1:])
    names = [f"chosen: {told({'reuse': plan.path.reuse, 'guiding': plan.path.guiding})}", *map(told, WAYS)]
    for way, (seconds, wrong) in zip(names, rows, strict=True):
        product_ = seconds * wrong
        yield f"| {name} | {way} | {seconds:.3f} | {wrong:.2e} | {product_:.2e} | {product_ / best:.2f} |"
    for row in plan.rows:
        if row.what in ("reuse", "guiding"):
            yield f"<!-- {row.what}: {row.chosen}, {row.why} -->"


def main():
    """Render and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", help="which; all if not given")
    parser.add_argument("--side", type=int, default=128, help="pixels on a side")
    parser.add_argument("--samples", type=int, default=64, help="of each pixel")
    parser.add_argument("--reference", type=int, default=2048, help="samples of half a long picture")
    parser.add_argument("--repeat", type=int, default=3, help="turns")
    arguments = parser.parse_args()
    known = scenes(arguments.side)
    print("| scene | paths | seconds | relMSE | seconds by relMSE | of the best |\n|---|---|---|---|---|---|")
    for name in arguments.scene or known:
        if name not in known:
            parser.error(f"--scene is {name!r}, expected one of {', '.join(known)}")
        for line in contest(name, *known[name](), arguments):
            print(line, flush=True)


if __name__ == "__main__":
    main()
