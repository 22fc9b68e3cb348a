"""Pictures against closed forms: each within four of its own standard errors, and these below 1 %."""

import math

import numpy as np
import pytest
import trimesh

import raywright as rw

# Faces of the conftest's cube look outwards; reversed it is a room.
INWARDS = [0, 2, 1]


def rectangle(corner, side, other, **kwargs):
    """Two triangles whose normal is along side cross other."""
    corner, side, other = (np.array(v, float) for v in (corner, side, other))
    vertices = [corner, corner + side, corner + side + other, corner + other]
    return rw.Mesh(vertices, [(0, 1, 2), (0, 2, 3)], **kwargs)


def room(box, reflectance, emission, scale=1.0, shift=0.0):
    """A closed box from 0 to `scale`, moved by `shift` along all axes, that shines inwards."""
    vertices = np.asarray(box.vertices) * scale + shift
    faces = np.asarray(box.faces)[:, INWARDS]
    return rw.Mesh(vertices, faces, material=rw.Diffuse(reflectance), emission=emission)


def mean(image):
    """Mean of all pixels' channels, and its standard error, were all channels one."""
    count = image.rgb.shape[0] * image.rgb.shape[1]
    variances = np.square(image.standard_error.astype(float)).mean(axis=2)
    return float(image.rgb.mean(dtype=float)), math.sqrt(float(variances.sum())) / count


def assert_mean(image, expected, slack=0.0):
    """`slack` is the relative error of the scene itself, such as a polygon's for a disk."""
    value, error = mean(image)
    # Pixels are rounded to single precision.
    assert abs(value - expected) <= 4 * error + (slack + 1e-6) * expected, (
        f"{value} ± {error}, not {expected}"
    )
    assert error < 0.01 * expected


def radiance_of_floor(lamps, samples=256, reflectance=0.8, **scene):
    """The picture of the origin on a large floor in the plane z = 0, seen from the side."""
    floor = rectangle((-9, -9, 0), (18, 0, 0), (0, 18, 0), material=rw.Diffuse(reflectance))
    camera = rw.Camera((3, 0, 0.1), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    return rw.render(rw.Scene([floor, *lamps], **scene), camera, samples=samples, progress=False)


@pytest.mark.parametrize("reflectance", [0.0, 0.3, 0.6, 0.9])
def test_white_furnace_shines_by_its_geometric_series(box, reflectance):
    camera = rw.Camera((0.5, 0.5, 0.9), (0.4, 0.5, 0), fov=80, width=16, height=16)
    image = rw.render(rw.Scene(room(box, reflectance, 2.0)), camera, samples=64, progress=False)
    assert_mean(image, 2.0 / (1.0 - reflectance))


@pytest.mark.parametrize("depth", [0, 1, 2, 5])
def test_white_furnace_shines_so_many_bounces(box, depth):
    camera = rw.Camera((0.5, 0.5, 0.9), (0.4, 0.5, 0), fov=80, width=16, height=16)
    scene = rw.Scene(room(box, 0.5, 1.0))
    image = rw.render(scene, camera, rw.Path(max_depth=depth), samples=128, progress=False)
    assert_mean(image, 2 - 0.5**depth)


@pytest.mark.parametrize(("scale", "shift"), [(1e-6, 0), (1e6, 0), (1.0, 1e6), (64.0, 1e7), (1e-3, 1.0)])
def test_white_furnace_shines_alike_at_any_size_and_place(box, scale, shift):
    center = np.full(3, shift + scale / 2)
    camera = rw.Camera(center, center + scale * np.array([0.2, 0.1, -1]), fov=80, width=16, height=16)
    furnace = room(box, 0.6, 1.0, scale, shift)
    assert_mean(rw.render(rw.Scene(furnace), camera, samples=64, progress=False), 2.5)


def test_bright_furnace_leaves_no_heavy_tail(box):
    camera = rw.Camera((0.5, 0.5, 0.9), (0.4, 0.5, 0), fov=80, width=8, height=8)
    image = rw.render(rw.Scene(room(box, 0.99, 0.1)), camera, samples=256, progress=False)
    assert_mean(image, 10.0)


def test_no_light_comes_into_a_closed_box(box):
    # Through 12 faces that meet in 8 corners, from a sky of radiance 10⁶, to 262,144 paths of many bounces.
    camera = rw.Camera((0.5, 0.5, 0.9), (0.4, 0.5, 0), fov=120, width=64, height=64)
    scene = rw.Scene(room(box, 0.9, 0.0), environment=1e6)
    assert not rw.render(scene, camera, samples=64, progress=False).rgb.any()


@pytest.mark.parametrize("gap", [1e-5, 1e-2])
def test_no_light_leaks_through_a_thin_plate(gap):
    # A lamp above a plate, and a floor right below it.
    plate = rectangle((-50, -50, gap), (100, 0, 0), (0, 100, 0))
    lamp = rectangle((-50, -50, 1), (0, 100, 0), (100, 0, 0), material=rw.Diffuse(0), emission=1e6)
    floor = rectangle((-50, -50, 0), (100, 0, 0), (0, 100, 0))
    camera = rw.Camera((0, 0, -1), (0.1, 0.1, 0), fov=90, width=32, height=32)
    lit_from_above = rw.Scene([plate, lamp, floor])
    assert not rw.render(lit_from_above, camera, samples=16, progress=False).rgb.any()
    # Between both, the camera looks down at a floor that only the plate's underside could light.
    camera = rw.Camera((0, 0, gap / 2), (1, 1, 0.49 * gap), up=(0, 0, 1), width=32, height=32)
    picture = rw.render(lit_from_above, camera, rw.Path(max_depth=4), samples=16, progress=False)
    assert not picture.rgb.any()


def test_rectangle_lamp_gives_lamberts_irradiance():
    # 2 by 2 at height 1, right above: four times the closed form of a corner (Lambert 1760).
    lamp = rectangle((-1, -1, 1), (0, 2, 0), (2, 0, 0), material=rw.Diffuse(0), emission=3)
    assert_mean(radiance_of_floor([lamp]), 0.8 / math.pi * 3 * 1.740839502734206)


def test_triangle_lamp_gives_lamberts_irradiance():
    corners = [(0, 0, 1), (0, 1, 1), (1, 0, 1)]
    lamp = rw.Mesh(corners, [(0, 1, 2)], material=rw.Diffuse(0), emission=3)
    assert_mean(radiance_of_floor([lamp]), 0.8 / math.pi * 3 * 0.30229989403903634)


@pytest.mark.parametrize(("radius", "height"), [(1.0, 1.0), (0.01, 1.0), (2.0, 0.25)])
def test_disk_lamp_gives_the_textbook_irradiance(radius, height):
    # E = π L r² / (r² + h²); the disk is a polygon of 720 sides, inscribed.
    around = np.arange(720) * (2 * np.pi / 720)
    rim = np.stack([radius * np.cos(around), radius * np.sin(around), np.full(720, height)], axis=1)
    faces = [(720, (i + 1) % 720, i) for i in range(720)]
    lamp = rw.Mesh(np.vstack([rim, (0, 0, height)]), faces, material=rw.Diffuse(0), emission=3)
    expected = 0.8 * 3 * radius**2 / (radius**2 + height**2)
    assert_mean(radiance_of_floor([lamp], samples=512), expected, slack=2e-5)


def test_sphere_lamp_gives_the_textbook_irradiance():
    # E = π L (R/d)² for a sphere of radius R right above at distance d; the mesh has the sphere's area.
    ball = sphere(5)
    lamp = rw.Mesh(0.5 * ball.vertices + (0, 0, 2), ball.faces, material=rw.Diffuse(0), emission=3)
    assert_mean(radiance_of_floor([lamp], samples=1024), 0.8 * 3 / 16, slack=1e-3)


def test_point_light_gives_the_inverse_square():
    light = rw.PointLight((1, 0, 1), intensity=5)
    image = radiance_of_floor([], samples=4, lights=[light])
    assert_mean(image, 0.8 / math.pi * 5 * 0.35355339059327373, slack=1e-4)


def test_sky_gives_pi_and_lights_add_up():
    assert_mean(radiance_of_floor([], environment=2.0), 0.8 * 2)
    lamp = rectangle((-1, -1, 1), (0, 2, 0), (2, 0, 0), material=rw.Diffuse(0), emission=3)
    light = rw.PointLight((0, 4, 2), intensity=5)
    # The lamp hides the part of the sky that it would light if both were equally bright.
    share = 1.740839502734206 / math.pi
    expected = 0.8 * (3 * share + 2 * (1 - share) + 5 / math.pi * 2 / 20**1.5)
    assert_mean(
        radiance_of_floor([lamp], samples=1024, environment=2.0, lights=[light]), expected, slack=1e-4
    )


def sphere(subdivisions):
    """A ball of many faces with the surface of the unit sphere: its mean shadow is π (Cauchy)."""
    ball = trimesh.creation.icosphere(subdivisions)
    ball.vertices *= math.sqrt(4 * math.pi / ball.area)
    return ball


@pytest.mark.parametrize(("phase_angle", "phase"), [(0.0, 1.0), (90.0, 1 / math.pi)])
def test_lambert_sphere_under_a_distant_light_has_its_phase_function(phase_angle, phase):
    # At phase angle a, a sphere of reflectance r under irradiance E reflects r E R² 2/3 f(a) per solid angle,
    # with f(a) = (sin a + (pi - a) cos a) / pi (Lambert 1760; Sobolev 1975).
    ball = sphere(5)
    far, fov, size = 1000.0, 0.15, 64
    angle = math.radians(phase_angle)
    light = rw.PointLight((far * math.sin(angle), 0, far * math.cos(angle)), intensity=2 * far**2)
    scene = rw.Scene(rw.Mesh(ball.vertices, ball.faces, material=rw.Diffuse(0.8)), lights=[light])
    camera = rw.Camera((0, 0, far), (0, 0, 0), fov=fov, width=size, height=size)
    image = rw.render(scene, camera, samples=64, progress=False)
    window = (2 * far * math.tan(math.radians(fov) / 2)) ** 2
    # The faces are flat, and the light and the camera 1000 radii away.
    assert_mean(image, 0.8 * 2 * 2 / 3 * phase / window, slack=3e-3)


def test_smooth_normals_leak_no_light():
    # A coarse ball, lit from behind: the side towards the camera must be black for any shading normals.
    ball = trimesh.creation.icosphere(1)
    mesh = rw.Mesh(ball.vertices, ball.faces, normals=ball.vertices, material=rw.Diffuse(0.8))
    scene = rw.Scene(mesh, lights=[rw.PointLight((0, 0, -1000), intensity=1e6)])
    camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=15, width=64, height=64)
    assert not rw.render(scene, camera, samples=16, progress=False).rgb.any()
    in_front = rw.Scene(mesh, lights=[rw.PointLight((0, 0, 1000), intensity=1e6)])
    assert (rw.render(in_front, camera, samples=16, progress=False).rgb[16:48, 16:48] > 0).all()
