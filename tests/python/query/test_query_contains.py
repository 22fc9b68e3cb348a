"""Inside or outside: against exact arithmetic."""

import warnings
from fractions import Fraction

import numpy as np
import pytest
import trimesh

import raywright as rw


def integer_torus():
    """A closed, not convex mesh whose vertices are integers."""
    torus = trimesh.creation.torus(40.0, 15.0, major_sections=16, minor_sections=10)
    return rw.Mesh(np.round(torus.vertices), torus.faces)


def integer_icosphere():
    ball = trimesh.creation.icosphere(subdivisions=2)
    return rw.Mesh(np.round(ball.vertices * 64), ball.faces)


def volumes(mesh, points, scale):
    """Volumes that points span with each face and the face's own edges seen from it: (P, F), in integers."""
    triangles = (mesh.vertices * scale).astype(np.int64)[mesh.faces]
    seen = triangles[None] - np.round(points * scale).astype(np.int64)[:, None, None]
    a, b, c = seen[:, :, 0], seen[:, :, 1], seen[:, :, 2]
    return a, b, c, (a * np.cross(b, c)).sum(axis=-1)


def on_surface(mesh, points, scale):
    """Whether points lie on a face: its plane holds them, and its edges turn the same way around them."""
    a, b, c, volume = volumes(mesh, points, scale)
    normal = np.cross(b - a, c - a)
    turns = [(np.cross(v, w) * normal).sum(axis=-1) >= 0 for v, w in ((a, b), (b, c), (c, a))]
    return ((volume == 0) & turns[0] & turns[1] & turns[2]).any(axis=1)


def winding_number(mesh, points):
    """By solid angles (van Oosterom and Strackee 1983), of points that are not on the surface."""
    triangles = mesh.vertices[mesh.faces]
    seen = triangles[None] - points[:, None, None]
    a, b, c = seen[:, :, 0], seen[:, :, 1], seen[:, :, 2]
    la, lb, lc = (np.linalg.norm(x, axis=-1) for x in (a, b, c))
    volume = (a * np.cross(b, c)).sum(axis=-1)
    below = la * lb * lc + (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return 2 * np.arctan2(volume, below).sum(axis=1) / (4 * np.pi)


@pytest.mark.parametrize("mesh", [integer_torus(), integer_icosphere()], ids=["torus", "ball"])
def test_points_on_grid_planes_are_where_integers_say(mesh):
    rng = np.random.default_rng(1)
    reach = np.abs(mesh.vertices).max(axis=0) * 2 + 8
    points = rng.integers(-reach, reach + 1, (1500, 3)) / 2
    points[:500] = np.round(points[:500])
    # Vertices, middles of edges, and points of faces whose coordinates are halves.
    corners = mesh.vertices[mesh.faces]
    points = np.concatenate([points, mesh.vertices, corners[:, :2].mean(axis=1)])
    surface = on_surface(mesh, points, 2)
    assert surface.sum() > 200
    number = np.zeros(len(points))
    number[~surface] = winding_number(mesh, points[~surface])
    assert np.allclose(number, np.round(number), atol=1e-9)
    truth = surface | (np.round(number) == 1)
    assert 150 < (truth & ~surface).sum() < len(points) - 300
    for accelerator in (rw.BVH(), rw.BruteForce()):
        scene = rw.Scene(mesh, accelerator=accelerator)
        assert np.array_equal(scene.contains(points), truth)
        assert np.array_equal(
            scene.contains(points.reshape(2, -1, 3) if len(points) % 2 == 0 else points).ravel(), truth
        )


def test_a_box_holds_its_points_to_the_last_bit(scene):
    steps = np.array([-1, np.nextafter(0, -1), -0.0, np.nextafter(0, 1), 0.3, 0.5, np.nextafter(1, 0), 1.0])
    steps = np.append(steps, [np.nextafter(1, 2), 2.0])
    points = np.stack(np.meshgrid(steps, steps, steps), axis=-1)
    truth = ((points >= 0) & (points <= 1)).all(axis=-1)
    assert np.array_equal(scene.contains(points), truth)


@pytest.mark.parametrize(("scale", "offset"), [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e6)])
def test_points_next_to_faces_are_on_their_side(scale, offset):
    """Points one step of f64 off a slanted face are told apart, by the exact volume of each."""
    ball = trimesh.creation.icosphere(subdivisions=1)
    mesh = rw.Mesh((ball.vertices * scale + offset).astype(np.float32), ball.faces)
    rng = np.random.default_rng(2)
    faces = rng.integers(0, len(mesh.faces), 300)
    corners = mesh.vertices.astype(np.float64)[mesh.faces[faces]]
    weights = rng.dirichlet((1.0, 1, 1), 300)
    points = (weights[..., None] * corners).sum(axis=1)
    points = np.nextafter(points, points + rng.choice([-1.0, 0, 1], points.shape))
    # The ball is convex: inside is the inner side of every face. Python's integers have any length.
    whole = np.vectorize(lambda x: int(Fraction(float(x)) * 2**1074), otypes=[object])
    a, b, c = (whole(mesh.vertices)[mesh.faces[:, i]] for i in range(3))
    u, v, place = b - a, c - a, whole(points)
    normal = np.stack([u[:, i] * v[:, j] - u[:, j] * v[:, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=1)
    beyond = ((place[:, None] - a[None]) * normal[None]).sum(axis=2) > 0
    truth = ~beyond.any(axis=1)
    assert 50 < truth.sum() < 250
    assert np.array_equal(rw.Scene(mesh).contains(points), truth)


def test_a_cavity_is_outside_and_a_body_in_another_inside(box):
    small = box.vertices / 4 + 0.25
    points = [(0.1, 0.1, 0.1), (0.3, 0.3, 0.3), (0.9, 0.2, 0.4), (2, 0.3, 0.3)]
    # Outward normals: a body within another. Inward normals: the wall of a cavity.
    for faces, is_inside in ((box.faces, True), (box.faces[:, ::-1], False)):
        apart = [box, rw.Mesh(small, faces)]
        as_one = rw.Mesh(np.concatenate([box.vertices, small]), np.concatenate([box.faces, faces + 8]))
        for shapes in (apart, apart[::-1], as_one):
            assert np.array_equal(rw.Scene(shapes).contains(points), [True, is_inside, True, False])
    # The cavity of a ball contains another ball, and a box that reaches into both.
    core = rw.Sphere((0.375, 0.375, 0.375), 0.05)
    nested = rw.Scene([box, rw.Mesh(small, box.faces[:, ::-1]), core])
    assert np.array_equal(nested.contains([(0.375, 0.375, 0.375), (0.27, 0.27, 0.27)]), [True, False])


def test_which_way_faces_are_wound_does_not_matter(box):
    turned = rw.Mesh(box.vertices, box.faces[:, ::-1], name="turned")
    mixed = rw.Mesh(box.vertices, [f[::-1] if i % 3 else f for i, f in enumerate(box.faces.tolist())])
    points = np.random.default_rng(3).uniform(-0.5, 1.5, (500, 3))
    expected = rw.Scene(box).contains(points)
    assert np.array_equal(expected, ((points >= 0) & (points <= 1)).all(axis=1))
    assert np.array_equal(rw.Scene([mixed]).contains(points), expected)
    scene = rw.Scene([rw.Mesh(box.vertices + 5, box.faces), turned])
    with pytest.warns(RuntimeWarning, match=r"normals of shape 1 'turned' point inward and are treated as"):
        assert np.array_equal(scene.contains(points), expected)
    # Once.
    assert np.array_equal(scene.signed_distance(points) <= 0, expected)


def test_what_is_open_has_no_inside(box):
    """Where a ground, a plane or a wall is beside a solid, and where a solid has a hole."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(4)
    points = rng.uniform(-2, 2, (4000, 3))
    assert not rw.Scene(rw.Mesh(ball.vertices, ball.faces[8:])).contains(points).any()
    ground = rw.Mesh([(-9, -9, 0.5), (9, -9, 0.5), (9, 9, 0.5), (-9, 9, 0.5)], [(0, 1, 2), (0, 2, 3)])
    flats = [
        ground,
        rw.Plane((0, 0, 0.25), (0, 0.1, 1)),
        rw.Disk((0, 0, 0.5), (0, 0, 1), 3.0),
        rw.Cylinder((0, 0, -3), (0, 0, 3), 0.5, capped=False),
        rw.shapes.Implicit("z - sin(x)", (-3, -3, -3), (3, 3, 3)),
        rw.Polygon([(-3, -3, 0), (3, -3, 0), (3, 3, 0)]),
    ]
    expected = ((points >= 0) & (points <= 1)).all(axis=1)
    for flat in flats:
        assert not rw.Scene(flat).contains(points).any()
        assert np.array_equal(rw.Scene([flat, box]).contains(points), expected)
    assert np.array_equal(rw.Scene([*flats, box]).contains(points), expected)
    # The ground shares a corner and an edge with the box.
    sheet = np.concatenate([box.vertices, [(0, -5, 0), (1, -5, 0)]])
    touching = rw.Mesh(sheet, np.concatenate([box.faces, [(0, 1, 8), (1, 9, 8)]]))
    assert np.array_equal(rw.Scene(touching).contains(points), expected)
    assert rw.Scene([flats[1], rw.Sphere((0, 0, 2), 1)]).signed_distance((0, 0, 2)) == -1
    # An open surface has no inside.
    assert not rw.Scene(ground).contains((0.3, 0.2, 0.5))


def test_what_overlaps_is_inside_and_copies_count_once(box):
    points = np.random.default_rng(5).uniform(-0.5, 2.5, (2000, 3))

    def within(at):
        return ((points >= at) & (points <= at + 1)).all(axis=1)

    other = rw.Mesh(box.vertices + 0.5, box.faces)
    both = rw.Mesh(
        np.concatenate([box.vertices, other.vertices]), np.concatenate([box.faces, other.faces + 8])
    )
    place = np.eye(4)
    place[:3, 3] = 0.5
    for shapes in ([box, other], both, [box, rw.Instance(box, place)], [box, rw.Box((0.5,) * 3, (1.5,) * 3)]):
        assert np.array_equal(rw.Scene(shapes).contains(points), within(0) | within(0.5))
    turned = box.faces[:, ::-1]
    for faces in ([box.faces, turned], [box.faces, box.faces], [turned, box.faces]):
        doubled = rw.Mesh(box.vertices, np.concatenate([box.faces[:0], *faces]))
        assert np.array_equal(rw.Scene([doubled, other]).contains(points), within(0) | within(0.5))
    assert np.array_equal(rw.Scene([box, box, rw.Mesh(box.vertices, box.faces)]).contains(points), within(0))
    # Side by side, with the wall between both in one mesh, and in the corner of it.
    beside = rw.Mesh(
        np.concatenate([box.vertices, box.vertices + np.array((1, 0, 0))]),
        np.concatenate([box.faces, box.faces + 8]),
    )
    expected = ((points >= 0) & (points <= (2, 1, 1))).all(axis=1)
    assert np.array_equal(rw.Scene(beside).contains(points), expected)
    assert rw.Scene(beside).contains([(1, 0.5, 0.5), (1, 1, 1), (1, 0.3, 0.0)]).all()


def test_only_shapes_that_are_named_count(box):
    far = rw.Mesh(box.vertices + 3, box.faces, name="far")
    ball = rw.Sphere((0.5, 0.5, 0.5), 0.25, name="ball")
    scene = rw.Scene([box, far, ball])
    points = np.array([(0.1, 0.1, 0.1), (0.5, 0.5, 0.5), (3.5, 3.5, 3.5)])
    assert np.array_equal(scene.contains(points), [True, True, True])
    assert np.array_equal(scene.contains(points, shapes="far"), [False, False, True])
    assert np.array_equal(scene.contains(points, shapes=["ball", "far"]), [False, True, True])
    assert np.array_equal(scene.contains(points, shapes=[True, False, False]), [True, True, False])
    assert not scene.contains(points, shapes=np.zeros(3, bool)).any()
    with pytest.raises(ValueError, match="shapes has 'near', which is not the name of a shape of the scene"):
        scene.contains(points, shapes="near")


@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("nested", [False, True])
def test_inverted_meshes_in_instances_are_told_by_the_normals_that_hits_have(box, mirror, nested):
    place = np.diag([mirror, 2.0, 1.0, 1.0])
    rays = (0.1, 0.2, 9), (0, 0, -1)
    for faces, is_inverted in ((box.faces, False), (box.faces[:, ::-1], True)):
        mesh = rw.Mesh(box.vertices - 0.5, faces)
        inner = rw.Instance(mesh, np.diag([1.0, mirror, 1.0, 1.0])) if nested else mesh
        scene = rw.Scene([box, rw.Instance([inner, rw.Sphere((0, 0, 3), 0.1)], place, name="copies")])
        assert (scene.intersect(*rays, shapes="copies", t_min=6.5).normal[2] < 0) == is_inverted
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            assert scene.contains((0.0, 0.9, 0.0), shapes="copies")
            assert not scene.contains((0.0, 1.1, 0.0), shapes="copies")
            scene.contains((0.0, 0.0, 0.0))
        assert len(told) == is_inverted
        assert all("normals of shape 1 'copies' point inward" in str(one.message) for one in told)
    # The wall of a cavity does not count as inverted.
    shell = [rw.Mesh(4 * (box.vertices - 0.5), box.faces), mesh]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        copies = rw.Scene(rw.Instance(shell, place))
        assert np.array_equal(copies.contains([(0, 0, 0.9), (0, 0, 0.1)]), [True, False])
        assert not rw.Scene([box, rw.Instance(mesh, place)]).contains((0, 9, 0), shapes=[True, False])


def test_walls_that_close_together_are_one(box):
    """As where a file has a mesh for each material."""
    points = np.random.default_rng(6).uniform(-0.5, 1.5, (1000, 3))
    expected = ((points >= 0) & (points <= 1)).all(axis=1)
    walls = [rw.Mesh(box.vertices, box.faces[i : i + 2]) for i in range(0, 12, 2)]
    assert np.array_equal(rw.Scene(walls).contains(points), expected)
    assert not rw.Scene(walls[1:]).contains(points).any()
    assert not rw.Scene(walls).contains(points, shapes=[True] * 5 + [False]).any()


def test_points_that_are_not_finite_are_outside(scene):
    points = np.full((4, 3), 0.5)
    points[[0, 1, 2], [0, 1, 2]] = np.nan, np.inf, -np.inf
    assert np.array_equal(scene.contains(points), [False, False, False, True])
    assert not rw.Scene([]).contains((0, 0, 0))


@pytest.mark.parametrize("threads", [1, 3])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_neither_threads_nor_batches_change_the_answer(threads, dtype):
    scene = rw.Scene(rw.scenes.torus_knot(along=60, around=8))
    points = np.random.default_rng(5).uniform(-1, 1, (30, 100, 3)).astype(dtype)
    expected = np.array([scene.contains(row) for row in points])
    assert expected.any()
    assert np.array_equal(scene.contains(points, threads=threads), expected)
    assert scene.contains(np.asfortranarray(points)).dtype == np.bool_
    assert np.array_equal(scene.contains(np.asfortranarray(points)), expected)
    assert np.array_equal(scene.contains(points[3, 4]), expected[3, 4])


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        (((0, 0),), ValueError, r"points must have shape \(\.\.\., 3\), got \(2,\)"),
        ((np.zeros((3, 3), complex),), TypeError, r"points must be real numbers, got dtype complex128"),
        (((0, 0, 0), 0), ValueError, r"threads must be at least 1, got 0"),
        (((0, 0, 0), 1.5), TypeError, r"threads must be an integer, got 1.5"),
    ],
)
def test_bad_points_are_refused_in_one_line(scene, arguments, error, message):
    with pytest.raises(error, match=message) as caught:
        scene.contains(*arguments)
    assert "\n" not in str(caught.value)
