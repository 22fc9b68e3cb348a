"""Paths that pixels of a patch share: the same mean, less noise, the same bits however it is worked on."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from cornell_picture import cornell_picture

import raywright as rw


def render(scene, camera, reuse, **how):
    how = {"samples": 16} | how
    return rw.render(scene, camera, rw.Path(reuse=reuse), progress=False, **how)


def relmse(image, reference):
    return float(np.mean(np.square(image.rgb - reference) / (np.square(reference) + 0.01)))


def assert_same(a, b):
    assert np.array_equal(a.rgb, b.rgb)
    assert np.array_equal(a.standard_error, b.standard_error)
    assert a.error == b.error


def box(width=24, height=24):
    return rw.scenes.cornell_box(width=width, height=height)


def room(*more):
    """Gray walls around the origin, a lamp under the ceiling, and what else; seen from within."""
    walls = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse((0.7, 0.5, 0.3)))
    x, y = 0.4, 0.95
    corners = [(-x, y, -x), (x, y, -x), (x, y, x), (-x, y, x)]
    lamp = rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0.2), emission=8)
    camera = rw.Camera((0, 0, 0.98), (0, -0.2, 0), fov=90, width=12, height=12)
    return rw.Scene([walls, lamp, *more]), camera


def coarse_ball():
    """Few faces with the normals of a ball."""
    around = np.linspace(0, 2 * np.pi, 7)[:-1]
    ring = np.stack([np.cos(around), 0 * around, np.sin(around)], axis=1)
    normals = np.concatenate([[(0, 1, 0)], ring, [(0, -1, 0)]])
    faces = [(0, 1 + (i + 1) % 6, 1 + i) for i in range(6)] + [(7, 1 + i, 1 + (i + 1) % 6) for i in range(6)]
    vertices = 0.5 * normals + (0, -0.3, 0)
    return rw.Mesh(vertices, faces, normals=normals, material=rw.Diffuse(0.8))


def shiny():
    """A surface that is half matt, and one that is half a mirror."""
    half = rw.Mix(rw.Diffuse(0.6), rw.Mirror(0.8), 0.5)
    return [
        rw.Sphere((-0.4, -0.5, 0), 0.3, material=half),
        rw.Sphere((0.4, -0.5, 0), 0.3, material=rw.Plastic((0.2, 0.4, 0.8))),
    ]


def glowing():
    """A surface that reflects and shines, on both of its sides."""
    corners = [(-0.5, -0.6, -0.5), (0.5, -0.6, -0.5), (0.5, -0.2, 0.4), (-0.5, -0.2, 0.4)]
    light = rw.Emission(0.7, both_sides=True)
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse((0.9, 0.1, 0)), emission=light)


WAYS = [{}, {"adaptive": True}, {"sampler": rw.rendering.Sobol()}, {"filter": rw.rendering.MitchellFilter()}]

SCENES = {
    "cornell": lambda: box(12, 12),
    "smooth normals": lambda: room(coarse_ball()),
    "matt and shiny": lambda: room(*shiny()),
    "shines where it reflects": lambda: room(glowing()),
}


# Expectation without sharing: rgb and standard error of render(scene, camera, 1, samples=32768,
# sampler=rw.rendering.Sobol(), seed=10**9), by the name of the scene.
ALONE = Path(__file__).parents[1] / "data" / "path_reuse.npz"


@pytest.mark.parametrize("name", SCENES)
def test_the_mean_is_what_it_is_without(name):
    scene, camera = SCENES[name]()
    with np.load(ALONE) as stored:
        alone, error_of_alone = stored[name].astype(float)
    for reuse in (2, 4):
        # Stored pixels have so little error that half the samples are as good as two such sets would be.
        few = np.array(
            [render(scene, camera, reuse, samples=32, seed=s, threads=1).rgb for s in range(40)], float
        )
        # For the whole picture, four standard errors are exceeded once in 16,000 cases. Pixels of a patch err
        # together, so the spread is that of pictures.
        pictures = few.mean(axis=(1, 2))
        error_of_all = np.hypot(
            pictures.std(axis=0, ddof=1) / np.sqrt(40), np.sqrt(np.mean(error_of_alone**2, (0, 1)) / 144)
        )
        off_by = np.abs(pictures.mean(axis=0) - alone.mean(axis=(0, 1)))
        assert (off_by <= 4 * error_of_all + 1e-6).all()
        # For pixels, by Student's t with 40 samples, six are exceeded once in a million.
        error = few.var(axis=0, ddof=1) / 40
        off = np.abs(few.mean(axis=0) - alone) / np.sqrt(error + error_of_alone**2 + 1e-12)
        assert off.max() < 6.5
        assert np.mean(error_of_alone**2) < 0.2 * np.mean(error)


def haze():
    """A medium that scatters each color by its own, in a room with a surface that has a spectrum."""
    scene, camera = room(spectral())
    return scene.replace(medium=rw.media.Homogeneous(0.1, (0.2, 0.4, 0.8))), camera


def spectral():
    return rw.Sphere((0.5, -0.6, 0.2), 0.3, material=rw.Diffuse(rw.Spectrum([360, 830], [0.2, 0.8])))


def prism():
    return rw.Sphere((0, -0.3, 0.3), 0.4, material=rw.Dielectric(rw.materials.glasses["N-SF11"]))


BY_WAVELENGTH = {"surfaces": lambda: room(spectral()), "glass": lambda: room(prism()), "haze": haze}


@pytest.mark.parametrize("name", BY_WAVELENGTH)
def test_the_mean_by_wavelength_is_what_it_is_without(name):
    scene, camera = BY_WAVELENGTH[name]()
    assert scene.wavelengths
    means, errors = {}, {}
    for reuse in (1, 4):
        few = [render(scene, camera, reuse, samples=64, seed=10 * reuse + 1000 * s).rgb for s in range(24)]
        pictures = np.array(few, float).mean(axis=(1, 2))
        means[reuse], errors[reuse] = pictures.mean(axis=0), pictures.std(axis=0, ddof=1) / np.sqrt(24)
    off = np.abs(means[4] - means[1]) / np.hypot(errors[4], errors[1])
    # By Student's t with 46 samples, once in 20,000 a channel.
    assert off.max() < 4.5
    assert (errors[4] < 0.01 * means[1].max()).all()


def test_the_error_by_wavelength_is_a_small_part_of_what_it_is_without():
    scene, camera = box(64, 64)
    scene = scene.replace(shapes=[*scene.shapes, spectral()])
    errors = {}
    for reuse in (1, 4):
        pictures = np.array(
            [render(scene, camera, reuse, samples=64, seed=seed).rgb for seed in range(3)], float
        )
        # The color noise that all pixels share would be known from three pictures alone.
        pictures *= pictures.mean(axis=(0, 1, 2)) / pictures.mean(axis=(1, 2), keepdims=True)
        errors[reuse] = np.mean(pictures.var(axis=0, ddof=1) / (pictures.mean(axis=0) ** 2 + 0.01))
    # 0.22 to 0.31 with four sets of seeds.
    assert errors[4] < 0.4 * errors[1]


def test_a_furnace_shines_by_its_geometric_series():
    shell = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0.6), emission=rw.Emission(1.0, both_sides=True))
    camera = rw.Camera((0, 0, 0.2), (0, 0.3, -1), fov=70, width=16, height=16)
    image = render(rw.Scene([shell]), camera, 4, samples=256, seed=2)
    # Two and a half, within five standard errors of the mean over patches, which err independently.
    patches = image.rgb.reshape(4, 4, 4, 4, 3).mean(axis=(1, 3)).reshape(16, 3)
    error = patches.std(axis=0, ddof=1) / 4
    assert (np.abs(patches.mean(axis=0) - 2.5) <= 5 * error + 1e-5).all()
    assert (error < 0.01).all()


def test_the_error_is_a_small_part_of_what_it_is_without():
    # In smaller pictures much of the error is in pixels at the edge of the lamp, whose light is direct.
    scene, camera = box(128, 128)
    errors = {}
    for reuse in (1, 2, 4):
        how = {"samples": 16, "sampler": rw.rendering.Sobol()}
        pictures = np.array([render(scene, camera, reuse, seed=seed, **how).rgb for seed in range(2)])
        spread = pictures.var(axis=0, ddof=1, dtype=np.float64)
        errors[reuse] = np.mean(spread / (np.square(pictures.mean(axis=0)) + 0.01))
    # Each is known to a few percent.
    assert errors[2] < 0.5 * errors[1]
    assert errors[4] < 0.25 * errors[1]


@pytest.mark.parametrize("reuse", [2, 4, 8])
@pytest.mark.parametrize("how", WAYS)
def test_threads_and_passes_change_no_bit(reuse, how):
    scene, camera = box(21, 13)
    one = render(scene, camera, reuse, samples=40, threads=1, **how)
    two = render(scene, camera, reuse, samples=40, threads=2, **how)
    assert_same(one, two)
    assert not any("not finite" in warning for warning in one.warnings)
    timed = render(scene, camera, reuse, samples=None, seconds=0.1, **how)
    again = render(scene, camera, reuse, samples=timed.samples, **how | {"sampler": timed.plan.sampler})
    assert np.array_equal(again.rgb, timed.rgb)


@pytest.mark.parametrize("adaptive", [False, True])
def test_pieces_and_checkpoints_change_no_bit(tmp_path, adaptive):
    scene, camera = box(21, 13)
    whole = render(scene, camera, 4, samples=64, adaptive=adaptive, seed=5)
    with ThreadPoolExecutor(2) as pool:
        pieces = render(scene, camera, 4, samples=64, adaptive=adaptive, seed=5, executor=pool)
    assert_same(pieces, whole)
    path = tmp_path / "reuse.checkpoint"
    how = {"adaptive": adaptive, "seed": 5, "sampler": whole.plan.sampler}
    for samples in (8, 24, 64):
        last = render(scene, camera, 4, samples=samples, **how, checkpoint=path)
    assert np.array_equal(last.rgb, whole.rgb)
    with pytest.raises(ValueError, match="is of another render: it has another integrator"):
        render(scene, camera, 2, samples=64, **how, checkpoint=path)


def test_without_reuse_bits_are_those_of_paths():
    scene, camera = box(21, 13)
    shared_nothing = rw.Path(max_depth=1, reuse=8), rw.Path(max_depth=1)
    a, b = (rw.render(scene, camera, path, samples=20, progress=False) for path in shared_nothing)
    assert_same(a, b)


def test_nothing_is_shared_where_something_moves_lets_through_or_has_a_filtered_texture():
    lace = rw.Sphere((0, -0.4, 0), 0.4, material=rw.Mask(rw.Diffuse(0.5), 0.5))
    there = np.eye(4)
    there[0, 3] = 0.3
    moving = rw.Instance(coarse_ball(), np.eye(4), there)
    checkered = rw.Sphere(
        (0, -0.5, 0), 0.4, material=rw.Diffuse(rw.Checker((0.9, 0.1, 0.1), (0.1, 0.1, 0.9), 8))
    )
    for scene, camera in (room(lace), room(moving), room(checkered)):
        a, b = (render(scene, camera, reuse, seed=3) for reuse in (1, 4))
        assert_same(a, b)


def test_intervals_hold_the_error():
    scene, camera, reference = cornell_picture(24)
    inside = 0
    for seed in range(40):
        image = render(scene, camera, 4, seed=seed)
        inside += image.error.low <= relmse(image, reference) <= image.error.high
    # At 95 %, 33 of 40 or fewer are inside once in 300 cases.
    assert inside >= 34


def test_intervals_of_pixels_hold_the_reference():
    scene, camera, reference = cornell_picture(24)
    covered = []
    for seed in range(10):
        low, high = render(scene, camera, 4, samples=256, seed=seed).interval()
        covered.append(np.mean((low <= reference) & (reference <= high)))
    assert 0.92 <= np.mean(covered) <= 0.97


@pytest.mark.parametrize("value", [0, 3, 16, -4])
def test_sides_that_there_are_not_are_refused(value):
    with pytest.raises(ValueError, match="reuse must be"):
        rw.Path(reuse=value)


@pytest.mark.parametrize("value", [2.0, "4", True])
def test_what_is_no_integer_is_refused(value):
    with pytest.raises(TypeError, match="reuse must be an integer, got"):
        rw.Path(reuse=value)
