"""Copies that move, against the same copies standing still at each time."""

import numpy as np
import pytest

import raywright as rw

RNG = np.random.default_rng(7)
COUNT = 12
MESH = rw.Mesh(RNG.normal(size=(150, 3)).astype(np.float32), np.arange(150).reshape(-1, 3))


def matrices(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    result = np.tile(np.eye(4), (COUNT, 1, 1))
    result[:, :3, :3] += rng.normal(size=(COUNT, 3, 3)) * 0.4
    result[:, :3, 3] = rng.uniform(-6, 6, (COUNT, 3))
    return result


START, END = matrices(1), matrices(2)
ORIGINS = RNG.uniform(-12, 12, (3000, 3))
DIRECTIONS = RNG.uniform(-5, 5, (3000, 3)) - ORIGINS
TIMES = RNG.choice([0, 0.125, 1 / 3, 0.77, 1], 3000)


def still(time: float) -> rw.Scene:
    return rw.Scene(rw.Instance(MESH, START + (END - START) * time if time < 1 else END))


@pytest.fixture(scope="module")
def moving() -> rw.Scene:
    return rw.Scene(rw.Instance(MESH, START, END))


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
def test_at_each_time_all_is_as_if_it_stood_still(accelerator: rw.BVH | rw.BruteForce) -> None:
    moving = rw.Scene([rw.Instance(MESH, START, END), MESH], accelerator=accelerator)
    hits = moving.intersect(ORIGINS, DIRECTIONS, time=TIMES)
    every = moving.intersect_all(ORIGINS, DIRECTIONS, time=TIMES)
    shadowed = moving.occluded(ORIGINS, DIRECTIONS, time=TIMES)
    counted = moving.count_hits(ORIGINS, DIRECTIONS, time=TIMES)
    assert hits.hit.mean() > 0.3
    np.testing.assert_array_equal(shadowed, hits.hit)
    np.testing.assert_array_equal(counted, every.count)
    for time in np.unique(TIMES):
        which = time == TIMES
        then = rw.Scene([still(time).shapes[0], MESH])
        wanted = then.intersect(ORIGINS[which], DIRECTIONS[which])
        for name in ("t", "shape_id", "instance_id", "primitive_id", "uv"):
            np.testing.assert_array_equal(getattr(hits, name)[which], getattr(wanted, name))
        np.testing.assert_allclose(hits.position[which], wanted.position, rtol=0, atol=1e-12)
        np.testing.assert_allclose(hits.normal[which], wanted.normal, rtol=0, atol=1e-12)
        all_then = then.intersect_all(ORIGINS[which], DIRECTIONS[which])
        mine = np.isin(every.ray, np.flatnonzero(which))
        np.testing.assert_array_equal(every.t[mine], all_then.t)
        np.testing.assert_allclose(every.position[mine], all_then.position, rtol=0, atol=1e-12)


def test_one_time_is_for_all_and_the_opening_is_the_default(moving: rw.Scene) -> None:
    for time in (0.0, 0.25, 1):
        one = moving.intersect(ORIGINS, DIRECTIONS, time=time)
        assert one == moving.intersect(ORIGINS, DIRECTIONS, time=np.full(3000, time))
        np.testing.assert_array_equal(one.t, still(time).intersect(ORIGINS, DIRECTIONS).t)
    assert moving.intersect(ORIGINS, DIRECTIONS) == moving.intersect(ORIGINS, DIRECTIONS, time=0.0)
    cost = moving.traversal_cost(ORIGINS, DIRECTIONS, time=0.5)
    assert cost.nodes.shape == (3000,)


def test_times_broadcast_with_rays(moving: rw.Scene) -> None:
    times = np.linspace(0, 1, 4)
    grid = moving.intersect(ORIGINS[:50, None], DIRECTIONS[:50, None], time=times)
    assert grid.shape == (50, 4)
    for i, time in enumerate(times):
        np.testing.assert_array_equal(
            grid.t[:, i], moving.intersect(ORIGINS[:50], DIRECTIONS[:50], time=time).t
        )
    single = moving.intersect(ORIGINS[0], DIRECTIONS[0], time=times)
    np.testing.assert_array_equal(single.t, grid.t[0])
    position = grid.position.copy()
    times[:] = 0
    np.testing.assert_array_equal(
        moving.intersect(ORIGINS[:50, None], DIRECTIONS[:50, None], time=1 - times).position[:, 0],
        position[:, 3],
    )


def test_a_point_moves_on_a_straight_line() -> None:
    triangle = rw.Mesh([(-1, -1, 0), (1, -1, 0), (0, 1, 0)], [(0, 1, 2)])
    end = np.eye(4)
    end[:3, 3] = (8, 0, -4)
    scene = rw.Scene(rw.Instance(triangle, np.eye(4), end))
    times = np.linspace(0, 1, 9)
    hits = scene.intersect(np.stack([8 * times, 0 * times, 0 * times + 10], axis=1), (0, 0, -1), time=times)
    np.testing.assert_array_equal(hits.t, 10 + 4 * times)
    np.testing.assert_array_equal(hits.instance_id, 0)
    np.testing.assert_allclose(hits.position[:, 2], -4 * times, rtol=0, atol=1e-15)
    assert not scene.occluded((0, 0, 10), (0, 0, -1), time=0.5)


def test_what_moves_within_what_moves() -> None:
    inner = rw.Instance(MESH, START[:3], END[:3])
    scene = rw.Scene(rw.Instance(inner, START[3:6], END[3:6]))
    for time in (0.0, 0.3, 1.0):
        then = [
            a + (b - a) * time if time < 1 else b for a, b in ((START[:3], END[:3]), (START[3:6], END[3:6]))
        ]
        wanted = rw.Scene(rw.Instance(rw.Instance(MESH, then[0]), then[1]))
        got = scene.intersect(ORIGINS, DIRECTIONS, time=time)
        assert got.hit.any()
        np.testing.assert_array_equal(got.t, wanted.intersect(ORIGINS, DIRECTIONS).t)


def test_a_flat_moment_is_not_seen(box: rw.Mesh) -> None:
    """Turned by half, a copy is flat half way."""
    scene = rw.Scene(rw.Instance(box, np.eye(4), np.diag((-1.0, -1, 1, 1))))
    ray = (0.0, 0, 5), (0, 0, -1)
    assert scene.occluded((0.1, 0.1, 5), (0, 0, -1), time=0.0)
    assert not scene.occluded(*ray, time=0.5)
    assert scene.occluded((-0.1, -0.1, 5), (0, 0, -1), time=1.0)


def test_a_picture_is_blurred_as_its_mean_over_time() -> None:
    sheet = rw.Mesh([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2), (0, 2, 3)], emission=1.0)
    end = np.eye(4)
    end[0, 3] = 2
    camera = rw.Camera((1, 0, 9), (1, 0, 0), width=8, height=8, fov=30)
    image = rw.render(
        rw.Scene(rw.Instance(sheet, np.eye(4), end)), camera, rw.Path(max_depth=0), samples=4000, seed=1
    )
    # Radiance 1 for the share of the time that the sheet covers a point; over a pixel, its mean.
    half = 9 * np.tan(np.radians(15))
    x = 1 + half * ((np.arange(8 * 64) + 0.5) / (8 * 64) * 2 - 1)
    share = np.clip(np.minimum(x + 1, 2) / 2, 0, 1) - np.clip((x - 1) / 2, 0, 1)
    rows = np.abs(half * ((np.arange(8 * 64) + 0.5) / (8 * 64) * 2 - 1)) <= 1
    wanted = (rows[:, None] * share[None]).reshape(8, 64, 8, 64).mean(axis=(1, 3))
    # Five standard errors of a share of 4000 samples, plus the error of the sum over 64 steps.
    np.testing.assert_allclose(image.rgb[..., 0], wanted, rtol=0, atol=5 * 0.5 / np.sqrt(4000) + 1 / 64)


@pytest.mark.parametrize("time", [-0.1, 1.1, np.nan, [0.5, 2.0]])
def test_a_time_outside_the_shutter_is_refused(moving: rw.Scene, time: float) -> None:
    with pytest.raises(ValueError, match="time must be between 0 and 1"):
        moving.intersect((0, 0, 0), (0, 0, 1), time=time)


def test_ends_must_match(box: rw.Mesh) -> None:
    with pytest.raises(
        ValueError, match=r"transform_end must have shape \(2, 4, 4\) as transform, got \(4, 4\)"
    ):
        rw.Instance(box, START[:2], np.eye(4))
    with pytest.raises(ValueError, match=r"transform_end\[1\] must have an inverse"):
        rw.Instance(box, START[:2], np.stack([np.eye(4), np.diag((1, 1, 0, 1.0))]))
