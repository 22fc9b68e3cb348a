"""Closest hits by brute force in exact arithmetic: what the library's answers are held against.

Everything is decided in integers: floats are integers times powers of two, and the powers are multiplied out.
Only pairs that f64 rejects with a margin of a thousand error bounds are left out.
"""

import itertools
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

import raywright as rw

UNIT = Fraction(1, 2**53)
TINY = Fraction(1, 2**1022)
SMALLEST = Fraction(1, 2**1074)


@dataclass(frozen=True)
class Candidate:
    """A triangle that a ray's line meets, at an exact `t`, and how far computed weights may be off.

    `length` turns lengths of the direction scaled to a largest coordinate in [1, 2) into those of `t`.
    """

    primitive: int
    t: Fraction
    uv: tuple[Fraction, Fraction]
    uv_slack: Fraction
    length: Fraction

    @property
    def is_subnormal(self):
        """Whether `t` has less digits in an f64, as it is or along the scaled direction."""
        return 0 < abs(self.t) < TINY * max(1, self.length)

    @property
    def nearest(self):
        """The f64 nearest to `t`, but on its side of 0: Python rounds a quotient of integers correctly."""
        try:
            nearest = self.t.numerator / self.t.denominator
        except OverflowError:
            nearest = np.inf if self.t > 0 else -np.inf
        return nearest or (5e-324 if self.t > 0 else -5e-324 if self.t < 0 else 0.0)


@dataclass
class Outcome:
    """How many rays hit, and how many had several triangles to choose from."""

    hits: int = 0
    choices: int = 0


def check(mesh, origins, directions, t_min=0.0, t_max=np.inf, precision="single"):
    """Hold the answers of both accelerators against the oracle.

    `t` is the f64 nearest to the exact one, that is what the ends of a ray are compared with, and of equal
    ones the lowest primitive counts.
    """
    scene = rw.Scene(mesh, precision=precision)
    brute = rw.Scene(mesh, accelerator=rw.BruteForce(), precision=precision)
    hits, others = (s.intersect(origins, directions, t_min, t_max) for s in (scene, brute))
    assert np.array_equal(hits.t, others.t)
    assert np.array_equal(hits.primitive_id, others.primitive_id)
    assert np.array_equal(hits.uv, others.uv)
    for s in (scene, brute):
        assert np.array_equal(s.occluded(origins, directions, t_min, t_max), hits.hit)
    assert np.array_equal(hits.hit, hits.primitive_id >= 0)

    starts, ways = np.broadcast_arrays(*np.atleast_2d(origins, directions))
    nears, fars = np.broadcast_to(t_min, len(starts)), np.broadcast_to(t_max, len(starts))
    triangles = rounded(mesh, precision)
    outcome = Outcome()
    for i, found in enumerate(candidates(triangles, starts.astype(np.float64), ways.astype(np.float64))):
        answer = (float(hits.t[i]), int(hits.primitive_id[i]), hits.uv[i])
        check_ray(found, answer, float(nears[i]), float(fars[i]))
        outcome.hits += answer[1] >= 0
        outcome.choices += len(found) > 1
    return outcome


def rounded(mesh, precision="single"):
    """Give the triangles (F,3,3) as a scene of this precision has them."""
    vertices = mesh.vertices.astype(np.float64)
    return (vertices if precision == "double" else vertices.astype(np.float32).astype(np.float64))[mesh.faces]


def check_ray(found, answer, t_min, t_max):
    t, primitive, uv = answer
    asked_for = [c for c in found if t_min <= c.nearest <= t_max and np.isfinite(c.nearest)]
    if primitive < 0:
        assert (t, primitive, *uv) == (np.inf, -1, 0.0, 0.0)
        assert all(c.is_subnormal for c in asked_for), "a miss, but these are hit"
        return
    first = min(asked_for, key=lambda c: (c.nearest, c.primitive), default=None)
    assert first is not None, f"primitive {primitive} is not hit"
    mine = next(c for c in found if c.primitive == primitive)
    if not mine.is_subnormal and not first.is_subnormal:
        assert (t, primitive) == (first.nearest, first.primitive)
    else:
        # Fewer digits of it are left.
        assert max(abs(Fraction(t) - c.t) for c in (mine, first)) <= 2 * SMALLEST * (1 + mine.length)
    assert t_min <= t <= t_max
    for computed, wanted in zip(uv, mine.uv, strict=True):
        assert abs(Fraction(float(computed)) - wanted) <= mine.uv_slack


def candidates(triangles, origins, directions):
    """For each ray, the triangles that its line meets, (T,3,3) and (N,3) float64."""
    usable = np.isfinite(triangles).all(axis=(1, 2))
    with np.errstate(all="ignore"):
        # A direction without a normal number counts as zero.
        way = np.abs(directions).max(axis=1) >= np.finfo(np.float64).tiny
        valid = np.isfinite(origins).all(axis=1) & np.isfinite(directions).all(axis=1) & way
        step = max(1, 400_000 // max(1, len(triangles)))
        for start in range(0, len(origins), step):
            part = slice(start, start + step)
            open_pairs = doubtful(triangles, origins[part], directions[part]) & usable & valid[part, None]
            for i, row in enumerate(open_pairs):
                ray = origins[start + i].tolist(), directions[start + i].tolist()
                tried = (candidate(int(p), triangles[p].tolist(), *ray) for p in np.flatnonzero(row))
                yield [c for c in tried if c is not None]


def doubtful(triangles, origins, directions):
    """Pairs (N, T) that f64 cannot reject for certain."""
    scaled = np.ldexp(directions, -np.frexp(np.abs(directions).max(axis=1))[1][:, None])
    corners = triangles[None] - origins[:, None, None]
    edges = np.roll(triangles, 1, axis=1) - np.roll(triangles, -1, axis=1)
    size, length = np.abs(corners).max(axis=(2, 3)), np.abs(edges).max(axis=(1, 2))
    # From an edge and one corner rather than from two corners: errors of far origins grow with the distance,
    # not with its square. An edge's volume takes some 20 roundings, each below 2⁻⁵³ of at most 12 size times
    # length (the direction is at most 1); 2⁻⁴⁰ is far more. The constant covers underflow.
    margin = 2.0**-40 * size * length + 1e-290
    planes = np.cross(np.roll(corners, -1, axis=2), edges[None])
    volumes = np.einsum("nj,ntij->nti", scaled, planes)
    positive = (volumes > margin[..., None]).any(axis=2)
    negative = (volumes < -margin[..., None]).any(axis=2)
    return ~(positive & negative & (size < 1e100))


def candidate(primitive, triangle, origin, direction):
    """Decide a pair exactly.

    The line meets a triangle that is not edge-on if it passes no edge on the side opposite to another's.
    """
    points, point_scale = integers([x for p in (*triangle, origin) for x in p])
    d, d_scale = integers(direction)
    o = points[9:]
    a, b, c = (minus(points[i : i + 3], o) for i in (0, 3, 6))
    volumes = [dot(d, cross(b, c)), dot(d, cross(c, a)), dot(d, cross(a, b))]
    total = sum(volumes)
    if total == 0 or (min(volumes) < 0 < max(volumes)):
        return None
    normal = cross(minus(b, a), minus(c, a))
    assert dot(normal, d) == total
    t = Fraction(dot(normal, a) * d_scale, total * point_scale)
    weights = Fraction(volumes[1], total), Fraction(volumes[2], total)
    length = Fraction(d_scale) / Fraction(2) ** (max(map(abs, d)).bit_length() - 1)
    return Candidate(primitive, t, weights, slack_of_weights([a, b, c], d, total), length)


def slack_of_weights(corners, d, total):
    """How far the weights of corners may be off.

    A weight may be off by `e` (see rust/shapes/src/triangle/edge.rs) if it is computed in f64, and its share
    of the total by 4 e / (|total| - 3 e). Where the total is at most 6 e, some weight is too small to tell
    its sign, and all are computed with less error, in the end with none.
    """
    size = max(abs(x) for c in corners for x in c)
    # d relative to its power of two is below 2; the total is scaled likewise.
    power = 1 << (max(map(abs, d)).bit_length() - 1)
    e = 208 * UNIT * 2 * size * size
    scaled_total = Fraction(abs(total), power)
    if scaled_total <= 6 * e:
        # Then they are computed from the edges themselves, which errs less.
        edges = [minus(p, q) for p, q in itertools.combinations(corners, 2)]
        e = 184 * UNIT * size * max(abs(x) for edge in edges for x in edge)
    return 8 * UNIT + (4 * e / (scaled_total - 3 * e) if scaled_total > 6 * e else 0)


def integers(values):
    """Integers and a power of two: each value is its integer over the power."""
    ratios = [x.as_integer_ratio() for x in values]
    scale = max(q for _, q in ratios)
    return [p * (scale // q) for p, q in ratios], scale


def minus(p, q):
    return [x - y for x, y in zip(p, q, strict=True)]


def dot(p, q):
    return sum(x * y for x, y in zip(p, q, strict=True))


def cross(p, q):
    return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]
