"""What textbooks say of accelerators, measured: every structure on the scenes that they argue with.

    python benches/textbooks.py [--triangles 50000] [--side 256] [--repeats 5] [--scene NAME ...]

Prints Markdown: a table for each scene of `raywright.scenes.classics`, with ratios to the default BVH's
rays a second, and then one line for each thing that textbooks say, with the figures for and against it.
All trees of two children are walked in the same way, so that rows differ by the tree alone; answers are held
against brute force.
"""

import argparse
from statistics import geometric_mean

import raywright as rw

# The default is the wide tree of scenes without options.
CONTENDERS = {
    "default": rw.BVH(),
    "median": rw.BVH(builder="median", traversal="stack"),
    "midpoint": rw.BVH(builder="midpoint", traversal="stack"),
    "Morton": rw.BVH(builder="morton", traversal="stack"),
    "PLOC": rw.BVH(builder="ploc", traversal="stack"),
    "binned SAH": rw.BVH(builder="binned", optimize=(), traversal="stack"),
    "spatial SAH": rw.BVH(builder="spatial", traversal="stack"),
    "kD-tree": rw.accelerators.KdTree(),
    "grid": rw.accelerators.Grid(),
    "nested grid": rw.accelerators.NestedGrid(),
    "octree": rw.accelerators.Octree(),
    "BSP tree": rw.accelerators.BSP(),
}
SETS = ("primary", "diffuse", "shadow")


class Measured:
    """One scene by all contenders."""

    def __init__(self, scene, camera, arguments):
        rays = rw.report.typical_rays(scene, camera, seed=0)
        report = rw.report.accelerators(
            scene, rays, CONTENDERS, threads=arguments.threads, repeats=arguments.repeats
        )
        self.rows = {one.name: one for one in report.measured}
        self.sets = [name for name in SETS if name in next(iter(self.rows.values())).rays]

    def mrays(self, name):
        """Return million rays a second, the geometric mean over the sets of rays."""
        return 1e-6 / geometric_mean([self.rows[name].seconds_per_ray[rays] for rays in self.sets])

    def tests(self, name):
        """Return primitives tested for a ray."""
        return sum(self.rows[name].primitives[rays] for rays in self.sets) / len(self.sets)

    def lines(self):
        """Yield a table."""
        yield "| | build ms | MB | nodes a ray | tests a ray | " + " | ".join(self.sets) + " | to default |"
        yield "|---|" + "---|" * (5 + len(self.sets))
        for name, one in self.rows.items():
            nodes = sum(one.nodes[rays] for rays in self.sets) / len(self.sets)
            speeds = " | ".join(f"{1e-6 / one.seconds_per_ray[rays]:.2f}" for rays in self.sets)
            wrong = sum(one.wrong.values())
            told = f" **{wrong} wrong**" if wrong else ""
            share = self.mrays(name) / self.mrays("default")
            yield (
                f"| {name}{told} | {1e3 * one.build_seconds:.1f} | {one.info.bytes / 1e6:.1f} | "
                f"{nodes:.1f} | {self.tests(name):.1f} | {speeds} | {share:.2f} |"
            )


def sayings(of):
    """Yield what textbooks say, and what was seen; `of` has the scenes that were measured."""
    if "terrain" in of and "stadium" in of:
        even, hall = (
            of[name].mrays("grid") / of[name].mrays("binned SAH") for name in ("terrain", "stadium")
        )
        yield (
            f"A grid suits evenly distributed geometry, and collapses in the stadium: {even:.2f} times the "
            f"rays a second of the binned tree on the terrain, {hall:.2f} in the stadium."
        )
    if "stadium" in of:
        nested = of["stadium"].mrays("nested grid") / of["stadium"].mrays("grid")
        yield f"A nested grid repairs that: {nested:.1f} times the rays a second of the plain grid."
    if "diagonal_wall" in of:
        straight, turned = (
            {name: of[wall].tests(name) for name in ("binned SAH", "spatial SAH")}
            for wall in ("straight_wall", "diagonal_wall")
        )
        yield (
            "Spatial splits repair rotation: number of tests in the wall turned by 45 degrees, over the "
            + "straight one: "
            + ", ".join(f"{turned[name] / straight[name]:.2f} ({name})" for name in turned)
            + "."
        )
    if "turned_room" in of:
        rows = (
            f"{of['room'].mrays(name) / of['turned_room'].mrays(name):.2f} ({name})"
            for name in ("default", "binned SAH", "spatial SAH", "kD-tree", "BSP tree", "grid")
        )
        yield f"Time in the turned room, over the straight one: {', '.join(rows)}."
    gains = [one.mrays("binned SAH") / one.mrays("median") for one in of.values()]
    yield (
        f"The surface area heuristic doubles a median tree: {geometric_mean(gains):.2f} times the rays a "
        f"second over all scenes, {min(gains):.2f} to {max(gains):.2f}."
    )
    gains = [one.mrays("PLOC") / one.mrays("Morton") for one in of.values()]
    yield f"Clustering repairs Morton order: PLOC has {geometric_mean(gains):.2f} times its rays a second."
    gains = [one.mrays("kD-tree") / one.mrays("binned SAH") for one in of.values()]
    yield (
        f"The kD-tree was long held to be the fastest: {geometric_mean(gains):.2f} times the binned tree of "
        f"two children, {min(gains):.2f} to {max(gains):.2f}."
    )


def main():
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--triangles", type=int, default=50_000, help="of a scene, about")
    parser.add_argument("--side", type=int, default=256, help="pixels on a side of the camera's picture")
    parser.add_argument("--repeats", type=int, default=5, help="turns")
    parser.add_argument("--threads", type=int, default=1, help="that trace rays")
    parser.add_argument("--scene", action="append", help="which; all if not given")
    arguments = parser.parse_args()
    scenes = rw.scenes.classics(arguments.triangles, width=arguments.side, height=arguments.side)
    unknown = set(arguments.scene or ()) - set(scenes)
    if unknown:
        parser.error(f"no such scene: {', '.join(sorted(unknown))}; there are {', '.join(scenes)}")
    of = {}
    for name, (scene, camera) in scenes.items():
        if arguments.scene is None or name in arguments.scene:
            of[name] = Measured(scene, camera, arguments)
            print(f"\n### {name}\n", *of[name].lines(), sep="\n", flush=True)
    print("\n### Claims and measurements\n", *(f"- {line}" for line in sayings(of)), sep="\n")


if __name__ == "__main__":
    main()
