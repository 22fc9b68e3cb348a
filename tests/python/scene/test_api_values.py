"""Materials, lights, cameras, integrators and accelerators: what they keep and what they refuse."""

import math
import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import raywright as rw

VALUES = [
    rw.Diffuse((0.1, 0.2, 0.3)),
    rw.PointLight((1, 2, 3), 4),
    rw.ConstantEnvironment(2),
    rw.Camera((0, 0, 5), (0, 0, 0)),
    rw.Path(max_depth=3),
    rw.BVH(bins=8),
    rw.accelerators.KdTree(max_depth=9),
    rw.accelerators.Octree(),
    rw.accelerators.BSP(leaf_size=3),
    rw.accelerators.Grid(resolution=(4, 5, 6)),
    rw.accelerators.NestedGrid(resolution=7),
    rw.BruteForce(),
    rw.rendering.ErrorEstimate(math.nan, math.nan, math.nan),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda v: type(v).__name__)
def test_values_pickle_compare_hash_and_print(value):
    back = pickle.loads(pickle.dumps(value))
    assert back == value
    assert hash(back) == hash(value)
    assert repr(back) == repr(value)
    assert repr(value).startswith(type(value).__name__ + "(")
    assert "\n" not in repr(value)


@pytest.mark.parametrize(
    ("value", "name"),
    [(rw.Diffuse(), "reflectance"), (rw.Path(), "max_depth"), (rw.BVH(), "bins"), (VALUES[3], "fov")],
)
def test_values_are_frozen(value, name):
    with pytest.raises(FrozenInstanceError):
        setattr(value, name, 1)


@pytest.mark.parametrize(
    ("kept", "expected"),
    [
        (rw.Diffuse().reflectance, (0.5, 0.5, 0.5)),
        (rw.Diffuse(1).reflectance, (1.0, 1.0, 1.0)),
        (rw.Diffuse(np.array([0, 0.25, 1], np.float32)).reflectance, (0.0, 0.25, 1.0)),
        (rw.PointLight(np.arange(3), 2).position, (0.0, 1.0, 2.0)),
        (rw.PointLight((0, 0, 0), 2).intensity, (2.0, 2.0, 2.0)),
        (rw.ConstantEnvironment().radiance, (1.0, 1.0, 1.0)),
        (rw.Camera([0, 0, 1], np.zeros(3)).position, (0.0, 0.0, 1.0)),
        (rw.Camera([0, 0, 1], np.zeros(3), fov=np.float32(60)).fov, 60.0),
        (rw.Camera((0, 0, 1), (0, 0, 0), width=np.int16(7)).width, 7),
        (rw.Path().max_depth, None),
    ],
)
def test_numbers_are_kept_as_plain_python(kept, expected):
    assert kept == expected
    assert type(kept) is type(expected)
    if isinstance(kept, tuple):
        assert {type(x) for x in kept} == {float}


def test_camera_keeps_the_dimensions_of_extreme_scenes():
    for scale in (1e-300, 1e-6, 1e7, 1e300):
        camera = rw.Camera((0, 0, scale), (0, 0, 0), up=(0, scale, 0))
        assert camera.position == (0, 0, scale)


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: rw.Diffuse(1.5), ValueError, r"reflectance must be between 0 and 1, got 1.5"),
        (lambda: rw.Diffuse(-0.1), ValueError, r"reflectance must be between 0 and 1, got -0.1"),
        (
            lambda: rw.Diffuse((0.1, 0.2)),
            ValueError,
            r"reflectance must be one number or 3, got shape \(2,\)",
        ),
        (lambda: rw.Diffuse("red"), TypeError, r"reflectance must be real numbers, got 'red'"),
        (lambda: rw.Diffuse(math.nan), ValueError, r"reflectance must be finite"),
        (lambda: rw.PointLight((0, 0), 1), ValueError, r"position must be 3 numbers, got shape \(2,\)"),
        (lambda: rw.PointLight((0, 0, math.inf), 1), ValueError, r"position must be finite"),
        (lambda: rw.PointLight((0, 0, 0), -1), ValueError, r"intensity must be at least 0, got -1"),
        (lambda: rw.ConstantEnvironment(-1), ValueError, r"radiance must be at least 0, got -1"),
        (lambda: rw.ConstantEnvironment(None), TypeError, r"radiance must be real numbers, got None"),
        (lambda: rw.Camera((1, 2, 3), (1, 2, 3)), ValueError, r"position and target must differ"),
        (lambda: rw.Camera((0, 5, 0), (0, 0, 0)), ValueError, r"up must not be parallel to the view"),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), (0, 0, -2)),
            ValueError,
            r"up must not be parallel to the view",
        ),
        (lambda: rw.Camera((0, 0, 5), (0, 0, 0), (0, 0, 0)), ValueError, r"up must not be zero"),
        (lambda: rw.Camera((0, 0, math.nan), (0, 0, 0)), ValueError, r"position must be finite"),
        (lambda: rw.Camera((0, 0, 5), (0, 0)), ValueError, r"target must be 3 numbers, got shape \(2,\)"),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), fov=0),
            ValueError,
            r"fov must be between 0 and 180 degrees, got 0",
        ),
        (lambda: rw.Camera((0, 0, 5), (0, 0, 0), fov=180), ValueError, r"fov must be between 0 and 180"),
        (lambda: rw.Camera((0, 0, 5), (0, 0, 0), fov=math.nan), ValueError, r"fov must be finite"),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), fov="wide"),
            TypeError,
            r"fov must be real numbers, got 'wide'",
        ),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), width=0),
            ValueError,
            r"width must be between 1 and 65536, got 0",
        ),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), height=-3),
            ValueError,
            r"height must be between 1 and 65536",
        ),
        (
            lambda: rw.Camera((0, 0, 5), (0, 0, 0), width=64.0),
            TypeError,
            r"width must be an integer, got 64.0",
        ),
        (lambda: rw.Path(max_depth=-1), ValueError, r"max_depth must be between 0 and \d+, got -1"),
        (lambda: rw.Path(max_depth=2.5), TypeError, r"max_depth must be an integer, got 2.5"),
        (lambda: rw.Path(roulette_depth=None), TypeError, r"roulette_depth must be an integer, got None"),
        (
            lambda: rw.Scene([], precision="half"),
            ValueError,
            r"precision must be one of 'auto', 'single', 'double', got 'half'",
        ),
        (
            lambda: rw.Scene([], quality=3),
            ValueError,
            r"quality must be one of 'low', 'medium', 'high', got 3",
        ),
        (lambda: rw.BVH("magic"), ValueError, r"builder must be one of 'binned', .*, got 'magic'"),
        (lambda: rw.BVH(bins=1), ValueError, r"bins must be between 2 and 64, got 1"),
        (lambda: rw.BVH(bins=True), TypeError, r"bins must be an integer, got True"),
        (lambda: rw.BVH(traversal_cost=0), ValueError, r"traversal_cost must be greater than 0, got 0"),
        (
            lambda: rw.BVH(intersection_cost=math.inf),
            ValueError,
            r"intersection_cost must be finite, got inf",
        ),
    ],
)
def test_bad_values_are_refused_in_one_line(call, error, message):
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("size", [(1, 1), (5, 3)])
def test_camera_rays_pass_through_the_pixels(size):
    width, height = size
    camera = rw.Camera((1, 2, 3), (1, 2, 0), fov=90, width=width, height=height)
    origins, directions = camera.rays()
    assert origins.shape == directions.shape == (height, width, 3)
    assert np.array_equal(origins, np.broadcast_to((1.0, 2, 3), origins.shape))
    # At distance 1 the picture is 2 high and spans x to the right, y up; row 0 is the top.
    x = (np.arange(width) + 0.5) * (2 / height) - width / height
    y = 1 - (np.arange(height) + 0.5) * (2 / height)
    onto = directions / -directions[..., 2:]
    assert np.allclose(onto[..., 0], x[np.newaxis], atol=1e-14)
    assert np.allclose(onto[..., 1], y[:, np.newaxis], atol=1e-14)


def test_camera_rays_may_pass_anywhere_through_the_pixels():
    camera = rw.Camera((1, 2, 3), (1, 2, 0), fov=90, width=6, height=4)
    offsets = np.random.default_rng(1).random((4, 6, 2))
    _, directions = camera.rays(offsets)
    onto = directions / -directions[..., 2:]
    assert np.allclose(onto[..., 0], (np.arange(6) + offsets[..., 0]) / 2 - 1.5, atol=1e-14)
    assert np.allclose(onto[..., 1], 1 - (np.arange(4)[:, None] + offsets[..., 1]) / 2, atol=1e-14)
    corner = camera.rays((0, 0))[1][0, 0]
    assert np.allclose(corner / -corner[2], (-1.5, 1, -1), atol=1e-14)


def test_camera_rays_have_the_type_asked_for():
    camera = rw.Camera((1, 2, 3), (1, 2, 0), width=3, height=2)
    for dtype in (np.float32, np.float64, "float32"):
        for array, exact in zip(camera.rays(dtype=dtype), camera.rays(), strict=True):
            assert array.dtype == dtype
            assert np.array_equal(array, exact.astype(dtype))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ({"offsets": (0.5, 0.5, 0.5)}, ValueError, r"offsets must have shape \(\.\.\., 2\), got \(3,\)"),
        (
            {"offsets": np.zeros((6, 4, 2))},
            ValueError,
            r"offsets must have shape .*\(4, 6, 2\), got \(6, 4, 2\)",
        ),
        ({"offsets": "center"}, TypeError, r"offsets must be real numbers, got 'center'"),
        ({"dtype": np.int32}, ValueError, r"dtype must be float32 or float64, got int32"),
    ],
)
def test_bad_offsets_are_refused_in_one_line(arguments, error, message):
    with pytest.raises(error, match=message):
        rw.Camera((1, 2, 3), (1, 2, 0), width=6, height=4).rays(**arguments)
