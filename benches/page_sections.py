"""The sections of the page of benchmarks: functions from sizes to records, which JSON can hold."""

import contextlib
import io
import statistics
import time
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
import points
import stress
import view_factors
from peers import build, installed, trace
from peers_meshes import MADE
from peers_rays import NAMES
from render_peers import Raywright, reference, relmse, scenes
from render_peers_mitsuba import Mitsuba

import raywright as rw

_ENGINES = ("raywright", "raywright avx2", "embreex", "embreex fast", "open3d", "mitsuba")
# Mitsuba's orthogonal sampler is left out: it rounds the number of samples up to the square of a prime.
_SAMPLERS = ("independent", "stratified", "multijitter")


@dataclass(frozen=True)
class Sizes:
    """Amount of measurement. The page's take five minutes on two cores."""

    triangles: int = 70_000
    threads: tuple[int, ...] = (1, 2)
    ray_side: int = 512
    ray_turns: int = 5
    stress_rays: int = 10_000
    built: tuple[int, ...] = (100_000, 1_000_000)
    build_turns: int = 3
    points: int = 100_000
    point_turns: int = 3
    cuts: tuple[int, ...] = (8, 13, 18)
    peer_cuts: tuple[int, ...] = (3, 4, 5)
    picture_side: int = 96
    picture_samples: tuple[int, ...] = (4, 16, 64, 256)
    reference_samples: int = 128
    picture_turns: int = 3
    pictures: tuple[str, ...] = ("cornell", "spheres", "mesh")


#: So little that all of it takes a minute, to try the command; its figures mean nothing.
TINY = Sizes(
    triangles=2_000,
    ray_side=48,
    ray_turns=1,
    stress_rays=300,
    built=(2_000, 20_000),
    build_turns=1,
    points=3_000,
    point_turns=1,
    cuts=(2, 3),
    peer_cuts=(2,),
    picture_side=32,
    picture_samples=(2, 8),
    reference_samples=16,
    picture_turns=1,
)


def rays(sizes):
    """Time six kinds of rays at three meshes on each number of threads, by every engine."""
    engines = installed([name for name in _ENGINES if name != "embreex fast"])
    options = SimpleNamespace(
        side=sizes.ray_side, threads=list(sizes.threads), rows=NAMES, repeat=sizes.ray_turns
    )
    records = []
    for mesh in ("sphere", "torus", "room"):
        subject = MADE[mesh](sizes.triangles, np.random.default_rng(0))
        # Hides the engines' own tables.
        with contextlib.redirect_stdout(io.StringIO()):
            for engine in engines:
                engine.build(subject.vertices, subject.faces)
            found = trace(engines, subject, options)
        for r in found:
            own = r["count"] / statistics.median(r.pop("raywright_seconds")) / 1e6
            # embreex has one thread, and raywright is also timed on one: each row compares equal threads.
            if r["threads"] == r["on_threads"]:
                records.append({k: v for k, v in r.items() if k != "seconds"} | {"raywright_mrays": own})
    return records


def wrong(sizes):
    """Count wrong answers of every engine where float32 decides badly."""
    engines = installed([name for name in _ENGINES if name != "raywright avx2"])
    return stress.measured(engines, sizes.stress_rays)


def builds(sizes):
    """Time builds of a rough torus, on all cores, and measure the memory that a fresh process grows by."""
    engines = installed(["raywright", "raywright double", "embreex", "open3d", "mitsuba"])
    records = []
    for count in sizes.built:
        records += build(engines, MADE["torus"](count, np.random.default_rng(0)), sizes.build_turns)
    return records


def distances(sizes):
    """Time closest points and signed distances."""
    subject = MADE["torus"](sizes.triangles, np.random.default_rng(0))
    return points.measured(subject, sizes.points, sizes.point_turns)


def factors(sizes):
    """Time view factors of a room, and those of pyViewFactor on fewer faces."""
    view_factors.validate()
    records = [r for cuts in sizes.cuts for r in view_factors.alone(cuts, 16)]
    try:
        records += [view_factors.peer(cuts) for cuts in sizes.peer_cuts]
    except ImportError as error:
        print(f"(pyViewFactor is left out: {error})")
    return records


def pictures(sizes):
    """Measure error against time of pictures, each engine against a long picture of its own."""
    known, records = scenes(None, sizes.picture_side), []
    for name in sizes.pictures:
        scene, camera, depth = known[name]()
        ours = [Raywright(scene, camera, rw.Path(max_depth=depth))]
        theirs = []
        try:
            theirs = [Mitsuba(scene, camera, depth, sampler) for sampler in _SAMPLERS]
        except ImportError as error:
            print(f"(mitsuba is left out: {error})")
        # The reference of `render_peers.py`.
        caustics = Raywright(
            scene, camera, rw.Path(max_depth=depth, reuse=1, guiding="photons"), rw.rendering.Sobol()
        )
        for engines, long in ((ours, caustics), (theirs, theirs[0] if theirs else None)):
            if not engines:
                continue
            (truth, noise), _, _ = reference(long, sizes.reference_samples, 8)
            for engine in engines:
                engine.render(sizes.picture_samples[0], 0)
                for samples in sizes.picture_samples:
                    records.append(_picture(name, engine, samples, sizes.picture_turns, truth, noise))
    return records


def _picture(scene, engine, samples, turns, truth, noise):
    seconds, errors = [], []
    for turn in range(turns):
        picture, taken = engine.render(samples, turn + 1)
        seconds.append(taken)
        # Subtracts the noise of the reference, which is independent of the other picture's.
        errors.append(relmse(picture, truth) - noise)
    return {
        "scene": scene,
        "engine": engine.name,
        "samples": samples,
        "seconds": statistics.median(seconds),
        "relmse": statistics.mean(errors),
    }


#: By name, in the order of the page.
SECTIONS = {
    "rays": rays,
    "wrong": wrong,
    "builds": builds,
    "distances": distances,
    "factors": factors,
    "pictures": pictures,
}


def timed(name, sizes):
    """Return the records of a section, and the seconds that they took."""
    start = time.perf_counter()
    records = SECTIONS[name](sizes)
    return records, time.perf_counter() - start
