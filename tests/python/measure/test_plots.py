"""Values drawn on meshes, at points and as pictures by matplotlib."""

import copy
import pickle
import sys

import numpy as np
import pytest
import trimesh
from PIL import Image as Pillow

import raywright as rw
from raywright.exchange.matrix_plot import block_means

measure = rw.measure


@pytest.fixture
def plt():
    pytest.importorskip("matplotlib").use("Agg")
    import matplotlib.pyplot as plt

    yield plt
    plt.close("all")


@pytest.fixture(scope="module")
def plates():
    """A floor below a smaller roof, a fan of faces each."""

    def fan(height, reach):
        angle = np.linspace(0, 2 * np.pi, 7)[:-1]
        rim = np.stack([reach * np.cos(angle), np.full(6, height), -reach * np.sin(angle)], axis=-1)
        faces = [(0, k + 1, (k + 1) % 6 + 1) for k in range(6)]
        return rw.Mesh(np.concatenate([[(0, height, 0)], rim]), faces)

    return rw.Scene([fan(0.0, 2.0), fan(1.0, 1.0)])


def surface(ax):
    """The polygons of axes and their colors, in the order in which they were given."""
    [faces] = [one for one in ax.collections if type(one).__name__ == "Poly3DCollection"]
    return faces, np.asarray(faces._facecolor3d)


def test_faces_have_the_colors_of_their_values(plt, plates):
    found = measure.sky_view(plates, rays=64)
    ax = found.plot()
    _, colors = surface(ax)
    assert len(colors) == len(found.value) == 12
    # One plane has one shade, so that its colors are those of the bar up to a factor.
    expected = plt.colormaps["viridis"](plt.Normalize(found.value.min(), found.value.max())(found.value))
    ratio = colors[:, :3] / expected[:, :3]
    assert np.allclose(ratio, ratio[0, 0], rtol=1e-9)
    assert 0.8 <= ratio[0, 0] <= 1.0
    # y is upright.
    assert (ax.get_xlabel(), ax.get_ylabel(), ax.get_zlabel()) == ("z", "x", "y")
    assert ax.get_zlim() == (0.0, 1.0)
    assert len(plt.gcf().axes) == 2


def test_a_value_of_every_vertex_colors_the_faces(plt, plates):
    vertices = np.concatenate([mesh.vertices for mesh in plates.shapes])
    height = vertices[:, 1]
    for ax in (measure.plot(plates, height), measure.plot(plates, height, vertices)):
        _, colors = surface(ax)
        low, high = plt.colormaps["viridis"]([0.0, 1.0])[:, :3]
        assert np.allclose(colors[:6, :3] / low, colors[0, 0] / low[0])
        assert np.allclose(colors[6:, :3] / high, colors[6, 0] / high[0])


def test_what_has_no_value_is_gray_and_infinity_is_an_end(plt, plates):
    values = np.arange(12.0)
    values[3], values[7] = np.nan, np.inf
    ax = measure.plot(plates, values, label="thickness", up="y")
    _, colors = surface(ax)
    assert np.ptp(colors[3, :3]) == 0
    top = np.array(plt.colormaps["viridis"](1.0))[:3]
    assert np.allclose(colors[7, :3] / top, colors[11, :3] / top)
    bar = plt.gcf().axes[1]
    assert bar.get_ylabel() == "thickness"
    assert ax.figure.axes[1]._colorbar.extend == "max"


def test_points_are_drawn_where_they_are(plt, plates):
    points = np.random.default_rng(0).uniform(-1, 1, (4, 5, 3))
    found = measure.ambient_visibility(plates, points, (0, 1, 0), rays=16)
    ax = found.plot(name="standard_error", up="z")
    [cloud] = [one for one in ax.collections if type(one).__name__ == "Path3DCollection"]
    assert np.array_equal(
        np.stack([np.asarray(part) for part in cloud._offsets3d], -1), points.reshape(-1, 3)
    )
    assert ax.get_zlabel() == "z"


@pytest.mark.parametrize("kind", ["sky", "sun", "sight", "scan", "closest", "hits", "radiosity"])
def test_results_draw_themselves_to_files(plt, plates, kind, tmp_path):
    down = plates.intersect([(0.1, 5, 0.2), (1.5, 5, 0), (9, 9, 9)], (0, -1, 0))
    result = {
        "sky": lambda: measure.sky_view(plates, down, rays=16),
        "sun": lambda: measure.solar_exposure(plates, sun=[(0, 1, 0), (0, 1, 1)]),
        "sight": lambda: measure.line_of_sight(plates, (0, 3, 0), plates.shapes[0].vertices),
        "scan": lambda: measure.lidar(
            plates, measure.SpinningLidar(elevations=(-30.0, 20.0), columns=36, position=(0, 0.5, 0))
        ),
        "closest": lambda: plates.closest_point(np.random.default_rng(1).normal(size=(20, 3))),
        "hits": lambda: down,
        "radiosity": lambda: rw.radiosity(rw.scenes.cornell_box()[0], rays=2000),
    }[kind]()
    path = tmp_path / "plot.png"
    result.plot(path)
    with Pillow.open(path) as picture:
        assert min(picture.size) > 300
        # More than axes and a bar: several colors.
        assert len(np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0)) > 50
    assert plt.get_fignums() == []


def test_rows_and_columns_of_hits_are_a_picture(plt):
    ball = rw.Mesh.of(trimesh.creation.icosphere(subdivisions=2))
    ball = rw.Mesh(ball.vertices, ball.faces, vertex_attributes={"h": ball.vertices[:, 1]})
    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=24, height=16)
    hits = rw.Scene(ball).intersect(*camera.rays())
    shown = np.ma.filled(hits.plot().images[0].get_array(), np.nan)
    assert np.array_equal(shown, np.where(hits.hit, hits.t, np.nan), equal_nan=True)
    faces = np.ma.filled(hits.plot(name="primitive_id").images[0].get_array(), np.nan)
    assert np.array_equal(faces, np.where(hits.hit, hits.primitive_id, np.nan), equal_nan=True)
    height = np.ma.filled(hits.plot(name="h").images[0].get_array(), np.nan)
    assert np.array_equal(height, hits.interpolate("h"), equal_nan=True)
    with pytest.raises(ValueError, match=r"^name must be an attribute of a mesh of the scene, got 'wings'"):
        hits.plot(name="wings")


def test_view_factors_are_a_matrix(plt, plates):
    found = rw.view_factors(plates)
    ax = found.plot()
    shown = np.ma.filled(ax.images[0].get_array(), np.nan)
    assert np.array_equal(shown, np.where(found.matrix > 0, found.matrix, np.nan), equal_nan=True)
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("to", "from")
    assert found.plot(name="standard_error") is not ax
    with pytest.raises(
        ValueError, match=r"^name must be one of 'matrix', 'standard_error', got 'to_surroundings'$"
    ):
        found.plot(name="to_surroundings")


@pytest.mark.parametrize(("count", "most"), [(7, 7), (7, 3), (8, 3), (12, 4), (5, 1)])
def test_large_matrices_are_drawn_by_the_means_of_blocks(count, most):
    sparse = pytest.importorskip("scipy.sparse")
    rng = np.random.default_rng(count)
    matrix = rng.uniform(size=(count, count)) * (rng.uniform(size=(count, count)) > 0.5)
    step = -(-count // most)
    starts = range(0, count, step)
    means = [[matrix[i : i + step, j : j + step].mean() for j in starts] for i in starts]
    assert np.allclose(block_means(matrix, most), means, rtol=1e-14)
    assert np.allclose(block_means(sparse.csr_array(matrix), most), means, rtol=1e-14)


def test_plots_need_matplotlib(plates, monkeypatch):
    for name in [name for name in sys.modules if name.partition(".")[0] == "matplotlib"]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    hits = plates.intersect([(0, 5, 0)], (0, -1, 0))
    for plot in (
        measure.sky_view(plates, rays=16).plot,
        hits.plot,
        rw.view_factors(plates).plot,
        lambda: measure.plot(plates, np.zeros(12)),
    ):
        with pytest.raises(ImportError, match=r"^plots need matplotlib: pip install 'raywright\[plot\]'$"):
            plot()


@pytest.mark.parametrize("again", [copy.copy, copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])
def test_copies_keep_values_but_no_scene(plates, again):
    found = measure.sky_view(plates, rays=16)
    other = again(found)
    assert np.array_equal(other.value, found.value)
    with pytest.raises(ValueError, match=r"^pickles and copies have no scene: use raywright\.measure"):
        other.plot()


@pytest.mark.parametrize(
    ("values", "options", "error", "message"),
    [
        (
            np.zeros(5),
            {},
            ValueError,
            r"values must have shape \(12,\), one per face, or \(14,\), one per v.*",
        ),
        (
            np.zeros(5),
            {"points": np.zeros((4, 3))},
            ValueError,
            r"values must have shape \(4,\), one per p.*",
        ),
        (["a"] * 12, {}, TypeError, r"values must be real numbers or bool, got .*"),
        (np.zeros(12), {"up": "w"}, ValueError, r"up must be one of 'x', 'y', 'z', got 'w'"),
        (
            np.zeros(12),
            {"points": "plot.png"},
            TypeError,
            r"points must be positions, got 'plot.png': .* ax=",
        ),
        (np.zeros(12), {"ax": "plot.gif"}, ValueError, r"a plot is saved as .*"),
    ],
)
def test_what_cannot_be_drawn_is_told(plates, values, options, error, message):
    with pytest.raises(error, match=f"^{message}$"):
        measure.plot(plates, values, **options)


def test_what_is_no_mesh_needs_points(plt):
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1), rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])])
    with pytest.raises(ValueError, match=r"^points must be given: shape 0 is a"):
        measure.plot(scene, [1.0, 2.0])
    ax = measure.plot(scene, [1.0, 2.0], [(0, 0, 1), (1, 0, 0)])
    assert len(surface(ax)[1]) == 1


def test_axes_are_those_given_and_have_three_dimensions(plt, plates):
    _, flat = plt.subplots()
    with pytest.raises(ValueError, match=r"^ax must have three dimensions: "):
        measure.plot(plates, np.zeros(12), ax=flat)
    _, solid = plt.subplots(subplot_kw={"projection": "3d"})
    assert measure.plot(plates, np.zeros(12), ax=solid) is solid
    with pytest.raises(ValueError, match=r"^ax must have two dimensions$"):
        rw.view_factors(plates).plot(solid)
    with pytest.raises(TypeError, match=r"^ax must be matplotlib axes or a path, got int$"):
        measure.plot(plates, np.zeros(12), ax=3)
