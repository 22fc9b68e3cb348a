"""The bounds of the kernels against the worst arithmetic that WGSL allows.

Every operation is off by a whole ulp, in the direction that is worst for what is computed, and so is all that
the kernels are given. The bounds are read from the kernels' own text; what is exact is computed in float64,
whose roundings are a billionth of these.
"""

import re
from pathlib import Path

import numpy as np
import pytest

import raywright as rw

U = 2.0**-23
TEXT = (Path(rw.__file__).parent / "gpu" / "trace.wgsl").read_text(encoding="utf-8")
COUNT = 15_000


def bound(name, **values):
    """Return what the kernels' text gives a name."""
    (expression,) = re.findall(rf"let {name} = (.*);", TEXT)
    return eval(expression, {"U": U, "least": 0.0, "abs": np.abs}, values)


def pushed(x, towards, ulps=1.0):
    """Return what is off by so many ulps, in a direction."""
    return x + ulps * U * np.abs(x) * np.sign(towards)


def pushed_cross(a, b, towards):
    """Return a cross product each of whose operations errs in a direction."""
    parts = []
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        to = towards[:, i]
        left, right = pushed(a[:, j] * b[:, k], to), pushed(a[:, k] * b[:, j], -to)
        parts.append(pushed(left - right, to))
    return np.stack(parts, axis=1)


def pushed_dot(a, b, towards):
    """Return a dot product each of whose operations errs in a direction."""
    x, y, z = (pushed(a[:, i] * b[:, i], towards) for i in range(3))
    return pushed(pushed(x + y, towards) + z, towards)


def pushed_triple(a, b, c, towards):
    """Return a . (b x c), each of whose operations errs in a direction."""
    return pushed_dot(a, pushed_cross(b, c, a * towards[:, None]), towards)


def expanded_triple(a, b, c, towards):
    """Return the same as a compiler may have it: six products of three, added up one after the other."""
    total = np.zeros(len(a))
    for i, j, k, sign in (
        (0, 1, 2, 1),
        (1, 2, 0, 1),
        (2, 0, 1, 1),
        (0, 2, 1, -1),
        (2, 1, 0, -1),
        (1, 0, 2, -1),
    ):
        product = pushed(pushed(a[:, i] * b[:, j], sign * c[:, k] * towards) * c[:, k], sign * towards)
        total = pushed(total + sign * product, towards)
    return total


class Cases:
    """Rays and triangles, as they are and as kernels are given them at the worst for one of the weights."""

    def __init__(self, seed, size):
        random = np.random.default_rng(seed)
        vectors = random.uniform(-1, 1, (4, COUNT, 3))
        # Half of them have maximal numbers, whose errors add up.
        vectors[:, : COUNT // 2] = np.sign(vectors[:, : COUNT // 2])
        self.corner, self.edge, self.other = 2 * vectors[0], size[0] * vectors[1], size[1] * vectors[2]
        self.direction = 2 * vectors[3] / np.abs(vectors[3]).max(axis=1, keepdims=True)
        self.direction[np.abs(self.direction).max(axis=1) >= 2] *= 1 - 2.0**-30
        self.origin = random.uniform(-4, 4, (COUNT, 3))
        # Also near a point of the triangle.
        near = slice(0, None, 3)
        away = 10.0 ** random.uniform(-6, 0, (len(self.origin[near]), 1))
        self.origin[near] = (self.corner + 0.4 * self.edge)[near] + away * vectors[3][near]
        self.towards = random.choice([-1.0, 1.0], COUNT)
        self.away = self.origin - self.corner

    def gradients(self, kind):
        """Return how a triple product grows with each of what it is made of, in the direction to err in."""
        s, d, e, f = self.away, self.direction, self.edge, self.other
        to = self.towards[:, None]
        products = {
            "u": {"s": np.cross(d, f), "d": np.cross(f, s), "f": np.cross(s, d)},
            "v": {"d": np.cross(s, e), "s": np.cross(e, d), "e": np.cross(d, s)},
            "determinant": {"e": np.cross(d, f), "d": np.cross(f, e), "f": np.cross(e, d)},
            "numerator": {"f": np.cross(s, e), "s": np.cross(e, f), "e": np.cross(f, s)},
        }[kind]
        return {name: to * product for name, product in products.items()}

    def given(self, kind):
        """Return s, d, e and f as kernels have them, and what they say of sizes."""
        to = self.gradients(kind)
        zero = np.zeros_like(self.origin)
        s = to.get("s", zero)
        origin = pushed(self.origin, s, 0.5) + 0.25 * U * np.sign(s)
        corner = pushed(self.corner, -s, 0.5)
        away = pushed(origin - corner, s)
        d, e, f = (
            pushed(getattr(self, name), to.get(name[0] if name != "other" else "f", zero), 0.5)
            for name in ("direction", "edge", "other")
        )
        return (
            away,
            d,
            e,
            f,
            {
                "E": np.abs(e).max(axis=1),
                "F": np.abs(f).max(axis=1),
                "S": np.abs(away).max(axis=1),
                "reach": np.abs(origin).max(axis=1) + 3,
            },
        )


PARTS = {"u": "sdf", "v": "dse", "determinant": "edf", "numerator": "fse"}
BOUNDS = {"u": "of_u", "v": "of_v", "determinant": "M", "numerator": "N"}
# Sizes of both edges: large, small, tiny, and of a sliver.
SIZES = [(2.0, 2.0), (0.01, 0.01), (1e-6, 1e-6), (1e-4, 2.0)]


def triple(named, parts, how):
    return how(*(named[part] for part in parts))


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("kind", PARTS)
@pytest.mark.parametrize("how", [pushed_triple, expanded_triple])
def test_no_product_is_off_by_more(kind, how, size):
    cases = Cases(1, size)
    exact = {"s": cases.away, "d": cases.direction, "e": cases.edge, "f": cases.other}
    s, d, e, f, sizes = cases.given(kind)
    named = {"s": s, "d": d, "e": e, "f": f}
    true = triple(exact, PARTS[kind], lambda a, b, c: np.einsum("ij,ij->i", a, np.cross(b, c)))
    computed = triple(named, PARTS[kind], lambda a, b, c: how(a, b, c, cases.towards))
    share = np.abs(computed - true) / bound(BOUNDS[kind], **sizes)
    assert share.max() < 1
    # The bound is not much too large either.
    assert share.max() > 0.3


@pytest.mark.parametrize("size", SIZES)
def test_the_third_weight_is_off_by_no_more(size):
    cases = Cases(2, size)
    s, d, e, f, sizes = cases.given("u")
    to = cases.towards
    dot = lambda a, b, c: np.einsum("ij,ij->i", a, np.cross(b, c))  # noqa: E731
    true = {
        "determinant": dot(cases.edge, cases.direction, cases.other),
        "u": dot(cases.away, cases.direction, cases.other),
        "v": dot(cases.direction, cases.away, cases.edge),
    }
    # Each is off by its own test's bound from its parts, two of them in the other direction.
    u = expanded_triple(s, d, f, to)
    _, d, e, f, _ = cases.given("determinant")
    determinant = expanded_triple(e, d, f, -to)
    s, d, e, f, _ = cases.given("v")
    v = expanded_triple(d, s, e, to)
    w = pushed(pushed(determinant - u, -to) - v, -to)
    share = np.abs(w - (true["determinant"] - true["u"] - true["v"])) / bound("of_w", **sizes)
    assert share.max() < 1
    assert share.max() > 0.3


@pytest.mark.parametrize("size", SIZES)
def test_t_lies_where_it_is_said_to(size):
    cases = Cases(3, size)
    to = cases.towards
    s, d, e, f, sizes = cases.given("numerator")
    numerator_true = np.einsum("ij,ij->i", cases.other, np.cross(cases.away, cases.edge))
    determinant_true = np.einsum("ij,ij->i", cases.edge, np.cross(cases.direction, cases.other))
    numerator = expanded_triple(f, s, e, to)
    # Signs that move the quotient the same way.
    cases.towards = -to * np.sign(numerator_true) * np.sign(determinant_true)
    _, d, e, f, _ = cases.given("determinant")
    determinant = expanded_triple(e, d, f, cases.towards)
    m = bound("M", **sizes)
    room = np.abs(determinant) - m
    certain = room > m
    with np.errstate(invalid="ignore", divide="ignore"):
        t_true = numerator_true / determinant_true
        t = pushed(numerator / determinant, to * np.sign(determinant_true), 2.5)
        n = bound("N", **sizes)
        error = bound("error", N=n, M=m, t=t, room=room, reach=sizes["reach"])
        share = (np.abs(t - t_true) + 2.0**-26 * (sizes["reach"] + 1)) / error
    # This includes the error of the CPU's own t.
    assert certain.mean() > 0.2
    assert share[certain].max() < 1
    assert share[certain].max() > 0.3


def test_no_box_is_passed_by_that_is_met():
    random = np.random.default_rng(4)
    origin, at = random.uniform(-4, 4, (COUNT, 1)), random.uniform(-2, 2, (COUNT, 1))
    direction = random.choice([-1.0, 1.0], (COUNT, 1)) * 2.0 ** random.uniform(-40, 1, (COUNT, 1))
    reach = np.abs(origin) + 2
    true = (at - origin) / direction
    for to in (-1.0, 1.0):
        given = pushed(origin, -to * direction, 0.5) - 0.25 * U * np.sign(to * direction)
        way = pushed(direction, -to * true * direction, 0.5)
        difference = pushed(at - given, to * direction)
        inverse = pushed(1 / way, to * difference, 2.5)
        plane = pushed(difference * inverse, to)
        (expression,) = re.findall(r"let room = (.*);", TEXT)[:1]
        # Evaluates the bound from the first use: slabs.
        room = eval(expression, {"U": U, "abs": np.abs}, {"reach": reach, "inverse": inverse})
        moved = pushed(plane - to * room, to)
        # The CPU's t may be off by this.
        gap = to * (true + to * 2.0**-26 * (reach + 2) - moved)
        assert (gap > 0).all()
        assert ((to * (plane - true)) / room).max() > 0.3
