"""Copies of instances exchange light as the shapes that they stand for do."""

import numpy as np
import pytest
from radiosity_scenes import room
from test_view_factors import inward_box, rectangle

import raywright as rw


def places() -> np.ndarray:
    """Two copies: moved, and mirrored and stretched."""
    moved, mirrored = np.eye(4), np.diag([-0.7, 0.9, 1.2, 1.0])
    moved[:3, 3] = 0.2, 0.3, 0.1
    mirrored[:3, 3] = 0.9, 0.5, 0.25
    return np.stack([moved, mirrored])


def block() -> rw.Mesh:
    """Of 12 faces, which look outwards and reflect."""
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((0.2, 0.25, 0.3))
    box.apply_translation((0.15, 0.2, 0.2))
    return rw.Mesh(box.vertices, box.faces, material=rw.Diffuse((0.7, 0.4, 0.2)))


def scenes() -> tuple[rw.Scene, rw.Scene]:
    """A lit room with two blocks in it, as copies and as meshes."""
    walls = room(0.6, (1, 0, 0, 0, 0, 0)).shapes
    copies = rw.Instance([block()], places())
    moved = [block().transformed(place) for place in places()]
    return rw.Scene([*walls, copies]), rw.Scene([*walls, *moved])


def test_view_factors_of_copies_are_those_of_moved_meshes() -> None:
    ours, plain = (rw.view_factors(scene, progress=False) for scene in scenes())
    assert len(ours) == 12 + 2 * 12
    assert np.array_equal(ours.matrix, plain.matrix)
    assert np.array_equal(ours.areas, plain.areas)
    by_shape = rw.view_factors(scenes()[0], per="shape", progress=False)
    assert len(by_shape) == 7
    np.testing.assert_allclose(by_shape.areas[6], ours.areas[12:].sum())
    np.testing.assert_allclose(
        by_shape.matrix[6, 0], ours.areas[12:] @ ours.matrix[12:, :2].sum(axis=1) / by_shape.areas[6]
    )


def test_rooms_within_rooms_have_the_catalog_s_factors() -> None:
    # A box whose sides are copies of copies of one square: C-11 and C-14 of Howell.
    unit = rectangle((0, 0, 0), (1, 0, 0), (0, 1, 0))
    turned = [side.vertices[[0, 2, 1]] for side in inward_box()]
    frames = []
    for low, first, second in turned:
        frame = np.eye(4)
        frame[:3, 3] = low
        frame[:3, 0], frame[:3, 1] = first - low, second - low
        frame[:3, 2] = np.cross(frame[:3, 0], frame[:3, 1])
        frames.append(frame)
    inner = rw.Instance([unit], np.stack(frames[:2]))
    outer = rw.Instance([inner], np.eye(4)[None])
    found = rw.view_factors(rw.Scene([outer, rw.Instance([unit], np.stack(frames[2:]))]), progress=False)
    # Sides of two faces each, in the order of copies.
    sides = found.matrix.reshape(6, 2, 6, 2).sum(axis=3).mean(axis=1)
    truth = np.full((6, 6), 0.20004377607540316)
    for i in range(6):
        truth[i, i], truth[i, i ^ 1] = 0.0, 0.19982489569838746
    np.testing.assert_allclose(sides, truth, rtol=1e-9, atol=1e-12)


def test_radiosity_of_copies_is_that_of_moved_meshes() -> None:
    how = {"rays": 2**14, "patch_size": 0.3, "progress": False}
    ours, plain = (rw.radiosity(scene, **how) for scene in scenes())  # type: ignore[call-overload]
    assert np.array_equal(ours.radiosity, plain.radiosity)
    assert np.array_equal(ours.corners, plain.corners, equal_nan=True)
    patches = ours.patches
    assert set(patches["copy"][patches["shape"] < 6]) == {-1}
    assert set(patches["copy"][patches["shape"] == 6]) == {0, 1}
    assert patches["face"][patches["shape"] == 6].max() == 11
    assert np.array_equal(ours.mirrored, [False] * 24 + [True] * 12)
    assert not plain.mirrored.any()
    matrix = rw.radiosity(scenes()[0], method="matrix", progress=False)
    assert len(matrix) == 36


def test_pictures_of_copies_are_those_of_moved_meshes() -> None:
    camera = rw.Camera((0.5, 0.05, 0.9), (0.5, 0.6, 0.2), fov=80, width=24, height=24)
    shown = []
    for scene in scenes():
        found = rw.radiosity(scene, per="vertex", rays=2**14, patch_size=0.3, progress=False)
        shown.append(rw.render(scene, camera, rw.Radiosity(found), 4, progress=False).rgb)
    # Hits agree to rounding, and so do patches, except for a few at edges.
    off = np.abs(shown[0] - shown[1]).max(axis=2)
    assert np.mean(off > 1e-3 * shown[1].mean()) < 0.01
    assert shown[0].max() > 0
    copies, _ = scenes()
    one = rw.Radiosity(rw.radiosity(copies, rays=64, progress=False))
    fewer = rw.Scene([*copies.shapes[:6], rw.Instance([block()], places()[:1])])
    with pytest.raises(ValueError, match=r"of a scene with 14 faces, this one has 13: solve again"):
        rw.render(fewer, camera, one, 1, progress=False)
    other = rw.Scene([*copies.shapes[:6], rw.Instance([rw.Sphere((0, 0, 0), 0.1)], places())])
    with pytest.raises(ValueError, match=r"with another shape 6: solve again"):
        rw.render(other, camera, one, 1, progress=False)


def test_heat_of_copies_is_that_of_moved_meshes() -> None:
    kelvin = [300.0] * 6
    ours = rw.radiative_exchange(scenes()[0], [*kelvin, 400.0], 0.8, progress=False)
    plain = rw.radiative_exchange(scenes()[1], [*kelvin, 400.0, 400.0], 0.8, progress=False)
    assert np.array_equal(ours.flux, plain.flux)
    # The same numbers, added in another order.
    assert np.isclose(ours.of(6), plain.of(6) + plain.of(7), rtol=1e-14, atol=0.0)


def test_spheres_in_copies_send_and_receive() -> None:
    # In the middle of a cube of side 2, by symmetry a sixth goes to each side.
    place = np.diag([0.5, 0.5, 0.5, 1.0])
    place[:3, 3] = 1.0
    ball = rw.Instance([rw.Sphere((0, 0, 0), 1.0)], place)
    found = rw.view_factors(
        rw.Scene([*inward_box((2.0, 2.0, 2.0)), ball]), per="shape", rays=64, progress=False
    )
    for side in range(6):
        value, error = found.matrix[6, side], found.standard_error[6, side]
        assert error < 5e-3 / 6
        assert abs(value - 1 / 6) < 3 * error
    np.testing.assert_allclose(found.areas[6], np.pi)


def test_what_moves_or_is_not_diffuse_is_refused() -> None:
    moving = rw.Instance([block()], places(), places() + np.eye(4)[None] * 0.0)
    for find in (rw.view_factors, rw.radiosity):
        with pytest.raises(ValueError, match=r"shape 0 has moving copies"):
            find(rw.Scene([moving], rw.PointLight((0, 0, 1), 1)), progress=False)  # type: ignore[operator]
    glass = rw.Instance([rw.Sphere((0, 0, 0), 1.0, material=rw.Mirror())], np.eye(4))
    with pytest.raises(ValueError, match=r"shape 0 is of Mirror: only Diffuse"):
        rw.radiosity(rw.Scene([glass], rw.PointLight((0, 0, 3), 1)), progress=False)
    with pytest.raises(ValueError, match=r"shapes\[0\] must have a finite area"):
        rw.view_factors(rw.Scene([rw.Instance([rw.Plane((0, 0, 0), (0, 0, 1))], np.eye(4))]), progress=False)
