"""Faces that exchange nothing of their own: without area, not finite, or where others are."""

import numpy as np
import pytest
from radiosity_scenes import room
from test_view_factors import inward_box
from test_view_factors_estimates import block

import raywright as rw

SIZE = (6, 5, 3)
CLOSED = block((0, 0, 0), SIZE, inwards=True)
FLOOR = np.array([(0, 0, 0), (6, 0, 0), (6, 5, 0), (0, 5, 0)], float)
# The floor once more: the same, cut along the other diagonal, in four parts, and reversed.
TWICE = {
    "the same": rw.Mesh(FLOOR, [(0, 1, 2), (0, 2, 3)]),
    "other diagonal": rw.Mesh(FLOOR, [(0, 1, 3), (1, 2, 3)]),
    "finer": rw.Mesh([*FLOOR, (3, 2.5, 0)], [(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]),
    "turned": rw.Mesh(FLOOR, [(1, 2, 0), (3, 0, 2)]),
}


@pytest.mark.parametrize("how", TWICE)
def test_a_wall_listed_twice_is_one(how: str) -> None:
    scene = rw.Scene([CLOSED, TWICE[how]])
    once = rw.view_factors(rw.Scene([CLOSED]), progress=False)
    count = len(TWICE[how].faces)
    with pytest.warns(RuntimeWarning, match=rf"{count} of {12 + count} faces coincide with others"):
        found = rw.view_factors(scene, progress=False)
    np.testing.assert_allclose(found.matrix[:12, :12], once.matrix, rtol=1e-12)
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    assert found.dropped == count
    assert not found.areas[12:].any()
    assert not found.matrix[:, 12:].any()
    with pytest.warns(RuntimeWarning, match="coincide"):
        shapes = rw.view_factors(scene, per="shape", progress=False)
    np.testing.assert_allclose(shapes.to_surroundings, 0, atol=1e-9)
    for method in ("matrix", "stochastic"):
        with pytest.warns(RuntimeWarning, match="coincide"):
            even = rw.radiative_exchange(scene, 300.0, 0.9, method=method, rays=2**12, progress=False)  # type: ignore[arg-type]
        assert even.dropped == count
        assert np.abs(even.flux).max() < 1e-6 + 5 * even.standard_error.max()
    with pytest.warns(RuntimeWarning, match="coincide"):
        warm = rw.radiative_exchange(scene, [300.0, 300.0], [0.9, 0.5], method="matrix", progress=False)
    assert np.abs(warm.flux).max() < 1e-6


def test_shapes_listed_twice_are_one() -> None:
    ball = rw.Sphere((3, 2, 1.5), 0.5)
    once = rw.view_factors(rw.Scene([CLOSED, ball]), per="shape", progress=False)
    with pytest.warns(RuntimeWarning, match=r"shapes\[2\] first, with face 0 of shapes\[1\]"):
        twice = rw.view_factors(
            rw.Scene([CLOSED, ball, rw.Sphere((3, 2, 1.5), 0.5, material=rw.Diffuse(0.1))]),
            per="shape",
            progress=False,
        )
    np.testing.assert_allclose(twice.matrix[:2, :2], once.matrix, atol=1e-12)
    np.testing.assert_allclose(twice.matrix[2], twice.matrix[1])


def test_faces_that_overlap_in_part_are_told() -> None:
    beside = rw.Mesh(FLOOR + np.array((3, 0, 0)), [(0, 1, 2), (0, 2, 3)])
    with pytest.warns(RuntimeWarning, match=r"2 of 14 faces partly overlap coplanar faces"):
        rw.view_factors(rw.Scene([CLOSED, beside]), progress=False)


def test_neighbors_and_the_other_side_do_not_coincide() -> None:
    back = rw.Mesh(CLOSED.vertices, CLOSED.faces[:, ::-1])
    found = rw.view_factors(rw.Scene([CLOSED, back]), progress=False)
    np.testing.assert_allclose(found.to_surroundings[:12], 0, atol=1e-9)
    assert not found.matrix[12:].any()
    assert found.dropped == 0


@pytest.mark.parametrize("is_first", [True, False])
def test_rays_meet_the_front_of_a_sheet_whichever_side_is_listed_first(is_first: bool) -> None:
    back = rw.Mesh(CLOSED.vertices, CLOSED.faces[:, ::-1])
    walls = [CLOSED, back] if is_first else [back, CLOSED]
    inside = 0 if is_first else 1
    even = rw.radiative_exchange(
        rw.Scene(walls), [300.0, 300.0], 0.9, method="stochastic", rays=2**14, progress=False
    )
    # The inside loses nothing, and the outside everything.
    sent = 5.670374419184429e-8 * 300.0**4
    outer = even.areas[even.patches["shape"] != inside].sum()
    assert even.escaped == pytest.approx(0.9 * sent * outer, rel=1e-9)
    assert abs(even.of(inside)) < 1e-4 * sent
    found = rw.view_factors(rw.Scene([*walls, rw.Sphere((3, 2, 1.5), 0.5)]), per="shape", progress=False)
    np.testing.assert_allclose(found.to_surroundings[[inside, 2]], 0, atol=1e-9)


def test_shots_from_faces_that_touch_come_to_each_other() -> None:
    scene = rw.Scene([CLOSED, block((1, 1, 0), (1, 1, 1))])
    even = rw.radiative_exchange(scene, 300.0, 0.9, method="stochastic", rays=2**14, progress=False)
    assert abs(even.escaped) < 1e-9
    assert np.abs(even.flux).max() < 1e-6
    # A warm block heats the room: nothing passes where it stands.
    warm = rw.radiative_exchange(scene, [300.0, 350.0], 0.9, method="stochastic", rays=2**14, progress=False)
    matrix = rw.radiative_exchange(scene, [300.0, 350.0], 0.9, method="matrix", progress=False)
    assert abs(warm.power.sum()) < 1e-4 * warm.of(1)
    assert warm.of(1) == pytest.approx(matrix.of(1), rel=0.03)


def test_radiosity_of_a_wall_listed_twice_is_that_of_one() -> None:
    scene = room(0.6, (1, 0, 0, 0, 0, 0))
    doubled = rw.Scene([*scene.shapes, scene.shapes[0], scene.shapes[3]])
    once = rw.radiosity(scene, method="matrix", patch_size=0.8, progress=False)
    with pytest.warns(RuntimeWarning, match="4 of 16 faces coincide"):
        twice = rw.radiosity(doubled, method="matrix", patch_size=0.8, progress=False)
    assert twice.dropped == 4
    np.testing.assert_allclose(twice.radiosity[: len(once)], once.radiosity, rtol=1e-9)
    mean = np.average(once.radiosity[once.patches["shape"] == 3], axis=0)
    np.testing.assert_allclose(twice.radiosity[twice.patches["shape"] == 7].mean(axis=0), mean, rtol=1e-9)
    np.testing.assert_allclose(twice.emitted, once.emitted)
    with pytest.warns(RuntimeWarning, match="coincide"):
        rays = rw.radiosity(doubled, rays=2**14, progress=False)
    assert rays.surface_area == pytest.approx(8)
    camera = rw.Camera((0.5, 0.5, 0.5), (0, 0.5, 0.5), fov=60.0, width=8, height=8)
    image = rw.render(doubled, camera, rw.Radiosity(rays), 4, progress=False)
    assert (image.rgb > 0).all()


def test_faces_without_area_are_dropped_everywhere() -> None:
    scene = room(0.6, (1, 0, 0, 0, 0, 0))
    wall = scene.shapes[2]
    corners = [*wall.vertices, (0.5, 0.5, 0.5)]
    count = len(wall.vertices)
    bad = rw.Mesh(
        corners,
        [*wall.faces, (0, 1, 1), (count, count, count)],
        material=wall.material,
        emission=wall.emission,
    )
    flawed = rw.Scene([*scene.shapes[:2], bad, *scene.shapes[3:]])
    assert rw.view_factors(flawed, progress=False).dropped == 2
    for method in ("matrix", "stochastic", "progressive"):
        clean, found = (
            rw.radiosity(of, method=method, rays=2**14, sides="front", progress=False)  # type: ignore[arg-type]
            for of in (scene, flawed)
        )
        assert found.dropped == 2
        assert np.isfinite(found.radiosity).all()
        assert not found.areas[found.areas == 0].any()
        np.testing.assert_allclose(found.emitted, clean.emitted, rtol=1e-9)
    for method in ("matrix", "stochastic"):
        exchange = rw.radiative_exchange(
            flawed, [400.0] + [300.0] * 5, 0.8, method=method, rays=2**12, progress=False
        )  # type: ignore[arg-type]
        assert exchange.dropped == 2
        assert np.isfinite(exchange.flux).all()
        assert not exchange.flux[exchange.areas == 0].any()


def test_faces_that_are_not_finite_are_dropped_with_the_scene_s_warning() -> None:
    wall = CLOSED
    bad = rw.Mesh([*wall.vertices, (np.nan, 0, 0)], [*wall.faces, (0, 1, 8)])
    for call in (rw.view_factors, lambda of, **how: rw.radiative_exchange(of, 300.0, **how)):
        with pytest.warns(RuntimeWarning, match="1 of 13 faces were dropped"):
            found = call(rw.Scene([bad]), progress=False)
        assert found.dropped == 1


SHEET = np.array([(0.2, 0.3, 0.5), (0.8, 0.3, 0.5), (0.8, 0.7, 0.5), (0.2, 0.7, 0.5)])


def sheets(low: float = 0.5, other: bool = False, shines: float = 0.0) -> list[rw.Mesh]:
    """Both sides of a sheet: the upper one, and a darker lower one, cut along either diagonal."""
    emission = rw.Emission(shines, both_sides=True) if shines else None
    lower = np.column_stack([SHEET[:, :2], np.full(4, low)])
    down = [(0, 3, 1), (1, 3, 2)] if other else [(0, 2, 1), (0, 3, 2)]
    return [
        rw.Mesh(SHEET, [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(0.8), emission=emission),
        rw.Mesh(lower, down, material=rw.Diffuse(0.2), emission=emission),
    ]


@pytest.mark.parametrize("other", [False, True])
def test_both_sides_of_a_sheet_are_those_of_one_face(other: bool) -> None:
    walls = room(0.6, (1, 0, 0, 0, 0, 0)).shapes
    found, apart = (
        rw.radiosity(rw.Scene([*walls, *sheets(low, other)]), rays=2**17, progress=False)
        for low in (0.5, 0.499)
    )
    assert found.dropped == 2
    assert found.areas.sum() == pytest.approx(2 * (6 + 0.24))
    assert found.surface_area == pytest.approx(6 + 2 * 0.24)
    rows = found.patches
    side = {
        (shape, way): found.irradiance[(rows["shape"] == shape) & (rows["side"] == way)].mean()
        for shape in (6, 7)
        for way in (1, -1)
    }
    # The front of each is the back of the other, and has its own reflectance.
    assert side[6, 1] == pytest.approx(side[7, -1], rel=1e-12)
    assert side[7, 1] == pytest.approx(side[6, -1], rel=1e-12)
    assert set(found.reflectance[(rows["shape"] == 6) & (rows["side"] == -1)][:, 0]) == {0.2}
    for shape in range(8):
        at = (rows["shape"] == shape) & (rows["side"] == 1)
        # Means of both, of some 10,000 rays each.
        assert found.irradiance[at].mean() == pytest.approx(apart.irradiance[at].mean(), rel=0.03)


def test_a_sheet_that_shines_on_both_sides_sends_as_much_as_one_face() -> None:
    walls = room(0.6, (0,) * 6).shapes
    once, twice = (
        rw.radiosity(rw.Scene([*walls, *sheets(shines=2.0)[:count]]), rays=2**14, progress=False)
        for count in (1, 2)
    )
    np.testing.assert_allclose(twice.emitted, once.emitted, rtol=1e-12)


def test_sides_of_a_sheet_keep_their_temperatures() -> None:
    walls = room(0.6, (0,) * 6).shapes
    kelvin, gray = [300.0] * 6 + [400.0, 350.0], [0.9] * 6 + [0.8, 0.6]
    found, apart = (
        rw.radiative_exchange(
            rw.Scene([*walls, *sheets(low)]), kelvin, gray, rays=2**16, sides="both", progress=False
        )
        for low in (0.5, 0.4999)
    )
    rows = found.patches
    for shape in range(8):
        at = (rows["shape"] == shape) & (rows["side"] == 1)
        # None of 16 faces is beyond 5.5 errors, except in 6e-7 of cases; 0.5 covers the loss through a gap of
        # 1e-4.
        errors = 5.5 * np.hypot(found.standard_error[at], apart.standard_error[at])
        assert (np.abs(found.flux[at] - apart.flux[at]) < errors + 0.5).all()
    above, below = ((rows["shape"] == shape) & (rows["side"] == -1) for shape in (7, 6))
    assert set(found.temperature[above]) == {400.0}
    assert set(found.temperature[below]) == {350.0}
    # Nothing counts twice: all lost power is gained, or leaves by the backs of the walls.
    assert found.power.sum() == pytest.approx(found.escaped, rel=1e-6)


def test_what_touches_in_a_corner_hides_what_lies_within() -> None:
    # Floor and walls of fine faces, some wholly beneath and behind the box: within it they see nothing.
    sides = inward_box((2, 2, 2), 4)
    found = rw.view_factors(rw.Scene([*sides, block((0, 0, 0), (1, 1, 1))]), rays=16, progress=False)
    centers = np.concatenate([side.vertices[side.faces].mean(axis=1) for side in sides])
    within = np.flatnonzero((centers < 1).all(axis=1))
    assert len(within) == 3 * 8
    assert (found.matrix[within, :192] <= 3 * found.standard_error[within, :192] + 1e-9).all()
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)


# A turn about an axis along no face.
TURN = np.array([[0.6, -0.64, 0.48], [0.8, 0.48, -0.36], [0.0, 0.6, 0.8]])

CONTACTS = {
    "on the floor": [block((1, 1, 0), (1, 1, 1))],
    "in a corner": [block((0, 0, 0), (1, 1, 1))],
    "beside each other": [block((1, 1, 0), (1, 1, 1)), block((2, 1, 0), (1, 1, 1))],
    "one on the other": [block((1, 1, 0), (1, 1, 1)), block((1.2, 1.2, 1), (0.5, 0.5, 0.5))],
    "from floor to ceiling": [block((2, 2, 0), (1, 1, 3))],
    "all over the floor": [block((0, 0, 0), (6, 5, 0.2))],
}


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("name", CONTACTS)
def test_faces_that_touch_tell_their_errors_also_where_corners_are_rounded(name: str, dtype: type) -> None:
    shapes = [*inward_box((6, 5, 3), 1), *CONTACTS[name]]

    def placed(turn: np.ndarray) -> rw.Scene:
        turned = (np.array(mesh.vertices @ turn.T, dtype) for mesh in shapes)
        return rw.Scene([rw.Mesh(v, mesh.faces) for v, mesh in zip(turned, shapes, strict=True)])

    straight = rw.view_factors(placed(np.eye(3)), rays=256, seed=1, progress=False)
    turned = rw.view_factors(placed(TURN), rays=64, seed=2, progress=False)
    np.testing.assert_allclose(straight.to_surroundings, 0, atol=1e-9)
    np.testing.assert_allclose(turned.to_surroundings, 0, atol=1e-9 if dtype is np.float64 else 3e-4)
    # One of 400 pairs is beyond six standard errors once in a million cases, if these were exact.
    off = np.abs(straight.matrix - turned.matrix)
    told = np.hypot(straight.standard_error, turned.standard_error)
    assert (off <= 6 * told + (1e-9 if dtype is np.float64 else 1e-5)).all()
    exchange = rw.radiative_exchange(placed(TURN), 300.0, 0.9, progress=False)
    assert np.abs(exchange.flux).max() < (1e-5 if dtype is np.float64 else 0.02)


def test_rounded_solids_that_overlap_are_done_soon() -> None:
    # A corner of one face lies 7e-8 in front of another, beside a part of that which is 9e-8 wide and 2 long.
    shapes = [*inward_box((6, 5, 3), 1), block((1, 1, 0), (2, 2, 1)), block((2, 1, 0), (3, 2, 1))]
    turned = [rw.Mesh(np.array(mesh.vertices @ TURN.T, np.float32), mesh.faces) for mesh in shapes]
    with pytest.warns(RuntimeWarning, match="partly overlap coplanar faces"):
        found = rw.view_factors(rw.Scene(turned), rays=16, progress=False)
    assert ((found.matrix >= 0) & (found.matrix <= 1)).all()


def test_faces_that_rounding_alone_could_part_still_see_each_other() -> None:
    # Two sheets face each other, closer than float32 can resolve at their size.
    square = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
    above = square + np.array([0, 0, 1e-7], np.float32)
    sheets = [rw.Mesh(square, [(0, 1, 2), (0, 2, 3)]), rw.Mesh(above, [(0, 2, 1), (0, 3, 2)])]
    found = rw.view_factors(rw.Scene(sheets), per="shape", progress=False)
    np.testing.assert_allclose(found.matrix, [(0, 1), (1, 0)], atol=1e-6)
