"""Scattering at its ends: hardly rough, hardly bent, grazing, at the critical angle; and glass in glass.

Means are within five of their standard errors of what they should be, which chance exceeds once in two
million.
"""

import math
from itertools import pairwise

import numpy as np
import pytest

import raywright as rw

ALPHAS = [0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.6, 1.0]
GLASSES = [1.0, 1 + 1e-7, 1.0001, 1.5, 3.0, 5.0, 10.0]


def seen(material, degrees, draws, below=False):
    """A floor of a material, met by so many rays at each of these angles from its normal."""
    corners = [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)]
    scene = rw.Scene(rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=material), precision="double")
    angles = np.repeat(np.radians(degrees), draws)
    back = np.stack([np.sin(angles), np.zeros_like(angles), np.cos(angles) * (-1 if below else 1)], axis=1)
    return scene.interactions(rw.query.Rays(3 * back + (0.1, 0.2, 0), -back, np.zeros(len(back))))


def scattered_share(material, degrees, index=1.0, below=False, draws=4000):
    """The share of light that is scattered at each angle, and its standard error; `index` is that below."""
    here = seen(material, degrees, draws, below)
    rng = np.random.default_rng(1)
    drawn = here.sample_bsdf(rng.random(len(here)), rng.random((len(here), 2)))
    # Refraction conserves radiance over the square of the index.
    through = np.nan_to_num(drawn.direction[:, 2]) * (-1 if below else 1) < 0
    share = drawn.weight[:, 1] * np.where(through, (1 / index if below else index) ** 2, 1)
    share = share.reshape(len(degrees), draws)
    return share.mean(axis=1), share.std(axis=1) / math.sqrt(draws)


@pytest.mark.parametrize("alpha", ALPHAS)
def test_rough_mirrors_lose_nothing(alpha):
    mirror = rw.Conductor(eta=1, k=1e9, alpha=alpha)
    mean, error = scattered_share(mirror, [0, 45, 75, 89, 89.9])
    assert (abs(mean - 1) <= 0.005 + 5 * error).all(), mean
    assert (error < 0.02).all()


@pytest.mark.parametrize("ior", GLASSES)
def test_rough_interfaces_lose_nothing_from_either_side(ior):
    for alpha in ALPHAS:
        for below in (False, True):
            mean, error = scattered_share(rw.Dielectric(ior, alpha=alpha), [0, 30, 75, 89], ior, below)
            assert (abs(mean - 1) <= 0.005 + 5 * error).all(), (alpha, below, mean)
            assert (error < 0.02).all()


@pytest.mark.parametrize(
    ("ior", "alpha"),
    [(ior, alpha) for ior in GLASSES for alpha in (0.0, 1e-4)]
    + [(ior, alpha) for ior in (1.0001, 1.5) for alpha in (0.01, 0.1, 1.0)],
)
def test_a_glass_ball_in_an_even_light_cannot_be_seen(ior, alpha):
    # Rougher ones of higher indices hold light for hundreds of bounces, and few paths carry most of it out.
    camera = rw.Camera((0, 0, 10), (0, 0, 0), fov=8, width=8, height=8)
    ball = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(ior, alpha=alpha))
    image = rw.render(rw.Scene(ball, environment=1), camera, samples=256, progress=False)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 64
    assert abs(float(image.rgb[..., 1].mean()) - 1) <= 0.005 + 5 * error
    assert error < 0.02
    assert not any("finite" in warning for warning in image.warnings)


@pytest.mark.parametrize(
    ("ior", "alpha", "samples", "distribution"),
    [
        (1.5, 0.05, 256, "ggx"),
        (1.5, 0.05, 256, "beckmann"),
        (1.5, 0.3, 512, "ggx"),
        (1.33, 0.7, 512, "beckmann"),
        (1 / 1.5, 0.3, 256, "ggx"),
        (1 / 1.5, 0.3, 256, "beckmann"),
        pytest.param(1.5, 0.3, 512, "beckmann", marks=pytest.mark.slow),
        pytest.param(1.33, 0.7, 512, "ggx", marks=pytest.mark.slow),
    ],
)
def test_a_ball_of_rough_glass_gains_and_loses_nothing(ior, alpha, samples, distribution):
    """Light goes through two surfaces, and is thrown back within now and then."""
    material = rw.Dielectric(ior, alpha=alpha, distribution=distribution)
    camera = rw.Camera((0, 0, 10), (0, 0, 0), fov=8, width=32, height=32)
    ball = rw.Sphere((0, 0, 0), 1, material=material)
    image = rw.render(rw.Scene(ball, environment=1), camera, samples=samples, progress=False)
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 1024
    assert abs(float(image.rgb[..., 1].mean()) - 1) <= 0.002 + 5 * error
    assert error < 0.001


def fresnel(cosine, ratio):
    """Reflectance for unpolarized light; `ratio` is the index beyond over that before (Born and Wolf)."""
    sine = np.sqrt(np.maximum(1 - cosine**2, 0)) / ratio
    beyond = np.sqrt(np.maximum(1 - sine**2, 0))
    s = (cosine - ratio * beyond) / (cosine + ratio * beyond)
    p = (ratio * cosine - beyond) / (ratio * cosine + beyond)
    return np.where(sine >= 1, 1.0, (s**2 + p**2) / 2)


@pytest.mark.parametrize("ior", [1.0, 1 + 1e-7, 1.0001, 1.5, 10.0])
def test_smooth_glass_reflects_by_fresnel_also_at_the_critical_angle(ior):
    # Exactly there, at adjacent numbers, and well off it. At index 1 there is none.
    critical = math.asin(1 / ior)
    angles = [0.0, 0.9 * critical]
    if ior > 1:
        angles += [np.nextafter(critical, 0), critical, np.nextafter(critical, 2)]
    if ior > 1.01:
        angles += [critical + 0.01, 1.5]
    here = seen(rw.Dielectric(ior), np.degrees(angles), 1, below=True)
    for choice in (0.0, 0.5, 1 - 1e-12):
        drawn = here.sample_bsdf(np.full(len(here), choice), np.full((len(here), 2), 0.5))
        assert np.isfinite(drawn.weight).all()
        assert (drawn.weight[:, 1] > 0).all()
        np.testing.assert_allclose(np.linalg.norm(drawn.direction, axis=1), 1, atol=1e-12)
        through = drawn.direction[:, 2] > 0
        np.testing.assert_allclose(drawn.weight[:, 1], np.where(through, ior**2, 1), rtol=1e-12)
        # 1 - F follows the root of the distance from the critical angle: sixteen digits give eight of it.
        expected = choice >= fresnel(np.cos(angles), 1 / ior)
        known = abs(choice - fresnel(np.cos(angles), 1 / ior)) > 1e-6
        assert (through == expected)[known].all()
        # By Snell's law.
        sine = np.sin(angles) * ior
        found = np.hypot(drawn.direction[:, 0], drawn.direction[:, 1])
        np.testing.assert_allclose(found[through], np.minimum(sine, 1)[through], atol=1e-7)


@pytest.mark.parametrize("alpha", [1e-4, 1e-3, 1.0])
@pytest.mark.parametrize(
    "kind",
    [
        lambda alpha: rw.Conductor("gold", alpha=alpha),
        lambda alpha: rw.Conductor("gold", alpha=(alpha, 0.5)),
        lambda alpha: rw.Dielectric(1.5, alpha=alpha),
        lambda alpha: rw.Dielectric(1.0001, alpha=alpha),
        lambda alpha: rw.Plastic(0.5, alpha=alpha),
        lambda alpha: rw.MetallicRough(0.5, 0.5, math.sqrt(alpha)),
    ],
    ids=["metal", "brushed metal", "glass", "hardly glass", "plastic", "glTF"],
)
def test_draws_are_weighed_by_what_is_evaluated_where_lobes_are_sharp_or_graze(kind, alpha):
    for below in (False, True):
        here = seen(kind(alpha), [0, 45, 85, 89, 89.9, 89.999], 200, below)
        rng = np.random.default_rng(2)
        drawn = here.sample_bsdf(rng.random(len(here)), rng.random((len(here), 2)))
        assert np.isfinite(drawn.weight).all()
        assert (drawn.pdf >= 0).all()
        some = np.isfinite(drawn.pdf) & drawn.any
        assert some.mean() > 0.2
        value, pdf = here.evaluate(np.nan_to_num(drawn.direction))
        # World directions are accurate to 1e-16, which is a larger share of a narrower lobe.
        bound = 1e-7 + 1e-11 * np.sqrt(drawn.pdf[some])
        assert (abs(pdf[some] / drawn.pdf[some] - 1) < bound).all()
        off = abs(value - drawn.weight * drawn.pdf[:, None])[some].max(axis=1)
        assert (off < bound * value[some].max(axis=1)).all()


def transmitted(indices):
    """What gets straight through one interface after another, all reflections counted (Stokes, 1862)."""
    through, back = 1.0, 0.0
    for one, other in pairwise(indices):
        r = ((one - other) / (one + other)) ** 2
        between = 1 - back * r
        through, back = through * (1 - r) / between, r + (1 - r) ** 2 * back / between
    return through


def over_a_lamp(glasses):
    """What is seen, from right above, of a lamp of radiance 1 below these: mean and standard error."""
    lamp = rw.Disk((0, 0, -9), (0, 0, 1), 9, material=rw.Diffuse(0), emission=1)
    camera = rw.Camera((0.0, 0, 9), (0, 0, 0), up=(0, 1, 0), fov=1e-5, width=16, height=16)
    image = rw.render(rw.Scene([*glasses, lamp], precision="double"), camera, samples=64, progress=False)
    assert not image.warnings
    error = math.sqrt(float(np.square(image.standard_error[..., 1].astype(float)).sum())) / 256
    return float(image.rgb[..., 1].mean(dtype=float)), error


def slab(low, high, ior, priority=0):
    box = np.array([(x, y, z) for x in (-5.0, 5.0) for y in (-5.0, 5.0) for z in (low, high)])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
    return rw.Mesh(box, faces, material=rw.Dielectric(ior, priority=priority))


def ball(radius, ior, priority=0):
    return rw.Sphere((0, 0, 0), radius, material=rw.Dielectric(ior, priority=priority))


@pytest.mark.parametrize(
    ("glasses", "indices"),
    [
        ([slab(0, 1, 1.0)], [1, 1, 1]),
        ([slab(0, 1, 1 + 1e-7)], [1, 1 + 1e-7, 1]),
        ([slab(0, 1, 1.0001)], [1, 1.0001, 1]),
        ([slab(0, 1, 10)], [1, 10, 1]),
        ([slab(0, 1, 1.5), slab(1 + 1e-6, 2, 1.5)], [1, 1.5, 1, 1.5, 1]),
        ([slab(0, 1, 1.5), slab(1, 2, 1.5, 1)], [1, 1.5, 1]),
        ([slab(0, 1, 3.0), slab(1 + 1e-6, 2, 2.0, 1)], [1, 2, 1, 3, 1]),
        ([slab(0, 1, 3.0), slab(1, 2, 2.0, 1)], [1, 2, 3, 1]),
        # Rays through the common center hit all balls at right angles.
        ([ball(2, 1.5), ball(2 - 1e-6, 3.0, 1)], [1, 1.5, 3, 1.5, 1]),
        ([ball(2, 1.5), ball(2, 3.0, 1)], [1, 3, 1]),
        ([ball(2, 1.5), ball(2, 1.0, 1)], [1, 1, 1]),
        ([ball(2, 1.5), ball(2 - 1e-6, 1.0, 1)], [1, 1.5, 1, 1.5, 1]),
        ([ball(2, 1.5, 1), ball(1, 3.0)], [1, 1.5, 1]),
    ],
)
def test_glass_in_glass_lets_through_what_stokes_says_whatever_the_gap(glasses, indices):
    expected = transmitted(indices)
    mean, error = over_a_lamp(glasses)
    # At 1.0001 five rays in a thousand million are reflected: none here.
    assert abs(mean - expected) <= 5 * error + 1e-6, f"{mean} ± {error}, not {expected}"
    assert error < 0.01


def test_a_ball_of_glass_that_fills_a_hole_in_glass_is_not_there():
    # The same glass within glass, without a gap: only the outer surface counts.
    same = over_a_lamp([ball(2, 1.5), ball(1, 1.5, 1)])
    assert abs(same[0] - transmitted([1, 1.5, 1])) <= 5 * same[1]
