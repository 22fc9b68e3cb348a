"""Curved shapes, copies and lights of all kinds at any size and place give what they give at the origin.

Means are within five of their standard errors of closed forms, which chance exceeds once in two million.
"""

import math

import numpy as np
import pytest

import raywright as rw

SIZES = [1e-6, 1e-3, 1e3, 1e6]
PLACES = [1e3, 1e4, 1e5, 1e6, 1e7]
MOVES = [(size, 0.0) for size in SIZES] + [(1.0, place) for place in PLACES]


def mean(image):
    """Mean of the green channel, and its standard error."""
    assert np.isfinite(image.rgb).all()
    assert not image.warnings
    count = image.rgb.shape[0] * image.rgb.shape[1]
    variances = np.square(image.standard_error[..., 1].astype(float))
    return float(image.rgb[..., 1].mean(dtype=float)), math.sqrt(float(variances.sum())) / count


def assert_mean(image, expected, slack=1e-5):
    value, error = mean(image)
    assert abs(value - expected) <= 5 * error + slack * expected, f"{value} ± {error}, not {expected}"
    assert error <= 0.005 * expected


class Moved:
    """Makes things of the unit scene larger, and moves them."""

    def __init__(self, size, place):
        self.size, self.place = size, np.array([place, -place, 0.5 * place])

    def __call__(self, *point):
        return np.array(point) * self.size + self.place

    def camera(self):
        """Looks at the floor's origin from the side, past what stands above it."""
        return rw.Camera(self(3, 0, 0.5), self(0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)

    def floor(self):
        return rw.Disk(self(0, 0, 0), (0, 0, 1), 2 * self.size, material=rw.Diffuse(0.8))


@pytest.mark.parametrize(("size", "place"), MOVES)
def test_a_curved_lamp_and_its_shadow(size, place):
    # A sphere of radius 0.5 and radiance 3 at height 2, E = π L (R/d)², which hides the same share of a sky
    # of 0.5.
    at = Moved(size, place)
    lamp = rw.Sphere(at(0, 0, 2), 0.5 * size, material=rw.Diffuse(0), emission=3)
    scene = rw.Scene([at.floor(), lamp], environment=0.5, precision="double")
    image = rw.render(scene, at.camera(), rw.Path(max_depth=1), samples=256, progress=False)
    assert_mean(image, 0.8 * (3 / 16 + 0.5 * (1 - 1 / 16)), slack=1e-4)


@pytest.mark.parametrize(("size", "place"), MOVES)
def test_lights_without_extent(size, place):
    # Lights with an inverse square law must be this much stronger; directions and sky need not.
    at = Moved(size, place)
    lights = [
        rw.PointLight(at(0, 0, 2), 4 * size**2),
        rw.SpotLight(at(0, 0, 1), at(0, 0, 0), 3 * size**2, angle=20),
        rw.DirectionalLight((0, -3, -4), 5),
    ]
    # A ball between the floor and another point light.
    ball = rw.Sphere(at(0, 2, 2), 0.25 * size)
    hidden = rw.PointLight(at(0, 4, 4), 4 * size**2)
    scene = rw.Scene([at.floor(), ball], lights=[*lights, hidden], precision="double")
    image = rw.render(scene, at.camera(), rw.Direct(light_samples=16), samples=64, progress=False)
    assert_mean(image, 0.8 / math.pi * (1 + 3 + 4), slack=1e-4)


@pytest.mark.parametrize(("size", "place"), MOVES)
def test_copies_of_a_room(box, size, place):
    # A room of a millionth, scaled and placed as a copy: 1 / (1 - 0.5).
    vertices = (np.asarray(box.vertices) - 0.5) * 1e-6
    walls = rw.Mesh(vertices, np.asarray(box.faces)[:, ::-1], material=rw.Diffuse(0.5), emission=1)
    matrix = np.diag([1e6 * size, 1e6 * size, 1e6 * size, 1])
    matrix[:3, 3] = Moved(size, place).place
    camera = rw.Camera(
        matrix[:3, 3], matrix[:3, 3] + size * np.array([0.2, 0.1, -1]), fov=80, width=8, height=8
    )
    image = rw.render(rw.Scene(rw.Instance(walls, matrix)), camera, samples=128, progress=False)
    assert_mean(image, 2)


@pytest.mark.parametrize(("size", "place"), MOVES)
def test_glass_and_mirrors_under_an_even_sky(size, place):
    # A ball of glass and a mirror ball in even light: both are invisible.
    at = Moved(size, place)
    glass = rw.Sphere(at(0, 0, 1), 0.5 * size, material=rw.Dielectric(1.5))
    mirror = rw.Sphere(at(0, 0.7, 0), 0.3 * size, material=rw.Mirror())
    camera = rw.Camera(at(4, 0.2, 2), at(0, 0.3, 0.5), up=(0, 0, 1), fov=30, width=16, height=16)
    scene = rw.Scene([glass, mirror], environment=1, precision="double")
    image = rw.render(scene, camera, rw.Path(roulette_depth=1000), samples=16, progress=False)
    np.testing.assert_allclose(image.rgb, 1, rtol=1e-6)


@pytest.mark.parametrize("light", ["point", "spot", "area", "sky"])
def test_light_from_behind_the_camera(light):
    # The camera looks down from height 1; lights are above it, and it is no obstacle.
    above = (0, 0, 2)
    lights, shapes, sky = [], [], None
    if light == "point":
        lights, expected = [rw.PointLight(above, 4)], 1
    elif light == "spot":
        lights, expected = [rw.SpotLight(above, (0, 0, 0), 4, angle=5)], 1
    elif light == "area":
        shapes = [rw.Disk(above, (0, 0, -1), 1, material=rw.Diffuse(0), emission=3)]
        expected = math.pi * 3 / 5
    else:
        # A map whose upper half, behind a camera that looks straight down, emits; the other is below the
        # floor.
        sky = rw.EnvironmentMap(np.repeat([[1.0], [0.0]], 64, axis=0), [[1, 0, 0], [0, 0, -1], [0, 1, 0]])
        expected = math.pi
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.Diffuse(0.8))
    camera = rw.Camera((0, 0, 1), (0, 0, 0), up=(0, 1, 0), fov=1e-3, width=8, height=8)
    scene = rw.Scene([floor, *shapes], lights=lights, environment=sky)
    image = rw.render(scene, camera, rw.Path(max_depth=1), samples=256, progress=False)
    assert_mean(image, 0.8 / math.pi * expected, slack=1e-3 if light == "sky" else 1e-5)


@pytest.mark.parametrize("far", [1e3, 1e5, 1e7])
def test_what_a_camera_sees_from_far_away_is_lit_as_it_is(far):
    # A patch of floor under a lamp, from far away and at an angle: Lambert's irradiance of a square (1760).
    corners = [(-1, -1, 1), (-1, 1, 1), (1, 1, 1), (1, -1, 1)]
    lamp = rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0), emission=3)
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.Diffuse(0.8))
    camera = rw.Camera(
        (far, 0, 0.1 * far), (0, 0, 0), up=(0, 0, 1), fov=math.degrees(1e-4 / far), width=8, height=8
    )
    scene = rw.Scene([floor, lamp], precision="double")
    image = rw.render(scene, camera, rw.Path(max_depth=1), samples=256, progress=False)
    assert_mean(image, 0.8 / math.pi * 3 * 1.740839502734206, slack=1e-4)
