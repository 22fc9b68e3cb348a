"""Stiff cases: sizes, places, strengths and gaps at which pictures go wrong elsewhere, against their truths.

Means are within four of their own standard errors, which chance exceeds once in 16,000 renders, and these are
below half a percent unless another bound is given.
"""

import math

import numpy as np
import pytest
import trimesh

import raywright as rw

INWARDS = [0, 2, 1]

OBLIQUE = np.array((1, 2, 3)) / math.sqrt(14)


def square(size, height, *, up=True, at=(0.0, 0.0), **kwargs):
    """A square of this half side in a plane of one height."""
    x, y = at
    corners = [(x - size, y - size), (x + size, y - size), (x + size, y + size), (x - size, y + size)]
    faces = [(0, 1, 2), (0, 2, 3)] if up else [(0, 2, 1), (0, 3, 2)]
    return rw.Mesh([(*corner, height) for corner in corners], faces, **kwargs)


def mean(image):
    """Mean of the green channel, and its standard error."""
    count = image.rgb.shape[0] * image.rgb.shape[1]
    variances = np.square(image.standard_error[..., 1].astype(float))
    return float(image.rgb[..., 1].mean(dtype=float)), math.sqrt(float(variances.sum())) / count


def assert_mean(image, expected, most=0.005, slack=1e-6):
    value, error = mean(image)
    assert np.isfinite(image.rgb).all()
    assert not image.warnings
    assert abs(value - expected) <= 4 * error + slack * expected, f"{value} ± {error}, not {expected}"
    assert error <= most * expected, f"{error} of {expected}"


def room(box, reflectance, emission, scale=1.0, shift=0.0):
    """A closed box from 0 to `scale`, moved by `shift` along all axes, that shines inwards."""
    vertices = np.asarray(box.vertices) * scale + shift
    material = rw.Diffuse(reflectance)
    return rw.Mesh(vertices, np.asarray(box.faces)[:, INWARDS], material=material, emission=emission)


def inside(scale=1.0, shift=0.0, size=16):
    center = np.full(3, shift + scale / 2)
    return rw.Camera(center, center + scale * np.array([0.2, 0.1, -1]), fov=80, width=size, height=size)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("precision", ["single", "double"])
def test_size_does_not_matter(box, scale, precision):
    scene = rw.Scene(room(box, 0.5, 1.0, scale), precision=precision)
    assert_mean(rw.render(scene, inside(scale), samples=64, progress=False), 2.0)


@pytest.mark.parametrize("shift", [1e3, 1e4, 1e5, 1e6, 1e7])
def test_place_does_not_matter(box, shift):
    # In f32, the corners of a box of 64 are exact at all of these places.
    scene = rw.Scene(room(box, 0.5, 1.0, 64.0, shift))
    assert_mean(rw.render(scene, inside(64.0, shift), samples=64, progress=False), 2.0)


@pytest.mark.parametrize("shift", [0.0, 1e3, 1e5, 1e7])
def test_a_lamp_lights_a_floor_alike_at_any_place(shift):
    # Lambert's irradiance of a square right above, with everything moved; in f64, which keeps 0.1 at 1e7.
    def moved(mesh):
        return rw.Mesh(mesh.vertices + shift, mesh.faces, material=mesh.material, emission=mesh.emission)

    shapes = [
        square(9, 0, material=rw.Diffuse(0.8)),
        square(1, 1, up=False, material=rw.Diffuse(0), emission=3),
    ]
    scene = rw.Scene([moved(mesh) for mesh in shapes], precision="double")
    at = np.full(3, shift)
    camera = rw.Camera(at + np.array([3, 0, 0.1]), at, up=(0, 0, 1), fov=1e-3, width=8, height=8)
    image = rw.render(scene, camera, samples=256, progress=False)
    assert_mean(image, 0.8 / math.pi * 3 * 1.740839502734206, most=0.01, slack=1e-4)


@pytest.mark.parametrize(
    ("reflectance", "samples"), [(0.99, 128), pytest.param(0.999, 48, marks=pytest.mark.slow)]
)
def test_bright_boxes_leave_no_heavy_tail(box, reflectance, samples):
    # Emission 1 over the loss per bounce: 100 and 1000.
    scene = rw.Scene(room(box, reflectance, 1.0))
    image = rw.render(scene, inside(size=8), samples=samples, progress=False)
    assert_mean(image, 1 / (1 - reflectance), most=0.02)


@pytest.mark.parametrize("radius", [1.0, 1e-2, 1e-5])
def test_a_sphere_that_shrinks_at_constant_power_lights_alike(radius):
    # E = pi L (R/d)²: with L = 1/R² it does not depend on R.
    ball = rw.Sphere((0, 0, 2), radius, material=rw.Diffuse(0), emission=1 / radius**2)
    scene = rw.Scene([square(9, 0, material=rw.Diffuse(0.8)), ball])
    camera = rw.Camera((3, 0, 0.1), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    assert_mean(rw.render(scene, camera, samples=64, progress=False), 0.8 / 4, slack=1e-4)


@pytest.mark.parametrize("area", [1e-6, 1e-12])
def test_a_tiny_lamp_lights_like_a_point(area):
    side = math.sqrt(area) / 2
    lamp = square(side, 1, up=False, material=rw.Diffuse(0), emission=1 / area)
    scene = rw.Scene([square(9, 0, material=rw.Diffuse(0.8)), lamp])
    camera = rw.Camera((3, 0, 0.1), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    assert_mean(rw.render(scene, camera, samples=16, progress=False), 0.8 / math.pi, slack=1e-4)


@pytest.mark.parametrize("strength", [1e-30, 1e30])
def test_strength_does_not_matter(box, strength):
    image = rw.render(rw.Scene(room(box, 0.5, strength)), inside(), samples=64, progress=False)
    value = float((image.rgb.astype(float) / strength).mean())
    # The error of such a dim or bright picture is in single precision, relative to its own scale.
    assert np.isfinite(image.rgb).all()
    assert abs(value - 2) < 0.02


@pytest.mark.parametrize("integrator", [rw.Path(), rw.Bidirectional()], ids=["path", "bidirectional"])
def test_a_camera_ten_million_away_sees_what_is_there(integrator):
    far = 1e7
    ball = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0), emission=3)
    fov = math.degrees(2 * math.atan(2 / far))
    # Along an axis, directions in float32 would lose nothing.
    camera = rw.Camera(far * OBLIQUE, (0, 0, 0), fov=fov, width=64, height=64)
    image = rw.render(rw.Scene(ball), camera, integrator, samples=16, progress=False)
    # A disk of radius 1 in a window of side 4.
    assert_mean(image, 3 * math.pi / 16, most=0.01, slack=1e-5)
    # Its edge is as sharp as the pixels.
    radius = np.hypot(*np.meshgrid(*[(np.arange(64) + 0.5 - 32) / 16] * 2))
    assert not image.rgb[radius > 1.1].any()
    np.testing.assert_allclose(image.rgb[radius < 0.9], 3)


@pytest.mark.parametrize("integrator", [rw.Path(), rw.Bidirectional()], ids=["path", "bidirectional"])
def test_a_speck_in_a_room_has_a_sharp_edge(integrator):
    # Roundings of directions in float32 would be ten pixels wide.
    size = 1e-7
    speck = rw.Sphere((0, 0, 0), size, material=rw.Diffuse(0), emission=3)
    room = rw.Box((-5, -5, -5), (5, 5, 5), material=rw.Diffuse(0))
    camera = rw.Camera(OBLIQUE, (0, 0, 0), fov=math.degrees(4 * size), width=64, height=64)
    image = rw.render(rw.Scene([speck, room]), camera, integrator, samples=4, progress=False)
    radius = np.hypot(*np.meshgrid(*[(np.arange(64) + 0.5 - 32) / 16] * 2))
    assert not image.rgb[radius > 1.1].any()
    np.testing.assert_allclose(image.rgb[radius < 0.9], 3)


@pytest.mark.parametrize("gap", [1e-6, 1e-3])
def test_sheets_a_millionth_apart_are_two(gap):
    # From below a black sheet hides a lamp; from above the lamp is visible, and nothing leaks either way.
    sheet, lamp = (
        square(5, 0, up=False, material=rw.Diffuse(0)),
        square(5, gap, material=rw.Diffuse(0), emission=2),
    )
    scene = rw.Scene([sheet, lamp])
    below = rw.Camera((0.3, 0.2, -1), (0, 0, 0), width=32, height=32)
    above = rw.Camera((0.3, 0.2, 1), (0, 0, 0), width=32, height=32)
    assert not rw.render(scene, below, samples=16, progress=False).rgb.any()
    np.testing.assert_array_equal(rw.render(scene, above, samples=16, progress=False).rgb, 2)


def test_of_coincident_sheets_one_is_there_and_always_the_same():
    red = square(5, 0, material=rw.Diffuse((0.9, 0, 0)))
    blue = square(5, 0, material=rw.Diffuse((0, 0, 0.9)))
    camera = rw.Camera((0.3, 0.2, 1), (0, 0, 0), fov=60, width=32, height=32)
    for sheets, channel in (([red, blue], 0), ([blue, red], 2)):
        image = rw.render(rw.Scene(sheets, environment=1.0), camera, samples=64, progress=False)
        others = [c for c in range(3) if c != channel]
        assert not image.rgb[..., others].any()
        assert abs(float(image.rgb[..., channel].mean()) - 0.9) < 0.01


def test_a_coarse_ball_has_no_facets_at_its_terminator():
    # Lit from the side, with smooth normals: shading has no step where a facet turns away.
    ball = trimesh.creation.icosphere(2)
    mesh = rw.Mesh(ball.vertices, ball.faces, normals=ball.vertices, material=rw.Diffuse(1.0))
    scene = rw.Scene(mesh, lights=[rw.PointLight((1e4, 0, 0), intensity=math.pi * 1e8)])
    camera = rw.Camera((0, 0, 50), (0, 0, 0), fov=2.0, width=128, height=128)
    image = rw.render(scene, camera, samples=16, progress=False).rgb[..., 1]
    hits = scene.intersect(*camera.rays())
    cosine = np.asarray(hits.position)[..., 0]
    seen = np.asarray(hits.hit) & (np.hypot(hits.position[..., 0], hits.position[..., 1]) < 0.8)
    # At most Lambert's cosine by the smooth normal. At least the rest where the facet turns away as far as
    # facets do: for two normals an angle d apart, G = 1 - tan(t) tan(d) (Chiang et al. 2019).
    corners = ball.vertices[ball.faces]
    tilt = math.tan(np.arccos(np.einsum("fij,fj->fi", corners, ball.face_normals).min()))
    lambert = np.clip(cosine, 0, 1)
    with np.errstate(divide="ignore"):
        g = np.clip(1 - tilt * np.sqrt(1 - lambert**2) / lambert, 0, 1)
    # A pixel is 0.03 wide, and the facets up to 2 % inside of the ball.
    assert (image[seen] <= lambert[seen] + 0.05).all()
    assert (image[seen] >= (lambert * (g + g**2 - g**3))[seen] - 0.05).all()
    assert not image[seen & (cosine < -0.3)].any()
    # Neighbors differ by less than a cut-off at a facet would give: the sine of the tilt.
    step = np.abs(np.diff(image, axis=1))[(seen & np.roll(seen, -1, 1))[:, :-1]]
    assert step.max() < math.sin(math.atan(tilt))


def test_a_lamp_behind_the_camera_lights_what_is_in_front():
    lamp = square(1, 3, up=False, material=rw.Diffuse(0), emission=3)
    scene = rw.Scene([square(9, 0, material=rw.Diffuse(0.8)), lamp])
    camera = rw.Camera((0, 0, 2), (0, 0, 0), up=(0, 1, 0), fov=1e-3, width=8, height=8)
    # Lambert 1760: a square of half side 1 at height 3 from the point below its middle.
    x = 1 / 3
    corner = x / math.sqrt(1 + x * x) * math.atan(x / math.sqrt(1 + x * x))
    # The camera is no obstacle.
    assert_mean(
        rw.render(scene, camera, samples=64, progress=False), 0.8 / math.pi * 3 * 4 * corner, slack=1e-4
    )
