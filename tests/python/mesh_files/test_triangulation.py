"""Polygons as triangles: they keep their area, cover it once, and convex ones stay fans."""

import numpy as np
import pytest

from raywright.mesh_files.triangulation import polygon_of, triangulate


def area_of(points, triangles):
    a, b, c = np.moveaxis(np.asarray(points, float)[triangles], 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def newell(ring):
    ring = np.asarray(ring, float) - ring[0]
    return np.linalg.norm(np.cross(ring, np.roll(ring, -1, axis=0)).sum(axis=0)) / 2


def alone(ring):
    return triangulate(np.asarray(ring, float), np.arange(len(ring)), np.array([len(ring)]))


def turned(ring, seed):
    """Points of a plane, put into space as a rotation and a shift take them."""
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.column_stack([ring, np.zeros(len(ring))]) @ axes + rng.normal(size=3) * 3


ARROW = [(0, 0, 0), (4, 1, 0), (0, 2, 0), (1.5, 1, 0)]


@pytest.mark.parametrize("first", range(4))
@pytest.mark.parametrize("way", [1, -1])
def test_a_concave_quad_keeps_its_area_from_whichever_corner_it_begins(first, way):
    ring = np.roll(np.array(ARROW[::way], float), first, axis=0)
    triangles = alone(ring)
    assert area_of(ring, triangles) == pytest.approx(2.5, rel=1e-15)
    normals = np.cross(*(ring[triangles[:, k]] - ring[triangles[:, 0]] for k in (1, 2)))
    assert (normals[:, 2] * way > 0).all()


@pytest.mark.parametrize("seed", range(40))
def test_stars_and_spirals_in_any_plane_keep_their_area(seed):
    rng = np.random.default_rng(seed)
    count = int(rng.integers(4, 200))
    angles = np.sort(rng.uniform(0, 2 * np.pi, count)) if count > 30 else np.arange(count) * 2 * np.pi / count
    star = np.stack([np.cos(angles), np.sin(angles)], 1) * rng.uniform(0.1, 1, (count, 1))
    turns = np.linspace(0, 6 * np.pi, count)
    out = np.stack([np.cos(turns), np.sin(turns)], 1) * (1 + turns[:, None])
    spiral = np.concatenate([out, out[::-1] * (1 + 0.5 / (1 + turns[::-1, None]))])
    for flat in (star, star[::-1], spiral):
        ring = turned(flat, seed)
        triangles = alone(ring)
        assert len(triangles) == len(ring) - 2
        if newell(ring) > 0.01:
            assert area_of(ring, triangles) == pytest.approx(newell(ring), rel=1e-12)


def test_a_hole_on_a_bridge_stays_open():
    outline = [(0, 0, 0), (4, 0, 0), (4, 4, 0), (0, 4, 0), (0, 0, 0)]
    hole = [(1, 1, 0), (1, 3, 0), (3, 3, 0), (3, 1, 0), (1, 1, 0)]
    ring = np.array(outline + hole, float)
    triangles = alone(ring)
    assert area_of(ring, triangles) == 12
    centers = ring[triangles].mean(axis=1)
    area = np.linalg.norm(np.cross(*(ring[triangles[:, k]] - ring[triangles[:, 0]] for k in (1, 2))), axis=1)
    assert (np.abs(centers[area > 0, :2] - 2).max(axis=1) > 1).all()


def test_polygons_of_all_sizes_come_in_their_order_and_convex_ones_as_fans():
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    points = np.array([*square, *ARROW], float)
    corners = np.array([0, 1, 2, 0, 1, 4, 5, 6, 7, 0, 1, 2, 3, 3, 0, 2])
    counts = np.array([3, 2, 4, 4, 3, 0])
    triangles = triangulate(points, corners, counts)
    assert polygon_of(counts).tolist() == [0, 2, 2, 3, 3, 4]
    assert corners[triangles][[0, 3, 4, 5]].tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], [3, 0, 2]]
    arrow = corners[triangles][1:3]
    assert area_of(points, arrow) == 2.5
    assert {7, 5} <= set(arrow[0]) & set(arrow[1])


def test_corners_on_a_straight_edge_get_triangles_with_an_area():
    ring = np.array([(0, 0, 0), (1, 0, 0), (2, 0, 0), (2, 2, 0), (1, 2, 0), (0, 2, 0)], float)
    triangles = alone(ring)
    normals = np.cross(*(ring[triangles[:, k]] - ring[triangles[:, 0]] for k in (1, 2)))
    assert (normals[:, 2] > 0).all()
    assert normals[:, 2].sum() == 8


def test_many_concave_polygons_are_done_at_once():
    count = 20_000
    points = (np.array(ARROW)[None] + np.arange(count)[:, None, None] * (0, 0, 1.0)).reshape(-1, 3)
    triangles = triangulate(points, np.arange(4 * count), np.full(count, 4))
    assert area_of(points, triangles) == pytest.approx(2.5 * count, rel=1e-12)


def test_what_has_no_area_or_is_not_finite_still_has_its_triangles():
    points = np.array([(0, 0, 0), (1, 1, 1), (2, 2, 2), (3, 3, 3), (np.nan, 0, 0), (np.inf, 1, 0)])
    corners = np.array([0, 1, 2, 3, 0, 4, 1, 2, 0, 1, 5, 2, 0, 0, 0, 0])
    triangles = triangulate(points, corners, np.array([4, 4, 4, 4]))
    assert polygon_of(np.array([4, 4, 4, 4])).tolist() == [0, 0, 1, 1, 2, 2, 3, 3]
    assert len(triangles) == 8
    assert len(triangulate(points, np.array([], int), np.array([], int))) == 0
    assert len(triangulate(points, np.array([0, 1]), np.array([2]))) == 0


def test_quads_become_the_fans_that_their_corners_allow():
    """From the first corner where both triangles turn as the quad does, and from the second elsewhere."""
    rng = np.random.default_rng(8)
    points = rng.normal(size=(400, 3)) * (1, 1, 0)
    corners = rng.integers(0, 400, 4000)
    counts = np.full(1000, 4)
    quads = points[corners.reshape(-1, 4)]
    sides = quads[:, 1:] - quads[:, :1]
    turns = np.cross(sides[:, :2], sides[:, 1:])[..., 2]
    is_fan = (turns > 0).all(axis=1) | (turns < 0).all(axis=1)
    assert 200 < is_fan.sum() < 800
    found = triangulate(points, corners, counts).reshape(1000, 2, 3) - 4 * np.arange(1000)[:, None, None]
    assert (found[is_fan] == [(0, 1, 2), (0, 2, 3)]).all()
    # A quad without a fan is cut along the other diagonal, unless it crosses itself or repeats a corner.
    is_simple = ~is_fan & np.array([_is_simple(quad[:, :2]) for quad in quads])
    assert is_simple.sum() > 50
    assert all(
        {tuple(sorted(t)) for t in pair.tolist()} == {(0, 1, 3), (1, 2, 3)} for pair in found[is_simple]
    )


def _is_simple(quad):
    """Whether no two sides of a quad that are no neighbors meet, and no corner is there twice."""

    def side(a, b, p):
        return np.sign((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]))

    def meet(a, b, c, d):
        return side(a, b, c) != side(a, b, d) and side(c, d, a) != side(c, d, b)

    a, b, c, d = quad
    return len({tuple(p) for p in quad}) == 4 and not meet(a, b, c, d) and not meet(b, c, d, a)
