"""Integrators beside one another, against closed forms, and what they refuse."""

import math
import pickle

import numpy as np
import pytest

import raywright as rw


def floor_under_a_lamp():
    """A floor of 0.8, a lamp of side 2 and radiance 3 at height 1, and a camera on the point below it."""

    def square(size, height, *, up, **kwargs):
        corners = [(-size, -size, height), (size, -size, height), (size, size, height), (-size, size, height)]
        faces = [(0, 1, 2), (0, 2, 3)] if up else [(0, 2, 1), (0, 3, 2)]
        return rw.Mesh(corners, faces, **kwargs)

    floor = square(9, 0, up=True, material=rw.Diffuse(0.8))
    lamp = square(1, 1, up=False, material=rw.Diffuse(0), emission=3)
    camera = rw.Camera((3, 0, 0.1), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
    return rw.Scene([floor, lamp]), camera


# Four times the irradiance of a corner (Lambert 1760), over pi.
LIT = 0.8 / math.pi * 3 * 1.740839502734206


@pytest.mark.parametrize(
    ("integrator", "expected"),
    [
        (rw.Path(), LIT),
        (rw.Direct(light_samples=3, surface_samples=2), LIT),
        (rw.RayCast(ambient=0.5), LIT + 0.4),
        (rw.Whitted(ambient=0.5), LIT + 0.4),
        (rw.Distributed(ambient=(0.5, 0.5, 0.5), splits=2), LIT + 0.4),
    ],
)
def test_each_gives_lamberts_irradiance(integrator, expected):
    # Within four standard errors, which chance exceeds once in 16,000 renders.
    scene, camera = floor_under_a_lamp()
    image = rw.render(scene, camera, integrator, samples=128, progress=False)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
    assert abs(float(image.rgb[..., 1].mean(dtype=float)) - expected) < 4 * error + 1e-5 * expected
    assert error < 0.01 * expected


def test_path_of_depth_one_and_direct_are_the_same_estimator():
    scene, camera = rw.scenes.cornell_box(width=24, height=24)
    path = rw.render(scene, camera, rw.Path(max_depth=1), samples=64, progress=False)
    direct = rw.render(scene, camera, rw.Direct(), samples=64, progress=False)
    # The special kernel and the general one: the same numbers, the same bits.
    np.testing.assert_array_equal(path.rgb, direct.rgb)


def test_ray_casting_without_shadows_is_brighter_where_there_were_some():
    scene, camera = rw.scenes.cornell_box(width=32, height=32)
    shadowed = rw.render(scene, camera, rw.RayCast(), samples=64, progress=False).rgb
    open_ = rw.render(scene, camera, rw.RayCast(shadows=False), samples=64, progress=False).rgb
    # The same draws, of which some are not blocked: nothing gets darker.
    assert (open_ >= shadowed).all()
    assert (open_ > 2 * shadowed).mean() > 0.05


@pytest.mark.parametrize("threads", [1, 3])
def test_splitting_changes_no_bit_with_threads(threads):
    scene, camera = rw.scenes.cornell_box(width=20, height=20)
    for integrator in (
        rw.Whitted(),
        rw.Distributed(splits=3),
        rw.AmbientOcclusion(samples=5),
        rw.Direct(4, 4),
    ):
        one = rw.render(scene, camera, integrator, samples=8, progress=False, threads=2)
        other = rw.render(scene, camera, integrator, samples=8, progress=False, threads=threads)
        np.testing.assert_array_equal(one.rgb, other.rgb)


def test_occlusion_of_a_floor_without_surroundings_is_none():
    scene, camera = floor_under_a_lamp()
    near = rw.render(scene, camera, rw.AmbientOcclusion(radius=0.99), samples=4, progress=False)
    np.testing.assert_array_equal(near.rgb, 1)
    # The lamp right above hides what it would light, were it as bright as what it hides.
    far = rw.render(scene, camera, rw.AmbientOcclusion(samples=16), samples=64, progress=False)
    expected = 1 - 1.740839502734206 / math.pi
    error = math.sqrt(float(np.square(far.standard_error[..., 1].astype(float)).sum())) / 64
    assert abs(float(far.rgb[..., 1].mean(dtype=float)) - expected) < 4 * error + 1e-5


@pytest.mark.parametrize(
    ("make", "kind", "message"),
    [
        (lambda: rw.Direct(light_samples=0), ValueError, "light_samples must be between 1 and 1024, got 0"),
        (lambda: rw.Direct(surface_samples=2.5), TypeError, "surface_samples must be an integer, got 2.5"),
        (lambda: rw.RayCast(ambient=-1), ValueError, "ambient must be at least 0, got -1"),
        (lambda: rw.RayCast(ambient=math.nan), ValueError, "ambient must be finite"),
        (lambda: rw.RayCast(shadows=1), TypeError, "shadows must be True or False, got 1"),
        (
            lambda: rw.Whitted(contribution=1),
            ValueError,
            "contribution must be at least 0 and below 1, got 1",
        ),
        (lambda: rw.Whitted(max_depth=-1), ValueError, "max_depth must be between 0 and"),
        (lambda: rw.Distributed(splits=0), ValueError, "splits must be between 1 and 1024, got 0"),
        (lambda: rw.AmbientOcclusion(radius=0), ValueError, "radius must be greater than 0, got 0"),
        (lambda: rw.AmbientOcclusion(radius=math.nan), ValueError, "radius must be finite, got nan"),
        (lambda: rw.AmbientOcclusion(cosine="yes"), TypeError, "cosine must be True or False, got 'yes'"),
    ],
)
def test_nonsense_is_refused_with_one_line(make, kind, message):
    with pytest.raises(kind, match=message) as raised:
        make()
    assert "\n" not in str(raised.value)


def test_integrators_compare_and_pickle():
    all_ = (rw.Path(5), rw.Direct(), rw.RayCast(0.5), rw.Whitted(), rw.Distributed(), rw.AmbientOcclusion())
    for integrator in all_:
        assert pickle.loads(pickle.dumps(integrator)) == integrator
        assert sum(integrator == other for other in all_) == 1


def test_plan_tells_what_is_left_out():
    scene, _ = rw.scenes.cornell_box()
    plan = scene.plan()
    assert plan.kernel == "plain"
    assert plan.needed == ("light",)
    assert "motion" in plan.left_out
    lines = str(plan).splitlines()
    assert len(lines) == 1 + len(plan.rows)
    ball = rw.Scene(rw.Sphere((0, 0, 0), 1))
    assert ball.plan().needed == ("shapes",)
