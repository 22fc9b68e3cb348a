"""Three filters of pyvista on raywright's rays."""

import numpy as np
import pytest

from raywright.compat import pyvista as compat

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]
pyvista = pytest.importorskip("pyvista", exc_type=ImportError)


@pytest.fixture(autouse=True)
def _installed():
    with compat.install():
        yield


def test_a_segment_meets_a_surface_in_order():
    cube = pyvista.Cube()
    points, cells = cube.ray_trace([-2, 0.125, 0.25], [2, 0.125, 0.25])
    np.testing.assert_array_equal(points, [[-0.5, 0.125, 0.25], [0.5, 0.125, 0.25]])
    assert (points.dtype, cells.dtype) == (cube.points.dtype, np.int64)
    # A cell is a quad, although rays hit one of its two triangles.
    normals = cube.face_normals[cells]
    np.testing.assert_array_equal(normals, [[-1, 0, 0], [1, 0, 0]])
    back = cube.ray_trace([2, 0.125, 0.25], [-2, 0.125, 0.25])
    np.testing.assert_array_equal(back[0], points[::-1])
    np.testing.assert_array_equal(back[1], cells[::-1])
    first, all_cells = cube.ray_trace([-2, 0.125, 0.25], [2, 0.125, 0.25], first_point=True)
    np.testing.assert_array_equal(first, points[0])
    np.testing.assert_array_equal(all_cells, cells)


@pytest.mark.parametrize(
    ("ends", "count"),
    [
        (([0, 0, 0], [1, 0, 0]), 1),
        (([0, 0, 0], [0.5, 0, 0]), 1),
        (([0, 0, 0], [0.49, 0, 0]), 0),
        (([5, 5, 5], [6, 6, 6]), 0),
        (([0.5, 0.5, 2], [0.5, 0.5, -2]), 2),
        (([-1, -1, -1], [1, 1, 1]), 2),
        (([0, 0, 2], [0, 0, 2]), 0),
    ],
)
def test_both_ends_of_a_segment_count_and_edges_once(ends, count):
    points, cells = pyvista.Cube().ray_trace(*ends)
    assert points.shape == (count, 3)
    assert cells.shape == (count,)


def test_many_rays_meet_what_pyvista_finds():
    ball = pyvista.Sphere(theta_resolution=12, phi_resolution=9)
    rng = np.random.default_rng(0)
    origins, ends = rng.normal(size=(2, 50, 3))
    points, rays, cells = ball.multi_ray_trace(origins, ends - origins)
    first = ball.multi_ray_trace(origins, ends - origins, first_point=True)
    assert len(np.unique(first[1])) == len(first[1]) == len(np.unique(rays))
    far = np.linalg.norm(points - origins[rays], axis=1)
    for ray in range(50):
        wanted, _ = compat.ray_trace(ball, origins[ray], origins[ray] + 100 * (ends - origins)[ray])
        mine = rays == ray
        np.testing.assert_allclose(points[mine], wanted, atol=1e-5)
        assert (np.diff(far[mine]) > 0).all()
    triangles = ball.points[ball.regular_faces[cells]]
    heights = np.einsum("ij,ij->i", points - triangles[:, 0], ball.face_normals[cells])
    np.testing.assert_allclose(heights, 0, atol=1e-6)
    assert len(ball.multi_ray_trace(origins, ends - origins, retry=True)[0]) == len(points)


def test_cells_are_those_of_the_caller():
    corners = np.float32([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    mixed = pyvista.PolyData(
        corners,
        verts=np.array([1, 0]),
        lines=np.array([2, 0, 1]),
        faces=np.array([4, 0, 1, 2, 3, 3, 1, 4, 2]),
    )
    at = np.array([[0.5, 0.25, 1], [0.25, 0.5, 1], [1.5, 0.25, 1]])
    assert mixed.multi_ray_trace(at, np.tile([0.0, 0, -1], (3, 1)))[2].tolist() == [2, 2, 3]
    flagged = pyvista.PolyData(corners, verts=np.array([1, 0, 1, 3]), faces=np.array([3, 0, 1, 2]))
    assert flagged.ray_trace([0.5, 0.25, 1], [0.5, 0.25, -1])[1].tolist() == [2]
    strip = pyvista.PolyData(corners[[0, 1, 3, 2]], strips=np.array([4, 0, 1, 2, 3]))
    assert strip.ray_trace(at[0], at[0] - [0, 0, 2])[1].tolist() == [0]
    assert pyvista.PolyData(corners).ray_trace(at[0], at[0] - [0, 0, 2])[1].tolist() == []


def test_answers_follow_the_surface_and_one_tree_serves_many_calls():
    cube = pyvista.Cube()
    ask = ([0.125, 0.25, 2], [0.125, 0.25, 0.125])
    assert cube.ray_trace(*ask)[0].tolist() == [[0.125, 0.25, 0.5]]
    kept = vars(cube)["_raywright_surface"].value
    cube.cell_data["temperature"] = np.arange(6.0)
    assert cube.ray_trace(*ask)[0].tolist() == [[0.125, 0.25, 0.5]]
    assert vars(cube)["_raywright_surface"].value is kept
    cube.points[:, 2] += 0.25
    assert cube.ray_trace(*ask)[0].tolist() == [[0.125, 0.25, 0.75]]
    cube.translate((0, 0, 0.25), inplace=True)
    assert cube.ray_trace(*ask)[0].tolist() == [[0.125, 0.25, 1.0]]
    assert cube.copy().ray_trace(*ask)[0].tolist() == [[0.125, 0.25, 1.0]]


def test_points_in_a_closed_surface():
    grid = pyvista.ImageData(dimensions=(9, 9, 9), spacing=(0.25,) * 3, origin=(-1, -1, -1))
    low, high = grid.select_interior_points(pyvista.Cube()), np.abs(grid.points).max(axis=1)
    assert low.active_scalars_name == "selected_points"
    assert "selected_points" not in grid.point_data
    np.testing.assert_array_equal(low["selected_points"], high <= 0.5)
    other = grid.select_interior_points(pyvista.Cube(), inside_out=True, method="cell_locator")
    np.testing.assert_array_equal(other["selected_points"], high >= 0.5)


def test_an_open_surface_has_no_inside_unless_it_is_not_checked():
    plane, points = pyvista.Plane(), pyvista.PolyData([[0.0, 0.1, 1], [0, 0.1, -1]])
    with pytest.raises(RuntimeError, match="surface must be closed, or check_surface be False"):
        points.select_interior_points(plane)
    below = points.select_interior_points(plane, check_surface=False)
    assert below["selected_points"].tolist() == [False, True]


def test_bad_input_is_refused():
    cube = pyvista.Cube()
    with pytest.raises(ValueError, match="origin must be 3 numbers"):
        cube.ray_trace([0, 0], [1, 1, 1])
    with pytest.raises(ValueError, match=r"ray_origins must have shape \(n, 3\)"):
        cube.multi_ray_trace([0, 0, 0], [1, 1, 1])
    with pytest.raises(TypeError, match=r"surface must be a pyvista\.PolyData, got int"):
        cube.select_interior_points(3)
    with pytest.raises(ValueError, match="method must be one of 'signed_distance', 'cell_locator'"):
        cube.select_interior_points(cube, method="luck")


def test_uninstalled_pyvista_has_its_own():
    mine = pyvista.PolyData.ray_trace
    compat.uninstall()
    assert pyvista.PolyData.ray_trace is not mine
    assert pyvista.Cube().ray_trace([0, 0, 0], [1, 0, 0])[0].shape == (1, 3)
