"""The same tree as pointers, as arrays and in a compute kernel: who asks a million rays of it, and how soon.

    python benches/gpu.py [--triangles 60000] [--rays 1000000] [--repeats 5] [--adapter NAME] [--mesh FILE]
                          [--seconds 10] [--size 256]

Prints Markdown: a row a way, with the bytes of its tree, the boxes that a ray tests, million rays a second
from numpy to numpy for closest hits and for any hit, and of kernels the share of rays that were left to the
CPU. The walks in Python are asked few rays. Every answer is held against the default tree's, to the bit
where it is the core's. A second table is of pictures: how many samples the CPU takes of each in a second, and
how many the device, each with its name, and how wrong the picture is after so many seconds, by the same
estimator and independent samples. Without a driver for Vulkan, Metal or Direct3D 12 the last row says so.
"""

import argparse
import os
import statistics
import time

import numpy as np

import raywright as rw

# What walks in Python are asked.
FEW = 300


class Node:
    """A node as a program has it that knows no arrays: a box, and two children or some faces."""

    def __init__(self, flat, i=0):
        one = flat.nodes[i]
        self.lower, self.upper = one["lower"].astype(float), one["upper"].astype(float)
        self.faces, self.children = [], []
        if one["count"]:
            some = flat.triangles[one["index"] : one["index"] + one["count"]]
            self.faces = [
                (
                    int(t["primitive"]),
                    t["corner"].astype(float),
                    t["edge"].astype(float),
                    t["other"].astype(float),
                )
                for t in some
            ]
        else:
            first = i + 1
            second = first + 1 if flat.nodes["count"][first] else int(flat.nodes["index"][first])
            self.children = [Node(flat, first), Node(flat, second)]

    def hit(self, origin, direction, best):
        """Return (t, face) of the closest hit, at most `best`, and how many boxes were tested."""
        ends = (np.stack([self.lower, self.upper]) - origin) / direction
        near, far = ends.min(axis=0).max(), ends.max(axis=0).min()
        if near > far + 1e-5 or far < 0 or near > best[0]:
            return best, 1
        for face in self.faces:
            best = closer(*face, origin, direction, best)
        boxes = 1
        for child in self.children:
            best, more = child.hit(origin, direction, best)
            boxes += more
        return best, boxes


def closer(number, corner, edge, other, origin, direction, best):
    """Return the closer of a hit and that of a face (Moeller and Trumbore 1997)."""
    p = np.cross(direction, other)
    determinant = edge @ p
    if determinant == 0:
        return best
    s = origin - corner
    u, q = s @ p / determinant, np.cross(s, edge)
    v, t = direction @ q / determinant, other @ q / determinant
    return (t, number) if u >= 0 and v >= 0 and u + v <= 1 and 0 <= t < best[0] else best


def by_arrays(flat, origin, direction, best):
    """Return what `Node.hit` does, from the arrays alone: one number for all of the walk's state."""
    nodes, triangles, i, boxes = flat.nodes, flat.triangles, 0, 0
    while i < len(nodes):
        node = nodes[i]
        boxes += 1
        ends = (np.stack([node["lower"], node["upper"]]) - origin) / direction
        near, far = ends.min(axis=0).max(), ends.max(axis=0).min()
        if near > far + 1e-5 or far < 0 or near > best[0]:
            i = i + 1 if node["count"] else int(node["index"])
            continue
        for t in triangles[node["index"] : node["index"] + node["count"]]:
            face = (int(t["primitive"]), *(t[name].astype(float) for name in ("corner", "edge", "other")))
            best = closer(*face, origin, direction, best)
        i += 1
    return best, boxes


def seconds(ask, repeats):
    """Return the median time of a call, after one that warms up, and what it returns."""
    answer, times = ask(), []
    for _ in range(repeats):
        start = time.perf_counter()
        answer = ask()
        times.append(time.perf_counter() - start)
    return statistics.median(times), answer


def rate(count, took):
    """Return million rays a second, for people."""
    return f"{1e-6 * count / took:.3g}"


def in_python(scene, rays, wanted):
    """Yield rows of the two walks in Python."""
    flat = scene.flat()
    origins = (rays[0][:FEW] - flat.centre) * flat.scale
    tree = Node(flat)
    ways = {
        "pointers, in Python": tree.hit,
        "arrays, in Python": lambda *ray: by_arrays(flat, *ray),
    }
    for name, walk in ways.items():
        start = time.perf_counter()
        found = [walk(o, d, (np.inf, -1)) for o, d in zip(origins, rays[1], strict=False)]
        took = time.perf_counter() - start
        wrong = sum(face != one for ((_, face), _), one in zip(found, wanted.primitive, strict=False))
        boxes = statistics.fmean(boxes for _, boxes in found)
        told = "" if "arrays" not in name else f"{flat.bytes / 1e6:.2f}"
        yield name, told, f"{boxes:.1f}", rate(FEW, took), "", f"{wrong} of {FEW} wrong"


def in_core(shapes, rays, wanted, repeats):
    """Yield rows of the core's walks."""
    ways = {
        "binary tree, stack": rw.BVH(traversal="stack"),
        "arrays, stack": rw.BVH(traversal="flat"),
        "arrays, no stack": rw.BVH(traversal="stackless"),
        "links, no stack": rw.BVH(traversal="threaded"),
        "wide tree, the default": rw.BVH(),
    }
    for name, accelerator in ways.items():
        scene = rw.Scene(shapes, accelerator=accelerator)
        closest, hits = seconds(lambda scene=scene: scene.intersect(*rays), repeats)
        any_hit, found = seconds(lambda scene=scene: scene.occluded(*rays), repeats)
        assert hits == wanted
        assert np.array_equal(found, wanted.hit)
        boxes = scene.cost(*(part[:20_000] for part in rays)).nodes.mean()
        count = len(rays[0])
        yield (
            *(name, f"{scene.accelerator.bytes / 1e6:.2f}", f"{boxes:.1f}"),
            *(rate(count, closest), rate(count, any_hit), ""),
        )


def in_compute(scene, rays, wanted, repeats, adapter):
    """Yield the row of a device."""
    try:
        gpu = rw.Gpu(adapter)
    except (ImportError, RuntimeError) as missing:
        yield "compute", "", "", "", "", str(missing)
        return
    with scene.on(gpu) as there:
        closest, hits = seconds(lambda: there.intersect(*rays), repeats)
        any_hit, found = seconds(lambda: there.occluded(*rays), repeats)
        assert hits == wanted
        assert np.array_equal(found, wanted.hit)
        stats, count = there.stats, len(rays[0])
        left = f"{100 * stats.closest_share:.2g} % of closest, {100 * stats.any_share:.2g} % of any"
        row = (f"compute, {gpu.name}", f"{there.bytes / 1e6:.2f}", "")
        yield *row, rate(count, closest), rate(count, any_hit), left


def pictures(size):
    """Yield scenes that devices know, each with its name and a camera."""
    yield "Cornell box", *rw.scenes.cornell_box(width=size, height=size)
    sky = np.random.default_rng(0).random((64, 128, 3)) ** 4
    sky[20, 70] = 400
    gold = rw.scenes.torus_knot(along=300, around=30)
    gold = rw.Mesh(
        gold.vertices, gold.faces, normals=gold.normals, material=rw.Conductor("gold", roughness=0.4)
    )
    camera = rw.Camera((0, -3, 7), (0, 0, 0), width=size, height=size)
    yield (
        f"golden knot of {len(gold.faces)} faces",
        rw.Scene(gold, environment=rw.EnvironmentMap(sky)),
        camera,
    )


def in_pictures(size, seconds, adapter):
    """Yield rows of pictures: by the CPU, and by a device if there is one."""
    devices = [(f"CPU, {os.cpu_count()} threads", None)]
    try:
        gpu = rw.Gpu(adapter)
        devices.append((gpu.name, gpu))
    except (ImportError, RuntimeError) as missing:
        yield "", "compute", "", str(missing)
    for name, scene, camera in pictures(size):
        path = rw.Path(reuse=1, caustics=False)
        for told, device in devices:
            image = rw.render(
                scene,
                camera,
                path,
                seconds=seconds,
                sampler=rw.Independent(),
                progress=False,
                device=device,
            )
            assert device is None or image.plan["device"].chosen == told
            # From the first pass on: before, kernels are compiled.
            taken = np.ptp(image.history["samples"]) * size * size
            spent = max(np.ptp(image.history["seconds"]), 1e-9)
            yield name, told, rate(taken, spent), f"{image.error.estimate:.3g}"


def main():
    """Measure, and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=60_000)
    parser.add_argument("--rays", type=int, default=1_000_000)
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--adapter")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--size", type=int, default=256, help="of pictures, in pixels a side")
    parser.add_argument("--mesh", help="an .npz with vertices and faces, or a mesh file")
    arguments = parser.parse_args()
    if arguments.mesh and arguments.mesh.endswith(".npz"):
        with np.load(arguments.mesh) as arrays:
            shapes = rw.Mesh(arrays["vertices"], arrays["faces"])
    else:
        around = max(round((arguments.triangles / 60) ** 0.5), 3)
        shapes = arguments.mesh or rw.scenes.torus_knot(along=30 * around, around=around)
    scene = rw.Scene(shapes)
    low, high = scene.bounds
    random = np.random.default_rng(0)
    middle, size = (low + high) / 2, high - low
    origins = middle + 1.5 * size * (random.random((arguments.rays, 3)) - 0.5)
    directions = random.normal(size=origins.shape)
    rays = origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)
    wanted = scene.intersect(*rays)
    faces = sum(len(shape.faces) for shape in scene.shapes if isinstance(shape, rw.Mesh))
    print(f"{faces} faces, {arguments.rays} random rays, {100 * wanted.hit.mean():.0f} % of which hit\n")
    print("| the tree | MB | boxes a ray | closest, M rays/s | any, M rays/s | |")
    print("|---|---|---|---|---|---|")
    for rows in (
        in_python(scene, rays, wanted),
        in_core(shapes, rays, wanted, arguments.repeats),
        in_compute(scene, rays, wanted, arguments.repeats, arguments.adapter),
    ):
        for row in rows:
            print("| " + " | ".join(row) + " |", flush=True)
    print(f"\npictures of {arguments.size} by {arguments.size} pixels, {arguments.seconds:g} s each\n")
    print("| picture | by | M samples/s | relMSE |")
    print("|---|---|---|---|")
    for row in in_pictures(arguments.size, arguments.seconds, arguments.adapter):
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
