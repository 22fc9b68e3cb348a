"""What a call costs that asks for few rays: microseconds a call, beside Open3D and embreex.

    python benches/small_calls.py [--mesh bunny.npz --mesh torus] [--sizes 1,16,256,4096] [--turns 7]

The rays are a camera's, in the order of the pixels, and random ones (`peers_rays.py`), each call takes the
next of them, and each engine is asked in the way that its users ask. All engines must agree on what is hit
before they are timed. The last column is how many times as fast as the fastest of the others raywright is:
the median over turns, in which each engine is timed next to raywright.
"""

import argparse
import statistics
import time

import numpy as np
from peers import installed
from peers_meshes import MADE, given
from peers_rays import Rays, ray_sets
from peers_tables import head, line
from peers_turns import disagreements

#: Seconds that each engine gets in a turn, about.
SECONDS = 0.1

#: Rays, per million, on which engines may differ: those at edges, where the others decide in float32.
DIFFERING = 1000


def calls(rays, size):
    """Return the rays of each of some calls."""
    origins, directions = (a.reshape(-1, 3) for a in rays[:2])
    starts = range(0, min(len(origins) // size, 1000) * size, size)
    return [Rays(origins[i : i + size], directions[i : i + size], *rays[2:]) for i in starts]


def validate(engines, some, row):
    """Raise an error unless all engines agree on what some calls hit."""
    answers = {}
    for engine in engines:
        each = [engine.trace(rays, engine.modes[0]) for rays in some]
        hit = np.concatenate([hit for hit, _ in each])
        answers[engine.name] = hit, None if each[0][1] is None else np.concatenate([t for _, t in each])
    for name, answer in answers.items():
        apart = disagreements(answers["raywright"], answer)
        # A few hundred rays may hold one that differs.
        if apart > max(DIFFERING, 2e6 / len(answer[0])):
            raise SystemExit(f"{row}: raywright and {name} differ on {apart:.0f} rays of a million")


def microseconds(engine, some):
    """Return how long a call takes."""
    count = 0
    start = time.perf_counter()
    while (spent := time.perf_counter() - start) < SECONDS:
        for rays in some:
            engine.ask(rays, engine.modes[0])
        count += len(some)
    return 1e6 * spent / count


def measured(engines, subject, sizes, turns):
    """Print a row for each kind of rays and size."""
    ours, *others = engines
    for engine in engines:
        engine.build(subject.vertices, subject.faces)
        engine.use(None if engine is ours else 0)
    sets = ray_sets(ours.scene, subject, 512, np.random.default_rng(1))
    print(head(["rays", "rays a call", *(f"{e.name}, µs" for e in engines), "raywright is faster by"]))
    for name in ("primary", "random", "random any"):
        for size in sizes:
            # So many as take a few milliseconds.
            some = calls(sets[name], size)[: max(1, 4096 // size)]
            validate(engines, some, f"{name}, {size} rays")
            own, spent, ratios = [], {e.name: [] for e in others}, []
            for _ in range(turns):
                of_turn = []
                for engine in others:
                    spent[engine.name].append(microseconds(engine, some))
                    own.append(microseconds(ours, some))
                    of_turn.append(spent[engine.name][-1] / own[-1])
                ratios.append(min(of_turn, default=float("nan")))
            medians = [statistics.median(own), *(statistics.median(spent[e.name]) for e in others)]
            row = [name, f"{size:,}", *(f"{m:,.1f}" for m in medians), f"{statistics.median(ratios):.2f}"]
            print(line(row), flush=True)


def main():
    """Measure, and print a table for each mesh."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mesh", action="append", help=f"{', '.join(MADE)} or a file")
    parser.add_argument("--triangles", type=int, default=70_000, help="size of meshes that are made, about")
    parser.add_argument("--sizes", default="1,16,256,4096", help="rays a call")
    parser.add_argument("--turns", type=int, default=7, help="turns that each engine gets")
    options = parser.parse_args()
    engines = installed(["raywright", "open3d", "embreex"])
    for mesh in options.mesh or ["torus"]:
        subject = MADE[mesh](options.triangles, np.random.default_rng(0)) if mesh in MADE else given(mesh)
        print(f"\n{subject.name}: {len(subject.faces):,} triangles\n")
        measured(engines, subject, [int(n) for n in options.sizes.split(",")], options.turns)


if __name__ == "__main__":
    main()
