"""Where the time of a picture goes: ns a vertex by part, for scenes of several kinds, on one thread.

    maturin develop --release --features timing
    python benches/shading.py [--scene NAME ...] [--side 256] [--samples 16] [--repeat 5] [--reuse 1]

A vertex is a surface that a path has come to. `shading` is all but the camera, the rays and the film: what
is known of surfaces, light that is asked for, random numbers, where paths go on to. Looking at the clock
takes time as well, which is measured and taken off; still, the sum is a little more than a picture takes
without. Choose instructions with RAYWRIGHT_SIMD, as avx2.
"""

import argparse
import dataclasses
import statistics

from render_peers import scenes

import raywright as rw
from raywright import _core

RAYS = ("camera", "closest", "shadow", "film")

# Materials of the blocks in the Cornell box, by scene.
KINDS = {
    "glass": rw.Dielectric(1.5),
    "pane": rw.ThinDielectric(1.5),
    "mirror": rw.Mirror(0.9),
    "metal": rw.Conductor("Au"),
    "rough metal": rw.Conductor("Au", roughness=0.5),
    "plastic": rw.Plastic((0.2, 0.4, 0.8)),
    "rough plastic": rw.Plastic((0.2, 0.4, 0.8), roughness=0.5),
    "metallic rough": rw.MetallicRough((0.9, 0.6, 0.2), 0.5, 0.5),
}


def of_kind(material, side):
    """Return the Cornell box with blocks of a material, its camera, and no limit of bounces."""
    scene, camera = rw.scenes.cornell_box(width=side, height=side)
    *room, short, tall = scene.shapes
    blocks = [dataclasses.replace(block, material=material) for block in (short, tall)]
    return rw.Scene([*room, *blocks]), camera, None


def told(scene, camera, path, arguments):
    """Return nanoseconds a vertex by part, medians of several pictures, and vertices of a sample."""
    rows = []
    for turn in range(arguments.repeat + 1):
        _core.timing()
        rw.render(scene, camera, path, samples=arguments.samples, seed=turn, threads=1, progress=False)
        spent, vertices = _core.timing()
        # The first turn compiles the scene, and meets cold caches.
        if turn:
            rows.append({name: ns / vertices for name, ns in spent})
    samples = camera.width * camera.height * arguments.samples
    return {name: statistics.median(row[name] for row in rows) for name in rows[0]}, vertices / samples


def main():
    """Render and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    which = f"which; by default those of render_peers.py, or one of {', '.join(KINDS)}"
    parser.add_argument("--scene", action="append", help=which)
    parser.add_argument("--side", type=int, default=256, help="pixels on a side")
    parser.add_argument("--samples", type=int, default=16, help="of each pixel")
    parser.add_argument("--repeat", type=int, default=5, help="turns")
    parser.add_argument("--reuse", type=int, default=1, help="side of the patches that share paths")
    arguments = parser.parse_args()
    if not hasattr(_core, "timing"):
        parser.error(
            "raywright must be built with the feature timing: maturin develop --release --features timing"
        )
    known = scenes(None, arguments.side)
    usual = list(known)
    for name, material in KINDS.items():
        known[name] = lambda material=material: of_kind(material, arguments.side)
    columns = {}
    for name in arguments.scene or usual:
        if name not in known:
            parser.error(f"--scene is {name!r}, expected one of {', '.join(known)}")
        scene, camera, depth = known[name]()
        path = rw.Path(
            max_depth=depth, reuse=arguments.reuse, guiding="photons" if name == "spheres" else "none"
        )
        columns[name] = told(scene, camera, path, arguments)
    print(f"{_core.simd()}, ns a vertex\n")
    print(f"| part | {' | '.join(columns)} |\n|---|{'---|' * len(columns)}")
    for part in next(iter(columns.values()))[0]:
        print(f"| {part} | {' | '.join(f'{parts[part]:.1f}' for parts, _ in columns.values())} |")
    shading = [sum(ns for part, ns in parts.items() if part not in RAYS) for parts, _ in columns.values()]
    print(f"| **shading** | {' | '.join(f'**{ns:.0f}**' for ns in shading)} |")
    print(f"| vertices of a sample | {' | '.join(f'{count:.2f}' for _, count in columns.values())} |")


if __name__ == "__main__":
    main()
