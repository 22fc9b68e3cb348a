"""The same rays through every engine that is installed, from numpy arrays to numpy arrays.

    python benches/peers.py                                   # a sphere, a torus, a room, a box, a triangle
    python benches/peers.py --mesh bunny.ply --mesh room      # a file that trimesh reads, or .npz
    python benches/peers.py --triangles 1000000 --threads 1,8 --json figures.json --turned
    python benches/peers.py --mesh torus --rows primary,diffuse --engines mitsuba    # while at work

What is printed for each mesh, as Markdown:

- what each engine costs: seconds from arrays to a scene ready for rays, on all cores, and the bytes for each
  triangle by which a fresh process grows;
- for each number of threads the medians of Mrays/s, and then how many times as fast raywright is as each of
  the others and as the fastest peer: the median ratio of turns taken side by side (`peers_turns.py`). The
  last column is raywright against itself on the fewest threads;
- the rays, per million, on which an engine says hit where raywright says miss or the other way round, or
  differs in t by more than a ten-thousandth.

Engines (`peers_engines.py`), each used if it is installed: `pip install embreex open3d mitsuba`. All but
raywright are Embree inside, and raywright itself is asked at AVX2 and at SSE2 too (`peers_levels.py`).
Mitsuba also wants LLVM (in Debian `libllvm19`); if it does not find it, DRJIT_LIBLLVM_PATH says where it
is. It is told that rays are coherent, and told that they are not, and the faster is shown, with its name.
embreex, and trimesh which stands on it, have one thread.
"""

import argparse
import json
import os
import platform
import statistics
import time
from importlib.metadata import packages_distributions, version
from pathlib import Path

# trimesh's arithmetic would start its own threads otherwise; this must precede the import of numpy.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from peers_engines import Embreex, EmbreexFast, Mitsuba, Open3D, Raywright, RaywrightDouble, Trimesh
from peers_levels import AtAvx2, AtLevel, AtSse2
from peers_memory import resident_bytes
from peers_meshes import MADE, given, turned
from peers_rays import NAMES, ray_sets
from peers_tables import SpeedTable, counted, disagreements_table, engines_table
from peers_turns import disagreements, timed_beside

import raywright as rw

ENGINES = {
    e.name: e
    for e in (Raywright, RaywrightDouble, AtAvx2, AtSse2, Embreex, EmbreexFast, Trimesh, Open3D, Mitsuba)
}


def installed(names):
    """Return the engines of these names that are there, and say why others are not."""
    engines = []
    for name in names:
        try:
            engines.append(ENGINES[name]())
        except ImportError as error:
            print(f"({name} is left out: {error})")
    return engines


def version_of(package):
    """Return the version of what is imported by a name: open3d may be of the distribution open3d-cpu."""
    if package == "raywright":
        return rw.__version__
    return version(packages_distributions().get(package, [package])[0])


def build(engines, subject, times):
    """Give each engine the mesh, several times in turns, and return a record of what that costs each."""
    seconds = {engine.name: [] for engine in engines}
    for _ in range(times):
        for engine in engines:
            start = time.perf_counter()
            engine.build(subject.vertices, subject.faces)
            seconds[engine.name].append(time.perf_counter() - start)
    records = []
    for engine in engines:
        # Memory of a child's child is not measured.
        is_elsewhere = isinstance(engine, AtLevel)
        grown = None if is_elsewhere else resident_bytes(type(engine), subject.vertices, subject.faces)
        records.append(
            {
                "mesh": subject.name,
                "triangles": len(subject.faces),
                "engine": engine.name,
                "version": version_of(engine.package),
                "build_seconds": statistics.median(seconds[engine.name]),
                "bytes_per_triangle": None if grown is None else grown / len(subject.faces),
            }
        )
    return records


def trace(engines, subject, options):
    """Print the tables of one mesh, row by row, and return the records that they are made of."""
    raywright, *others = engines
    sets = ray_sets(raywright.scene, subject, options.side, np.random.default_rng(1))
    records = []
    for threads in options.threads:
        print(f"\nOn {counted(threads, 'thread')}:\n")
        table = SpeedTable(others, options.threads[0])
        print(table.head(), flush=True)
        for name in options.rows:
            rays = sets[name]
            wrong, hit = agreement(engines, rays, threads)
            contenders = [(raywright, options.threads[0]), *((engine, threads) for engine in others)]
            timed = timed_beside(raywright, threads, contenders, rays, options.repeat)
            row = {"mesh": subject.name, "rays": name, "count": rays.count, "hit": hit, "on_threads": threads}
            of_row = [row | r | {"disagree_per_million": wrong[r["engine"], r["mode"]]} for r in timed]
            print(table.row(name, of_row), flush=True)
            records += of_row
    if others:
        print("\n" + disagreements_table([r for r in records if r["engine"] != "raywright"]))
    return records


def agreement(engines, rays, threads):
    """Return disagreements by (engine, mode), and the part of all rays that hit; it warms every engine up."""
    answers = {}
    for engine in engines:
        engine.use(threads)
        for mode in engine.modes:
            answers[engine.name, mode] = engine.trace(rays, mode)
    reference = answers["raywright", ""]
    return {key: disagreements(reference, answer) for key, answer in answers.items()}, reference[0].mean()


def chosen(among):
    """Return what reads a comma-separated choice of names."""

    def read(text):
        names = [name.strip() for name in text.split(",")]
        for name in names:
            if name not in among:
                raise argparse.ArgumentTypeError(f"{name!r} is none of: {', '.join(among)}")
        return names

    return read


def thread_counts(text):
    """Read comma-separated numbers of threads, fewest first."""
    counts = sorted({int(count) for count in text.split(",")})
    if counts[0] < 1:
        raise argparse.ArgumentTypeError(f"a number of threads is at least 1, got {counts[0]}")
    return counts


def compare(engines, subject, options, figures):
    """Print the tables of a mesh, and add what they are made of to the figures."""
    print(f"\n### {subject.name}: {len(subject.faces):,} triangles\n")
    costs = build(engines, subject, options.builds)
    print(engines_table(costs), flush=True)
    figures["engines"] += costs
    figures["rays"] += trace(engines, subject, options)
    if options.json:
        options.json.write_text(json.dumps(figures, indent=1))


def main():
    """Run the comparison that the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add = parser.add_argument
    add("--mesh", action="append", help=f"{', '.join(MADE)} or a file; may be given several times")
    add(
        "--turned", action="store_true", help="each mesh turned as well, by a rotation in no special position"
    )
    add("--triangles", type=int, default=70_000, help="size of the meshes that are made, about")
    add("--threads", type=thread_counts, default=thread_counts(f"1,{os.cpu_count()}"), help="such as 1,2,8")
    add("--side", type=int, default=1024, help="square root of the number of rays")
    add("--rows", type=chosen(NAMES), default=NAMES, help=f"some of: {', '.join(NAMES)}")
    add("--engines", type=chosen(ENGINES), default=ENGINES, help=f"some of: {', '.join(ENGINES)}")
    add("--repeat", type=int, default=7, help="turns that each engine gets")
    add("--builds", type=int, default=3, help="times that each engine builds each mesh")
    add("--json", type=Path, help="a file for all figures, turn by turn")
    options = parser.parse_args()
    machine = {"simd": rw.simd(), "machine": platform.machine(), "cores": os.cpu_count()}
    print(f"raywright {rw.__version__} at {rw.simd()}, {platform.machine()}, {os.cpu_count()} cores")
    engines = installed(["raywright", *(name for name in options.engines if name != "raywright")])
    figures = machine | {"side": options.side, "repeat": options.repeat, "engines": [], "rays": []}
    for mesh in options.mesh or MADE:
        straight = MADE[mesh](options.triangles, np.random.default_rng(0)) if mesh in MADE else given(mesh)
        for subject in (straight, turned(straight, np.float32)) if options.turned else (straight,):
            compare(engines, subject, options, figures)


if __name__ == "__main__":
    main()
