"""No NaN, no infinity and nothing negative is ever in a picture; what was left out is counted and told."""

import math

import numpy as np
import pytest

import raywright as rw


class Spoilt(rw.integrators.Integrator):
    """Radiance 1, but for about this share of the samples, which have something else in one channel."""

    def __init__(self, value, share):
        self.value, self.share = value, share
        self.spoilt = 0

    def radiance(self, scene, rays, rng):
        result = np.ones((len(rays), 3))
        spoilt = rng.next_1d() < self.share
        result[spoilt, 1] = self.value
        self.spoilt += int(spoilt.sum())
        return result


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -1.0, -1e-300, 1e39, 1e300])
def test_what_is_no_radiance_counts_as_black_and_is_counted(value):
    scene, camera = rw.scenes.cornell_box(width=8, height=8)
    spoilt = Spoilt(value, 0.1)
    with pytest.warns(RuntimeWarning, match=r"Spoilt\.radiance must return finite .* for \d+ samples"):
        image = rw.render(scene, camera, spoilt, samples=16, progress=False)
    assert 50 < spoilt.spoilt < 150
    assert image.warnings[0].startswith(f"{spoilt.spoilt} samples were not finite or negative")
    # Such a sample is entirely black, and the others are unchanged.
    assert (image.rgb * 16).sum(axis=(0, 1)).tolist() == [1024 - spoilt.spoilt] * 3
    assert np.isfinite(image.standard_error).all()
    assert math.isfinite(image.error.estimate)


def test_one_sample_that_is_no_radiance_is_told_as_one():
    scene, camera = rw.scenes.cornell_box(width=1, height=1)
    with pytest.warns(RuntimeWarning, match="did not for 1 sample, which count"):
        image = rw.render(scene, camera, Spoilt(np.nan, 1.0), samples=1, progress=False)
    assert image.warnings[0] == "1 sample was not finite or negative, and counts as black"


def test_a_picture_without_any_says_nothing():
    scene, camera = rw.scenes.cornell_box(width=4, height=4)
    how = {"samples": 16, "sampler": rw.rendering.Independent(), "progress": False}
    assert rw.render(scene, camera, Spoilt(2.0, 0.1), **how).warnings == ()


def anything(rng, most):
    """A scene of materials, shapes and lights with numbers at the ends of what they may be."""
    ends = (0.0, 1e-300, 1e-9, 1e-4, 0.3, 0.5, 0.999, 1 - 1e-12, 1.0)

    def share():
        return float(rng.choice(ends))

    def strength():
        return float(rng.choice([0.0, 1e-40, 1e-30, 1.0, most]))

    def ior():
        return float(rng.choice([1e-3, 0.5, 1.0, 1 + 1e-7, 1.0001, 1.5, 10.0, 1e3]))

    def material():
        kinds = [
            lambda: rw.Diffuse(share()),
            lambda: rw.materials.OrenNayar(share(), share()),
            lambda: rw.Mirror(share()),
            lambda: rw.Dielectric(ior(), alpha=share(), priority=int(rng.integers(3))),
            lambda: rw.ThinDielectric(ior()),
            lambda: rw.Conductor(eta=ior(), k=float(rng.choice([0, 1e-9, 3, 1e9])), alpha=(share(), share())),
            lambda: rw.Plastic(share(), max(ior(), 1.0), alpha=share()),
            lambda: rw.materials.Phong(0.5 * share(), 0.5 * share(), float(rng.choice([0, 1, 1e4, 1e12]))),
            lambda: rw.materials.BlinnPhong(
                0.5 * share(), 0.5 * share(), float(rng.choice([0, 1, 1e4, 1e12]))
            ),
            lambda: rw.MetallicRough(share(), share(), share()),
            lambda: rw.Mix(rw.Diffuse(share()), rw.Mirror(share()), share()),
            lambda: rw.Mask(rw.Diffuse(share()), share()),
            lambda: rw.BumpMap(rw.Diffuse(share()), rw.textures.Noise(), float(rng.choice([1e-9, 1, 1e9]))),
        ]
        return kinds[rng.integers(len(kinds))]()

    def place():
        return rng.uniform(-1, 1, 3)

    size = float(rng.choice([1e-3, 1e-2, 1.0, 1.0, 1e6]))
    shapes = [
        rw.Sphere(
            size * place(), size * float(rng.choice([1e-5, 0.3, 0.3, 2])), material=material(), emission=e
        )
        for e in (0.0, strength())
    ]
    corners = size * rng.uniform(-1, 1, (9, 3)) * rng.choice([1, 1, 1e-5], (9, 1))
    faces = np.arange(9).reshape(3, 3)
    normals = rng.normal(size=(9, 3))
    shapes += [
        rw.Mesh(corners, faces, normals=normals, material=material(), emission=strength()),
        rw.Disk(size * place(), place(), size, material=material()),
        rw.Disk((0, -size, 0), (0, 1, 0), 3 * size, material=rw.Diffuse(share())),
    ]
    lights = [
        rw.PointLight(size * place(), strength()),
        # On a surface, too.
        rw.PointLight(np.asarray(corners[0]), strength()),
        rw.DirectionalLight(place(), strength()),
    ]
    picture = rng.choice([0, 1e-30, 1.0, 1e7], (4, 8)).astype(np.float32)
    environment = [None, strength(), rw.EnvironmentMap(picture)][rng.integers(3)]
    camera = rw.Camera(3 * size * place(), (0, 0, 0), fov=40, width=8, height=8)
    return rw.Scene(shapes, lights=lights, environment=environment), camera


INTEGRATORS = [
    rw.Path(),
    rw.Path(max_depth=3),
    rw.Direct(2, 2),
    rw.Whitted(ambient=1.0),
    rw.integrators.Distributed(splits=2, ambient=1.0),
    rw.RayCast(ambient=1e3),
    rw.AmbientOcclusion(),
]


@pytest.mark.parametrize("most", [1e7, 1e30])
@pytest.mark.parametrize("seed", range(20))
def test_no_picture_of_anything_has_what_is_no_number(seed, most):
    scene, camera = anything(np.random.default_rng(seed), most)
    integrator = INTEGRATORS[seed % len(INTEGRATORS)]
    image = rw.render(
        scene, camera, integrator, samples=8, seed=seed, progress=False, aov=["depth", "normal", "albedo"]
    )
    assert np.isfinite(image.rgb).all()
    assert (image.rgb >= 0).all()
    assert np.isfinite(image.standard_error).all()
    assert math.isfinite(image.error.estimate)
    assert np.isfinite(image.aov["normal"]).all()
    assert np.isfinite(image.aov["albedo"]).all()
    # Lamps of 1e30 may overflow float32, close by or in highlights; those of 1e7 do not.
    assert most > 1e7 or not any("finite" in warning for warning in image.warnings), image.warnings
