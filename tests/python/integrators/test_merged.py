"""Paths from both ends that merge: what they share with connections, with photon maps and with paths."""

import math
import pickle
from concurrent.futures import ProcessPoolExecutor

import numpy as np
import pytest
from light_pictures import behind_glass, square

import raywright as rw

SIDE = 16


def picture(scene, camera, way, samples, **options):
    return rw.render(scene, camera, way, samples, progress=False, **options)


def blocks(values, size=4):
    side = values.shape[0] // size
    return values.astype(float).reshape(side, size, side, size, 3).mean((1, 3))


def seeds(scene, camera, way, samples, count, **options):
    """Means over blocks, of pictures of several seeds; their standard error, and the bias that is told."""
    images = [picture(scene, camera, way, samples, seed=seed, **options) for seed in range(count)]
    each = np.array([blocks(image.rgb) for image in images])
    bias = np.zeros(each.shape[1:])
    if images[0].bias is not None:
        bias = np.abs(np.mean([blocks(image.bias) for image in images], 0))
    return each.mean(0), each.std(0, ddof=1) / math.sqrt(count), bias


def assert_agree(ours, theirs):
    """Blocks agree within five of the joint standard errors and twice the bias that is told of both.

    Five standard errors of six pictures are exceeded in one of 250 cases; by two such, far more rarely. Edges
    that no disk of light tells, and noise of the bias, may take 2 %.
    """
    (mean, error, bias), (other, doubt, blur) = ours, theirs
    allowed = 5 * np.hypot(error, doubt) + 2 * (bias + blur) + 0.02 * other + 1e-6
    off = np.abs(mean - other) / allowed
    assert off.max() < 1, off.round(2)
    whole = 5 * math.hypot(error.mean(), doubt.mean()) + 2 * (bias + blur).mean()
    assert abs(mean.mean() - other.mean()) < whole + 0.005 * other.mean()


def test_radii_of_nothing_are_connections_alone():
    # The disk of photons tends to nothing, and with it the weight of merging, down to zero in single
    # precision.
    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    plain = picture(scene, camera, rw.Bidirectional(4), 8)
    merged = picture(scene, camera, rw.Bidirectional(4, vertex_merging=True, radius=1e-6), 8)
    np.testing.assert_allclose(merged.rgb, plain.rgb, rtol=1e-6)
    # Direct light is never merged.
    np.testing.assert_array_equal(
        picture(scene, camera, rw.Bidirectional(1, vertex_merging=True, radius=50.0), 8).rgb,
        picture(scene, camera, rw.Bidirectional(1), 8).rgb,
    )


@pytest.mark.parametrize("depth", [2, None])
def test_a_room_is_that_of_paths(depth):
    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    truth = picture(scene, camera, rw.Path(depth, reuse=1, guiding="none"), 1024)
    error = np.sqrt(blocks(truth.standard_error.astype(float) ** 2) / 16)
    ours = seeds(
        scene, camera, rw.Bidirectional(depth, vertex_merging=True, radius=25.0, photons=2000), 16, 6
    )
    assert_agree(ours, (blocks(truth.rgb), error, 0.0))
    # Merging is active: disks have some bias.
    assert ours[2].max() > 0


def test_a_lamp_and_an_eye_both_behind_glass():
    # Only merging finds a point in glass seen through glass, so that photon maps have the same picture.
    shapes, _ = behind_glass()
    scene = rw.Scene(shapes, lights=[rw.PointLight((0, 0, 1.2), 1.0)])
    look = rw.Camera((0, -3.5, 1.2), (0, 0, 0.1), up=(0, 0, 1), fov=25, width=SIDE, height=SIDE)
    assert picture(scene, look, rw.Bidirectional(), 4).rgb.max() == 0
    # Light held by total reflection would need thousands of bounces.
    merging = rw.Bidirectional(40, vertex_merging=True, radius=0.06, photons=3000)
    progressive = rw.ProgressivePhotonMap(3000, 0.06, max_depth=40)
    ours, theirs = (
        seeds(scene, look, way, 8, 6, sampler=rw.rendering.Sobol(2)) for way in (merging, progressive)
    )
    assert_agree(ours, theirs)
    # No other strategy competes: it is the same estimate by the same photons.
    np.testing.assert_allclose(ours[0], theirs[0], rtol=0.05)


def test_what_moves_is_lit_at_its_time():
    start, end = np.eye(4), np.eye(4)
    start[:3, 3], end[:3, 3] = (-0.6, 0, 0.2), (0.6, 0, 0.2)
    board = rw.Instance(square(0.3, 0.0, material=rw.Diffuse(0.8)), start, transform_end=end)
    floor = square(1.5, 0.0, material=rw.Diffuse(0.4))
    pane = square(2.0, 0.8, material=rw.Dielectric(1.5))
    lamp = square(0.25, 1.2, up=False, material=rw.Diffuse(0), emission=8)
    eye = (0, -2.5, 0.7)
    look = rw.Camera(eye, (0, 0, 0), up=(0, 0, 1), fov=30, width=SIDE, height=SIDE, shutter=(0.0, 1.0))
    scene = rw.Scene([floor, board, pane, lamp])
    truth = picture(scene, look, rw.LightTraced(), 1024)
    error = np.sqrt(blocks(truth.standard_error.astype(float) ** 2) / 16)
    ours = seeds(scene, look, rw.Bidirectional(vertex_merging=True, radius=0.05, photons=3000), 32, 6)
    assert_agree(ours, (blocks(truth.rgb), error, 0.0))


def test_bits_go_by_the_seed_alone(tmp_path):
    scene, look = rw.scenes.cornell_box(width=12, height=10)
    way = rw.Bidirectional(vertex_merging=True)
    options = {"samples": 20, "seed": 5, "progress": False}
    one = rw.render(scene, look, way, threads=1, **options)
    # Photon maps kept with a scene make no difference.
    fresh, _ = rw.scenes.cornell_box(width=12, height=10)
    two = rw.render(fresh, look, way, threads=2, **options)
    for name in ("rgb", "standard_error", "bias"):
        np.testing.assert_array_equal(getattr(one, name), getattr(two, name))
    sampler = one.plan.sampler
    rw.render(scene, look, way, 7, seed=5, checkpoint=tmp_path / "c", sampler=sampler, progress=False)
    later = rw.render(fresh, look, way, checkpoint=tmp_path / "c", **options)
    np.testing.assert_array_equal(later.rgb, one.rgb)
    with ProcessPoolExecutor(2) as executor:
        there = rw.render(scene, look, way, executor=executor, **options)
    np.testing.assert_array_equal(there.rgb, one.rgb)
    assert not np.array_equal(rw.render(scene, look, way, 20, seed=6, progress=False).rgb, one.rgb)


def test_its_bias_is_told():
    scene, look = rw.scenes.cornell_box(width=8, height=8)
    image = picture(scene, look, rw.Bidirectional(vertex_merging=True, radius=60.0), 4)
    assert image.biased
    assert np.abs(image.bias).max() > 0
    # A requested error below the blur raises a warning.
    coarse = rw.Bidirectional(vertex_merging=True, radius=200.0, photons=1000)
    image = rw.render(scene, look, coarse, 64, error=1e-9, progress=False)
    assert any("error=1e-09 is of noise alone" in line for line in image.warnings)
    plain = picture(scene, look, rw.Bidirectional(), 4)
    assert plain.bias is None
    assert not plain.biased


def test_scenes_with_nothing_to_merge_have_pictures():
    look = rw.Camera((0, -3, 0.5), (0, 0, 0.5), up=(0, 0, 1), fov=40, width=6, height=6)
    sky = rw.ConstantEnvironment((0.2, 0.3, 0.4))
    mirrors = rw.Scene(square(3.0, 0.0, material=rw.Mirror(1.0)), environment=sky)
    dark = rw.Scene(square(3.0, 0.0, material=rw.Diffuse(0.5)))
    way = rw.Bidirectional(vertex_merging=True)
    np.testing.assert_allclose(picture(mirrors, look, way, 2).rgb[..., 1], 0.3, rtol=1e-6)
    assert picture(dark, look, way, 2).rgb.max() == 0
    assert picture(dark, look, rw.Bidirectional(0, vertex_merging=True), 2).rgb.max() == 0


def test_it_is_a_value():
    way = rw.Bidirectional(3, vertex_merging=True, radius=0.5)
    assert pickle.loads(pickle.dumps(way)) == way != rw.Bidirectional(3)
    assert way == rw.Bidirectional(3, vertex_merging=True, radius=0.5, photons=None)
