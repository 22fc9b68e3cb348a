"""Scenes with media rendered by raywright and by Mitsuba 3: error against run time.

    python benches/media.py [--scene NAME ...] [--side 128] [--samples 64] [--repeat 5]

The scenes are told in Mitsuba's format, so that both have the same: a slab under a lamp, a cloud on a grid in
the sun, a ball that dims each color by its own. Both render them in turns, on all cores, raywright as it
does by itself, Mitsuba by its ``volpath`` and, which is made for colors, its ``volpathmis``. Errors are
relMSE against a long picture of each one's own, and before anything is timed, both have to agree. Mitsuba's
long picture is that of ``volpathmis``: what ``volpath`` brings of a color that is dimmed much less than the
others has so long a tail that the mean of a million samples lies far below its own. Mitsuba
wants LLVM: name Debian's libLLVM in DRJIT_LIBLLVM_PATH.

What a picture needs is error times seconds. The last columns are how much raywright takes to the same error
of what the better of Mitsuba's does, and of what raywright does by red, green and blue: each scene is
rendered by wavelength, too, against a long picture of that.
"""

import argparse
import importlib.util
import math
import statistics
import struct
import tempfile
import time
from itertools import product
from pathlib import Path

import numpy as np
from render_peers import reference, relmse

import raywright as rw

VARIANT = "llvm_ad_rgb"
INTEGRATORS = ("volpath", "volpathmis")
# Out of sight: its material makes the scene render by wavelength.
ASIDE = rw.Sphere((0, 0, -1e4), 1e-3, material=rw.Diffuse(rw.Spectrum([360, 830], [0.5, 0.5])))


def rgb(*value):
    """Return a color."""
    return {"type": "rgb", "value": list(value)}


def placed(scale, move):
    """Return the matrix that scales along each axis and then moves."""
    matrix = np.diag([*scale, 1.0])
    matrix[:3, 3] = move
    return matrix


def seen_from(origin, target, side, fov=40.0):
    """Return a sensor, with y up."""
    origin, target = np.array(origin, float), np.array(target, float)
    ahead = (target - origin) / np.linalg.norm(target - origin)
    left = np.cross((0, 1, 0), ahead)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3] = np.stack([left, np.cross(ahead, left), ahead, origin], axis=1)
    film = {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}}
    film |= {"pixel_format": "rgb", "component_format": "float32"}
    return {"type": "perspective", "fov": fov, "to_world": matrix, "film": film}


FLOOR = {
    "type": "rectangle",
    "to_world": np.array([[4.0, 0, 0, 0], [0, 0, 1, 0], [0, -4, 0, 0], [0, 0, 0, 1]]),
    "bsdf": {"type": "diffuse", "reflectance": rgb(0.5, 0.5, 0.5)},
}
NULL = {"type": "null"}


def slab(side, folder):
    """Return a layer of haze on a floor, under a lamp."""
    haze = {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.9, "phase": {"type": "hg", "g": 0.5}}
    lamp = np.array([[0.7, 0, 0, 0], [0, 0, -1, 3], [0, 0.7, 0, 0], [0, 0, 0, 1]])
    return {
        "type": "scene",
        "sensor": seen_from((0, 2.6, 5.5), (0, 0.6, 0), side),
        "floor": FLOOR,
        "lamp": {
            "type": "rectangle",
            "to_world": lamp,
            "emitter": {"type": "area", "radiance": rgb(12.0, 11.0, 9.0)},
        },
        "haze": {
            "type": "cube",
            "to_world": placed((2, 0.5, 2), (0, 0.55, 0)),
            "bsdf": NULL,
            "interior": haze,
        },
    }


def cloud(side, folder, size=64):
    """Return a cloud on a grid in the sun, under a sky."""
    x, y, z = (np.indices((size,) * 3) + 0.5) / size * 2 - 1
    waves = np.sin(7 * x + 2 * np.sin(5 * y)) * np.cos(6 * y + 1) * np.sin(5 * z + 2 * np.cos(4 * x))
    density = np.clip(1.2 - 1.4 * np.sqrt(x**2 + 2 * y**2 + z**2) + 0.8 * waves, 0, None).astype("<f4")
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, size, size, size, 1, 0, 0, 0, 1, 1, 1)
    (folder / "cloud.vol").write_bytes(header + density.transpose(2, 1, 0).tobytes())
    place = placed((3, 2, 3), (-1.5, 0.4, -1.5))
    vapor = {
        "type": "heterogeneous",
        "albedo": 0.98,
        "scale": 8.0,
        "sigma_t": {"type": "gridvolume", "filename": "cloud.vol", "to_world": place},
        "phase": {"type": "hg", "g": 0.6},
    }
    return {
        "type": "scene",
        "sensor": seen_from((0, 2.0, 6.5), (0, 1.2, 0), side),
        "floor": FLOOR,
        "sky": {"type": "constant", "radiance": rgb(0.3, 0.4, 0.6)},
        "sun": {"type": "directional", "direction": [-0.5, -1, -0.4], "irradiance": rgb(5.0, 4.6, 4.0)},
        "cloud": {
            "type": "cube",
            "to_world": placed((1.5, 1, 1.5), (0, 1.4, 0)),
            "bsdf": NULL,
            "interior": vapor,
        },
    }


def ball(side, folder):
    """Return a ball that dims blue sixteen times as much as red, under a sky."""
    wax = {
        "type": "homogeneous",
        "sigma_t": rgb(0.0625, 0.25, 1.0),
        "albedo": rgb(0.95, 0.9, 0.8),
        "scale": 16.0,
    }
    return {
        "type": "scene",
        "sensor": seen_from((0, 2.0, 5.0), (0, 0.9, 0), side),
        "floor": FLOOR,
        "sky": {"type": "constant", "radiance": rgb(0.5, 0.5, 0.5)},
        "sun": {"type": "directional", "direction": [-0.5, -1, -0.4], "irradiance": rgb(3.0, 3.0, 3.0)},
        "ball": {"type": "sphere", "center": [0, 1, 0], "radius": 0.95, "bsdf": NULL, "interior": wax},
    }


SCENES = {"slab": slab, "cloud": cloud, "ball": ball}


class Raywright:
    """raywright on all cores, as it does by itself."""

    def __init__(self, told, folder, by_wavelength=False):
        shot = rw.from_mitsuba(told, folder=folder)
        self.name = "raywright" + " by wavelength" * by_wavelength
        self.scene, self.camera = shot.scene, shot.camera
        if by_wavelength:
            self.scene = self.scene.replace(shapes=[*self.scene.shapes, ASIDE])

    def render(self, samples, seed):
        """Return a picture and the seconds that it took."""
        start = time.perf_counter()
        image = rw.render(self.scene, self.camera, rw.Path(), samples=samples, seed=seed, progress=False)
        return image.rgb.astype(np.float64), time.perf_counter() - start


class Mitsuba:
    """Mitsuba on all cores, by one of its integrators."""

    def __init__(self, told, folder, integrator):
        import mitsuba

        if mitsuba.variant() != VARIANT:
            mitsuba.set_variant(VARIANT)
        self.mi, self.name = mitsuba, f"mitsuba {integrator}"
        self.scene = mitsuba.load_dict(self._own(told, folder))
        self.integrator = mitsuba.load_dict({"type": integrator, "max_depth": -1})

    def _own(self, told, folder):
        """Return the scene with Mitsuba's own objects for transforms, and whole paths."""
        result = {}
        for key, value in told.items():
            if isinstance(value, dict):
                value = self._own(value, folder)
            elif key == "to_world":
                value = self.mi.ScalarTransform4f(value)
            elif key == "filename":
                value = str(folder / value)
            result[key] = value
        return result

    def render(self, samples, seed):
        """Return a picture and the seconds that it took."""
        start = time.perf_counter()
        image = self.mi.render(self.scene, integrator=self.integrator, seed=seed, spp=samples)
        picture = np.array(image)
        return picture.astype(np.float64), time.perf_counter() - start


def contest(name, arguments, folder):
    """Render a scene by all in turns; returns lines of a table."""
    told = SCENES[name](arguments.side, folder)
    ours = [Raywright(told, folder), Raywright(told, folder, by_wavelength=True)]
    with_mitsuba = importlib.util.find_spec("mitsuba") is not None
    others = [Mitsuba(told, folder, integrator) for integrator in INTEGRATORS] if with_mitsuba else []
    truths, means = {}, {}
    # Mitsuba's two have the same expectation, but only the second finds all light.
    for engine in (*ours, *others[1:]):
        truths[engine.name], *means[engine.name] = reference(engine, arguments.reference, 8)
    truths |= {other.name: truths[others[1].name] for other in others}
    if others:
        # Blocks in the tails of t with 7 degrees of freedom: beyond 8 standard errors, one in 10,000.
        (mine, my_errors), (theirs, their_errors) = means[ours[0].name], means[others[1].name]
        off = np.abs(mine - theirs) / np.maximum(np.hypot(my_errors, their_errors), 1e-6)
        print(
            f"{name}: the pictures differ by {np.median(off):.2f} standard errors in the middle, "
            f"{off.max():.1f} at most"
        )
    records = {engine.name: ([], []) for engine in (*ours, *others)}
    for engine in (*ours, *others):
        engine.render(arguments.samples, 0)
    for turn, engine in product(range(arguments.repeat), (*ours, *others)):
        picture, seconds = engine.render(arguments.samples, turn + 1)
        # Subtracts the noise of the reference, which is independent of the other picture's.
        truth, noise = truths[engine.name]
        records[engine.name][0].append(seconds)
        records[engine.name][1].append(relmse(picture, truth) - noise)
    needs = {
        engine: (statistics.median(seconds), statistics.mean(wrong))
        for engine, (seconds, wrong) in records.items()
    }
    best = min((math.prod(needs[other.name]) for other in others), default=math.nan)
    plain = math.prod(needs[ours[0].name])
    for engine, (seconds, wrong) in needs.items():
        ratios = [f"{seconds * wrong / by:.2f}" if by == by else "-" for by in (best, plain)]
        yield f"| {name} | {engine} | {seconds:.3f} | {wrong:.2e} | {' | '.join(ratios)} |"


def main():
    """Render and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--scene", action="append", choices=list(SCENES), help="which; all if not given")
    parser.add_argument("--side", type=int, default=128, help="pixels on a side")
    parser.add_argument("--samples", type=int, default=64, help="of each pixel")
    parser.add_argument(
        "--reference", type=int, default=1024, help="samples of each of the eight long pictures"
    )
    parser.add_argument("--repeat", type=int, default=5, help="turns")
    arguments = parser.parse_args()
    table = [
        "| scene | engine | seconds | relMSE | seconds by relMSE, of the better of Mitsuba | of raywright |",
        "|---|---|---|---|---|---|",
    ]
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.scene or SCENES:
            table += contest(name, arguments, Path(folder))
    print("\n" + "\n".join(table))


if __name__ == "__main__":
    main()
