"""The rays that reports use: from where they come, where they go, and how they are thinned."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import raywright as rw
from raywright.report import Rays, typical_rays

KNOT = rw.scenes.torus_knot(along=60, around=10)
CAMERA = rw.Camera((0, 0, 5), (0, 0, 0), width=120, height=100)
LAMP = rw.Mesh([(-1, 3, -1), (1, 3, -1), (1, 3, 1), (-1, 3, 1)], [(0, 1, 2), (0, 2, 3)], emission=5.0)


def test_primary_rays_are_the_cameras():
    primary = typical_rays(rw.Scene(KNOT), CAMERA)["primary"]
    origins, directions = CAMERA.rays()
    assert np.array_equal(primary.origins, origins)
    assert np.array_equal(primary.directions, directions)
    assert not primary.any_hit


def test_without_a_camera_all_of_the_scene_is_seen_from_outside():
    scene = rw.Scene(KNOT)
    primary = typical_rays(scene)["primary"]
    hit = scene.intersect(primary.origins, primary.directions).hit
    assert hit.shape == (256, 256)
    assert hit.any()
    assert not np.concatenate([hit[0], hit[-1], hit[:, 0], hit[:, -1]]).any()
    point = rw.Scene(rw.Mesh(np.ones((3, 3)), [(0, 1, 2)]))
    with pytest.raises(ValueError, match="no primary ray hits anything"):
        typical_rays(point)


def test_diffuse_rays_leave_what_is_seen_as_the_cosine():
    scene = rw.Scene(KNOT)
    hits = scene.intersect(*CAMERA.rays())
    towards = CAMERA.rays()[1][hits.hit]
    normal = hits.normal[hits.hit]
    assert (np.sum(normal * towards, axis=1) < 0).all()
    rays = typical_rays(scene, CAMERA)["diffuse"]
    assert np.allclose(rays.origins, hits.position[hits.hit], atol=1e-8)
    unit = rays.directions / np.linalg.norm(rays.directions, axis=1, keepdims=True)
    cosine = np.sum(unit * normal, axis=1)
    # The density is 2c from 0 to 1: mean 2/3, variance 1/18. Five standard errors: once in a million seeds.
    assert cosine.min() > 0
    assert abs(cosine.mean() - 2 / 3) < 5 * (1 / 18 / len(cosine)) ** 0.5
    assert np.array_equal(rays.directions, typical_rays(scene, CAMERA)["diffuse"].directions)
    assert not np.array_equal(rays.directions, typical_rays(scene, CAMERA, seed=1)["diffuse"].directions)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_rays_do_not_hit_the_face_that_they_leave(scale):
    flat = rw.Mesh(np.array([(-1, -1, 3), (1, -1, 3), (0, 1, 3.0)]) * scale, [(0, 1, 2)])
    scene = rw.Scene(flat)
    sets = typical_rays(scene, rw.Camera((0, 0, 5 * scale), (0, 0, 3 * scale), width=32, height=32))
    for name in ("diffuse", "shadow"):
        rays = sets[name]
        assert not scene.occluded(rays.origins, rays.directions, t_max=rays.t_max).any()


def test_shadow_rays_go_to_point_lights_in_turn():
    places = np.array([(3.0, 3, 3), (-3, 4, 1)])
    scene = rw.Scene(KNOT, lights=[rw.PointLight(tuple(place), 1.0) for place in places])
    rays = typical_rays(scene, CAMERA)["shadow"]
    assert rays.any_hit
    assert np.allclose(rays.origins + rays.directions, places[np.arange(rays.count) % 2])
    assert rays.t_max < 1


def test_shadow_rays_go_to_all_of_a_shining_mesh_and_are_not_stopped_by_it():
    scene = rw.Scene([KNOT, LAMP])
    rays = typical_rays(scene, CAMERA)["shadow"]
    ends = rays.origins + rays.directions
    assert np.allclose(ends[:, 1], 3)
    # Uniform on [-1, 1]: variance 1/3.
    assert (np.abs(ends[:, [0, 2]].mean(axis=0)) < 5 * (1 / 3 / rays.count) ** 0.5).all()
    assert np.array_equal(
        scene.occluded(rays.origins, rays.directions, t_max=rays.t_max),
        rw.Scene(KNOT).occluded(rays.origins, rays.directions, t_max=rays.t_max),
    )


@pytest.mark.parametrize("wall", [[], [rw.scenes.turned([LAMP], -30, (1, 0, 0))[0]], rw.scenes.room(500)])
def test_where_nothing_shines_the_lamp_is_one_point_that_the_camera_sees(wall):
    scene = rw.Scene([rw.Mesh(mesh.vertices, mesh.faces) for mesh in [KNOT, *wall]])
    camera = rw.Camera((0.4, 1.6, 4.5), (0, 0, 0), width=20, height=20)
    rays = typical_rays(scene, camera)["shadow"]
    lamps = rays.origins + rays.directions
    assert np.allclose(lamps, lamps[0])
    assert not scene.occluded(camera.position, lamps[0] - camera.position, t_max=1.0)


@given(st.integers(1, 60), st.integers(1, 60), st.integers(1, 4000))
def test_a_thinned_image_has_no_more_rays_than_asked_for_and_not_far_fewer(height, width, most):
    rays = Rays(np.zeros((height, width, 3)), np.ones((height, width, 3)))
    few = rays.thinned(most)
    assert 1 <= few.count <= max(most, 1)
    assert few.count >= min(rays.count, most) / 8
    assert (few.count == rays.count) == (most >= rays.count)


def test_thinned_rays_are_some_of_the_rays():
    origins = np.arange(300.0).reshape(10, 10, 3)
    few = Rays(origins, (0, 0, 1), t_max=2.0, any_hit=True).thinned(25)
    assert np.array_equal(few.origins, origins[::2, ::2])
    assert (few.t_max, few.any_hit) == (2.0, True)
    row = Rays(origins.reshape(-1, 3), (0, 0, 1)).thinned(2)
    assert np.array_equal(row.origins, origins.reshape(-1, 3)[[0, -1]])


def test_rays_are_checked():
    with pytest.raises(
        ValueError, match=r"leading shapes do not broadcast: origins \(2,\), directions \(3,\)"
    ):
        Rays(np.zeros((2, 3)), np.zeros((3, 3)))
    with pytest.raises(ValueError, match="t_max must not be NaN"):
        Rays((0, 0, 0), (0, 0, 1), np.nan)
    assert Rays((0, 0, 0), (0, 0, 1)).count == 1
