"""Meshes as files have them: corners that rounding has moved, faces turned, twice or missing."""

import warnings

import numpy as np
import pytest
import trimesh

import raywright as rw

measure = rw.measure


@pytest.fixture
def soup(box):
    """A cube of faces with corners of their own, of which zeros are a little off."""
    corners = box.vertices[box.faces].astype(np.float64)
    off = np.random.default_rng(0).choice([0, 1e-17, -1e-17], (corners == 0).sum())
    corners[corners == 0] = off
    return rw.Mesh(corners.reshape(-1, 3), np.arange(36).reshape(-1, 3))


def jittered(mesh, by, seed=1):
    """Every face with corners of its own, each of them moved by up to so much."""
    corners = np.asarray(mesh.vertices, np.float64)[mesh.faces].reshape(-1, 3)
    corners = corners + np.random.default_rng(seed).uniform(-by, by, corners.shape)
    return corners, np.arange(len(corners)).reshape(-1, 3)


def test_corners_that_rounding_has_moved_are_one(soup):
    cut = measure.cross_section(soup, (0, 0, 0.4), (0, 0, 1))
    assert cut.area == pytest.approx(1.0, abs=1e-15)
    assert cut.closed == (True,)
    assert measure.cross_section(rw.Scene(soup, weld=None), (0, 0, 0.4), (0, 0, 1)).area == 0
    points = np.random.default_rng(1).uniform(-0.5, 1.5, (500, 3))
    inside = ((points > 0) & (points < 1)).all(axis=1)
    assert np.array_equal(rw.Scene(soup).contains(points), inside)
    assert not rw.Scene(soup, weld=None).contains(points).any()
    found = measure.topology(soup)
    assert found.is_closed
    assert found.volumes == pytest.approx([1.0])
    assert 1e-15 < found.tolerance < 1e-13
    crack = measure.topology(rw.Scene(soup, weld=None))
    assert not crack.is_closed
    assert len(crack.cracks) > 10
    assert crack.volumes == ()


@pytest.mark.parametrize("as_file", [True, False])
def test_rays_in_a_plane_of_symmetry_do_not_slip_through_files(soup, as_file, tmp_path):
    mesh = trimesh.Trimesh(soup.vertices, soup.faces, process=False)
    if as_file:
        mesh.export(tmp_path / "soup.stl")
    shapes = tmp_path / "soup.stl" if as_file else mesh
    side = np.random.default_rng(2).uniform(0.001, 0.999, 2000)
    ways = np.array([(0, 0, -1.0)])
    # Through the diagonals of faces.
    for other in (side, 1 - side):
        hits = rw.Scene(shapes).intersect(np.stack([side, other, np.full(2000, 3.0)], axis=-1), ways)
        assert np.allclose(hits.t, 2.0, rtol=0, atol=1e-6)
    welded = rw.Scene(shapes).shapes[0]
    assert len(welded.faces) == 12
    assert len(np.unique(welded.vertices[welded.faces].reshape(-1, 3), axis=0)) == 8


def test_how_close_corners_are_one_can_be_said(box):
    corners, faces = jittered(box, 1e-4)
    mesh = rw.Mesh(corners, faces)
    assert len(measure.topology(mesh).cracks) == 36
    scene = rw.Scene(mesh, weld=1e-3)
    assert measure.topology(scene).is_closed
    assert measure.topology(scene).tolerance == 1e-3
    assert len(np.unique(scene.shapes[0].vertices, axis=0)) == 8
    assert scene.weld == 1e-3
    assert scene.replace(weld=None).weld is None
    assert "weld=0.001" in repr(scene)
    # Single precision has fewer digits for the offset.
    for dtype, by, is_closed in (
        (np.float32, 5e-8, True),
        (np.float64, 1e-15, True),
        (np.float64, 1e-9, False),
    ):
        corners, faces = jittered(box, by)
        assert measure.topology(rw.Mesh(corners.astype(dtype), faces)).is_closed == is_closed
    for weld, told in ((-1, "weld must be at least 0"), ("near", "weld must be 'auto', a distance or None")):
        with pytest.raises(ValueError, match=told):
            rw.Scene(mesh, weld=weld)


def test_what_is_closed_or_apart_stays_to_the_last_bit(box):
    film = rw.Mesh(box.vertices * (10, 10, 1e-12), box.faces)
    for shapes in (
        [film],
        [box, rw.Mesh(box.vertices + np.array((1 + 1e-9, 0, 0)), box.faces)],
        [rw.scenes.teapot()],
    ):
        scene = rw.Scene(shapes)
        assert scene.welded() is scene
        assert scene.shapes == tuple(rw.Scene(shapes, weld=None).shapes)
    thin = measure.cross_section(rw.Scene(film, weld=1e-3), (5, 0, 0), (1, 0, 0))
    assert thin.area == pytest.approx(1e-11, rel=1e-12)


def test_arrays_are_hit_where_they_are(soup):
    scene = rw.Scene(soup)
    assert scene.shapes[0] is soup
    assert scene.welded().shapes[0] != soup
    assert scene.welded() is scene.welded()
    thick = measure.thickness(scene)
    assert np.allclose(thick, 1.0, rtol=0, atol=1e-12)


def test_corners_within_edges_are_told(box):
    """A wall of which the neighbor has a corner in the middle of an edge closes, to rounding."""
    middle = (box.vertices[0] + box.vertices[1]) / 3
    corners = np.concatenate([box.vertices, [middle]])
    edge = {0, 1}
    which = next(i for i, face in enumerate(box.faces.tolist()) if edge <= set(face))
    face = box.faces[which].tolist()
    while edge != {face[0], face[1]}:
        face = face[1:] + face[:1]
    parts = [(face[0], 8, face[2]), (8, face[1], face[2])]
    faces = np.concatenate([np.delete(box.faces, which, axis=0), parts])
    found = measure.topology(rw.Mesh(corners, faces))
    assert found.is_closed
    assert np.array_equal(found.t_junctions, [middle])
    assert "1 T-junctions" in repr(found)
    points = np.random.default_rng(3).uniform(-0.5, 1.5, (300, 3))
    inside = ((points > 0) & (points < 1)).all(axis=1)
    assert np.array_equal(rw.Scene(rw.Mesh(corners, faces)).contains(points), inside)
    for normal in ((0.3, 0.5, 1), (1, -0.2, 0.1)):
        cut = measure.cross_section(rw.Mesh(corners, faces), (0.5, 0.5, 0.5), normal)
        assert cut.is_closed
        assert cut.area == pytest.approx(measure.cross_section(box, (0.5, 0.5, 0.5), normal).area)


def test_a_section_does_not_depend_on_how_faces_turn_or_on_copies(box):
    plane = (0, 0, 0.4), (0, 0, 1)
    one_turned = box.faces.copy()
    one_turned[[4, 7]] = one_turned[[4, 7], ::-1]
    both = np.concatenate([box.faces, box.faces[:, ::-1]])
    for faces in (one_turned, both, both[::-1], np.concatenate([box.faces, box.faces[3:5]])):
        for rule in ("winding", "even-odd"):
            cut = measure.cross_section(rw.Mesh(box.vertices, faces), *plane, rule=rule)
            assert cut.closed == (True,)
            assert cut.area == pytest.approx(1.0, abs=1e-14)
    found = measure.topology(rw.Mesh(box.vertices, one_turned))
    assert found.turned_edges > 0
    assert np.isnan(found.volumes).all()
    assert measure.topology(rw.Mesh(box.vertices, both)).duplicate_faces == 12
    assert measure.cross_section(rw.Mesh(box.vertices, box.faces[:, ::-1]), *plane).area == pytest.approx(-1)


def test_overlaps_count_once_or_not_at_all(box):
    other = rw.Mesh(box.vertices + 0.5, box.faces)
    for shapes, winding, even_odd in (
        ([box, other], 1.75, 1.5),
        ([box, box], 1.0, 1.0),
        ([box, rw.Mesh(box.vertices / 2 + 0.25, box.faces)], 1.0, 0.75),
        ([box, rw.Mesh(box.vertices / 2 + 0.25, box.faces[:, ::-1])], 0.75, 0.75),
        ([box, rw.Mesh(box.vertices + np.array((1, 0, 0)), box.faces)], 2.0, 2.0),
    ):
        # Along the axes, and rotated so that nothing is axis-aligned.
        turn = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
        for place in (np.eye(4), turn):
            placed = [shape.transformed(place) for shape in shapes]
            point, normal = place[:3, :3] @ (0, 0, 0.6), place[:3, 2]
            for rule, area in (("winding", winding), ("even-odd", even_odd)):
                cut = measure.cross_section(placed, point, normal, rule=rule)
                assert cut.area == pytest.approx(area, abs=1e-13)
    with pytest.raises(ValueError, match="rule must be one of 'winding', 'even-odd', got 'odd'"):
        measure.cross_section(box, (0, 0, 0), (0, 0, 1), rule="odd")


@pytest.mark.parametrize("seed", range(6))
def test_sections_and_insides_bear_all_of_it_at_once(seed):
    """Every face has corners of its own, off by rounding; some are turned, some or all there twice."""
    rng = np.random.default_rng(seed)
    body = trimesh.creation.annulus(0.5, 1.0, 2.0, sections=20)
    if seed % 2:
        body = trimesh.creation.torus(2.0, 0.5, major_sections=24, minor_sections=12)
    body.apply_transform(trimesh.transformations.random_rotation_matrix(rng.random(3)))
    vertices = body.vertices + rng.normal(size=3)
    corners, faces = jittered(rw.Mesh(vertices, body.faces), 1e-15, seed)
    turned = rng.random(len(faces)) < 0.1
    faces[turned] = faces[turned, ::-1]
    again = faces[:, ::-1] if seed % 3 == 0 else faces[rng.random(len(faces)) < 0.2]
    noisy = rw.Mesh(corners, rng.permutation(np.concatenate([faces, again])))
    clean = rw.Mesh(vertices, body.faces)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    points = rng.uniform(low, high, (500, 3))
    wanted = rw.Scene(clean, precision="double").contains(points)
    assert 50 < wanted.sum() < 450
    with warnings.catch_warnings():
        # A body with reversed faces has a random orientation.
        warnings.simplefilter("ignore", RuntimeWarning)
        assert np.array_equal(rw.Scene(noisy, precision="double").contains(points), wanted)
    planes = rng.uniform(low, high, (5, 3)), rng.normal(size=(5, 3))
    for rule in ("winding", "even-odd"):
        cuts = zip(*(measure.cross_section(mesh, *planes, rule=rule) for mesh in (clean, noisy)), strict=True)
        for one, other in cuts:
            assert other.is_closed
            assert other.area == pytest.approx(one.area, rel=1e-12, abs=1e-13)


def test_open_outlines_are_told(box):
    sides = box.faces[np.ptp(box.vertices[box.faces][..., 0], axis=1) > 0]
    lidless = rw.Mesh(box.vertices, sides)
    cut = measure.cross_section(lidless, (0, 0, 0.5), (0, 0, 1))
    assert not cut.is_closed
    assert cut.area == 0
    assert len(cut) == 2
    assert cut.gaps == pytest.approx([1.0, 1.0])
    assert cut.length == pytest.approx(2.0)
    assert "0 closed and 2 open lines" in repr(cut)
    ball = rw.Mesh(box.vertices + 5, box.faces)
    both = measure.cross_section([lidless, ball], [(0, 0, 0.5), (0, 0, 5.5)], (0, 0, 1))
    assert [section.area for section in both] == pytest.approx([0, 1])
    assert [section.is_closed for section in both] == [False, True]


def test_many_planes_are_cut_as_each_by_itself():
    rng = np.random.default_rng(5)
    body = trimesh.creation.torus(2.0, 0.5, major_sections=64, minor_sections=48)
    points, normals = rng.uniform(-1.5, 1.5, (40, 3)), rng.normal(size=(40, 3))
    points[:10], normals[:10] = 0.0, (0, 0, 1)
    points[:10, 2] = np.linspace(-0.6, 0.6, 10)
    many = measure.cross_section(body, points, normals)
    assert len(many) == 40
    for section, point, normal in zip(many, points, normals, strict=True):
        alone = measure.cross_section(body, point, normal)
        assert section.area == alone.area
        assert all(map(np.array_equal, section.lines, alone.lines))
        assert section.is_closed
    assert sum(section.area > 0 for section in many) > 30
    assert isinstance(measure.cross_section(body, points[:1], (0, 0, 1)), tuple)
    assert measure.cross_section(body, points[:0], (0, 0, 1)) == ()
    with pytest.raises(ValueError, match=r"point and normal must be of shape \(3,\) or \(N, 3\)"):
        measure.cross_section(body, np.zeros((2, 2, 3)), (0, 0, 1))


def test_degenerate_faces_and_corners_that_are_not_finite_are_counted(box):
    corners = np.concatenate([box.vertices, [(np.nan, 0, 0)]])
    faces = np.concatenate([box.faces, [(0, 0, 1), (1, 2, 8)]])
    mesh = rw.Mesh(corners, faces)
    found = measure.topology(mesh)
    assert (found.degenerate_faces, found.open_faces, found.volumes) == (2, 0, (pytest.approx(1.0),))
    assert measure.cross_section(mesh, (0, 0, 0.4), (0, 0, 1)).area == pytest.approx(1.0)
    with pytest.raises(ValueError, match="shape 1 must be a mesh to be cut, got a Sphere"):
        measure.topology([box, rw.Sphere()])
