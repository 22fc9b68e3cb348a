"""A `seed` is an integer, a Generator, which is advanced by one draw, or a SeedSequence, everywhere."""

import copy
import inspect
import pickle
from types import ModuleType

import numpy as np
import pytest

import raywright as rw

LAMP = rw.Mesh([(0.0, 0, 2), (1, 0, 2), (0, 1, 2)], [(0, 2, 1)], emission=5.0)
FLOOR = rw.Mesh([(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)])
SCREEN = rw.Mesh([(-1.0, 0, 1), (1, 0, 1), (0.2, 0.3, 1)], [(0, 1, 2)])
SCENE = rw.Scene([LAMP, FLOOR, SCREEN])
CAMERA = rw.Camera((0, -4, 3), (0, 0, 0), width=4, height=3)
LIDAR = rw.measure.RasterLidar(columns=9, rows=9, position=(0, 0.5, 3), forward=(0, 0, -1))

GRID = np.linspace(-0.9, 0.9, 4)
POINTS, UP = np.stack([GRID, GRID, 0 * GRID], axis=1), np.tile((0.0, 0, 1), (4, 1))
ONE, QUIET = {"samples": 1, "progress": False}, {"progress": False}


def vertices(shapes):
    return [mesh.vertices for mesh in shapes]


def frames(seed):
    rgb = []
    rw.render_frames([(SCENE, CAMERA)] * 2, lambda _, image: rgb.append(image.rgb), seed=seed, **ONE)
    return rgb


def viewed(seed):
    with rw.view(SCENE, CAMERA, samples=1, seed=seed) as viewer:
        return viewer._session._how["seed"]


def drawn(seed):
    return rw.integrators.Rng(seed, np.arange(3, dtype=np.uint32), np.zeros(3, np.uint32)).next_1d()


def timed(report, seed):
    # Of what it tells, nothing is a function of the seed.
    report(SCENE, rays=CAMERA, accelerators=rw.BVH(), repeats=1, seed=seed)


# What is returned is a function of the seed alone.
USES = {
    "FBm": lambda seed: rw.textures.FBm(0.0, 1.0, seed=seed).seed,
    "Marble": lambda seed: rw.textures.Marble(0.0, 1.0, seed=seed).seed,
    "Noise": lambda seed: rw.textures.Noise(0.0, 1.0, seed=seed).seed,
    "Rng": drawn,
    "Scene.photons": lambda seed: SCENE.photons(20, seed=seed).positions,
    "RenderSetup": lambda seed: rw.rendering.RenderSetup(SCENE, CAMERA, seed=seed).render(**ONE).rgb,
    "Wood": lambda seed: rw.textures.Wood(0.0, 1.0, seed=seed).seed,
    "aovs": lambda seed: rw.aovs(SCENE, CAMERA, "depth", samples=1, seed=seed)["depth"],
    "measure.ambient_visibility": lambda seed: (
        rw.measure.ambient_visibility(SCENE, POINTS, UP, 64, seed=seed).value
    ),
    "measure.lidar": lambda seed: rw.measure.lidar(SCENE, LIDAR, range_sigma=0.1, seed=seed).range,
    "measure.sky_view": lambda seed: rw.measure.sky_view(SCENE, POINTS, UP, 64, seed=seed).value,
    "radiative_exchange": lambda seed: (
        rw.radiative_exchange(SCENE, 300.0, 0.5, method="stochastic", rays=64, seed=seed, **QUIET).flux
    ),
    "radiosity": lambda seed: rw.radiosity(SCENE, error=0.5, rays=64, seed=seed, **QUIET).radiosity,
    "render": lambda seed: rw.render(SCENE, CAMERA, seed=seed, **ONE).rgb,
    "render_frames": frames,
    "report.accelerators": lambda seed: timed(rw.report.accelerators, seed),
    "report.kernels": lambda seed: rw.report.kernels(10, seed=seed, repeats=1).notes[0],
    "report.rays_per_build": lambda seed: timed(rw.report.rays_per_build, seed),
    "report.typical_rays": lambda seed: rw.report.typical_rays(SCENE, CAMERA, seed)["diffuse"].directions,
    "scenes.city": lambda seed: vertices(rw.scenes.city(1, seed)),
    "scenes.classics": lambda seed: vertices(
        part
        for scene, _ in rw.scenes.classics(1000, seed).values()
        for shape in scene.shapes
        for part in getattr(shape, "shapes", [shape])
    ),
    "scenes.forest": lambda seed: rw.scenes.forest(3, 1, 500, seed=seed),
    "scenes.many_lights": lambda seed: vertices(rw.scenes.many_lights(3, seed)[0].shapes),
    "scenes.room": lambda seed: vertices(rw.scenes.room(100, seed)),
    "scenes.soup": lambda seed: vertices(rw.scenes.soup(10, seed=seed)),
    "scenes.terrain": lambda seed: vertices(rw.scenes.terrain(4, 5, seed)),
    "view": viewed,
    "view_factors": lambda seed: rw.view_factors(SCENE, rays=64, seed=seed, **QUIET).matrix,
}
# Noises have seeds of 32 bits.
MOST = {"FBm": 2**32 - 1, "Marble": 2**32 - 1, "Noise": 2**32 - 1, "Wood": 2**32 - 1}


def with_seed(prefix, things):
    """Yield the names of what has a parameter `seed`, of classes their methods too."""
    for name, thing in things.items():
        if isinstance(thing, ModuleType):
            # Other submodules hold what the package knows by its own name, or kinds of it.
            prefix = f"{name}." if name in ("measure", "report", "scenes") else ""
            yield from with_seed(prefix, {own: getattr(thing, own) for own in thing.__all__})
        elif callable(thing):
            if inspect.isclass(thing):
                public = {own: value for own, value in inspect.getmembers(thing, callable) if own[0] != "_"}
                yield from with_seed(f"{prefix}{name}.", public)
            try:
                parameters = inspect.signature(thing).parameters
            except ValueError:
                continue
            if "seed" in parameters:
                yield prefix + name


def test_all_uses_are_known():
    assert set(with_seed("", {name: getattr(rw, name) for name in rw.__all__})) == set(USES)


@pytest.mark.parametrize("name", USES)
def test_a_generator_or_a_sequence_stands_for_an_integer(name):
    use, most = USES[name], MOST.get(name, 2**64 - 1)
    generator = np.random.default_rng(5)
    twin = copy.deepcopy(generator)
    number = int(twin.integers(2**64 - 1, dtype=np.uint64, endpoint=True)) & most
    found = pickle.dumps(use(generator))
    assert found == pickle.dumps(use(number))
    # By one draw, however much is made of it.
    assert generator.bit_generator.state == twin.bit_generator.state

    sequence = np.random.SeedSequence(5)
    number = int(sequence.generate_state(1, np.uint64)[0]) & most
    assert pickle.dumps(use(sequence)) == pickle.dumps(use(number))
    assert sequence.n_children_spawned == 0
    # Another number, another answer.
    assert (found == pickle.dumps(use(number))) == (use(number) is None)


@pytest.mark.parametrize("name", USES)
@pytest.mark.parametrize(
    ("seed", "message"),
    [
        (0.5, r"seed must be an integer, got 0\.5"),
        (None, r"seed must be an integer, got None"),
        (np.random.PCG64(1), "seed must be an integer, a Generator or a SeedSequence, got <numpy.*PCG64"),
        (np.random.RandomState(1), "seed must be an integer, a Generator or a SeedSequence, got RandomState"),
    ],
)
def test_other_seeds_are_refused(name, seed, message):
    with pytest.raises(TypeError, match=f"^{message}"):
        USES[name](seed)


def test_pictures_of_one_generator_differ_and_those_of_one_sequence_do_not():
    generator, sequence = np.random.default_rng(1), np.random.SeedSequence(1)
    assert not np.array_equal(USES["render"](generator), USES["render"](generator))
    assert np.array_equal(USES["render"](sequence), USES["render"](sequence))


def test_a_shot_keeps_the_number_of_its_generator():
    shot = rw.rendering.RenderSetup(SCENE, CAMERA, seed=np.random.default_rng(3))
    assert np.array_equal(shot.render(**ONE).rgb, shot.render(**ONE).rgb)


def test_a_contest_takes_sequences_that_were_spawned():
    seeds = np.random.SeedSequence(2).spawn(2)
    rw.report.convergence(SCENE, CAMERA, {"path": rw.Path()}, seconds=0.01, seeds=seeds)
    with pytest.raises(TypeError, match=r"^seeds must be an integer, got 0\.5"):
        rw.report.convergence(SCENE, CAMERA, {"path": rw.Path()}, seconds=0.01, seeds=[0.5])
