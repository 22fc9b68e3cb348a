"""Compare a graphics processor with the CPU: bits and rates of rays, and the error of pictures against time.

    python benches/gpu.py [--adapter NAME] [--rays 10000000] [--seconds 10] [--size 512] [--repeats 3]
                          [--triangles 60000] [--walks 1000000] [--mesh FILE]

Prints Markdown in four parts, each row as soon as it is known:

1. The adapters that wgpu finds, the one that is used, and the CPU.
2. Bits: `--rays` rays of four kinds, traced by the CPU and by the device. A row has million rays a second
   from numpy to numpy, for closest hits and for any hit, the share of rays that the device left to the CPU,
   and how many answers differ from the CPU's in any bit.
3. Pictures: relMSE against seconds. The CPU renders each twice, by the integrator and sampler that it chooses
   and by those of the device. The device's picture is compared with the latter by blocks of 16 by 16 pixels:
   the mean square of their differences in standard errors, z², is 1 where the device is unbiased.
4. Trees: one BVH as objects, as arrays and in a compute kernel, with `--walks` random rays.

With 16 cores and a graphics processor the defaults take about three minutes. Without a driver for Vulkan,
Metal or Direct3D 12 the device's rows are missing. The exit status is 1 if an answer or a picture is wrong.
"""

import argparse
import math
import os
import platform
import statistics
import sys
import time

import numpy as np

import raywright as rw

# Rays for the traversals in Python.
FEW = 300
# Seconds at which the error of a picture is printed.
TIMES = (0.5, 1, 2, 4, 8, 16, 32)
# Side in pixels of the blocks for comparisons.
BLOCK = 16


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
    """Return the median time of a call after a warm-up, and its result."""
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
    flat = scene.gpu_arrays()
    origins = (rays[0][:FEW] - flat.center) * flat.scale
    tree = Node(flat)
    ways = {
        "pointers, in Python": tree.hit,
        "arrays, in Python": lambda *ray: by_arrays(flat, *ray),
    }
    for name, walk in ways.items():
        start = time.perf_counter()
        found = [walk(o, d, (np.inf, -1)) for o, d in zip(origins, rays[1], strict=False)]
        took = time.perf_counter() - start
        wrong = sum(face != one for ((_, face), _), one in zip(found, wanted.primitive_id, strict=False))
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
        boxes = scene.traversal_cost(*(part[:20_000] for part in rays)).nodes.mean()
        count = len(rays[0])
        yield (
            *(name, f"{scene.accelerator_info.bytes / 1e6:.2f}", f"{boxes:.1f}"),
            *(rate(count, closest), rate(count, any_hit), ""),
        )


def in_compute(scene, rays, wanted, repeats, gpu):
    """Yield the row of a device."""
    if gpu is None:
        yield "compute, no device", "", "", "", "", ""
        return
    with scene.on_device(gpu) as there:
        closest, hits = seconds(lambda: there.intersect(*rays), repeats)
        any_hit, found = seconds(lambda: there.occluded(*rays), repeats)
        assert hits == wanted
        assert np.array_equal(found, wanted.hit)
        stats, count = there.stats, len(rays[0])
        left = f"{100 * stats.closest_share:.2g} % of closest, {100 * stats.any_share:.2g} % of any"
        yield (
            *(f"compute, {gpu.name}", f"{there.bytes / 1e6:.2f}", ""),
            *(rate(count, closest), rate(count, any_hit), left),
        )


def device(name):
    """Print which adapters there are, and return the device that is used, or None."""
    try:
        import wgpu

        for one in wgpu.gpu.enumerate_adapters_sync():
            info = one.info
            keys = "device", "description", "adapter_type", "backend_type"
            told = [info[key] for key in keys if info[key]]
            print("adapter: " + ", ".join(map(str, told)))
        gpu = rw.Gpu(name)
        print(f"device: {gpu.name}, {gpu.backend}")
    except (ImportError, RuntimeError) as missing:
        print(f"device: none, {missing}")
        gpu = None
    print(f"CPU: {processor()}, {os.cpu_count()} threads, raywright {rw.__version__}\n", flush=True)
    return gpu


def processor():
    """Return the name of the CPU."""
    try:
        with open("/proc/cpuinfo") as lines:
            return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def random_rays(scene, count, random):
    """Return rays from anywhere about a scene in any direction."""
    low, high = scene.bounds
    middle, size = (low + high) / 2, high - low
    origins = middle + 1.5 * size * (random.random((count, 3)) - 0.5)
    directions = random.normal(size=origins.shape)
    return origins, directions / np.linalg.norm(directions, axis=1, keepdims=True)


def kinds_of_rays(scene, count):
    """Yield four kinds of rays, each with its name, as arguments of `intersect`."""
    random = np.random.default_rng(1)
    low, high = scene.bounds
    middle, size = (low + high) / 2, np.linalg.norm(high - low)
    side = max(math.isqrt(count), 1)
    camera = rw.Camera(middle + size * np.array([0, -0.4, 0.9]), middle, width=side, height=side)
    yield "camera", [np.reshape(part, (-1, 3)) for part in camera.rays()]
    origins, directions = random_rays(scene, count, random)
    yield "random", [origins, directions]
    hits = scene.intersect(origins, directions)
    points = (origins + np.where(hits.hit, hits.t, 0)[:, None] * directions)[hits.hit]
    points = np.resize(points, (count, 3)) if len(points) else origins
    yield "shadow", [points, middle + size * np.array([0, 1, 0]) - points, 1e-4, 1.0]
    meshes = [shape for shape in scene.shapes if isinstance(shape, rw.Mesh)]
    corners = np.concatenate([np.asarray(mesh.vertices, float)[mesh.faces] for mesh in meshes])
    ends = corners[random.integers(len(corners), size=count)]
    along = random.choice([0, 0.5, 1], size=(count, 1))
    yield "at edges and corners", [origins, ends[:, 0] + along * (ends[:, 1] - ends[:, 0]) - origins]


def differing(hits, wanted):
    """Count rays whose answers differ in any bit."""
    wrong = np.zeros(hits.t.shape, bool)
    for name in ("t", "shape_id", "primitive", "uv"):
        one, other = (np.ascontiguousarray(getattr(each, name)) for each in (hits, wanted))
        parts = one.view(np.uint8) != other.view(np.uint8)
        wrong |= parts.reshape(len(wrong), -1).any(axis=1)
    return int(wrong.sum())


def in_bits(shapes, count, repeats, gpu):
    """Print the table of rays, and return how many answers of the device differ from the CPU's."""
    scene = rw.Scene(shapes)
    faces = sum(len(shape.faces) for shape in scene.shapes if isinstance(shape, rw.Mesh))
    print(f"bits of {count} rays, {faces} faces\n")
    print("| rays | | by | closest, M rays/s | any, M rays/s | left to the CPU: closest, any | differ |")
    print("|---|---|---|---|---|---|---|")
    wrong = asked = 0
    for kind, rays in kinds_of_rays(scene, count // 4):
        closest, wanted = seconds(lambda rays=rays: scene.intersect(*rays), repeats)
        any_hit, shadowed = seconds(lambda rays=rays: scene.occluded(*rays), repeats)
        number = len(rays[0])
        said = f"{number}, {100 * wanted.hit.mean():.0f} % hit"
        print(row(kind, said, "CPU", rate(number, closest), rate(number, any_hit), "", ""), flush=True)
        if gpu is None:
            continue
        with scene.on_device(gpu) as there:
            closest, hits = seconds(lambda rays=rays, there=there: there.intersect(*rays), repeats)
            any_hit, found = seconds(lambda rays=rays, there=there: there.occluded(*rays), repeats)
            left = f"{100 * there.stats.closest_share:.2g} %, {100 * there.stats.any_share:.2g} %"
        off = differing(hits, wanted) + int(np.count_nonzero(found != shadowed))
        print(row("", "", gpu.name, rate(number, closest), rate(number, any_hit), left, off), flush=True)
        wrong, asked = wrong + off, asked + 2 * number
    print(f"\n{wrong} of {asked} answers of the device differ from the CPU's\n", flush=True)
    return wrong


def row(*cells):
    """Return a row of a table."""
    return "| " + " | ".join(map(str, cells)) + " |"


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


def at_times(history, times):
    """Return the relMSE of a picture at some seconds, between its passes by powers of time."""
    known = history[np.isfinite(history["error"]) & (history["error"] > 0)]
    if not len(known):
        return ["" for _ in times]
    when, error = np.log(known["seconds"]), np.log(known["error"])
    return [
        f"{math.exp(np.interp(math.log(t), when, error)):.3g}" if when[0] <= math.log(t) <= when[-1] else ""
        for t in times
    ]


def difference(one, other):
    """Return mean square and maximum of the differences of two pictures' blocks, in standard errors."""

    def in_blocks(array):
        rows, columns = (n // BLOCK * BLOCK for n in array.shape[:2])
        blocks = array[:rows, :columns].astype(float)
        return blocks.reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK, -1).mean(axis=(1, 3))

    variance = sum(in_blocks(each.standard_error.astype(float) ** 2) for each in (one, other)) / BLOCK**2
    # If all samples agree, the error is that of float32 pictures.
    error = np.sqrt(variance) + 3e-6 * (1e-3 + in_blocks(other.rgb))
    z = (in_blocks(one.rgb) - in_blocks(other.rgb)) / error
    return float(np.mean(z**2)), float(np.abs(z).max())


def in_pictures(size, seconds, gpu):
    """Print the table of pictures, and return how many of the device's are wrong."""
    times = [t for t in TIMES if t < seconds]
    print(f"pictures of {size} by {size} pixels, {seconds:g} s each: relMSE after so many seconds\n")
    columns = ("first pass, s", "M samples/s", *(f"{t:g} s" for t in times), f"{seconds:g} s", "z²")
    print(row("picture", "by", *columns))
    print("|---" * (len(columns) + 2) + "|")
    path, same, wrong = rw.Path(reuse=1, guiding="none"), rw.rendering.Independent(), 0
    cpu = f"CPU, {os.cpu_count()} threads"
    ways = [(f"{cpu}, its own choice", None, rw.Path(), None), (cpu, None, path, same)]
    if gpu is not None:
        ways.append((gpu.name, gpu, path, same))
    for name, scene, camera in pictures(size):
        images = []
        for told, device, integrator, sampler in ways:
            options = {"sampler": sampler, "device": device, "seed": len(images), "progress": False}
            image = rw.render(scene, camera, integrator, seconds=seconds, **options)
            assert device is None or image.plan["device"].chosen == told
            images.append(image)
            history = image.history
            # From the first pass on, since kernels compile before it.
            taken = np.ptp(history["samples"]) * size * size
            spent = max(np.ptp(history["seconds"]), 1e-9)
            z = ""
            if device is not None:
                square, largest = difference(image, images[1])
                z = f"{square:.2f}, at most {largest:.1f}²"
                # Channels may be equal; eight deviations of chi square leave room for tails.
                wrong += not (square < 1 + 8 * math.sqrt(2 / (size // BLOCK) ** 2) and largest < 7)
            first = f"{history['seconds'][0]:.2g}"
            errors = (*at_times(history, times), f"{image.error.estimate:.3g}")
            print(row(name, told, first, rate(taken, spent), *errors, z), flush=True)
    print(flush=True)
    return wrong


def in_trees(shapes, count, repeats, gpu):
    """Print the table of trees."""
    scene = rw.Scene(shapes)
    rays = random_rays(scene, count, np.random.default_rng(0))
    wanted = scene.intersect(*rays)
    print(f"trees, {count} random rays, {100 * wanted.hit.mean():.0f} % of which hit\n")
    print("| the tree | MB | boxes a ray | closest, M rays/s | any, M rays/s | |")
    print("|---|---|---|---|---|---|")
    for rows in (
        in_python(scene, rays, wanted),
        in_core(shapes, rays, wanted, repeats),
        in_compute(scene, rays, wanted, repeats, gpu),
    ):
        for cells in rows:
            print(row(*cells), flush=True)


def main():
    """Measure, print tables, and return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=60_000)
    parser.add_argument("--rays", type=int, default=10_000_000, help="of which bits are compared")
    parser.add_argument("--walks", type=int, default=1_000_000, help="rays for the table of trees")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--adapter")
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--size", type=int, default=512, help="of pictures, in pixels a side")
    parser.add_argument("--mesh", help="an .npz with vertices and faces, or a mesh file")
    arguments = parser.parse_args()
    start = time.perf_counter()
    gpu = device(arguments.adapter)
    if arguments.mesh and arguments.mesh.endswith(".npz"):
        with np.load(arguments.mesh) as arrays:
            shapes = rw.Mesh(arrays["vertices"], arrays["faces"])
    else:
        around = max(round((arguments.triangles / 60) ** 0.5), 3)
        shapes = arguments.mesh or rw.scenes.torus_knot(along=30 * around, around=around)
    wrong = in_bits(shapes, arguments.rays, arguments.repeats, gpu)
    wrong += in_pictures(arguments.size, arguments.seconds, gpu)
    in_trees(shapes, arguments.walks, arguments.repeats, gpu)
    print(f"\n{time.perf_counter() - start:.0f} s in all, {wrong} wrong")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main())
