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
        (rw.integrators.Distributed(ambient=(0.5, 0.5, 0.5), splits=2), LIT + 0.4),
    ],
)
def test_each_gives_lamberts_irradiance(integrator, expected):
    # Within four standard errors, which chance exceeds once in 16,000 renders.
    scene, camera = floor_under_a_lamp()
    image = rw.render(scene, camera, integrator, samples=128, progress=False)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
    assert abs(float(image.rgb[..., 1].mean(dtype=float)) - expected) < 4 * error + 1e-5 * expected
    assert error < 0.01 * expected


CHECKED = rw.Checker(0.2, 0.6, 2)  # two cells to a unit; the camera sees one of them


@pytest.mark.parametrize("make", [rw.RayCast, rw.Whitted, rw.integrators.Distributed])
@pytest.mark.parametrize(
    ("material", "share"),
    [
        (rw.materials.Phong(0.5, 0.25, 8, ambient=(0.1, 0.2, 0.7)), (0.1, 0.2, 0.7)),
        (rw.materials.BlinnPhong(0.5, 0.25, 8, ambient=0), 0),
        # By default the diffuse reflectance, without the highlights.
        (rw.materials.Phong(0.5, 0.25), 0.5),
        (rw.materials.BlinnPhong((0.1, 0.2, 0.3), 0.25), (0.1, 0.2, 0.3)),
        (rw.materials.Phong(0.5, 0.25, ambient=CHECKED), 0.2),
        # Mixtures have the mean, with nothing from a mirror; masks and maps have that of their material.
        (rw.Mix(rw.materials.Phong(0.5, 0.25, ambient=0.1), rw.Diffuse(0.7), 0.25), 0.75 * 0.1 + 0.25 * 0.7),
        (rw.Mix(rw.materials.Phong(0.5, 0.25, ambient=0.8), rw.Mirror(), 0.5), 0.4),
        (rw.Mask(rw.materials.Phong(ambient=0.3), 1.0), 0.3),
        (rw.NormalMap(rw.materials.Phong(ambient=0.3), (0.8, 0.5, 0.9)), 0.3),
        (rw.BumpMap(rw.materials.BlinnPhong(ambient=0.3), rw.textures.Noise(), 0.1), 0.3),
        (rw.TwoSided(rw.materials.Phong(ambient=0.3), rw.materials.Phong(ambient=0.9)), 0.3),
        (rw.Diffuse(0.6), 0.6),
        (rw.Mirror(), 0),
    ],
)
def test_ambient_light_times_the_ambient_share_is_added(make, material, share):
    # Phong 1975: k_a I_a; dark and mirrored surfaces show nothing else.
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
    uv = [(0, 0), (1, 0), (1, 1), (0, 1)]
    floor = rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], uv=uv, material=material)
    camera = rw.Camera((-0.2, -0.2, 3), (-0.2, -0.2, 0), fov=1, width=4, height=4)
    light = np.array([1.0, 2.0, 3.0])
    image = rw.render(rw.Scene(floor), camera, make(ambient=light), samples=2, progress=False)
    np.testing.assert_allclose(image.rgb, np.broadcast_to(share * light, (4, 4, 3)), rtol=1e-6)
    assert not rw.render(rw.Scene(floor), camera, make(), samples=2, progress=False).rgb.any()


@pytest.mark.parametrize("make", [rw.RayCast, rw.Whitted])
def test_the_classic_model_is_ambient_diffuse_and_specular(make):
    # A lamp right above, seen from right above, where the highlight is strongest: k_a I_a, k_d / pi of the
    # irradiance, and k_s (n + 2) / 2 pi of it (Lafortune and Willems 1994).
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.materials.Phong(0.4, 0.3, 10, ambient=0.2))
    scene = rw.Scene(floor, lights=[rw.PointLight((0, 0, 2), 8)])
    camera = rw.Camera((0, 0, 1), (0, 0, 0), up=(0, 1, 0), fov=1e-3, width=4, height=4)
    image = rw.render(scene, camera, make(ambient=0.5), samples=2, progress=False)
    expected = 0.2 * 0.5 + 2 * (0.4 / math.pi + 0.3 * 12 / (2 * math.pi))
    np.testing.assert_allclose(image.rgb, expected, rtol=1e-6)


def test_path_of_depth_one_and_direct_are_the_same_estimator():
    scene, camera = rw.scenes.cornell_box(width=24, height=24)
    path = rw.render(scene, camera, rw.Path(max_depth=1), samples=64, progress=False)
    direct = rw.render(scene, camera, rw.Direct(), samples=64, progress=False)
    # Both are paths of one bounce by the same stages.
    np.testing.assert_array_equal(path.rgb, direct.rgb)


def test_ray_casting_without_shadows_is_brighter_where_there_were_some():
    scene, camera = rw.scenes.cornell_box(width=32, height=32)
    shadowed = rw.render(scene, camera, rw.RayCast(), samples=64, progress=False).rgb
    open_ = rw.render(scene, camera, rw.RayCast(shadows=False), samples=64, progress=False).rgb
    # The same draws, some now unblocked: nothing gets darker.
    assert (open_ >= shadowed).all()
    assert (open_ > 2 * shadowed).mean() > 0.05


@pytest.mark.parametrize("threads", [1, 3])
def test_splitting_changes_no_bit_with_threads(threads):
    scene, camera = rw.scenes.cornell_box(width=20, height=20)
    for integrator in (
        rw.Whitted(),
        rw.integrators.Distributed(splits=3),
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
    # The lamp right above occludes its form factor: its irradiance at unit radiance, over pi.
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
        (
            lambda: rw.integrators.Distributed(splits=0),
            ValueError,
            "splits must be between 1 and 1024, got 0",
        ),
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
    all_ = (
        rw.Path(5),
        rw.Direct(),
        rw.RayCast(0.5),
        rw.Whitted(),
        rw.integrators.Distributed(),
        rw.AmbientOcclusion(),
    )
    for integrator in all_:
        assert pickle.loads(pickle.dumps(integrator)) == integrator
        assert sum(integrator == other for other in all_) == 1


def test_plan_tells_what_is_left_out():
    scene, _ = rw.scenes.cornell_box()
    plan = scene.plan()
    assert plan.needed == ("light", "float64 vertices")
    assert "motion" in plan.left_out
    lines = str(plan).splitlines()
    assert len(lines) == 1 + len(plan.rows)
    ball = rw.Scene(rw.Sphere((0, 0, 0), 1))
    assert ball.plan().needed == ("shapes",)
