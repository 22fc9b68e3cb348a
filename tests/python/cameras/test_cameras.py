"""Cameras of every kind: where their rays go, and what their pictures show."""

import numpy as np
import pytest

import raywright as rw

EYE, AT = (1.0, 2.0, 5.0), (0.1, 0.0, 0.0)
SIZE = {"width": 37, "height": 21}
MOVED = rw.Pose((1.5, 2.0, 4.5), (0, 0.2, 0), (0.1, 1, 0))
CAMERAS = {
    "pinhole": rw.Camera(EYE, AT, **SIZE),
    "moving pinhole": rw.Camera(EYE, AT, end_pose=MOVED, shutter=(0.25, 0.75), **SIZE),
    "thin_lens": rw.ThinLens(EYE, AT, f_stop=0.01, blades=5, blade_rotation=10, **SIZE),
    "orthographic": rw.Orthographic(EYE, AT, scale=4, **SIZE),
    "fisheye": rw.Fisheye(EYE, AT, fov=70, **SIZE),
    "panorama": rw.Panorama((0.2, 0.4, 0.9), AT, end_pose=MOVED, **SIZE),
}
SCENE = rw.Scene([rw.scenes.torus_knot(along=60, around=8), rw.scenes.teapot(2)])
every_camera = pytest.mark.parametrize("camera", CAMERAS.values(), ids=CAMERAS)


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@every_camera
@pytest.mark.parametrize("time", [0.0, 0.5, 1.0])
def test_picks_and_first_hits_are_those_of_the_rays(camera, time):
    hits = SCENE.intersect(*camera.rays(time=time))
    y, x = np.mgrid[:21, :37]
    assert SCENE.pick(camera, x, y, time=time) == hits
    assert SCENE.first_hits(camera, time=time) == hits
    assert hits.hit.any()
    assert not hits.hit.all()


@every_camera
def test_rays_through_points_are_those_of_the_pixels(camera):
    rng = np.random.default_rng(5)
    offsets, lens, time = rng.random((21, 37, 2)), rng.random((21, 37, 2)), rng.random((21, 37))
    y, x = np.mgrid[:21, :37]
    found = camera.rays_through(np.stack([x, y], axis=-1) + offsets, lens, time)
    wanted = camera.rays(offsets, lens=lens, time=time)
    single = camera.rays(offsets, np.float32, lens, time)
    for a, b, c in zip(found, wanted, single, strict=True):
        assert np.array_equal(a, b, equal_nan=True)
        assert np.array_equal(b.astype(np.float32), c, equal_nan=True)
    seen = np.isfinite(wanted[1]).all(axis=-1)
    assert seen.all() or isinstance(camera, rw.Fisheye)
    assert np.abs(np.linalg.norm(wanted[1][seen], axis=-1) - 1).max() < 1e-15


@pytest.mark.parametrize("kind", ["pinhole", "thin_lens", "orthographic", "fisheye", "panorama"])
def test_a_camera_moves_rigidly_and_evenly(kind):
    still = CAMERAS[kind]
    shared = {
        k: v for k, v in vars(still).items() if k not in ("position", "target", "up", "direction", "end_pose")
    }
    shared |= {"focus_distance": 3.0} if kind == "thin_lens" else {}
    start = type(still)((0, 0, 5), (0, 0, 0), **shared)
    end = type(still)((4, 0, 0), direction=(-1, 0, 0), **shared)
    moving = type(still)((0, 0, 5), (0, 0, 0), **shared, end_pose=end)
    lens = (0.9, 0.3)
    for time, other in ((0.0, start), (1.0, end)):
        for found, expected in zip(moving.rays(lens=lens, time=time), other.rays(lens=lens), strict=True):
            assert np.array_equal(found, expected, equal_nan=True)
    # Halfway it has turned by half of 90 degrees to the left, and stands in the middle.
    turn = np.array([(1, 0, -1), (0, np.sqrt(2), 0), (1, 0, 1)]) / np.sqrt(2)
    origins, directions = start.rays(lens=lens)
    half = moving.rays(lens=lens, time=0.5)
    turned = (origins - (0, 0, 5)) @ turn + (2, 0, 2.5)
    assert np.allclose(half[0], turned, rtol=0, atol=1e-15 * 16)
    assert np.allclose(half[1], directions @ turn, rtol=0, atol=1e-15 * 8, equal_nan=True)


def test_the_shutter_is_open_in_the_scenes_time():
    still, moving = CAMERAS["pinhole"], CAMERAS["moving pinhole"]
    assert still.scene_time(0.3) == 0.3
    assert np.array_equal(moving.scene_time([0, 0.5, 1]), (0.25, 0.5, 0.75))
    # A ball that moves by 8 in the scene's time is 2 to the right when the shutter opens.
    end = np.eye(4)
    end[0, 3] = 8.0
    scene = rw.Scene(rw.Instance(rw.Sphere((0, 0, 0), 0.5), np.eye(4), end))
    camera = rw.Camera((2, 0, 9), (2, 0, 0), width=9, height=9, shutter=(0.25, 0.75))
    assert scene.pick(camera, 4, 4).t == pytest.approx(8.5, rel=1e-14)
    assert scene.first_hits(camera).t[4, 4] == pytest.approx(8.5, rel=1e-14)
    assert not scene.pick(camera, 4, 4, time=1.0).hit
    assert scene.pick(rw.Camera((6, 0, 9), (6, 0, 0), shutter=(0.25, 0.75)), 256, 256, time=1.0).hit


def test_the_rays_of_a_thin_lens_meet_where_it_is_in_focus():
    lens = np.random.default_rng(2).random((500, 2))
    camera = CAMERAS["thin_lens"]
    for sharp in ({}, {"focus_distance": 3.0}, {"focus_point": (0, 1, 1)}):
        camera = rw.ThinLens(EYE, AT, aperture_radius=0.3, **sharp, **SIZE)
        through = EYE + 3 * camera.forward if "focus_distance" in sharp else sharp.get("focus_point", AT)
        assert camera.focused_distance == pytest.approx(np.subtract(through, EYE) @ camera.forward, rel=1e-15)
        for point in [(18.5, 10.5), (0, 0), (31, 20)]:
            origins, directions = camera.rays_through(point, lens)
            away = camera.focused_distance / (directions @ camera.forward)
            met = origins + directions * away[:, None]
            assert np.ptp(met, axis=0).max() < 1e-12
            # The same point as seen by the pinhole.
            middle = rw.Camera(EYE, AT, **SIZE).rays_through(point)[1]
            towards = unit(met.mean(axis=0) - EYE)
            assert np.abs(towards - middle).max() < 1e-12
        assert np.linalg.norm(origins - EYE, axis=1).max() <= 0.3 + 1e-15
        assert np.abs((origins - EYE) @ camera.forward).max() < 1e-15


def test_a_shifted_lens_sees_what_a_shifted_pinhole_does():
    lens = np.random.default_rng(3).random((100, 2))
    shift = {"fov": 50, "principal_point": (4.5, 17.0), **SIZE}
    camera = rw.ThinLens(EYE, AT, aperture_radius=0.3, focus_distance=4.0, **shift)
    pinhole = rw.Camera(EYE, AT, **shift)
    for point in [(18.5, 10.5), (0, 0), (4.5, 17)]:
        origins, directions = camera.rays_through(point, lens)
        met = origins + directions * (4 / (directions @ camera.forward))[:, None]
        assert np.ptp(met, axis=0).max() < 1e-12
        assert np.abs(unit(met.mean(axis=0) - EYE) - pinhole.rays_through(point)[1]).max() < 1e-12
    assert pinhole.rays_through((4.5, 17))[1] == pytest.approx(camera.forward, abs=1e-15)


def test_f_stops_and_focal_lengths_are_those_of_photography():
    # 50 mm at f/2 before a sensor of 24 mm, in meters: a lens of 25 mm, and an angle of 27 degrees.
    camera = rw.ThinLens(EYE, AT, f_stop=2, focal_length=0.05)
    assert camera.lens_radius == pytest.approx(0.0125, rel=1e-15)
    angle = np.degrees(2 * np.arctan(12 / 50))
    middle = (256.0, 0.0), (256.0, 512.0)
    top, bottom = camera.rays_through(middle)[1]
    assert np.degrees(np.arccos(top @ bottom)) == pytest.approx(angle, rel=1e-12)
    # The same by its angle, measured along the picture's width of 36 mm.
    wide = np.degrees(2 * np.arctan(18 / 50))
    other = rw.ThinLens(EYE, AT, fov=wide, fov_axis="x", f_stop=2, width=36, height=24)
    assert other.lens_radius == pytest.approx(0.0125, rel=1e-14)


def test_an_edge_is_blurred_by_the_circle_of_confusion():
    # Half a plane emits at distance 2, and the lens is in focus at 4. A point at x of the film at distance 1
    # sees 2 x + l / 2 from the point l of the lens, and the part of the lens that sees light is a segment of
    # its disk.
    radius, far = 0.2, 1e3
    half = rw.Mesh(
        [(0, -far, 0), (far, -far, 0), (far, far, 0), (0, far, 0)], [(0, 1, 2), (0, 2, 3)], emission=1.0
    )
    angle = np.degrees(2 * np.arctan(0.1))
    camera = rw.ThinLens(
        (0, 0, 2), (0, 0, 0), fov=angle, width=10, height=10, aperture_radius=radius, focus_distance=4
    )
    image = rw.render(rw.Scene(half), camera, rw.Path(max_depth=0), samples=2000, seed=1, progress=False)
    x = 0.1 * (2 * np.linspace(0, 10, 10001) / 10 - 1)
    chord = np.clip(-4 * x / radius, -1, 1)
    part = (np.arccos(chord) - chord * np.sqrt(1 - chord**2)) / np.pi
    expected = [part[1000 * i : 1000 * i + 1001].mean() for i in range(10)]
    # The mean of a column has 20 000 samples of 0 or 1; it is beyond 5 deviations once in 1.7 million. 1e-5
    # covers the sum in place of an integral, and float32.
    deviation = np.sqrt(np.multiply(expected, np.subtract(1, expected)) / 20000)
    assert (np.abs(image.rgb[..., 0].mean(axis=0) - expected) <= 5 * deviation + 1e-5).all()
    assert expected[0] == 0
    assert 0.2 < expected[4] < 0.5


def test_an_edge_is_blurred_by_the_cameras_motion():
    # A camera of parallel rays, 10 pixels of 1, moves by 3 pixels past the edge of a light.
    half = rw.Mesh([(0, -99, 0), (99, -99, 0), (99, 99, 0), (0, 99, 0)], [(0, 1, 2), (0, 2, 3)], emission=1.0)
    camera = rw.Orthographic(
        (0, 0, 1),
        (0, 0, 0),
        scale=10,
        width=10,
        height=10,
        end_pose=rw.Pose((3, 0, 1), (3, 0, 0)),
        shutter=(0, 0.5),
    )
    image = rw.render(rw.Scene(half), camera, rw.Path(max_depth=0), samples=2000, seed=1, progress=False)
    left = np.arange(-5, 5)
    # Of the pixel [left, left + 1] + 3 t the part beyond 0, on average over t: a step's second integral.
    whole = [np.maximum(left + end, 0) ** 2 / 2 for end in (4, 1, 3, 0)]
    expected = (whole[0] - whole[1] - whole[2] + whole[3]) / 3
    # As above.
    deviation = np.sqrt(expected * (1 - expected) / 20000)
    assert (np.abs(image.rgb[..., 0].mean(axis=0) - expected) <= 5 * deviation + 1e-6).all()
    assert expected[0] == 0
    assert expected[3] == pytest.approx(0.5, rel=1e-15)


MAPPINGS = {
    "equidistant": lambda theta: theta,
    "equisolid": lambda theta: np.sin(theta / 2),
    "stereographic": lambda theta: np.tan(theta / 2),
    "orthographic": np.sin,
}


@pytest.mark.parametrize("mapping", MAPPINGS)
@pytest.mark.parametrize("fov", [40, 180, 300, 360])
def test_a_fisheye_has_the_angles_of_its_mapping(mapping, fov):
    if (mapping == "orthographic" and fov > 180) or (mapping == "stereographic" and fov == 360):
        with pytest.raises(ValueError, match="fov must be between 0 and"):
            rw.Fisheye(EYE, AT, fov=fov, mapping=mapping)
        return
    camera = rw.Fisheye(EYE, AT, fov=fov, mapping=mapping, width=300, height=200)
    theta = np.radians(np.linspace(0, 0.98 * fov / 2, 50))
    radius = 100 * MAPPINGS[mapping](theta) / MAPPINGS[mapping](np.radians(fov / 2))
    axes = camera.matrix[:3, :3].T
    for turn in (0, 1, 4):
        points = np.stack([150 + radius * np.cos(turn), 100 - radius * np.sin(turn)], axis=-1)
        local = [np.sin(theta) * np.cos(turn), np.sin(theta) * np.sin(turn), -np.cos(theta)]
        assert np.allclose(camera.rays_through(points)[1], np.transpose(local) @ axes, rtol=0, atol=2e-14)
    assert np.isnan(camera.rays_through((150, 201))[1]).all()


def test_beyond_the_circle_a_picture_is_black():
    camera = rw.Fisheye(EYE, AT, width=20, height=10)
    image = rw.render(rw.Scene([], environment=(1, 2, 3)), camera, samples=64, progress=False)
    x, y = np.meshgrid(np.arange(20) - 9.5, np.arange(10) - 4.5)
    near, far = (np.hypot(np.abs(x) + side, np.abs(y) + side) for side in (0.5, -0.5))
    assert (image.rgb[near < 5] == (1, 2, 3)).all()
    assert (image.rgb[far > 5] == 0).all()
    rim = image.rgb[(near > 5) & (far < 5)]
    assert ((rim >= 0) & (rim <= (1, 2, 3))).all()
    assert not image.warnings


def test_a_panorama_shows_a_direction_where_its_convention_says():
    camera = rw.Panorama((1, 2, 3), width=400, height=200)
    u, v = np.random.default_rng(8).random((2, 300))
    phi, theta = 2 * np.pi * (u - 0.5), np.pi * v
    expected = [np.sin(phi) * np.sin(theta), np.cos(theta), -np.cos(phi) * np.sin(theta)]
    origins, directions = camera.rays_through(np.stack([400 * u, 200 * v], axis=-1))
    assert np.allclose(directions, np.transpose(expected), rtol=0, atol=2e-15)
    assert (origins == (1, 2, 3)).all()
    # Directions to the right of a camera with a target are a quarter turn to the right.
    found = rw.Panorama(EYE, AT, width=400, height=200).rays_through([(200, 100), (300, 100), (7, 0)])[1]
    matrix = rw.Camera(EYE, AT).matrix
    assert np.allclose(found, [-matrix[:3, 2], matrix[:3, 0], matrix[:3, 1]], rtol=0, atol=1e-15)


def test_an_orthographic_camera_shows_lengths():
    plane = rw.Scene(rw.Plane((0, 0, 0), (0, 0, 1)))
    for axis, pixel in (("x", 0.1), ("y", 0.2), ("smaller", 0.2), ("diagonal", 4 / np.hypot(40, 20))):
        camera = rw.Orthographic((3, 1, 7), (3, 1, 0), scale=4, scale_axis=axis, width=40, height=20)
        hits = plane.intersect(*camera.rays())
        x, y = np.meshgrid(3 + pixel * (np.arange(40) - 19.5), 1 - pixel * (np.arange(20) - 9.5))
        assert np.allclose(hits.position, np.stack([x, y, 0 * x], axis=-1), rtol=0, atol=1e-14)
        assert (hits.t == 7).all()


@pytest.mark.parametrize("kind", ["pinhole", "thin_lens", "orthographic", "fisheye"])
def test_from_far_away_every_pixel_is_where_it_should(kind):
    # 1e7 away, with pixels of 0.1: positions there are known to 2e-9, and a direction's error makes as much.
    far, size, pixel = 1e7, {"width": 40, "height": 40}, 0.1
    fov = np.degrees(2 * np.arctan(2 / far))
    make = {
        "pinhole": lambda *pose: rw.Camera(*pose, fov=fov, **size),
        "thin_lens": lambda *pose: rw.ThinLens(*pose, fov=fov, aperture_radius=1.0, **size),
        "orthographic": lambda *pose: rw.Orthographic(*pose, scale=4, **size),
        "fisheye": lambda *pose: rw.Fisheye(*pose, fov=fov, fov_axis="diagonal", **size),
    }[kind]
    camera = make((0.0, 0.0, far), (0, 0, 0), (0, 1, 0))
    hits = rw.Scene(rw.Plane((0, 0, 0), (0, 0, 1))).intersect(*camera.rays(lens=(0.7, 0.2)))
    pixel = pixel / np.sqrt(2) if kind == "fisheye" else pixel
    at = pixel * (np.arange(40) - 19.5)
    x, y = np.meshgrid(at, -at)
    assert np.abs(hits.position - np.stack([x, y, 0 * x], axis=-1)).max() < 1e-8
