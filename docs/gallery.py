"""The pictures of the gallery, and its page: ``python docs/gallery.py [NAME ...]``.

Each picture is a function whose lines make it, and the page shows them. It is saved in ``docs/gallery``; its
time, samples and error go into ``docs/gallery.md``. Those that are not named keep what they have.
"""

import inspect
import json
import re
import sys
import textwrap
import time
from pathlib import Path
from typing import Any

import numpy as np

import raywright as rw

FOLDER = Path(__file__).parent / "gallery"
PAGE = Path(__file__).parent / "gallery.md"
# What was seen of each picture when it was made.
RECORD = FOLDER / "record.json"


def cornell() -> rw.Image:
    """The box of Cornell University by its measured colours, with a knot of 25,600 triangles in it."""
    knot = rw.scenes.torus_knot(material=rw.Diffuse((0.78, 0.55, 0.2)))
    scene, camera = rw.scenes.cornell_box(knot, 1000, 1000, emission=(40, 33, 22))
    return rw.render(scene, camera, samples=128)


def caustic() -> rw.Image:
    """Light under a glass of water: photons find what paths from the eye meet by chance alone."""
    turn = np.linspace(0, 2 * np.pi, 128, endpoint=False)

    def turned(profile, centre=0.0, **how):
        """Sweep a line of radii and heights about an upright axis."""
        radius, height = np.array(profile, float).T
        x, z = centre + np.outer(radius, np.cos(turn)), np.outer(radius, np.sin(turn))
        corners = np.stack([x, np.broadcast_to(height[:, None], x.shape), z], -1).reshape(-1, 3)
        row, column = np.mgrid[: len(profile) - 1, : len(turn)]
        a, b = row * len(turn) + column, row * len(turn) + (column + 1) % len(turn)
        quads = np.stack([a, a + len(turn), b + len(turn), b], -1).reshape(-1, 4)
        return rw.Mesh(corners, np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]), **how)

    bend = np.linspace(np.pi / 2, 0, 16)
    outside = [(0, 0.001), (0.36, 0.001), (0.4, 0.04), (0.46, 0.9), (0.45, 1.0)]
    inside = np.stack([0.41 * np.sin(bend), 0.62 - 0.06 * np.cos(bend)], -1)
    glass = turned([*outside, (0.43, 1.0), *inside], material=rw.Dielectric(1.5))
    band = [(0.5, 0.001), (0.5, 0.3), (0.53, 0.3), (0.53, 0.001)]
    ring = turned(band, 1.35, material=rw.Conductor("gold", roughness=0.1))
    table = rw.Disk((0, 0, 0), (0, 1, 0), 8, material=rw.Diffuse((0.55, 0.42, 0.3)))
    lamp = rw.Sphere((-2.4, 2.2, -1.2), 0.12, emission=(900, 800, 650))
    camera = rw.Camera((0.9, 1.8, 2.7), (0.5, 0.3, 0.2), fov=36, width=1000, height=800)
    scene = rw.Scene([glass, ring, table, lamp], environment=0.02)
    return rw.render(scene, camera, rw.ProgressivePhotonMap(photons=400_000), samples=256)


def photons() -> np.ndarray:
    """Where photons fall that a ball of glass or a mirror has turned, of 2,000,000 paths of light.

    Each that the camera sees is a point of its colour.
    """
    scene, camera = rw.scenes.glass_spheres(1000, 1000)
    found = scene.photons(2_000_000)
    found = found[found.sharp > 0]
    turn, move = camera.extrinsics
    eye = -turn.T @ move
    seen = found[
        ~scene.occluded(np.broadcast_to(eye, found.positions.shape), found.positions - eye, t_max=1 - 1e-6)
    ]
    column, row, depth = camera.intrinsics @ (turn @ seen.positions.T + move[:, None])
    x, y = (column / depth).astype(int), (row / depth).astype(int)
    inside = (depth > 0) & (x >= 0) & (x < 1000) & (y >= 0) & (y < 1000)
    picture = np.zeros((1000, 1000, 3))
    np.add.at(picture, (y[inside], x[inside]), seen.powers[inside])
    return 1 - np.exp(-picture / np.percentile(seen.powers, 99))


def keyhole() -> rw.Image:
    """A room that has no light but what comes through a hole of 12 by 12 cm from the next."""
    white, warm = rw.Diffuse(0.7), rw.Diffuse((0.7, 0.45, 0.25))

    def wall(x, y, z, material=white, **how):
        """Stand across the axis that has one number instead of two."""
        ends = [np.atleast_1d(e).astype(float) for e in (x, y, z)]
        axis = next(i for i in range(3) if len(ends[i]) == 1)
        u, v = (axis + 1) % 3, (axis + 2) % 3
        corners = np.empty((4, 3))
        corners[:, axis], corners[:, u], corners[:, v] = (
            ends[axis],
            ends[u][[0, 1, 1, 0]],
            ends[v][[0, 0, 1, 1]],
        )
        return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=material, **how)

    shell = [wall(x, (0, 4), (0, 3)) for x in (0, 7)]
    shell += [wall((0, 7), y, (0, 3), warm if y else white) for y in (0, 4)]
    shell += [wall((0, 7), (0, 4), z) for z in (0, 3)]
    hole = [((0, 1.94), (0, 3)), ((2.06, 4), (0, 3)), ((1.94, 2.06), (0, 1.34)), ((1.94, 2.06), (1.46, 3))]
    shell += [wall(4, y, z) for y, z in hole]
    lamp = wall((5.5, 6.2), (1.6, 2.4), 2.9, rw.Diffuse(0), emission=rw.Emission(6000, side="both"))
    ball = rw.Sphere((2.1, 2.5, 0.5), 0.5, material=rw.Plastic((0.15, 0.3, 0.5), roughness=0.2))
    camera = rw.Camera((0.4, 0.4, 1.7), (2.8, 2.8, 1.0), up=(0, 0, 1), fov=75, width=1000, height=800)
    return rw.render(rw.Scene([*shell, lamp, ball]), camera, rw.Bidirectional(), samples=256)


def radiosity() -> rw.Image:
    """The box again, solved for once: patches of one value each, which any camera can look at."""
    scene, camera = rw.scenes.cornell_box(width=1000, height=1000)
    solution = rw.radiosity(scene, patch_size=40, error=0.01, progress=False)
    return rw.render(scene, camera, rw.Radiosity(solution), samples=16)


def plates() -> rw.Image:
    """Veach's plates: four lamps of equal power seen in four plates, from sharp to dull.

    No single way to draw light does for all.
    """
    scene, camera = rw.scenes.veach_plates(1000, 750)
    return rw.render(scene, camera, rw.Direct(), samples=128, adaptive=True)


def glass() -> rw.Image:
    """A ball of glass and a mirror in the box: the bright spots are light that went through and over them."""
    scene, camera = rw.scenes.glass_spheres(1000, 1000)
    return rw.render(scene, camera, samples=256)


def whitted() -> rw.Image:
    """The first picture of its kind (Whitted 1980): what is seen in glass and mirrors, as a tree of rays."""
    scene, camera = rw.scenes.whitted_spheres(1000, 750)
    return rw.render(scene, camera, rw.Whitted(ambient=0.1), samples=64, filter=rw.BlackmanHarrisFilter())


def gold() -> rw.Image:
    """Rough gold by its measured index of refraction; what is scattered twice between facets is not lost."""
    scene, camera = rw.scenes.material_ball(rw.Conductor("Au", roughness=0.35), 1000, 1000)
    return rw.render(scene, camera, samples=128)


def marble() -> rw.Image:
    """Marble under a coat of varnish: a solid texture, made in the space of its shape."""
    stone = rw.Plastic(rw.Marble(transform=2.0), roughness=0.1)
    scene, camera = rw.scenes.material_ball(stone, 1000, 1000)
    return rw.render(scene, camera, samples=128)


def lamps() -> rw.Image:
    """Two thousand lamps. A tree of them knows which matter where."""
    scene, camera = rw.scenes.many_lights(width=1000, height=667)
    return rw.render(scene, camera, samples=64, adaptive=True)


def shapes() -> rw.Image:
    """Curved shapes are hit as they are, not as triangles, here behind a lens with six blades."""
    blue, rust = rw.Plastic((0.1, 0.35, 0.6), roughness=0.15), rw.OrenNayar((0.7, 0.3, 0.15))
    copper, wood = rw.Conductor("Cu", roughness=0.2), rw.Diffuse(rw.Wood())
    things = [
        rw.Cylinder((0, -1, -0.4), (0, 0.9, -0.4), 0.8, material=blue),
        rw.Torus((2.7, -0.55, 0.3), (0.2, 1, 0.3), 0.8, 0.3, material=copper),
        rw.Cone((-2.4, -1, -0.6), (-2.4, 1.1, -0.6), 0.9, material=rust),
        rw.Ellipsoid((-1.5, -0.6, 1.5), (0.7, 0.4, 0.4), material=rw.Dielectric(1.5)),
        rw.Sphere((1.4, -0.55, 1.7), 0.45, material=rw.Mirror()),
        rw.Box((3.4, -1, -3.4), (5.0, 0.9, -1.8), material=wood),
        rw.Plane((0, -1, 0), (0, 1, 0), material=rw.Diffuse(rw.Checker(0.25, 0.5))),
    ]
    camera = rw.ThinLens(
        (0.5, 1.6, 7),
        (0.3, -0.2, 0),
        fov=34,
        width=1000,
        height=640,
        aperture_radius=0.12,
        focus_point=(0, 0, 1),
        blades=6,
    )
    scene = rw.Scene(things, environment=rw.SunSky((0.6, 0.7, 0.5), sun_scale=0.03, sky_scale=0.03))
    return rw.render(scene, camera, samples=256, filter=rw.GaussianFilter())


def motion() -> rw.Image:
    """Balls that fall, turn and roll while the shutter is open."""
    skin = rw.Plastic(rw.Checker((0.75, 0.1, 0.08), (0.85, 0.82, 0.75), 8), roughness=0.1)
    ball = rw.Sphere((0, 0, 0), 0.5, material=skin)
    placed = []
    for i, way in enumerate([(0, 0, 0), (0, 0.45, 0), (0.9, 0, 0), (0.2, 0.2, 0.9)]):
        start, end = np.eye(4), np.eye(4)
        start[:3, 3] = (1.4 * i - 2.1, 0, 0)
        end[:3, 3] = start[:3, 3] + way
        placed.append(rw.Instance(ball, start, end))
    floor = rw.Plane((0, -0.5, 0), (0, 1, 0), material=rw.Diffuse(0.5))
    lamp = rw.Disk((-3, 5, 4), (3, -5, -4), 1.0, emission=60)
    camera = rw.Camera((0.3, 1.6, 6), (0.2, 0, 0), fov=32, width=1000, height=500)
    return rw.render(rw.Scene([*placed, floor, lamp], environment=0.4), camera, samples=128)


def forest() -> rw.Image:
    """A thousand million triangles: a hundred thousand copies of ten trees, under a physical sky."""
    sky = rw.SunSky((0.7, 0.5, 0.4), sun_scale=0.04, sky_scale=0.04)
    scene = rw.Scene(rw.scenes.forest().instances(), environment=sky)
    _, camera = rw.scenes.classics(1000, width=1000, height=570)["forest"]
    return rw.render(scene, camera, rw.Path(max_depth=3), samples=64)


def cloud() -> rw.Image:
    """A cloud at sunset: a grid of densities, which scatters what light comes, as often as it takes."""
    x, y, z = np.mgrid[-1:1:96j, -1:1:64j, -1:1:96j]
    height = (y + 0.85) / 1.85
    puffs = np.random.default_rng(4).uniform((-0.65, 0.0, -0.65, 0.16), (0.65, 0.35, 0.65, 0.4), (40, 4))
    puffs = puffs[np.hypot(puffs[:, 0], puffs[:, 2]) < 0.6]
    body = np.full(x.shape, -1.0)
    for a, b, c, r in puffs:
        body = np.maximum(body, 1 - np.sqrt((x - a) ** 2 + ((y + 0.5 - b) * 1.3) ** 2 + (z - c) ** 2) / r)
    frill = np.zeros(x.shape)
    for octave in range(4):
        k = 5 * 2**octave
        frill += np.sin(k * x + 1.3 * octave + 2 * np.sin(k * z)) * np.sin(k * y + np.cos(k * x)) / 2**octave
    density = np.clip(2.5 * (body + 0.22 * frill), 0, 1) * np.clip(4 * height, 0, 1)
    bounds = [(-3, 1, -3), (3, 4, 3)]
    vapour = rw.GridMedium(density, bounds, scattering=14.0, phase=rw.HenyeyGreenstein(0.7), at="centres")
    evening = rw.SunSky((-1, 0.12, 0.35), sun_scale=0.06, sky_scale=0.06)
    ground = rw.Plane((0, 0, 0), (0, 1, 0), material=rw.Diffuse((0.25, 0.22, 0.16)))
    scene = rw.Scene([rw.Box(*bounds, material=rw.Boundary(vapour)), ground], environment=evening)
    camera = rw.Camera((1.5, 0.8, 9.5), (0, 2.2, 0), fov=38, width=1000, height=640)
    return rw.render(scene, camera, samples=256)


def haze() -> rw.Image:
    """Beams of light in haze, from a lamp behind a wall with slits."""
    bars = [rw.Box((-2 + 0.5 * i, 0, -0.05), (-1.72 + 0.5 * i, 3, 0.05)) for i in range(9)]
    floor = rw.Plane((0, 0, 0), (0, 1, 0), material=rw.Diffuse(0.4))
    ball = rw.Sphere((0.5, 0.55, 1.6), 0.55, material=rw.Plastic((0.6, 0.15, 0.1), roughness=0.2))
    lamp = rw.PointLight((0.3, 2.2, -2.5), (260, 220, 170))
    sides = [rw.Box((-9, 0, -0.05), (-2, 3, 0.05)), rw.Box((2.28, 0, -0.05), (9, 3, 0.05))]
    top = rw.Box((-9, 3, -0.05), (9, 9, 0.05))
    haze = rw.Homogeneous(absorption=0.005, scattering=0.07, phase=rw.HenyeyGreenstein(0.5))
    scene = rw.Scene([*bars, *sides, top, floor, ball], lights=[lamp], medium=haze)
    camera = rw.Camera((-3.4, 1.7, 6.2), (0.2, 1.0, 0.6), fov=40, width=1000, height=640)
    return rw.render(scene, camera, samples=256)


PICTURES = {
    each.__name__: each
    for each in (
        cornell,
        caustic,
        photons,
        keyhole,
        cloud,
        haze,
        radiosity,
        plates,
        glass,
        whitted,
        gold,
        marble,
        lamps,
        shapes,
        motion,
        forest,
    )
}


def main(names: list[str]) -> None:
    """Render the pictures of these names, or all, and write the page."""
    unknown = set(names) - set(PICTURES)
    if unknown:
        raise SystemExit(f"no such picture: {', '.join(sorted(unknown))}; there are {', '.join(PICTURES)}")
    FOLDER.mkdir(exist_ok=True)
    for name in names or PICTURES:
        start = time.process_time()
        picture = PICTURES[name]()
        told = [f"{time.process_time() - start:.0f} s of one core"]
        if isinstance(picture, rw.Image):
            picture.save(FOLDER / f"{name}.jpg")
            told += [f"{picture.samples} samples a pixel", f"relMSE {picture.error}", *picture.warnings]
        else:
            _save(picture, FOLDER / f"{name}.jpg")
        print(name, "; ".join(told), flush=True)
        record = json.loads(RECORD.read_text()) if RECORD.exists() else {}
        RECORD.write_text(json.dumps(record | {name: told}, indent=1) + "\n")
    PAGE.write_text("\n".join(page(json.loads(RECORD.read_text()))))


def _save(picture: np.ndarray, path: Path) -> None:
    """Save what is from 0 to 1 and no light, but a drawing."""
    from PIL import Image

    Image.fromarray(np.round(picture * 255).astype(np.uint8)).save(path, quality=92)


def page(record: dict[str, Any]) -> list[str]:
    """Return the lines of the page."""
    lines = [
        "# Gallery",
        "",
        "Every picture was made by the lines under it, and `python docs/gallery.py NAME` makes it again.",
        "The time is the processor's, all threads together. The error is the relMSE that the render itself",
        "estimated, without a picture to compare with, and its interval of 95 %.",
        "",
        "<!-- shown -->",
        "```python",
        "import numpy as np",
        "import raywright as rw",
        "```",
        "",
    ]
    for name, picture in PICTURES.items():
        if name in record:
            body = textwrap.dedent(inspect.getsource(picture).split('"""', 2)[2].strip("\n"))
            lines += [
                f"## {name.capitalize()}",
                "",
                inspect.getdoc(picture),
                "",
                f"![{name}](gallery/{name}.jpg)",
                "",
                f"{'; '.join(record[name])}.",
                "",
                "<!-- shown -->",
                "```python",
                *re.sub("^return", "picture =", body, flags=re.MULTILINE).splitlines(),
                "```",
                "",
            ]
    return lines


if __name__ == "__main__":
    main(sys.argv[1:])
