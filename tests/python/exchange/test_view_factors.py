"""View factors against closed forms, enclosures and each other."""

import math
import re
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import raywright as rw
from raywright.exchange import view_factors as module

Array = NDArray[np.float64]


def rectangle(corner: Any, side: Any, other: Any, cuts: int = 1) -> rw.Mesh:
    """A parallelogram in cuts x cuts parts; its normal is along side x other."""
    corner, side, other = (np.asarray(v, float) for v in (corner, side, other))
    share = np.arange(cuts + 1) / cuts
    u, v = (g.reshape(-1, 1) for g in np.meshgrid(share, share, indexing="ij"))
    at = np.arange((cuts + 1) ** 2).reshape(cuts + 1, cuts + 1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    faces = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return rw.Mesh(corner + u * side + v * other, faces)


def inward_box(size: Any = (1.0, 1.0, 1.0), cuts: int = 1) -> list[rw.Mesh]:
    """The sides -x, +x, -y, +y, -z, +z of a box from 0, seen from inside."""
    a, b, c = np.diag(np.asarray(size, float))
    return [
        rectangle(0 * a, b, c, cuts),
        rectangle(a, c, b, cuts),
        rectangle(0 * a, c, a, cuts),
        rectangle(b, a, c, cuts),
        rectangle(0 * a, a, b, cuts),
        rectangle(c, b, a, cuts),
    ]


def factors(*shapes: Any, **how: Any) -> rw.exchange.ViewFactors:
    return rw.view_factors(rw.Scene(list(shapes)), **{"per": "shape", "progress": False, **how})


def within(found: rw.exchange.ViewFactors, i: int, j: int, truth: float) -> None:
    """Three standard errors, each of at most 0.2 %."""
    value, error = found.matrix[i, j], found.standard_error[i, j]
    assert error <= 2e-3 * truth
    assert abs(value - truth) <= 3 * error


def corner(x: Any, y: Any, h: float) -> Any:
    """From an element to a rectangle over it with a corner above it, in parallel (Howell, C-1)."""
    p, q = np.sqrt(x * x + h * h), np.sqrt(y * y + h * h)
    return (x / p * np.arctan(y / p) + y / q * np.arctan(x / q)) / (2 * math.pi)


def half_hidden(blocker: float) -> float:
    """Unit squares, 1 apart, with a square of this side half-way: by shadows on the second, cut at kinks."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    # The shadow along each axis extends from 2 l - x to 2 h - x, with l and h the ends of the blocker.
    low, high = 0.5 - blocker / 2, 0.5 + blocker / 2
    kinks = np.unique(np.clip([0, 1, 2 * low - 1, 2 * low, 2 * high - 1, 2 * high], 0, 1))
    x = np.concatenate([(a + b) / 2 + (b - a) / 2 * nodes for a, b in pairwise(kinks)])
    w = np.concatenate([(b - a) / 2 * weights for a, b in pairwise(kinks)])
    ends = np.clip(2 * low - x, 0, 1) - x, np.clip(2 * high - x, 0, 1) - x

    def over(u: tuple[Array, Array]) -> Any:
        (a, b), (c, d) = ([e[:, None] for e in u], [e[None, :] for e in u])
        return corner(b, d, 1.0) - corner(a, d, 1.0) - corner(b, c, 1.0) + corner(a, c, 1.0)

    return float(w @ (over((-x, 1 - x)) - over(ends)) @ w)


def test_a_box_by_its_sides() -> None:
    found = factors(*inward_box((1.0, 2.0, 3.0)))
    first = [
        0.0,
        0.475576436532953,
        0.159498350739525,
        0.159498350739525,
        0.102713430993999,
        0.102713430993999,
    ]
    np.testing.assert_allclose(found.matrix[0], first, rtol=0, atol=1e-12)
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-12)
    np.testing.assert_allclose(found.areas, [6, 6, 3, 3, 2, 2], rtol=1e-15)
    assert not found.standard_error.any()
    assert (found.sampled, found.hidden, found.rays) == (0, 0, 0)


@pytest.mark.parametrize("size", [1e-8, 0.1, 1e6])
def test_faces_of_a_convex_room_add_up_to_one(size: float) -> None:
    found = factors(*inward_box((size, 2 * size, 0.7 * size), 4), per="face")
    assert len(found) == 192
    assert found.rays == 0
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    exchanged = found.areas[:, None] * found.matrix
    np.testing.assert_allclose(exchanged, exchanged.T, rtol=1e-15)
    x = np.linspace(0, 1, len(found))
    np.testing.assert_allclose(found.matvec(x), found.matrix @ x)
    np.testing.assert_allclose(found.rmatvec(x), x @ found.matrix)


def test_a_ball_of_faces_seen_from_inside() -> None:
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(subdivisions=2)
    found = factors(rw.Mesh(ball.vertices, ball.faces[:, ::-1]), per="face")
    assert found.rays == 0
    np.testing.assert_allclose(found.to_surroundings, 0, atol=1e-9)
    outside = factors(rw.Mesh(ball.vertices, ball.faces), per="face")
    assert not outside.matrix.any()


@pytest.mark.parametrize(
    ("cuts", "blocker", "rays"),
    [(1, 0.25, 2**14), (1, 0.5, 2**16), (3, 0.25, 2**9), (3, 0.5, 2**9), (3, 0.8, 2**12)],
)
def test_squares_with_a_smaller_one_half_way(cuts: int, blocker: float, rays: int) -> None:
    x, y, z = np.eye(3)
    low = 0.5 - blocker / 2
    found = factors(
        rectangle(0 * x, x, y, cuts),
        rectangle(z, y, x, cuts),
        rectangle([low, low, 0.5], blocker * x, blocker * y),
        rays=rays,
    )
    within(found, 0, 1, half_hidden(blocker))
    assert half_hidden(1e-9) == pytest.approx(0.19982489569838746, rel=1e-9)


def test_what_is_hidden_wholly_is_nothing() -> None:
    x, y, z = np.eye(3)
    wall = rw.Mesh([[-9, -9, 0.5], [20, -9, 0.5], [-9, 20, 0.5]], [[0, 1, 2]])
    found = factors(rectangle(0 * x, x, y, 3), rectangle(z, y, x, 3), wall, per="face")
    assert not found.matrix[:18, :36].any()
    assert (found.hidden, found.rays) == (18 * 18, 0)


def test_a_room_with_a_box_in_it() -> None:
    trimesh = pytest.importorskip("trimesh")
    block = trimesh.creation.box((0.4, 0.3, 0.5))
    block.apply_translation((0.55, 0.45, 0.4))
    scene = rw.Scene([*inward_box(cuts=3), rw.Mesh(block.vertices, block.faces)])
    found = rw.view_factors(scene, rays=64, progress=False)
    assert found.hidden > 0
    assert found.sampled > 0
    # 120 rows, each within 5 errors: these come from few batches a pair.
    error = np.sqrt((found.standard_error**2).sum(axis=1))
    assert (np.abs(found.to_surroundings) <= 5 * error + 1e-9).all()
    assert np.abs(found.to_surroundings).max() < 0.02
    exchanged = found.areas[:, None] * found.matrix
    np.testing.assert_allclose(exchanged, exchanged.T, rtol=1e-15)
    again = rw.view_factors(scene, rays=64, threads=1, progress=False)
    assert np.array_equal(again.matrix, found.matrix)
    assert np.array_equal(again.standard_error, found.standard_error)
    other = rw.view_factors(scene, rays=64, seed=1, progress=False)
    assert not np.array_equal(other.matrix, found.matrix)
    finer = rw.view_factors(scene, error=1e-3, progress=False)
    assert finer.standard_error.max() <= 1e-3 < found.standard_error.max()
    apart = np.abs(finer.matrix - other.matrix)
    both = np.hypot(finer.standard_error, other.standard_error)
    assert np.mean(apart[both > 0] <= 3 * both[both > 0]) > 0.95


def test_rows_by_rays_agree_with_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    trimesh = pytest.importorskip("trimesh")
    block = trimesh.creation.box((0.4, 0.3, 0.5))
    block.apply_translation((0.55, 0.45, 0.4))
    scene = rw.Scene([*inward_box(cuts=2), rw.Mesh(block.vertices, block.faces)])
    pairs = rw.view_factors(scene, rays=256, progress=False)
    shapes = rw.view_factors(scene, per="shape", rays=256, progress=False)
    monkeypatch.setattr(module, "_MOST_DENSE", 10)
    rows = rw.view_factors(scene, rays=256, progress=False)
    np.testing.assert_allclose(rows.to_surroundings, 0, atol=1e-12)
    both = np.hypot(pairs.standard_error, rows.standard_error.toarray())
    apart = np.abs(pairs.matrix - rows.matrix.toarray())
    assert np.mean(apart[both > 0] <= 3 * both[both > 0]) > 0.95
    assert "sparse" in repr(rows)
    by_shape = rw.view_factors(scene, per="shape", rays=256, progress=False)
    np.testing.assert_allclose(by_shape.matrix, shapes.matrix, atol=5e-3)
    np.testing.assert_allclose(rows.matvec(np.ones(len(rows))), 1.0)


def test_spheres_and_disks() -> None:
    sphere = rw.Sphere((0, 0, 1.25), 0.8)
    found = factors(rw.Disk((0, 0, 0), (0, 0, 1), 2.0), sphere, rays=128)
    within(found, 0, 1, 0.150400339198982)
    found = factors(rw.Sphere((0, 0, 0), 0.5), rw.Sphere((4, 0, 0), 2.0), rays=700)
    within(found, 0, 1, 0.0673688530967076)
    near = factors(rw.Disk((0, 0, 0), (0, 0, 1), 1.0), rw.Disk((0, 0, 0.1), (0, 0, -1), 1.0), rays=16)
    within(near, 0, 1, 0.9048750780274973)


def test_a_sphere_in_a_cube() -> None:
    cube = inward_box((2.0, 2.0, 2.0))
    found = factors(*cube, rw.Sphere((1, 1, 1), 0.5), rays=512)
    for i in range(6):
        within(found, 6, i, 1 / 6)
        within(found, i, 6, 0.130899693899575)


def test_a_disk_between_disks() -> None:
    found = factors(
        rw.Disk((0, 0, 0), (0, 0, 1), 1.0),
        rw.Disk((0, 0, 2), (0, 0, -1), 1.0),
        rw.Disk((0, 0, 1), (0, 0, 1), 0.5),
        rays=256,
    )
    within(found, 0, 1, 0.081408557450239)


def test_long_strips_with_one_between() -> None:
    # Ends of strips 10 000 long contribute 1e-4 of the whole.
    long, x, y, z = 1e4, *np.eye(3)
    found = factors(
        rectangle(-x, 2 * x, long * y),
        rectangle(2 * z - x, long * y, 2 * x),
        rectangle(z - 0.5 * x, x, long * y),
        rays=2**17,
    )
    truth = 0.118033988749895
    assert found.standard_error[0, 1] <= 2e-3 * truth
    assert abs(found.matrix[0, 1] - truth) <= 3 * found.standard_error[0, 1] + 2e-4 * truth


def tube(sides: int, radius: float, length: float, top: float) -> rw.Mesh:
    """The inner side of a cone or cylinder of many sides, open at its ends."""
    angle = 2 * math.pi * np.arange(sides) / sides
    ring = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1) * radius
    vertices = np.concatenate([ring, ring * top + [0, 0, length]])
    i, j = np.arange(sides), (np.arange(sides) + 1) % sides
    faces = np.concatenate([np.stack([i, i + sides, j], -1), np.stack([j, i + sides, j + sides], -1)])
    return rw.Mesh(vertices, faces)


@pytest.mark.parametrize(
    ("radius", "length", "top", "sides", "truth"),
    [
        (0.1, 3.0, 1.0, 12, 0.966703621627092),
        (5.0, 0.5, 1.0, 48, 0.0487507802749607),
        (1.0, 2.0, 1e-6, 12, 0.552786404500042),
    ],
)
def test_the_inside_of_cylinders_and_cones_sees_itself(
    radius: float, length: float, top: float, sides: int, truth: float
) -> None:
    # With n sides the factor is off by a multiple of 1 / n^2, which two values of n eliminate.
    found = [float(factors(tube(n, radius, length, top)).matrix[0, 0]) for n in (sides, 2 * sides)]
    # The flat ring sees a twentieth of itself.
    assert (4 * found[1] - found[0]) / 3 == pytest.approx(truth, rel=2e-3 if truth < 0.1 else 1e-4)


def test_a_shape_of_no_area_sees_nothing() -> None:
    dot = rw.Mesh([[0.5, 0.5, 0.5]] * 3, [[0, 1, 2]])
    found = factors(*inward_box(), dot)
    assert found.areas[6] == 0
    assert not found.matrix[6].any()
    assert not found.matrix[:, 6].any()
    np.testing.assert_allclose(found.to_surroundings, [0] * 6 + [1], atol=1e-12)


@pytest.mark.parametrize(
    ("make", "error", "what"),
    [
        (lambda: rw.view_factors(3), TypeError, "shapes must be a Mesh, another"),
        (lambda: rw.view_factors(rw.Scene([])), ValueError, "the scene has no faces"),
        (lambda: factors(*inward_box(), per="vertex"), ValueError, "per must be"),
        (lambda: factors(*inward_box(), rays=0), ValueError, "rays must be"),
        (lambda: factors(*inward_box(), rays=-3), ValueError, "rays must be"),
        (lambda: factors(*inward_box(), rays=1.5), TypeError, "rays must be"),
        (lambda: factors(*inward_box(), error=-1.0), ValueError, "error must be"),
        (lambda: factors(*inward_box(), error=math.nan), ValueError, "error must be"),
        (lambda: factors(*inward_box(), seed=-1), ValueError, "seed must be"),
        (lambda: factors(*inward_box(), threads=0), ValueError, "threads must be"),
        (lambda: factors(*inward_box(), progress="yes"), TypeError, "progress must be"),
        (lambda: factors(rw.Plane((0, 0, 0), (0, 0, 1))), ValueError, "shapes[0] must have a finite area"),
        (
            lambda: factors(rw.Mesh([[0, 0, 0], [1, 0, 0], [0, math.nan, 0]], [[0, 1, 2]])),
            ValueError,
            "face 0 of shapes[0] has a non-finite corner",
        ),
        (lambda: factors(*inward_box()).matvec([1.0]), ValueError, "x must be (6,) or (6, K), got (1,)"),
    ],
)
def test_wrong_input(make: Callable[[], object], error: type[Exception], what: str) -> None:
    with pytest.raises(error, match=re.escape(what)):
        make()


def test_progress_is_told_and_may_end_it() -> None:
    told: list[float] = []
    factors(*inward_box(), progress=told.append)
    assert told[-1] == 1.0

    def stop(share: float) -> None:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        factors(*inward_box(cuts=12), per="face", progress=stop)


@pytest.mark.parametrize("per", ["shape", "face"])
def test_arrays_belong_to_the_caller(per: str) -> None:
    room = inward_box()
    found = factors(*room, per=per)
    # torch warns of what cannot be written to.
    for array in (found.matrix, found.areas, found.standard_error, found.to_surroundings):
        assert array.flags.writeable
        assert array.flags.c_contiguous
        array[:] = 7.0
    again = factors(*room, per=per)
    assert again.matrix.max() <= 1
    assert again.areas.sum() == pytest.approx(6.0)


def test_it_says_what_it_is() -> None:
    said = repr(factors(*inward_box()))
    assert said.startswith("ViewFactors(6 shapes; pairs: 60 closed, 0 hidden, 0 sampled; 0 rays; rest up to")
