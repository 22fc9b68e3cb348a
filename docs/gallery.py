"""The pictures of the gallery, and its page: ``python docs/gallery.py [NAME ...]``.

Each picture is a function, and the page shows its code. It is saved in ``docs/gallery``, and its seconds and
error in ``docs/gallery/record.json`` and on the page. Pictures that are not named are not changed.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from PIL import Image, ImageDraw

import raywright as rw

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import gallery_page  # noqa: E402

# The first lines of the page.
HEAD = """# Gallery

Each picture is made by the code below it, and `python docs/gallery.py NAME` renders it again. None was
clamped, denoised or retouched. Seconds are processor time, of all threads together, on a virtual machine of
two cores under other load. The error is the render's own estimate of relMSE, without a reference, with its
95 % interval.

All begin with

<!-- shown -->
```python
import numpy as np
import trimesh
from PIL import Image, ImageDraw

import raywright as rw
```
"""


def cornell():
    """The box of Cornell University with its measured colors, and a knot of 20,000 triangles."""
    knot = rw.scenes.torus_knot(material=rw.Diffuse((0.78, 0.55, 0.2)))
    scene, camera = rw.scenes.cornell_box(knot, 1000, 1000, emission=(18, 15, 10.5))
    image = rw.render(scene, camera, samples=64)
    image.save("cornell.jpg", exposure=0.8)
    return image


def caustic():
    """Light under a glass of water, and in a ring of gold.

    Paths from the camera hit a small lamp through glass only by chance. Here each sample has photons too,
    and MIS weights all techniques (vertex connection and merging, Georgiev et al. 2012).
    """
    up = np.array((0, 1, 0))
    glass = rw.Cylinder(-0.02 * up, 1.15 * up, 0.5, material=rw.Dielectric(1.5))
    water = rw.Cylinder(0.1 * up, 0.75 * up, 0.45, material=rw.Dielectric(1.33, priority=1))
    air = rw.Cylinder(0.74 * up, 1.2 * up, 0.45, material=rw.Dielectric(1.0, priority=2))
    gold = rw.Conductor("Au", roughness=0.1)
    ring = rw.Cylinder((1.35, 0.001, -0.45), (1.35, 0.28, -0.45), 0.55, capped=False, material=gold)
    table = rw.Disk((0, 0, 0), (0, 1, 0), 9, material=rw.Diffuse((0.5, 0.4, 0.32)))
    window = rw.Disk((-2, 4, 3), (2, -4, -3), 1.2, emission=1.5)
    lamp = rw.SpotLight((-2.6, 2.6, -1.6), (0.6, 0, 0.2), (44, 39, 32), angle=40, falloff=20)
    scene = rw.Scene([glass, water, air, ring, table, window], lights=[lamp])
    camera = rw.Camera((0.9, 2.1, 3.6), (0.6, 0.47, 0.1), fov=26, width=1000, height=520)
    image = rw.render(scene, camera, rw.Bidirectional(vertex_merging=True), samples=20)
    image.save("caustic.jpg")
    return image


def keyhole():
    """A room lit only through the hole in its door.

    Paths from the lamp and paths from the camera are connected at all surfaces (Lafortune and Willems 1993;
    Veach and Guibas 1994).
    """
    turn = np.linspace(np.radians(-60), np.radians(240), 40)
    hole = np.stack([0.11 * np.cos(turn), 1.2 + 0.11 * np.sin(turn), 0 * turn], axis=1)
    hole = np.concatenate([hole, [(-0.1, 0.9, 0), (0.1, 0.9, 0)]])
    door = [(-1.4, 0, 0), (1.4, 0, 0), (1.4, 2.2, 0), (-1.4, 2.2, 0)]
    white, wood = rw.Diffuse(0.8), rw.Diffuse((0.6, 0.42, 0.28))

    def wall(corners, material=white):
        return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=material)

    room = [
        rw.Polygon(door, [hole], material=wood),
        wall([(-1.4, 0, 0), (-1.4, 0, 3), (1.4, 0, 3), (1.4, 0, 0)], wood),
        wall([(-1.4, 2.2, 0), (1.4, 2.2, 0), (1.4, 2.2, 3), (-1.4, 2.2, 3)]),
        wall([(-1.4, 0, 0), (-1.4, 2.2, 0), (-1.4, 2.2, 3), (-1.4, 0, 3)]),
        wall([(1.4, 0, 0), (1.4, 0, 3), (1.4, 2.2, 3), (1.4, 2.2, 0)]),
        wall([(-1.4, 0, 3), (-1.4, 2.2, 3), (1.4, 2.2, 3), (1.4, 0, 3)]),
        rw.Sphere((-0.75, 0.35, 1.0), 0.35, material=rw.Plastic((0.15, 0.3, 0.5), roughness=0.2)),
        rw.Torus((0.7, 0.12, 0.8), (0, 1, 0), 0.28, 0.12, material=rw.Conductor("Cu", roughness=0.3)),
    ]
    glow = rw.Disk((-0.3, 0.95, -1), (0.3, 0.1, 1), 0.45, emission=(0.6, 0.5, 0.4))
    lamp = rw.SpotLight((0.25, 1.85, -0.75), (0, 1.1, 0), (230, 190, 140), angle=14)
    camera = rw.Camera((0.9, 1.5, 2.95), (-0.1, 0.68, 0.4), fov=54, width=1000, height=580)
    image = rw.render(rw.Scene([*room, glow], lights=[lamp]), camera, rw.Bidirectional(), samples=32)
    image.save("keyhole.jpg")
    return image


def prism():
    """White light, dispersed by a prism of flint glass.

    The index of refraction is that of the glass SF10 at each wavelength (Sellmeier's formula). Paths carry
    three wavelengths, and one of them continues after a dispersive refraction (Wilkie et al. 2014). The beam
    is as narrow as a slit: only paths from the lamp follow it.
    """
    corners = [0.6 * np.array((np.cos(turn), np.sin(turn))) for turn in np.radians((90, 210, 330))]
    ends = [(x, y, z) for z in (0.002, 0.7) for x, y in corners]
    faces = [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]
    glass = rw.Mesh(ends, faces, material=rw.Dielectric(rw.materials.glasses["SF10"]))
    table = rw.Box((-4, -4, -1), (5, 4, 0), material=rw.Diffuse(0.8))
    # It comes down through the middle of a face, which it meets under 60 degrees.
    lamp, face = (-2.86, -1.35, 0.8), (-0.26, 0.15, 0.3)
    white = 300 * rw.textures.illuminants["D65"]
    slit = rw.ProjectorLight(np.ones((110, 1)), lamp, face, up=(0, 0, 1), fov=36, intensity=white)
    window = rw.Disk((-1.5, 3.5, 3), (1.5, -3.5, -3), 1.2, emission=1.4)
    scene = rw.Scene([table, glass, window], lights=[slit])
    camera = rw.Camera((0.5, -3.3, 2.4), (0.5, -0.35, 0.1), up=(0, 0, 1), fov=36, width=1000, height=560)
    image = rw.render(scene, camera, rw.Bidirectional(), samples=96)
    image.save("prism.jpg", exposure=1)
    return image


def haze():
    """Beams of light in haze, through a window with a blind, without multiple scattering."""
    dark = rw.Diffuse(0.15)
    slats = [rw.Box((-2, y, -0.04), (2, y + 0.15, 0.04), material=dark) for y in np.arange(0.9, 3.3, 0.48)]
    wall = [
        rw.Box((-9, 0, -0.04), (-2, 9, 0.04), material=dark),
        rw.Box((2, 0, -0.04), (9, 9, 0.04), material=dark),
        rw.Box((-2, 3.3, -0.04), (2, 9, 0.04), material=dark),
        rw.Box((-2, 0, -0.04), (2, 0.9, 0.04), material=dark),
    ]
    floor = rw.Plane((0, 0, 0), (0, 1, 0), material=rw.Diffuse((0.3, 0.28, 0.25)))
    ball = rw.Sphere((0, 0.5, 3.2), 0.5, material=rw.materials.OrenNayar((0.6, 0.15, 0.1)))
    lamp = rw.PointLight((0, 4.2, -3.6), (1100, 930, 690))
    haze = rw.Homogeneous(scattering=0.07, phase=rw.HenyeyGreenstein(0.3))
    air = rw.Box((-9, -1, 0.05), (5, 8, 9), material=rw.MediumInterface(haze))
    camera = rw.Camera((-8, 1.7, 3.0), (0, 1.35, 2.6), fov=26, width=1000, height=520)
    scene = rw.Scene([*slats, *wall, floor, ball, air], lights=[lamp])
    image = rw.render(scene, camera, rw.Path(max_depth=1), samples=48, adaptive=True)
    image.save("haze.jpg")
    return image


def cloud():
    """A cloud at sunset: a grid of densities, with multiple scattering to any depth."""
    x, y, z = np.mgrid[-1:1:128j, -1:1:80j, -1:1:128j]
    rng = np.random.default_rng(4)
    # Waves of all lengths, the weaker the shorter.
    length = np.sqrt(sum(k**2 for k in np.meshgrid(*(np.fft.fftfreq(n) * n for n in x.shape), indexing="ij")))
    waves = np.fft.ifftn(np.fft.fftn(rng.normal(size=x.shape)) / (length + 3) ** 1.9).real
    body = np.full(x.shape, -1.0)
    for a, b, c, r in rng.uniform((-0.75, -0.8, -0.6, 0.15), (0.75, -0.1, 0.6, 0.4), (60, 4)):
        r *= 1.1 - abs(a)
        b = min(b, 0.3 - 1.6 * abs(a))
        body = np.maximum(body, 1 - np.sqrt((x - a) ** 2 + (y - b) ** 2 + (z - c) ** 2) / r)
    density = np.clip(6 * (body + 0.14 * waves / waves.std()), 0, 1) * np.clip(6 * (y + 0.8), 0, 1)
    bounds = [(-4, 1, -4), (4, 5, 4)]
    vapor = rw.GridMedium(density, bounds, scattering=12.0, phase=rw.HenyeyGreenstein(0.6), at="centers")
    evening = rw.SunSky((-1, 0.13, 0.1), turbidity=2.5, sun_scale=0.08, sky_scale=0.08)
    scene = rw.Scene(rw.Box(*bounds, material=rw.MediumInterface(vapor)), environment=evening)
    camera = rw.Camera((1.5, 0, 11), (0.2, 3.1, 0), fov=26, width=1000, height=520)
    image = rw.render(scene, camera, samples=32, adaptive=True)
    image.save("cloud.jpg")
    return image


def marble():
    """Translucent marble: a rough dielectric surface around a scattering medium.

    It is bright where it is thin, and where light from behind comes out. Shadow rays do not pass a rough
    dielectric, so photons are stored where the stone scatters them, and paths from the camera gather them.
    """
    within = rw.Homogeneous(absorption=(0.13, 0.44, 1.0), scattering=11)
    stone = rw.Dielectric(1.5, 0.5, interior=within)
    knot = rw.scenes.torus_knot(tube=0.3, along=600, around=48, material=stone)
    table = rw.Disk((0, 0, -0.76), (0, 0, 1), 14, material=rw.Diffuse((0.16, 0.13, 0.12)))
    lamp = rw.Disk((-2.2, 4, 3.8), (2.2, -4, -4.1), 2.7, emission=(5.5, 4.15, 2.8))
    window = rw.Disk((3.5, -3, 4.5), (-3.5, 3, -4.5), 1.8, emission=(0.9, 1.1, 1.4))
    camera = rw.Camera((0.6, -5.2, 2.5), (0.05, 0, -0.12), up=(0, 0, 1), fov=28, width=1000, height=560)
    scene = rw.Scene([knot, table, lamp, window])
    image = rw.render(scene, camera, rw.ProgressivePhotonMap(120_000), samples=72)
    image.save("marble.jpg", exposure=1)
    return image


def radiosity():
    """A room solved by radiosity, shown by its patches.

    Any camera can view the solution, with one ray per sample. The error is that of the picture; that of the
    solution is 2 %.
    """

    def quad(corner, a, b, gray, **how):
        corner, a, b = np.array([corner, a, b], float)
        corners = [corner, corner + a, corner + a + b, corner + b]
        return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(gray), **how)

    def block(low, high, gray):
        solid = trimesh.creation.box(bounds=[low, high])
        return rw.Mesh(solid.vertices, solid.faces, material=rw.Diffuse(gray))

    red, blue, wood = (0.6, 0.2, 0.12), (0.2, 0.3, 0.5), (0.5, 0.32, 0.18)
    room = [
        quad((0, 0, 0), (0, 0, 4), (5, 0, 0), 0.5),
        quad((0, 2.7, 0), (5, 0, 0), (0, 0, 4), 0.75),
        quad((0, 0, 0), (5, 0, 0), (0, 2.7, 0), 0.7),
        quad((0, 0, 0), (0, 2.7, 0), (0, 0, 4), red),
        quad((5, 0, 0), (0, 0, 4), (0, 2.7, 0), blue),
        quad((1.6, 2.69, 2.4), (1.8, 0, 0), (0, 0, 1.2), 0.5, emission=(9, 8, 6.5)),
        block((1.5, 0.7, 1.1), (3.5, 0.76, 2.3), wood),
        *(block((x, 0, z), (x + 0.1, 0.7, z + 0.1), wood) for x in (1.6, 3.3) for z in (1.2, 2.1)),
        block((0.5, 0, 0.5), (1.1, 1.8, 1.0), 0.6),
        block((2.3, 0.76, 1.5), (2.7, 1.1, 1.8), 0.7),
    ]
    scene = rw.Scene(room)
    solution = rw.radiosity(scene, patch_size=0.35, error=0.02)
    camera = rw.Camera((2.1, 1.75, 6.6), (2.5, 0.95, 1), fov=37, width=1000, height=640)
    image = rw.render(scene, camera, rw.Radiosity(solution), samples=32)
    # Edges of patches are drawn where the camera sees them, in eight pieces each.
    part = np.linspace(0, 1, 9)[:, None]
    a, b = solution.corners[:, :, None], np.roll(solution.corners, 1, axis=1)[:, :, None]
    points = a + part * (b - a)
    middle = (points[..., 1:, :] + points[..., :-1, :]) / 2
    hidden = scene.occluded(camera.position, middle - camera.position, t_max=0.998)
    turn, move = camera.extrinsics
    column, row, depth = np.moveaxis((points @ turn.T + move) @ camera.intrinsics.T, -1, 0)
    places = np.stack([column / depth, row / depth], axis=-1)
    picture = Image.fromarray(image.srgb(exposure=0.7))
    for start, end in zip(places[..., :-1, :][~hidden], places[..., 1:, :][~hidden], strict=True):
        ImageDraw.Draw(picture, "RGBA").line([*start, *end], fill=(0, 0, 0, 40))
    picture.save("radiosity.jpg", quality=90)
    return image


def photons():
    """Photons as points: each photon that the camera sees, in the color of its power."""
    scene, camera = rw.scenes.glass_spheres(1000, 1000)
    found = scene.photons(200_000)
    seen = found[~scene.occluded(camera.position, found.positions - camera.position, t_max=1 - 1e-6)]
    turn, move = camera.extrinsics
    column, row, depth = camera.intrinsics @ (turn @ seen.positions.T + move[:, None])
    place = np.rint([row / depth, column / depth]).astype(int)
    inside = (depth > 0) & ((place >= 0) & (place < 1000)).all(axis=0)
    picture = np.zeros((1000, 1000, 3))
    np.add.at(picture, tuple(place[:, inside]), seen.powers[inside])
    shown = np.clip(1.2 * picture / seen.powers.max(), 0, 1) ** (1 / 2.2)
    Image.fromarray((255 * shown).astype(np.uint8)).save("photons.jpg", quality=80)
    return seen


def shapes():
    """Curved shapes without triangles, seen through a lens with six blades."""
    blue, rust = rw.Plastic((0.1, 0.35, 0.6), roughness=0.15), rw.materials.OrenNayar((0.7, 0.3, 0.15))
    green, copper = rw.Plastic((0.2, 0.45, 0.15), roughness=0.25), rw.Conductor("Cu", roughness=0.2)
    stool = "(x - 0.5)**2 + (z - 1.4)**2 - 0.45 * (y + 0.1)**2 - 0.06"
    things = [
        rw.shapes.Implicit(stool, (-0.2, -1, 0.7), (1.2, 0.7, 2.1), material=rust),
        rw.Cylinder((-0.6, -1, -1.6), (-0.6, 1.1, -1.6), 0.7, material=blue),
        rw.Torus((2.7, -0.55, 0.3), (0.2, 1, 0.3), 0.8, 0.3, material=copper),
        rw.Cone((-2.5, -1, -0.4), (-2.5, 1.1, -0.4), 0.9, material=green),
        rw.shapes.Ellipsoid((-1.2, -0.6, 1.9), (0.7, 0.4, 0.4), material=rw.Dielectric(1.5)),
        rw.Sphere((1.9, -0.6, 2.1), 0.4, material=rw.Mirror()),
        rw.Box((3.6, -1, -3.4), (5.2, 0.9, -1.8), material=rw.Diffuse(rw.textures.Wood())),
        rw.Plane((0, -1, 0), (0, 1, 0), material=rw.Diffuse(rw.Checker(0.25, 0.5))),
        rw.Disk((-5, 8, 6), (5, -8, -6), 4, emission=3.6),
    ]
    camera = rw.ThinLens(
        (0.5, 1.5, 7.5),
        (0.4, -0.1, 0),
        fov=32,
        width=1000,
        height=620,
        aperture_radius=0.11,
        focus_point=(0, 0, 1.5),
        blades=6,
    )
    image = rw.render(rw.Scene(things, environment=(0.5, 0.6, 0.75)), camera, samples=32, adaptive=True)
    image.save("shapes.jpg")
    return image


def materials():
    """Materials and textures, each defined in a line or two."""
    lacquer = rw.Plastic((0.55, 0.12, 0.1), roughness=0.2)
    bumps = rw.BumpMap(lacquer, rw.textures.FBm(transform=4.0), scale=0.12)
    paint = rw.Principled((0.1, 0.25, 0.45), roughness=0.5, metallic=0.6, clearcoat=1, clearcoat_gloss=1)
    kinds = [
        rw.Conductor("Au", roughness=0.35),
        rw.Plastic(rw.textures.Marble(transform=1.6), roughness=0.1),
        rw.Dielectric(1.5, transmittance=(0.45, 0.9, 0.6), distance=1.0),
        paint,
        rw.Plastic(rw.textures.Wood(transform=5.0), roughness=0.25),
        rw.Conductor("Cu", roughness=rw.Checker(0.1, 0.5, 12)),
        bumps,
        rw.materials.OrenNayar((0.25, 0.4, 0.2)),
    ]
    places = [(2.3 * (i % 4) - 3.45, 0, -2.6 * (i // 4)) for i in range(8)]
    balls = [rw.Sphere(place, 1.0, material=kind) for place, kind in zip(places, kinds, strict=True)]
    floor = rw.Plane((0, -1, 0), (0, 1, 0), material=rw.Diffuse(rw.Checker(0.3, 0.4, 2)))
    lamp = rw.Disk((-6, 9, 6), (6, -9, -6), 4.5, emission=3.4)
    camera = rw.Camera((0, 4.2, 10), (0, -0.2, -1.1), fov=28, width=1000, height=560)
    image = rw.render(rw.Scene([*balls, floor, lamp], environment=0.55), camera, samples=32, adaptive=True)
    image.save("materials.jpg")
    return image


def bubble():
    """A draining soap bubble in a dark room with two windows.

    The film is black at the top, where it is 12 nm thick, and shows interference colors below.
    """
    scene, camera = rw.scenes.soap_bubble(1000, 900)
    image = rw.render(scene, camera, samples=64)
    image.save("bubble.jpg")
    return image


def oil():
    """Oil that spreads on a puddle: a film of some hundred nm, thinnest at its rim."""
    scene, camera = rw.scenes.oil_on_water(1000, 600)
    image = rw.render(scene, camera, samples=96)
    image.save("oil.jpg")
    return image


def motion():
    """Balls that fall, roll and come nearer while the shutter is open."""
    skin = rw.Plastic(rw.Checker((0.75, 0.1, 0.08), (0.85, 0.82, 0.75), 8), roughness=0.1)
    ball = rw.Sphere((0, 0, 0), 0.5, material=skin)
    placed = []
    for i, way in enumerate([(0, 0, 0), (0, 0.45, 0), (0.9, 0, 0), (0.2, 0.2, 0.9)]):
        start, end = np.eye(4), np.eye(4)
        start[:3, 3] = (1.4 * i - 2.1, 0, 0)
        end[:3, 3] = start[:3, 3] + way
        placed.append(rw.Instance(ball, start, end))
    floor = rw.Plane((0, -0.5, 0), (0, 1, 0), material=rw.Diffuse((0.24, 0.28, 0.34)))
    lamp = rw.Disk((-3, 5, 4), (3, -5, -4), 1.5, emission=22)
    camera = rw.Camera((0.3, 1.6, 6), (0.2, 0, 0), fov=28, width=1000, height=440)
    image = rw.render(rw.Scene([*placed, floor, lamp], environment=0.4), camera, samples=96)
    image.save("motion.jpg")
    return image


def forest():
    """A thousand million triangles: a hundred thousand copies of ten trees, under a physical sky."""
    trees = rw.scenes.forest().instances()
    sky = rw.SunSky((0.7, 0.5, 0.4), sun_scale=0.04, sky_scale=0.04)
    ground = rw.Plane((0, 0, 0), (0, 1, 0), material=rw.Diffuse((0.11, 0.12, 0.05)))
    camera = rw.Camera((0, 11, 60), (0, 4, 0), fov=40, width=1000, height=520)
    image = rw.render(rw.Scene([*trees, ground], environment=sky), camera, rw.Path(max_depth=3), samples=24)
    image.save("forest.jpg")
    return image


def whitted():
    """Whitted's picture of 1980: reflection and refraction as a tree of rays."""
    scene, camera = rw.scenes.whitted_spheres(1000, 640)
    tree = rw.Whitted(ambient=0.1, light_samples=2)
    image = rw.render(scene, camera, tree, samples=64, filter=rw.rendering.BlackmanHarrisFilter())
    image.save("whitted.jpg")
    return image


def heatmap():
    """Traversal cost: the number of tree nodes that each ray visits, in a picture of a city."""
    scene = rw.Scene(rw.scenes.city())
    camera = rw.Camera((-260, 190, 420), (0, 20, 0), fov=50, width=888, height=560)
    picture = rw.report.heatmap(scene, camera)
    picture.save("heatmap.png")
    return picture


PICTURES = {
    picture.__name__: picture
    for picture in (
        cornell,
        caustic,
        keyhole,
        prism,
        haze,
        cloud,
        marble,
        radiosity,
        photons,
        shapes,
        materials,
        bubble,
        oil,
        motion,
        forest,
        whitted,
        heatmap,
    )
}


def main(names: list[str]) -> None:
    """Make the pictures of these names, or all, and write the page."""
    record = gallery_page.make(names, PICTURES, HERE / "gallery", seen)
    (HERE / "gallery.md").write_text(page(record))


def seen(_name: str, made: Any, seconds: float) -> str:
    """Return the line under a picture: seconds, samples and error."""
    parts = [f"{seconds:.0f} s of one core"]
    if not isinstance(made, rw.Image):
        return "; ".join([*parts, repr(made)])
    parts += [f"{made.samples} samples a pixel", f"relMSE {made.error}"]
    if made.bias is not None:
        blur = float(np.mean(made.bias**2 / (made.rgb**2 + 0.01)))
        parts.append(f"relMSE of the blur {blur:.2g}")
    return "; ".join([*parts, *made.warnings])


def page(record: dict[str, str]) -> str:
    """Return the page, given the line under each picture."""
    return gallery_page.page(HEAD, PICTURES, record, "gallery")


if __name__ == "__main__":
    main(sys.argv[1:])
