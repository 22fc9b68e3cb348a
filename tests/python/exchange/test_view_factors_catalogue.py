"""View factors of curved surfaces, elements and tubes against Howell's catalog and Hottel's strings.

What is sampled is within three standard errors, each of at most 0.2 %. Seeds are fixed, so that a test that
passes goes on passing; of another stream, 1 of 100 would be farther off, as few batches tell errors.
"""

import math
from typing import Any

import numpy as np
import pytest
from radiosity_scenes import swept, zone
from test_view_factors import factors, rectangle, within

import raywright as rw

UP, DOWN = (0.0, 0.0, 1.0), (0.0, 0.0, -1.0)


def disks(one: float, other: float, height: float) -> list[Any]:
    """Coaxial disks that face each other."""
    return [rw.Disk((0, 0, 0), UP, one), rw.Disk((0, 0, height), DOWN, other)]


@pytest.mark.parametrize(
    ("one", "other", "height", "truth", "rays"),
    [
        (1, 1, 1, 0.3819660112501051, 32),
        (1, 2, 1, 0.7639320225002102, 16),
        (2, 1, 1, 0.19098300562505255, 32),
        (0.3, 0.7, 0.4, 0.726323064060485, 16),
        (1, 1, 0.001, 0.999000499875, 1),
    ],
)
def test_coaxial_disks(one: float, other: float, height: float, truth: float, rays: int) -> None:
    within(factors(*disks(one, other, height), rays=rays), 0, 1, truth)


def polygon(height: float, up: bool, corners: int) -> rw.Mesh:
    """A regular polygon of the area of the unit disk, in triangles about its middle."""
    angle = 2 * math.pi * np.arange(corners) / corners
    radius = math.sqrt(math.pi / (0.5 * corners * math.sin(2 * math.pi / corners)))
    ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0 * angle + height], -1)
    i = np.arange(corners)
    faces = np.stack([0 * i, 1 + i, 1 + (i + 1) % corners], -1)
    return rw.Mesh(np.concatenate([[(0, 0, height)], ring]), faces if up else faces[:, [0, 2, 1]])


def test_disks_far_apart() -> None:
    # Rays would hit once in a million. The polygon has the disk's area; its outline matters only to 1e-6.
    found = factors(polygon(0.0, True, 48), polygon(1000.0, False, 48))
    assert found.matrix[0, 1] == pytest.approx(9.99998000005e-07, rel=1e-8)
    far = factors(rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0)), rectangle((0, 0, 1000), (0, 1, 0), (1, 0, 0)))
    assert far.matrix[0, 1] == pytest.approx(3.1830967397738e-07, rel=1e-8)


@pytest.mark.slow
def test_two_spheres() -> None:
    found = factors(rw.Sphere((0, 0, 0), 1.0), rw.Sphere((3, 0, 0), 1.0), rays=1024)
    within(found, 0, 1, 0.0295903122505504)


@pytest.mark.slow
def test_a_sphere_over_the_corner_of_a_rectangle() -> None:
    found = factors(rw.Sphere((0, 0, 1.5), 1.0), rectangle((0, 0, 0), (1, 0, 0), (0, 2, 0)), rays=2048)
    within(found, 0, 1, 0.0365889461394651)


def element(normal: Any) -> rw.Disk:
    """So small that its size counts 1e-8 of what it sees."""
    return rw.Disk((0, 0, 0), normal, 1e-4)


@pytest.mark.parametrize(
    ("distance", "degrees", "truth", "rays"),
    [
        (1.5, 30, 0.384900179459751, 16),
        (1.5, 80, 0.117488949858507, 128),
    ],
)
def test_an_element_sees_a_sphere(distance: float, degrees: float, truth: float, rays: int) -> None:
    tilt = math.radians(degrees)
    found = factors(element((math.sin(tilt), 0, math.cos(tilt))), rw.Sphere((0, 0, distance), 1.0), rays=rays)
    within(found, 0, 1, truth)


def above_or_cut(h: float, degrees: float) -> float:
    """An element and a unit sphere that the element's plane cuts (Hamilton and Morgan 1952; Naraghi 1988)."""
    t, q = math.radians(degrees), math.sqrt(h * h - 1)
    cut = math.sqrt(1 - (h * math.cos(t)) ** 2)
    first = 0.5 - math.asin(q / (h * math.sin(t))) / math.pi
    return first + (math.cos(t) * math.acos(-q / math.tan(t)) - q * cut) / (math.pi * h * h)


def test_the_horizon_of_an_element_is_as_the_catalog_has_it() -> None:
    assert above_or_cut(1.5, 80) == pytest.approx(0.117488949858507, rel=1e-11)
    assert above_or_cut(1.0001, 60) == pytest.approx(0.742153797432516, rel=1e-11)


def test_an_element_next_to_a_sphere() -> None:
    # A ten-thousandth of the radius above it: the element has a size of a millionth.
    tilt = math.radians(60)
    small = rw.Disk((0, 0, 0), (math.sin(tilt), 0, math.cos(tilt)), 1e-6)
    within(factors(small, rw.Sphere((0, 0, 1.0001), 1.0), rays=16), 0, 1, 0.742153797432516)


def test_an_element_sees_a_disk_off_its_axis() -> None:
    found = factors(element(UP), rw.Disk((1.5, 0, 0.7), DOWN, 1.0), rays=128)
    within(found, 0, 1, 0.110440818665135)


def small_square(normal: Any) -> rw.Mesh:
    """Around the origin, in closed form: its size counts its square."""
    side = 1e-6
    first = np.array((1.0, 0, 0)) if normal == UP else np.array((0, 1.0, 0))
    second = np.cross(normal, first)
    return rectangle(-0.5 * side * (first + second), side * first, side * second)


def test_an_element_over_a_corner_of_a_rectangle() -> None:
    found = factors(small_square(UP), rectangle((0, 0, 0.5), (0, 3, 0), (2, 0, 0)))
    assert found.matrix[0, 1] == pytest.approx(0.240894009175505, rel=1e-9)
    assert found.rays == 0


def test_an_element_beside_an_upright_rectangle() -> None:
    found = factors(small_square(UP), rectangle((1, 0, 0), (0, 0, 3), (0, 2, 0)))
    # Half of the element is nearer than the other half, and the rectangle starts in its plane.
    assert found.matrix[0, 1] == pytest.approx(0.14782540236298, rel=1e-9)


def test_long_tubes_side_by_side() -> None:
    # Hottel's strings hold for infinite tubes: at ten thousand radii, the ends lose 1e-4.
    long = 1e4
    tubes = [rw.Cylinder((x, 0, 0), (x, 0, long), 1.0) for x in (0.0, 2.5)]
    found = factors(*tubes, rays=128)
    truth = 0.136012292208971
    value, error = found.matrix[0, 1], found.standard_error[0, 1]
    assert error <= 2e-3 * truth
    assert abs(value - truth) <= 3 * error + 2e-4 * truth


def test_caps_of_a_sphere() -> None:
    # Emission is uniform over the inside of a sphere. Polygons in rings are off by the squares of their
    # sizes.
    found = []
    for cuts in (1, 2):
        caps = [
            swept(zone(math.cos(math.radians(30)), 1, cuts), 8 * cuts, 0.5),
            swept(zone(-1, -0.5, 2 * cuts), 8 * cuts, 0.5),
        ]
        found.append(float(factors(*caps).matrix[0, 1]))
    assert abs(found[1] - 0.25) < 0.3 * abs(found[0] - 0.25)
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(0.25, rel=1e-3)


def test_errors_are_told_rightly_and_below_the_binomial_law() -> None:
    # For N independent rays, the error is sqrt(F (1 - F) / N); nets of rays are better.
    assert math.sqrt(0.199824895698387 * (1 - 0.199824895698387) / 1e6) == pytest.approx(
        0.000399868611868343, rel=1e-9
    )
    truth, off, told = 0.3819660112501051, [], []
    for seed in range(100):
        found = factors(*disks(1, 1, 1), rays=1, seed=seed)
        off.append(found.matrix[0, 1] - truth)
        told.append(found.standard_error[0, 1])
    # Both disks emit 4096 rays, and the result is their mean.
    assert np.mean(told) < math.sqrt(truth * (1 - truth) / 8192)
    # The spread of 100 is known to 1 in 14: three times this, plus the uncertainty of 64 batches.
    assert 0.75 < np.sqrt(np.mean(np.square(off)) / np.mean(np.square(told))) < 1.25
    assert abs(np.mean(off)) < 3 * np.sqrt(np.mean(np.square(told)) / 100)
