"""Paths that share what they find in even media: the same mean, less noise, the same bits in any order."""

import math

import numpy as np
import pytest

import raywright as rw

CAMERA = rw.Camera((0, 0.3, 4), (0, 0, 0), fov=34, width=8, height=8)
LAMP = rw.Sphere((1.5, 2.5, 1), 0.5, material=rw.Diffuse(0), emission=9.0)


def render(scene, reuse, samples, seed=0, depth=None, roulette=4, camera=CAMERA, **how):
    path = rw.Path(depth, roulette, reuse=reuse, guiding="none")
    return rw.render(scene, camera, path, samples, seed=seed, progress=False, **how)


def filled(medium, *more, sky=0.0, **around):
    """A ball of a medium under a lamp, and other shapes."""
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(medium))
    return rw.Scene([ball, LAMP, *more], environment=sky, **around)


def thick(g=0.0, albedo=0.9, depth=2.0):
    phase = rw.HenyeyGreenstein(g) if g else rw.media.Isotropic()
    return rw.Homogeneous(depth * (1 - albedo), depth * albedo, phase=phase)


SUN = rw.DirectionalLight((-1, -1, -0.5), 3.0)
SCENES = {
    "even": lambda: filled(thick()),
    "forward": lambda: filled(thick(0.8), sky=0.3),
    "backward": lambda: filled(thick(-0.6), lights=[SUN]),
    "Rayleigh": lambda: filled(rw.Homogeneous(0.1, 1.5, phase=rw.media.Rayleigh()), lights=[SUN]),
    "colored": lambda: filled(rw.Homogeneous((0.1, 0.3, 0.0), (0.3, 1.0, 6.0)), sky=(1.0, 0.7, 0.4)),
    "one channel": lambda: filled(rw.Homogeneous(0.5, (0.0, 2.0, 0.0)), sky=0.5),
    "things in it": lambda: filled(
        thick(0.4),
        rw.Sphere((0.2, 0.3, 0.3), 0.4, material=rw.Diffuse((0.8, 0.5, 0.2))),
        rw.Sphere((-0.4, -0.3, 0.2), 0.3, material=rw.Dielectric(1.5)),
        sky=0.3,
    ),
    "another in it": lambda: filled(
        thick(0.4),
        rw.Sphere((0, 0, 0.2), 0.5, material=rw.MediumInterface(thick(0.0, 0.5, 6.0), priority=1)),
        sky=0.2,
    ),
    "within glass": lambda: rw.Scene(
        [rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(1.3, interior=thick(0.5, 0.95, 4.0))), LAMP],
        environment=0.5,
    ),
    "everywhere": lambda: rw.Scene(
        [rw.Sphere((0, 0, 0), 0.6, material=rw.Diffuse(0.5)), LAMP], medium=thick(0.5, 0.8, 0.4)
    ),
    "glowing": lambda: filled(rw.Homogeneous(0.3, 1.5, emission=(0.5, 0.2, 0.1))),
    "over a floor": lambda: filled(
        thick(0.3), rw.Disk((0, -1.05, 0), (0, 1, 0), 2.0, material=rw.Diffuse((0.9, 0.5, 0.2))), lights=[SUN]
    ),
    "on a floor": lambda: rw.Scene(
        [
            rw.Box((-1, -1, -1), (1, 0.2, 1), material=rw.MediumInterface(thick(0.0, 0.9, 1.0))),
            rw.Box((-2, -1.5, -2), (2, -1, 2), material=rw.Diffuse(0.8)),
            LAMP,
        ]
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "depth"), [*((name, None) for name in SCENES), ("things in it", 3)])
def test_the_mean_is_what_it_is_without(name, depth):
    scene, count = SCENES[name](), 30
    one, shared = (
        np.array([render(scene, reuse, 32, i, depth, 0).rgb for i in range(count)], dtype=float)
        for reuse in (1, 4)
    )
    # By Student's t with some 58 degrees of freedom: one of 192 numbers of a picture lies beyond 6.5 standard
    # errors once in a hundred thousand cases; a mean of all, whose errors are those of pictures, beyond 4.2
    # once in 10,000.
    for a, b, most in ((one, shared, 6.5), (one.mean(axis=(1, 2)), shared.mean(axis=(1, 2)), 4.2)):
        error = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / count)
        assert (np.abs(a.mean(axis=0) - b.mean(axis=0)) <= most * error + 1e-6).all()


@pytest.mark.parametrize("g", [0.0, 0.9])
def test_a_white_ball_in_an_even_sky_is_invisible(g):
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(thick(g, 1.0, 3.0)))
    scene = rw.Scene([ball], environment=1.0)
    means = [render(scene, 4, 16, seed).rgb.mean(axis=(0, 1), dtype=float) for seed in range(20)]
    error = np.std(means, axis=0, ddof=1) / math.sqrt(20)
    # Student's t with 19 degrees of freedom: beyond 5 standard errors once in 12,000 cases.
    assert (np.abs(np.mean(means, axis=0) - 1) <= 5 * error + 1e-6).all()
    assert error.max() < 0.01


def test_there_is_less_noise_where_light_is_scattered_often():
    slab = rw.Box((-3, -1, -3), (3, 1, 3), material=rw.MediumInterface(thick()))
    camera = rw.Camera((0, 0.3, 4), (0, 0, 0), fov=34, width=32, height=16)
    scene = rw.Scene([slab, rw.Sphere((0, 4, 0), 0.7, material=rw.Diffuse(0), emission=9.0)])
    pictures = [
        np.array([render(scene, reuse, 4, s, camera=camera).rgb for s in range(6)], dtype=float)
        for reuse in (1, 8)
    ]
    noise = [of.var(axis=0, ddof=1).mean() for of in pictures]
    assert noise[1] < 0.45 * noise[0]


def test_pictures_are_the_same_for_any_threads():
    scene = SCENES["things in it"]()
    camera = rw.Camera((0, 0.3, 4), (0, 0, 0), fov=34, width=20, height=12)
    one, two = (render(scene, 4, 8, camera=camera, threads=threads) for threads in (1, 2))
    assert np.array_equal(one.rgb, two.rgb)
    assert not np.array_equal(one.rgb, render(scene, 1, 8, camera=camera).rgb)


def test_what_cannot_be_shared_is_as_without():
    grid = rw.GridMedium(np.ones((2, 2, 2)), [(-1, -1, -1), (1, 1, 1)], scattering=2.0)
    point = [rw.PointLight((0, 3, 0), 20.0)]
    for scene in (filled(grid), filled(thick(), lights=point), filled(rw.Homogeneous(1.0))):
        assert np.array_equal(render(scene, 4, 4).rgb, render(scene, 1, 4).rgb)
    once = filled(thick())
    assert np.array_equal(render(once, 4, 4, depth=1).rgb, render(once, 1, 4, depth=1).rgb)


def test_where_nearly_all_light_goes_straight_on_nothing_is_shared():
    """Shares would be worth a thousand times their mean there, and come once in as many samples."""
    cloud = rw.Homogeneous(0, 1, rw.HenyeyGreenstein(0.99))
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1, material=rw.MediumInterface(cloud))], environment=1.0)
    camera = rw.Camera((0, 0, 4), (0, 0, 0), fov=20, width=8, height=8)
    errors = []
    for reuse in (1, 4):
        made = rw.render(
            scene,
            camera,
            rw.Path(reuse=reuse),
            samples=64,
            sampler=rw.rendering.Independent(),
            progress=False,
        )
        errors.append(float(((made.rgb - 1) ** 2).mean()))
    assert errors[1] < 1.5 * errors[0] < 0.003, errors
