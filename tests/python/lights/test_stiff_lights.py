"""Lights that are very strong, very weak, very small, or a single texel, against closed forms.

Means are within five of their standard errors, which chance exceeds once in two million.
"""

import math

import numpy as np
import pytest

import raywright as rw

UPRIGHT = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])  # what is up in a map is +z


def lit(samples=64, integrator=None, **scene):
    """Radiance of the origin on a floor of reflectance 0.8 in the plane z = 0: mean, and standard error."""
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.Diffuse(0.8))
    shapes = [floor, *scene.pop("shapes", ())]
    camera = rw.Camera((3, 0, 0.5), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    how = integrator or rw.Path(max_depth=1)
    image = rw.render(rw.Scene(shapes, **scene), camera, how, samples=samples, progress=False)
    assert np.isfinite(image.rgb).all()
    assert np.isfinite(image.standard_error).all()
    assert not any("finite" in warning for warning in image.warnings)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
    return float(image.rgb[..., 1].mean(dtype=float)), error


def assert_lit(found, expected, slack=1e-5):
    value, error = found
    assert abs(value - expected) <= 5 * error + slack * expected, f"{value} ± {error}, not {expected}"
    assert error <= 0.01 * expected


# Lights by strength, and the radiance of the origin at strength 1.
ARRANGEMENTS = {
    "point": (lambda s: {"lights": [rw.PointLight((0, 0, 2), s)]}, 0.8 / math.pi / 4),
    "spot": (lambda s: {"lights": [rw.SpotLight((0, 0, 2), (0, 0, 0), s)]}, 0.8 / math.pi / 4),
    "direction": (lambda s: {"lights": [rw.DirectionalLight((0, 0, -1), s)]}, 0.8 / math.pi),
    "sphere": (
        lambda s: {"shapes": [rw.Sphere((0, 0, 2), 0.5, material=rw.Diffuse(0), emission=s)]},
        0.8 / 16,
    ),
    "disk": (
        lambda s: {"shapes": [rw.Disk((0, 0, 1), (0, 0, -1), 1, material=rw.Diffuse(0), emission=s)]},
        0.8 / 2,
    ),
    "sky": (lambda s: {"environment": s}, 0.8),
    "map": (lambda s: {"environment": rw.EnvironmentMap(np.ones((4, 8)), scale=s)}, 0.8),
}


@pytest.mark.parametrize("strength", [1e-30, 1e-10, 1e10, 1e30])
@pytest.mark.parametrize("kind", ARRANGEMENTS)
def test_strength_is_a_factor_of_the_picture_and_of_its_error(kind, strength):
    # The same random numbers at any strength: results scale with it, to the precision of pictures.
    make, share = ARRANGEMENTS[kind]
    found, unit = lit(**make(strength)), lit(**make(1.0))
    assert found[0] == pytest.approx(unit[0] * strength, rel=1e-5)
    # Cancellation leaves no digit of a standard error of nearly nothing.
    assert found[1] == pytest.approx(unit[1] * strength, rel=1e-2, abs=1e-6 * share * strength)
    assert_lit(found, share * strength)


def test_a_weak_light_beside_a_strong_one_is_not_lost():
    # 1e30 in one channel, 1e-30 in another: each has the same result as alone.
    lights = [rw.PointLight((0, 0, 2), (1e30, 0, 0)), rw.PointLight((0, 0, 1), (0, 1e-30, 0))]
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.Diffuse(0.8))
    camera = rw.Camera((3, 0, 0.5), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=4, height=4)
    image = rw.render(
        rw.Scene(floor, lights=lights), camera, rw.Direct(light_samples=2), samples=4, progress=False
    )
    assert np.isfinite(image.rgb).all()
    assert image.rgb[..., 0] == pytest.approx(1e30 * 0.8 / math.pi / 4, rel=1e-4)
    assert (image.rgb[..., 2] == 0).all()


def sum_over_map(picture, fine=16):
    """Irradiance of a plane that looks to the top of a map, of texels joined linearly, by midpoints."""
    rows, columns = picture.shape
    theta = (np.arange(rows * fine) + 0.5) / (rows * fine) * math.pi
    down = np.clip(theta / math.pi * rows - 0.5, 0, rows - 1)
    # Texels join around the seam, so only the sum of a row counts.
    sums = np.interp(down, np.arange(rows), picture.sum(axis=1))
    weight = np.maximum(np.cos(theta), 0) * np.sin(theta) * math.pi / (rows * fine)
    return float((sums * weight).sum()) * 2 * math.pi / columns


@pytest.mark.parametrize(
    "texel", [(0, 5), (10, 0), (10, 63), (15, 20), (20, 33)], ids=["pole", "seam", "edge", "horizon", "below"]
)
def test_a_sun_of_one_texel_anywhere_in_a_map_lights_as_the_sum_over_it(texel):
    picture = np.random.default_rng(4).random((32, 64)).astype(np.float32)
    picture[texel] = 1e7
    found = lit(samples=256, environment=rw.EnvironmentMap(picture, UPRIGHT))
    assert_lit(found, 0.8 / math.pi * sum_over_map(picture), slack=2e-3)


@pytest.mark.parametrize("strength", [1e-30, 1e30])
def test_a_map_of_any_strength_lights_as_the_sum_over_it(strength):
    picture = np.random.default_rng(5).random((8, 16)).astype(np.float32)
    found = lit(samples=256, environment=rw.EnvironmentMap(picture * np.float32(strength), UPRIGHT))
    assert_lit(found, 0.8 / math.pi * sum_over_map(picture) * strength, slack=2e-3)


@pytest.mark.parametrize("place", [0.0, 1e3, 1e6])
@pytest.mark.parametrize("radius", [1e-5, 1e-9])
def test_a_tiny_sphere_of_constant_power_is_a_point_also_from_far_and_far_away(radius, place):
    # E = π L (R/d)²: at a distance of 1 and of 1000, at any place.
    for distance in (1.0, 1e3):
        at = (place, 0, 0)
        ball = rw.Sphere((place, 0, distance), radius, material=rw.Diffuse(0), emission=1 / radius**2)
        floor = rw.Disk(at, (0, 0, 1), 9, material=rw.Diffuse(0.8))
        camera = rw.Camera((place + 3, 0, 0.5), at, up=(0, 0, 1), fov=1e-3, width=8, height=8)
        scene = rw.Scene([floor, ball], precision="double")
        image = rw.render(scene, camera, rw.Path(max_depth=1), samples=16, progress=False)
        error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
        assert_lit((float(image.rgb[..., 1].mean(dtype=float)), error), 0.8 / distance**2, slack=1e-4)


@pytest.mark.parametrize("shape", ["square", "disk", "triangle", "sliver"])
def test_areas_of_a_trillionth_light_as_points(shape):
    # Power π L A at height 1, cosines 1: E = L A.
    if shape == "disk":
        lamp = rw.Disk(
            (0, 0, 1), (0, 0, -1), math.sqrt(1e-12 / math.pi), material=rw.Diffuse(0), emission=1e12
        )
    else:
        a, b = {"square": (1e-6, 1e-6), "triangle": (2e-6, 1e-6), "sliver": (2e-3, 1e-9)}[shape]
        corners = np.array([(0, 0, 1), (0, b, 1), (a, b, 1), (a, 0, 1)]) - (a / 3, b / 3, 0)
        faces = [(0, 1, 2), (0, 2, 3)] if shape == "square" else [(0, 1, 3)]
        lamp = rw.Mesh(corners, faces, material=rw.Diffuse(0), emission=1e12)
    found = lit(samples=16, shapes=[lamp], precision="double")
    assert_lit(found, 0.8 / math.pi, slack=1e-4)


def hollow(side):
    """Closed shapes about the origin, some large, small, stretched or far away, and a place within."""
    glowing = {"material": rw.Diffuse(0.5), "emission": rw.Emission(1, side=side)}
    return {
        "sphere": (rw.Sphere((0, 0, 0), 1, **glowing), (0, 0, 0)),
        "small sphere": (rw.Sphere((0.1, 0.2, 0.3), 1e-5, **glowing), (0.1, 0.2, 0.3)),
        "far sphere": (rw.Sphere((1e5, -1e5, 1e4), 1, **glowing), (1e5, -1e5, 1e4)),
        "ellipsoid": (rw.shapes.Ellipsoid((0, 0, 0), (1, 2, 0.5), **glowing), (0, 0, 0)),
        "box": (rw.Box((-1, -2, -1), (1, 1, 3), **glowing), (0, 0, 0)),
        "cylinder": (rw.Cylinder((0, 0, -1), (0, 0, 1), 1, **glowing), (0, 0, 0)),
        "cone": (rw.Cone((0, 0, -0.5), (0, 0, 1), 1, **glowing), (0, 0, 0)),
        "torus": (rw.Torus((0, 0, 2), (0, 1, 0), 2, 1, **glowing), (0, 0, 0)),
        "copy": (rw.Instance(rw.Sphere((0, 0, 0), 1, **glowing), np.diag([1, 2, 0.5, 1])), (0, 0, 0)),
        "far copy": (
            rw.Instance(
                rw.Sphere((0, 0, 0), 1, **glowing), [[2, 0, 0, 1e5], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]
            ),
            (1e5, 0, 0),
        ),
    }


HOLLOW = {f"{name}, {side}": one for side in ("both", "back") for name, one in hollow(side).items()}


@pytest.mark.parametrize(
    "kind", [pytest.param(k, marks=pytest.mark.slow) if k == "torus, back" else k for k in HOLLOW]
)
def test_within_any_hollow_shape_that_shines_it_is_alike(kind):
    # Closed, with radiance 1 and a reflectance of a half: 1 / (1 - 0.5), and 1.5 with one bounce.
    shape, center = HOLLOW[kind]
    scene = rw.Scene(shape, precision="double")
    camera = rw.Camera(center, np.add(center, (0.3, 0.4, 0.5)), fov=90, width=8, height=8)
    for depth, expected in ((None, 2.0), (1, 1.5)):
        image = rw.render(scene, camera, rw.Path(max_depth=depth), samples=128, progress=False)
        error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
        assert_lit((float(image.rgb[..., 1].mean(dtype=float)), error), expected)


def test_a_ball_that_shines_and_reflects_is_seen_by_itself_from_outside_only():
    # Convex: none of its own light falls on its outside, despite rounding.
    for center in ((0, 0, 0), (1e5, 0, 0)):
        ball = rw.Sphere(center, 1, material=rw.Diffuse(0.5), emission=rw.Emission(1, both_sides=True))
        camera = rw.Camera(np.add(center, (0, 0, 9)), center, fov=8, width=16, height=16)
        image = rw.render(rw.Scene(ball, precision="double"), camera, samples=16, progress=False)
        np.testing.assert_array_equal(image.rgb, 1)


def lamps(kind, scale):
    """A room of some size, with lamps of a kind, and a camera in it."""

    def box(low, high, **how):
        return rw.Box(np.multiply(low, scale), np.multiply(high, scale), **how)

    def corners(x, z, size):
        return np.array([(x, 0.9, z), (x + size, 0.9, z), (x + size, 0.9, z + size), (x, 0.9, z + size)])

    def quad(x, z, size):
        return rw.Mesh(corners(x, z, size) * scale, [(0, 1, 2), (0, 2, 3)], emission=2.0)

    shining = {
        "a square": [quad(-0.3, -0.3, 0.6)],
        "a ball": [rw.Sphere((0, 0.5 * scale, 0), 0.2 * scale, emission=2.0)],
        "a disk": [rw.Disk((0, 0.9 * scale, 0), (0, -1, 0), 0.4 * scale, emission=2.0)],
        "many squares": [quad(x, z, 0.05) for x in np.linspace(-0.9, 0.8, 8) for z in (-0.8, 0.1, 0.7)],
    }
    walls = box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(0.5))
    if kind == "a square":
        at = np.array([(x, y, z) for x in (-1.0, 1) for y in (-1.0, 1) for z in (-1.0, 1)]) * scale
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
        walls = rw.Mesh(at, faces, material=rw.Diffuse(0.5))
    eye, target = (0.3 * scale, 0.1 * scale, 0.9 * scale), (0, -0.5 * scale, 0)
    return rw.Scene([walls, *shining[kind]]), rw.Camera(eye, target, fov=70, width=8, height=8)


@pytest.mark.parametrize("exponent", [-100, -60, -40, -30, 30, 40, 60, 100])
@pytest.mark.parametrize("kind", ["a square", "a ball", "a disk", "many squares"])
def test_a_room_is_as_bright_at_any_size(kind, exponent):
    """Overflow of f32 would make it darker by a tenth or more."""
    for way in (rw.Path(max_depth=3, reuse=1, guiding="none"), rw.Path(max_depth=3, reuse=4, guiding="none")):
        usual, other = (
            rw.render(*lamps(kind, scale), way, samples=256, progress=False).rgb
            for scale in (1.0, 2.0**exponent)
        )
        assert usual.mean() > 1e-3
        np.testing.assert_allclose(other.mean(), usual.mean(), rtol=0.04)


@pytest.mark.parametrize("exponent", [-100, 100])
@pytest.mark.parametrize("kind", ["a square", "a ball"])
def test_paths_from_lights_know_no_size(kind, exponent):
    """Powers of two scale every number exactly but those in float32, which must not overflow."""
    for way in (rw.LightTraced(max_depth=3), rw.Bidirectional(max_depth=3), rw.PhotonMap(2000, max_depth=2)):
        usual, other = (
            rw.render(*lamps(kind, scale), way, samples=8, progress=False).rgb
            for scale in (1.0, 2.0**exponent)
        )
        assert usual.mean() > 1e-3
        np.testing.assert_allclose(other.mean(), usual.mean(), rtol=0.04)
