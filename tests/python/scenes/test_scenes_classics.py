"""The scenes on which accelerators are compared: what they are made of, and that they stay the same."""

import numpy as np
import pytest

import raywright as rw
from raywright.shapes.topology import degenerate_faces, is_watertight

SCENES = rw.scenes
MADE = {
    "stadium": lambda seed: SCENES.teapot_in_stadium(4, 3, 12),
    "terrain": lambda seed: SCENES.terrain(10, 200, seed),
    "wall": lambda seed: SCENES.diagonal_wall(30),
    "soup": lambda seed: SCENES.soup(200, seed=seed),
    "city": lambda seed: SCENES.city(3, seed),
    "room": lambda seed: SCENES.room(1200, seed),
    "forest": lambda seed: SCENES.forest(5, 2, 500, seed=seed).meshes(),
}


def corners(mesh):
    return mesh.vertices[mesh.faces].astype(np.float64)


def areas(mesh):
    a, b, c = np.moveaxis(corners(mesh), 1, 0)
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


@pytest.mark.parametrize("name", MADE)
def test_the_same_seed_makes_the_same_scene_and_another_another(name):
    once = MADE[name](0)
    assert isinstance(once, list)
    assert once == MADE[name](0)
    assert (once == MADE[name](1)) == (name in ("stadium", "wall"))
    assert sum(map(degenerate_faces, once)) == 0
    assert rw.Scene(once).accelerator_info.primitives == sum(len(mesh.faces) for mesh in once)


# The stadium.


@pytest.mark.parametrize(("divisions", "tiers", "around"), [(2, 1, 3), (5, 4, 7)])
def test_a_stadium_is_a_field_of_tiers_a_wall_a_roof_and_a_teapot(divisions, tiers, around):
    hall, pot = SCENES.teapot_in_stadium(divisions, tiers, around, width=0.5)
    # A step and a seat for each tier, then the wall and the roof.
    assert len(hall.faces) == around * (1 + 2 * (2 * tiers + 2))
    assert len(pot.faces) == len(SCENES.teapot(divisions).faces)
    assert np.ptp(pot.bounds[:, 0]) == pytest.approx(0.5)
    assert pot.bounds[0, 1] == hall.bounds[0, 1] == 0


def test_a_stadium_is_open_only_above_and_seen_from_inside():
    scene = rw.Scene(SCENES.teapot_in_stadium(4, 10, 48))
    directions = np.random.default_rng(2).normal(size=(20_000, 3))
    hits = scene.intersect((3, 4, -2), directions)
    assert (directions[~hits.hit][:, 1] > 0).all()
    hall = hits.shape_id == 0
    assert (np.sum(hits.normal[hall] * directions[hall], axis=1) < 0).all()
    # All detail in one place: half of the faces in a ten millionth of the room.
    rooms = [np.ptp(shape.bounds, axis=0).prod() for shape in scene.shapes]
    assert rooms[1] < 1e-7 * rooms[0]


# Terrain.


def test_the_ground_is_a_square_of_hills_that_look_up():
    (ground,) = SCENES.terrain(20, 0, seed=3)
    assert len(ground.faces) == 2 * 20**2
    assert np.allclose(ground.bounds, [(-50, 0, -50), (50, 6, 50)])
    a, b, c = np.moveaxis(corners(ground), 1, 0)
    assert (np.cross(b - a, c - a)[:, 1] > 0).all()


def test_grass_stands_on_the_ground_one_blade_a_cell():
    ground, grass = SCENES.terrain(20, 900, seed=3)
    assert len(grass.faces) == 900
    feet = corners(grass)[:, :2].mean(axis=1)
    assert (corners(grass)[:, 2, 1] > feet[:, 1]).all()
    below = rw.Scene(ground, precision="double").intersect(feet + np.array([0, 10, 0]), (0, -1, 0))
    assert np.allclose(below.t, 10, atol=1e-9)
    cells = np.floor((feet[:, [0, 2]] + 50) * 30 / 100).astype(int)
    assert len(np.unique(cells, axis=0)) == 900
    assert len(SCENES.terrain(20, 901)[1].faces) == 901


# The wall.


def test_a_straight_wall_fills_the_boxes_of_its_boards_and_a_diagonal_one_does_not():
    def filled(angle):
        boards = SCENES.diagonal_wall(40, angle)[0].vertices.reshape(-1, 8, 3)
        return np.ptp(boards, axis=1).prod(axis=1)

    straight, diagonal = filled(0), filled(45)
    assert len(straight) == 40
    # Ten long, half a unit wide and apart, 0.04 thick.
    assert np.allclose(straight, 10 * 0.5 * 0.04)
    assert np.allclose(diagonal, (10.5**2 / 2) * 0.04)


def test_a_wall_turns_about_its_normal():
    straight, diagonal = SCENES.diagonal_wall(17, 0), SCENES.diagonal_wall(17, 30)
    (expected,) = SCENES.turned(straight, 30, (0, 0, 2))
    assert np.allclose(diagonal[0].vertices, expected.vertices)
    assert np.array_equal(diagonal[0].faces, expected.faces)
    assert np.allclose(straight[0].bounds[:, :2], [(-5, -5), (5, 5)])


# Soup.


def test_soup_is_of_any_triangles_and_a_ray_sees_a_third_of_its_cube():
    (mesh,) = SCENES.soup(20_000, seed=1)
    assert len(mesh.faces) == 20_000
    middle = corners(mesh).mean(axis=1)
    assert np.abs(middle.mean(axis=0) - 0.5).max() < 0.02
    p, q = np.random.default_rng(5).uniform(0.2, 0.8, (2, 4000, 3))
    crossings = rw.Scene(mesh).count_hits(p, q - p, t_max=1.0)
    assert crossings.sum() / np.linalg.norm(q - p, axis=1).sum() == pytest.approx(3, rel=0.1)
    (tiny,) = SCENES.soup(50, size=1e-3)
    assert np.ptp(corners(tiny), axis=1).max() <= 2e-3


# City and room.


def test_a_city_has_closed_houses_on_a_ground_with_streets_between():
    ground, houses = SCENES.city(3, seed=2)
    assert len(ground.faces) == 2
    assert len(houses.faces) == 3**2 * 9 * 5 * 12
    assert is_watertight(houses)
    assert ground.bounds[:, 1].tolist() == [0, 0]
    assert houses.bounds[0, 1] == 0
    assert np.ptp(ground.bounds, axis=0).tolist() == [234, 0, 234]
    # The middle of a street shows nothing but ground.
    line = np.linspace(-110, 110, 200)
    above = np.stack([np.full(200, 39.0), np.full(200, 500.0), line], axis=1)
    assert (rw.Scene([ground, houses]).intersect(above, (0, -1, 0)).shape_id == 0).all()


def test_a_city_is_higher_in_the_center():
    houses = SCENES.city(9, seed=2)[1]
    boxes = houses.vertices.reshape(-1, 5, 8, 3)
    top, away = boxes[..., 1].max(axis=(1, 2)), np.linalg.norm(boxes[:, 0, :, [0, 2]].mean(axis=-1), axis=0)
    assert top[away < 100].mean() > 3 * top[away > 300].mean()


@pytest.mark.parametrize("triangles", [1, 1200, 5000])
def test_a_room_is_of_boxes_and_closed(triangles):
    (mesh,) = SCENES.room(triangles)
    assert len(mesh.faces) == 12 * max(triangles // 12, 8)
    assert mesh.vertices.dtype == np.float32
    a, b, c = np.moveaxis(corners(mesh).reshape(-1, 12, 3, 3), 2, 0)
    volumes = (a * np.cross(b, c)).sum(axis=(1, 2)) / 6
    assert (volumes > 0).all()
    directions = np.random.default_rng(3).normal(size=(5000, 3))
    assert rw.Scene(mesh).occluded((0.4, 1.65, 4.65), directions).all()


# The forest.


def test_a_forest_has_a_billion_triangles_of_a_hundred_thousand():
    forest = SCENES.forest()
    assert forest.triangles == 10**9
    assert sum(len(tree.faces) for tree in forest.trees) == 10**5
    assert forest.transforms.shape == (10**5, 4, 4)
    assert forest.transforms.nbytes + forest.tree.nbytes < 15e6


def test_trees_stand_upright_one_in_a_square_turned_and_scaled():
    forest = SCENES.forest(100, 3, 401, spacing=2.0, seed=6)
    assert [len(tree.faces) for tree in forest.trees] == [401] * 3
    assert set(forest.tree) == {0, 1, 2}
    linear, place = forest.transforms[:, :3, :3], forest.transforms[:, :3, 3]
    size = np.linalg.det(linear) ** (1 / 3)
    assert 0.7 <= size.min() < size.max() <= 1.3
    square = np.einsum("nji,njk->nik", linear, linear)
    assert np.allclose(square, size[:, None, None] ** 2 * np.eye(3))
    assert np.allclose(linear[:, 1], size[:, None] * [0, 1, 0])
    cells = np.floor(place / 2).astype(int)
    assert len(np.unique(cells, axis=0)) == 100
    assert (place[:, 1] == 0).all()
    meshes = forest.meshes()
    assert sum(len(mesh.faces) for mesh in meshes) == forest.triangles
    foot = meshes[7].vertices[:5].mean(axis=0)
    assert np.allclose(foot, place[7], atol=1e-12)


# Rotations, and all scenes.


@pytest.mark.parametrize("axis", [(0, 1, 0), (1, -2, 3), (0, 0, 1e-300)])
def test_turning_keeps_lengths_and_the_axis(axis):
    (mesh,) = SCENES.soup(20)
    (after,) = SCENES.turned([mesh], 33.0, axis)
    assert np.allclose(np.linalg.norm(after.vertices, axis=1), np.linalg.norm(mesh.vertices, axis=1))
    unit = np.array(axis) / max(map(abs, axis))
    assert np.allclose(after.vertices @ unit, mesh.vertices @ unit)
    (back,) = SCENES.turned([after], -33.0, axis)
    assert np.allclose(back.vertices, mesh.vertices)


def test_a_quarter_turn_about_y_takes_x_to_minus_z():
    (after,) = SCENES.turned([rw.Mesh([(1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 1, 2)])], 90)
    assert np.allclose(after.vertices, [(0, 0, -1), (0, 1, 0), (1, 0, 0)])


def test_classics_have_about_as_many_triangles_as_asked_for_and_a_view():
    made = SCENES.classics(20_000, width=24, height=24)
    assert len(made) == 9
    for name, (scene, camera) in made.items():
        meshes = [mesh for shape in scene.shapes for mesh in getattr(shape, "shapes", (shape,))]
        assert sum(len(mesh.faces) for mesh in meshes) == pytest.approx(20_000, rel=0.1), name
        assert scene.intersect(*camera.rays()).hit.mean() > 0.2, name
    assert made == SCENES.classics(20_000, width=24, height=24)
    # Every shape of a scene is in the picture.
    scene, camera = made["stadium"]
    assert set(scene.intersect(*camera.rays()).shape_id.reshape(-1)) >= {0, 1}


def test_the_turned_room_is_the_same_room():
    made = SCENES.classics(3000, width=40, height=30)
    straight, turned = (s.intersect(*c.rays()) for s, c in (made["room"], made["turned_room"]))
    # Except for pixels at an edge, where rounding decides.
    assert (straight.primitive_id == turned.primitive_id).mean() > 0.98
    same = straight.primitive_id == turned.primitive_id
    assert np.allclose(straight.t[same], turned.t[same], rtol=1e-4)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: SCENES.teapot_in_stadium(around=2), "around must be at least 3, got 2"),
        (lambda: SCENES.teapot_in_stadium(width=0), "width must be greater than 0, got 0"),
        (lambda: SCENES.terrain(side=0), "side must be at least 1, got 0"),
        (lambda: SCENES.terrain(blades=-1), "blades must be at least 0, got -1"),
        (lambda: SCENES.diagonal_wall(3, layers=4), "boards must be at least 4, got 3"),
        (lambda: SCENES.diagonal_wall(angle=np.nan), "angle must be finite, got nan"),
        (lambda: SCENES.soup(0), "triangles must be at least 1, got 0"),
        (lambda: SCENES.soup(size=-1), "size must be greater than 0, got -1"),
        (lambda: SCENES.city(0), "blocks must be at least 1, got 0"),
        (lambda: SCENES.room(seed=-1), "seed must be at least 0, got -1"),
        (lambda: SCENES.forest(triangles=400), "triangles must be at least 401, got 400"),
        (lambda: SCENES.turned([], 5, (0, 0, 0)), "axis must not be zero"),
        (lambda: SCENES.classics(999), "triangles must be at least 1000, got 999"),
    ],
)
def test_bad_arguments_are_refused(call, message):
    with pytest.raises(ValueError, match=message):
        call()
