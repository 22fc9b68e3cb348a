"""Every way to carry light on eight scenes: error against run time.

    python benches/light.py [--scene NAME ...] [--side 96] [--seconds 4] [--reference 60] [--plots FOLDER]

Prints Markdown. On each scene all ways take turns, six budgets each, with errors against a long picture:
relMSE is the mean of (x - ref)² / (ref² + 0.01). The long picture is by a way without bias that finds all the
light of the scene; a way that cannot find it, or adds a bias, has that in its error. What a picture needs is
error times seconds, where that is the same for all times; the last column is how many times more of it a way
needs than the best. Where Mitsuba 3 is installed its path tracer and its light tracer render the same scenes
for as long (it wants LLVM: name Debian's libLLVM in DRJIT_LIBLLVM_PATH).
"""

import argparse
import importlib.util
import statistics
import time
from pathlib import Path

import numpy as np
from light_scenes import SCENES
from render_peers_mitsuba import Mitsuba

import raywright as rw

WAYS = {
    "Path": rw.Path(reuse=1, guiding="none"),
    "Path, as chosen": rw.Path(),
    "LightTraced": rw.LightTraced(),
    "Bidirectional": rw.Bidirectional(),
    "Bidirectional, merged": rw.Bidirectional(vertex_merging=True),
    "PhotonMap": rw.PhotonMap(),
    "ProgressivePhotonMap": rw.ProgressivePhotonMap(),
}

# Integrators of the reference pictures: unbiased, and able to find all light. Only merging finds light
# through glass that is itself lit through glass; its blur tends to zero.
RIGHT = {"behind glass": "Bidirectional, merged", "lens": "Bidirectional, merged"}


def relmse(picture, truth):
    """Return the mean over pixels and channels of (x - truth)² / (truth² + 0.01)."""
    return float(np.mean((picture - truth) ** 2 / (truth**2 + 0.01)))


class MitsubaFor:
    """Mitsuba's picture of so many seconds, by one of its integrators."""

    def __init__(self, name, scene, camera, sampler, integrator):
        self.name = f"Mitsuba, {name}"
        self.engine = Mitsuba(scene, camera, None, sampler)
        if integrator != "path":
            self.engine.integrator = self.engine.mi.load_dict({"type": integrator})
        # Timed after one sample, which compiles everything.
        self.engine.render(16, 0)
        self.rate = self.engine.render(16, 1)[1] / 16

    def error_seconds(self, budget, seeds, truth):
        """Return relMSE times seconds, the mean over seeds."""
        samples = max(1, round(budget / self.rate))
        products = []
        for seed in range(seeds):
            picture, seconds = self.engine.render(samples, seed + 2)
            products.append(relmse(picture, truth) * seconds)
        return statistics.fmean(products)


def peers(scene, camera, budget, seeds, truth):
    """Yield Mitsuba's ways by name, with relMSE times seconds."""
    if importlib.util.find_spec("mitsuba") is None:
        return
    kinds = [("path, independent", "independent", "path"), ("path, multijitter", "multijitter", "path")]
    for name, sampler, integrator in [*kinds, ("ptracer", "independent", "ptracer")]:
        try:
            engine = MitsubaFor(name, scene, camera, sampler, integrator)
        except TypeError as why:
            yield f"Mitsuba, {name}", str(why)
            continue
        yield engine.name, engine.error_seconds(budget, seeds, truth)


def takes(way, scene, camera):
    """Return why a way cannot render a scene, or None."""
    try:
        rw.render(scene, camera, way, samples=1, progress=False)
    except ValueError as why:
        return str(why)
    return None


def contest(name, arguments):
    """Render a scene in all ways; returns lines of Markdown."""
    scene, camera = SCENES[name](width=arguments.side, height=arguments.side)
    ways, refused = {}, {}
    for each, way in WAYS.items():
        why = takes(way, scene, camera)
        (refused if why else ways)[each] = why or {"integrator": way}
    right = RIGHT.get(name, "Bidirectional")
    truth = rw.render(scene, camera, WAYS[right], seconds=arguments.reference, seed=2**63, progress=False)
    report = rw.report.convergence(
        scene, camera, ways, arguments.seconds, reference=truth, seeds=arguments.seeds
    )
    if arguments.plots is not None:
        arguments.plots.mkdir(exist_ok=True, parents=True)
        report.plot(arguments.plots / f"{name.replace(' ', '_')}.png")
    rows = {}
    for each in ways:
        last = report.where(contender=each)
        error, seconds = last.column("relmse")[-1], last.column("seconds")[-1]
        rows[each] = None if error is None else error * seconds
    rows |= dict(peers(scene, camera, arguments.seconds, arguments.seeds, truth.rgb.astype(np.float64)))
    products = [value for value in rows.values() if isinstance(value, float)]
    yield f"## {name.capitalize()}\n"
    yield f"Reference: {right}, {truth.samples} samples, relMSE {truth.error}.\n"
    yield "| integrator | relMSE x seconds | over the best |\n|---|---|---|"
    for each, value in rows.items():
        if isinstance(value, float):
            yield f"| {each} | {value:.2e} | {value / min(products):.1f} |"
        else:
            yield f"| {each} | {value or 'below the error of the reference'} | |"
    for each, why in refused.items():
        yield f"| {each} | {why} | |"
    yield ""


def main():
    """Render and print the tables."""
    start = time.perf_counter()
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=list(SCENES), help="which; all if not given")
    parser.add_argument("--side", type=int, default=96, help="pixels on a side")
    parser.add_argument("--seconds", type=float, default=4.0, help="the longest budget of a picture")
    parser.add_argument("--reference", type=float, default=60.0, help="seconds for the long picture")
    parser.add_argument("--seeds", type=int, default=3, help="pictures of each budget")
    parser.add_argument("--plots", type=Path, help="a folder for plots of error against time")
    arguments = parser.parse_args()
    for name in arguments.scene or SCENES:
        print("\n".join(contest(name, arguments)), flush=True)
    print(f"All of it took {time.perf_counter() - start:.0f} s.")


if __name__ == "__main__":
    main()
