"""Shading normals that are taken as they are given: light counts by its cosine to them, and does not fade."""

import pickle

import numpy as np
import pytest

import raywright as rw

GRAY, BLACK = rw.Diffuse(0.8), rw.Diffuse(0.0)
LEANING = np.array([0.6, 0.0, 0.8])
LIGHT = 3.0


def floor(normal, material=GRAY):
    """A square of 2 by 2 in the plane z = 0 whose vertices have a normal, with u along x and v along y."""
    corners = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    normals = None if normal is None else np.tile(normal, (4, 1))
    uv = 0.5 * (corners[:, :2] + 1)
    return rw.Mesh(corners, [[0, 1, 2], [0, 2, 3]], normals=normals, uv=uv, material=material)


def unit(*vector):
    return np.array(vector) / np.linalg.norm(vector)


def seen(shape, lights=(), sky=None, towards=(0, 0, 1), way=None, mode="raw", samples=4):
    """Return the mean radiance of the square from a direction, and its standard error."""
    towards = unit(*towards)
    up = (0, 1, 0) if abs(towards[1]) < 0.9 else (1, 0, 0)
    eye = rw.Camera(tuple(4 * towards), (0, 0, 0), up=up, fov=1.0, width=2, height=2)
    scene = rw.Scene(shape, lights, sky, shading_normals=mode)
    image = rw.render(scene, eye, way or rw.Direct(), samples=samples, progress=False)
    return image.rgb[..., 0].mean(), np.sqrt((image.standard_error[..., 0] ** 2).mean() / 4)


def lit_from(towards):
    return [rw.DirectionalLight(tuple(-unit(*towards)), LIGHT)]


@pytest.mark.parametrize(
    "towards", [(0, 0, 1), (-0.3, 0.2, 1), (0.9, 0, 0.3), (0.2, -2, 0.4), (-0.95, 0, 0.2)]
)
def test_light_counts_by_its_cosine_to_the_shading_normal(towards):
    expected = 0.8 / np.pi * LIGHT * max(0.0, unit(*towards) @ LEANING)
    assert np.isclose(seen(floor(LEANING), lit_from(towards))[0], expected, rtol=1e-6, atol=1e-12)
    faded = seen(floor(LEANING), lit_from(towards), mode="faded")[0]
    assert faded <= expected * (1 + 1e-6)
    if towards == (0.9, 0, 0.3):
        # Grazing for the face, and high above its shading normal.
        assert faded < 0.7 * expected


def test_a_face_is_not_lit_from_its_other_side():
    # Above the horizon of the shading normal, and below that of the face.
    assert unit(1, 0, -0.2) @ LEANING > 0
    assert seen(floor(LEANING), lit_from((1, 0, -0.2)))[0] == 0


def test_who_sees_a_shading_normal_from_behind_sees_that_side():
    towards = (-1, 0, 0.5)
    assert unit(*towards) @ LEANING < 0
    # Lit from above the face, from either side of the shading normal.
    before, behind = unit(0.5, 0, 1), unit(-1, 0, 0.3)
    two = rw.TwoSided(rw.Diffuse(0.25), rw.Diffuse(0.75))
    for material, share in ((GRAY, 0.8), (two, 0.75), (rw.TwoSided(GRAY, BLACK), 0.0)):
        shape = floor(LEANING, material)
        assert seen(shape, lit_from(before), towards=towards)[0] == 0
        expected = share / np.pi * LIGHT * -(behind @ LEANING)
        assert np.isclose(seen(shape, lit_from(behind), towards=towards)[0], expected, rtol=1e-6)


def shadowing(normal, light, own=(0, 0, 1)):
    """Estevez, Lecocq and Stein (2019), by slopes."""

    def square_of_tangent(vector):
        cosine = np.dot(vector, own)
        return (1 - cosine**2) / cosine**2

    return 2 / (1 + np.sqrt(1 + min(square_of_tangent(normal) / 8, 1) * square_of_tangent(light)))


def mapped(normal, material=GRAY):
    colors = np.array(0.5 * (np.asarray(normal) + 1), np.float32).reshape(1, 1, 3)
    return rw.NormalMap(material, rw.ImageTexture(colors, linear=True))


@pytest.mark.parametrize("lean", [LEANING, unit(0.3, -0.4, 1), unit(-2, 1, 0.2)])
@pytest.mark.parametrize("towards", [(0, 0, 1), (-0.5, 0.4, 1), (0.9, 0, 0.2)])
def test_maps_let_facets_stand_in_the_light(lean, towards):
    light = unit(*towards)
    expected = 0.8 / np.pi * LIGHT * max(0.0, light @ lean) * shadowing(lean, light)
    assert np.isclose(seen(floor(None, mapped(lean)), lit_from(light))[0], expected, rtol=1e-5, atol=1e-12)


def test_a_bump_leans_by_its_slope_alone():
    """The plane of height u / 2 over 2 u of x, whose normal leans by 1/4 of its height."""
    ramp = np.linspace(0, 1, 64, dtype=np.float32)[None, :, None]
    # Between the centers of texels, u goes from 1/128 to 127/128.
    bump = rw.BumpMap(GRAY, rw.ImageTexture(ramp, linear=True, wrap="clamp"), 0.5 * 63 / 64)
    lean = unit(-0.25, 0, 1)
    for towards in ((0, 0, 1), (-0.5, 0.4, 1)):
        light = unit(*towards)
        expected = 0.8 / np.pi * LIGHT * (light @ lean) * shadowing(lean, light)
        assert np.isclose(seen(floor(None, bump), lit_from(light))[0], expected, rtol=1e-4)


def test_a_mapped_normal_that_is_seen_from_behind_is_turned_half_round():
    lean, towards = unit(2, 0, 1), unit(-1, 0, 0.3)
    assert towards @ lean < 0
    turned, light = lean * (-1, -1, 1), unit(-0.2, 0.3, 1)
    expected = 0.8 / np.pi * LIGHT * (light @ turned) * shadowing(turned, light)
    got = seen(floor(None, mapped(lean)), lit_from(light), towards=towards)[0]
    assert np.isclose(got, expected, rtol=1e-5)


WAYS = [
    rw.Direct(),
    rw.Path(max_depth=2),
    rw.Path(max_depth=2, reuse=4),
    rw.Path(max_depth=2, guiding="photons"),
    rw.Bidirectional(max_depth=2),
]


@pytest.mark.parametrize("way", WAYS, ids=repr)
def test_an_even_sky_lights_what_of_it_is_above_both_horizons(way):
    """The integral of the cosine to a normal that leans by θ, above the face: π (1 + cos θ) / 2."""
    got, error = seen(floor(LEANING), sky=1.0, way=way, samples=1024)
    expected = 0.8 * 0.5 * (1 + LEANING[2])
    # 4 standard errors: wrong once in 15,000 runs.
    assert abs(got - expected) < 4 * error
    assert error < 0.01


@pytest.mark.parametrize("way", [rw.Bidirectional(max_depth=3), rw.LightTraced(max_depth=3)], ids=repr)
def test_light_from_lights_scatters_as_seen_from_the_camera(way):
    """Normals that lean both ways, and one from a map, between a lamp and the camera."""
    lean = unit(0.5, 0.2, 1)
    square = floor(lean, mapped(unit(0.3, -0.6, 1)))
    wall = rw.Mesh(
        [[1.5, -1, 0], [1.5, 1, 0], [1.5, 1, 2], [1.5, -1, 2]], [[0, 1, 2], [0, 2, 3]], material=GRAY
    )
    lamp = rw.Sphere((0.5, 0.3, 2.0), 0.4, material=BLACK, emission=4.0)
    scene = rw.Scene([square, wall, lamp], shading_normals="raw")
    eye = rw.Camera((-2, -1, 2), (0, 0, 0), up=(0, 0, 1), fov=30, width=8, height=8)
    one = rw.render(scene, eye, rw.Path(max_depth=3), samples=512, seed=1, progress=False)
    two = rw.render(scene, eye, way, samples=512, seed=2, progress=False)
    error = np.sqrt((one.standard_error**2 + two.standard_error**2).sum((0, 1)))[0] / 64
    assert abs(one.rgb.mean() - two.rgb.mean()) < 4 * error
    assert error < 0.03 * one.rgb.mean()


def test_what_has_no_normals_of_its_own_keeps_its_bits():
    scene, eye = rw.scenes.cornell_box(width=16, height=16)
    given = scene.replace(shading_normals="raw")
    pictures = [rw.render(one, eye, samples=4, progress=False).rgb for one in (scene, given)]
    assert np.array_equal(*pictures)
    assert repr(given.plan()) == repr(scene.plan())


def test_a_plan_tells_of_normals_as_given():
    smooth = rw.Scene(floor(LEANING), shading_normals="raw")
    assert "normals as given" in smooth.plan().needed
    assert "normals as given" not in smooth.replace(shading_normals="faded").plan().needed


def test_scenes_remember_it():
    scene = rw.Scene(floor(LEANING), shading_normals="raw")
    assert scene.shading_normals == "raw"
    assert rw.Scene([]).shading_normals == "faded"
    assert scene != scene.replace(shading_normals="faded")
    assert pickle.loads(pickle.dumps(scene)) == scene
    assert "shading_normals='raw'" in repr(scene)
    scene.build(progress=False)
    scene.refit(np.add(scene.shapes[0].vertices, 0.5))
    assert "normals as given" in scene.plan().needed
    with pytest.raises(ValueError, match="shading_normals must be one of 'faded', 'raw', got 'smooth'"):
        rw.Scene([], shading_normals="smooth")
