"""Photon maps: the light of closed forms and of path tracing, its noise, and its bias."""

import math
import pickle
from concurrent.futures import ProcessPoolExecutor
from functools import cache

import numpy as np
import pytest
from light_pictures import assert_agree, behind_glass, square

import raywright as rw

SIDE = 16


def picture(scene, camera, integrator, samples, **options):
    return rw.render(scene, camera, integrator, samples, progress=False, **options)


WAYS = {
    "nearest": rw.PhotonMap(5000),
    "looked up": rw.PhotonMap(5000, final_gather=0, filter="epanechnikov"),
    "one map": rw.PhotonMap(5000, caustic=False, final_gather=0, filter="cone"),
    "caustics by rays": rw.PhotonMap(5000, caustic=False, final_gather=2),
    "fixed": rw.PhotonMap(5000, k_nearest=None, radius=20.0),
    "progressive": rw.ProgressivePhotonMap(5000),
    "short": rw.PhotonMap(10_000, final_gather=0, max_depth=2),
    "short, gathered": rw.PhotonMap(5000, max_depth=3),
}


@cache
def room(max_depth):
    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    return scene, camera, picture(scene, camera, rw.Path(max_depth, reuse=1, guiding="none"), 512)


@pytest.mark.parametrize("way", WAYS)
def test_a_room_is_that_of_paths(way):
    scene, camera, truth = room(WAYS[way].max_depth)
    assert_agree(scene, camera, WAYS[way], truth)


def water(n=1.33, depth=0.3):
    """Even light over a tank of water whose walls are mirrors: as of a lake without end."""
    white = rw.Diffuse(0.6)
    floor = square(0.5, 0.0, material=white)
    surface = square(0.5, depth, material=rw.Dielectric(n))
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    points = [(x, y, z) for z in (0.0, depth) for x, y in corners]
    faces = []
    for i in range(4):
        j = (i + 1) % 4
        faces += [(i, j, j + 4), (i, j + 4, i + 4)]
    walls = rw.Mesh(points, faces, material=rw.Mirror(1.0))
    return rw.Scene([floor, surface, walls], environment=rw.ConstantEnvironment(1))


@pytest.mark.parametrize(
    "way",
    [
        rw.PhotonMap(6_000, k_nearest=None, radius=0.05, final_gather=0),
        pytest.param(rw.ProgressivePhotonMap(30_000, 0.08), marks=pytest.mark.slow),
        pytest.param(rw.PhotonMap(60_000, k_nearest=90, final_gather=0), marks=pytest.mark.slow),
    ],
)
def test_the_sky_over_water(way):
    # The floor scatters light up through the water, and the surface reflects a part of it back, again and
    # again: the radiance straight up is R0 + (1 - R0) rho E / (pi n^2). Photons and the camera both pass it.
    # No disk reaches the walls, beyond which no photons lie: gather rays there lose a share of the light that
    # depends on the radius, 2 % at 0.05.
    camera = rw.Orthographic((0, 0, 2), (0, 0, 0), up=(0, 1, 0), width=8, height=8, scale=0.8)
    seen = [picture(water(), camera, way, 96, seed=seed).rgb.astype(float).mean() for seed in range(6)]
    mean, error = np.mean(seen), np.std(seen, ddof=1) / math.sqrt(len(seen))
    # Known to some 0.2 %; over six pictures, five standard errors are exceeded once in 250 times.
    assert error < 0.0025 * mean
    assert abs(mean - 0.453181373761441) < 5 * error


@pytest.fixture(scope="module")
def caustic():
    """A floor lit by a lamp of intensity 1, 1 above it, through a pane that neither bends nor dims its light.

    So all light comes by way of something sharp, and none straight.
    """
    floor = square(2.0, 0.0, material=rw.Diffuse(0.5))
    pane = square(3.0, 0.5, material=rw.Dielectric(1.0))
    return rw.Scene([floor, pane], lights=[rw.PointLight((0, 0, 1), 1.0)])


@pytest.mark.parametrize(("radius", "expected"), [(0.5, 0.844582472000673), (1.0, 0.585786437626905)])
def test_a_disk_has_its_bias_and_tells_it(caustic, radius, expected):
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=1, height=1, scale=1e-3)
    way = rw.PhotonMap(30_000, k_nearest=None, radius=radius, final_gather=0)
    images = [
        picture(caustic, look, way, 16, sampler=rw.rendering.Independent(), seed=seed) for seed in range(4)
    ]
    light = [2 * math.pi * float(image.rgb.mean()) for image in images]
    error = np.std(light, ddof=1) / 2
    assert error < 0.01
    # By Student's t of three degrees, seven standard errors are exceeded once in 170 times.
    assert abs(np.mean(light) - expected) < 7 * error + 1e-3
    for image in images:
        assert image.biased
        assert image.bias.shape == (1, 1, 3)
    # At such a near lamp, r⁴ counts as well as r²: by the disks' expected values, the estimated bias is 0.907
    # of the true one, and 1.068 for the wide lamp, which has another law. Four pictures estimate it to about
    # 0.01.
    told = 2 * math.pi * np.mean([image.bias.mean() for image in images])
    assert abs(told / (expected - 1) - (0.907 if radius == 0.5 else 1.068)) < 0.3
    # Less than a third of the bias remains after its subtraction.
    left = np.mean(light) - 2 * math.pi * np.mean([image.bias.mean() for image in images]) - 1
    assert abs(left) < (1 - expected) / 3 + 7 * error


@pytest.mark.parametrize("opacity", [0.25, 1.0])
@pytest.mark.parametrize(
    "way",
    [
        rw.PhotonMap(30_000, radius=0.25, final_gather=0),
        rw.Bidirectional(vertex_merging=True, radius=0.25, photons=30_000),
    ],
)
def test_a_masked_floor_is_as_bright_as_it_is_opaque(way, opacity):
    # Light through a pane is found by photons alone. Those that pass the mask are not stored; the others
    # stand for them too, since the camera sees the floor by the same chance.
    floor = square(2.0, 0.0, material=rw.Mask(rw.Diffuse(0.5), opacity))
    pane = square(3.0, 0.5, material=rw.Dielectric(1.0))
    scene = rw.Scene([floor, pane], lights=[rw.DirectionalLight((0, 0, -1), 1.0)])
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=8, height=8, scale=0.5)
    light = [2 * math.pi * picture(scene, look, way, 16, seed=seed).rgb.mean() for seed in range(4)]
    assert np.std(light, ddof=1) / 2 < 0.02 * opacity
    assert abs(np.mean(light) - opacity) < 0.08 * opacity


@pytest.mark.parametrize(("x", "y"), [(1.9999, 0.0), (1.9999, 1.9999), (1.9, 0.3)])
@pytest.mark.parametrize(("photons", "nearest"), [(20_000, None), (30_000, 32)])
def test_edges_are_as_bright_as_what_is_in_the_middle(x, y, photons, nearest):
    # Even light on a floor that ends within the disk: half of that, or three quarters, has no photons, and
    # the estimate divides by the area that exists. Sixteen probes estimate that to a few in a hundred.
    floor = square(2.0, 0.0, material=rw.Diffuse(0.5))
    pane = square(3.0, 0.5, material=rw.Dielectric(1.0))
    scene = rw.Scene([floor, pane], lights=[rw.DirectionalLight((0, 0, -1), 1.0)])
    look = rw.Orthographic((x, y, 0.4), (x, y, 0), up=(0, 1, 0), width=1, height=1, scale=1e-6)
    way = rw.PhotonMap(photons, k_nearest=nearest, radius=0.25, final_gather=0)
    light = [
        2
        * math.pi
        * float(picture(scene, look, way, 16, sampler=rw.rendering.Independent(), seed=seed).rgb.mean())
        for seed in range(4)
    ]
    assert np.std(light, ddof=1) / 2 < 0.03
    assert abs(np.mean(light) - 1) < 0.1


def test_progress_takes_the_bias_away(caustic):
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=4, height=4, scale=0.05)
    way = rw.ProgressivePhotonMap(3000, radius=0.8)
    bias, off = [], []
    for samples in (4, 32, 256):
        images = [
            picture(caustic, look, way, samples, sampler=rw.rendering.Independent(), seed=seed)
            for seed in range(max(64 // samples, 1))
        ]
        bias.append(np.mean([image.bias.mean() for image in images]))
        off.append(2 * math.pi * np.mean([image.rgb.mean() for image in images]) - 1)
    # It is too dark under the lamp, and reports so; N^(-1/3) of it is left, 1/2 of 1/2.
    assert bias[0] < bias[2] < 0
    assert off[0] < 1.2 * off[1] < 1.2 * 1.2 * off[2] < 0
    assert 0.1 < off[2] / off[0] < 0.45


@pytest.mark.parametrize("samples", [16, 64, 256])
def test_the_error_of_a_single_pixel_is_as_it_says(caustic, samples):
    # Over many pictures, pixels are off by their estimated errors: the spread of four batches would make the
    # mean square three.
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=4, height=4, scale=1.6)
    way = rw.ProgressivePhotonMap(200)
    images = [picture(caustic, look, way, samples, seed=seed) for seed in range(24)]
    light = np.array([image.rgb[..., 0].astype(float) for image in images])
    told = np.array([image.standard_error[..., 0].astype(float) for image in images])
    off = (light - light.mean(0)) / told * math.sqrt(24 / 23)
    # Sixteen batches or more: 15/13 of one at most, for Student's t of 15 degrees. Pixels of one picture
    # share their maps; the mean of 24 such squares is off by a half in less than one of 10,000 cases.
    assert np.mean(off**2) < 15 / 13 + 0.5


def test_bias_has_an_error_of_its_own(caustic):
    # One pixel with few photons: its estimated bias is mostly noise, and its error says so.
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=1, height=1, scale=1e-3)
    way = rw.ProgressivePhotonMap(3000)
    images = [picture(caustic, look, way, 32, seed=seed) for seed in range(40)]
    assert all(image.bias_error.shape == (1, 1, 3) for image in images)
    told = np.array([float(image.bias.mean()) for image in images])
    errors = np.array([float(image.bias_error.mean()) for image in images])
    # The true bias is -0.04 of a light of 1 / (2 pi), by the law of the radius.
    off = told + 0.04 / (2 * math.pi)
    # In groups of eight, five standard errors are exceeded once in 600 times. The estimated and the true
    # spread of forty pictures agree to a third, four standard deviations of their ratio.
    assert (np.abs(off) < 5 * errors).mean() > 0.9
    assert 0.6 < np.sqrt(np.mean(errors**2)) / told.std(ddof=1) < 1.6
    assert abs(off.mean()) < 5 * told.std(ddof=1) / math.sqrt(len(told))


def test_standard_errors_hold_for_what_maps_tend_to(caustic):
    # Many seeds estimate the expectation. Intervals of 95 % hold it in 93 to 97 % of pixels over all
    # pictures: pixels of one picture share their maps, so that many pictures are needed.
    look = rw.Orthographic((0, 0, 0.4), (0, 0, 0), up=(0, 1, 0), width=6, height=6, scale=1.6)
    way = rw.PhotonMap(300, k_nearest=None, radius=0.5, final_gather=0)
    options = {"sampler": rw.rendering.Independent(), "progress": False}
    images = [rw.render(caustic, look, way, 32, seed=seed, **options) for seed in range(100)]
    truth = np.mean([image.rgb.astype(float) for image in images], 0)
    held = []
    for image in images:
        low, high = image.interval()
        held.append((low <= truth) & (truth <= high))
    assert 0.93 < np.mean(held) < 0.97


def test_a_lamp_and_an_eye_both_behind_glass():
    shapes, lamp = behind_glass()
    look = rw.Camera((0, -3.5, 1.2), (0, 0, 0.1), up=(0, 0, 1), fov=25, width=SIDE, height=SIDE)
    # Paths find a lamp of this size by chance, if there are many.
    scene = rw.Scene([*shapes, lamp])
    truth = picture(scene, look, rw.Path(reuse=1, guiding="photons"), 1024)
    # Light held by total reflection would need thousands of bounces.
    assert_agree(scene, look, rw.PhotonMap(8000, final_gather=0, max_depth=40), truth, blur=0.06)
    # They cannot reach a point light in glass; photons see the same as before.
    point = rw.Scene(shapes, lights=[rw.PointLight((0, 0, 1.2), 1.0)])
    assert picture(point, look, rw.Path(), 16).rgb.max() == 0
    seen = picture(point, look, rw.ProgressivePhotonMap(8000, max_depth=40), 8)
    assert (seen.rgb[8] > 0).mean() > 0.5


def test_what_moves_is_lit_at_its_time():
    # A white board passes a lamp behind a pane, while the shutter is open. Photons and the camera must use
    # the same time for the board and its light, or it would not lie in its own light.
    start, end = np.eye(4), np.eye(4)
    start[:3, 3], end[:3, 3] = (-0.6, 0, 0.2), (0.6, 0, 0.2)
    board = rw.Instance(square(0.3, 0.0, material=rw.Diffuse(0.8)), start, transform_end=end)
    floor = square(1.5, 0.0, material=rw.Diffuse(0.4))
    pane = square(2.0, 0.8, material=rw.Dielectric(1.5))
    lamp = square(0.25, 1.2, up=False, material=rw.Diffuse(0), emission=8)
    look = rw.Camera(
        (0, -2.5, 0.7), (0, 0, 0), up=(0, 0, 1), fov=30, width=SIDE, height=SIDE, shutter=(0.0, 1.0)
    )
    scene = rw.Scene([floor, board, pane, lamp])
    truth = picture(scene, look, rw.LightTraced(), 1024)
    assert_agree(scene, look, rw.PhotonMap(3000, final_gather=0), truth, samples=16, blur=0.06)


@pytest.mark.parametrize(
    "way",
    [
        rw.PhotonMap(4000, k_nearest=None, radius=0.2, final_gather=0),
        rw.PhotonMap(4000, caustic=False),
        rw.ProgressivePhotonMap(4000, 0.2),
        rw.Bidirectional(vertex_merging=True, radius=0.2),
    ],
    ids=lambda way: type(way).__name__,
)
def test_gold_at_both_ends_gives_no_more_than_there_is(way):
    # Gold reflects more red than Rec. 709 can represent. All gold on a path is clipped to that, except at the
    # vertex nearest to the eye, where photons meet paths, too. A floor seen in gold, and lit by way of gold,
    # has the color of paths: it hardly depends on angles, and so hardly has noise.
    floor = square(1.5, 0.0, material=rw.Diffuse(0.5))
    gold = rw.Mesh(
        [(1.2, -2, 0), (1.2, 2, 0), (1.2, 2, 3), (1.2, -2, 3)],
        [(0, 2, 1), (0, 3, 2)],
        material=rw.Conductor("Au"),
    )
    # It emits towards the mirror alone, and the floor behind it is visible.
    lamp = rw.Mesh(
        [(0, -0.3, 1.2), (0, 0.3, 1.2), (0, 0.3, 1.8), (0, -0.3, 1.8)],
        [(0, 1, 2), (0, 2, 3)],
        material=rw.Diffuse(0),
        emission=20,
    )
    scene = rw.Scene([floor, gold, lamp])
    look = rw.Camera((0, -1, 1), (3.0, 0, 0), up=(0, 0, 1), fov=8, width=8, height=8)
    tints = []
    for one, samples in ((way, 32), (rw.Path(reuse=1, guiding="none"), 1024)):
        red, green, blue = picture(scene, look, one, samples).rgb.astype(float).mean((0, 1))
        assert red > 1.5 * blue > 0
        tints.append(red / green)
    assert abs(tints[0] / tints[1] - 1) < 0.002


LIGHTS = {
    "point": ([], {"lights": [rw.PointLight((0, 0, 1.5), 4)]}),
    "spot": ([], {"lights": [rw.SpotLight((0.3, 0, 1.5), (0, 0, 0), 8, angle=40, falloff=10)]}),
    "sun": ([], {"lights": [rw.DirectionalLight((0.2, 0.1, -1), 3)]}),
    "sky": ([], {"environment": rw.ConstantEnvironment((0.5, 0.7, 1.0))}),
    "copies": (
        [
            rw.Instance(
                square(0.1, 0.0, up=False, material=rw.Diffuse(0), emission=20),
                [[[1, 0, 0, x], [0, 1, 0, 0], [0, 0, 1, 1.4], [0, 0, 0, 1]] for x in (-0.5, 0.5)],
            )
        ],
        {},
    ),
}


@pytest.mark.parametrize("name", LIGHTS)
def test_any_light_comes_through_glass(name):
    # Light tracing finds it, too, where the camera sees the floor directly: without a map.
    shapes, lights = LIGHTS[name]
    floor = square(1.5, 0.0, material=rw.Diffuse((0.7, 0.5, 0.3)))
    glass = rw.Sphere((0, 0, 0.7), 0.4, material=rw.Dielectric(1.5))
    scene = rw.Scene([floor, glass, *shapes], **lights)
    below = rw.Camera((0.9, 0, 0.35), (0.1, 0, 0), up=(0, 0, 1), fov=30, width=SIDE, height=SIDE)
    truth = picture(scene, below, rw.LightTraced(), 1024)
    assert_agree(scene, below, rw.PhotonMap(6000, k_nearest=30, final_gather=0), truth, blur=0.08)


def test_bits_go_by_the_seed_alone(tmp_path):
    scene, look = rw.scenes.cornell_box(width=12, height=10)
    for way in (rw.PhotonMap(3000, maps=2), rw.ProgressivePhotonMap(3000)):
        options = {"samples": 20, "seed": 5, "progress": False}
        one = rw.render(scene, look, way, threads=1, **options)
        # Photon maps kept with a scene make no difference.
        fresh, _ = rw.scenes.cornell_box(width=12, height=10)
        two = rw.render(fresh, look, way, threads=2, **options)
        assert np.array_equal(one.rgb, two.rgb)
        assert np.array_equal(one.standard_error, two.standard_error)
        assert np.array_equal(one.bias, two.bias)
        name = tmp_path / type(way).__name__
        rw.render(scene, look, way, 7, seed=5, checkpoint=name, sampler=one.plan.sampler, progress=False)
        later = rw.render(fresh, look, way, checkpoint=name, **options)
        assert np.array_equal(later.rgb, one.rgb)
        assert np.array_equal(later.bias, one.bias)
        assert not np.array_equal(rw.render(scene, look, way, 20, seed=6, progress=False).rgb, one.rgb)


@pytest.mark.parametrize(("side", "photons"), [(8, 20_000), (80, 25_600)])
def test_as_many_photons_as_suit_the_picture(side, photons):
    scene, look = rw.scenes.cornell_box(width=side, height=side)
    chosen, told = (picture(scene, look, rw.ProgressivePhotonMap(count), 1) for count in (None, photons))
    assert np.array_equal(chosen.rgb, told.rgb)


@pytest.mark.parametrize("kind", [rw.ProgressivePhotonMap, rw.PhotonMap])
def test_glass_is_followed_both_ways(kind):
    # A pane before a lamp, seen straight: (1 - R) / (1 + R) of it, R = 0.04. Paths split into reflection and
    # refraction at three surfaces, so that 0.16 % is left to chance; by chance alone a sample is all or
    # nothing.
    pane = rw.Box((-3, -3, 0), (3, 3, 0.2), material=rw.Dielectric(1.5))
    shining = square(50, -2, material=rw.Diffuse(0), emission=1.0)
    look = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), fov=2, width=SIDE, height=SIDE)
    seen = picture(rw.Scene([pane, shining]), look, kind(100, roulette_depth=99), 4)
    np.testing.assert_allclose(seen.rgb, 0.96 / 1.04, atol=0.0016)


def test_workers_make_the_same_maps():
    scene, look = rw.scenes.cornell_box(width=12, height=10)
    way = rw.PhotonMap(3000, k_nearest=20)
    here = picture(scene, look, way, 20)
    with ProcessPoolExecutor(2) as executor:
        there = picture(scene, look, way, 20, executor=executor)
    assert np.array_equal(here.rgb, there.rgb)
    assert np.array_equal(here.bias, there.bias)


def test_error_and_seconds_end_it():
    # Uniform light has a trusted error after few samples.
    shines = rw.Emission(1, side="back")
    room = rw.Scene(rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(0.7), emission=shines))
    within = rw.Camera((0, 0, 0.5), (0, 0, -1), fov=60, width=8, height=8)
    image = rw.render(room, within, rw.ProgressivePhotonMap(1000), error=0.01, progress=False)
    assert image.error.high <= 0.01
    assert image.samples >= 16
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    assert rw.render(scene, look, rw.ProgressivePhotonMap(3000), seconds=0.2, progress=False).samples > 0


def test_scenes_without_photons_have_pictures():
    look = rw.Camera((0, -3, 0.5), (0, 0, 0.5), up=(0, 0, 1), fov=40, width=6, height=6)
    sky = rw.ConstantEnvironment((0.2, 0.3, 0.4))
    mirrors = rw.Scene(square(3.0, 0.0, material=rw.Mirror(1.0)), environment=sky)
    dark = rw.Scene(square(3.0, 0.0, material=rw.Diffuse(0.5)))
    lit = rw.Scene(square(3.0, 0.0, material=rw.Diffuse(0.5)), environment=sky)
    for way in (rw.PhotonMap(1000), rw.PhotonMap(1000, final_gather=0), rw.ProgressivePhotonMap(1000)):
        # Without matt surfaces nothing is gathered, and the picture is exact.
        np.testing.assert_allclose(picture(mirrors, look, way, 2).rgb[..., 1], 0.3, rtol=1e-6)
        assert picture(dark, look, way, 2).rgb.max() == 0
        # A single floor has no interreflection: direct light is all.
        seen, paths = picture(lit, look, way, 64), picture(lit, look, rw.Path(), 64)
        np.testing.assert_allclose(seen.rgb.mean((0, 1)), paths.rgb.mean((0, 1)), rtol=0.02)
        assert seen.bias.max() == 0
        assert picture(lit, look, type(way)(1000, max_depth=0), 2).rgb[-1].max() == 0
    assert paths.bias is None
    assert not paths.biased


def test_what_cannot_be_is_refused_in_one_line():
    for kind in (rw.PhotonMap, rw.ProgressivePhotonMap):
        for arguments, error, words in [
            ({"photons": 0}, ValueError, "photons must be between 1 and"),
            ({"photons": 1.5}, TypeError, "photons must be an integer"),
            ({"radius": 0}, ValueError, "radius must be greater than 0"),
            ({"final_gather": -1}, ValueError, "final_gather must be between 0 and"),
            ({"filter": "gauss"}, ValueError, "filter must be one of 'box', 'cone', 'epanechnikov'"),
            ({"max_depth": -1}, ValueError, "max_depth must be"),
            ({"roulette_depth": -1}, ValueError, "roulette_depth must be"),
        ]:
            with pytest.raises(error, match=words):
                kind(**arguments)
    for kind, arguments, error, words in [
        (rw.PhotonMap, {"k_nearest": 1}, ValueError, "k_nearest must be between 2 and"),
        (rw.PhotonMap, {"maps": 0}, ValueError, "maps must be between 1 and"),
        (rw.PhotonMap, {"caustic": 1}, TypeError, "caustic must be True or False"),
        (rw.ProgressivePhotonMap, {"alpha": 0}, ValueError, "alpha must be above 0"),
        (rw.ProgressivePhotonMap, {"alpha": 1.5}, ValueError, "alpha must be above 0"),
    ]:
        with pytest.raises(error, match=words):
            kind(**arguments)
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    with pytest.raises(ValueError, match="cannot be adaptive"):
        rw.render(scene, look, rw.PhotonMap(100), 4, adaptive=True, progress=False)
    endless = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1))], environment=rw.ConstantEnvironment(1))
    with pytest.raises(ValueError, match="and photons cannot start there: use Path"):
        rw.render(endless, look, rw.ProgressivePhotonMap(100), 4, progress=False)


def test_it_is_a_value():
    way = rw.PhotonMap(1000, k_nearest=None, filter="cone")
    assert pickle.loads(pickle.dumps(way)) == way != rw.PhotonMap()
    assert "filter='cone'" in repr(way)
    scene, look = rw.scenes.cornell_box(width=4, height=4)
    image = picture(scene, look, rw.PhotonMap(500), 2)
    again = pickle.loads(pickle.dumps(image))
    assert again == image
    assert not again.bias.flags.writeable


@pytest.mark.parametrize("among", [False, True], ids=["in air", "in a thin medium"])
@pytest.mark.parametrize(
    "coated",
    [
        rw.Mix(rw.Diffuse(0.5), rw.Mirror(), 0.5),
        rw.Plastic(0.5, ior=1.87),
        rw.MetallicRough((0.5, 0.5, 0.5), 0.0, 0.0),
    ],
    ids=lambda coated: type(coated).__name__,
)
@pytest.mark.parametrize(
    "way",
    [
        rw.ProgressivePhotonMap(photons=1000),
        rw.PhotonMap(photons=1000, final_gather=0),
        rw.PhotonMap(photons=1000),
    ],
    ids=["progressive", "seen at once", "looked about"],
)
def test_what_a_coat_reflects_is_not_lost(way, coated, among):
    """Of what is reflected in a single direction nothing is known from photons: it has to be followed."""
    shapes = [rw.Sphere((0, 0, 0), 0.8, material=coated)]
    if among:
        shapes.append(rw.Sphere((0, 0, 0), 2, material=rw.MediumInterface(rw.Homogeneous(1e-6, 0))))
    scene, camera = (
        rw.Scene(shapes, environment=1.0),
        rw.Camera((0, 0, 4), (0, 0, 0), fov=22, width=4, height=4),
    )
    wanted = rw.render(scene, camera, rw.Path(), samples=256, progress=False)
    found = rw.render(scene, camera, way, samples=256, progress=False)
    # Photon estimates of even light are not exact: their rings end at the ball's rim.
    assert found.rgb.mean() == pytest.approx(wanted.rgb.mean(), rel=0.01)
