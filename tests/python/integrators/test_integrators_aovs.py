"""What is seen first, against the rays that see it."""

import numpy as np
import pytest

import raywright as rw


@pytest.fixture(scope="module")
def room():
    return rw.scenes.cornell_box(width=96, height=64)


def test_numbers_are_those_of_the_rays_through_the_middles(room):
    scene, camera = room
    hits = scene.intersect(*camera.rays())
    seen = rw.aovs(scene, camera, ("shape_id", "primitive_id"), samples=1)
    np.testing.assert_array_equal(seen["shape_id"], hits.shape_id)
    np.testing.assert_array_equal(seen["primitive_id"], hits.primitive_id)
    assert seen["shape_id"].dtype == np.int32


def test_means_tend_to_what_fine_rays_see(room):
    scene, camera = room
    seen = rw.aovs(scene, camera, samples=64)
    assert set(seen) == set(rw.rendering.AOVS)
    hits = scene.intersect(*camera.rays())
    # Over a pixel of the wall that faces the camera, depth hardly changes; a few pixels have others in them
    # too.
    hit = hits.hit
    back = hit & (hits.normal[..., 2] == -1) & (hits.position[..., 2] > 559)
    assert back.sum() > 30
    depth = np.abs(seen["depth"][back] / hits.t[back] - 1)
    assert np.median(depth) < 2e-3
    lengths = np.linalg.norm(seen["normal"], axis=-1)
    assert lengths.max() < 1 + 1e-6
    assert np.median(lengths[hit]) > 1 - 1e-6
    assert not seen["motion"].any()
    np.testing.assert_array_equal(seen["normal"], seen["shading_normal"])
    assert seen["albedo"].min() >= 0
    assert seen["albedo"].max() <= 1
    for array in seen.values():
        assert not array.flags.writeable
        assert array.shape[:2] == (64, 96)


def test_nothing_is_told_as_such():
    camera = rw.Camera((0, 0, 5), (0, 0, 9), width=3, height=2)
    seen = rw.aovs(rw.Scene(rw.Sphere((0, 0, 0), 1)), camera)
    assert (seen["depth"] == np.inf).all()
    assert (seen["shape_id"] == -1).all()
    assert not seen["albedo"].any()


def test_motion_is_what_instances_do():
    ball = rw.Sphere((0, 0, 0), 1)
    start, end = np.eye(4), np.eye(4)
    end[:3, 3] = (0.1, -0.2, 0.3)
    scene = rw.Scene(rw.Instance(ball, start, end))
    camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=5, width=4, height=4)
    motion = rw.aovs(scene, camera, "motion", samples=4)["motion"]
    np.testing.assert_allclose(motion, np.broadcast_to([0.1, -0.2, 0.3], motion.shape), atol=1e-6)


def test_the_way_in_the_picture_is_that_of_what_moves_and_of_what_looks():
    ball = rw.Sphere((0, 0, 0), 1)
    start, end = np.eye(4), np.eye(4)
    end[:3, 3] = (0.1, -0.2, 0.0)
    moving = rw.Scene(rw.Instance(ball, start, end))
    parallel = {"scale": 2.0, "width": 10, "height": 10}
    seen = ("motion", "screen_motion")
    # Five pixels are one unit; up in the scene is up in the picture, where y points down.
    camera = rw.Orthographic((0, 0, 5), (0, 0, 0), **parallel)
    way = rw.aovs(moving, camera, seen, samples=4)
    middle = way["screen_motion"][3:7, 3:7]
    np.testing.assert_allclose(middle, np.broadcast_to([0.5, 1.0], middle.shape), atol=1e-6)
    # With the shutter open for half of the time, things move half of their way.
    short = rw.Orthographic((0, 0, 5), (0, 0, 0), shutter=(0.5, 1.0), **parallel)
    half = rw.aovs(moving, short, seen, samples=4)
    for name in seen:
        np.testing.assert_allclose(half[name][3:7, 3:7], way[name][3:7, 3:7] / 2, atol=1e-6)
    # A camera that moves to the right sees static things move to the left.
    going = rw.Orthographic((0, 0, 5), (0, 0, 0), end_pose=rw.Pose((0.2, 0, 5), (0.2, 0, 0)), **parallel)
    still = rw.aovs(rw.Scene(ball), going, seen, samples=4)
    middle = still["screen_motion"][3:7, 3:7]
    np.testing.assert_allclose(middle, np.broadcast_to([-1.0, 0.0], middle.shape), atol=1e-6)
    assert not still["motion"].any()


def test_unknown_names_are_refused(room):
    with pytest.raises(ValueError, match=r"aov 'height' is unknown, expected some of depth, "):
        rw.aovs(*room, "height")
    for other, told in ((["depth", 7], "7"), (7, "7"), (None, "None"), ([["depth"]], r"\['depth'\]")):
        with pytest.raises(TypeError, match=f"aov must be names, got {told}"):
            rw.aovs(*room, other)
        with pytest.raises(TypeError, match=f"aov must be names, got {told}"):
            rw.render(*room, samples=1, aov=other, progress=False)


def test_what_is_no_scene_or_no_camera_is_refused(room):
    scene, camera = room
    with pytest.raises(TypeError, match=r"scene must be a raywright\.Scene, got NoneType"):
        rw.aovs(None, camera)
    with pytest.raises(TypeError, match=r"camera must be a raywright\.Camera, got Scene"):
        rw.aovs(scene, scene)
