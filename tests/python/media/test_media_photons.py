"""Photons among media: where they are scattered and absorbed, and that none of their power is lost."""

import math
import pickle

import numpy as np
import pytest

import raywright as rw

BLACK = rw.Diffuse(0.0)
# Light paths carry their power in float32: each factor rounds by up to 2^-24.
ROUNDING = 1e-7
LAMP = rw.PointLight((0, 0, 0), 1.0)
NEVER = 2**31


def ball(material, radius=1.0, center=(0, 0, 0)):
    return rw.Sphere(center, radius, material=material)


def square(height, size=3.0, material=BLACK):
    corners = [(-size, -size, height), (size, -size, height), (size, size, height), (-size, size, height)]
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=material)


def total(found, *more):
    """Sum of the escaped, absorbed and other power."""
    return np.sum([found.escaped, found.absorbed, *more], axis=0)


def test_what_only_absorbs_takes_its_share():
    # Beer and Lambert, path by path.
    dark = ball(rw.MediumInterface(rw.Homogeneous((0.5, 1.0, 2.0))))
    found = rw.Scene([dark], lights=[LAMP]).photons(500)
    np.testing.assert_allclose(found.emitted, 4 * math.pi, rtol=1e-12)
    np.testing.assert_allclose(found.escaped, 4 * math.pi * np.exp([-0.5, -1.0, -2.0]), rtol=ROUNDING)
    np.testing.assert_allclose(total(found), found.emitted, rtol=ROUNDING)
    assert len(found) == 0


def test_no_power_is_lost():
    # Smoke over a black floor, a ball of milk, and a grid: escaped, absorbed and deposited power add up to
    # the emission.
    smoke = ball(rw.MediumInterface(rw.Homogeneous(0.7, 1.6, rw.HenyeyGreenstein(0.6))))
    milk = rw.Dielectric(1.33, interior=rw.Homogeneous(1.0, 4.0))
    cloud = rw.GridMedium(
        np.linspace(0, 3, 64).reshape(4, 4, 4), [(-2, 1, -1), (0, 3, 1)], absorption=0.3, scattering=0.9
    )
    box = rw.Box((-2, 1, -1), (0, 3, 1), material=rw.MediumInterface(cloud))
    scene = rw.Scene([square(-2.0), smoke, ball(milk, 0.5, (1.8, 0, 0)), box], lights=[LAMP])
    found = scene.photons(5000, max_depth=1000, roulette_depth=NEVER)
    on_floor = found.powers[found.shape_id == 0].sum(0)
    np.testing.assert_allclose(total(found, on_floor), found.emitted, rtol=1e-6)
    assert found.absorbed[0] > 0.1 * found.emitted[0]
    # By its first event alone: scattered photons have not continued.
    first = scene.photons(5000, max_depth=1, roulette_depth=NEVER)
    within = first.shape_id == -1
    assert within.any()
    np.testing.assert_array_equal(first.primitive_id[within], -1)
    assert not first.normals[within].any()
    assert (first.bounces == 0).all()
    # The scattering albedo in these is 1.6 of 2.3, except in the cloud, 0.9 of 1.2.
    in_cloud = within & (first.positions[:, 1] > 1)
    albedo = np.where(in_cloud, 0.75, 1.6 / 2.3)[:, None]
    rest = (first.powers * np.where(within[:, None], albedo, 1)).sum(0)
    np.testing.assert_allclose(total(first, rest), first.emitted, rtol=ROUNDING)


def test_colors_are_absorbed_on_average_as_they_should_be():
    # In infinite fog every photon is absorbed: with probability 1 - w per collision, so that it has 1 / (1 -
    # w) of them.
    absorption, scattering = np.array([0.5, 1.0, 2.0]), np.array([0.5, 2.0, 1.0])
    fog = rw.Homogeneous(tuple(absorption), tuple(scattering))
    scene = rw.Scene([], lights=[rw.PointLight((0, 0, 0), 1 / (4 * math.pi))], medium=fog)
    runs = [scene.photons(20_000, seed=seed) for seed in range(8)]
    met = np.array([found.powers.sum(0) for found in runs])
    error = met.std(0, ddof=1) / math.sqrt(8)
    expected = 1 + scattering / absorption
    assert (error < 0.01 * expected).all(), error / expected
    # Over eight, five standard errors are exceeded once in 600 times.
    assert (abs(met.mean(0) - expected) < 5 * error).all(), (met.mean(0), error)
    taken = np.array([found.absorbed for found in runs])
    assert (abs(taken.mean(0) - 1) < 5 * taken.std(0, ddof=1) / math.sqrt(8) + 1e-9).all()
    assert runs[0].escaped == (0, 0, 0)


def test_free_ways_are_as_long_as_they_should_be():
    fog = rw.Homogeneous(0.2, 1.8)
    found = rw.Scene([], lights=[LAMP], medium=fog).photons(20_000, max_depth=1)
    ways = np.linalg.norm(found.positions, axis=1)
    assert len(ways) == 20_000
    # Their mean and standard deviation are both 1 / 2.
    assert abs(ways.mean() - 0.5) < 4 * 0.5 / math.sqrt(20_000)
    np.testing.assert_allclose(found.positions / ways[:, None], found.directions, atol=1e-9)


def test_a_ball_takes_its_share_of_even_light():
    # Optical radius 1, albedo 0.5: solved as an integral equation. The light on it is pi times its area.
    gas = ball(rw.MediumInterface(rw.Homogeneous(0.5, 0.5)))
    scene = rw.Scene([gas], environment=rw.ConstantEnvironment(1.0))
    shares = np.array([scene.photons(40_000, seed=seed).absorbed[1] for seed in range(10)]) / (4 * math.pi**2)
    mean, error = shares.mean(), shares.std(ddof=1) / math.sqrt(10)
    assert error < 0.005 * mean
    # Over ten, four and a half standard errors are exceeded once in 600 times.
    assert abs(mean - 0.457742891) < 4.5 * error


def test_chains_tell_what_scattered():
    haze = rw.Box((-3, -3, -1), (3, 3, 3), material=rw.MediumInterface(rw.Homogeneous(0.02, 0.2)))
    glass = ball(rw.Dielectric(1.5), 0.5, (0, 0, 1.0))
    scene = rw.Scene([square(0.0, 2.5, rw.Diffuse(0.5)), haze, glass], lights=[rw.PointLight((0, 0, 2.5), 1)])
    found = scene.photons(20_000, max_depth=5)
    ways = set(found.chains)
    assert {"L", "LV", "LSS", "LSSV", "LD", "LDV", "LVV", "LVD"} <= ways
    assert set("".join(ways)) == {"L", "S", "V", "D"}
    np.testing.assert_array_equal(np.char.str_len(found.chains), found.bounces + 1)
    assert not (found.specular & found.in_medium).any()
    caustic = found[(found.chains == "LSS") & (found.shape_id == -1)]
    # The caustic of the ball lies below it.
    below = np.hypot(caustic.positions[:, 0], caustic.positions[:, 1]) < 0.5
    assert below.mean() > 0.6
    assert pickle.loads(pickle.dumps(found)) == found
    assert found == scene.photons(20_000, max_depth=5, threads=1)


def test_light_from_outside_does_not_come_through_endless_fog():
    floor = square(0.0)
    sun = rw.DirectionalLight((0, 0, -1), 1.0)
    scene = rw.Scene([floor], lights=[sun], medium=rw.Homogeneous((0.1, 0.0, 0.1)))
    found = scene.photons(1000)
    assert found.powers[:, [0, 2]].max() == 0
    np.testing.assert_allclose(found.powers[:, 1].sum() + found.escaped[1], found.emitted[1], rtol=1e-9)


@pytest.mark.parametrize(
    "way",
    [rw.LightTraced(), rw.PhotonMap(100), rw.ProgressivePhotonMap(100)],
    ids=lambda way: type(way).__name__,
)
def test_what_glows_is_refused_in_one_line(way):
    fire = ball(rw.MediumInterface(rw.Homogeneous(1, emission=1)))
    look = rw.Camera((0, 0, 4), (0, 0, 0), width=4, height=4)
    for scene in (rw.Scene([fire], lights=[LAMP]), rw.Scene([rw.Instance([fire], np.eye(4))], lights=[LAMP])):
        with pytest.raises(ValueError, match=r"a medium is emissive.*use Path"):
            rw.render(scene, look, way, 4, progress=False)
