"""Integrators written in Python give the core's pictures, and their errors come through."""

import importlib.util
import pickle
from pathlib import Path

import numpy as np
import pytest

import raywright as rw

EXAMPLES = Path(__file__).parents[3] / "examples"


def example(name):
    spec = importlib.util.spec_from_file_location(name, EXAMPLES / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def assert_same_picture(one, other, blocks=8):
    """Means of 192 blocks agree within five standard errors, which chance exceeds once in 9,000 pictures."""
    side = len(one.rgb) // blocks

    def mean(array):
        return array.astype(np.float64).reshape(blocks, side, blocks, side, 3).mean(axis=(1, 3))

    def error(image):
        return np.sqrt(mean(image.standard_error.astype(np.float64) ** 2)) / side

    off = np.abs(mean(one.rgb) - mean(other.rgb)) / np.maximum(np.hypot(error(one), error(other)), 1e-7)
    assert off.max() < 5
    # The errors are small enough for a meaningful comparison.
    assert np.median(np.hypot(error(one), error(other)) / mean(other.rgb)) < 0.05


def test_the_path_tracer_of_the_examples_gives_the_cores_picture():
    scene, camera = rw.scenes.cornell_box(width=48, height=48)
    written = rw.render(scene, camera, example("path_tracer").PathTracer(), samples=64, progress=False)
    assert_same_picture(written, rw.render(scene, camera, samples=64, seed=1, progress=False))


def test_the_path_tracer_of_the_examples_knows_glass():
    scene, camera = rw.scenes.whitted_spheres(width=48, height=48)
    written = rw.render(scene, camera, example("path_tracer").PathTracer(), samples=64, progress=False)
    assert_same_picture(written, rw.render(scene, camera, samples=64, seed=1, progress=False))


def test_whitted_of_the_examples_gives_the_cores_picture():
    scene, camera = rw.scenes.whitted_spheres(width=48, height=48)
    written = rw.render(scene, camera, example("whitted").Whitted(), samples=64, progress=False)
    core = rw.render(scene, camera, rw.Whitted(contribution=0.0), samples=64, seed=1, progress=False)
    assert_same_picture(written, core)


@pytest.mark.parametrize("name", ["path_tracer", "whitted"])
def test_the_examples_are_short(name):
    assert len((EXAMPLES / f"{name}.py").read_text().splitlines()) <= 65


def test_threads_change_no_bit():
    scene, camera = rw.scenes.cornell_box(width=20, height=20)
    tracer = example("path_tracer").PathTracer()
    one, two = (
        rw.render(scene, camera, tracer, samples=9, threads=threads, progress=False) for threads in (1, 2)
    )
    assert np.array_equal(one.rgb, two.rgb)


class Constant(rw.integrators.Integrator):
    def __init__(self, value):
        self.value = value

    def radiance(self, scene, rays, rng):
        return np.broadcast_to(self.value, (len(rays), 3))


def test_what_is_returned_is_the_picture():
    scene, camera = rw.scenes.cornell_box(width=4, height=4)
    image = rw.render(scene, camera, Constant((1.0, 2.0, 0.5)), samples=4, progress=False)
    assert (image.rgb == np.float32((1.0, 2.0, 0.5))).all()
    assert (image.standard_error == 0).all()
    told = r"Constant\.radiance must return finite numbers .* did not for 64 samples, which count as black"
    with pytest.warns(RuntimeWarning, match=told):
        bad = rw.render(scene, camera, Constant((1.0, np.nan, 0.5)), samples=4, progress=False)
    assert (bad.rgb == 0).all()
    assert "64 samples" in bad.warnings[0]


def test_what_it_raises_comes_through():
    class Broken(rw.integrators.Integrator):
        def radiance(self, scene, rays, rng):
            raise LookupError("nothing there")

    class Misshaped(rw.integrators.Integrator):
        def radiance(self, scene, rays, rng):
            return np.zeros(3)

    scene, camera = rw.scenes.cornell_box(width=4, height=4)
    with pytest.raises(LookupError, match="nothing there"):
        rw.render(scene, camera, Broken(), samples=4, progress=False)
    with pytest.raises(TypeError, match=r"Misshaped.radiance must return an array of shape \(\d+, 3\), got"):
        rw.render(scene, camera, Misshaped(), samples=4, progress=False)
    with pytest.raises(TypeError, match="abstract"):
        rw.integrators.Integrator()


def test_interactions_tell_of_hits_and_misses():
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1.0, emission=3.0)], environment=0.25)
    rays = rw.query.Rays(
        np.array([[0, 0, 4.0], [0, 0, 4.0]]), np.array([[0, 0, -1.0], [0, 0, 1.0]]), np.zeros(2)
    )
    here = scene.interactions(rays)
    assert here.hit.tolist() == [True, False]
    assert here.shape_id.tolist() == [0, -1]
    assert here.t.tolist() == [3.0, np.inf]
    assert np.allclose(here.position[0], (0, 0, 1), atol=1e-15)
    assert np.isnan(here.position[1]).all()
    assert np.array_equal(here.emission, [(3.0,) * 3, (0.25,) * 3])
    assert np.array_equal(here.normal[0], here.shading_normal[0])
    assert not here.t.flags.writeable
    # Lambert's law: half gray over pi, times the cosine, and drawn by that.
    value, pdf = here.evaluate([(0, 0.6, 0.8), (0, 0, 1)])
    assert value[0] == pytest.approx(0.5 * 0.8 / np.pi)
    assert pdf[0] == pytest.approx(0.8 / np.pi)
    assert (value[1] == 0).all()
    assert pdf[1] == 0
    part = here[np.array([True, False])]
    assert part.t.tolist() == [3.0]
    left = here.spawn_rays(np.array([(0, 0, 1.0), (0, 0, 1.0)]))
    assert left.origins[0, 2] > 1
    assert not scene.occluded(left.origins[:1], left.directions[:1])[0]


def test_what_does_not_fit_is_refused():
    scene, _ = rw.scenes.cornell_box()
    rays = rw.query.Rays(np.zeros((2, 3)), np.tile((0.0, 0, 1), (2, 1)), np.zeros(2))
    here = scene.interactions(rays)
    with pytest.raises(ValueError, match=r"rays must have shapes \(N, 3\), \(N, 3\) and \(N,\)"):
        rw.query.Rays(np.zeros((2, 3)), np.zeros((3, 3)), np.zeros(2))
    with pytest.raises(TypeError, match=r"rays must be raywright\.query\.Rays, got tuple"):
        scene.interactions((rays.origins, rays.directions))
    with pytest.raises(ValueError, match="directions has 3 rows, expected 2"):
        here.evaluate(np.ones((3, 3)))
    with pytest.raises(ValueError, match="u has 1 rows, expected 2"):
        here.sample_bsdf(np.zeros(2), np.zeros((1, 2)))
    with pytest.raises(ValueError, match="index 2 is out of range for 2 rays"):
        here[np.array([0, 2])]
    with pytest.raises(IndexError, match="a mask must have shape"):
        here[np.array([True])]


def test_random_numbers_are_named_by_pixel_and_sample():
    pixel, sample = np.arange(100, dtype=np.uint32), np.full(100, 3, np.uint32)
    whole, part = rw.integrators.Rng(7, pixel, sample), rw.integrators.Rng(7, pixel[40:], sample[40:])
    assert np.array_equal(whole.next_1d()[40:], part.next_1d())
    some = np.arange(0, 60, 2)
    assert np.array_equal(whole.next_2d(some + 40), part.next_2d(some))
    assert whole.next_2d().shape == (100, 2)


def test_no_two_samples_have_the_same_numbers():
    seen = []

    class Recorded(rw.integrators.Integrator):
        def radiance(self, scene, rays, rng):
            seen.extend(rng.next_1d())
            return np.zeros((len(rays), 3))

    scene, camera = rw.scenes.cornell_box(width=2, height=2)
    rw.render(scene, camera, Recorded(), samples=64, sampler=rw.rendering.Sobol(8), progress=False)
    assert len(np.unique(seen)) == len(seen) == 256


def test_the_power_heuristic_survives_extremes():
    assert rw.query.power_heuristic(np.inf, 2.0) == 1
    assert rw.query.power_heuristic(0.0, 2.0) == 0
    assert rw.query.power_heuristic(1e-200, 1e200) == 0
    a, b = np.array([1.0, 1e300]), np.array([3.0, 1e300])
    assert np.allclose(rw.query.power_heuristic(a, b) + rw.query.power_heuristic(b, a), 1)


def test_written_integrators_pickle_as_any_object():
    again = pickle.loads(pickle.dumps(Constant((1.0, 2.0, 3.0))))
    assert again.value == (1.0, 2.0, 3.0)
