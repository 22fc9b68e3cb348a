"""The pictures of the gallery, and its page: ``python docs/gallery.py [NAME ...]``.

Each picture is rendered and saved in ``docs/gallery``; its seconds, samples and error go into
``docs/gallery.md``. Those that are not named keep what they have.
"""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import raywright as rw

FOLDER = Path(__file__).parent / "gallery"
PAGE = Path(__file__).parent / "gallery.md"
# What was seen of each picture when it was made.
RECORD = FOLDER / "record.json"

# What `rw.render` takes.
Take = tuple[rw.Scene, rw.AnyCamera, dict[str, Any]]
GREY = rw.Diffuse(0.5)


def _cornell() -> Take:
    knot = rw.scenes.torus_knot(material=rw.Diffuse((0.78, 0.55, 0.2)))
    scene, camera = rw.scenes.cornell_box(knot, 480, 480, emission=(40.0, 33.0, 22.0))
    return scene, camera, {"samples": 256}


def _plates() -> Take:
    scene, camera = rw.scenes.veach_plates(480, 360)
    return scene, camera, {"integrator": rw.Direct(), "samples": 256, "adaptive": True}


def _glass() -> Take:
    scene, camera = rw.scenes.glass_spheres(400, 400)
    return scene, camera, {"samples": 256, "adaptive": True}


def _whitted() -> Take:
    scene, camera = rw.scenes.whitted_spheres(480, 360)
    return (
        scene,
        camera,
        {"integrator": rw.Whitted(ambient=0.1), "samples": 64, "filter": rw.BlackmanHarrisFilter()},
    )


def _gold() -> Take:
    scene, camera = rw.scenes.material_ball(rw.Conductor("Au", roughness=0.35), 360, 360)
    return scene, camera, {"samples": 256}


def _marble() -> Take:
    stone = rw.Plastic(rw.Marble(transform=2.0), roughness=0.1)
    scene, camera = rw.scenes.material_ball(stone, 360, 360)
    return scene, camera, {"samples": 256}


def _lamps() -> Take:
    scene, camera = rw.scenes.many_lights(width=480, height=320)
    return scene, camera, {"samples": 128, "adaptive": True}


def _shapes() -> Take:
    things = [
        rw.Cylinder(
            (0, -1, -0.4), (0, 0.9, -0.4), 0.8, material=rw.Plastic((0.1, 0.35, 0.6), roughness=0.15)
        ),
        rw.Torus((2.7, -0.55, 0.3), (0.2, 1, 0.3), 0.8, 0.3, material=rw.Conductor("Cu", roughness=0.2)),
        rw.Cone((-2.4, -1, -0.6), (-2.4, 1.1, -0.6), 0.9, material=rw.OrenNayar((0.7, 0.3, 0.15))),
        rw.Ellipsoid((-1.5, -0.6, 1.5), (0.7, 0.4, 0.4), material=rw.Dielectric(1.5)),
        rw.Sphere((1.4, -0.55, 1.7), 0.45, material=rw.Mirror()),
        rw.Box((3.4, -1, -3.4), (5.0, 0.9, -1.8), material=rw.Diffuse(rw.Wood())),
        rw.Plane((0, -1, 0), (0, 1, 0), material=rw.Diffuse(rw.Checker(0.25, 0.5))),
    ]
    camera = rw.ThinLens(
        (0.5, 1.6, 7),
        (0.3, -0.2, 0),
        fov=34,
        width=560,
        height=360,
        aperture_radius=0.12,
        focus_point=(0, 0, 1),
        blades=6,
    )
    scene = rw.Scene(things, environment=rw.SunSky((0.6, 0.7, 0.5), sun_scale=0.03, sky_scale=0.03))
    return scene, camera, {"samples": 128, "filter": rw.GaussianFilter()}


def _motion() -> Take:
    ball = rw.Sphere(
        (0, 0, 0),
        0.5,
        material=rw.Plastic(rw.Checker((0.75, 0.1, 0.08), (0.85, 0.82, 0.75), 8), roughness=0.1),
    )
    placed = []
    for i, way in enumerate([(0, 0, 0), (0, 0.45, 0), (0.9, 0, 0), (0.2, 0.2, 0.9)]):
        start, end = np.eye(4), np.eye(4)
        start[:3, 3] = (1.4 * i - 2.1, 0, 0)
        end[:3, 3] = start[:3, 3] + way
        placed.append(rw.Instance(ball, start, end))
    floor = rw.Plane((0, -0.5, 0), (0, 1, 0), material=GREY)
    lamp = rw.Disk((-3, 5, 4), (3, -5, -4), 1.0, emission=60.0)
    camera = rw.Camera((0.3, 1.6, 6), (0.2, 0, 0), fov=32, width=560, height=280)
    return rw.Scene([*placed, floor, lamp], environment=0.4), camera, {"samples": 128}


def _forest() -> Take:
    shapes = rw.scenes.forest().instances()
    scene = rw.Scene(shapes, environment=rw.SunSky((0.7, 0.5, 0.4), sun_scale=0.04, sky_scale=0.04))
    _, camera = rw.scenes.classics(1000, width=560, height=320)["forest"]
    return scene, camera, {"integrator": rw.Path(max_depth=3), "samples": 64}


# Each by its name: what stands over it, and what is rendered.
PICTURES: dict[str, tuple[str, Callable[[], Take]]] = {
    "cornell": (
        "The box of Cornell University by its measured colours, with a knot of 25,600 triangles in it.",
        _cornell,
    ),
    "plates": (
        "Veach's plates: four lamps of equal power seen in four plates, from sharp to dull. No "
        "single way to draw light does for all.",
        _plates,
    ),
    "glass": (
        "A ball of glass and a mirror in the box: the bright spots are light that went through "
        "and over them, found by chance alone.",
        _glass,
    ),
    "whitted": (
        "The first picture of its kind (Whitted 1980): what is seen in glass and mirrors, as a tree of rays.",
        _whitted,
    ),
    "gold": (
        "Rough gold by its measured index of refraction. What is scattered more than once between "
        "its facets is not lost.",
        _gold,
    ),
    "marble": (
        "Marble under a coat of varnish: a solid texture, made in the space of its shape.",
        _marble,
    ),
    "lamps": (
        "Two thousand lamps. A tree of them knows which matter where.",
        _lamps,
    ),
    "shapes": (
        "Curved shapes are hit as they are, not as triangles: a torus, a cone, a cylinder, an "
        "ellipsoid of glass and a mirror, behind a lens with six blades.",
        _shapes,
    ),
    "motion": (
        "Balls that fall, turn and roll while the shutter is open.",
        _motion,
    ),
    "forest": (
        "A thousand million triangles: a hundred thousand copies of ten trees, under a physical sky.",
        _forest,
    ),
}


def main(names: list[str]) -> None:
    """Render the pictures of these names, or all, and write the page."""
    unknown = set(names) - set(PICTURES)
    if unknown:
        raise SystemExit(f"no such picture: {', '.join(sorted(unknown))}; there are {', '.join(PICTURES)}")
    FOLDER.mkdir(exist_ok=True)
    record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
    for name in names or PICTURES:
        scene, camera, how = PICTURES[name][1]()
        image = rw.render(scene, camera, sampler=rw.Sobol(), progress=False, **how)
        image.save(FOLDER / f"{name}.png")
        record[name] = [
            image.seconds,
            image.samples,
            image.error.estimate,
            image.error.low,
            image.error.high,
            *image.warnings,
        ]
        print(name, image, flush=True)
        RECORD.write_text(json.dumps(record, indent=1) + "\n")
    PAGE.write_text("\n".join(page(record)))


def page(record: dict[str, Any]) -> list[str]:
    """Return the lines of the page."""
    lines = [
        "# Gallery",
        "",
        "Every picture here was made by the command that stands under it, on two cores of a virtual machine.",
        "The error is the relMSE that the render itself estimated, without a picture to compare with.",
        "",
    ]
    for name, (text, _) in PICTURES.items():
        if name in record:
            seconds, samples, error, low, high, *warnings = record[name]
            told = [
                f"{seconds:.0f} s, {samples} samples a pixel, relMSE {error:.2g} ({low:.2g} to {high:.2g})",
                *warnings,
            ]
            lines += [
                f"## {name.capitalize()}",
                "",
                text,
                "",
                f"![{name}](gallery/{name}.png)",
                "",
                f"`python docs/gallery.py {name}`: {'. '.join(told)}.",
                "",
            ]
    return lines


if __name__ == "__main__":
    main(sys.argv[1:])
