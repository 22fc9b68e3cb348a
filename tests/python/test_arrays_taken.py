"""Numbers of other libraries are taken as they are; with a unit or a mask, or elsewhere, they are refused."""

import numpy as np
import pytest

import raywright as rw
from raywright.arrays import real_array

POINTS = np.array([(0.5, 0.25, 2.0), (4.0, 4.0, 4.0)])
CORNERS, FACES = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]), [(0, 1, 2), (0, 2, 3)]


class Capsule:
    """An array that has DLPack and nothing else."""

    def __init__(self, array, device=(1, 0)):
        self.array, self.device = array, device

    def __dlpack__(self, **how):
        return self.array.__dlpack__()

    def __dlpack_device__(self):
        return self.device


class Unit:
    """A unit as those of pint and astropy are told."""

    def __init__(self, name):
        self.name = name

    def __str__(self):
        return self.name


Unit.__module__ = "pint"


class Quantity:
    """As pint has it: it becomes an array, and loses its unit."""

    def __init__(self, magnitude, unit):
        self.magnitude, self.units = magnitude, Unit(unit)

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self.magnitude)


class Masked(np.ndarray):
    """As astropy has it: an array with a mask that is no np.ma."""

    mask = np.array([(False, True, False), (False, False, False)])


def library(name):
    return pytest.importorskip(name, exc_type=ImportError)


def heavy(*values):
    """A case of a library that takes seconds to import."""
    return pytest.param(*values, marks=pytest.mark.slow)


WAYS = {
    "pandas": lambda a: library("pandas").DataFrame(a, columns=["x", "y", "z"]),
    "pandas of nullable columns": lambda a: library("pandas").DataFrame(a, dtype="Float64"),
    "polars": lambda a: library("polars").DataFrame(a, schema=["x", "y", "z"]),
    "xarray": lambda a: library("xarray").DataArray(a, dims=("point", "axis"), attrs={"units": "m"}),
    "pint": lambda a: a * library("pint").UnitRegistry().dimensionless,
    "DLPack": Capsule,
    "quantity without unit": lambda a: Quantity(a, "dimensionless"),
    "memoryview": memoryview,
    "big-endian": lambda a: a.astype(">f8"),
    "strided": lambda a: np.repeat(a, 2, axis=1)[:, ::2],
    "masked nowhere": np.ma.array,
}
HEAVY = {
    "astropy": lambda a: a * library("astropy.units").dimensionless_unscaled,
    "torch": lambda a: library("torch").tensor(a),
    "jax": lambda a: library("jax").numpy.asarray(a),
    "jax's bfloat16": lambda a: library("jax").numpy.asarray(a, "bfloat16"),
    "open3d": lambda a: library("open3d").core.Tensor(a),
}


@pytest.mark.parametrize(
    "way",
    [
        *(pytest.param(way, id=name) for name, way in WAYS.items()),
        *(pytest.param(way, id=name, marks=pytest.mark.slow) for name, way in HEAVY.items()),
    ],
)
def test_points_rays_and_meshes_are_those_of_numpy(way):
    scene = rw.Scene(rw.Mesh(CORNERS, FACES))
    hits = scene.intersect(way(POINTS), [0, 0, -1.0])
    assert hits.t.tolist() == [2, np.inf]
    assert scene.closest_point(way(POINTS)).distance.tolist() == [2, np.sqrt(9 + 9 + 16)]
    mesh = rw.Mesh(way(CORNERS), FACES, normals=way(np.tile([0.0, 0, 1], (4, 1))))
    np.testing.assert_array_equal(mesh.vertices, CORNERS)
    assert rw.Scene(mesh).occluded(POINTS, [0, 0, -1.0]).tolist() == [True, False]


@pytest.mark.parametrize(
    ("name", "table", "column"),
    [
        ("pandas", "DataFrame", "Series"),
        ("polars", "DataFrame", "Series"),
        heavy("torch", "tensor", "tensor"),
        (None,) * 3,
    ],
)
def test_faces_and_masks_too(name, table, column):
    if name is None:
        faces, mask = Capsule(np.array(FACES)), Capsule(np.array([True, False]))
    else:
        faces = getattr(library(name), table)(np.array(FACES))
        mask = getattr(library(name), column)([True, False])
    mesh = rw.Mesh(CORNERS, faces)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    scene = rw.Scene(mesh)
    assert scene.occluded([POINTS[0]] * 2, [0, 0, -1.0], mask=mask).tolist() == [True, False]
    assert scene.occluded(POINTS[0], [0, 0, -1.0], shapes=Capsule(np.array([False]))).tolist() is False


def test_nothing_that_is_read_as_it_is_gets_copied(tmp_path):
    path = tmp_path / "points.npy"
    np.save(path, POINTS)
    sealed = POINTS.copy()
    sealed.setflags(write=False)
    for given in (POINTS, POINTS.astype(np.float32), np.load(path, mmap_mode="r"), sealed, POINTS[::-1]):
        assert np.shares_memory(real_array("points", given), given)
    assert np.shares_memory(real_array("points", Capsule(POINTS)), POINTS)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_mesh_keeps_arrays_that_nobody_can_write_to(dtype):
    corners, faces = CORNERS.astype(dtype), np.array(FACES, np.uint32)
    for array in (corners, faces):
        array.setflags(write=False)
    mesh = rw.Mesh(corners, faces, uv=corners[:, :2], normals=corners[:])
    assert np.shares_memory(mesh.vertices, corners)
    assert np.shares_memory(mesh.normals, corners)
    assert np.shares_memory(mesh.faces, faces)
    # These are not contiguous.
    assert not np.shares_memory(mesh.uv, corners)
    again = rw.Mesh(mesh.vertices, mesh.faces[:1])
    assert np.shares_memory(again.vertices, corners)


def test_a_mesh_copies_what_is_written_to_elsewhere():
    corners = CORNERS.copy()
    view = corners[:]
    view.setflags(write=False)
    mesh = rw.Mesh(view, FACES)
    corners[:] = 7
    np.testing.assert_array_equal(mesh.vertices, CORNERS)


def test_pictures_too():
    pixels = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    np.testing.assert_array_equal(rw.ImageTexture(Capsule(pixels)).image, pixels)
    with pytest.raises(ValueError, match="image must have no masked entries, got 3"):
        rw.ImageTexture(np.ma.masked_less(pixels, 3))
    with pytest.raises(TypeError, match="image must be numbers without a unit, got Quantity in lux"):
        rw.ImageTexture(Quantity(pixels, "lux"))
    with pytest.raises(TypeError, match=r"on CUDA:0; pass its \.cpu\(\)"):
        rw.ImageTexture(Capsule(pixels, (2, 0)))


ML = Quantity(POINTS, "meter")


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (
            ML,
            TypeError,
            "must be numbers without a unit, got Quantity in meter: convert it, and pass its "
            ".to('meter').magnitude",
        ),
        ([ML, ML], TypeError, "must be numbers without a unit, got list of Quantity in meter: convert it, "),
        (
            [(1.0, Quantity(2.0, "deg"), 3.0)],
            TypeError,
            "must be numbers without a unit, got tuple of Quantity",
        ),
        (
            Capsule(POINTS, (2, 1)),
            TypeError,
            "must be an array of numbers in the memory of the CPU, got Capsule on CUDA:1; pass its .cpu()",
        ),
        (np.ma.masked_greater(POINTS, 3), ValueError, "must have no masked entries, got 3: fill them"),
        (POINTS.view(Masked), ValueError, "must have no masked entries, got 1: fill them, as with NaN"),
        ((x for x in POINTS), TypeError, "must be real numbers, got generator; pass a list of it"),
        (
            [(0.0, None, 1.0)],
            TypeError,
            "must be real numbers, got list of dtype object, with None at [0, 1]",
        ),
        (
            np.array([(1.0, 2.0, 3.0)], [("x", float), ("y", float), ("z", float)]),
            TypeError,
            "must be real numbers, got dtype [('x', '<f8'), ('y', '<f8'), ('z', '<f8')]; pass "
            "numpy.lib.recfunctions.structured_to_unstructured of the columns that count",
        ),
    ],
)
def test_the_cause_is_named(value, error, message):
    scene = rw.Scene(rw.Sphere((0, 0, 0), 1))
    for name, ask in (
        ("points", lambda: scene.contains(value)),
        ("vertices", lambda: rw.Mesh(value, [(0, 0, 0)])),
        ("origins", lambda: scene.intersect(value, (0, 0, 1))),
    ):
        with pytest.raises(error) as caught:
            ask()
        assert str(caught.value).startswith(f"{name} {message}")


def test_lengths_with_a_unit_are_refused_one_by_one():
    length = Quantity(2.0, "cm")
    for name, ask in (
        ("radius", lambda: rw.Sphere((0, 0, 0), length)),
        ("t_max", lambda: rw.Scene(rw.Sphere((0, 0, 0), 1)).occluded((0, 0, 2), (0, 0, -1), t_max=length)),
        ("weld", lambda: rw.Scene([], weld=length)),
    ):
        with pytest.raises(TypeError, match=f"{name} must be .*without a unit, got Quantity in cm"):
            ask()


@pytest.mark.parametrize(
    ("name", "made", "message"),
    [
        ("pint", lambda m: [1, 2, 3] * m.UnitRegistry().meter, "got Quantity in meter"),
        ("pint", lambda m: [3 * m.UnitRegistry().meter] * 3, "got list of Quantity in meter"),
        ("pint", lambda m: [1, 2, 3] * m.UnitRegistry().degree, "got Quantity in degree"),
        heavy(
            "astropy.units",
            lambda m: [1, 2, 3] * m.m,
            r"got Quantity in m: convert it, and pass its \.to_value\('m'\)",
        ),
        ("pandas", lambda m: m.DataFrame({"x": ["a"], "y": [1.0], "z": [2.0]}), r"with 'a' at \[0, 0\]"),
        (
            "pandas",
            lambda m: m.DataFrame([[1, None, 2]], dtype="Float64"),
            r"with <NA> at \[0, 1\]; pass its \.to_numpy",
        ),
        ("polars", lambda m: m.Series([[1.0, 2, 3]]), r"pass its \.to_list\(\)"),
        ("polars", lambda m: m.DataFrame({"x": [1.0]}).lazy(), r"got LazyFrame; pass its \.collect\(\)"),
        (
            "xarray",
            lambda m: m.Dataset({"x": ("n", [1.0, 2, 3])}),
            r"pass one of its variables, or its \.to_array",
        ),
        ("scipy.sparse", lambda m: m.csr_matrix(POINTS), r"got csr_matrix; pass its \.toarray\(\)"),
        heavy("torch", lambda m: m.ones(3, requires_grad=True), r"pass its \.detach\(\)\.numpy\(\)"),
        heavy("torch", lambda m: m.ones(3, device="meta"), r"pass its \.cpu\(\)\.numpy\(\)"),
        heavy("torch", lambda m: m.ones(3, dtype=m.bfloat16), r"pass its \.float\(\)\.numpy\(\)"),
        heavy("torch", lambda m: m.eye(3).to_sparse(), r"pass its \.to_dense\(\)\.numpy\(\)"),
    ],
)
def test_what_a_library_has_instead_of_numbers_is_refused_with_a_cure(name, made, message):
    with pytest.raises((TypeError, ValueError), match=message):
        real_array("points", made(library(name)))
