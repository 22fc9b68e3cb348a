"""Light among media by paths from lights and from both ends: closed forms, and pictures of path tracing."""

import math

import media_scenes as media
import numpy as np
import pytest
from light_pictures import SIDE, assert_same, blocks, camera, lamp, square
from media_references import kept

import raywright as rw

SKY = rw.ConstantEnvironment(1.0)
WAYS = {"traced": (rw.LightTraced, 96), "both": (rw.Bidirectional, 16)}
# Few paths from the lamp get through rough glass twice.
RARE = {("milk", "traced"): 384}
slow = pytest.mark.slow


def smoke(absorption=0.1, scattering=0.6, g=0.5, low=(-2, -2, 0), high=(2, 2, 1.5), **kwargs):
    medium = rw.Homogeneous(absorption, scattering, rw.HenyeyGreenstein(g))
    return rw.Box(low, high, material=rw.MediumInterface(medium), **kwargs)


def swirl():
    x, y, z = np.mgrid[-1:1:12j, -1:1:12j, -1:1:12j]
    density = np.clip(1.2 - x**2 - y**2 - z**2 + 0.6 * np.sin(7 * x + 3 * y), 0, None)
    bounds = [(-1, -1, 0.2), (1, 1, 1.6)]
    cloud = rw.GridMedium(density, bounds, absorption=(0.1, 0.3, 0.5), scattering=(1.5, 1.2, 0.6))
    return rw.Box(*bounds, material=rw.MediumInterface(cloud))


def stained():
    """A cloud whose colors get very far apart, so that what decides how far light gets does too."""
    density = np.random.default_rng(3).uniform(0, 1, (6, 6, 6))
    bounds = [(-1, -1, 0.2), (1, 1, 1.2)]
    cloud = rw.GridMedium(density, bounds, absorption=(6.0, 1.0, 0.1), scattering=(0.6, 0.3, 0.1))
    return rw.Box(*bounds, material=rw.MediumInterface(cloud))


FLOOR = square(3, 0, material=rw.Diffuse((0.7, 0.6, 0.5)))
MILK = rw.Dielectric(1.33, roughness=0.4, interior=rw.Homogeneous((0.1, 0.2, 0.4), 3.0))
SCENES = {
    "smoke": rw.Scene([FLOOR, lamp(), smoke()]),
    "colored": rw.Scene([FLOOR, lamp(), smoke((0.1, 0.2, 0.4), (1.2, 0.6, 0.3), -0.3)]),
    "cloud": rw.Scene([FLOOR, lamp(size=1.0), swirl()]),
    "stained": rw.Scene([FLOOR, lamp(size=1.0), stained()]),
    "milk": rw.Scene([FLOOR, lamp(), rw.Sphere((0, 0, 0.7), 0.6, material=MILK)]),
    "fog": rw.Scene([FLOOR, rw.Sphere((0, 0, 0.6), 0.5)], lights=[rw.PointLight((0.5, 0.2, 2), 6)],
                    medium=rw.Homogeneous(0.05, 0.15)),
    "sun": rw.Scene([FLOOR, smoke()], lights=[rw.DirectionalLight((0.3, 0.2, -1), (2, 1, 1))]),
    "sky": rw.Scene([FLOOR, smoke()], environment=rw.ConstantEnvironment((0.5, 0.7, 1.0))),
    "lamp within": rw.Scene([FLOOR, smoke(), rw.Sphere((0, 0, 0.8), 0.15, emission=20)]),
    "veiled": rw.Scene([FLOOR, lamp(), smoke(), square(0.8, 1.0, material=rw.Mask(rw.Diffuse(0.7), 0.5))]),
}  # fmt: skip


# Each scene is seen in one way, and in both where there is time.
QUICK = {
    "traced": ("smoke", "stained", "sun"),
    "both": ("colored", "stained", "milk", "fog", "sky", "lamp within", "veiled"),
}
EACH = [
    pytest.param(name, way, marks=() if name in QUICK[way] else slow, id=f"{name}-{way}")
    for way in WAYS
    for name in SCENES
]


def assert_kept(name, scene, look, kind, samples):
    """As `light_pictures.assert_same`, with a picture of paths that is kept and hardly errs."""
    ours, theirs = rw.render(scene, look, kind, samples, progress=False), kept(f"ends: {name}")
    expected = blocks(theirs.rgb)
    error = np.hypot(*(np.sqrt(blocks(one.standard_error.astype(float) ** 2) / 64) for one in (ours, theirs)))
    off = np.abs(blocks(ours.rgb) - expected) / (error + 1e-6 * expected + 1e-12)
    # Exceeded by chance once in two million.
    assert off.max() < 5, off.round(1)
    assert np.median(error / (expected + 1e-12)) < 0.1


@pytest.mark.parametrize(("name", "way"), EACH)
def test_pictures_are_those_of_paths(name, way):
    kind, samples = WAYS[way]
    assert_kept(name, SCENES[name], camera(), kind(), RARE.get((name, way), samples))


@pytest.mark.parametrize("depth", [0, 1, 2, pytest.param(3, marks=slow)])
@pytest.mark.parametrize("way", WAYS)
def test_depths_count_what_scatters(depth, way):
    kind, samples = WAYS[way]
    look = camera(target=(0, 0, 0.8))
    if depth == 0:
        ours, theirs = (
            rw.render(SCENES["lamp within"], look, *one, progress=False)
            for one in ((kind(0), samples), (rw.Path(0), 64))
        )
        np.testing.assert_allclose(ours.rgb.mean((0, 1)), theirs.rgb.mean((0, 1)), rtol=0.1)
    else:
        assert_kept(f"depth {depth}", SCENES["lamp within"], look, kind(depth), samples)


@slow
@pytest.mark.parametrize(
    "look",
    [
        rw.ThinLens(
            (0.4, 0.6, 0.9),
            (0.4, 0.4, 0),
            fov=60,
            width=SIDE,
            height=SIDE,
            aperture_radius=0.1,
            focus_distance=1.0,
        ),
        rw.Orthographic((0.5, 0.5, 2.4), (0.5, 0.4, 0), scale=1.1, width=SIDE, height=SIDE),
        rw.Panorama((0.4, 0.6, 0.9), (0.4, 0.4, 0), width=SIDE, height=SIDE),
    ],
    ids=lambda look: type(look).__name__,
)
def test_cameras_within_and_without(look):
    assert_same(SCENES["smoke"], look, (rw.Bidirectional(), 32), (rw.Path(), 128))


@pytest.mark.parametrize("way", WAYS)
def test_a_ball_that_scatters_and_absorbs(way):
    # Optical radius 1, albedo 0.5, solved as an integral equation: the lost share of the sky's light.
    kind, samples = WAYS[way]
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(media.of_depth(1.0, 0.5)))
    scene = rw.Scene([ball], environment=SKY)
    disk = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=2.0, width=48, height=48)
    image = rw.render(scene, disk, kind(), samples // 3 + 8, progress=False)
    mean, share = image.rgb[..., 1].mean(dtype=float), math.pi / 4
    error = math.sqrt((image.standard_error[..., 1].astype(float) ** 2).sum()) / 48**2
    assert error < 0.002
    assert abs(mean - (1 - share * 0.457742891)) < 3 * error


@pytest.mark.parametrize(("way", "g"), [("traced", 0.0), ("both", 0.0), ("both", 0.9)])
def test_nobody_sees_a_white_ball_in_even_light(way, g):
    kind, samples = WAYS[way]
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(media.of_depth(1.0, 1.0, g)))
    scene = rw.Scene([ball], environment=SKY)
    look = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=1.2, width=24, height=24)
    image = rw.render(scene, look, kind(), samples, progress=False)
    mean = image.rgb[..., 1].mean(dtype=float)
    error = math.sqrt((image.standard_error[..., 1].astype(float) ** 2).sum()) / 24**2
    assert error < 0.01
    assert abs(mean - 1) < 3 * error


@pytest.mark.parametrize("name", ["above", "below"])
def test_slabs_reflect_and_let_through_what_discrete_ordinates_say(name):
    # Optical depth 1, albedo 0.5, isotropic, under an even sky and over black.
    below, expected = {"above": (False, 0.149753839073), "below": (True, 0.23028520169)}[name]
    box = rw.Box((-40, -40, -1), (40, 40, 0), material=rw.MediumInterface(media.of_depth(1.0, 0.5)))
    black = square(40, -2.0, material=rw.Diffuse(0.0))
    scene = rw.Scene([box, black], environment=SKY)
    look = media.looking(0.5, below=below, distance=3.0 if below else 0.5, side=8)
    media.assert_seen(scene, look, 256, expected, rw.Bidirectional(), most=0.01)


def test_light_that_is_scattered_once():
    # Chandrasekhar 1960: the sun's irradiance is pi across its rays.
    sun = rw.DirectionalLight((math.sqrt(0.75), 0, -0.5), math.pi)
    box = rw.Box((-40, -40, -1), (40, 40, 0), material=rw.MediumInterface(media.of_depth(2.0, 0.9, 0.75)))
    look = media.looking(0.5, azimuth=60.0 + 180)
    media.assert_seen(
        rw.Scene([box], lights=[sun]), look, 512, 0.0305162257168885, rw.Bidirectional(1), most=0.004
    )


def test_what_glows_is_found_from_the_camera():
    gas = rw.Homogeneous(0.3, 0.5, emission=(0.5, 0.3, 0.1))
    scene = rw.Scene([FLOOR, lamp(), rw.Sphere((0, 0, 0.8), 0.6, material=rw.MediumInterface(gas))])
    assert_same(scene, camera(), (rw.Bidirectional(), 24), (rw.Path(), 128))


@pytest.mark.parametrize("name", ["smoke", "milk", "veiled"])
def test_walks_are_merged_among_media(name):
    # So small a disk hardly blurs anything.
    merged = rw.Bidirectional(vertex_merging=True, radius=0.05, photons=3000)
    assert_same(SCENES[name], camera(), (merged, 24), (rw.Path(), 128))


def test_bits_are_those_of_any_threads():
    for kind, _ in WAYS.values():
        one, two = (
            rw.render(SCENES["cloud"], camera(side=8), kind(), 16, threads=threads, progress=False)
            for threads in (1, 2)
        )
        np.testing.assert_array_equal(one.rgb, two.rgb)
