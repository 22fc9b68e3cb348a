"""Light tracing: the pictures of path tracing, by paths that start at lights."""

import math
import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from cornell_picture import cornell_picture
from light_pictures import MATERIALS, SIDE, assert_same, ball, blocks, camera, lamp, square

import raywright as rw


def assert_same_picture(scene, camera, samples=256, paths=256, light=None, path=None):
    ours, theirs = light or rw.LightTraced(), path or rw.Path(reuse=1)
    return assert_same(scene, camera, (ours, samples), (theirs, paths))


@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_scatters_light_as_it_is_seen(name):
    # The geometric normals of twenty triangles are far from the shading normals.
    for divisions in (0, 3):
        scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), lamp(), ball(divisions, MATERIALS[name])])
        assert_same_picture(scene, camera(), paths=1024 if name == "rough glass" else 256)


def test_bumps_textures_masks_and_sides():
    checker = rw.Checker((0.9, 0.2, 0.1), 0.3, 4)
    floor = square(3, 0, material=rw.BumpMap(rw.Diffuse(checker), rw.textures.Noise(), scale=0.2))
    lace = square(0.8, 1.0, material=rw.Mask(rw.Diffuse(0.7), rw.Checker(1, 0.3, 6)))
    wall = rw.Mesh(
        [(-2, 2, 0), (2, 2, 0), (2, 2, 2), (-2, 2, 2)], [(0, 2, 1), (0, 3, 2)], material=rw.Diffuse(0.5)
    )
    assert_same_picture(rw.Scene([floor, lace, wall, lamp()]), camera())


@pytest.mark.parametrize(
    "light",
    [
        rw.PointLight((0.5, 0.2, 2), 6),
        rw.SpotLight((0.5, 0.2, 2), (0, 0, 0), 9, angle=35, falloff=10),
        rw.DirectionalLight((0.3, 0.2, -1), (2, 1, 1)),
        rw.ConstantEnvironment((0.5, 0.7, 1)),
        rw.SunSky((1, 1, 0.8), up=(0, 0, 1)),
    ],
    ids=lambda light: type(light).__name__,
)
def test_every_light_sends_what_is_asked_of_it(light):
    shapes = [square(3, 0, material=rw.Diffuse(0.6)), ball(2, rw.Diffuse(0.8)), rw.Sphere((1, 1, 0.4), 0.4)]
    is_around = isinstance(light, rw.ConstantEnvironment | rw.SunSky)
    scene = rw.Scene(shapes, environment=light) if is_around else rw.Scene(shapes, lights=[light])
    assert_same_picture(scene, camera())


def test_what_shines_in_instances_and_what_moves():
    glow = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 2, 1)], material=rw.Diffuse(0), emission=9)
    places = np.tile(np.eye(4), (3, 1, 1))
    places[:, :3, 3] = [(-1, -1, 1.5), (0.5, 0, 2), (0, 1, 1.2)]
    places[1, 0, 0] = 0.3
    flag = rw.Mesh([(-0.5, 0, 0.5), (0.5, 0, 0.5), (0, 0, 1.2)], [(0, 1, 2)], material=rw.Diffuse(0.9))
    end = np.eye(4)
    end[1, 3] = 1
    moved = rw.Instance([flag], np.eye(4), end)
    scene = rw.Scene([square(3, 0, material=rw.Diffuse(0.6)), rw.Instance([glow], places), moved])
    assert_same_picture(scene, camera())


def test_a_caustic_is_found_with_less_noise():
    # The floor under a ball of glass, from aside; paths are guided, since they would not find it either.
    scene = rw.Scene(
        [
            square(3, 0, material=rw.Diffuse(0.7)),
            rw.Sphere((0, 0, 1.2), 0.5, material=rw.Dielectric(1.5)),
            lamp(height=3.0, size=0.1, radiance=300.0),
        ]
    )
    below = rw.Camera((1.5, -1.5, 0.5), (0, 0, 0), up=(0, 0, 1), fov=20, width=SIDE, height=SIDE)
    ours, _ = assert_same_picture(scene, below, paths=1024, path=rw.Path(reuse=1, guiding="photons"))
    plain = rw.render(scene, below, rw.Path(reuse=1, guiding="none"), 256, progress=False)
    # With other paths than ours, and an eighth of their variance.
    truth = rw.render(scene, below, rw.LightTraced(), 2048, seed=1, progress=False).rgb.astype(float)
    off = [float(np.mean((image.rgb - truth) ** 2 / (truth**2 + 0.01))) for image in (ours, plain)]
    assert off[0] < off[1] / 10


def test_media_that_lie_in_one_another():
    glass = rw.Dielectric(1.5, roughness=0.5, priority=1)
    water = rw.Dielectric(1.33, roughness=0.5)
    scene = rw.Scene(
        [
            square(3, 0, material=rw.Diffuse(0.6)),
            rw.Sphere((0, 0, 0.7), 0.6, material=glass),
            rw.Box((-0.4, -0.4, 0.3), (0.9, 0.4, 1.0), material=water),
            lamp(size=1.0),
        ]
    )
    assert_same_picture(scene, camera())


@pytest.mark.parametrize("depth", [0, 1, 2, 3])
def test_depths_count_bounces(depth):
    scene, look = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    assert_same_picture(scene, look, light=rw.LightTraced(depth), path=rw.Path(depth, reuse=1))


def test_filters_with_negative_lobes():
    scene, look = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    ours, theirs = (
        rw.render(scene, look, way, 400, filter=rw.rendering.LanczosFilter(), progress=False)
        for way in (rw.LightTraced(), rw.Path(reuse=1))
    )
    error = np.sqrt(blocks(ours.standard_error.astype(float) ** 2 + theirs.standard_error.astype(float) ** 2))
    # The mean of 64 independent pixels has an eighth of their error. Light that arrives at the camera by
    # itself spreads over several pixels, whose errors correlate: twice as much is allowed for that.
    assert (np.abs(blocks(ours.rgb) - blocks(theirs.rgb)) < 5 * error / 4).all()


def test_the_error_is_as_told():
    # The interval holds the truth in 95 of 100: fewer than 31 of 36 once in 100 such tests by chance.
    scene, look, truth = cornell_picture(SIDE)
    held = 0
    for seed in range(36):
        image = rw.render(scene, look, rw.LightTraced(), 32, seed=seed, progress=False)
        error = float(np.mean((image.rgb - truth) ** 2 / (truth**2 + 0.01)))
        held += image.error.low <= error <= image.error.high or not image.error.trusted
    assert held >= 31


def test_bits_are_those_of_any_threads_passes_and_executors(tmp_path):
    scene, look = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    options = {"samples": 40, "progress": False}
    one = rw.render(scene, look, rw.LightTraced(), threads=1, **options)
    two = rw.render(scene, look, rw.LightTraced(), threads=2, **options)
    np.testing.assert_array_equal(one.rgb, two.rgb)
    with ThreadPoolExecutor(2) as executor:
        there = rw.render(scene, look, rw.LightTraced(), executor=executor, **options)
    np.testing.assert_array_equal(one.rgb, there.rgb)
    rw.render(
        scene, look, rw.LightTraced(), 17, checkpoint=tmp_path / "c", sampler=one.plan.sampler, progress=False
    )
    later = rw.render(scene, look, rw.LightTraced(), checkpoint=tmp_path / "c", **options)
    np.testing.assert_array_equal(one.rgb, later.rgb)


def test_wrong_input_gets_one_clear_line():
    for arguments, kind, words in [
        ({"max_depth": -1}, ValueError, "max_depth must be between 0 and"),
        ({"max_depth": 2.5}, TypeError, "max_depth must be"),
        ({"roulette_depth": "4"}, TypeError, "roulette_depth must be"),
    ]:
        with pytest.raises(kind, match=words):
            rw.LightTraced(**arguments)
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    with pytest.raises(ValueError, match="use adaptive=False"):
        rw.render(scene, look, rw.LightTraced(), 4, adaptive=True, progress=False)
    endless = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1))], environment=rw.ConstantEnvironment(1))
    with pytest.raises(ValueError, match=r"shape 0, which is unbounded.*use Path"):
        rw.render(endless, look, rw.LightTraced(), 4, progress=False)
    with ThreadPoolExecutor(1) as executor, pytest.raises(ValueError, match="which is unbounded"):
        rw.render(endless, look, rw.LightTraced(), 4, progress=False, executor=executor)


def test_values():
    way = rw.LightTraced(3, roulette_depth=2)
    assert repr(way) == "LightTraced(max_depth=3, roulette_depth=2)"
    assert pickle.loads(pickle.dumps(way)) == way != rw.LightTraced()


def test_what_is_dark_stays_black():
    scene = rw.Scene([square(1, 0, material=rw.Diffuse(0.5))])
    image = rw.render(scene, camera(), rw.LightTraced(), 4, progress=False)
    assert not image.rgb.any()


def test_mitsuba_files_name_it(tmp_path):
    path = tmp_path / "scene.xml"
    path.write_text(
        '<scene version="3.0.0"><integrator type="ptracer"><integer name="max_depth" value="6"/></integrator>'
        '<sensor type="perspective"/><shape type="sphere"/></scene>'
    )
    assert rw.load(path).integrator == rw.LightTraced(5, 4)


def test_a_floor_under_a_lamp_is_as_bright_as_lambert_says():
    scene = rw.Scene(
        [square(9, 0, material=rw.Diffuse(0.8)), square(1, 1, up=False, material=rw.Diffuse(0), emission=3)]
    )
    look = rw.Camera((1.5, 1.5, 0.7), (0, 0, 0), up=(0, 0, 1), fov=2, width=8, height=8)
    image = rw.render(scene, look, rw.LightTraced(), 20_000, progress=False)
    expected = 0.8 / math.pi * 3 * 1.740839502734206  # four times the irradiance of a corner, over pi
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
    assert abs(float(image.rgb[..., 1].mean(dtype=float)) - expected) < 4 * error
    assert error < 0.05 * expected


def test_light_ends_where_nothing_absorbs_it():
    white = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(1.0), emission=rw.Emission(1, side="back"))
    look = rw.Camera((0, 0, 0.5), (0, 0, 0), fov=90, width=4, height=4)
    image = rw.render(rw.Scene(white), look, rw.LightTraced(roulette_depth=2**31), 1, progress=False)
    # Some four thousand bounces, of 1 each.
    assert 1000 < image.rgb.mean() < 20_000
