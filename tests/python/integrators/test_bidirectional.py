"""Bidirectional path tracing: the pictures of path tracing, and light that is hard to reach."""

import math
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from cornell_picture import cornell_picture
from light_pictures import MATERIALS, SIDE, assert_same, ball, camera, lamp, square
from long_runs import error_of_part, part

import raywright as rw


def assert_same_picture(scene, camera, samples=64, paths=256, depth=None, path=None):
    theirs = path or rw.Path(depth, reuse=1)
    return assert_same(scene, camera, (rw.Bidirectional(depth), samples), (theirs, paths))


def mean(image):
    """Mean of green over the picture, and its standard error."""
    error = np.square(image.standard_error[..., 1].astype(float)).sum()
    return float(image.rgb[..., 1].mean(dtype=float)), math.sqrt(error) / image.rgb[..., 1].size


def assert_mean(image, expected, most, off=0.0):
    """Within three standard errors, which are at most a share of what is expected, and a share that the scene
    is off by. Chance exceeds three once in 370 seeds, and seeds are fixed."""
    found, error = mean(image)
    assert error <= most * expected, error / expected
    assert abs(found - expected) <= 3 * error + off * expected, (found, error, expected)


@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_scatters_as_paths_see_it(name):
    # The geometric normals of twenty triangles are far from the shading normals.
    scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), lamp(), ball(0, MATERIALS[name])])
    assert_same_picture(scene, camera())


def test_what_is_sharp_and_what_is_beside_it():
    shapes = [
        square(3, 0, material=rw.Diffuse(0.6)),
        lamp(size=1.0),
        rw.Sphere((0.3, 0, 0.6), 0.6, material=rw.Dielectric(1.5)),
        rw.Sphere((-0.9, 0.3, 0.4), 0.4, material=rw.Mirror()),
        rw.Sphere((-0.2, -1.1, 0.3), 0.3, material=rw.Plastic((0.2, 0.4, 0.7))),
    ]
    assert_same_picture(rw.Scene(shapes), camera(), paths=1024, path=rw.Path(reuse=1, guiding="none"))


def test_bumps_textures_masks_and_sides():
    checker = rw.Checker((0.9, 0.2, 0.1), 0.3, 4)
    floor = square(3, 0, material=rw.BumpMap(rw.Diffuse(checker), rw.textures.Noise(), scale=0.2))
    lace = square(0.8, 1.0, material=rw.Mask(rw.Diffuse(0.7), rw.Checker(1, 0.3, 6)))
    wall = rw.Mesh(
        [(-2, 2, 0), (2, 2, 0), (2, 2, 2), (-2, 2, 2)], [(0, 2, 1), (0, 3, 2)], material=rw.Diffuse(0.5)
    )
    assert_same_picture(rw.Scene([floor, lace, wall, lamp()]), camera())


@pytest.mark.parametrize(
    "light",
    [
        rw.PointLight((0.5, 0.2, 2), 6),
        rw.SpotLight((0.5, 0.2, 2), (0, 0, 0), 9, angle=35, falloff=10),
        rw.DirectionalLight((0.3, 0.2, -1), (2, 1, 1)),
        rw.ConstantEnvironment((0.5, 0.7, 1)),
        rw.SunSky((1, 1, 0.8), up=(0, 0, 1)),
    ],
    ids=lambda light: type(light).__name__,
)
def test_every_light_is_weighed(light):
    shapes = [square(3, 0, material=rw.Diffuse(0.6)), ball(2, rw.Diffuse(0.8)), rw.Sphere((1, 1, 0.4), 0.4)]
    is_around = isinstance(light, rw.ConstantEnvironment | rw.SunSky)
    scene = rw.Scene(shapes, environment=light) if is_around else rw.Scene(shapes, lights=[light])
    assert_same_picture(scene, camera())


def test_lights_of_every_kind_together():
    shapes = [
        square(3, 0, material=rw.Diffuse(0.6)),
        lamp(height=3.0),
        rw.Sphere((0, 0, 2.2), 0.3, emission=8),
        rw.Torus((0.3, 0, 0.6), (0, 0, 1), 0.6, 0.2, emission=2),
        rw.shapes.Ellipsoid((-0.8, -0.3, 0.4), (0.2, 0.3, 0.4), emission=3),
    ]
    lights = [
        rw.PointLight((-1, 1, 2), 3),
        rw.DirectionalLight((0.3, 0.2, -1), 1),
        rw.DirectionalLight((-0.3, 0.2, -1), 0.5),
    ]
    scene = rw.Scene(shapes, lights=lights, environment=rw.ConstantEnvironment((0.5, 0.7, 1)))
    assert_same_picture(scene, camera())


def test_what_shines_in_instances_and_what_moves():
    glow = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 2, 1)], material=rw.Diffuse(0), emission=9)
    bulb = rw.Sphere((0, 0, 0.3), 0.2, emission=5)
    places = np.tile(np.eye(4), (3, 1, 1))
    places[:, :3, 3] = [(-1, -1, 1.5), (0.5, 0, 2), (0, 1, 1.2)]
    places[1, 0, 0] = 0.3
    flag = rw.Mesh([(-0.5, 0, 0.5), (0.5, 0, 0.5), (0, 0, 1.2)], [(0, 1, 2)], material=rw.Diffuse(0.9))
    end = np.eye(4)
    end[1, 3] = 1
    moved = rw.Instance([flag], np.eye(4), end)
    scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), rw.Instance([glow, bulb], places), moved])
    assert_same_picture(scene, camera())


def test_media_that_lie_in_one_another():
    glass = rw.Dielectric(1.5, roughness=0.5, priority=1)
    water = rw.Dielectric(1.33, roughness=0.5)
    scene = rw.Scene(
        [
            square(3, 0, material=rw.Diffuse(0.6)),
            rw.Sphere((0, 0, 0.7), 0.6, material=glass),
            rw.Box((-0.4, -0.4, 0.3), (0.9, 0.4, 1.0), material=water),
            lamp(size=1.0),
        ]
    )
    assert_same_picture(scene, camera())


@pytest.mark.parametrize(
    "look",
    [
        rw.ThinLens(
            (0.5, 0.5, 2.4),
            (0.5, 0.4, 0),
            fov=39,
            width=SIDE,
            height=SIDE,
            aperture_radius=0.1,
            focus_distance=2.0,
        ),
        rw.Orthographic((0.5, 0.5, 2.4), (0.5, 0.4, 0), scale=1.1, width=SIDE, height=SIDE),
        rw.Panorama((0.4, 0.6, 0.9), (0.4, 0.4, 0), width=SIDE, height=SIDE),
        rw.Fisheye((0.4, 0.6, 0.9), (0.4, 0.4, 0), fov=150, width=SIDE, height=SIDE),
    ],
    ids=lambda look: type(look).__name__,
)
def test_every_camera(look):
    scene, _ = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    assert_same_picture(scene, look)


@pytest.mark.parametrize("depth", [0, 1, 2, 3])
def test_depths_count_bounces(depth):
    scene, look = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    assert_same_picture(scene, look, depth=depth)


def hollow(aperture, *, center=0.0, up=True, rings=96, **kwargs):
    """A sphere of radius 1 that faces inwards, less the cap beyond a circle about the top, or the bottom."""
    start = math.asin(aperture)
    polar = start + np.linspace(0, 1, rings) ** 1.5 * (math.pi - start)
    around = np.arange(2 * rings) * (math.pi / rings)
    out, z = np.sin(polar)[:, None], np.cos(polar)[:, None]
    x, y, z = np.broadcast_arrays(out * np.cos(around), out * np.sin(around), z if up else -z)
    i, j = np.meshgrid(np.arange(rings - 1), np.arange(2 * rings), indexing="ij")
    k = (j + 1) % (2 * rings)
    a, b, c, d = (r * 2 * rings + s for r, s in [(i, j), (i + 1, j), (i + 1, k), (i, k)])
    # The last ring is the pole, where one of the two triangles has no area.
    faces = np.concatenate(
        [np.stack(three, -1).reshape(-1, 3) for three in [(a[:-1], c[:-1], b[:-1]), (a, d, c)]]
    )
    vertices = np.stack([x, y, z + center], -1).reshape(-1, 3)
    return rw.Mesh(vertices, faces if up else faces[:, ::-1], **kwargs)


@pytest.mark.slow
def test_light_behind_a_port():
    # A point light in a hollow sphere whose wall has a port: the receiver sees the wall alone. Its radiosity
    # is rho I / (1 - rho (1 - s)), with s the share of the sphere that is cut away. The port emits like a
    # disk of this radiosity. The irradiance of the receiver follows from a camera there, by solid angle and
    # cosine.
    port, rho, far, aside = 0.1, 0.9, 0.5, 0.3
    rim = math.sqrt(1 - port**2)
    share = (1 - rim) / 2
    wall = rho / (1 - rho * (1 - share))
    # The configuration factor of a disk for a parallel element (Walsh 1958).
    h, r = far / port, aside / port
    factor = 0.5 * (1 - (h * h + r * r - 1) / math.sqrt((h * h + r * r + 1) ** 2 - 4 * r * r))
    expected = wall * factor
    assert abs(wall - 8.80146936562785) < 1e-12
    assert abs(expected - 0.189124193924197) < 1e-12
    side, fov = 48, 26
    scene = rw.Scene([hollow(port, material=rw.Diffuse(rho))], lights=[rw.PointLight((0, 0, 0), 1)])
    at, to = np.array([aside, 0.0, rim + far]), np.array([0.0, 0.0, rim])
    look = rw.Camera(at, to, up=(0, 1, 0), fov=fov, width=side, height=side)
    image = rw.render(scene, look, rw.Bidirectional(), 96, progress=False)
    # Pixels as seen from there: the solid angle of each, and the cosine of its middle to the port's normal.
    half = math.tan(math.radians(fov / 2))
    u, v = np.meshgrid(*[((np.arange(side) + 0.5) / side * 2 - 1) * half] * 2)
    axis = (to - at) / np.linalg.norm(to - at)
    across = np.cross(axis, [0, 1, 0])
    away = axis + u[..., None] * across - v[..., None] * np.array([0.0, 1.0, 0.0])
    length = np.linalg.norm(away, axis=-1)
    share = -away[..., 2] / length * (2 * half / side) ** 2 / length**3
    found = float((image.rgb[..., 1] * share).sum())
    error = math.sqrt(float(((image.standard_error[..., 1] * share) ** 2).sum()))
    assert error < 0.002 * expected
    # The wall of straight pieces, of 2 degrees, is off by less than a thousandth.
    assert abs(found - expected) < 3 * error + 1e-3 * expected


def test_the_near_side_of_a_ball_hides_its_far_side():
    # From the floor, vertices on the far side of rough glass would add 3 %.
    floor = rw.Mesh(
        [(-3, 0, -3), (-3, 0, 3), (3, 0, 3), (3, 0, -3)], [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0.6)
    )
    ball = rw.Sphere((0, 0.7, 0), 0.6, material=rw.Dielectric(1.5, roughness=0.5))
    lamp = rw.Sphere((1.0, 2.6, 0.5), 0.3, material=rw.Diffuse(0), emission=30.0)
    camera = rw.Camera((0, 1.5, 4), (0, 0.5, 0), fov=40, width=24, height=24)
    found = []
    for way, samples in ((rw.Path(reuse=1, guiding="none"), 1024), (rw.Bidirectional(), 128)):
        image = rw.render(rw.Scene([floor, ball, lamp]), camera, way, samples=samples, seed=2, progress=False)
        error = math.sqrt((image.standard_error.astype(float) ** 2).sum()) / image.rgb.size
        found.append((image.rgb.astype(float).mean(), error))
    (path, one), (both, other) = found
    error = math.hypot(one, other)
    assert error < 0.004 * path
    # Four standard errors: by chance once in 16,000.
    assert abs(path - both) < 4 * error, found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("aperture", "rho", "expected", "most"),
    [
        (0.5, (0.5, 0.8), (1.89963972281447, 0.401441108742115), 0.002),
        # One path in 8000 passes the small hole: 0.2 % would take 2 billion of them.
        (0.01, (0.8, 0.8), (4.99950008748438, 0.000499912515622227), 0.06),
    ],
)
def test_chambers_that_light_each_other_through_a_hole(aperture, rho, expected, most):
    # From any point of a sphere, the opening has the form factor s: each wall is uniform. BA = 1 + rA ((1 -
    # s) BA + s BB), BB = rB ((1 - s) BB + s BA).
    rim = math.sqrt(1 - aperture**2)
    s = (1 - rim) / 2
    bounce = np.array([[rho[0] * (1 - s), rho[0] * s], [rho[1] * s, rho[1] * (1 - s)]])
    np.testing.assert_allclose(np.linalg.solve(np.eye(2) - bounce, [1, 0]), expected, rtol=1e-12)
    first = hollow(aperture, material=rw.Diffuse(rho[0]), emission=1 / math.pi)
    second = hollow(aperture, center=2 * rim, up=False, material=rw.Diffuse(rho[1]))
    scene = rw.Scene([first, second])
    # By photons, to each depth: a share of the light that arrives at a wall after that many bounces is
    # reflected. The small hole needs twice as many, or too few pass it.
    depths, runs, count = 6, 12, part(200_000 if aperture > 0.1 else 600_000, 4)
    arrived = np.zeros((runs, 2, depths + 1))
    for seed in range(runs):
        found = scene.photons(count, seed=seed)
        order = np.minimum(found.bounces, depths)
        for wall in range(2):
            here = found.shape_id == wall
            sums = np.bincount(order[here], found.powers[here, 1], depths + 1)
            arrived[seed, wall] = sums / found.emitted[1]
    # Both walls have the same area, and the first emits 1: irradiance is in units of that.
    of_depth = [np.linalg.matrix_power(bounce, k) @ [1, 0] for k in range(1, depths + 1)]
    rest = np.array(expected) - [1, 0] - np.sum(of_depth, 0)
    sent = arrived * np.array(rho)[:, None]
    mean, error = sent.mean(0), sent.std(0, ddof=1) / math.sqrt(runs)
    whole, doubt = sent.sum(2).mean(0), sent.sum(2).std(0, ddof=1) / math.sqrt(runs)
    assert (doubt < error_of_part(most, 4) * whole).all(), doubt / whole
    # Within three standard errors; seeds are fixed. Walls of straight pieces are off by less than a
    # thousandth, and so is the hole between them.
    off = np.abs(whole - (np.array(expected) - [1, 0]))
    assert (off < 3 * doubt + 1e-3 * whole).all(), (whole, doubt)
    for k, truth in enumerate([*of_depth, rest]):
        off = np.abs(mean[:, k] - truth)
        assert (off < 3 * error[:, k] + 1e-3 * truth + 1e-12).all(), (k, mean[:, k], truth)
    # By connections, the picture of either; through the small hole they do not resolve the other.
    for chamber in range(2 if aperture > 0.1 else 1):
        center = 2 * rim * chamber
        look = rw.Camera((0.1, 0.2, center), (1, 0.3, center), up=(0, 0, 1), fov=60, width=16, height=16)
        for depth in (1, 2, None):
            image = rw.render(scene, look, rw.Bidirectional(depth), 64, progress=False)
            radiosity = expected if depth is None else np.add([1, 0], sum(of_depth[:depth]))
            assert_mean(image, radiosity[chamber] / math.pi, 0.03, off=1e-3)


def test_a_lamp_under_a_ceiling():
    # A point light of intensity 1 half a unit under a wide ceiling of reflectance 0.8. A floor at height 0,
    # under the lamp, gets from the ceiling at 2.5 2 rho a H^2 times the integral of r dr / ((a^2 + r^2)^(3/2)
    # (H^2 + r^2)^2), and directly 1 / 2^2.
    ceiling = square(200, 2.5, up=False, material=rw.Diffuse(0.8))
    scene = rw.Scene(
        [ceiling, square(0.01, 0, material=rw.Diffuse(1.0))], lights=[rw.PointLight((0, 0, 2), 1)]
    )
    look = rw.Camera((0.3, 0, 0.4), (0, 0, 0), up=(0, 0, 1), fov=0.5, width=8, height=8)
    direct = rw.render(scene, look, rw.Bidirectional(1), 64, progress=False)
    both = rw.render(scene, look, rw.Bidirectional(2), 3000, progress=False)
    # The visible 4 mm get less by a few millionths than the point under the lamp.
    assert_mean(direct, 0.25 / math.pi, 0.002, off=1e-5)
    assert_mean(both, (0.25 + 0.166860231636058) / math.pi, 0.002, off=1e-5)


@pytest.mark.slow
def test_a_pane_before_a_point_light():
    # A pane without thickness transmits (1 - r) / (1 + r); straight on r = 0.04, and 12/13 arrive. Neither
    # paths from the floor nor connections reach the point light through the pane: only light paths do.
    pane, floor = square(50, 1.0, material=rw.ThinDielectric(1.5)), square(2, 0, material=rw.Diffuse(1.0))
    for x, expected in [(0, 0.230769230769231), (1, 0.16483003912558)]:
        # The cone lights little more than the visible 6 mm.
        lamp = rw.SpotLight((0, 0, 2), (x, 0, 0), 1, angle=0.16, falloff=0)
        scene = rw.Scene([pane, floor], lights=[lamp])
        look = rw.Camera((x, -0.8, 0.8), (x, 0, 0), up=(0, 0, 1), fov=0.3, width=16, height=16)
        assert not rw.render(scene, look, rw.Path(1, reuse=1), 16, progress=False).rgb.any()
        image = rw.render(scene, look, rw.Bidirectional(2), 4000, progress=False)
        # Over the visible part it differs by less than a hundred-thousandth or so from its middle.
        assert_mean(image, expected / math.pi, 0.002, off=5e-5)


def bulb(height, *, up):
    """1e-12 of area that shines by 1e12: a power of pi."""
    corners = [(0, 0, height), (1e-6, 0, height), (0, 2e-6, height)]
    return rw.Mesh(corners, [(0, 1, 2) if up else (0, 2, 1)], material=rw.Diffuse(0), emission=1e12)


def test_a_tiny_lamp():
    wall = rw.Mesh(
        [(-2, 2, 0), (2, 2, 0), (2, 2, 2), (-2, 2, 2)], [(0, 2, 1), (0, 3, 2)], material=rw.Diffuse(0.5)
    )
    scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), wall, bulb(1.0, up=False)])
    ours, _ = assert_same_picture(scene, camera(), depth=3, paths=1024)
    assert np.isfinite(ours.rgb).all()
    assert (ours.rgb >= 0).all()


def test_a_lamp_close_to_a_surface():
    # A thousandth above the floor: a power of pi falls on a few square millimeters, where camera paths hardly
    # ever go. A reflectance of 0.6 reflects 0.6 of it along the normal per solid angle.
    scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), bulb(1e-3, up=False)])
    at = np.array([3.0, -2.0, 2.5])
    far = np.linalg.norm(at)
    image = rw.render(scene, camera(at, (0, 0, 0)), rw.Bidirectional(1), 400, progress=False)
    # The picture takes (2 tan 20 degrees)^2 at distance 1.
    expected = 0.6 * (at[2] / far) / (2 * far * math.tan(math.radians(20))) ** 2
    # A few square millimeters are no point, and one part in a thousand falls 3 cm away or farther.
    assert_mean(image, expected, 0.002, off=1e-3)


def test_the_error_is_as_told():
    # The interval holds the truth in 95 of 100: fewer than 31 of 36 once in 100 such tests by chance.
    scene, look, truth = cornell_picture(16)
    held = 0
    for seed in range(36):
        image = rw.render(scene, look, rw.Bidirectional(), 16, seed=seed, progress=False)
        error = float(np.mean((image.rgb - truth) ** 2 / (truth**2 + 0.01)))
        held += image.error.low <= error <= image.error.high or not image.error.trusted
    assert held >= 31


def test_bits_are_those_of_any_threads_passes_and_executors(tmp_path):
    scene, look = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    way, options = rw.Bidirectional(), {"samples": 20, "progress": False}
    one = rw.render(scene, look, way, threads=1, **options)
    two = rw.render(scene, look, way, threads=2, **options)
    np.testing.assert_array_equal(one.rgb, two.rgb)
    with ThreadPoolExecutor(2) as executor:
        there = rw.render(scene, look, way, executor=executor, **options)
    np.testing.assert_array_equal(one.rgb, there.rgb)
    rw.render(scene, look, way, 9, checkpoint=tmp_path / "c", sampler=one.plan.sampler, progress=False)
    later = rw.render(scene, look, way, checkpoint=tmp_path / "c", **options)
    np.testing.assert_array_equal(one.rgb, later.rgb)


def test_wrong_input_gets_one_clear_line():
    for arguments, kind, words in [
        ({"max_depth": -1}, ValueError, "max_depth must be between 0 and"),
        ({"max_depth": 2.5}, TypeError, "max_depth must be"),
        ({"roulette_depth": "4"}, TypeError, "roulette_depth must be"),
        ({"vertex_merging": 1}, TypeError, "vertex_merging must be True or False, got 1"),
        ({"radius": 0.1}, ValueError, "radius requires vertex_merging=True"),
        ({"photons": 100}, ValueError, "photons requires vertex_merging=True"),
        ({"vertex_merging": True, "radius": -1}, ValueError, "radius must be greater than 0"),
        ({"vertex_merging": True, "radius": "1"}, TypeError, "radius must be"),
        ({"vertex_merging": True, "photons": 0}, ValueError, "photons must be between 1 and"),
    ]:
        with pytest.raises(kind, match=words):
            rw.Bidirectional(**arguments)
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    with pytest.raises(ValueError, match="use adaptive=False"):
        rw.render(scene, look, rw.Bidirectional(), 4, adaptive=True, progress=False)
    endless = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1))], environment=rw.ConstantEnvironment(1))
    with pytest.raises(ValueError, match=r"shape 0, which is unbounded.*use Path"):
        rw.render(endless, look, rw.Bidirectional(), 4, progress=False)


def test_values():
    way = rw.Bidirectional(3, roulette_depth=2)
    assert repr(way).startswith("Bidirectional(max_depth=3, roulette_depth=2, vertex_merging=False")
    assert pickle.loads(pickle.dumps(way)) == way != rw.Bidirectional()


def test_what_is_dark_stays_black():
    scene = rw.Scene([square(1, 0, material=rw.Diffuse(0.5))])
    image = rw.render(scene, camera(), rw.Bidirectional(), 4, progress=False)
    assert not image.rgb.any()


def test_paths_end_where_nothing_absorbs_them():
    white = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(1.0), emission=rw.Emission(1, side="back"))
    look = rw.Camera((0, 0, 0.5), (0, 0, 0), fov=90, width=1, height=1)
    image = rw.render(rw.Scene(white), look, rw.Bidirectional(), 1, progress=False)
    assert np.isfinite(image.rgb).all()
    assert image.rgb.min() > 1
