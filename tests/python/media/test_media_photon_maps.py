"""Photon maps among media: closed forms, the light of path tracing, caustics in haze, and bias."""

import math

import media_scenes as media
import numpy as np
import pytest
from light_pictures import assert_agree, lamp, square
from media_references import kept

import raywright as rw

SIDE = 16
slow = pytest.mark.slow
SKY = rw.ConstantEnvironment(1.0)
FLOOR = square(1.5, 0.0, material=rw.Diffuse((0.7, 0.5, 0.3)))


def camera(at=(2.2, -1.6, 1.6), target=(0, 0, 0.4), fov=40):
    return rw.Camera(at, target, up=(0, 0, 1), fov=fov, width=SIDE, height=SIDE)


def haze(absorption=0.1, scattering=0.8, g=0.3, material=rw.MediumInterface):
    medium = rw.Homogeneous(absorption, scattering, rw.HenyeyGreenstein(g))
    return rw.Box((-1.4, -1.4, -0.1), (1.4, 1.4, 1.2), material=material(medium))


def cloud():
    x, y, z = np.mgrid[-1:1:8j, -1:1:8j, -1:1:8j]
    bounds = [(-0.9, -0.9, 0.1), (0.9, 0.9, 1.3)]
    density = np.clip(1.3 - x**2 - y**2 - z**2 + 0.4 * np.sin(7 * x), 0, None)
    grid = rw.GridMedium(density, bounds, absorption=0.2, scattering=(2.0, 1.5, 1.0))
    return rw.Box(*bounds, material=rw.MediumInterface(grid))


LAMP = lamp(1.6, 0.4)
MILK = rw.Dielectric(1.33, interior=rw.Homogeneous((0.1, 0.2, 0.4), 4.0))
SCENES = {
    "haze": rw.Scene([FLOOR, LAMP, haze()]),
    "cloud": rw.Scene([FLOOR, LAMP, cloud()]),
    "milk": rw.Scene([FLOOR, LAMP, rw.Sphere((0, 0, 0.6), 0.5, material=MILK)]),
    # By wavelength: glass that disperses, in haze that scatters blue light most.
    "colors": rw.Scene(
        [
            FLOOR,
            LAMP,
            haze(0.1, rw.Spectrum([360, 830], [1.4, 0.3])),
            rw.Sphere((0, 0, 0.6), 0.35, material=rw.Dielectric(rw.materials.Cauchy(1.5, 0.02))),
        ]
    ),
    "tinted": rw.Scene(
        [
            FLOOR,
            # So large that its image in the ball is not bright.
            lamp(1.8, 2.0, 1.0),
            rw.Sphere(
                (0, 0, 0.6), 0.5, material=rw.Dielectric(1.5, transmittance=(0.3, 0.9, 0.5), distance=0.5)
            ),
        ]
    ),
}
MAPS = {
    "nearest": rw.PhotonMap(8000, final_gather=0),
    "gathered": rw.PhotonMap(8000, k_nearest=40),
    "fixed": rw.PhotonMap(8000, k_nearest=None, radius=0.12, final_gather=0, filter="epanechnikov"),
    "progressive": rw.ProgressivePhotonMap(8000),
}


# Each scene is seen by one map, and by all where there is time. The haze's is that of the depths below.
QUICK = {
    ("cloud", "progressive"),
    ("milk", "gathered"),
    ("tinted", "fixed"),
    ("colors", "progressive"),
}
EACH = [
    pytest.param(name, way, marks=() if (name, way) in QUICK else slow, id=f"{name}-{way}")
    for name in SCENES
    for way in MAPS
]


@pytest.mark.parametrize(("name", "way"), EACH)
def test_pictures_are_those_of_paths(name, way):
    # For a progressive map most of the tolerance is its bias.
    samples = 4 if way == "progressive" else 8
    assert_agree(SCENES[name], camera(), MAPS[way], kept(f"maps: {name}"), samples=samples, blur=0.06)


@pytest.mark.parametrize("depth", [1, pytest.param(2, marks=slow)])
def test_depths_count_what_scatters(depth):
    scene, look = SCENES["haze"], camera()
    truth = rw.render(scene, look, rw.Path(depth), 256, progress=False)
    assert_agree(scene, look, rw.PhotonMap(8000, final_gather=0, max_depth=depth), truth, blur=0.06)


@slow
def test_a_caustic_in_haze_is_that_of_light_tracing():
    # No path finds a point light behind a ball of glass.
    glass = rw.Sphere((0, 0, 1.4), 0.3, material=rw.Dielectric(1.5))
    spot = rw.SpotLight((0, 0, 2.6), (0, 0, 0), 30.0, angle=12, falloff=2)
    scene = rw.Scene([FLOOR, glass, haze(0.05, 0.4)], lights=[spot])
    look = camera(at=(2.4, -1.2, 0.8), target=(0, 0, 0.6), fov=25)
    truth = rw.render(scene, look, rw.LightTraced(), 512, progress=False)
    assert truth.rgb[4:12, 6:10].mean() > 3 * rw.render(scene, look, rw.Path(), 8, progress=False).rgb.min()
    assert_agree(scene, look, rw.PhotonMap(10_000, k_nearest=40, final_gather=0), truth, blur=0.08)


def tank(medium, reflectance=0.0):
    """A medium between mirrors over ground, its surface at the height 0: as a slab without end."""
    walls = []
    corners = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        points = [(ax, ay, -1.0), (bx, by, -1.0), (bx, by, 0.0), (ax, ay, 0.0)]
        walls.append(rw.Mesh(points, [(0, 1, 2), (0, 2, 3)], material=rw.Mirror(1.0)))
    box = rw.Box((-0.501, -0.501, -1), (0.501, 0.501, 0), material=rw.MediumInterface(medium))
    return rw.Scene([*walls, box, square(0.6, -1.0, material=rw.Diffuse(reflectance))], environment=SKY)


def told(scene, look, way, samples, seeds=6):
    """Mean of pictures of other seeds, and its standard error."""
    means = [
        rw.render(scene, look, way, samples, seed=seed, progress=False).rgb[..., 1].mean(dtype=float)
        for seed in range(seeds)
    ]
    return np.mean(means), np.std(means, ddof=1) / math.sqrt(seeds)


def test_a_slab_reflects_what_discrete_ordinates_say():
    # Optical depth 1, albedo 0.5: seen straight from above, under an even sky.
    scene = tank(media.of_depth(1.0, 0.5))
    look = rw.Orthographic((0, 0, 0.5), (0, 0, -1), up=(0, 1, 0), width=8, height=8, scale=0.9)
    mean, error = told(scene, look, rw.ProgressivePhotonMap(4000), 32)
    assert error < 0.01 * mean
    # Light is less even near the surface, where a little bias remains. Over six, five standard errors are
    # exceeded once in 250 times.
    assert abs(mean - 0.0991191855366) < 5 * error + 0.01 * mean


@pytest.mark.parametrize("way", ["nearest", "progressive"])
def test_nobody_sees_a_white_ball_in_even_light(way):
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(media.of_depth(2.0, 1.0)))
    scene = rw.Scene([ball], environment=SKY)
    look = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=1.2, width=8, height=8)
    mean, error = told(scene, look, MAPS[way], 8)
    assert error < 0.01
    assert abs(mean - 1) < 5 * error + 0.01


def test_bias_is_told():
    # Near a lamp in dense fog, light falls off within the radius of balls: their mean is brighter.
    fog = rw.Homogeneous(2.0, 2.0)
    scene = rw.Scene([], lights=[rw.PointLight((0, 0, 0), 1.0)], medium=fog)
    look = rw.Orthographic((0.5, 0, 0), (0.5, 0, -1), up=(0, 1, 0), scale=0.05, width=8, height=8)
    truth = rw.render(scene, look, rw.Path(), 512, progress=False).rgb.mean(dtype=float)
    images = [
        rw.render(
            scene, look, rw.PhotonMap(20_000, k_nearest=None, radius=0.25), 8, seed=seed, progress=False
        )
        for seed in range(4)
    ]
    found = [image.rgb.mean(dtype=float) for image in images]
    bias = np.mean([image.bias.mean(dtype=float) for image in images])
    error = np.std(found, ddof=1) / 2
    assert error < 0.02 * truth
    off = np.mean(found) - truth
    assert off > 0.1 * truth
    # The bias estimate compares three radii, with ever fewer photons: it is good to about a sixth.
    assert abs(bias - off) < 0.5 * off + 3 * error


def test_bits_go_by_the_seed_alone():
    for way in (rw.PhotonMap(2000, maps=2), rw.ProgressivePhotonMap(2000)):
        one, two = (
            rw.render(SCENES["cloud"], camera(), way, 16, threads=threads, seed=3, progress=False)
            for threads in (1, 2)
        )
        np.testing.assert_array_equal(one.rgb, two.rgb)
        np.testing.assert_array_equal(one.bias, two.bias)
