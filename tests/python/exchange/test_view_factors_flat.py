"""View factors of triangles that are nearly in one plane, against integrals around both of forty digits."""

import json
import math
from itertools import pairwise, product
from pathlib import Path
from typing import Any

import pytest
from mpmath import mp

import raywright as rw

DIGITS = 40


def exchanged(one: Any, other: Any) -> Any:
    """The area of one triangle times its view factor, 1/(2 pi) of the sum over both edges of ln r dp.dq."""
    with mp.workdps(DIGITS):
        one, other = ([[mp.mpf(float(x)) for x in corner] for corner in of] for of in (one, other))
        # The tolerance of `quad` is absolute, so sizes must be about 1.
        size = max(abs(x) for corner in (*one, *other) for x in corner)
        one, other = ([[x / size for x in corner] for corner in of] for of in (one, other))
        pairs = product(range(3), range(3))
        edges = (along(one[i], one[(i + 1) % 3], other[j], other[(j + 1) % 3]) for i, j in pairs)
        return size**2 * mp.fsum(edges) / (2 * mp.pi)


def minus(a: Any, b: Any) -> Any:
    return [x - y for x, y in zip(a, b, strict=True)]


def dot(a: Any, b: Any) -> Any:
    return mp.fsum(x * y for x, y in zip(a, b, strict=True))


def along(p: Any, p_end: Any, q: Any, q_end: Any) -> Any:
    """The double integral of ln r dp.dq along two edges: the inner one in closed form."""
    u, v = minus(p_end, p), minus(q_end, q)
    a, b = mp.sqrt(dot(u, u)), mp.sqrt(dot(v, v))
    u, v = [x / a for x in u], [x / b for x in v]
    cosine = dot(u, v)
    if not cosine:
        return mp.mpf(0)

    def inner(s: Any) -> Any:
        here = [x + s * k for x, k in zip(p, u, strict=True)]
        first, last = minus(q, here), minus(q_end, here)
        start, end = dot(first, v), dot(last, v)
        across = [first[i] * v[j] - first[j] * v[i] for i, j in ((1, 2), (2, 0), (0, 1))]
        square, far = dot(first, first), dot(last, last)
        height = mp.sqrt(dot(across, across))
        found = -b
        found += end * mp.log(far) / 2 if far else 0
        found -= start * mp.log(square) / 2 if square else 0
        found += height * mp.atan2(height * (end - start), height * height + start * end) if height else 0
        return found

    # Split at the other edge's ends and its line, and more often next to these.
    places = [dot(minus(end, p), u) for end in (q, q_end)]
    if 1 - cosine**2 > mp.mpf(10) ** -30:
        way = minus(q, p)
        places.append((dot(way, u) - dot(way, v) * cosine) / (1 - cosine**2))
    cuts = sorted({mp.mpf(0), a, *(place for place in places if 0 < place < a)})
    finer = [cuts[0]]
    for low, high in pairwise(cuts):
        if high - low > a * mp.mpf(10) ** -25:
            near = [(high - low) * mp.mpf(10) ** -k for k in (12, 8, 4)]
            finer += [low + x for x in near] + [high - x for x in reversed(near)] + [high]
    return cosine * mp.quad(inner, finer, maxdegree=6)


def hinged(kind: str, bend: float, size: float) -> tuple[Any, Any]:
    """Two triangles about the y-axis, whose planes are so far off one plane."""
    sine, cosine = math.sin(bend), math.cos(bend)
    apex = (-0.8 * cosine, 0.6, 0.8 * sine)
    one = [(0.9, 0.3, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0)]
    if kind == "edge":
        other = [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0), apex]
    elif kind == "part of an edge":
        other = [(0.0, 0.5, 0.0), (0.0, 1.75, 0.0), apex]
    elif kind == "corner":
        one[1] = (0.5, 1.0, 0.0)
        other = [(0.0, 0.0, 0.0), (-0.4 * cosine, 1.0, 0.4 * sine), apex]
    else:
        # A distance for the edge that is nearly shared; it is turned a little, too.
        gap = float(kind)
        start, end = (gap * cosine, gap * sine), (3 * gap * cosine, 3 * gap * sine)
        other = [(-start[0], 0.1, start[1]), (-end[0], 1.25, end[1]), apex]
    return tuple([[size * x for x in corner] for corner in of] for of in (one, other))


# The kind, the bend and the size of each pair, and `exchanged` of it. At a bend of 1e-8 that is 4e-18 of the
# square of the size, of terms that are about 1.
with (Path(__file__).parents[1] / "data" / "flat_view_factors.json").open(encoding="utf-8") as file:
    PAIRS = json.load(file)


@pytest.mark.parametrize(("kind", "bend", "size", "truth"), PAIRS)
def test_nearly_in_one_plane(kind: str, bend: float, size: float, truth: float) -> None:
    meshes = [rw.Mesh(of, [[0, 1, 2]]) for of in hinged(kind, bend, size)]
    found = rw.view_factors(rw.Scene(meshes, precision="double"), progress=False)
    assert abs(found.matrix[0, 1] * found.areas[0] / truth - 1) < 1e-9
    assert abs(found.matrix[1, 0] * found.areas[1] / truth - 1) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "bend", "size", "truth"), PAIRS[::6])
def test_what_is_kept_is_the_integral(kind: str, bend: float, size: float, truth: float) -> None:
    assert abs(exchanged(*hinged(kind, bend, size)) / truth - 1) < 1e-15
