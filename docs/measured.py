"""Ten pictures of measurements, and their page: ``python docs/measured.py [NAME ...]``.

Each picture is a function, and ``docs/measured.md`` shows its lines. Files in ``docs/measured`` have at most
40 kB each. Needs matplotlib and manifold3d.
"""

import inspect
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
import trimesh
from PIL import Image

import raywright as rw

matplotlib.use("Agg")
HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import gallery_page  # noqa: E402

LARGEST = 40_000


def city(count: int = 9) -> rw.Scene:
    """Return houses of different heights along a grid of streets, on a ground, y up."""
    rng = np.random.default_rng(3)
    shapes = [rw.Box((-20, -1, -20), (15 * count + 15, 0, 15 * count + 15), name="ground")]
    for x, z in np.argwhere(np.ones((count, count))) * 15.0:
        wide, deep, high = rng.uniform(7, 11), rng.uniform(7, 11), 4 + rng.gamma(2, 4)
        shapes.append(rw.Box((x, 0, z), (x + wide, high, z + deep)))
    return rw.Scene(shapes)


def painted(hits: rw.query.Hits, values: Any, cmap: str, label: str, **limits: float) -> Any:
    """Return a figure of values on the surfaces that a camera sees, shaded a little by their normals."""
    figure, axes = plt.subplots(figsize=(8, 4.5), dpi=100, layout="constrained")
    shown = axes.imshow(values, cmap=cmap, **limits)
    light = 0.7 + 0.3 * np.abs(hits.normal @ (0.36, 0.8, 0.48))
    colors = shown.cmap(shown.norm(values))[..., :3] * light[..., None]
    axes.clear()
    axes.imshow(np.where(hits.hit[..., None], colors, 1.0))
    axes.set_axis_off()
    figure.colorbar(shown, ax=axes, label=label, shrink=0.8)
    return figure


def sky():
    """The sky view factor of ground, walls and roofs, at every point that the camera sees."""
    scene = city()
    camera = rw.Camera((165, 95, 190), (62, 4, 72), fov=32, width=800, height=480)
    hits = scene.first_hits(camera)
    found = rw.measure.sky_view(scene, hits, up=(0, 1, 0), rays=64)
    return painted(hits, found.value, "viridis", "sky view factor", vmin=0, vmax=1)


def sun():
    """Hours of sun on the 21st of March at 47 degrees north."""
    scene = city()
    camera = rw.Camera((165, 95, 190), (62, 4, 72), fov=32, width=800, height=480)
    hits = scene.first_hits(camera)
    times = np.arange("2025-03-21T05:00", "2025-03-21T18:30", 15, dtype="datetime64[m]")
    found = rw.measure.solar_exposure(scene, hits, times=times, latitude=47.4, longitude=8.5, weights=0.25)
    return painted(hits, found.sunlit, "inferno", "hours of sun", vmin=0, vmax=12)


def viewshed():
    """The land that is visible from a tower, by lines of sight to every point in the picture."""
    x, z = np.meshgrid(np.linspace(-3000, 3000, 401), np.linspace(-3000, 3000, 401))
    y = 160 * np.sin(x / 500) * np.cos(z / 650) + 90 * np.sin((x + 2 * z) / 400)
    index = np.arange(401 * 401).reshape(401, 401)
    quads = np.stack([index[:-1, :-1], index[1:, :-1], index[1:, 1:], index[:-1, 1:]], axis=-1)
    land = rw.Scene((np.stack([x, y, z], axis=-1).reshape(-1, 3), quads.reshape(-1, 4)))
    foot = land.intersect((650, 1000, 250), (0, -1, 0)).position
    eye = foot + np.array((0, 40, 0))
    hits = land.first_hits(rw.Camera((0, 4200, 6200), (0, -250, 300), fov=40, width=800, height=480))
    view = rw.measure.line_of_sight(land, eye, np.where(hits.hit[..., None], hits.position, foot))
    away = np.linalg.norm(hits.position - foot, axis=-1) / 1000
    figure = painted(
        hits, np.where(view.visible, away, np.nan), "plasma", "visible from a tower, km away", vmin=0
    )
    hidden = np.where(hits.hit & ~view.visible, 0.5, np.nan)
    figure.axes[0].imshow(hidden, cmap="gray", vmin=0, vmax=1, alpha=0.7)
    return figure


def lidar():
    """A scan from a roof: 96 beams, with noise and losses, seen from above."""
    scanner = rw.measure.SpinningLidar(
        elevations=np.linspace(-65, 0, 96), columns=1500, position=(70, 34, 66), max_range=90
    )
    scan = rw.measure.lidar(city(), scanner, range_sigma=0.02, dropout=0.05, returns="first")
    order = scan.position[:, 1].argsort()
    figure, axes = plt.subplots(figsize=(8, 4.8), dpi=100, layout="constrained")
    x, y, z = scan.position[order].T
    shown = axes.scatter(x, -z, c=y, s=0.4, cmap="turbo", linewidths=0)
    axes.plot(70, -66, "k^")
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.colorbar(shown, label="height of returns, m")
    return figure


def thickness():
    """Wall thickness of a bracket, as the diameter of the largest ball inside at every point."""
    block = trimesh.creation.box((8, 2, 5))
    pocket = trimesh.creation.box(
        (4.6, 2, 3.4), transform=trimesh.transformations.translation_matrix((-1, 0.5, 0))
    )
    drill = trimesh.creation.cylinder(0.8, 9, sections=128)
    drill.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
    drill.apply_translation((2.75, 0, 0.9))
    part = rw.Scene(trimesh.boolean.difference([block, pocket, drill], engine="manifold"))
    hits = part.first_hits(rw.Camera((6, 9, 11), (0.2, 0, 0.2), fov=36, width=800, height=480))
    found = rw.measure.thickness(part, hits, method="sphere")
    return painted(hits, np.where(hits.hit, found, 0), "RdYlGn", "wall thickness, mm", vmin=0, vmax=1.6)


def distance():
    """The signed distance field of a knot, in a plane through it."""
    knot = rw.Scene(rw.scenes.torus_knot())
    x, y = np.meshgrid(np.linspace(-3.2, 3.2, 640), np.linspace(-1.9, 1.9, 380))
    field = knot.signed_distance(np.stack([x, y, 0 * x + 0.15], axis=-1))
    figure, axes = plt.subplots(figsize=(8, 4.5), dpi=100, layout="constrained")
    shown = axes.contourf(x, y, field, levels=np.arange(-0.4, 2.01, 0.1), cmap="RdBu")
    axes.contour(x, y, field, levels=[0], colors="k")
    axes.set_aspect("equal")
    axes.set_axis_off()
    figure.colorbar(shown, label="signed distance", shrink=0.8)
    return figure


def xray():
    """An X-ray picture of a suitcase: lengths within each object, light and dense ones in two colors."""
    case = {
        "shell": (rw.Box((-4, -2.4, -1), (4, 2.4, 1)), 1.0, 0.0),
        "inside": (rw.Box((-3.9, -2.3, -0.9), (3.9, 2.3, 0.9)), -1.0, 0.0),
        "bottle": (rw.Cylinder((-2.9, -1.9, 0), (-2.9, 1.2, 0), 0.6), 0.25, 0.0),
        "wheel": (rw.Torus((1.9, 0.9, 0), (0, 0.3, 1), 1.0, 0.22), 0.0, 1.0),
        "knot": (rw.scenes.torus_knot().transformed(np.diag((0.8, 0.8, 0.5, 1))), 0.0, 0.5),
        "ball": (rw.Sphere((2.4, -1.4, 0), 0.7), 0.5, 0.2),
    }
    scene = rw.Scene({name: shape for name, (shape, _, _) in case.items()})
    x, y = np.meshgrid(np.linspace(-4.3, 4.3, 800), np.linspace(2.6, -2.6, 480))
    light, dense = np.zeros(x.size), np.zeros(x.size)
    for name, (_, organic, metal) in case.items():
        every = scene.intersect_all(np.stack([x, y, 0 * x + 5], axis=-1), (0, 0, -1.0), shapes=name)
        number = np.arange(len(every.t)) - every.ray_splits[every.ray]
        length = np.bincount(every.ray, np.where(number % 2, every.t, -every.t), minlength=x.size)
        light, dense = light + organic * length, dense + metal * length
    rgb = np.exp(-light[:, None] * (0.25, 0.8, 1.8) - dense[:, None] * (2.2, 1.1, 0.5))
    return Image.fromarray((255 * rgb.reshape(*x.shape, 3)).astype(np.uint8))


def slices():
    """Outlines of a knot in 44 layers, as for a printer."""
    knot = rw.scenes.torus_knot()
    low, high = knot.bounds[:, 2]
    heights = np.linspace(low, high, 46)[1:-1]
    cuts = rw.measure.cross_section(knot, heights[:, None] * (0, 0, 1), (0, 0, 1))
    figure, axes = plt.subplots(figsize=(8, 4.5), dpi=100, layout="constrained")
    for cut, height in zip(cuts, heights, strict=True):
        color = plt.get_cmap("viridis")((height - low) / (high - low))
        for line in cut.lines:
            axes.plot(line[:, 0], 0.5 * line[:, 1] + 1.6 * height, color=color, linewidth=0.8)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return figure


def daylight():
    """The daylight factor of a room with one window, on all its surfaces."""
    matt = rw.Diffuse(0.6)
    box = [(x, y, z) for y in (0, 2.8) for x, z in ((-3, 2), (3, 2), (3, -2), (-3, -2))]
    sides = [(0, 1, 2, 3), (7, 6, 5, 4), (3, 2, 6, 7), (0, 3, 7, 4), (1, 0, 4, 5)]
    walls = [rw.Mesh([box[i] for i in side], [(0, 1, 2), (0, 2, 3)], material=matt) for side in sides]
    hole = [(3, 0.9, 1.2), (3, 0.9, -1.2), (3, 2.3, -1.2), (3, 2.3, 1.2)]
    front = rw.Polygon([box[2], box[1], box[5], box[6]], [hole], material=matt)
    table = rw.Box((-0.6, 0.7, -0.9), (1.2, 0.76, 0.3), material=matt)
    feet = [(x, 0, z) for x in (-0.6, 1.1) for z in (-0.9, 0.2)]
    legs = [rw.Box(foot, np.add(foot, (0.06, 0.7, 0.06)), material=matt) for foot in feet]
    room = rw.Scene([*walls, front, table, *legs], environment=1.0)
    camera = rw.Camera((-2.7, 2.2, 1.7), (0.9, 0.75, -0.5), fov=62, width=500, height=300)
    image = rw.render(room, camera, samples=64, denoise=True)
    factor = 100 * image.rgb[..., 0] / 0.6
    return painted(room.first_hits(camera), factor, "magma", "daylight factor, %", vmin=0, vmax=15)


def canopy():
    """The sky through leaves, as a fisheye sees it from the ground, and the gaps by zenith angle."""
    rng = np.random.default_rng(1)
    leaf = rw.Disk((0, 0, 0), (0, 1, 0), 0.14)
    trunks, leaves = [], []
    for place in rng.uniform(-18, 18, (70, 2)):
        trunks.append(rw.Cylinder((place[0], 0, place[1]), (place[0], 9, place[1]), 0.2))
        at = rng.normal(size=(800, 3))
        at *= (rng.random(800) ** (1 / 3) / np.linalg.norm(at, axis=1))[:, None]
        leaves.append(at * (2.6, 3.2, 2.6) + (place[0], 8.5, place[1]))
    places = np.tile(np.eye(4), (70 * 800, 1, 1))
    places[:, :3, :3] = np.linalg.qr(rng.normal(size=(len(places), 3, 3)))[0]
    places[:, :3, 3] = np.concatenate(leaves)
    wood = rw.Scene([*trunks, rw.Instance(leaf, places)])
    camera = rw.Fisheye((0, 1.5, 0), direction=(0, 1, 0), up=(0, 0, 1), fov=180, width=480, height=480)
    origins, ways = camera.rays()
    is_seen = np.isfinite(ways).all(axis=-1)
    sky = is_seen & ~wood.occluded(origins, np.where(is_seen[..., None], ways, (0, 1, 0)))
    zenith = np.degrees(np.arccos(np.clip(ways[is_seen][:, 1], -1, 1)))
    rings = np.arange(0, 91, 5)
    gaps = np.histogram(zenith, rings, weights=1.0 * sky[is_seen])[0] / np.histogram(zenith, rings)[0]
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 4), dpi=100, layout="constrained")
    left.imshow(np.where(is_seen, sky, np.nan), cmap="gray", vmin=0, vmax=1)
    left.set_axis_off()
    right.plot(rings[:-1] + 2.5, gaps)
    right.set(xlabel="zenith angle, degrees", ylabel="gap fraction", ylim=(0, 1))
    return figure


PICTURES = {
    picture.__name__: picture
    for picture in (sky, sun, viewshed, lidar, thickness, distance, xray, slices, daylight, canopy)
}

HEAD = f"""# A measurer's gallery

Ten pictures of measurements, each with its code. `python docs/measured.py NAME` makes one again. Seconds are
processor time, of all threads together, on a virtual machine of two cores under other load. `painted` only
draws: it turns values on the surfaces that a camera sees into colors.

<!-- shown -->
```python
import matplotlib.pyplot as plt
import numpy as np
import trimesh
from PIL import Image

import raywright as rw


{inspect.getsource(city)}

{inspect.getsource(painted).rstrip()}
```
"""


def kept(name: str, made: Any, seconds: float) -> str:
    """Save a figure or a picture as a JPEG file that is small enough, and tell how long it took."""
    if not isinstance(made, Image.Image):
        drawn = BytesIO()
        made.savefig(drawn, format="png")
        plt.close(made)
        made = Image.open(drawn)
    for quality in range(92, 20, -4):
        made.convert("RGB").save(f"{name}.jpg", quality=quality, optimize=True)
        if Path(f"{name}.jpg").stat().st_size <= LARGEST:
            break
    return f"{seconds:.1f} s of one core"


def page(record: dict[str, str]) -> str:
    """Return the page, given the line under each picture."""
    return gallery_page.page(HEAD, PICTURES, record, "measured")


def main(names: list[str]) -> None:
    """Make the pictures of these names, or all, and write the page."""
    record = gallery_page.make(names, PICTURES, HERE / "measured", kept)
    (HERE / "measured.md").write_text(page(record))


if __name__ == "__main__":
    main(sys.argv[1:])
