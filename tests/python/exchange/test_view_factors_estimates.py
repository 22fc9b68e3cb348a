"""What view factors by rays promise: told errors that hold, rows that add up, and factors within 0 and 1."""

import math
from typing import Literal

import numpy as np
import pytest
from test_view_factors import factors, half_hidden, inward_box, rectangle

import raywright as rw

BOX_FACES = [
    [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
    [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7],
]  # fmt: skip


def block(low: tuple[float, ...], size: tuple[float, ...], inwards: bool = False) -> rw.Mesh:
    """A box of twelve faces."""
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    faces = np.array(BOX_FACES)[:, ::-1] if inwards else BOX_FACES
    return rw.Mesh(np.array(low) + np.array(corners) * np.array(size), faces)


def furnished() -> rw.Scene:
    """A closed room with three boxes in it."""
    boxes = [((1, 1, 0.5), (1, 1, 1)), ((3, 2, 0.25), (1, 0.5, 2)), ((4.5, 0.5, 1), (0.5, 3, 0.25))]
    return rw.Scene([block((0, 0, 0), (6, 5, 3), inwards=True), *(block(*box) for box in boxes)])


def screened(blocker: float) -> rw.Scene:
    """Unit squares, 1 apart, with a square half-way."""
    x, y, z = np.eye(3)
    low = 0.5 - blocker / 2
    middle = rectangle([low, low, 0.5], blocker * x, blocker * y)
    return rw.Scene([rectangle(0 * x, x, y), rectangle(z, y, x), middle])


def behind_a_screen() -> tuple[rw.Scene, float]:
    """A wall, mostly below a large floor, of which a screen higher than the wall hides all but a strip.

    And the factor from the wall to the strip.
    """
    x, y, z = np.eye(3)
    wall = rectangle(-2 * y - 20 * z, 4 * y, 21 * z)
    floor = rectangle(-50 * x - 50 * y, 100 * x, 100 * y)
    strip = float(factors(rectangle(-50 * y, 8 * x, 100 * y), wall).matrix[1, 0])
    return rw.Scene([floor, wall, rectangle(8 * x - 200 * y, 400 * y, 30 * z)]), strip


def test_told_errors_hold_over_seeds() -> None:
    screen, strip = behind_a_screen()
    cases = [(screened(0.25), half_hidden(0.25)), (screened(0.8), half_hidden(0.8)), (screen, strip)]
    off = []
    for seed in range(24):
        for rays in (16, 128):
            for number, (scene, truth) in enumerate(cases):
                how = {"rays": rays, "seed": seed, "progress": False}
                found = rw.view_factors(scene, per="shape", **how)
                row = 1 if number == 2 else 0
                off.append((found.matrix[row, 1 - row] - truth) / found.standard_error[row, 1 - row])
    # One of 144 standard normals is beyond 5 in 8e-5 of cases.
    assert np.abs(off).max() < 5
    # With 144 degrees of freedom a root mean square above 1.25 has a probability of 2e-5.
    assert math.sqrt(np.mean(np.square(off))) < 1.25


def test_the_default_s_told_errors_hold() -> None:
    for scene, truth in ((screened(0.25), half_hidden(0.25)), (screened(0.8), half_hidden(0.8))):
        found = rw.view_factors(scene, per="shape", seed=5, progress=False)
        error = found.standard_error[0, 1]
        assert 0 < error <= 0.01 * found.matrix[0].max()
        assert abs(found.matrix[0, 1] - truth) < 4 * error


def test_told_errors_of_all_pairs_of_a_furnished_room_hold() -> None:
    scene = furnished()
    truth = rw.view_factors(scene, rays=2**11, seed=100, progress=False)
    off = []
    for seed in range(2):
        for how in ({}, {"rays": 16}, {"rays": 64}):
            found = rw.view_factors(scene, seed=seed, progress=False, **how)
            both = np.hypot(found.standard_error, truth.standard_error)
            off.append((found.matrix - truth.matrix)[both > 0] / both[both > 0])
            assert np.abs(found.to_surroundings).max() < 1e-9
            assert 0 <= found.matrix.min() <= found.matrix.max() <= 1
            exchanged = found.areas[:, None] * found.matrix
            np.testing.assert_allclose(exchanged, exchanged.T, rtol=1e-14, atol=0)
    # 3,000 entries, some of few rays, with the tails of counts.
    off_all = np.concatenate(off)
    assert np.abs(off_all).max() < 6
    assert np.mean(np.abs(off_all) > 3) < 0.01
    assert math.sqrt(np.mean(np.square(off_all))) < 1.1


def test_the_default_tells_a_hundredth_of_the_greatest_factor() -> None:
    for scene in (furnished(), screened(0.5), rw.Scene([*inward_box(cuts=3), block((0.3,) * 3, (0.4,) * 3)])):
        for per in ("face", "shape"):
            found = rw.view_factors(scene, per=per, progress=False)  # type: ignore[arg-type]
            assert found.sampled > 0
            assert (found.standard_error.max(axis=1) <= 0.01 * found.matrix.max(axis=1)).all()


def test_no_count_of_zero_is_certain() -> None:
    # Two triangles hide together, and neither does alone, so that only rays detect it.
    x, y, z = np.eye(3)
    found = factors(
        rectangle(0 * x, x, y), rectangle(z, y, x), rectangle(0.5 * z - x - y, 3 * x, 3 * y), rays=64
    )
    error = found.standard_error[0, 1]
    assert found.matrix[0, 1] <= error
    # 1.96 errors of each of the four pairs are at least three of 64 times its unblocked exchange.
    assert error > 0.9 * 1.5 / 64 * 0.19982489569838746 / 2


def test_rows_of_open_rooms_leave_no_less_than_nothing() -> None:
    sides, box = inward_box(), block((0.3,) * 3, (0.4,) * 3)
    found = factors(*sides[:5], box, rays=64)
    assert found.to_surroundings.min() > -1e-9
    # Escaping rays arrive at the removed side when it is there.
    closed = factors(*sides, box, rays=2**10)
    leaves, arrives = float(found.areas @ found.to_surroundings), float(closed.areas @ closed.matrix[:, 5])
    error = math.hypot(*(found.areas @ found.standard_error), *(closed.areas * closed.standard_error[:, 5]))
    assert abs(leaves - arrives) < 4.5 * error < 0.5


def test_a_box_that_stands_on_the_floor_touches_it() -> None:
    scene = rw.Scene([block((0, 0, 0), (6, 5, 3), inwards=True), block((1, 1, 0), (1, 1, 1))])
    found = rw.view_factors(scene, per="shape", progress=False)
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    # The bottom sees only the floor, which it hides by the same amount.
    faces = rw.view_factors(scene, progress=False)
    bottom = faces.matrix[12:14]
    np.testing.assert_allclose(bottom.sum(axis=1), 1, atol=1e-9)
    np.testing.assert_allclose(faces.areas[12:14] @ bottom, faces.matrix.T[12:14].sum(axis=0) * faces.areas)
    exchange = rw.radiative_exchange(scene, 300.0, 0.9, progress=False)
    assert np.abs(exchange.flux).max() < 1e-6


def test_a_sheet_of_two_sides_does_not_see_itself() -> None:
    x, y, _ = np.eye(3)
    sheet = [rectangle([1, 1, 1.5], x, y), rectangle([1, 1, 1.5], y, x)]
    room = block((0, 0, 0), (6, 5, 3), inwards=True)
    found = factors(room, *sheet)
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    np.testing.assert_allclose(found.matrix[1:], [[1, 0, 0], [1, 0, 0]], atol=1e-9)


@pytest.mark.parametrize("method", ["matrix", "stochastic"])
def test_nothing_is_exchanged_at_one_temperature(method: Literal["matrix", "stochastic"]) -> None:
    scene = furnished()
    found = rw.radiative_exchange(scene, 300.0, 0.9, method=method, progress=False)
    assert np.abs(found.flux).max() < 1e-6
    # By rays a room is closed, except for a loss that some 65,536 of them may have missed.
    assert found.standard_error.max() < 0.02
    assert abs(found.power.sum()) < 1e-5
    assert found.escaped == pytest.approx(0, abs=1e-6)
    # A slightly warmer wall: the others gain its loss, and the error is relative to that.
    kelvin = [300.0, 301.0, 300.0, 300.0]
    warm = rw.radiative_exchange(scene, kelvin, 0.9, method=method, rays=2**16, progress=False)
    assert warm.of(1) > 0
    assert abs(warm.power.sum()) < 1e-4 * warm.of(1)
    exact = rw.radiative_exchange(scene, kelvin, 0.9, method="matrix", error=2e-3, progress=False)
    assert warm.of(1) == pytest.approx(exact.of(1), rel=0.02)


def test_told_errors_of_fluxes_hold() -> None:
    scene = furnished()
    kelvin = [300.0, 400.0, 350.0, 280.0]
    truth = rw.radiative_exchange(scene, kelvin, 0.8, error=4e-4, seed=50, progress=False)
    assert abs(truth.power.sum()) < 1e-9 * np.abs(truth.power).sum()
    off = []
    for seed in range(6):
        found = rw.radiative_exchange(scene, kelvin, 0.8, error=5e-3, seed=seed, progress=False)
        off.append((found.flux - truth.flux) / np.hypot(found.standard_error, truth.standard_error))
    # Errors of estimates scaled to add up are upper bounds. Of 288 normals none is beyond 5: 1.6e-4.
    assert np.abs(off).max() < 5
    assert math.sqrt(np.mean(np.square(off))) < 1.15
