"""Light that mirrors, balls and lamps throw, by photons and by exact hits, against closed forms."""

import math

import numpy as np
import pytest

import raywright as rw

BLACK = rw.Diffuse(0)


def square(size, height, **kwargs):
    corners = [(-size, -size, height), (size, -size, height), (size, size, height), (-size, size, height)]
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], material=BLACK, **kwargs)


def flux(found, chains, shape, radius):
    """Power that came by some chains to a disk about the axis, in one channel, and its standard error."""
    which = np.isin(found.chains, chains) & (found.shape_id == shape)
    which &= np.hypot(found.positions[:, 0], found.positions[:, 1]) < radius
    powers = found.powers[which, 0]
    return powers.sum(), math.sqrt((powers**2).sum())


def test_a_lamp_over_a_plane():
    # Of the photons of a point light, that share falls on the disk of radius 2, 1.5 below: a binomial count,
    # whose standard error is 0.4 % of it, and the flux with it.
    scene = rw.Scene([square(3.0, 0.0)], lights=[rw.PointLight((0, 0, 1.5), 1)])
    found = scene.photons(250_000, max_depth=1)
    inside = np.hypot(found.positions[:, 0], found.positions[:, 1]) < 2
    assert abs(inside.sum() / 250_000 - 0.2) < 4 * math.sqrt(0.2 * 0.8 / 250_000)
    power, error = flux(found, ["L"], 0, 2.0)
    assert abs(power - 2.51327412287183) < 4 * error
    ring = np.abs(np.hypot(found.positions[:, 0], found.positions[:, 1]) - 2) < 0.1
    irradiance = found.powers[ring, 0].sum() / (math.pi * (2.1**2 - 1.9**2))
    # Over so narrow a ring it is on average what it is in the middle, to 0.2 %.
    assert abs(irradiance / 0.096 - 1) < 0.002 + 4 / math.sqrt(ring.sum())


@pytest.mark.slow
def test_a_paraboloid_makes_a_beam():
    mirror = rw.Paraboloid((0, 0, 0), (0, 0, 0.5), radius=1, material=rw.Mirror(1.0))
    scene = rw.Scene([mirror, square(1.2, 2.0)], lights=[rw.PointLight((0, 0, 0.5), 1)])
    found = scene.photons(700_000, max_depth=2)
    power, error = flux(found, ["LS"], 1, 0.8)
    assert error < 0.002 * power
    assert abs(power - 4.9039495080426) < 3 * error
    # On a ring about 0.8, 2 in 1000 wide of which is known by the difference of two such fluxes.
    wide, narrow = (flux(found, ["LS"], 1, radius)[0] for radius in (0.85, 0.75))
    within = [4 * math.pi * r * r / (1 + r * r) for r in (0.85, 0.75)]
    assert abs((wide - narrow) / (within[0] - within[1]) - 1) < 0.01
    assert abs((wide - narrow) / (math.pi * (0.85**2 - 0.75**2)) / 1.48720999405116 - 1) < 0.015


@pytest.mark.slow
@pytest.mark.parametrize(
    ("n", "z", "radius", "once", "often"),
    [
        (1.5, 1.5, 0.1, 1.17218298616915, 1.17242583888073),
        (2.42, 1.0, 0.2, 0.997587271113372, 0.998886599595504),
    ],
)
def test_sunlight_through_a_clear_ball(n, z, radius, once, often):
    # A plane at 1 touches the ball of 2.42: it is put next to nothing behind it.
    plane = square(radius, max(z, 1 + 1e-9))
    ball = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(n))
    scene = rw.Scene([plane, ball], lights=[rw.DirectionalLight((0, 0, 1), 1)])
    found = scene.photons(1_500_000, max_depth=12)
    for chains, expected in ((["LSS"], once), (["L" + "S" * k for k in range(2, 10)], often)):
        power, error = flux(found, chains, 0, radius)
        assert error < 0.003 * power
        assert abs(power - expected) < 3 * error


@pytest.mark.slow
def test_a_cup_of_light():
    # Half a cylinder of mirror stands on a floor, in facets so narrow that each throws less than 1/1000
    # aside. In units of the floor's direct light, what is thrown on it at a distance on the axis is the sum
    # over the ways there.
    steps, slope = 4000, math.radians(30)
    height = 1.02 * math.tan(slope)
    g = np.linspace(-math.pi / 2, math.pi / 2, steps + 1)
    points = [(math.cos(a), math.sin(a), h) for h in (0.0, height) for a in g]
    faces = []
    for i in range(steps):
        j = i + steps + 1
        faces += [(i, i + 1, j + 1), (i, j + 1, j)]
    cup = rw.Mesh(points, faces, material=rw.Mirror(1.0))
    floor = rw.Mesh(
        [(-0.1, -0.1, 0), (1, -0.1, 0), (1, 0.1, 0), (-0.1, 0.1, 0)], [(0, 1, 2), (0, 2, 3)], material=BLACK
    )
    sun = rw.DirectionalLight((math.cos(slope), 0, -math.sin(slope)), 1)
    found = rw.Scene([floor, cup], lights=[sun]).photons(1_500_000, max_depth=2)
    which = (found.chains == "LS") & (found.shape_id == 0)
    x, y = found.positions[which, 0], found.positions[which, 1]
    # The wall is as high as to light the axis to -0.02.
    half = 0.018
    for at, expected in [(0.0, 1.0), (0.4, 5.0), (0.75, 3.6), (0.85, 2.48677248677249)]:
        inside = (abs(x - at) < half) & (abs(y) < half)
        light = found.powers[which, 0][inside].sum() / (2 * half) ** 2 / math.sin(slope)
        # What the light of a square of this size is more than in its middle is 2 % at most, at 0.4.
        assert abs(light / expected - 1) < 0.02 + 4 / math.sqrt(inside.sum())


def test_a_ball_has_its_focus():
    # By exact hits and Snell's law: where rays of some impact cross the axis, and how far the last are
    # turned.
    ball, n = rw.Scene(rw.Sphere((0, 0, 0), 1)), 1.5

    def refracted(direction, normal, ratio):
        cosine = -(direction * normal).sum(-1, keepdims=True)
        sine = ratio**2 * (1 - cosine**2)
        return ratio * direction + (ratio * cosine - np.sqrt(1 - sine)) * normal

    b = np.array([1e-4, 0.5, 1 - 1e-12])
    origins = np.stack([b, 0 * b, 0 * b - 3], -1)
    directions = np.broadcast_to([0.0, 0.0, 1.0], origins.shape)
    first = ball.intersect(origins, directions)
    inside = refracted(directions, first.position, 1 / n)
    far = ball.intersect(first.position + inside, -inside)
    assert far.hit.all()
    back = first.position - 2 * (first.position * inside).sum(-1, keepdims=True) * inside
    out = refracted(inside, -back, n)
    z = back[:, 2] - back[:, 0] / out[:, 0] * out[:, 2]
    np.testing.assert_allclose(z[0], 1.5, rtol=1e-7)
    np.testing.assert_allclose(z[0] - 1, 0.5, rtol=1e-7)
    np.testing.assert_allclose(z[1], 1.39157294888931, rtol=1e-12)
    turned = math.degrees(math.acos(out[2, 2]))
    # Near the rim it goes by the root of what is left to it.
    assert abs(turned - 96.3793702084428) < 3e-4


def test_a_mirror_circle_has_its_cardioid():
    # Rays close to one from (-1, 0), after the wall: they cross where the pencil is focused.
    wall = rw.Scene(rw.Cylinder((0, 0, -1), (0, 0, 1), 1, capped=False))
    for degrees, focus in [
        (0, (1 / 3, 0)),
        (60, (0.5, 0.288675134594813)),
        (120, (-0.166666666666667, 0.866025403784439)),
    ]:
        t = math.radians(degrees) + np.array([-1e-5, 1e-5])
        target = np.stack([np.cos(t), np.sin(t), 0 * t], -1)
        start = np.array([-1.0, 0.0, 0.0]) + 0.5 * (target - [-1, 0, 0])
        directions = target - start
        directions /= np.linalg.norm(directions, axis=-1, keepdims=True)
        hits = wall.intersect(start, directions)
        normal = hits.normal
        turned = directions - 2 * (directions * normal).sum(-1, keepdims=True) * normal
        (p, q), (d, e) = hits.position[:, :2], turned[:, :2]
        along = np.linalg.solve(np.stack([d, -e], -1), q - p)
        np.testing.assert_allclose(p + along[0] * d, focus, atol=1e-8)
