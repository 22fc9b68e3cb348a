"""Photons: light at the surfaces that it comes to."""

import math
import pickle

import numpy as np
import pytest

import raywright as rw


def room(reflectance=0.5, emission=1.0):
    """A closed box from -1 to 1 that shines inwards."""
    material = rw.Diffuse(reflectance)
    box = rw.Box((-1, -1, -1), (1, 1, 1), material=material, emission=rw.Emission(emission, side="back"))
    return rw.Scene(box)


def caustic():
    floor = rw.Mesh(
        [(-4, 0, -4), (-4, 0, 4), (4, 0, 4), (4, 0, -4)], [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0.5)
    )
    glass = rw.Sphere((0, 1.5, 0), 0.5, material=rw.Dielectric(1.5))
    return rw.Scene([floor, glass, rw.Sphere((0, 4, 0), 0.1, material=rw.Diffuse(0), emission=100)])


def test_light_that_sets_out_arrives_or_escapes():
    scene = caustic()
    found = scene.photons(50_000, max_depth=1)
    power = math.pi * 100 * 4 * math.pi * 0.1**2
    np.testing.assert_allclose(found.emitted, power, rtol=1e-12)
    np.testing.assert_allclose(found.powers.sum(0) + found.escaped, found.emitted, rtol=1e-9)
    assert (found.bounces == 0).all()
    assert (found.chains == "L").all()
    assert set(found.shape_id) == {0, 1}


def test_a_closed_room_gets_the_sum_of_its_series():
    # Emission is 24 pi, and half of the arriving light is reflected: 48 pi arrive. With roulette from the
    # fourth surface on, a sixteenth of it is random: four standard errors are below 0.5 %.
    found = room().photons(100_000)
    np.testing.assert_allclose(found.powers.sum(0), 48 * math.pi, rtol=0.005)
    assert found.escaped == (0, 0, 0)
    # Half of the light with n arrivals arrives once more.
    arrived = [found.powers[found.bounces == n].sum() for n in range(4)]
    np.testing.assert_allclose(np.divide(arrived[1:], arrived[:-1]), 0.5, rtol=1e-6)


def test_irradiance_is_power_over_area():
    # Straight below the middle of a ball the floor gets I / h^2, with I = L pi r^2.
    floor = rw.Mesh(
        [(-9, 0, -9), (-9, 0, 9), (9, 0, 9), (9, 0, -9)], [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0)
    )
    scene = rw.Scene([floor, rw.Sphere((0, 2, 0), 0.1, material=rw.Diffuse(0), emission=100)])
    found = scene.photons(1_000_000, max_depth=1)
    near = np.hypot(found.positions[:, 0], found.positions[:, 2]) < 0.2
    irradiance = found.powers[near, 1].sum() / (math.pi * 0.2**2)
    # Mean over the disk, by 2 h I / (h^2 + x^2)^(3/2): I h (1 / h - 1 / sqrt(h^2 + R^2)) 2 / R^2.
    expected = math.pi * 0.1**2 * 100 * 2 * (1 / 2 - 1 / math.hypot(2, 0.2)) * 2 / 0.2**2
    assert abs(irradiance / expected - 1) < 4 / math.sqrt(near.sum())
    assert near.sum() > 2000


def test_chains_tell_how_light_came():
    found = caustic().photons(100_000, max_depth=4)
    ways = set(found.chains)
    assert {"L", "LS", "LSS", "LD"} <= ways
    through = found[(found.chains == "LSS") & (found.shape_id == 0)]
    # A ball of glass focuses light below itself.
    assert len(through) > 100
    assert np.median(np.hypot(*through.positions[:, [0, 2]].T)) < 0.5
    assert (found.chains[found.bounces == 2] != "L").all()
    lengths = np.char.str_len(found.chains)
    np.testing.assert_array_equal(lengths, found.bounces + 1)


def test_photons_lie_on_surfaces_and_came_from_their_side():
    found = caustic().photons(20_000)
    on_floor = found[found.shape_id == 0]
    assert np.abs(on_floor.positions[:, 1]).max() < 1e-12
    assert ((found.directions * found.normals).sum(1) < 0).all()
    np.testing.assert_allclose(np.linalg.norm(found.directions, axis=1), 1, rtol=1e-12)
    in_order = np.lexsort((found.bounces, found.path))
    np.testing.assert_array_equal(in_order, np.arange(len(found)))


def test_bits_go_by_the_seed_alone():
    scene = caustic()
    one, two = (scene.photons(10_000, threads=threads) for threads in (1, 2))
    assert one == two
    assert one != scene.photons(10_000, seed=1)
    assert pickle.loads(pickle.dumps(one)) == one
    assert not one.powers.flags.writeable
    assert not one.chains.flags.writeable


def test_long_ways_are_told_to_their_64th_bounce():
    found = room(reflectance=0.999).photons(100, roulette_depth=100)
    assert found.bounces.max() > 64
    assert max(map(len, found.chains)) == 65
    assert set("".join(found.chains)) == {"L", "D"}


def test_light_that_glass_holds_for_ever_ends_soon():
    # For a lamp in a cube of glass, all light within the critical angle of a side leaves sooner or later, as
    # its angles to all sides stay the same: six cones, 3 (1 - sqrt(1 - 1 / n^2)) of all. The rest never does,
    # and ends after some 96 bounces, not some 4,096.
    cube = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Dielectric(1.5))
    found = rw.Scene([cube], lights=[rw.PointLight((0.1, 0.2, 0.3), 1)]).photons(20_000)
    out = 3 * (1 - math.sqrt(1 - 1 / 1.5**2))
    assert abs(found.escaped[1] / found.emitted[1] - out) < 4 * math.sqrt(out * (1 - out) / 20_000)
    assert len(found) < 40 * 20_000


def test_what_cannot_be_is_refused_in_one_line():
    scene = caustic()
    for arguments, kind, words in [
        ({"count": 0}, ValueError, "count must be between 1 and"),
        ({"count": 1.5}, TypeError, "count must be"),
        ({"count": 1, "max_depth": 0}, ValueError, "max_depth must be between 1 and"),
        ({"count": 1, "roulette_depth": -1}, ValueError, "roulette_depth must be between 0 and"),
        ({"count": 1, "seed": -1}, ValueError, "seed must be between 0 and"),
        ({"count": 1, "threads": 0}, ValueError, "threads must be"),
    ]:
        with pytest.raises(kind, match=words):
            scene.photons(**arguments)
    endless = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1))], environment=rw.ConstantEnvironment(1))
    with pytest.raises(ValueError, match="shape 0, which is unbounded, and light paths cannot start there"):
        endless.photons(1)
    fire = rw.Sphere((0, 0, 0), 1, material=rw.MediumInterface(rw.Homogeneous(1, emission=1)))
    with pytest.raises(ValueError, match="a medium is emissive, and light paths cannot start there"):
        rw.Scene([fire], lights=[rw.PointLight((0, 0, 2), 1)]).photons(1)


def test_a_dark_scene_has_none():
    dark = rw.Scene(rw.Sphere((0, 0, 0), 1))
    found = dark.photons(10)
    assert len(found) == 0
    assert found.emitted == (0, 0, 0)
    assert found.chains.shape == (0,)
    assert repr(found) == "Photons(0 on 0 paths, 0 W emitted)"
