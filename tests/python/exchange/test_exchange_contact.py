"""Shapes that are no meshes and touch others: what lies on a face exchanges light with that alone.

The oracle is the same scene with the shape a hundred-thousandth off, where rays cross the gap.
"""

from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest
from test_view_factors import inward_box
from test_view_factors_estimates import block

import raywright as rw
from raywright.shapes import Shape

SIZE = (6, 5, 3)
SIDES = inward_box(SIZE, 1)
# A turn about an axis along no face, and maps that mirror and shear.
TURN = np.array([[0.6, -0.64, 0.48], [0.8, 0.48, -0.36], [0.0, 0.6, 0.8]])
HALF = np.diag([0.5, -0.5, 0.5, 1.0])
HALF[:3, 3] = 1, 2, 0
SHEAR = np.eye(4)
SHEAR[0, 2], SHEAR[:3, 3] = 0.4, (2, 2, 0)
LIFT = 1e-5
ABOVE = next(i for i, side in enumerate(SIDES) if (side.vertices[:, 2] == SIZE[2]).all())

# Each shape is lifted by the number of gaps below it.
CONTACTS: dict[str, list[rw.Mesh | Shape]] = {
    "box": [rw.Box((1, 1, 0), (2, 2, 1))],
    "mirrored box": [rw.Box((0, 0, 0), (2, 2, 2), transform=HALF)],
    "cylinder": [rw.Cylinder((2, 2, 0), (2, 2, 1), 0.5)],
    "cylinder upside down": [rw.Cylinder((2, 2, 1), (2, 2, 0), 0.5)],
    "sheared cylinder": [rw.Cylinder((0, 0, 0), (0, 0, 1), 0.5, transform=SHEAR)],
    "truncated cone": [rw.Cone((2, 2, 0), (2, 2, 1), 0.7, 0.2)],
    "paraboloid": [rw.shapes.Paraboloid((2, 2, 1), (2, 2, 0), 0.7, capped=True)],
    "stack": [
        rw.Cylinder((2, 2, 0), (2, 2, 1), 0.6),
        rw.Box((1.5, 1.5, 1), (2.5, 2.5, 1.5)),
        rw.Cone((2.2, 2, 1.5), (2.2, 2, 2), 0.3),
    ],
    "cylinder beyond the edge of a mesh": [
        block((1, 1, 0), (1, 1, 1)),
        rw.Cylinder((1.9, 1.5, 1), (1.9, 1.5, 2), 0.3),
    ],
    "mesh on a cylinder": [rw.Cylinder((2, 2, 0), (2, 2, 1), 0.6), block((1.7, 1.7, 1), (1.3, 1.3, 0.4))],
}
# Backs are black and seen from the room, which is open so.
SHEETS: dict[str, list[rw.Mesh | Shape]] = {
    "disk on a mesh": [block((1, 1, 0), (3, 3, 1)), rw.Disk((2.5, 2.5, 1), (0, 0, -1), 1.4)],
    "ring on a box": [rw.Box((1, 1, 0), (4, 4, 1)), rw.Disk((2.5, 2.5, 1), (0, 0, -1), 1.4, 0.4)],
    "polygon on a box": [
        rw.Box((1, 1, 0), (4, 4, 1)),
        rw.Polygon([(1.2, 1.2, 1), (1.2, 3.8, 1), (3.8, 3.8, 1), (3.8, 1.2, 1)]),
    ],
}


def moved(shape: rw.Mesh | Shape, matrix: np.ndarray, dtype: type = np.float64) -> rw.Mesh | Shape:
    if isinstance(shape, rw.Mesh):
        places = np.c_[shape.vertices, np.ones(len(shape.vertices))] @ matrix.T
        return rw.Mesh(places[:, :3].astype(dtype), shape.faces)
    values = {part.name: getattr(shape, part.name) for part in fields(shape)}
    own = values["transform"]
    return type(shape)(**values | {"transform": matrix if own is None else matrix @ own})


def turned(shapes: list[rw.Mesh | Shape], dtype: type = np.float64) -> rw.Scene:
    turn = np.eye(4)
    turn[:3, :3] = TURN
    return rw.Scene([moved(shape, turn, dtype) for shape in shapes])


def lifted(shapes: list[rw.Mesh | Shape]) -> list[rw.Mesh | Shape]:
    lifts = []
    for number in range(len(shapes)):
        lifts.append(np.eye(4))
        lifts[-1][2, 3] = LIFT * (number + 1)
    return [moved(shape, lift) for shape, lift in zip(shapes, lifts, strict=True)]


def as_it_is(shapes: list[rw.Mesh | Shape]) -> rw.Scene:
    return rw.Scene(shapes)


@pytest.mark.parametrize("placed", [as_it_is, turned, lambda shapes: turned(shapes, np.float32)])
@pytest.mark.parametrize("name", [*CONTACTS, *SHEETS])
def test_what_touches_is_as_what_is_next_to_touching(
    name: str, placed: Callable[[list[rw.Mesh | Shape]], rw.Scene]
) -> None:
    shapes = (CONTACTS | SHEETS)[name]
    found = rw.view_factors(placed([*SIDES, *shapes]), per="shape", rays=8, seed=1, progress=False)
    apart = [*SIDES, *lifted(shapes)]
    wanted = rw.view_factors(rw.Scene(apart), per="shape", rays=8, seed=2, progress=False)
    # One of 81 entries is beyond six standard errors in 1.6e-7 of cases; the gap itself transmits as much.
    told = np.hypot(found.standard_error, wanted.standard_error)
    assert (np.abs(found.matrix - wanted.matrix) <= 6 * told + 4 * LIFT).all()
    if name in CONTACTS:
        np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    else:
        # The ceiling looks down on the sheet: of 2,048 rays 5 to 10 % meet it.
        assert found.to_surroundings[ABOVE] == pytest.approx(wanted.to_surroundings[ABOVE], rel=0.6)
        assert found.to_surroundings[ABOVE] > 0.03


@pytest.mark.parametrize("name", [name for name in CONTACTS if name != "sheared cylinder"])
def test_at_one_temperature_what_touches_exchanges_nothing(name: str) -> None:
    scene = rw.Scene([*SIDES, *CONTACTS[name]])
    for method in ("matrix", "stochastic"):
        found = rw.radiative_exchange(scene, 300.0, 0.9, method=method, rays=2**14, progress=False)  # type: ignore[arg-type]
        assert np.abs(found.flux).max() < 1e-6
        assert found.escaped == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("low", [(1, 1, 0), (0, 0, 0)])
def test_a_box_that_touches_is_as_its_mesh(low: tuple[float, ...]) -> None:
    high = tuple(np.add(low, 1))
    plain = rw.Box(low, high)
    mesh = rw.view_factors(rw.Scene([*SIDES, block(low, (1, 1, 1))]), per="shape", rays=32, progress=False)
    for box in (plain, rw.Instance([plain], np.eye(4))):
        scene = rw.Scene([*SIDES, box])
        found = rw.view_factors(scene, per="shape", rays=4, progress=False)
        np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
        # One of 49 entries is beyond six standard errors in 1e-7 of cases.
        both = np.hypot(found.standard_error, mesh.standard_error)
        assert (np.abs(found.matrix - mesh.matrix) <= 6 * both + 1e-9).all()
        faces = rw.view_factors(scene, rays=4, progress=False)
        assert faces.matrix.shape == (13, 13)
        exchanged = faces.areas[:, None] * faces.matrix
        np.testing.assert_allclose(exchanged, exchanged.T, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("name", ["box", "stack", "mesh on a cylinder", "two blocks"])
def test_nothing_leaks_into_what_touches_where_both_sides_take_part(name: str) -> None:
    blocks = [block((1, 1, 0), (1, 1, 1)), block((1, 1, 1), (1, 1, 1))]
    shapes = blocks if name == "two blocks" else CONTACTS[name]
    walls = [rw.Mesh(side.vertices, side.faces, emission=1.0) for side in SIDES]
    scene = rw.Scene([*walls, *shapes])
    front, both = (
        rw.radiosity(scene, rays=2**16, sides=sides, progress=False)
        for sides in ("front", "both")  # type: ignore[arg-type]
    )
    assert both.escaped == front.escaped == (0, 0, 0)
    count = len(front.areas)
    # Both are solved with the same rays.
    np.testing.assert_allclose(both.irradiance[:count], front.irradiance, rtol=1e-9)
    is_solid = both.patches["shape"][:count] >= len(SIDES)
    assert not both.irradiance[count:][is_solid].any()


def test_no_sky_shines_on_what_another_face_covers() -> None:
    ground = rw.Mesh([(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)], [(0, 1, 2), (0, 2, 3)])
    black = rw.Mesh(ground.vertices, ground.faces, material=rw.Diffuse(0.0))
    cube = block((0, 0, 0), (1, 1, 1))
    for sides in ("front", "both"):
        scene = rw.Scene([black, cube], environment=1.0)
        found = rw.radiosity(scene, rays=2**14, sides=sides, progress=False)  # type: ignore[arg-type]
        heights = cube.vertices[cube.faces][:, :, 2]
        assert not found.irradiance[2:14][(heights == 0).all(axis=1)].any()
        assert found.irradiance[2:14][(heights == 1).all(axis=1)] == pytest.approx(np.pi, rel=0.02)
    scene = rw.Scene([black, rw.Cylinder((0, 0, 0), (0, 0, 1), 1)], environment=1.0)
    found = rw.radiosity(scene, rays=2**18, sides="front", progress=False)
    # The cap above sees all of the sky, the side half of it, and the cap below none. 12 standard
    # errors, of 7 degrees of freedom, are one case in 150,000.
    wanted = np.pi * (np.pi + 0.5 * 2 * np.pi) / found.areas[2]
    np.testing.assert_allclose(found.irradiance[2], wanted, atol=12 * found.irradiance_error[2].max())
    assert found.irradiance_error[2].max() < 0.06 * wanted


def test_a_disk_that_lies_in_a_floor_and_looks_up_is_told() -> None:
    with pytest.warns(RuntimeWarning, match=r"1 of 13 faces partly overlap coplanar faces"):
        rw.view_factors(rw.Scene([*SIDES, rw.Disk((2, 2, 0), (0, 0, 1), 0.5)]), rays=1, progress=False)
