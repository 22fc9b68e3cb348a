"""How calls scale with threads: a table of times, and a model of what limits each.

    python benches/scaling.py                             # a room of 100,000 triangles, 1, 2, 4, ... threads
    python benches/scaling.py --mesh bunny.npz --threads 1,2 --predict 64

For each call the table has its time on one thread and on the most, the speed-up, and processor time on
the most threads over that on one (1 if threads do not slow each other down). Answers are compared bit by
bit before they are timed.

The model has three parts. With T(n) the time on n threads, and C(n) the processor time,

    T(n) = s + c (T(1) - s) / n,      c = C(n) / C(1),

where s is the serial part, such as the allocation of arrays and what Python does, and c the price of
sharing caches, memory and the core's execution units. Both follow from two measured numbers of threads.
No call takes less than its arrays take to pass through memory: `bytes` of a ray over the bandwidth that
all threads reach together when they copy. The prediction is the larger of both; c and the bandwidth are
taken from this machine, so that it is a bound for what this machine's memory would allow, unless
`--bandwidth` gives that of another.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import threading
import time

# numpy's arithmetic would have threads of its own otherwise.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from peers_meshes import MADE, given

import raywright as rw
from raywright import _core

_GAP = 0.02
_COPIED = 1 << 26
# Of its time on one thread, a call has the processor at least for this share on an idle machine.
_IDLE = 0.9
# Builds take all threads that there are: another process has as many as it is told.
_BUILD = """
import sys, time
import numpy as np
import raywright as rw
with np.load(sys.argv[1]) as arrays:
    mesh = rw.Mesh(arrays["vertices"], arrays["faces"])
times = []
for _ in range(int(sys.argv[2])):
    scene = rw.Scene([mesh])
    start, used = time.perf_counter(), time.process_time()
    scene.build(progress=False)
    times.append((time.perf_counter() - start, time.process_time() - used))
print(*np.min(times, axis=0))
"""


def calls(subject, size, rng):
    """Return each call by name: a function of the number of threads, its rays or points, and their bytes."""
    scene = rw.Scene([rw.Mesh(subject.vertices, subject.faces)])
    camera = rw.Camera(subject.eye, subject.target, fov=50, width=size[0], height=size[1])
    origins, directions = camera.rays(dtype=np.float32)
    hits = scene.intersect(origins, directions)
    lamp = rw.PointLight(subject.lamp, 1)
    facing = np.where(np.sum(hits.normal * directions, axis=-1, keepdims=True) <= 0, 1, -1) * hits.normal
    sphere = rng.normal(size=facing.shape)
    sphere /= np.linalg.norm(sphere, axis=-1, keepdims=True)
    ways = (facing + sphere)[hits.hit].astype(np.float32)
    starts = hits.spawn_rays(facing).origins[hits.hit]
    mesh = subject.vertices.max(axis=0) - subject.vertices.min(axis=0)
    points = (subject.vertices.min(axis=0) + rng.random((50_000, 3)) * mesh).astype(np.float32)
    small = rw.Camera(subject.eye, subject.target, fov=50, width=160, height=120)
    lit = rw.Scene([rw.Mesh(subject.vertices, subject.faces)], environment=rw.ConstantEnvironment(1.0))
    pixels, bounced = directions[..., 0].size, len(ways)

    def rendered(threads):
        return rw.render(lit, small, samples=4, adaptive=False, progress=False, threads=threads).rgb

    def nearest(threads):
        return scene.closest_point(points, threads=threads).distance

    return {
        "primary": (lambda n: scene.intersect(origins, directions, threads=n).t, pixels, 24 + 32),
        "primary, t alone": (
            lambda n: scene.intersect(origins, directions, threads=n, fields="t").t,
            pixels,
            24 + 8,
        ),
        "diffuse": (lambda n: scene.intersect(starts, ways, threads=n).t, bounced, 36 + 32),
        "diffuse, hit alone": (lambda n: scene.occluded(starts, ways, threads=n), bounced, 36 + 1),
        "preview": (lambda n: scene.preview(camera, lamp, threads=n), pixels, 3),
        "closest points": (nearest, len(points), 12 + 56),
        "picture": (rendered, 160 * 120 * 4, 0),
    }


def timed(call, threads, repeats):
    """Return the least seconds of a call, and those of all processors."""
    walls, busy = [], []
    for _ in range(repeats):
        # Pools that have just worked are still awake.
        time.sleep(_GAP)
        start, used = time.perf_counter(), time.process_time()
        call(threads)
        walls.append(time.perf_counter() - start)
        busy.append(time.process_time() - used)
    return min(walls), min(busy)


def built(path, threads, repeats):
    """Return the same of the build of a mesh in a file."""
    environment = {**os.environ, "RAYON_NUM_THREADS": str(threads)}
    command = [sys.executable, "-c", _BUILD, path, str(repeats)]
    told = subprocess.run(command, env=environment, check=True, capture_output=True, text=True).stdout
    wall, busy = map(float, told.split())
    return wall, busy


def bandwidth(threads):
    """Return bytes a second, read and written, that so many threads reach when they copy."""
    arrays = [(np.ones(_COPIED // 8), np.empty(_COPIED // 8)) for _ in range(threads)]

    def copy(pair):
        for _ in range(4):
            np.copyto(pair[1], pair[0])

    best = 0.0
    for _ in range(3):
        workers = [threading.Thread(target=copy, args=(pair,)) for pair in arrays]
        start = time.perf_counter()
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()
        best = max(best, 8 * _COPIED * threads / (time.perf_counter() - start))
    return best


def serial(one, most, threads, price):
    """Return the serial part of the time on one thread."""
    share = price / threads
    return min(max((most - share * one) / (1 - share), 0.0), one) if share < 1 else 0.0


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--mesh", default="room", help=f"{', '.join(MADE)}, or a file")
    parser.add_argument("--triangles", type=int, default=100_000, help="of meshes that are made here")
    parser.add_argument("--size", default="800x600", help="of the picture")
    parser.add_argument("--threads", help="numbers of threads; 1, 2, 4, ... up to the cores if not given")
    parser.add_argument("--predict", type=int, default=64, help="threads that the model is asked for")
    parser.add_argument("--bandwidth", type=float, help="GB/s of the machine that the model is asked for")
    parser.add_argument("--repeats", type=int, default=7)
    told = parser.parse_args()
    cores = _core.cores()
    counts = sorted({1, *(2**k for k in range(1, 12) if 2**k <= cores), cores})
    if told.threads:
        counts = [int(count) for count in told.threads.split(",")]
    rng = np.random.default_rng(1)
    subject = MADE[told.mesh](told.triangles, rng) if told.mesh in MADE else given(told.mesh)
    size = tuple(int(side) for side in told.size.split("x"))
    speed = bandwidth(counts[-1])
    there = 1e9 * told.bandwidth if told.bandwidth else speed
    triangles = f"{len(subject.faces):,} triangles"
    print(f"{subject.name}, {triangles}, {rw.simd()}, {cores} cores, {speed / 1e9:.1f} GB/s\n")
    heads = ["call", *(f"{n} threads, ms" for n in counts), "speed-up", "processor time", "serial, %"]
    print(f"| {' | '.join([*heads, 'bytes', f'{told.predict} threads, speed-up', 'limit'])} |")
    print("|---" * (len(heads) + 3) + "|")
    is_busy = []
    for name, (call, items, size_of_one) in calls(subject, size, rng).items():
        first = np.asarray(call(1))
        if not all(np.array_equal(first, call(n), equal_nan=first.dtype.kind == "f") for n in counts):
            raise SystemExit(f"{name}: the answer depends on the number of threads")
        times = [timed(call, n, told.repeats) for n in counts]
        is_busy.append(times[0][1] < _IDLE * times[0][0])
        print(row(name, counts, times, told.predict, items * size_of_one / there, size_of_one), flush=True)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "mesh.npz")
        np.savez(path, vertices=subject.vertices, faces=subject.faces)
        times = [built(path, n, told.repeats) for n in counts]
    print(row("build", counts, times, told.predict, 24 * len(subject.faces) / there, 24))
    if any(is_busy):
        told = f"{sum(is_busy)} of {len(is_busy)} calls had to wait for a processor"
        print(f"\n{told}: run this on an idle machine")


def row(name, counts, times, threads, streamed, size):
    """Return the row of a call: its times, what the model has of it, and what it says of so many threads."""
    (one, used), (most, used_by_most), last = times[0], times[-1], counts[-1]
    price = max(used_by_most / used, 1.0)
    fixed = serial(one, most, last, price)
    shared = price * (one - fixed) / threads
    limits = {"serial parts": fixed, "bandwidth": streamed, "processors": shared}
    predicted = max(fixed + shared, streamed)
    cells = [name, *(f"{1e3 * wall:.1f}" for wall, _ in times), f"{one / most:.2f}", f"{price:.2f}"]
    cells += [f"{100 * fixed / one:.1f}", f"{size}", f"{one / predicted:.0f}", max(limits, key=limits.get)]
    return f"| {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
