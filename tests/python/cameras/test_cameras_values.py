"""Cameras of every kind as values: what they keep, and what they refuse."""

import pickle
import re
from dataclasses import replace

import numpy as np
import pytest

import raywright as rw

EYE, AT = (1.0, 2.0, 5.0), (0.1, 0.0, 0.0)
CAMERAS = [
    rw.Camera(EYE, AT, width=30),
    rw.Camera(EYE, direction=AT, focal_length_px=(100, 90), principal_point=(4, 5), skew=0.5),
    rw.Camera(EYE, AT, (1, 0, 0), 70, fov_axis="diagonal", shutter=(0.25, 0.75), end_pose=rw.Pose(AT, EYE)),
    rw.ThinLens(EYE, AT, f_stop=2.8, blades=5, blade_rotation=10, focus_point=(0, 0, 1)),
    rw.ThinLens(EYE, AT, aperture_radius=0.5, focal_length=0.1, sensor_height=0.05, focus_distance=2),
    rw.ThinLens(EYE, AT, f_stop=2, principal_point=(4, 5)),
    rw.Orthographic(EYE, AT, scale=4, scale_axis="x"),
    rw.Fisheye(EYE, AT, fov=70, mapping="equisolid", fov_axis="diagonal"),
    rw.Panorama(EYE),
    rw.Pose(EYE, AT),
    rw.Pose(EYE, up=(0, 0, 1), direction=AT),
]


@pytest.mark.parametrize("camera", CAMERAS, ids=repr)
def test_cameras_pickle_compare_hash_and_print(camera):
    back = pickle.loads(pickle.dumps(camera))
    assert back == camera
    assert hash(back) == hash(camera)
    assert eval(repr(camera), vars(rw)) == camera
    assert len({*CAMERAS}) == len(CAMERAS)
    with pytest.raises(AttributeError):
        camera.up = (0, 0, 1)


def test_what_was_given_can_be_replaced():
    lens = rw.ThinLens(EYE, AT, f_stop=2)
    assert replace(lens, f_stop=4).lens_radius == lens.lens_radius / 2
    assert replace(lens, target=(1, 2, 4)).focused_distance == 1
    camera = rw.Camera(EYE, AT)
    assert replace(camera, target=None, direction=(0, 0, 1)) == rw.Camera(EYE, direction=(0, 0, 1))
    assert replace(camera, end_pose=lens).end_pose == rw.Pose(EYE, AT)
    assert camera.fov == 40
    with pytest.raises(TypeError, match=r"end_pose must be a raywright\.Pose, got tuple"):
        rw.Camera(EYE, AT, end_pose=EYE)


def test_cameras_tell_where_they_look():
    for camera in CAMERAS:
        matrix = camera.matrix
        assert np.abs(matrix[:3, :3].T @ matrix[:3, :3] - np.eye(3)).max() < 1e-15
        assert np.linalg.det(matrix) == pytest.approx(1, rel=1e-14)
        assert np.abs(matrix[:3, 2] + camera.forward).max() < 1e-15
        assert (matrix[:3, 3] == camera.position).all()
        rotation, shift = camera.extrinsics
        assert np.abs(rotation @ camera.position + shift).max() < 1e-15
        assert matrix[:3, 1] @ camera.up > 0


NAN = float("nan")
PINHOLE = rw.Camera(EYE, AT, width=37, height=21)
LENS = {"f_stop": 2.0}


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: rw.ThinLens(EYE, EYE, **LENS), "position and target must differ"),
        (lambda: rw.Fisheye((0, 5, 0), (0, 0, 0)), "up must not be parallel to the view"),
        (lambda: rw.Panorama(EYE, direction=(0, 2, 0)), "up must not be parallel to the view"),
        (lambda: rw.Camera(EYE), "either target or direction must be given, got neither"),
        (lambda: rw.Camera(EYE, AT, direction=AT), "either target or direction must be given, got both"),
        (lambda: rw.Camera(EYE, direction=(0, 0, 0)), "direction must not be zero"),
        (
            lambda: rw.Camera(EYE, AT, fov=40, focal_length_px=(1, 1)),
            "either fov or focal_length_px must be given, got both",
        ),
        (
            lambda: rw.Camera(EYE, AT, focal_length_px=(1, 0)),
            "focal_length_px must not be zero, got (1.0, 0.0)",
        ),
        (lambda: rw.Camera(EYE, AT, principal_point=(NAN, 0)), "principal_point must be finite"),
        (
            lambda: rw.ThinLens(EYE, AT, f_stop=2, principal_point=(0, 0, 0)),
            "principal_point must be 2 numbers",
        ),
        (lambda: rw.Camera(EYE, AT, skew=1), "skew must be given with focal_length_px"),
        (lambda: rw.Camera(EYE, AT, fov_axis="z"), "fov_axis must be one of 'x', 'y'"),
        (lambda: rw.Camera(EYE, AT, shutter=(0.5, 0.25)), "shutter must open and then close within 0 to 1"),
        (lambda: rw.Camera(EYE, AT, shutter=(0, 1.5)), "within 0 to 1, got (0, 1.5)"),
        (lambda: rw.Camera(EYE, AT, shutter=(NAN, 1)), "within 0 to 1, got (nan, 1)"),
        (lambda: rw.Camera(EYE, AT, shutter=0.5), "shutter must be 2 numbers"),
        (lambda: rw.ThinLens(EYE, AT), "either f_stop or aperture_radius must be given, got neither"),
        (lambda: rw.ThinLens(EYE, AT, f_stop=-2), "f_stop must be greater than 0, got -2"),
        (lambda: rw.ThinLens(EYE, AT, f_stop=NAN), "f_stop must be finite"),
        (lambda: rw.ThinLens(EYE, AT, aperture_radius=-1), "aperture_radius must be at least 0, got -1"),
        (lambda: rw.ThinLens(EYE, AT, **LENS, focus_distance=0), "focus_distance must be greater than 0"),
        (lambda: rw.ThinLens(EYE, AT, **LENS, focus_point=(2, 4, 10)), "focus_point must be in front"),
        (lambda: rw.ThinLens(EYE, direction=AT, **LENS), "focus_distance must be given"),
        (lambda: rw.ThinLens(EYE, AT, **LENS, blades=2), "blades must be 0 or at least 3, got 2"),
        (lambda: rw.Orthographic(EYE, AT, scale=0), "scale must be greater than 0"),
        (lambda: rw.Fisheye(EYE, AT, mapping="flat"), "mapping must be one of 'equidistant'"),
        (lambda: PINHOLE.rays(lens=(0.5, 1.5)), "lens must be between 0 and 1, got 1.5"),
        (lambda: PINHOLE.rays(time=NAN), "time must be between 0 and 1, got nan"),
        (lambda: PINHOLE.rays(time=[0, 1]), "time must have shape () or (21, 37), got (2,)"),
        (lambda: rw.Scene([]).first_hits(PINHOLE, time=2), "time must be between 0 and 1, got 2"),
    ],
)
def test_what_is_no_camera_is_refused_in_one_line(make, message):
    with pytest.raises(ValueError, match=re.escape(message)) as refusal:
        make()
    assert "\n" not in str(refusal.value)
