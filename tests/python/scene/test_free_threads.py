"""Python threads side by side give the answers of one thread: with the interpreter's lock, and without it."""

import subprocess
import sys
import sysconfig
import threading

import numpy as np
import pytest

import raywright as rw

THREADS = 4
TURNS = 6
IS_FREE = bool(sysconfig.get_config_var("Py_GIL_DISABLED"))


def at_once(work):
    """Return what each thread gets from `work(number)`; all begin together, and an error of one is raised."""
    gate, results, errors = threading.Barrier(THREADS), [None] * THREADS, []

    def run(number):
        gate.wait()
        try:
            results[number] = work(number)
        except BaseException as error:
            errors.append(error)

    threads = [threading.Thread(target=run, args=(number,)) for number in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    if errors:
        raise errors[0]
    return results


def same(left, right):
    for a, b in zip(left, right, strict=True):
        np.testing.assert_array_equal(a, b)


def rays(seed, count=500):
    rng = np.random.default_rng(seed)
    return rng.uniform(-2, 2, (count, 3)), rng.normal(size=(count, 3))


def soup(seed, count=300):
    rng = np.random.default_rng(seed)
    return rw.Mesh(rng.uniform(-1, 1, (3 * count, 3)), np.arange(3 * count).reshape(-1, 3))


def answers(scene, seed):
    origins, directions = rays(seed)
    hits, every = scene.intersect(origins, directions), scene.intersect_all(origins, directions)
    near = scene.closest_point(origins)
    blocked = scene.occluded(origins, directions, t_max=1.0)
    return hits.t, hits.primitive_id, hits.uv, every.t, every.ray_splits, near.distance, blocked


def test_one_scene_is_asked_and_compiled_by_all_at_once():
    """The first query compiles: whoever comes first, all get the same tree."""
    for turn in range(TURNS):
        scene = rw.Scene([soup(turn), rw.Torus((3, 0, 0), (0, 0, 1), 1.0, 0.3)])
        alone = [answers(rw.Scene(scene.shapes), number) for number in range(THREADS)]
        for found, expected in zip(at_once(lambda k, s=scene: answers(s, k)), alone, strict=True):
            same(found, expected)


def test_scenes_that_share_prototypes_are_made_and_dropped_by_all_at_once():
    """Prototypes are found again by the addresses of their shapes, which other threads free and take."""
    places = np.tile(np.eye(4), (5, 1, 1))
    places[:, :3, 3] = np.random.default_rng(0).uniform(-1, 1, (5, 3))
    shared = (soup(99),)

    def work(number):
        found = []
        for turn in range(4 * TURNS):
            shapes = shared if turn % 2 else (soup(10 * number + turn, 40),)
            found.append(rw.Scene(rw.Instance(shapes, places)).intersect(*rays(turn, 60)).t)
        return found

    alone = [work(number) for number in range(THREADS)]
    for found, expected in zip(at_once(work), alone, strict=True):
        same(found, expected)


def test_pictures_and_view_factors_are_the_same_at_once():
    def work(number):
        scene, camera = rw.scenes.cornell_box(width=6, height=6)
        image = rw.render(scene, camera, samples=4, seed=number, progress=False)
        factors = rw.view_factors(scene, per="shape", rays=16, seed=number, progress=False)
        return image.rgb, image.standard_error, factors.matrix

    alone = [work(number) for number in range(THREADS)]
    for found, expected in zip(at_once(work), alone, strict=True):
        same(found, expected)


def test_metals_and_films_are_tabulated_once_for_all():
    """Tables of spectra are made at the first use, here by several threads of a new process at once."""
    code = (
        "import threading, numpy as np, raywright as rw\n"
        "def work(k):\n"
        "    gold = rw.Conductor('Au', roughness=0.3)\n"
        "    ball = rw.Sphere((0, 0, 0), 1, material=rw.materials.ThinFilm(400.0, base=gold))\n"
        "    scene = rw.Scene([ball], environment=rw.Blackbody(4000))\n"
        "    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=4, height=4)\n"
        "    rgb[k] = rw.render(scene, camera, samples=2, progress=False).rgb\n"
        f"rgb, threads = {{}}, [threading.Thread(target=work, args=(k,)) for k in range({THREADS})]\n"
        "[t.start() for t in threads]; [t.join() for t in threads]\n"
        f"assert len(rgb) == {THREADS} and all(np.array_equal(rgb[0], one) for one in rgb.values())\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif(not IS_FREE, reason="this Python has its lock")
def test_the_import_leaves_the_lock_off():
    code = "import sys, raywright; raywright.simd(); print(sys._is_gil_enabled())"
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code], capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout.strip()) == (0, "False"), done.stderr
