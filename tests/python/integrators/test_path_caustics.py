"""Paths that aim at where light comes from by mirrors and glass: the same mean, less noise, the same bits."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import raywright as rw


def render(scene, camera, guiding, **how):
    how = {"samples": 16} | how
    depth = how.pop("max_depth", None)
    reuse = how.pop("reuse", 1)
    path = rw.Path(max_depth=depth, reuse=reuse, guiding=guiding)
    return rw.render(scene, camera, path, progress=False, **how)


def assert_same(a, b):
    assert np.array_equal(a.rgb, b.rgb)
    assert np.array_equal(a.standard_error, b.standard_error)


def quad(corner, side, other, **what):
    corner, side, other = (np.array(v, float) for v in (corner, side, other))
    return rw.Mesh(
        [corner, corner + side, corner + side + other, corner + other], [(0, 1, 2), (0, 2, 3)], **what
    )


SHIFT = np.array([4.0, -8.0, 16.0])
LAMP = np.array([[0.5, 1.0, 0.0], [0.0, 0.0, 0.05], [0.05, 0.0, 0.0]])


def mirrored(scale, shift=0.0):
    """A floor that a lamp lights by way of a mirror alone, and a camera that sees a spot of it."""

    def at(point):
        return tuple((np.array(point, float) + shift) * scale)

    def part(corner, side, other, **what):
        return quad(at(corner), np.array(side) * scale, np.array(other) * scale, **what)

    black = rw.Diffuse(0.0)
    floor = part((-1, 0, -1), (0, 0, 2), (2, 0, 0), material=rw.Diffuse(0.5))
    mirror = part((1, 0, -1), (0, 0, 2), (0, 2, 0), material=rw.Mirror(0.8))
    # Dark from above: it emits downwards, and a shade hides it from the camera.
    lamp = part(*LAMP[[0, 2, 1]], material=black, emission=20.0)
    shade = part((0.4, 0.3, -0.5), (0, 0.8, 0), (0, 0, 1), material=black)
    camera = rw.Camera(at((-0.5, 2, 0.3)), at((0, 0, 0)), fov=0.1, width=4, height=4)
    return rw.Scene([floor, mirror, lamp, shade]), camera


def truth():
    """Radiance of the spot: 0.5 / π times 0.8 times the light of the lamp's image, 2 - x away."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    u, v = np.meshgrid(0.5 + 0.5 * nodes, 0.5 + 0.5 * nodes)
    corner, side, other = LAMP
    points = corner + u[..., None] * side + v[..., None] * other
    points[..., 0] = 2.0 - points[..., 0]
    square = np.sum(points**2, axis=-1)
    # Both cosines are the height over the distance.
    light = np.sum(np.outer(weights, weights) / 4 * points[..., 1] ** 2 / square**2) * 0.05**2
    return 0.5 / np.pi * 0.8 * 20.0 * light


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("shift", [0.0, SHIFT])
def test_light_from_a_mirror_is_that_of_the_image(scale, shift):
    scene, camera = mirrored(scale, shift)
    image = render(scene, camera, "photons", samples=16384, max_depth=2, seed=3)
    mean, error = image.rgb.mean(dtype=float), np.sqrt(np.mean(image.standard_error.astype(float) ** 2) / 16)
    # Four standard errors, which are below one part in a hundred; the spot is a thousandth wide.
    assert abs(mean - truth()) <= 4 * error + 1e-3 * truth()
    assert error < 0.01 * truth()


def test_most_paths_find_it():
    scene, camera = mirrored(1.0)
    free, aimed = (
        render(scene, camera, guiding, samples=4096, max_depth=2).standard_error
        for guiding in ("none", "photons")
    )
    # The image fills one part in some five thousand of the floor's hemisphere, and most aimed paths hit it.
    assert np.mean(np.square(aimed)) < 0.01 * np.mean(np.square(free))


def room(*more, lamp=0.4):
    """Gray walls around the origin, a lamp under the ceiling, and other shapes; seen from within."""
    walls = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse((0.7, 0.5, 0.3)))
    shines = quad(
        (-lamp, 0.95, -lamp), (2 * lamp, 0, 0), (0, 0, 2 * lamp), material=rw.Diffuse(0.2), emission=8
    )
    camera = rw.Camera((0, 0, 0.98), (0, -0.2, 0), fov=90, width=12, height=12)
    return rw.Scene([walls, shines, *more]), camera


def sky():
    """A glass ball on a floor, under a sky with a bright patch."""
    pixels = np.full((16, 32, 3), 0.3)
    pixels[3:5, 6:9] = 40.0
    floor = rw.Disk((0, -0.5, 0), (0, 1, 0), 3.0, material=rw.Diffuse(0.6))
    ball = rw.Sphere((0, 0, 0), 0.5, material=rw.Dielectric(1.5))
    camera = rw.Camera((0, 1.5, 4), (0, -0.2, 0), fov=50, width=12, height=12)
    return rw.Scene([floor, ball], environment=rw.EnvironmentMap(pixels)), camera


def moving():
    ball = rw.Sphere((0, 0, 0), 0.3, material=rw.Mirror(0.9))
    here, there = np.eye(4), np.eye(4)
    here[:3, 3], there[:3, 3] = (-0.3, -0.5, 0), (0.3, -0.5, 0)
    return room(rw.Instance([ball], here, there))


def copies():
    places = np.stack([np.eye(4)] * 2)
    places[:, :3, 3] = [(-0.4, -0.5, 0), (0.4, -0.5, 0.1)]
    return room(rw.Instance([rw.Sphere((0, 0, 0), 0.3, material=rw.Dielectric(1.5))], places))


SCENES = {
    "glass": lambda: room(rw.Sphere((0.2, -0.4, 0), 0.4, material=rw.Dielectric(1.5))),
    "mirror and varnish": lambda: room(
        rw.Sphere((-0.4, -0.5, 0), 0.3, material=rw.Mirror(0.9)),
        rw.Sphere((0.4, -0.5, 0), 0.3, material=rw.Plastic((0.2, 0.4, 0.8))),
    ),
    "metal": lambda: room(rw.Sphere((0, -0.5, 0), 0.4, material=rw.Conductor("gold", roughness=0.2))),
    "half a mirror": lambda: room(
        rw.Sphere((0, -0.5, 0), 0.4, material=rw.Mix(rw.Diffuse(0.6), rw.Mirror(0.8), 0.5))
    ),
    "glass in glass": lambda: room(
        rw.Sphere((0, -0.4, 0), 0.5, material=rw.Dielectric(1.5)),
        rw.Sphere((0, -0.4, 0), 0.3, material=rw.Dielectric(1.2, priority=1)),
    ),
    # All direct light is blocked.
    "bulb": lambda: room(rw.Sphere((0, 0.9, 0), 0.8, material=rw.Dielectric(1.1)), lamp=0.2),
    "sky": sky,
    "moving": moving,
    "copies": copies,
}


# Mean of red, green and blue without caustics, and its standard error, from
# [render(scene, camera, "none", seed=1000 + s, samples=128, sampler=rw.rendering.Sobol()) for s in
# range(200)], of the glass in glass and the bulb for s in range(300).
FREE = {
    "glass": ((0.510533, 0.237978, 0.110439), (0.000302, 0.000176, 0.000123)),
    "mirror and varnish": ((0.408407, 0.206501, 0.114372), (0.000172, 0.000092, 0.000074)),
    "metal": ((0.520074, 0.230965, 0.094424), (0.00027, 0.000131, 0.000049)),
    "half a mirror": ((0.456824, 0.223716, 0.111901), (0.00019, 0.00012, 0.000103)),
    "glass in glass": ((0.51563, 0.242198, 0.11525), (0.000347, 0.0002, 0.000142)),
    "bulb": ((0.127626, 0.057275, 0.025424), (0.000313, 0.000146, 0.000077)),
    "sky": ((0.736619, 0.736619, 0.736619), (0.000318, 0.000318, 0.000318)),
    "moving": ((0.498394, 0.234279, 0.111625), (0.000218, 0.00015, 0.000137)),
    "copies": ((0.513153, 0.238681, 0.10939), (0.000304, 0.00017, 0.000112)),
}


@pytest.mark.parametrize("name", SCENES)
def test_the_mean_is_what_it_is_without(name):
    scene, camera = SCENES[name]()
    free, error_of_free = np.array(FREE[name])
    how = {"samples": 32, "sampler": rw.rendering.Sobol(), "threads": 1}
    few = np.array([render(scene, camera, "photons", seed=s, **how).rgb.mean(axis=(0, 1)) for s in range(40)])
    error = np.hypot(few.std(axis=0, ddof=1) / np.sqrt(40), error_of_free)
    # By Student's t of 39 degrees, one of the 27 such numbers of all scenes is off by more once in 640 tries.
    assert (np.abs(few.mean(axis=0) - free) <= 4.5 * error).all()
    # A hundredth, so that loss or double counting would show.
    assert (error < 0.01 * free).all()


HAZE = rw.media.Homogeneous((0.02, 0.05, 0.1), 0.2)


def hazy_box():
    """A box of haze beside a ball of glass, in a room."""
    ball = rw.Sphere((0.3, -0.4, 0), 0.4, material=rw.Dielectric(1.5))
    return room(rw.Box((-0.8, -0.9, -0.5), (-0.3, 0.5, 0.5), material=rw.MediumInterface(HAZE)), ball)


def in_haze():
    scene, camera = SCENES["glass"]()
    return scene.replace(medium=HAZE), camera


DIMMED = {
    "by wavelength": lambda: room(
        rw.Sphere((0.2, -0.4, 0), 0.4, material=rw.Dielectric(rw.materials.glasses["N-SF11"]))
    ),
    "in haze": in_haze,
    "in a box of haze": hazy_box,
}


@pytest.mark.parametrize(
    ("name", "guiding"), [*((name, "photons") for name in DIMMED), ("in a box of haze", "learned")]
)
def test_wavelengths_and_media_change_no_mean(name, guiding):
    scene, camera = DIMMED[name]()
    means, errors = {}, {}
    for way in ("none", guiding):
        few = [render(scene, camera, way, samples=32, seed=s + 100 * len(way)).rgb for s in range(24)]
        pictures = np.array(few, float).mean(axis=(1, 2))
        means[way], errors[way] = pictures.mean(axis=0), pictures.std(axis=0, ddof=1) / np.sqrt(24)
    off = np.abs(means[guiding] - means["none"]) / np.hypot(errors["none"], errors[guiding])
    # By Student's t with 46 samples, once in 20,000 a channel.
    assert off.max() < 4.5
    assert (errors[guiding] < 0.015 * means["none"].max()).all()


@pytest.mark.parametrize("name", DIMMED)
def test_wavelengths_and_media_leave_less_noise(name):
    scene, camera = DIMMED[name]()
    # A small lamp, whose caustic paths seldom find.
    walls, _, *rest = scene.shapes
    lamp = quad((-0.05, 0.95, -0.05), (0.1, 0, 0), (0, 0, 0.1), material=rw.Diffuse(0.2), emission=300)
    scene = scene.replace(shapes=[walls, lamp, *rest])
    free, aimed = (
        np.mean(np.square(render(scene, camera, way, samples=256).standard_error))
        for way in ("none", "photons")
    )
    # A third or less when it was measured.
    assert aimed < 0.6 * free


def test_a_furnace_stays_one():
    floor = rw.Disk((0, -0.5, 0), (0, 1, 0), 3.0, material=rw.Diffuse(1.0))
    balls = [
        rw.Sphere((-0.6, 0, 0), 0.5, material=rw.Dielectric(1.5)),
        rw.Sphere((0.6, 0, 0), 0.5, material=rw.Mirror(1.0)),
    ]
    camera = rw.Camera((0, 1.5, 4), (0, -0.2, 0), fov=50, width=16, height=16)
    scene = rw.Scene([floor, *balls], environment=1.0)
    image = render(scene, camera, "photons", samples=256)
    error = np.sqrt(np.mean(image.standard_error.astype(float) ** 2) / image.rgb.size * 3)
    assert abs(image.rgb.mean(dtype=float) - 1) <= 4 * error + 1e-6
    assert error < 0.005


@pytest.fixture(scope="module")
def same_scenes():
    """Three equal scenes: each finds by itself where light comes from, and keeps it."""
    balls = (
        rw.Sphere((0.3, -0.4, 0), 0.4, material=rw.Dielectric(1.5)),
        rw.Sphere((-0.5, -0.5, 0), 0.3, material=rw.Mirror(0.9)),
    )
    camera = rw.Camera((0, 0, 0.98), (0, -0.2, 0), fov=90, width=21, height=13)
    return [(room(*balls)[0], camera) for _ in range(3)]


@pytest.mark.parametrize("how", [{}, {"adaptive": True}, {"sampler": rw.rendering.Sobol()}, {"reuse": 4}])
def test_threads_pieces_and_checkpoints_change_no_bit(how, same_scenes, tmp_path):
    alone, together, elsewhere = same_scenes
    one = render(*alone, "photons", samples=48, threads=1, **how)
    assert one.error.estimate > 0
    assert_same(render(*together, "photons", samples=48, threads=3, **how), one)
    with ThreadPoolExecutor(2) as executor:
        assert_same(render(*elsewhere, "photons", samples=48, executor=executor, **how), one)
    # Batches depend on the number of samples, which differs here.
    how = how | {"sampler": one.plan.sampler, "checkpoint": tmp_path / "a"}
    render(*alone, "photons", samples=16, **how)
    assert_same(render(*together, "photons", samples=48, **how), one)


def test_where_nothing_can_be_found_it_changes_no_bit():
    plain = rw.scenes.cornell_box(width=16, height=16)
    assert_same(render(*plain, "photons"), render(*plain, "none"))
    # No ray hits lights with a delta distribution, and with one bounce no path reaches the lamp by a mirror.
    ball = rw.Sphere((0, -0.5, 0), 0.4, material=rw.Mirror())
    walls = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(0.5))
    point = rw.Scene([walls, ball], lights=rw.PointLight((0, 0.9, 0), 3.0))
    camera = rw.Camera((0, 0, 0.98), (0, -0.2, 0), fov=90, width=12, height=12)
    assert_same(render(point, camera, "photons"), render(point, camera, "none"))
    glass = SCENES["glass"]()
    assert_same(render(*glass, "photons", max_depth=1), render(*glass, "none", max_depth=1))
    dark = rw.Scene([walls, ball])
    assert not render(dark, camera, "photons").rgb.any()


def test_fireflies_are_found_by_most_paths():
    scene, camera = rw.scenes.glass_spheres(width=32, height=32)
    free, aimed = (
        np.array([render(scene, camera, guiding, samples=64, seed=s).rgb for s in range(4)], float)
        for guiding in ("none", "photons")
    )
    mean = np.square(aimed.mean(axis=0)) + 0.01
    # Seventeen to thirty-six times less in four such sets of seeds.
    assert np.mean(aimed.var(axis=0, ddof=1) / mean) < 0.2 * np.mean(free.var(axis=0, ddof=1) / mean)


@pytest.mark.parametrize("guiding", ["paths", "", True, 1])
def test_other_guiding_is_refused(guiding):
    with pytest.raises(
        ValueError, match=f"guiding must be one of 'none', 'photons', 'learned', got {guiding!r}"
    ):
        rw.Path(guiding=guiding)
