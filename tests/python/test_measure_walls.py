"""Thickness, sight and cross sections, against closed forms."""

import numpy as np
import pytest
import trimesh

import raywright as rw

measure = rw.measure


def test_a_shell_is_as_thick_as_its_radii_differ():
    shell = rw.Scene([rw.Sphere((1, 2, 3), 1.0), rw.Sphere((1, 2, 3), 0.8)])
    ways = np.random.default_rng(1).normal(size=(200, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    hits = shell.intersect((1, 2, 3) + 5 * ways, -ways)
    assert np.allclose(measure.thickness(shell, hits), 0.2, rtol=0, atol=1e-13)
    plain = measure.thickness(shell, np.array([1, 2, 3]) + ways, ways)
    assert np.allclose(plain, 0.2, rtol=0, atol=1e-12)


def test_a_shell_of_faces_is_as_thick_as_its_faces_are_apart():
    """Between two like polyhedra every pair of faces is the difference of the distances from the centre
    apart.
    """
    outer = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
    inner = outer.copy()
    inner.apply_scale(0.75)
    inner.invert()
    scene = rw.Scene([outer, inner], precision="double")
    middles, normals = outer.triangles_center, outer.face_normals
    apart = 0.25 * (middles * normals).sum(axis=1)
    found = measure.thickness(scene)
    assert found.shape == (2 * len(outer.faces),)
    # A ray that leaves the middle of a face along its normal need not go through the middle of the one below.
    assert np.allclose(found[: len(apart)], apart, rtol=0.02)
    assert np.allclose(measure.thickness(scene, middles, normals), found[: len(apart)], rtol=1e-9)
    balls = measure.thickness(scene, method="sphere")[: len(apart)]
    assert (balls <= found[: len(apart)] * (1 + 1e-8)).all()
    assert (balls > 0.8 * apart).all()


def test_a_plate_is_as_thick_by_ball_as_by_ray():
    plate = trimesh.creation.box((4.0, 4.0, 0.2))
    points = [(0, 0, 0.1), (0.5, 1.0, -0.1), (1.7, 0.0, 0.1)]
    normals = [(0, 0, 1), (0, 0, -2.0), (0, 0, 1)]
    for method in ("ray", "sphere"):
        found = measure.thickness(plate, points, normals, method=method)
        assert np.allclose(found, 0.2, rtol=0, atol=2e-7)  # the box is rounded to float32
    across = measure.thickness(plate, (2.0, 0, 0), (1, 0, 0))
    assert across == pytest.approx(4.0, abs=1e-6)
    assert measure.thickness(plate, (2.0, 0, 0), (1, 0, 0), method="sphere") == pytest.approx(0.2, abs=1e-6)


def test_the_ball_in_a_wedge():
    """At a distance d from the edge of a wedge of angle a, the ball that touches both sides has radius d
    tan(a / 2).
    """
    angle = np.radians(50.0)
    far = 100.0
    tip = np.array([np.cos(angle), np.sin(angle)]) * far
    vertices = [(0, 0, -far), (far, 0, -far), (*tip, -far), (0, 0, far), (far, 0, far), (*tip, far)]
    faces = [(0, 1, 4), (0, 4, 3), (0, 5, 2), (0, 3, 5), (1, 2, 5), (1, 5, 4), (0, 2, 1), (3, 4, 5)]
    scene = rw.Scene(rw.Mesh(vertices, faces), precision="double")
    d = np.array([1.0, 3.0, 10.0])
    points = np.stack([d, np.zeros(3), np.zeros(3)], axis=-1)
    balls = measure.thickness(scene, points, (0, -1, 0), method="sphere")
    assert np.allclose(balls, 2 * d * np.tan(angle / 2), rtol=1e-6)
    rays = measure.thickness(scene, points, (0, -1, 0))
    assert np.allclose(rays, d * np.tan(angle), rtol=1e-9)


def test_no_other_side_and_no_point():
    sheet = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert np.array_equal(measure.thickness(sheet), [np.inf])
    assert np.array_equal(measure.thickness(sheet, method="sphere"), [np.inf])
    scene = rw.Scene(sheet)
    assert np.isnan(measure.thickness(scene, scene.intersect((5.0, 5, 5), (0, 0, 1)))).all()
    with pytest.raises(ValueError, match="points must be given: shape 1 is no mesh but a Sphere"):
        measure.thickness([sheet, rw.Sphere()])
    with pytest.raises(ValueError, match="method must be one of 'ray', 'sphere', got 'cone'"):
        measure.thickness(sheet, method="cone")


def test_points_see_each_other_or_what_is_between():
    ball = rw.Sphere((0, 0, 0), 1.0, name="ball")
    a = np.array([(0, 0, -3.0), (0, 2, -3.0), (0, 0, 0)])
    found = measure.line_of_sight(rw.Scene(ball), a[:, None], [(0, 0, 3.0), (5.0, 0, -3)])
    # The segment passes the ball if its nearest point to the centre does.
    b = np.array([(0, 0, 3.0), (5.0, 0, -3)])
    way = b - a[:, None]
    share = np.clip(-(a[:, None] * way).sum(-1) / (way**2).sum(-1), 0, 1)
    nearest = np.linalg.norm(a[:, None] + share[..., None] * way, axis=-1)
    assert np.array_equal(found.visible, nearest > 1)
    assert np.allclose(found.obstruction.t[0, 0], 1 / 3, rtol=1e-12)
    assert np.allclose(found.distance, np.linalg.norm(way, axis=-1))
    assert set(found.obstruction.names[~found.visible]) == {"ball"}
    # Ends on surfaces do not hide each other, unless they count.
    ends = ((0, 0, -3.0), (0, 0, -1.0))
    assert measure.line_of_sight(ball, *ends).visible
    assert not measure.line_of_sight(ball, *ends, margin=0.0).visible
    assert measure.line_of_sight(ball, ends[0], ends[0]).visible
    with pytest.raises(ValueError, match=r"leading shapes do not broadcast: a \(2,\), b \(3,\)"):
        measure.line_of_sight(ball, np.zeros((2, 3)), np.zeros((3, 3)))
    with pytest.raises(ValueError, match=r"margin must be at least 0 and less than 0\.5, got 0\.5"):
        measure.line_of_sight(ball, *ends, margin=0.5)


@pytest.mark.parametrize(("z", "area"), [(-1.5, 0), (-1.0, 2), (0.5, 2), (1.5, 2), (1.6, 0)])
def test_a_box_is_cut_in_a_rectangle_also_at_its_corners(z, area):
    """A corner on the plane counts as above it: so the upper face is cut, the lower is not."""
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    cut = measure.cross_section(box, (7, 7, z), (0, 0, 3))
    assert cut.area == pytest.approx(area, abs=1e-14)
    assert cut.length == pytest.approx(6.0 if area else 0.0)
    assert cut.closed == ((True,) if area else ())
    for line in cut.lines:
        assert np.array_equal(line[0], line[-1])
        assert np.allclose(line[:, 2], z, rtol=0, atol=1e-15)
    slanted = measure.cross_section(box, (0, 0, 0), (1, 1, 1))
    assert all(slanted.closed)
    # Seen from the other side it is the same, and turns the other way round as seen from the first.
    assert measure.cross_section(box, (0, 0, 0), (-1, -1, -1)).area == pytest.approx(slanted.area, rel=1e-12)


def test_a_ball_is_cut_in_circles():
    """Of a sphere of triangles whose corners lie on it and edges are e long, a cut lies between circles
    e^2 / 2 apart.
    """
    ball = trimesh.creation.icosphere(subdivisions=4)
    edge = ball.edges_unique_length.max()
    for z in (0.0, 0.3, -0.77):
        cut = measure.cross_section(ball, (0, 0, z), (0, 0, 1))
        assert cut.closed == (True,)
        radius = np.linalg.norm(cut.lines[0][:, :2], axis=1)
        assert (radius <= np.sqrt(1 - z * z) + 1e-12).all()
        least = max(1 - edge**2 / 2, abs(z))
        assert np.pi * (least**2 - z * z) < cut.area < np.pi * (1 - z * z)


def test_a_torus_is_cut_in_two_loops_or_a_ring():
    torus = trimesh.creation.torus(2.0, 0.5, major_sections=64, minor_sections=48)
    # A regular polygon of 48 corners twice, where the plane goes through two rings of corners.
    across = measure.cross_section(torus, (0, 0, 0), (0, 1, 0))
    assert across.closed == (True, True)
    assert across.area == pytest.approx(2 * 48 / 2 * np.sin(2 * np.pi / 48) * 0.25, rel=1e-9)
    along = measure.cross_section(torus, (0, 0, 0), (0, 0, 1))
    assert along.closed == (True, True)
    polygon = 64 / 2 * np.sin(2 * np.pi / 64)
    assert along.area == pytest.approx(polygon * (2.5**2 - 1.5**2), rel=1e-9)
    # Inside out, all is less than nothing.
    torus.invert()
    assert measure.cross_section(torus, (0, 0, 0), (0, 0, 1)).area == pytest.approx(-along.area, rel=1e-9)


def test_areas_add_up_to_the_volume():
    """Cavalieri: between heights of corners the area is a parabola, for which Simpson's rule is exact."""
    body = trimesh.creation.icosphere(subdivisions=1).subdivide()
    body.vertices += np.random.default_rng(4).normal(scale=0.02, size=body.vertices.shape)
    levels = np.unique(body.vertices[:, 2])
    gaps = np.diff(levels)
    total = 0.0
    for low, gap in zip(levels[:-1], gaps, strict=True):
        at = [low + gap * share for share in (1e-9, 0.5, 1 - 1e-9)]
        a, b, c = (measure.cross_section(body, (0, 0, z), (0, 0, 1)).area for z in at)
        total += gap / 6 * (a + 4 * b + c)
    assert total == pytest.approx(body.volume, rel=1e-7)


def test_open_meshes_and_copies_are_cut_too(triangle, box):
    cut = measure.cross_section(triangle, (0.25, 0, 0), (1, 0, 0))
    assert cut.closed == (False,)
    assert cut.area == 0
    assert cut.length == pytest.approx(0.75, rel=1e-12)
    places = np.tile(np.eye(4), (3, 1, 1))
    places[:, 0, 3] = (0, 5, 10)
    copies = measure.cross_section(rw.Scene([box, rw.Instance(box, places + 0)]), (0, 0.5, 0), (0, 1, 0))
    assert copies.area == pytest.approx(4.0)
    with pytest.raises(ValueError, match="shape 1 is no mesh but a Sphere: only meshes can be cut"):
        measure.cross_section([box, rw.Sphere()], (0, 0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="shape 0 moves"):
        measure.cross_section(rw.Instance(box, places[0], places[1]), (0, 0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="normal must have a length"):
        measure.cross_section(box, (0, 0, 0), (0, 0, 0))
