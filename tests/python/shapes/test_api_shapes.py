"""Shapes that are no meshes: what they refuse, keep, and say of themselves."""

import math
import pickle

import numpy as np
import pytest

import raywright as rw
from raywright import shapes

TURN = np.array([[0.0, -2.0, 0.0, 1.0], [2.0, 0.0, 0.0, 2.0], [0.0, 0.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]])
EXAMPLES = [
    shapes.Sphere((1, 2, 3), 2),
    shapes.Plane((1, 2, 3), (0, 0, 2)),
    shapes.Disk((1, 2, 3), (0, 1, 1), 2, 1),
    shapes.Cylinder((1, 2, 3), (2, 2, 3), 0.5, capped=False),
    shapes.Cone((1, 2, 3), (1, 2, 5), 2, 1),
    shapes.Box((-1, -2, -3), (1, 2, 3)),
    shapes.Ellipsoid((1, 2, 3), (1, 2, 3)),
    shapes.Paraboloid((1, 2, 3), (1, 2, 4), 2),
]


@pytest.mark.parametrize("shape", EXAMPLES, ids=lambda shape: type(shape).__name__)
def test_values(shape):
    again = pickle.loads(pickle.dumps(shape))
    assert again == shape
    assert hash(again) == hash(shape)
    assert repr(again) == repr(shape)
    assert repr(shape).startswith(type(shape).__name__ + "(")
    values = {name: getattr(shape, name) for name in shape.__dataclass_fields__}
    moved = type(shape)(**{**values, "transform": TURN, "material": rw.Diffuse(0.2), "emission": 2})
    assert moved != shape
    copy = pickle.loads(pickle.dumps(moved))
    assert copy == moved
    assert not copy.transform.flags.writeable
    assert copy.emission == (2, 2, 2)
    with pytest.raises(AttributeError):
        shape.material = rw.Diffuse()
    assert shape != "something else"


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: shapes.Sphere(radius=-1), "radius must be greater than 0, got -1"),
        (lambda: shapes.Sphere(radius=0), "radius must be greater than 0, got 0"),
        (lambda: shapes.Sphere(radius=math.nan), "radius must be finite, got nan"),
        (lambda: shapes.Sphere(center=(0, math.inf, 0)), "center must be finite"),
        (lambda: shapes.Plane(normal=(0, 0, 0)), "normal must not be zero"),
        (
            lambda: shapes.Disk(inner_radius=1),
            "inner_radius must be at least 0 and less than radius = 1.0, got 1.0",
        ),
        (lambda: shapes.Cylinder((1, 2, 3), (1, 2, 3)), "base and tip must differ"),
        (lambda: shapes.Cylinder(radius=-2), "radius must be greater than 0, got -2"),
        (lambda: shapes.Cone(base_radius=-1), "base_radius must be at least 0, got -1.0"),
        (lambda: shapes.Cone(base_radius=0), "base_radius and tip_radius must not both be 0"),
        (lambda: shapes.Box((0, 2, 0), (1, 1, 1)), "its y is 2.0, and that of max 1.0"),
        (lambda: shapes.Ellipsoid(semi_axes=(1, 0, 1)), "semi_axes must each be greater than 0"),
        (lambda: shapes.Paraboloid((0, 0, 1), (0, 0, 1)), "apex and tip must differ"),
        (lambda: shapes.Sphere(transform=np.eye(3)), r"transform must have shape \(4, 4\), got \(3, 3\)"),
        (
            lambda: shapes.Sphere(transform=np.diag([1, 1, 0, 1])),
            "transform must have an inverse, but its determinant is 0",
        ),
        (
            lambda: shapes.Sphere(transform=np.full((4, 4), np.nan)),
            "transform must be finite, got nan in row 0, column 0",
        ),
        (lambda: shapes.Sphere(transform=np.ones((4, 4))), "last row"),
    ],
)
def test_what_cannot_be_is_refused(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_what_is_of_another_type_is_refused():
    with pytest.raises(TypeError, match="material must be"):
        shapes.Sphere(material="red")
    with pytest.raises(TypeError, match="radius must be real numbers"):
        shapes.Sphere(radius="1")
    with pytest.raises(TypeError, match="capped must be True or False"):
        shapes.Cone(capped=1)


def test_a_matrix_is_singular_only_if_it_is_exactly():
    # Rows that are multiples of each other, except for one unit in the last place.
    rows = np.array([[1, 2, 3, 0], [0.1, 0.2, 0.3, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
    exact = np.array([[1, 2, 3, 0], [2, 4, 6, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    with pytest.raises(ValueError, match="determinant is 0"):
        shapes.Sphere(transform=exact)
    nearly = exact.copy()
    nearly[1, 1] = np.nextafter(4.0, 5.0)
    assert shapes.Sphere(transform=nearly).transform is not None
    # In doubles, 0.1 times 2 is 0.2: this one is singular too.
    with pytest.raises(ValueError, match="determinant is 0"):
        shapes.Sphere(transform=rows)


def test_areas_and_bounds_have_their_closed_forms():
    pi = math.pi
    areas = [16 * pi, math.inf, 3 * pi, pi, 8 * pi - 3 * pi + 3 * pi * math.sqrt(5), 88, None, None]
    for shape, area in zip(EXAMPLES, areas, strict=True):
        if area is not None:
            assert shape.area == pytest.approx(area, rel=1e-13)
    moved = shapes.Sphere((1, 2, 3), 2, transform=TURN)
    assert moved.area == pytest.approx(64 * pi, rel=1e-13)
    center = TURN[:3, :3] @ (1, 2, 3) + TURN[:3, 3]
    np.testing.assert_allclose(moved.bounds, [center - 4, center + 4], rtol=0, atol=2e-14)
    assert shapes.Plane().bounds.tolist() == [[-math.inf, -math.inf, 0], [math.inf, math.inf, 0]]
    assert shapes.Box((1, 2, 3), (4, 5, 6)).bounds.tolist() == [[1, 2, 3], [4, 5, 6]]
    # A prolate spheroid, and a sphere that is stretched into one.
    e = math.sqrt(3) / 2
    spheroid = 2 * pi * (1 + 2 / e * math.asin(e))
    assert shapes.Ellipsoid(semi_axes=(1, 2, 1)).area == pytest.approx(spheroid, rel=1e-13)
    assert shapes.Sphere(transform=np.diag([1, 1, 2, 1])).area == pytest.approx(spheroid, rel=1e-13)
