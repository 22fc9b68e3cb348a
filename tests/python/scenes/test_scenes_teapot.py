"""The Utah teapot: its patches fit together as Newell's do."""

import numpy as np
import pytest

import raywright as rw
from raywright.scenes.teapot import patches, surface

CONTROL = patches()


def test_there_are_thirty_two_patches():
    assert CONTROL.shape == (32, 4, 4, 3)
    # y = 0 is a plane of symmetry.
    mirrored = {tuple(point) for point in (CONTROL * [1, -1, 1] + 0.0).reshape(-1, 3)}
    assert mirrored == {tuple(point) for point in CONTROL.reshape(-1, 3)}


@pytest.mark.parametrize("divisions", [1, 2, 7])
def test_it_is_as_large_as_it_is_known_to_be(divisions):
    teapot = rw.scenes.teapot(divisions)
    # Eight patches have a degenerate side, where every second triangle would have no area.
    assert len(teapot.faces) == 64 * divisions**2 - 8 * divisions
    assert teapot.bounds[:, 1].tolist() == [0, 3.15]
    assert teapot.bounds[:, 2].tolist() == [-2, 2]
    fine = rw.scenes.teapot(40)
    assert fine.bounds[0, 0] == -3
    assert fine.bounds[1, 0] == pytest.approx(3.434, abs=1e-3)


@pytest.mark.parametrize("divisions", [2, 3, 8])
def test_patches_meet_without_gaps(divisions):
    teapot = rw.scenes.teapot(divisions)
    _, joined = np.unique(teapot.vertices, axis=0, return_inverse=True)
    faces = joined.reshape(-1)[teapot.faces]
    edges = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1), axis=-1).reshape(-1, 2)
    uses = np.unique(edges, axis=0, return_counts=True)[1]
    assert set(uses) <= {1, 2}
    # Open edges: the rim and the lid, each a circle of four patches, and both ends of handle and spout, each
    # of two.
    assert (uses == 1).sum() == (2 * 4 + 4 * 2) * divisions


def test_patches_that_follow_each_other_meet_smoothly():
    # Along the profile: the last step of one patch and the first of the next are parallel.
    smooth = 0
    for one in CONTROL:
        for other in CONTROL:
            if np.array_equal(one[3], other[0]) and not np.array_equal(one, other):
                before, after = one[3] - one[2], other[1] - other[0]
                assert np.abs(np.cross(before, after)).max() < 1e-12
                assert (np.sum(before * after, axis=1) > 0).all()
                smooth += 1
    # Rim and body, body and body, body and bottom, knob and lid; handle and spout.
    assert smooth == 4 * 4 + 2 * 2


def test_normals_are_unit_and_those_of_the_surface():
    points, normals = surface(CONTROL, np.linspace(0, 1, 9))
    assert np.allclose(np.linalg.norm(normals, axis=-1), 1)
    # Compared with finite differences of the surface, away from the sides.
    near = surface(CONTROL, np.array([0.4, 0.4 + 1e-6]))[0]
    along, across = near[:, 1, 0] - near[:, 0, 0], near[:, 0, 1] - near[:, 0, 0]
    expected = np.cross(along, across)
    expected /= np.linalg.norm(expected, axis=1, keepdims=True)
    assert np.allclose(surface(CONTROL, np.array([0.4]))[1][:, 0, 0], expected, atol=1e-4)
    assert np.array_equal(points[:, 0, 0], CONTROL[:, 0, 0])
    assert np.array_equal(points[:, -1, -1], CONTROL[:, 3, 3])


def test_it_is_seen_from_outside():
    scene = rw.Scene(rw.scenes.teapot(12))
    rng = np.random.default_rng(1)
    # From below and from both sides no ray enters through the spout or past the lid.
    for axis, start in ((1, -9.0), (2, 9.0), (2, -9.0)):
        origins = rng.uniform((-3, 0, -2), (3.4, 3.1, 2), (3000, 3))
        origins[:, axis] = start
        hits = scene.intersect(origins, -np.sign(start) * np.eye(3)[axis])
        facing = hits.normal[hits.hit][:, axis] * np.sign(start)
        assert hits.hit.any()
        assert (facing > 0).all()


def test_it_takes_a_material():
    assert rw.scenes.teapot(1, rw.Diffuse(0.2)).material == rw.Diffuse(0.2)
    with pytest.raises(ValueError, match="divisions must be at least 1, got 0"):
        rw.scenes.teapot(0)
