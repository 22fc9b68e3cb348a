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
    """Between two like polyhedra every pair of faces is the difference of the distances from the center
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


def test_the_result_belongs_to_the_caller():
    plate = rw.Scene(trimesh.creation.box((4.0, 4.0, 0.2)))
    for method in ("ray", "sphere"):
        found = measure.thickness(plate, method=method)
        again = found.copy()
        found *= 1000.0
        assert np.array_equal(measure.thickness(plate, method=method), again)


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


def test_the_largest_balls_are_empty_and_touch():
    """Of every ball that is told, nothing of the surface is inside, and none that is larger by 1e-5 is so."""
    bodies = [
        trimesh.creation.icosphere(subdivisions=2),
        trimesh.creation.capsule(height=3.0, radius=0.5, count=[12, 12]),
        trimesh.creation.cylinder(radius=0.4, height=5.0, sections=40),
        trimesh.creation.torus(1.0, 0.3, major_sections=24, minor_sections=12),
    ]
    for body in bodies:
        body.apply_transform(trimesh.transformations.rotation_matrix(0.7, (1, 2, 3), (5, -3, 1)))
        scene = rw.Scene(body, precision="double")
        diameters = measure.thickness(scene, method="sphere")
        middles, normals = body.triangles_center, body.face_normals
        assert (diameters <= measure.thickness(scene) * (1 + 1e-12)).all()
        radius = diameters / 2
        gap = scene.closest_point(middles - radius[:, None] * normals).distance / radius
        assert np.allclose(gap, 1, rtol=0, atol=4e-6)
        larger = radius * (1 + 1e-5)
        is_whole = diameters < measure.thickness(scene) * (1 - 1e-4)
        gap = scene.closest_point(middles - larger[:, None] * normals).distance / larger
        assert (gap < 1)[is_whole].all()


def test_balls_of_a_rod_are_as_thick_as_it_is():
    """From the middle of a side of a regular prism the ball touches all of its sides at once."""
    sections = 200
    rod = trimesh.creation.cylinder(radius=1.0, height=20.0, sections=sections)
    scene = rw.Scene(rod, precision="double")
    side = np.abs(rod.face_normals[:, 2]) < 0.5
    found = measure.thickness(scene, method="sphere")[side]
    assert len(found) == 2 * sections
    # A third of the way along its edge, at the middles of the triangles, the next side limits the ball.
    flat = np.cos(np.pi / sections)
    assert (found <= 2 * flat * (1 + 1e-6)).all()
    off = np.tan(np.pi / sections) * flat / 3
    ball = (flat * np.tan(np.pi / sections) - off) / np.tan(np.pi / sections)
    assert np.allclose(found, 2 * ball, rtol=1e-6)


def test_balls_and_rays_of_what_is_no_mesh():
    """Between two spheres about one point the largest ball is as wide as they are apart."""
    shell = rw.Scene([rw.Sphere((1, 2, 3), 1.0), rw.Sphere((1, 2, 3), 0.8)])
    ways = np.random.default_rng(1).normal(size=(50, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    found = measure.thickness(shell, np.array([1, 2, 3]) + ways, ways, method="sphere")
    assert np.allclose(found, 0.2, rtol=1e-8)
    mixed = rw.Scene([rw.Box((0, 0, 0), (4, 4, 1)), rw.Box((9, 9, 9), (10, 10, 10))])
    assert measure.thickness(mixed, (2, 2, 1), (0, 0, 1), method="sphere") == pytest.approx(1, rel=1e-8)


def test_a_film_in_a_large_part_is_as_thick_as_it_is():
    """What else is in the scene, and how large that is, is no matter."""
    film = trimesh.creation.box(bounds=[(0, 0, 0), (10, 10, 1e-6)])
    far = trimesh.creation.icosphere(radius=1e4)
    far.apply_translation((1e6, 0, 0))
    for others in ([], [far]):
        scene = rw.Scene([film, *others], precision="double")
        for points in ((5, 5, 1e-6), [(5, 5, 1e-6), (1e6, 1e4, 0)]):
            for method in ("ray", "sphere"):
                found = measure.thickness(scene, points, (0, 0, 1), method=method)
                assert np.atleast_1d(found)[0] == pytest.approx(1e-6, rel=1e-6)


def test_no_other_side_and_no_point():
    sheet = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert np.array_equal(measure.thickness(sheet), [np.inf])
    assert np.array_equal(measure.thickness(sheet, method="sphere"), [np.inf])
    scene = rw.Scene(sheet)
    assert np.isnan(measure.thickness(scene, scene.intersect((5.0, 5, 5), (0, 0, 1)))).all()
    with pytest.raises(ValueError, match="points must be given: shape 1 is a Sphere, not a mesh"):
        measure.thickness([sheet, rw.Sphere()])
    with pytest.raises(ValueError, match="method must be one of 'ray', 'sphere', got 'cone'"):
        measure.thickness(sheet, method="cone")


def test_points_see_each_other_or_what_is_between():
    ball = rw.Sphere((0, 0, 0), 1.0, name="ball")
    a = np.array([(0, 0, -3.0), (0, 2, -3.0), (0, 0, 0)])
    found = measure.line_of_sight(rw.Scene(ball), a[:, None], [(0, 0, 3.0), (5.0, 0, -3)])
    # The segment passes the ball if its nearest point to the center does.
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


def test_what_is_near_hides_however_far_the_other_end_is():
    """The sun is 1.5e11 away, and a leaf a hand."""
    for far in (10.0, 1e6, 1.5e11):
        for near in (1e-6, 0.1, 5.0):
            leaf = rw.Mesh([(near, -1, -1), (near, 1, -1), (near, 0, 2)], [(0, 1, 2)])
            scene = rw.Scene(leaf, precision="double")
            found = measure.line_of_sight(scene, [(0, 0, 0), (0, 3, 0)], (far, 0.0, 0.0))
            assert np.array_equal(found.visible, [False, True])
            assert found.obstruction.t[0] == pytest.approx(near / far, rel=1e-12)
            back = measure.line_of_sight(scene, (far, 0.0, 0.0), (0, 0, 0))
            assert not back.visible


def test_points_on_surfaces_are_not_hidden_by_these():
    """Of a convex body a point sees what lies before its face, and nothing behind it."""
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    box.apply_translation((1e3, -500, 20))
    scene = rw.Scene(box, precision="double")
    rng = np.random.default_rng(3)
    middle = np.array((1e3, -500.0, 20))
    on = middle + np.stack([np.ones(200), *rng.uniform(-1, 1, (2, 200))], axis=-1)
    other = middle + np.stack([-np.ones(200), *rng.uniform(-1, 1, (2, 200))], axis=-1)
    out = on + np.stack([rng.uniform(1e-6, 5, 200), *rng.uniform(-5, 5, (2, 200))], axis=-1)
    for a, b, visible in ((on, out, True), (on, other, True), (out, other, False)):
        found = measure.line_of_sight(scene, a, b)
        assert (found.visible == visible).all()
        assert (measure.line_of_sight(scene, b, a).visible == visible).all()
    # Along the face, and over an edge and a corner of it.
    assert measure.line_of_sight(scene, on, on[::-1]).visible.all()
    edge, corner = np.add(middle, (1, 1, 0.3)), np.add(middle, (1, 1, 1))
    for start in (edge, corner):
        above, across = np.add(start, (0.5, 0.5, 3)), np.add(start, (-4, -3, -0.1))
        assert measure.line_of_sight(scene, start, above).visible
        assert measure.line_of_sight(scene, above, start).visible
        assert not measure.line_of_sight(scene, across, start).visible


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
    # Seen from the other side it is the same, with the reversed orientation.
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
    # Inside out, all values are negative.
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
    # The first copy is where the box itself is.
    copies = measure.cross_section(rw.Scene([box, rw.Instance(box, places + 0)]), (0, 0.5, 0), (0, 1, 0))
    assert copies.area == pytest.approx(3.0)
    with pytest.raises(ValueError, match="shape 1 must be a mesh to be cut, got a Sphere"):
        measure.cross_section([box, rw.Sphere()], (0, 0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="shape 0 moves"):
        measure.cross_section(rw.Instance(box, places[0], places[1]), (0, 0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="normal must not contain zero vectors"):
        measure.cross_section(box, (0, 0, 0), (0, 0, 0))
