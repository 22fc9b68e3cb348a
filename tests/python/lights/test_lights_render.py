"""Pictures lit by all kinds of lights, against closed forms: each within four of its standard errors."""

import math

import numpy as np
import pytest

import raywright as rw

REFLECTANCE = 0.8


def rectangle(corner, side, other, **kwargs):
    """Two triangles whose normal is along side cross other."""
    corner, side, other = (np.array(v, float) for v in (corner, side, other))
    vertices = [corner, corner + side, corner + side + other, corner + other]
    return rw.Mesh(vertices, [(0, 1, 2), (0, 2, 3)], **kwargs)


def floor_irradiance(shapes=(), samples=64, **scene):
    """Irradiance of the origin on a floor in the plane z = 0, and its standard error."""
    floor = rectangle((-1, -1, 0), (2, 0, 0), (0, 2, 0), material=rw.Diffuse(REFLECTANCE))
    camera = rw.Camera((0.3, 0, 0.03), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    image = rw.render(
        rw.Scene([floor, *shapes], **scene), camera, rw.Path(max_depth=1), samples=samples, progress=False
    )
    errors = np.square(image.standard_error.astype(float)).mean(axis=2)
    scale = math.pi / REFLECTANCE
    return float(image.rgb.mean(dtype=float)) * scale, scale * math.sqrt(float(errors.sum())) / 64


def assert_irradiance(found, expected, slack=1e-5):
    value, error = found
    assert abs(value - expected) <= 4 * error + slack * expected, f"{value} ± {error}, not {expected}"
    assert error <= 0.02 * expected


def test_spots_light_their_cone():
    def lit(angle, falloff=0.0, target=(0, 0, 0), profile="smooth"):
        spot = rw.SpotLight((0, 0, 2), target, 12, angle=angle, falloff=falloff, profile=profile)
        return floor_irradiance(samples=2, lights=[spot])

    assert_irradiance(lit(10), 3)
    assert_irradiance(lit(90, 90), 3)
    # Aimed 30 degrees off: outside a cone of 29, and halfway in cosines through the falloff of another.
    aside = (2 * math.tan(math.radians(30)), 0, 0)
    assert lit(29, target=aside)[0] == 0
    half = math.degrees(math.acos(2 * math.cos(math.radians(30)) - math.cos(math.radians(10))))
    assert_irradiance(lit(half, half - 10, target=aside), 1.5)
    # A quarter of the way in, in degrees.
    assert_irradiance(lit(35, 20, target=aside, profile="linear"), 0.75)


def test_directional_light_brings_its_irradiance():
    light = rw.DirectionalLight((0, -3, -4), 5)
    assert_irradiance(floor_irradiance(samples=2, lights=[light]), 4)
    roof = rectangle((-5, -5, 50), (10, 0, 0), (0, 10, 0))
    assert floor_irradiance([roof], samples=2, lights=[rw.DirectionalLight((0, 0, -1), 5)])[0] == 0
    # From below.
    assert floor_irradiance(samples=2, lights=[rw.DirectionalLight((0, 0, 1), 5)])[0] == 0


def test_projector_throws_its_picture():
    picture = [[1, 1], [0, 7]]
    for target, expected in (((0.3, 0, 0), 1), ((-0.3, 0, 0), 1), ((5, 0, 0), 0)):
        light = rw.ProjectorLight(picture, (*target[:2], 2), target, up=(0, -1, 0), fov=40, intensity=4)
        found = floor_irradiance(samples=2, lights=[light])
        if expected:
            # The origin is in the middle of the height, where both rows count half.
            x = (0 - target[0]) / (2 * math.tan(math.radians(20)))
            lower = np.interp(-x, (-0.5, 0.5), (0, 7))
            assert_irradiance(found, (1 + lower) / 2)
        else:
            assert found[0] == 0


def test_map_of_one_radiance_is_a_constant_environment():
    assert_irradiance(
        floor_irradiance(samples=512, environment=rw.EnvironmentMap(np.full((8, 16), 2.0))), 2 * math.pi
    )
    several = [
        rw.EnvironmentMap(np.ones((4, 4))),
        rw.ConstantEnvironment(0.5),
        rw.EnvironmentMap([[3]], scale=0.5),
    ]
    assert_irradiance(floor_irradiance(samples=512, environment=several), 3 * math.pi)


def test_camera_sees_a_map_upright():
    picture = np.zeros((64, 128, 3), np.float32)
    picture[:32, :, 0] = 1
    picture[:, 64:, 1] = 1
    scene = rw.Scene([], environment=rw.EnvironmentMap(picture))
    camera = rw.Camera((0, 0, 0), (0, 0, -1), fov=60, width=8, height=8)
    seen = rw.render(scene, camera, samples=1, progress=False).rgb
    assert (seen[:3, :, 0] == 1).all()
    assert (seen[5:, :, 0] == 0).all()
    assert (seen[:, 5:, 1] == 1).all()
    assert (seen[:, :3, 1] == 0).all()
    # Turned upside down.
    scene = rw.Scene([], environment=rw.EnvironmentMap(picture, np.diag([1, -1, -1])))
    camera = rw.Camera((0, 0, 0), (0, 0, 1), up=(0, -1, 0), fov=60, width=8, height=8)
    assert np.array_equal(rw.render(scene, camera, samples=1, progress=False).rgb, seen)


def test_sun_of_one_texel_does_not_blow_up():
    # A sun of 10⁷ straight above: its tent of 2 by 2 texels, integrated over the map's own grid, refined.
    picture = np.ones((64, 128), np.float32)
    picture[12, 40] = 1e7
    turned = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    fine = 40
    theta = (np.arange(64 * fine) + 0.5) / (64 * fine) * math.pi
    rows = np.clip(theta / math.pi * 64 - 0.5, 0, 63)
    tent = np.maximum(0, 1 - abs(rows - 12))
    level = (np.sin(theta) * np.maximum(np.cos(theta), 0) * math.pi / (64 * fine)).astype(float)
    expected = math.pi + (1e7 - 1) * float((tent * level).sum()) * 2 * math.pi / 128
    found = floor_irradiance(samples=256, environment=rw.EnvironmentMap(picture, turned))
    assert_irradiance(found, expected, slack=1e-4)


@pytest.mark.parametrize(("radius", "distance"), [(1e-5, 1.0), (1e-3, 1e4), (0.5, 2.0)])
def test_sphere_light_of_constant_power_is_a_point_light(radius, distance):
    # E = π L (R / d)² for a sphere right above; intensity π R² L.
    ball = rw.Sphere((0, 0, distance), radius, emission=1 / (math.pi * radius**2))
    expected = floor_irradiance(samples=2, lights=[rw.PointLight((0, 0, distance), 1)])[0]
    assert expected == pytest.approx(1 / distance**2, rel=1e-5)
    assert_irradiance(floor_irradiance([ball], samples=16), expected)


@pytest.mark.parametrize("radiance", [1e-20, 1.0, 1e30])
def test_area_of_a_trillionth_lights_as_a_point(radiance):
    size = 1e-6
    lamp = rectangle((-size / 2, -size / 2, 1), (0, size, 0), (size, 0, 0), emission=radiance)
    scene = {"precision": "double"}
    found = floor_irradiance([lamp], samples=16, **scene)
    assert_irradiance(found, radiance * size**2, slack=1e-4)


def test_both_sides_shine():
    # A lamp that looks up lights the floor below only if its back shines: Lambert, 1760.
    for emission, expected in (
        (rw.Emission(1, False), 0.0),
        (rw.Emission(1, True), 1.740839502734206),
        (rw.Emission(1, side="back"), 1.740839502734206),
    ):
        lamp = rectangle((-1, -1, 1), (2, 0, 0), (0, 2, 0), emission=emission)
        found = floor_irradiance([lamp], samples=256)
        if expected:
            assert_irradiance(found, expected)
        else:
            assert found[0] == 0


HOLLOW = {
    "sphere": {"shapes": [rw.Sphere((0.2, 0, 0.3), 2.0, emission=rw.Emission(3, side="back"))]},
    "stretched": {
        "shapes": [
            rw.Sphere(
                transform=[[3, 0, 1, 0], [0, 2, 0, 0.1], [0, 0, 4, 0.5], [0, 0, 0, 1]],
                emission=rw.Emission(3, side="back"),
            )
        ]
    },
    "ellipsoid": {
        "shapes": [rw.shapes.Ellipsoid((0, 0, 0), (2, 3, 4), emission=rw.Emission(3, side="back"))]
    },
    "box": {"shapes": [rw.Box((-2, -2, -2), (2, 3, 4), emission=rw.Emission(3, side="back"))]},
    "cylinder": {"shapes": [rw.Cylinder((0, 0, -2), (0, 0, 2), 3, emission=rw.Emission(3, side="back"))]},
    "copy": {
        "shapes": [
            rw.Instance(rw.Sphere((0, 0, 0), 1, emission=rw.Emission(3, side="back")), np.diag([2, 3, 2, 1]))
        ]
    },
    "two": {
        # The inner one is dark outside, and hides the outer one.
        "shapes": [
            rw.Sphere((0, 0, 0), 2, emission=rw.Emission(3, side="back")),
            rw.Sphere((0, 0, 0), 9, emission=rw.Emission(70, side="back")),
        ]
    },
    "patterned": {
        "shapes": [rw.Sphere((0, 0, 0), 2, emission=rw.Emission(rw.Checker(3.0, 3.0), side="back"))],
    },
}


@pytest.mark.parametrize("kind", HOLLOW)
def test_within_what_shines_inwards_there_is_light_from_everywhere(kind):
    # π L, none of it hidden by the floor.
    assert_irradiance(floor_irradiance(samples=256, **HOLLOW[kind]), 3 * math.pi, slack=1e-5)


def test_a_tube_that_shines_inwards():
    # Seen from the middle of its base, the far end fills π r² / (r² + h²), and all else is wall.
    radius, height = 1.5, 2.0
    wall = rw.Cylinder((0, 0, -1), (0, 0, height), radius, capped=False, emission=rw.Emission(2, side="back"))
    expected = 2 * math.pi * height**2 / (radius**2 + height**2)
    assert_irradiance(floor_irradiance([wall], samples=512), expected)


def test_what_shines_inwards_is_dark_from_outside():
    camera = rw.Camera((0, 0, 9), (0, 0, 0), fov=20, width=16, height=16)
    emission = rw.Emission(5, side="back")
    for shape in (
        rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0.5), emission=emission),
        rw.Cylinder((0, -1, 0), (0, 1, 0), 1, material=rw.Diffuse(0.5), emission=emission),
        rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(0.5), emission=emission),
    ):
        assert not rw.render(rw.Scene(shape), camera, samples=4, progress=False).rgb.any()
        # Light from elsewhere is reflected as usual: it is convex, and half of the sky's 2 is 1.
        lit = rw.render(rw.Scene(shape, environment=2.0), camera, samples=64, progress=False)
        assert lit.rgb[8, 8] == pytest.approx(1.0, abs=5 * float(lit.standard_error[8, 8].max()))


@pytest.mark.parametrize("integrator", [rw.Path(), rw.Path(reuse=2), rw.Path(guiding="photons")], ids=repr)
def test_a_ball_in_what_shines_inwards_and_reflects(integrator):
    # All is L / (1 - albedo), also the ball, which emits and reflects like the shell.
    shell = rw.Sphere((0, 0, 0), 3, material=rw.Diffuse(0.5), emission=rw.Emission(1, side="back"))
    ball = rw.Sphere((0, 0, 0), 0.5, material=rw.Diffuse(0.5), emission=1)
    camera = rw.Camera((0, 0, 2), (0, 0, 0), fov=60, width=16, height=16)
    image = rw.render(rw.Scene([shell, ball]), camera, integrator, samples=256, progress=False)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 256
    assert abs(float(image.rgb[..., 1].mean(dtype=float)) - 2.0) <= 4 * error + 1e-5
    assert error < 0.01


def test_lamps_in_instances_light_as_they_do_outside():
    # Small lamps in copies, which random directions hardly hit: π r² L cos² / d² each.
    lamp = rw.Disk((0, 0, 0), (0, 0, -1), 1e-4, emission=1e8)
    matrices = np.tile(np.eye(4), (50, 1, 1))
    matrices[:, :3, 3] = [(0.1 * i - 2.5, 0.3, 1) for i in range(50)]
    expected = sum(math.pi / (x * x + 0.09 + 1) ** 2 for x in 0.1 * np.arange(50) - 2.5)
    found = floor_irradiance([rw.Instance(lamp, matrices)], samples=256)
    assert_irradiance(found, expected, slack=1e-4)


def test_hall_of_lamps_is_lit_by_all():
    # 2000 small lamps over the floor, of strengths from 1 to 1000, which a tree chooses from.
    rng = np.random.default_rng(1)
    places = rng.uniform((-30, -30, 1), (30, 30, 6), (2000, 3))
    intensities = 10 ** rng.uniform(0, 3, 2000)
    lights = [rw.PointLight(place, intensity) for place, intensity in zip(places, intensities, strict=True)]
    square = (places**2).sum(axis=1)
    expected = float((intensities * places[:, 2] / square**1.5).sum())
    assert_irradiance(floor_irradiance(samples=1024, lights=lights), expected)
