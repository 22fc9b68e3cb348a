"""Lamps with masks: as much light as there is of them, on all sides that shine, whoever looks for it."""

import math

import numpy as np
import pytest

import raywright as rw

BLACK = rw.Diffuse(0.0)
#: A plate of reflectance 1 sends on E / pi.
PLATE = rw.Mesh(
    [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(1.0)
)
#: It sees the origin of the plate alone, from beside the lamps.
CAMERA = rw.Camera((0, -6, 0.5), (0, 0, 0), up=(0, 0, 1), fov=0.01, width=1, height=1)
#: What asks lights alone, what also runs into them, and what starts at them.
ASKING = [rw.RayCast(), rw.Whitted(), rw.Direct(), rw.Path(max_depth=1), rw.Bidirectional(max_depth=1)]


def lower_half_open(material=BLACK):
    """Nothing of a sphere below its equator, and all of it above."""
    rows = np.repeat([1.0, 0.0], 64).reshape(-1, 1)
    return rw.Mask(material, rw.ImageTexture(rows, filter="nearest", wrap="clamp"))


def irradiance(lamp, integrator, samples=4096, **more):
    """The irradiance at the origin of a plate, and its standard error."""
    scene = rw.Scene([PLATE, *np.atleast_1d(lamp)], **more)
    image = rw.render(scene, CAMERA, integrator, samples=samples, seed=7, progress=False)
    return float(image.rgb[0, 0, 1]) * math.pi, float(image.standard_error.max()) * math.pi


def assert_irradiance(lamp, integrator, expected, share=0.02, **more):
    """Five standard errors, which chance exceeds once in a million."""
    mean, error = irradiance(lamp, integrator, **more)
    assert abs(mean - expected) <= 5 * error + 2e-4 * expected, (mean, error, expected)
    assert error <= share * expected


def sphere(mask, emission, center=(0, 0, 2), radius=0.6):
    return rw.Sphere(center, radius, material=mask, emission=emission)


def square(mask, emission, height=2.0):
    corners = [(-0.5, -0.5, height), (0.5, -0.5, height), (0.5, 0.5, height), (-0.5, 0.5, height)]
    return rw.Mesh(corners, [(0, 2, 1), (0, 3, 2)], material=mask, emission=emission)


def instance(mask, emission):
    inner = rw.Sphere((0, 0, 1), 0.3, material=mask, emission=emission)
    return rw.Instance(inner, np.diag([2.0, 2.0, 2.0, 1.0]))


@pytest.mark.parametrize("integrator", ASKING, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("lamp", [sphere, square, instance], ids=lambda one: one.__name__)
def test_a_lamp_that_is_not_there_lights_nothing(lamp, integrator):
    assert irradiance(lamp(rw.Mask(BLACK, 0.0), 3.0), integrator, 16) == (0, 0)


@pytest.mark.parametrize("integrator", ASKING, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("lamp", [sphere, square, instance], ids=lambda one: one.__name__)
def test_a_lamp_lights_by_its_opacity(lamp, integrator):
    # Of a sphere pi L (R / d)^2; of a square above 4 L s atan(s), with s = a / sqrt(a^2 + h^2).
    side = 0.5 / math.hypot(0.5, 2)
    whole = 4 * side * math.atan(side) if lamp is square else math.pi * 0.3**2
    assert_irradiance(lamp(rw.Mask(BLACK, 0.25), 3.0), integrator, 0.25 * 3 * whole)
    # The other side adds the light that passes the nearer one.
    both = rw.Emission(3.0, side="both")
    again = 1 if lamp is square else 1 + 0.75
    assert_irradiance(lamp(rw.Mask(BLACK, 0.25), both), integrator, 0.25 * 3 * whole * again)


@pytest.mark.parametrize("integrator", ASKING, ids=lambda one: type(one).__name__)
@pytest.mark.parametrize("side", ["back", "both"])
def test_the_inner_side_of_a_cut_open_sphere_is_seen_through_its_hole(integrator, side):
    # The visible inner side fills the hole, a disk: pi L R^2 / (R^2 + h^2).
    expected = math.pi * 2 * 0.6**2 / (0.6**2 + 2**2)
    assert_irradiance(sphere(lower_half_open(), rw.Emission(2.0, side=side)), integrator, expected)


@pytest.mark.parametrize("integrator", ASKING, ids=lambda one: type(one).__name__)
def test_what_shines_outwards_is_hidden_behind_nothing_that_is_there(integrator):
    # Its upper half shines up, and none of that comes down.
    assert irradiance(sphere(lower_half_open(), 2.0), integrator, 64) == (0, 0)


def test_many_lamps_and_lamps_in_haze_too():
    expected = math.pi * 2 * 0.6**2 / (0.6**2 + 2**2)
    bowl = sphere(lower_half_open(), rw.Emission(2.0, side="both"))
    gone = [sphere(rw.Mask(BLACK, 0.0), 5.0, (x, 3, 4), 0.1) for x in range(20)]
    assert_irradiance([bowl, *gone], rw.Path(max_depth=1), expected)
    haze = rw.Homogeneous(absorption=1e-9, scattering=0.0)
    for integrator in (rw.Path(max_depth=1), rw.Bidirectional(max_depth=1)):
        assert_irradiance(bowl, integrator, expected, medium=haze)


@pytest.mark.parametrize("lamp", [sphere, square, instance], ids=lambda one: one.__name__)
def test_photons_are_emitted_by_what_is_there(lamp):
    area = 1.0 if lamp is square else 4 * math.pi * 0.6**2
    for side, sides in (("front", 1), ("back", 1), ("both", 2)):
        scene = rw.Scene(lamp(rw.Mask(BLACK, 0.25), rw.Emission(3.0, side=side)))
        found = scene.photons(1000)
        np.testing.assert_allclose(found.emitted, 0.25 * 3 * math.pi * area * sides, rtol=1e-9)
    assert rw.Scene(lamp(rw.Mask(BLACK, 0.0), 3.0)).photons(1000).emitted == (0, 0, 0)


def test_photons_of_a_lamp_with_a_hole_leave_what_is_there():
    found = rw.Scene(sphere(lower_half_open(), 3.0)).photons(40_000)
    # Half of 40,000: the share is off by 0.005 once in 10^22.
    np.testing.assert_allclose(found.emitted, 3 * math.pi * 2 * math.pi * 0.6**2, rtol=0.05)


def test_two_lamps_share_photons_by_what_is_there_of_them():
    lamps = [sphere(rw.Mask(BLACK, 0.1), 3.0, (0, 0, 2)), sphere(BLACK, 3.0, (0, 0, 5))]
    found = rw.Scene(lamps).photons(1000)
    np.testing.assert_allclose(found.emitted, 1.1 * 3 * math.pi * 4 * math.pi * 0.6**2, rtol=1e-9)
