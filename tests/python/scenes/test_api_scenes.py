"""Scenes that are ready to render."""

import numpy as np
import pytest

import raywright as rw
from raywright.shapes.topology import degenerate_faces, is_watertight


def enclosed(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float((a * np.cross(b, c)).sum() / 6)


@pytest.mark.parametrize(("p", "q"), [(2, 3), (3, 2), (2, 5)])
def test_knot_is_a_closed_tube_around_its_curve(p, q):
    knot = rw.scenes.torus_knot(p, q, along=900, around=60, tube=0.1)
    assert len(knot.faces) == 2 * 900 * 60
    assert is_watertight(knot)
    assert degenerate_faces(knot) == 0
    center = knot.vertices.reshape(900, 60, 3).mean(axis=1)
    assert np.allclose(np.linalg.norm(knot.vertices.reshape(900, 60, 3) - center[:, np.newaxis], axis=2), 0.1)
    # Pappus: the volume of a tube is its section times the length of its middle line.
    length = np.linalg.norm(np.roll(center, -1, axis=0) - center, axis=1).sum()
    assert enclosed(knot) == pytest.approx(np.pi * 0.1**2 * length, rel=0.005)
    assert np.allclose(np.linalg.norm(knot.normals, axis=1), 1)
    assert np.allclose(
        knot.normals, (knot.vertices.reshape(900, 60, 3) - center[:, np.newaxis]).reshape(-1, 3) / 0.1
    )


def test_default_knot_has_twenty_thousand_faces():
    assert len(rw.scenes.torus_knot().faces) == 20_000


def test_cornell_box_has_its_measures():
    scene, camera = rw.scenes.cornell_box(width=32, height=24)
    assert np.allclose(scene.bounds, [(0, 0, 0), (556, 548.8, 559.2)], atol=1e-4)
    assert len(scene.shapes) == 8
    light = scene.shapes[0]
    assert sum(shape.emission is not None for shape in scene.shapes) == 1
    a, b, c = light.vertices[light.faces[0]]
    assert np.linalg.norm(np.cross(b - a, c - a)) == pytest.approx(130 * 105)
    assert (camera.width, camera.height) == (32, 24)
    assert camera.position == (278.0, 273.0, -800.0)
    assert camera.fov == pytest.approx(39.3077, abs=1e-4)


def test_cornell_colors_are_those_of_the_spectra():
    """Whatever made them of the spectra, a weighted mean lies between the least and the greatest value."""
    shapes = rw.scenes.cornell_box()[0].shapes
    white, red, green = (shapes[i].material.reflectance for i in (1, 5, 4))
    assert np.ptp(white) < 0.01
    assert red[0] > 5 * max(red[1:])
    assert green[1] > 4 * max(green[0], green[2])
    for color, least, greatest in ((white, 0.70, 0.78), (red, 0.039, 0.657), (green, 0.081, 0.482)):
        assert least < min(color)
        assert max(color) < greatest
    light = shapes[0]
    assert light.material.reflectance == (0.78,) * 3
    # The lamp emits more at longer wavelengths.
    assert 18.4 > light.emission[0] > light.emission[1] > light.emission[2] > 0


def test_cornell_box_faces_look_into_the_room():
    scene, _ = rw.scenes.cornell_box()
    inside = np.array((278.0, 400.0, 60.0))
    for shape in scene.shapes[:6]:
        a, b, c = (shape.vertices[shape.faces[:, i]] for i in range(3))
        assert (((inside - a) * np.cross(b - a, c - a)).sum(axis=1) > 0).all()


@pytest.mark.parametrize("block", [6, 7])
def test_cornell_blocks_look_outwards_and_stand_on_the_floor(block):
    mesh = rw.scenes.cornell_box()[0].shapes[block]
    middle = mesh.vertices.mean(axis=0)
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    assert (((a - middle) * np.cross(b - a, c - a)).sum(axis=1) > 0).all()
    assert mesh.bounds[0, 1] == 0


def test_cornell_box_is_closed_but_for_its_front():
    scene, _ = rw.scenes.cornell_box()
    directions = np.random.default_rng(7).normal(size=(20_000, 3))
    hits = scene.intersect((278, 500, 280), directions)
    out = directions[~hits.hit]
    assert len(out) > 0
    assert (out[:, 2] < 0).all()
    # Up through the middle of the light and of the ceiling: each finds its own.
    up = scene.intersect([(278, 400, 280), (278, 400, 100)], (0, 1, 0))
    assert up.shape_id.tolist() == [0, 2]


def test_red_is_left_and_green_is_right():
    scene, camera = rw.scenes.cornell_box(width=16, height=16)
    hits = scene.intersect(*camera.rays())
    left, right = (scene.shapes[hits.shape_id[8, column]].material.reflectance for column in (1, 14))
    assert left[0] > 3 * left[1]
    assert right[1] > 3 * right[0]


def test_a_mesh_stands_in_for_the_short_block():
    knot = rw.scenes.torus_knot(along=60, around=8).transformed(np.diag([1e-3, 1e-3, 1e-3, 1]))
    scene, _ = rw.scenes.cornell_box(mesh=[knot])
    low, high = scene.shapes[7].bounds
    assert low[1] == pytest.approx(0, abs=1e-9)
    assert (high - low).max() == pytest.approx(230, rel=0.15)
    assert (low > (50, -1, 40)).all()
    assert (high < (310, 300, 300)).all()


@pytest.mark.parametrize("mesh", [rw.Mesh([], []), rw.Mesh(np.ones((3, 3)), [(0, 1, 2)])])
def test_a_mesh_without_size_cannot_stand(mesh):
    with pytest.raises(ValueError, match=r"mesh (holds no faces|is a single point)"):
        rw.scenes.cornell_box(mesh=mesh)


@pytest.mark.parametrize("up", ["y", "z"])
@pytest.mark.parametrize("size", [(64, 48), (30, 90), (200, 20)])
@pytest.mark.parametrize(
    "matrix", [np.diag([1.0, 1, 1, 1]), np.diag([1e-6, 3e-6, 1e-6, 1]), np.diag([1e7, 1e6, 1e3, 1])]
)
def test_studio_frames_any_mesh(box, up, size, matrix):
    mesh = box.transformed(matrix)
    scene, camera = rw.scenes.studio(mesh, up, *size)
    assert scene.shapes[0] == mesh
    assert camera.up == {"y": (0, 1, 0), "z": (0, 0, 1)}[up]
    seen = scene.intersect(*camera.rays()).shape_id == 0
    assert seen.any()
    # All of it is in the picture, and it fills a good part of one side.
    border = np.concatenate([seen[0], seen[-1], seen[:, 0], seen[:, -1]])
    assert not border.any()
    assert max(np.ptp(where) / n for where, n in zip(np.nonzero(seen), seen.shape, strict=True)) > 0.3


def test_studio_frames_copies_where_they_stand_and_go(box):
    matrices = np.tile(np.eye(4), (3, 1, 1))
    matrices[:, 0, 3] = 0, 4, 9
    ends = matrices.copy()
    ends[2, 1, 3] = 5
    scene, camera = rw.scenes.studio(rw.Instance([box, rw.Sphere((0, 0, 0), 0.5)], matrices, ends))
    for time in (0.0, 1.0):
        hits = scene.intersect(*camera.rays(), time=time)
        seen = hits.shape_id == 0
        assert set(hits.instance_id[seen]) == {0, 1, 2}
        border = np.concatenate([seen[0], seen[-1], seen[:, 0], seen[:, -1]])
        assert not border.any()


def test_studio_puts_a_floor_under_and_a_lamp_above(box):
    scene, camera = rw.scenes.studio(box)
    floor, lamp = scene.shapes[-2:]
    assert -1e-3 < floor.bounds[1, 1] < 0
    assert lamp.bounds[0, 1] > 1.5
    assert lamp.emission[0] > 0
    middle = lamp.vertices.mean(axis=0)
    a, b, c = lamp.vertices[lamp.faces[0]]
    assert np.dot(np.cross(b - a, c - a), (0.5, 0.5, 0.5) - middle) > 0
    assert not (scene.intersect(*camera.rays()).shape_id == 2).any()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: rw.scenes.studio([]), "there are no faces to show"),
        (
            lambda: rw.scenes.studio(rw.scenes.torus_knot(along=9, around=3), up="x"),
            "up must be 'y' or 'z', got 'x'",
        ),
        (lambda: rw.scenes.torus_knot(p=0), "p must be at least 1, got 0"),
        (lambda: rw.scenes.torus_knot(around=2), "around must be at least 3, got 2"),
        (lambda: rw.scenes.torus_knot(tube=0), "tube must be greater than 0, got 0"),
        (lambda: rw.scenes.cornell_box(width=0), "width must be between 1 and 65536, got 0"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()


def test_topology_tells_open_from_closed(box, triangle):
    assert is_watertight(box)
    assert not is_watertight(triangle)
    assert not is_watertight(rw.Mesh([], []))
    assert not is_watertight(rw.Mesh(box.vertices, box.faces[:-1]))
    turned = box.faces.copy()
    turned[0] = turned[0, ::-1]
    assert not is_watertight(rw.Mesh(box.vertices, turned))
    split = rw.Mesh(box.vertices[box.faces].reshape(-1, 3), np.arange(36).reshape(-1, 3))
    assert is_watertight(split)


def test_degenerate_faces_are_counted():
    vertices = [(0, 0, 0), (1, 0, 0), (2, 0, 0), (0, 1, 0), (np.nan, 0, 0)]
    mesh = rw.Mesh(vertices, [(0, 1, 3), (0, 1, 2), (0, 0, 3), (0, 1, 4)])
    assert degenerate_faces(mesh) == 3
