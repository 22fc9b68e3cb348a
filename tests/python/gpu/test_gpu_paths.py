"""Pictures whose paths a graphics processor follows, or one in software: what the CPU's tend to.

Where there is no driver for Vulkan, Metal or Direct3D 12, or wgpu is not installed, they are skipped.
Pictures are compared by 64 blocks of 4 by 4 pixels: none of the differences is beyond 5.2 standard errors,
which of normal ones happens to one block in five million, and their mean square is that of 64 numbers in all
but one case in ten thousand (the quantiles of chi square), were channels one and the same.
"""

import os
import signal
import threading

import numpy as np
import pytest

import raywright as rw
from raywright.scenes.boxes import boxes

# The software renderer gets one thread per test process.
os.environ.setdefault("LP_NUM_THREADS", "1")
SIDE = 32
PLAIN = rw.Path(reuse=1, guiding="none")
CAMERA = rw.Camera((0, 1, 6), (0, 0, 0), width=SIDE, height=SIDE)


@pytest.fixture(scope="module")
def gpu():
    try:
        return rw.Gpu()
    except (ImportError, RuntimeError) as missing:
        pytest.skip(str(missing))


def quad(corner, across, up, **look):
    """Return a parallelogram."""
    corner, across, up = (np.array(x, float) for x in (corner, across, up))
    points = [corner, corner + across, corner + across + up, corner + up]
    return rw.Mesh(points, [(0, 1, 2), (0, 2, 3)], uv=[(0, 0), (1, 0), (1, 1), (0, 1)], **look)


def ball(center, material, radius=1.0, rows=12):
    """Return a sphere of faces with the normals of a round one."""
    theta, phi = np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, 2 * rows + 1)
    sine, turn = np.sin(theta)[:, None], phi[None, :]
    height = np.broadcast_to(np.cos(theta)[:, None], (rows + 1, 2 * rows + 1))
    points = np.stack([sine * np.cos(turn), height, -sine * np.sin(turn)], axis=-1).reshape(-1, 3)
    a = (np.arange(rows)[:, None] * (2 * rows + 1) + np.arange(2 * rows)).reshape(-1)
    b, c, d = a + 2 * rows + 1, a + 2 * rows + 2, a + 1
    faces = np.concatenate([np.stack([a, b, c], 1)[: len(a) - 2 * rows], np.stack([a, c, d], 1)[2 * rows :]])
    return rw.Mesh(points * radius + center, faces, normals=points, material=material)


def floor(material):
    return quad((-4, -1, -4), (0, 0, 8), (8, 0, 0), material=material)


def lamp():
    return quad((-1, 3, -1), (2, 0, 0), (0, 0, 2), emission=(8, 7, 6), material=rw.Diffuse(0))


def sky():
    """Return a sky with a sun of one texel, turned."""
    image = np.random.default_rng(1).random((16, 32, 3)) ** 6
    image[3, 20] = (60, 50, 40)
    turn = np.radians(40)
    to_world = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    return rw.EnvironmentMap(image, to_world=to_world, scale=0.8)


def in_blocks(array):
    height, width = array.shape[:2]
    return array.reshape(height // 4, 4, width // 4, 4, 3).astype(float).mean(axis=(1, 3))


def agree(one, other):
    """Hold two pictures with error bars against each other; return the mean square of the differences."""
    variance = in_blocks(one.standard_error.astype(float) ** 2) + in_blocks(
        other.standard_error.astype(float) ** 2
    )
    # If all samples agree, the error is that of float32.
    error = np.sqrt(variance / 16) + 3e-6 * (1e-3 + in_blocks(other.rgb))
    z = (in_blocks(one.rgb) - in_blocks(other.rgb)) / error
    assert np.abs(z).max() < 5.2, np.abs(z).max()
    assert np.mean(z**2) < 1.8
    return np.mean(z**2)


def both(scene, gpu, camera=CAMERA, samples=64, path=PLAIN):
    there = rw.render(scene, camera, path, samples, progress=False, device=gpu, seed=5)
    assert there.plan["device"].chosen == gpu.name
    here = rw.render(scene, camera, path, 4 * samples, progress=False)
    return there, here, agree(there, here)


def test_the_cornell_box(gpu):
    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    there, here, square = both(scene, gpu, camera)
    # Error bars are not too long, either.
    assert square > 0.4
    assert there.samples == 64
    assert there.error.low < there.error.estimate < there.error.high
    assert there.history["samples"].tolist() == [1, 2, 4, 8, 16, 32, 48, 64]
    # The estimated error is the true one, up to the reference's own.
    off = np.mean((there.rgb - here.rgb.astype(float)) ** 2 / (here.rgb.astype(float) ** 2 + 0.01))
    assert there.error.low < off < 2 * there.error.high
    assert (there.plan.sampler, there.plan.path) == (rw.rendering.Independent(), PLAIN)


SCENES = {
    "mirror and glass": lambda: rw.Scene(
        [
            floor(rw.Diffuse((0.6, 0.5, 0.4))),
            lamp(),
            ball((-1.1, 0, 0), rw.Mirror(0.9)),
            ball((1.1, 0, 0), rw.Dielectric(1.5)),
        ],
        environment=0.2,
    ),
    "a picture of the sky": lambda: rw.Scene(
        [floor(rw.Diffuse(0.5)), ball((0, 0, 0), rw.Diffuse((0.7, 0.3, 0.2)))], environment=sky()
    ),
    "metals": lambda: rw.Scene(
        [
            floor(rw.Conductor("gold", alpha=0.3)),
            lamp(),
            ball((-1.1, 0, 0), rw.Conductor(eta=(0.2, 0.9, 1.1), k=(3.9, 2.4, 2.2), alpha=0.6)),
            ball((1.1, 0, 0), rw.Conductor("copper")),
        ],
        environment=sky(),
    ),
    "rough glass": lambda: rw.Scene(
        [
            floor(rw.Diffuse(0.5)),
            ball((-1.1, 0, 0), rw.Dielectric(1.5, alpha=0.2, multiple_scattering=False)),
            ball((1.1, 0, 0), rw.Dielectric(1.5, alpha=0.5)),
        ],
        environment=0.7,
    ),
    "plastic": lambda: rw.Scene(
        [
            floor(rw.Plastic((0.6, 0.3, 0.2), roughness=0.5)),
            lamp(),
            ball((-1.1, 0, 0), rw.Plastic(0.8)),
            ball((1.1, 0, 0), rw.Plastic((0.1, 0.2, 0.7), 1.8, alpha=0.5)),
        ],
        environment=0.3,
    ),
    "points, directions and pictures": lambda: rw.Scene(
        [
            floor(
                rw.Diffuse(
                    rw.ImageTexture(
                        np.random.default_rng(1).random((8, 6, 3), np.float32),
                        filter="bilinear",
                        transform=rw.textures.UvTransform(3.0, rotation=20),
                        wrap=("mirror", "repeat"),
                    )
                )
            ),
            ball((0, 0, 0), rw.TwoSided(rw.Diffuse(0.7), rw.Diffuse(0))),
        ],
        lights=[rw.PointLight((2, 3, 2), (20, 30, 10)), rw.DirectionalLight((1, -1, -0.5), (1, 0.5, 2))],
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SCENES)
def test_scenes(gpu, name):
    both(SCENES[name](), gpu)


FILTERS = [
    rw.rendering.BoxFilter(1.5),
    rw.rendering.TriangleFilter(2),
    rw.rendering.GaussianFilter(),
    rw.rendering.BlackmanHarrisFilter(3),
]


@pytest.mark.parametrize("filter", FILTERS, ids=lambda filter: type(filter).__name__)
def test_filters_draw_samples(gpu, filter):
    """Of a tilted edge, which each filter blurs by another width."""
    scene = rw.Scene(quad((-2, -3, 0), (2.3, 1, 0), (-1, 6, 0), material=rw.Diffuse(0), emission=1.0))
    how = {"filter": filter, "progress": False}
    there = rw.render(scene, CAMERA, rw.Path(0, reuse=1, guiding="none"), 400, device=gpu, **how)
    assert there.plan["device"].chosen == gpu.name
    here = rw.render(
        scene, CAMERA, rw.Path(0, reuse=1, guiding="none"), 400, sampler=rw.rendering.Independent(), **how
    )
    error = np.sqrt(there.standard_error.astype(float) ** 2 + here.standard_error.astype(float) ** 2) + 1e-3
    z = ((there.rgb - here.rgb) / error)[..., 0]
    assert np.abs(z).max() < 5.2
    # Samples differ near the edge, but by no more than their standard errors.
    edge = np.minimum(there.rgb, 1 - there.rgb)[..., 0] > 0.1
    assert edge.sum() > 20
    assert np.mean(z[edge] ** 2) < 2


def test_copies_are_laid_out(gpu, monkeypatch):
    moves = np.tile(np.diag([0.7, 0.7, 0.7, 1.0]), (3, 1, 1))
    moves[:, 0, 3] = -1.5, 0, 1.5
    moves[1, 0, 0] = -0.7
    knob = ball((0, 0, 0), rw.Mirror(0.8), rows=6)
    shade = quad((-0.5, 1.2, -0.5), (1, 0, 0), (0, 0, 1), emission=(3, 2, 1), material=rw.Diffuse(0))
    shapes = [floor(rw.Diffuse(0.5)), rw.Instance([rw.Instance([knob], [np.eye(4)]), shade], moves)]
    scene = rw.Scene(shapes, environment=0.1)
    both(scene, gpu)
    from raywright.rendering import on_device

    monkeypatch.setattr(on_device, "_LAID_OUT", 100)
    image = rw.render(scene, CAMERA, PLAIN, 1, progress=False, device=gpu)
    assert "the scene has instances" in image.plan["device"].why


@pytest.mark.parametrize("depth", [0, 1, 2])
def test_bounces_are_counted_alike(gpu, depth):
    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    both(scene, gpu, camera, samples=16, path=rw.Path(max_depth=depth, reuse=1, guiding="none"))


WHITE = {
    "a rough mirror": [
        quad((-9, -9, 0), (18, 0, 0), (0, 18, 0), material=rw.Conductor(eta=1e-4, k=1e4, alpha=0.5))
    ],
    "a rough cube of glass": [
        rw.Mesh(*boxes(np.zeros((1, 3)), np.ones((1, 3))), material=rw.Dielectric(1.5, alpha=0.4))
    ],
}


@pytest.mark.parametrize("name", WHITE)
def test_a_furnace_is_white(gpu, name):
    """What reflects all of the light that comes evenly from everywhere is not seen before it."""
    scene = rw.Scene(WHITE[name], environment=1.0)
    there = rw.render(scene, CAMERA, PLAIN, 64, progress=False, device=gpu)
    error = np.sqrt((there.standard_error.astype(float) ** 2).mean() / SIDE**2)
    assert error < 0.005
    # The compensation of facet loss is tabulated, to some 1e-3.
    assert abs(there.rgb.mean(dtype=float) - 1) < 4 * error + 1e-3


def test_nothing_and_nothing_but_light(gpu):
    how = {"samples": 2, "progress": False, "device": gpu}
    for scene, radiance in [(rw.Scene([]), 0), (rw.Scene([], environment=(1, 2, 3)), (1, 2, 3))]:
        image = rw.render(scene, CAMERA, PLAIN, **how)
        assert image.plan["device"].chosen == gpu.name
        np.testing.assert_array_equal(image.rgb, np.broadcast_to(np.float32(radiance), image.rgb.shape))
    dark = rw.render(rw.Scene(floor(rw.Diffuse(0.5))), CAMERA, PLAIN, **how)
    assert not dark.rgb.any()


def test_the_same_seed_is_the_same_picture(gpu):
    scene, camera = rw.scenes.cornell_box(width=8, height=8)

    def render(**how):
        return rw.render(scene, camera, PLAIN, progress=False, device=gpu, **how)

    one, same, other = (render(samples=20, seed=seed) for seed in (2**40, 2**40, 2**40 + 1))
    np.testing.assert_array_equal(one.rgb, same.rgb)
    assert (one.rgb != other.rgb).any()


def test_large_scenes_and_pictures_are_taken_in_parts(gpu, monkeypatch):
    knot = rw.scenes.torus_knot(along=40, around=8)
    knot = rw.Mesh(knot.vertices, knot.faces, normals=knot.normals, material=rw.Mirror(0.9))
    scene = rw.Scene(knot, environment=sky())
    camera = rw.Camera((0, 0, 6), (0, 0, 0), width=24, height=16)

    def render():
        image = rw.render(scene, camera, PLAIN, 3, progress=False, device=gpu)
        assert image.plan["device"].chosen == gpu.name
        return image.rgb

    whole = render()
    most, gpu._most = gpu._most, 1 << 15
    try:
        np.testing.assert_array_equal(render(), whole)
        # Some devices have a million bindings.
        monkeypatch.setitem(gpu._device.limits, "max-storage-buffers-per-shader-stage", 8)
        gpu._most = 256
        image = rw.render(scene, camera, PLAIN, 1, progress=False, device=gpu)
        assert "no room: the scene needs" in image.plan["device"].why
    finally:
        gpu._most = most


def test_nothing_gets_in_between_faces(gpu):
    """Outside of a closed wall of odd faces it is so bright that a single ray through it would be seen."""
    shell = ball((0.3, 0.1, 0.2), rw.Diffuse(0.8), 2.0, rows=24)
    points = shell.vertices + 0.02 * np.sin(50 * shell.vertices[:, ::-1])
    scene = rw.Scene(rw.Mesh(points, shell.faces, material=shell.material), environment=1e6)
    camera = rw.Camera((0.1, 0.2, 0.3), (1, 0.2, 0.1), fov=120, width=SIDE, height=SIDE)
    path = rw.Path(max_depth=6, reuse=1, guiding="none")
    image = rw.render(scene, camera, path, 32, progress=False, device=gpu)
    assert image.plan["device"].chosen == gpu.name
    assert not image.rgb.any()


def test_limits_and_those_who_watch(gpu):
    scene, camera = rw.scenes.cornell_box(width=8, height=8)
    timed = rw.render(scene, camera, PLAIN, seconds=0.5, progress=False, device=gpu)
    assert timed.samples >= 1
    assert timed.seconds < 20
    sure = rw.render(scene, camera, PLAIN, error=0.2, progress=False, device=gpu)
    assert sure.error.high <= 0.2
    seen = []
    rw.render(scene, camera, PLAIN, 32, progress=seen.append, device=gpu)
    assert seen[-1].samples == 32
    assert seen[-1].plan["device"].chosen == gpu.name
    stop = threading.Event()
    stopped = rw.render(scene, camera, PLAIN, 10**6, progress=lambda image: stop.set(), stop=stop, device=gpu)
    assert stopped.samples < 10**6

    def interrupted(**how):
        left = [signal.SIGINT]

        def progress(image):
            if left:
                signal.raise_signal(left.pop())

        return rw.render(scene, camera, PLAIN, 10**6, progress=progress, device=gpu, **how)

    with pytest.raises(KeyboardInterrupt) as raised:
        interrupted()
    assert raised.value.image.plan["device"].chosen == gpu.name
    returned = interrupted(on_interrupt="return")
    assert "interrupted by Ctrl-C" in returned.warnings


LEFT = {
    "reuse=4 of Path": {"integrator": rw.Path(reuse=4)},
    "the integrator is a RayCast": {"integrator": rw.RayCast()},
    "adaptive=True": {"adaptive": True},
    "clamp": {"clamp": 10.0},
    "background='transparent'": {"background": "transparent"},
    "halves=True": {"halves": True},
    "denoise": {"denoise": True, "samples": 4, "sampler": rw.rendering.Independent()},
    "the sampler is a Sobol": {"sampler": rw.rendering.Sobol(4)},
    "the filter is MitchellFilter": {"filter": rw.rendering.MitchellFilter()},
    "the camera is a Orthographic": {"camera": rw.Orthographic((0, 1, 6), (0, 0, 0), width=4, height=4)},
    "the camera is far from all": {"camera": rw.Camera((0, 0, 1e5), (0, 0, 0), width=4, height=4)},
    "shape 0 is a Sphere": {"scene": rw.Scene(rw.Sphere())},
    "the scene has motion": {
        "scene": rw.Scene(rw.Instance([lamp()], [np.eye(4)], [np.diag([2.0, 2, 2, 1])]))
    },
    "the Phong of shape 0 has an unsupported type": {"scene": rw.Scene(floor(rw.materials.Phong()))},
    "the scene has masks": {"scene": rw.Scene(floor(rw.Mask(rw.Diffuse(), 0.5)))},
    "the scene has smoke and haze": {"scene": rw.Scene(lamp(), medium=rw.Homogeneous(0.1))},
    "shape 1 is too small": {"scene": rw.Scene([lamp(), ball((0, 0, 0), rw.Diffuse(), 1e-4)])},
    "is anisotropic": {"scene": rw.Scene(floor(rw.Conductor("gold", alpha=(0.1, 0.2))))},
    "has the distribution 'beckmann'": {
        "scene": rw.Scene(floor(rw.Conductor("gold", alpha=0.1, distribution="beckmann")))
    },
    "the reflectance of the Diffuse of shape 0 is a Checker": {
        "scene": rw.Scene(floor(rw.Diffuse(rw.Checker())))
    },
    "the scene has shapes in glass": {
        "scene": rw.Scene([ball((0, 0, 0), rw.Dielectric()), ball((0, 0, 0), rw.Dielectric(1.3), 0.5)])
    },
    "several glass shapes, and not all are closed": {
        "scene": rw.Scene(
            [
                ball((-2, 0, 0), rw.Dielectric()),
                quad((1, 0, 0), (1, 0, 0), (0, 1, 0), material=rw.Dielectric(1.3)),
            ]
        )
    },
    "the scene has a SpotLight": {
        "scene": rw.Scene([lamp()], lights=rw.SpotLight((0, 2, 0), (0, 0, 0), 1.0))
    },
    "the environment is a SunSky": {"scene": rw.Scene([lamp()], environment=rw.SunSky((0, 1, 1)))},
}


@pytest.mark.parametrize("why", LEFT)
def test_what_is_the_cpus_is_told_by_name(gpu, why):
    given = {
        "scene": rw.Scene(lamp()),
        "camera": rw.Camera((0, 1, 6), (0, 0, 0), width=4, height=4),
        "samples": 1,
        "progress": False,
        **LEFT[why],
    }
    image = rw.render(**given, device=gpu)
    row = image.plan["device"]
    assert (row.chosen, why in row.why) == ("CPU", True), row.why
    np.testing.assert_array_equal(image.rgb, rw.render(**given).rgb)


def test_what_is_no_device_is_refused():
    scene, camera = rw.Scene(lamp()), rw.Camera((0, 1, 6), (0, 0, 0), width=4, height=4)
    for wrong in (3, "cuda", rw.Gpu):
        with pytest.raises(TypeError, match=r"device must be a raywright\.Gpu, got"):
            rw.render(scene, camera, device=wrong)


def test_a_device_that_is_lost_is_told_of_and_the_cpu_goes_on(gpu, monkeypatch):
    from raywright.gpu.wavefront import Wavefront

    scene, camera = rw.scenes.cornell_box(width=SIDE, height=SIDE)
    add = Wavefront.add

    def fails(self, first, samples, look):
        if first >= 8:
            raise RuntimeError("Parent device is lost")
        return add(self, first, samples, look)

    monkeypatch.setattr(Wavefront, "add", fails)
    with pytest.warns(RuntimeWarning, match="was lost, and the CPU takes over: Parent device"):
        image = rw.render(scene, camera, PLAIN, 64, progress=False, device=gpu)
    assert image.samples == 64
    assert image.plan["device"].chosen == "CPU"
    assert "Parent device is lost" in image.warnings[0]
    agree(image, rw.render(scene, camera, PLAIN, 128, progress=False))


def resident():
    """Bytes of memory that the process has."""
    with open("/proc/self/statm") as told:
        return int(told.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="the system does not tell memory so")
def test_memory_does_not_grow_with_samples(gpu):
    # All kernels, and each kind of lighting: a driver may keep memory for each binding.
    looks = (
        rw.Diffuse(0.5),
        rw.Mirror(),
        rw.Conductor("gold", roughness=0.3),
        rw.Dielectric(1.5, roughness=0.3),
    )
    balls = [ball((2.5 * i - 4, 0, 0), material, rows=4) for i, material in enumerate(looks)]
    camera = rw.Camera((0, 1, 9), (0, 0, 0), width=16, height=16)
    for shapes, environment in (([*balls, lamp()], sky()), (balls, 0.5)):
        scene = rw.Scene(shapes, environment=environment)
        how = {"device": gpu, "progress": False}
        assert rw.render(scene, camera, PLAIN, samples=64, **how).plan["device"].chosen == gpu.name
        before = resident()
        rw.render(scene, camera, PLAIN, samples=384, **how)
        # It used to be half a megabyte for each of some two hundred bindings.
        assert resident() - before < 20e6
