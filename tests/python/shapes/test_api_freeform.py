"""Toruses, polygons and implicit surfaces: what they refuse, keep, and say of themselves."""

import math
import pickle

import numpy as np
import pytest

from raywright import shapes

L = [(0, 0, 1), (8, 0, 1), (8, 4, 1), (4, 4, 1), (4, 8, 1), (0, 8, 1)]
HOLE = [(1, 1, 1), (1, 3, 1), (3, 3, 1), (3, 1, 1)]
EXAMPLES = [
    shapes.Torus((1, 2, 3), (0, 1, 1), 2, 0.5),
    shapes.Polygon(L, [HOLE]),
    shapes.Implicit("x*x + y*y + z*z - 1", (-1, -1, -1), (1, 1, 2)),
]


@pytest.mark.parametrize("shape", EXAMPLES, ids=lambda shape: type(shape).__name__)
def test_values(shape):
    again = pickle.loads(pickle.dumps(shape))
    assert again == shape
    assert hash(again) == hash(shape)
    assert repr(again) == repr(shape)
    values = {name: getattr(shape, name) for name in shape.__dataclass_fields__}
    assert type(shape)(**{**values, "transform": np.diag([2, 1, 1, 1])}) != shape


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: shapes.Torus(major_radius=-1), "major_radius must be greater than 0, got -1"),
        (lambda: shapes.Torus(axis=(0, 0, 0)), "axis must not be zero"),
        (
            lambda: shapes.Torus(minor_radius=1.5),
            "minor_radius must be at most major_radius = 1.0, got 1.5: the surface would pass through itself",
        ),
        (lambda: shapes.Polygon(L[:2]), "polygon: the outline has 2 points, expected at least 3"),
        (
            lambda: shapes.Polygon([(0, 0, 0), (2, 0, 0), (0, 1, 0), (3, 3, 0)]),
            "polygon: edge 1 of the outline crosses or touches edge 3 of the outline",
        ),
        (
            lambda: shapes.Polygon([*L[:3], (4, 4, 1.1), *L[4:]]),
            "polygon: point 3 of the outline lies .* off the plane, expected at most",
        ),
        (
            lambda: shapes.Polygon(L, [HOLE, [(5, 5, 1), (6, 5, 1), (5, 6, 1)]]),
            "polygon: hole 1 is outside the outline",
        ),
        (lambda: shapes.Polygon([(0, 0), (1, 0), (0, 1)]), r"outline must have shape \(N, 3\)"),
        (lambda: shapes.Implicit("x + foo"), "unknown name 'foo' at column 5; known: x, y, z, pi, e, abs"),
        (lambda: shapes.Implicit("x +"), "a number, a name or .* at column 4, but the expression ends there"),
        (lambda: shapes.Implicit("x^2"), r"unexpected '\^' at column 2, powers are written \*\*"),
        (lambda: shapes.Implicit("x", (0, 0, 0), (1, 0, 1)), "min is .* max is"),
    ],
)
def test_what_cannot_be_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_what_is_of_another_type_is_refused():
    with pytest.raises(TypeError, match="expression must be a string, got 3"):
        shapes.Implicit(3)


def test_areas_and_bounds():
    torus, polygon, sphere = EXAMPLES
    assert torus.area == pytest.approx(4 * math.pi**2, rel=1e-14)
    assert polygon.area == pytest.approx(44, rel=1e-14)
    assert sphere.area == pytest.approx(4 * math.pi, rel=1e-3)
    assert polygon.bounds.tolist() == [[0, 0, 1], [8, 8, 1]]
    reach = 2 * math.sqrt(0.5) + 0.5
    np.testing.assert_allclose(
        torus.bounds, [[-1.5, 2 - reach, 3 - reach], [3.5, 2 + reach, 3 + reach]], rtol=0, atol=1e-14
    )
