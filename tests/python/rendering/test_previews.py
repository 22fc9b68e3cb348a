"""Previews: pictures of a ray and a shadow ray per pixel, beside the same in numpy."""

import doctest
import signal
import threading
import time

import numpy as np
import pytest

import raywright as rw
from raywright.query import previews

SUN = (0.3, 1.0, 0.45)
WOOD = rw.Diffuse((0.6, 0.4, 0.2))
CHECKED = rw.Diffuse(rw.Checker((0.9, 0.1, 0.1), (0.1, 0.2, 0.9), 8))
POSE = {"position": (0.4, 1.6, 4.1), "target": (0.0, 0.1, 0.0)}
CAMERAS = {
    "pinhole": rw.Camera(**POSE, fov=50, width=67, height=45),
    "off center": rw.Camera(**POSE, fov=50, width=64, height=48, principal_point=(20, 31)),
    "thin_lens": rw.ThinLens(**POSE, fov=50, width=40, height=31, aperture_radius=0.2, focus_distance=3),
    "orthographic": rw.Orthographic(**POSE, scale=4, width=33, height=41),
    "fisheye": rw.Fisheye(**POSE, fov=170, width=37, height=37),
    "panorama": rw.Panorama(**POSE, width=64, height=32),
    "one pixel": rw.Camera(**POSE, fov=20, width=1, height=1),
    "a row": rw.Camera(**POSE, fov=90, width=300, height=2),
}


def grid(count, height):
    """Return a hilly mesh of 2 * count² triangles with texture coordinates."""
    u, v = np.meshgrid(*2 * (np.linspace(0, 1, count + 1),), indexing="ij")
    points = np.stack([6 * u - 3, height * np.sin(9 * u) * np.cos(8 * v) - 0.6, 6 * v - 3], axis=-1)
    first = (np.arange(count)[:, None] * (count + 1) + np.arange(count)).reshape(-1)
    one, other = np.stack([first, first + 1, first + count + 2], 1), None
    other = np.stack([first, first + count + 2, first + count + 1], 1)
    faces = np.concatenate([one, other]).astype(np.uint32)
    return points.reshape(-1, 3), faces, np.stack([u, v], axis=-1).reshape(-1, 2)


def scenes():
    """Return scenes of meshes alone, few and many faces, of curved shapes, of copies, and of nothing."""
    points, faces, uvs = grid(12, 0.3)
    hills = rw.Mesh(points, faces, uv=uvs, material=CHECKED)
    box = rw.Mesh(
        [[0, 0, 0], [1, 0, 0], [0, 1.5, 0], [0, 0, 1]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]
    )
    ball = rw.Sphere((0.2, 0.6, 0.1), 0.5, material=WOOD)
    turned = np.stack([np.eye(4) * (1, 1, 1, 1) for _ in range(3)])
    turned[:, :3, 3] = [[-1, 0, 0], [0, 0.3, 0], [1, 0, 0.5]]
    return {
        "hills and a box": rw.Scene([hills, box]),
        "a box": rw.Scene([box]),
        "a ball on hills": rw.Scene([hills, ball]),
        "copies": rw.Scene([hills, rw.Instance([box, ball], turned)]),
        "nothing": rw.Scene([]),
    }


SCENES = scenes()


def by_hand(scene, camera, light):
    """Return the linear picture as numpy makes it of hits, shadow rays and albedos, and where it is sure."""
    origins, directions = camera.rays()
    hits = scene.intersect(origins, directions)
    along = np.sum(hits.normal * directions, axis=-1)
    normal = np.where(along <= 0, 1.0, -1.0)[..., None] * hits.normal
    if light == "headlight":
        ways = -directions
        blocked = np.zeros(hits.shape, bool)
    elif isinstance(light, rw.PointLight):
        ways = np.array(light.position) - hits.position
        starts = hits.spawn_rays(ways).origins
        blocked = scene.occluded(starts, light.position - starts, t_max=1 - 2.0**-45)
    else:
        sun = -np.array(light.direction) if isinstance(light, rw.DirectionalLight) else np.array(light, float)
        ways = np.broadcast_to(sun, directions.shape)
        blocked = scene.occluded(hits.spawn_rays(sun).origins, sun)
    cosine = np.sum(normal * ways, axis=-1) / np.linalg.norm(ways, axis=-1)
    flat = rw.query.Rays(origins.reshape(-1, 3), directions.reshape(-1, 3), np.zeros(hits.t.size))
    albedo = scene.interactions(flat).albedo.reshape(*hits.shape, 3)
    lit = hits.hit & ~blocked & (cosine > 0)
    return np.where(hits.hit[..., None], albedo, 0.0), np.where(lit, cosine, 0.0), hits.hit


@pytest.mark.parametrize("name", SCENES)
@pytest.mark.parametrize("kind", CAMERAS)
def test_pixels_are_those_of_numpy(name, kind):
    scene, camera = SCENES[name], CAMERAS[kind]
    lamp = rw.PointLight((1.3, 2.2, 0.8), 1)
    for light in ("headlight", SUN, lamp, rw.DirectionalLight((-1, -2, 0.5), 1)):
        albedo, cosine, hit = by_hand(scene, camera, light)
        for ambient, behind in ((0.0, 0.0), (0.25, (0.1, 0.2, 0.3))):
            wanted = albedo * (ambient + (1 - ambient) * cosine)[..., None]
            wanted = np.where(hit[..., None], wanted, behind)
            found = scene.preview(camera, light, dtype=np.float32, ambient=ambient, background=behind)
            assert found.dtype == np.float32
            np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=1e-7)


def test_scenes_show_light_and_shadow():
    for name in ("hills and a box", "a ball on hills", "copies"):
        _, cosine, hit = by_hand(SCENES[name], CAMERAS["pinhole"], SUN)
        assert hit.mean() > 0.3
        assert 0.1 < (cosine > 0)[hit].mean() < 0.99


def test_bytes_have_the_curve_of_srgb():
    scene, camera = SCENES["hills and a box"], CAMERAS["pinhole"]
    linear = scene.preview(camera, SUN, dtype="float32", background=0.5).astype(float)
    curve = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    found = scene.preview(camera, SUN, background=0.5)
    assert found.dtype == np.uint8
    # A value at the edge between two bytes may be rounded to either.
    np.testing.assert_allclose(found, 255 * curve, atol=0.5001)


def test_threads_make_no_difference_and_out_is_returned():
    scene, camera = SCENES["a ball on hills"], CAMERAS["pinhole"]
    one = scene.preview(camera, SUN, threads=1)
    out = np.full((45, 67, 3), 77, np.uint8)
    assert scene.preview(camera, SUN, out, threads=3) is out
    np.testing.assert_array_equal(out, one)
    part = np.full((3, 45, 67, 3), np.nan, np.float32)
    scene.preview(camera, SUN, out=part[1], dtype=np.float32)
    assert np.isfinite(part[1]).all()
    assert np.isnan(part[::2]).all()


def test_cameras_and_scenes_that_move_are_seen_as_the_shutter_opens():
    ball = rw.Sphere((0, 0, 0), 0.5)
    ends = np.stack([np.eye(4), np.eye(4)])
    ends[1, 0, 3] = 3
    moving = rw.Scene([rw.Instance(ball, ends[:1], ends[1:])])
    still = rw.Scene([rw.Instance(ball, ends[:1])])
    end = rw.Pose((5, 5, 5), target=(0, 0, 0))
    cameras = [rw.Camera(**POSE, fov=30, width=20, height=15, end_pose=moved) for moved in (None, end)]
    wanted = still.preview(cameras[0], SUN)
    assert wanted.any()
    np.testing.assert_array_equal(moving.preview(cameras[1], SUN), wanted)


def test_a_point_light_on_a_surface_lights_the_others():
    floor = rw.Mesh([[-9, 0, -9], [-9, 0, 9], [9, 0, 9], [9, 0, -9]], [[0, 1, 2], [0, 2, 3]])
    ceiling = rw.Mesh([[-1, 2, -1], [1, 2, -1], [1, 2, 1], [-1, 2, 1]], [[0, 1, 2], [0, 2, 3]])
    camera = rw.Camera((0, 1, 6), (0, 0.5, 0), fov=40, width=32, height=24)
    picture = rw.Scene([floor, ceiling]).preview(camera, rw.PointLight((0, 2, 0), 1), dtype="float32")
    assert np.isfinite(picture).all()
    assert picture[20].min() > 0


def test_what_shines_is_white():
    lamp = rw.Mesh([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], [[0, 1, 2], [0, 2, 3]], emission=3)
    camera = rw.Camera((0, 3, 0.1), (0, 0, 0), fov=20, width=8, height=8)
    for light in ("headlight", SUN):
        assert (rw.Scene([lamp]).preview(camera, light) == 255).all()


REFUSED = [
    ({"camera": "front"}, TypeError, "camera must be a Camera, got str"),
    ({"light": "moon"}, ValueError, "light must be 'headlight' or the direction towards the sun, got 'moon'"),
    (
        {"light": None},
        TypeError,
        "light must be 'headlight', 3 floats, a DirectionalLight or a PointLight, got NoneType",
    ),
    ({"light": (0, 0, 0)}, ValueError, r"light must be a direction with a length, got \(0.0, 0.0, 0.0\)"),
    ({"light": (0, 1)}, ValueError, r"light must be 3 numbers, got shape \(2,\)"),
    ({"light": (0, np.nan, 1)}, ValueError, "light must be finite"),
    ({"dtype": np.float64}, TypeError, "dtype must be uint8 or float32, got float64"),
    ({"ambient": 1.5}, ValueError, "ambient must be between 0 and 1, got 1.5"),
    ({"background": -1}, ValueError, "background must be at least 0, got -1"),
    ({"threads": 0}, ValueError, "threads must be at least 1, got 0"),
    ({"out": [1, 2]}, TypeError, "out must be an array of uint8 or float32, got list"),
    (
        {"out": np.empty((45, 67, 3))},
        TypeError,
        "out must be an array of uint8 or float32, got dtype float64",
    ),
    (
        {"out": np.empty((67, 45, 3), np.uint8)},
        ValueError,
        r"out has shape \(67, 45, 3\), expected \(45, 67, 3\)",
    ),
    ({"out": np.empty((45, 67, 6), np.uint8)[..., ::2]}, ValueError, "out must be C-contiguous and writable"),
    ({"out": np.empty((3, 67, 45), np.uint8).T}, ValueError, "out must be C-contiguous and writable"),
    (
        {"out": np.broadcast_to(np.uint8(0), (45, 67, 3))},
        ValueError,
        "out must be C-contiguous and writable",
    ),
    (
        {"out": np.empty((45, 67, 3), np.uint8), "dtype": np.float32},
        ValueError,
        "dtype must be that of out, uint8, got float32",
    ),
]


@pytest.mark.parametrize(("wrong", "kind", "message"), REFUSED)
def test_what_is_no_argument_is_refused(wrong, kind, message):
    with pytest.raises(kind, match=message):
        SCENES["a box"].preview(**({"camera": CAMERAS["pinhole"]} | wrong))


def test_a_read_only_array_is_refused():
    out = np.empty((45, 67, 3), np.float32)
    out.setflags(write=False)
    with pytest.raises(ValueError, match="out must be C-contiguous and writable"):
        SCENES["a box"].preview(CAMERAS["pinhole"], out=out)


def test_other_threads_run_meanwhile():
    scene, counted, over = SCENES["hills and a box"], [0], threading.Event()
    camera = rw.Camera(**POSE, fov=50, width=1200, height=800)

    def draw():
        scene.preview(camera, SUN, threads=1)
        over.set()

    thread = threading.Thread(target=draw)
    thread.start()
    while not over.is_set():
        counted[0] += 1
        time.sleep(0.001)
    thread.join()
    assert counted[0] > 20


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="needs a timer")
def test_it_ends_at_ctrl_c():
    def interrupt(*_):
        raise KeyboardInterrupt

    # A picture that takes some seconds.
    large = rw.Camera(**POSE, fov=50, width=9000, height=6000)
    before = signal.signal(signal.SIGALRM, interrupt)

    def draw():
        signal.setitimer(signal.ITIMER_REAL, 0.05)
        for _ in range(1000):
            SCENES["a ball on hills"].preview(large, SUN)

    try:
        with pytest.raises(KeyboardInterrupt):
            draw()
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def test_its_example_runs():
    failed, tried = doctest.testmod(previews)
    assert tried > 3
    assert failed == 0
