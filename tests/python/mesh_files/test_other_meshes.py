"""Meshes of other libraries, each from its real objects, and back."""

import subprocess
import sys
import types
import warnings

import numpy as np
import pytest
import trimesh
from conftest import CORNERS, QUADS
from hypothesis import given
from hypothesis import strategies as st

import raywright as rw

POINTS, FACES = np.array(CORNERS), np.array(QUADS)
HEIGHT = POINTS[:, 2]
DOWN = (0, 0, -1)
# Other libraries warn at import.
QUIETLY = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning", "ignore::UserWarning", "ignore::FutureWarning"
)


def library(name):
    # An installed library may lack a system library.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip(name, exc_type=ImportError)


def is_closed(mesh):
    found = mesh.to_trimesh()
    found.merge_vertices()
    return found.is_watertight


def volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(float) for k in range(3))
    return (np.cross(a, b) * c).sum() / 6


def check_heated(source, cell=5, exact=True):
    """A unit cube of quads, "height" on its points and "number" on its cells: hits read both."""
    scene = rw.Scene(source)
    x, y = np.random.default_rng(0).uniform(0, 1, (2, 100))
    hits = scene.intersect(np.column_stack([x, y, 0 * x + 9]), DOWN)
    assert np.allclose(hits.position, np.column_stack([x, y, 0 * x + 1]), rtol=0, atol=1e-15)
    assert np.allclose(hits.interpolate("height"), 1, rtol=0, atol=1e-15 if exact else 1e-7)
    assert (hits.interpolate("number") == 10 * cell).all()
    assert (hits.cell == cell).all()
    assert volume(rw.Mesh.of(source)) == pytest.approx(1, rel=1e-15)


class Tensor:
    """What a tensor of PyTorch has of an array: no ndarray, but it becomes one."""

    def __init__(self, array, device="cpu", grad=False):
        self.array, self.device, self.requires_grad = np.asarray(array), device, grad
        self.shape, self.dtype = self.array.shape, self.array.dtype

    def __array__(self, dtype=None, copy=None):
        if self.device != "cpu":
            raise TypeError("can't convert cuda:0 device type tensor to numpy.")
        return self.array

    def detach(self):
        return self

    def cpu(self):
        return Tensor(self.array)


def test_pairs_of_tensors_are_meshes():
    for pair in ((POINTS, FACES), [POINTS, FACES], (Tensor(POINTS), Tensor(FACES)), (POINTS, Tensor(FACES))):
        mesh = rw.Mesh.of(pair)
        assert np.array_equal(mesh.vertices, POINTS)
        assert np.array_equal(mesh.cells, np.repeat(np.arange(6), 2))
        assert volume(mesh) == 1
        assert rw.Scene(pair).shapes == (mesh,)
    assert rw.Mesh.of((POINTS, FACES[:, :3])).cells is None
    both = rw.Scene([(POINTS, FACES), (POINTS + 2, FACES)])
    assert [shape.bounds[0, 0] for shape in both.shapes] == [0, 2]


def test_pairs_of_plain_lists_are_meshes():
    lists, rows = POINTS.tolist(), [tuple(face) for face in FACES.tolist()]
    vectors = list(POINTS)
    for pair in ((lists, rows), [lists, rows], (tuple(map(tuple, lists)), tuple(rows)), (vectors, FACES)):
        assert rw.Mesh.of(pair) == rw.Mesh.of((POINTS, FACES))
        scene = rw.Scene({"house": {"walls": pair}, "roof": rw.Sphere((0, 0, 3), 1)})
        assert scene.names == ("house/walls", "roof")
    # Two meshes, and two pairs, are still lists of meshes.
    mesh = rw.Mesh.of((POINTS, FACES))
    assert len(rw.Scene([mesh, mesh]).shapes) == len(rw.Scene([(lists, rows), (lists, rows)]).shapes) == 2


@pytest.mark.parametrize(
    ("pair", "error", "told"),
    [
        ((POINTS[None], FACES), ValueError, r"vertices of a \(.*\) pair .* \(V, 3\), got \(1, 8, 3\)"),
        ((POINTS, FACES[0]), ValueError, r"faces of a \(vertices, faces\) pair .* got \(4,\)"),
        ((POINTS, FACES[:, :2]), ValueError, r"\(F, 3\), or \(F, N\) for polygons .* got \(6, 2\)"),
        ((POINTS, FACES + 1), ValueError, "faces must be between 0 and 7, got 8"),
        ((POINTS, FACES * 1.0), TypeError, "faces must be integers, got"),
        ((Tensor(POINTS, "cuda:0"), FACES), TypeError, r"vertices must be an array .*\.cpu\(\)"),
        ((POINTS, Tensor(FACES, "cuda:0")), TypeError, r"faces must be an array .*\.cpu\(\)"),
        (POINTS, TypeError, r"got numpy.ndarray; of vertices and faces make a mesh"),
        ((POINTS, FACES, FACES), TypeError, r"got numpy.ndarray; of vertices and faces make a mesh"),
        (3, TypeError, "got builtins.int"),
        (None, TypeError, "got builtins.NoneType"),
        ((POINTS.tolist(), (FACES + 1).tolist()), ValueError, "faces must be between 0 and 7, got 8"),
        ((POINTS.tolist(), [(0, 1, 2), (0, 1, 2, 3)]), ValueError, "faces must be .* got ragged list"),
        ({"house": {"roof": 3}}, TypeError, "shape 'house/roof' must be a Mesh.* got builtins.int"),
        ({1: (POINTS, FACES)}, TypeError, "names of type str as the keys of a dict, got 1"),
        (trimesh.Trimesh, TypeError, "pyvista, VTK, Open3D, .* got the class trimesh.base.Trimesh"),
        (trimesh.PointCloud(POINTS), TypeError, "got trimesh.points.PointCloud"),
    ],
)  # fmt: skip
def test_what_is_no_mesh_is_refused_by_its_name(pair, error, told):
    for take in (rw.Scene, rw.Mesh.of):
        with pytest.raises(error, match=told):
            take(pair)


def test_nothing_is_imported_to_recognize_anything():
    code = (
        "import sys, numpy as np, raywright as rw; from raywright.shapes.sources import SOURCES;"
        "pair = np.eye(3), np.array([[0, 1, 2]]); rw.Scene([pair, {'a': rw.Mesh.of(pair)}]);"
        "print(*{source.module for source in SOURCES} & set(sys.modules))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stdout.split() == []


def test_a_dict_names_its_meshes():
    ball = rw.Sphere((5, 5, 5), 1, name="ball")
    house = {
        "roof": (POINTS + np.array((0, 0, 1)), FACES),
        "walls": [(POINTS, FACES), rw.Mesh.of((POINTS + 3, FACES))],
    }
    scene = rw.Scene({"house": house, "sun": ball, "copy": rw.Instance(ball, np.eye(4))})
    assert scene.names == ("house/roof", "house/walls", "house/walls", "sun", "copy")
    assert ball.name == "ball"
    assert scene.shapes[3] == rw.Sphere((5, 5, 5), 1, name="sun")
    hits = scene.intersect([[0.5, 0.5, 9], [3.5, 3.5, 9], [5, 5, 9]], DOWN)
    assert hits.names.tolist() == ["house/roof", "house/walls", "sun"]
    assert scene.occluded((0.5, 0.5, 9), DOWN, shapes="house/roof")
    house["again"] = house
    with pytest.raises(ValueError, match="must not be a dict that contains itself"):
        rw.Scene(house)


def test_several_meshes_become_one():
    parts = [rw.Mesh.of((POINTS, FACES)), rw.Mesh(POINTS + 2, [(1, 5, 7)])]
    whole = rw.Mesh.of({"a": parts[0], "b": parts[1]})
    assert np.array_equal(whole.vertices, np.concatenate([POINTS, POINTS + 2]))
    assert np.array_equal(whole.faces[-1], (9, 13, 15))
    assert np.array_equal(whole.cells, [*np.repeat(np.arange(6), 2), 6])
    with pytest.warns(RuntimeWarning, match="2 meshes with different materials become one with that of"):
        rw.Mesh.of([parts[0], rw.Mesh(POINTS, [(1, 5, 7)], material=rw.Mirror())])
    with pytest.raises(ValueError, match=r"source must hold a mesh, got builtins\.list with none"):
        rw.Mesh.of([])
    with pytest.raises(TypeError, match=r"source must be .*got raywright\.shapes\.sphere\.Sphere"):
        rw.Mesh.of(rw.Sphere((0, 0, 0), 1))
    assert rw.Mesh.of(parts[1]) is parts[1]


def test_trimesh_keeps_attributes_and_cells():
    box = trimesh.Trimesh(POINTS, rw.Mesh.of((POINTS, FACES)).faces, process=False)
    box.vertex_attributes["height"] = HEIGHT
    box.face_attributes["number"] = np.arange(12) * 10
    visual = trimesh.visual.TextureVisuals(
        uv=np.zeros((8, 2)),
        material=trimesh.visual.material.MultiMaterial([trimesh.visual.material.SimpleMaterial()] * 2),
        face_materials=np.arange(12) % 2,
    )
    for given_visual in (None, visual):
        if given_visual is not None:
            box.visual = given_visual
        hits = rw.Scene(box).intersect([[0.7, 0.2, 9], [0.2, 0.7, 9]], DOWN)
        assert hits.interpolate("height").tolist() == pytest.approx([1, 1], abs=1e-15)
        assert sorted(hits.cell) == [10, 11]
        assert np.array_equal(hits.interpolate("number"), hits.cell * 10)


def test_points_and_curves_of_a_trimesh_scene_are_left_out_with_one_warning():
    scene = trimesh.Scene({"box": trimesh.creation.box(), "dots": trimesh.PointCloud(POINTS)})
    scene.add_geometry(trimesh.load_path(POINTS[:3]), geom_name="track")
    for take in (rw.Scene, rw.Mesh.of):
        with pytest.warns(RuntimeWarning, match=r"'dots', a PointCloud, 'track', a Path3D") as told:
            take(scene)
        assert len(told) == 1
        assert told[0].filename == __file__


EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))
# Nodes of hexahedra: the bottom, then the top, each around.
AROUND = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
HALVES = np.concatenate([AROUND, [(AROUND[a] + AROUND[b]) / 2 for a, b in EDGES]])
FOUR = np.array([(0.0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
TEN = np.concatenate(
    [FOUR, [(FOUR[a] + FOUR[b]) / 2 for a, b in ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))]]
)


def test_meshio_has_values_on_points_and_cells():
    meshio = library("meshio")
    values = {"point_data": {"height": HEIGHT}, "cell_data": {"number": [np.arange(6) * 10]}}
    check_heated(meshio.Mesh(POINTS, [("quad", FACES)], **values))
    polygons = [("polygon", [list(face) for face in FACES])]
    check_heated(meshio.Mesh(POINTS, polygons, **values))


def test_meshio_counts_cells_through_all_blocks():
    meshio = library("meshio")
    blocks = [("line", [[0, 1], [1, 2]]), ("triangle", [[1, 5, 7]]), ("quad", FACES[:5])]
    with pytest.warns(
        RuntimeWarning, match=r"left out of meshio.Mesh: cells of type 'line', cell data 'text'"
    ):
        mesh = rw.Mesh.of(
            meshio.Mesh(
                POINTS,
                blocks,
                cell_data={"id": [[1, 2], [3], np.arange(4, 9)], "text": [["a", "b"], ["c"], ["d"] * 5]},
            )
        )
    assert mesh.cells.tolist() == [2, *np.repeat(np.arange(3, 8), 2)]
    assert np.array_equal(mesh.face_attributes["id"], mesh.cells + 1)


@pytest.mark.parametrize(
    ("kind", "points", "faces", "expected"),
    [
        ("tetra", FOUR, 4, 1 / 6),
        ("tetra10", TEN, 16, 1 / 6),
        ("hexahedron", AROUND, 12, 1),
        ("hexahedron20", HALVES, 36, 1),
        ("wedge", AROUND[[0, 1, 3, 4, 5, 7]], 8, 0.5),
        ("pyramid", np.array([*AROUND[:4], (0.5, 0.5, 1)]), 6, 1 / 3),
    ],
)
def test_meshio_volume_cells_have_closed_surfaces(kind, points, faces, expected):
    meshio = library("meshio")
    for mirror in (1, -1):
        mesh = rw.Mesh.of(meshio.Mesh(points * (1, 1, mirror), [(kind, [np.arange(len(points))])]))
        assert len(mesh.faces) == faces
        assert is_closed(mesh)
        assert volume(mesh) == pytest.approx(expected, rel=1e-14)


def grid(n):
    """Return points and hexahedra of a cube of n by n by n cells."""
    i = np.arange((n + 1) ** 3).reshape((n + 1,) * 3)
    corners = [i[a : n + a, b : n + b, c : n + c].reshape(-1) for a, b, c in AROUND.astype(int)]
    return np.stack(np.unravel_index(i.reshape(-1), i.shape), axis=1).astype(float), np.stack(corners, axis=1)


def test_meshio_surface_of_a_volume_tells_its_cells():
    meshio = library("meshio")
    points, cells = grid(4)
    skin = np.array([[0, 1, 2]])
    blocks = [("triangle", skin), ("hexahedron", cells)]
    mesh = meshio.Mesh(points, blocks, cell_data={"heat": [[-1.0], np.arange(64.0)]})
    scene = rw.Scene(mesh)
    assert len(scene.shapes[0].faces) == 1 + 6 * 16 * 2
    x, y = np.random.default_rng(2).uniform(0, 4, (2, 50))
    hits = scene.intersect(np.column_stack([x, y, 0 * x + 9]), DOWN)
    # Cells at the top, z = 3, where the first coordinate counts most.
    expected = (x.astype(int) * 4 + y.astype(int)) * 4 + 3
    assert np.array_equal(hits.interpolate("heat"), expected)
    assert np.array_equal(hits.cell, expected + 1)
    # A face that is also given as a polygon is not duplicated.
    with_skin = rw.Mesh.of(meshio.Mesh(points, [("hexahedron", cells), ("quad", cells[:1, [0, 3, 2, 1]])]))
    assert len(with_skin.faces) == 6 * 16 * 2
    assert with_skin.cells.max() == 64


@pytest.mark.parametrize(
    ("points", "cells", "told"),
    [
        (POINTS, [("line", [[0, 1]])], "cells of a meshio.Mesh must have faces, got line"),
        (POINTS[:, :1], [("triangle", [[0, 1, 2]])], r"must have shape \(N, 2\) or \(N, 3\), got \(8, 1\)"),
        (POINTS, [("triangle", [[0, 1, 9]])], r"face 0 of faces is \(0, 1, 9\), but there are 8 vertices"),
        (POINTS, [("quad", [[0, 1, 2, 3], [0, 1, 2, 9]])], "face 1 has vertex 9, but there are 8 vertices"),
    ],
)
def test_meshio_without_a_surface_is_refused(points, cells, told):
    meshio = library("meshio")
    with pytest.raises(ValueError, match=told):
        rw.Scene(meshio.Mesh(points, cells))


def test_manifold3d_keeps_its_precision_and_properties():
    manifold = library("manifold3d")
    ball = manifold.Manifold.sphere(1.0, 32)
    exact, single = ball.to_mesh64(), ball.to_mesh()
    assert np.array_equal(rw.Mesh.of(ball).vertices, exact.vert_properties)
    for given_mesh in (exact, single):
        mesh = rw.Mesh.of(given_mesh)
        assert mesh.vertices.dtype == given_mesh.vert_properties.dtype
        assert np.array_equal(mesh.vertices, given_mesh.vert_properties)
        assert np.array_equal(mesh.faces, given_mesh.tri_verts)
    assert volume(rw.Mesh.of(ball)) == pytest.approx(ball.volume(), rel=1e-12)
    triangles = rw.Mesh.of((POINTS, FACES)).faces.copy()
    values = np.column_stack([POINTS, HEIGHT]).astype(np.float32)
    mesh = rw.Mesh.of(manifold.Mesh(values, triangles, face_id=np.repeat(np.arange(6), 2).astype(np.uint32)))
    assert np.array_equal(mesh.vertex_attributes["properties"][:, 0], HEIGHT)
    assert np.array_equal(mesh.face_attributes["face_id"], np.repeat(np.arange(6), 2))


NUMBERS = st.floats(-1e6, 1e6, width=32)


@given(
    st.lists(st.tuples(NUMBERS, NUMBERS, NUMBERS), min_size=3, max_size=9),
    st.data(),
    st.sampled_from([np.float32, np.float64]),
)
def test_faces_and_places_stay_as_they_are(points, data, dtype):
    meshio, manifold = library("meshio"), library("manifold3d")
    corner = st.integers(0, len(points) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(corner, corner, corner), min_size=1, max_size=9)))
    points = np.array(points, dtype)
    kind = manifold.Mesh if dtype == np.float32 else manifold.Mesh64
    index = np.uint32 if dtype == np.float32 else np.uint64
    for source in (
        (points, faces),
        meshio.Mesh(points, [("triangle", faces)]),
        kind(points, faces.astype(index)),
    ):
        for mesh in (rw.Mesh.of(source), *rw.Scene(source).shapes):
            assert mesh.vertices.dtype == dtype
            assert np.array_equal(mesh.vertices, points)
            assert np.array_equal(mesh.faces, faces)
            assert mesh.cells is None


class Sequence(list):
    """A collection of Blender's, which fills arrays with a property of each of its items."""

    def foreach_get(self, name, array):
        array[:] = np.array([getattr(item, name) for item in self]).reshape(-1)


def blender_cube(collection):
    item = types.SimpleNamespace
    heights = item(
        name="height",
        domain="POINT",
        data_type="FLOAT",
        data=collection(item(value=z) for z in HEIGHT),
    )
    numbers = item(
        name="number", domain="FACE", data_type="INT", data=collection(item(value=10 * i) for i in range(6))
    )
    own = item(name=".select_vert", domain="POINT", data_type="BOOLEAN", data=collection())
    return item(
        name="Cube",
        vertices=collection(item(co=tuple(point)) for point in CORNERS),
        loops=collection(item(vertex_index=i) for face in QUADS for i in face),
        polygons=collection(item(loop_start=4 * i, loop_total=4) for i in range(6)),
        attributes=[heights, numbers, own],
    )


@pytest.mark.parametrize("collection", [Sequence, list])
def test_objects_of_blender_are_evaluated_and_placed(monkeypatch, collection):
    """By a stand-in with the attributes of Blender's own."""
    mesh, freed = blender_cube(collection), []
    matrix = np.eye(4)

    def evaluated(graph):
        assert graph == "graph"
        return types.SimpleNamespace(
            to_mesh=lambda: mesh, to_mesh_clear=lambda: freed.append(True), matrix_world=matrix
        )

    cube = types.SimpleNamespace(
        name="Kitchen", type="MESH", evaluated_get=evaluated, to_mesh=None, matrix_world=None
    )
    lamp = types.SimpleNamespace(
        name="Lamp", type="LIGHT", evaluated_get=None, to_mesh=None, matrix_world=None
    )
    with pytest.raises(TypeError, match=r"got types\.SimpleNamespace"):
        rw.Scene(cube)
    context = types.SimpleNamespace(evaluated_depsgraph_get=lambda: "graph")
    monkeypatch.setitem(sys.modules, "bpy", types.SimpleNamespace(context=context))
    check_heated(cube)
    assert freed == [True, True]
    assert rw.Scene(cube).names == ("Kitchen",)
    matrix[:3, 3] = (1, 2, 3)
    assert np.array_equal(rw.Mesh.of(cube).bounds, [(1, 2, 3), (2, 3, 4)])
    with pytest.warns(RuntimeWarning, match="left out of the objects of Blender: 'Lamp', a light"):
        assert rw.Scene([cube, lamp]).names == ("Kitchen",)


@pytest.mark.slow
@QUIETLY
def test_blender_itself():
    bpy = library("bpy")
    cube = bpy.data.objects["Cube"]
    cube.location = (1, 2, 3)
    heat = cube.data.attributes.new("height", "FLOAT", "POINT")
    heat.data.foreach_set("value", np.arange(8.0, dtype=np.float32))
    bpy.context.view_layer.update()
    mesh = rw.Mesh.of(cube)
    assert np.array_equal(mesh.bounds, [(0, 1, 2), (2, 3, 4)])
    assert np.array_equal(mesh.vertex_attributes["height"], np.arange(8))
    assert np.array_equal(mesh.cells, np.repeat(np.arange(6), 2))
    cube.modifiers.new("finer", "SUBSURF").levels = 2
    bpy.context.view_layer.update()
    assert len(rw.Mesh.of(cube).faces) == 6 * 16 * 2
    with pytest.warns(RuntimeWarning, match="'Camera', a camera, 'Light', a light") as told:
        assert rw.Scene(bpy.data.objects).names == ("Cube",)
    assert len(told) == 1


@pytest.mark.slow
@QUIETLY
def test_pyvista_surfaces_have_values_and_cells():
    pv = library("pyvista")
    cube = pv.PolyData.from_regular_faces(POINTS, FACES)
    cube.point_data["height"], cube.cell_data["number"] = HEIGHT, np.arange(6) * 10
    check_heated(cube)
    with pytest.warns(RuntimeWarning, match="left out of PolyData: lines") as told:
        mesh = rw.Mesh.of(pv.PolyData(POINTS, faces=[4, *QUADS[0], 3, 1, 5, 7], lines=[2, 0, 1]))
    assert len(told) == 1
    assert mesh.cells.tolist() == [1, 1, 2]
    back = rw.Mesh.of(mesh.to_pyvista())
    assert np.array_equal(back.vertices, mesh.vertices)
    assert np.array_equal(back.faces, mesh.faces)
    assert np.array_equal(back.face_attributes["cell"], mesh.cells)
    ball = pv.Sphere()
    whole = rw.Mesh.of(ball)
    assert np.array_equal(whole.vertices, ball.points)
    assert np.array_equal(whole.normals, ball.point_data["Normals"])
    assert volume(rw.Mesh.of(ball.strip())) == pytest.approx(volume(whole), rel=1e-5)
    blocks = pv.MultiBlock({"a": cube, "b": ball, "c": pv.PolyData(POINTS)})
    with pytest.warns(RuntimeWarning, match="left out of MultiBlock: points"):
        assert rw.Scene(blocks).names == ("a", "b")
    with pytest.raises(ValueError, match="a PolyData must have faces to become a mesh, got points"):
        rw.Scene(pv.PolyData(POINTS))


@pytest.mark.slow
@QUIETLY
def test_pyvista_volumes_tell_the_cell_behind_each_face():
    pv = library("pyvista")
    points, cells = grid(4)
    volume_cells = pv.UnstructuredGrid({pv.CellType.HEXAHEDRON: cells}, points)
    volume_cells.cell_data["heat"] = np.arange(64.0)
    volume_cells.point_data["height"] = points[:, 2]
    x, y = np.random.default_rng(2).uniform(0, 4, (2, 50))
    hits = rw.Scene(volume_cells).intersect(np.column_stack([x, y, 0 * x + 9]), DOWN)
    expected = (x.astype(int) * 4 + y.astype(int)) * 4 + 3
    assert np.array_equal(hits.cell, expected)
    assert np.array_equal(hits.interpolate("heat"), expected)
    assert np.allclose(hits.interpolate("height"), 4, rtol=0, atol=1e-14)
    assert is_closed(rw.Mesh.of(pv.ImageData(dimensions=(3, 4, 5))))


@pytest.mark.slow
@QUIETLY
def test_vtk_alone_is_enough(tmp_path):
    sources = library("vtkmodules.vtkFiltersSources")
    cube = sources.vtkCubeSource()
    cube.Update()
    mesh = rw.Mesh.of(cube.GetOutput())
    assert volume(mesh) == 1
    assert mesh.cells.max() == 5
    with pytest.raises(TypeError, match="shapes must be data sets of VTK with a surface, got vtkTable"):
        rw.Scene(library("vtkmodules.vtkCommonDataModel").vtkTable())
    library("pyvista")
    mesh.save(tmp_path / "cube.vtp")
    assert (tmp_path / "cube.vtp").stat().st_size > 0


@pytest.mark.slow
@QUIETLY
def test_open3d_meshes_of_both_kinds():
    o3d = library("open3d")
    triangles = rw.Mesh.of((POINTS, FACES)).faces.astype(np.int64)
    tensors = o3d.t.geometry.TriangleMesh(o3d.core.Tensor(POINTS), o3d.core.Tensor(triangles))
    tensors.vertex["height"] = o3d.core.Tensor(HEIGHT)
    tensors.triangle["number"] = o3d.core.Tensor(np.arange(12) * 10)
    mesh = rw.Mesh.of(tensors)
    assert np.array_equal(mesh.vertices, POINTS)
    assert np.array_equal(mesh.faces, triangles)
    hits = rw.Scene(tensors).intersect((0.7, 0.2, 9), DOWN)
    assert hits.interpolate("height") == pytest.approx(1, abs=1e-15)
    assert hits.interpolate("number") == 10 * hits.cell == 10 * hits.primitive_id
    legacy = tensors.to_legacy()
    legacy.vertex_colors = o3d.utility.Vector3dVector(POINTS * 0.75)
    colored = rw.Mesh.of(legacy)
    assert np.array_equal(colored.vertices, POINTS)
    assert colored.colors.max() == pytest.approx(((0.75 + 0.055) / 1.055) ** 2.4, rel=1e-12)
    values = (mesh.vertex_attributes, mesh.face_attributes, mesh.faces[:, 0])
    looks = (colored.normals, None, colored.material, None, colored.colors, None)
    back = rw.Mesh(mesh.vertices, mesh.faces, *looks, *values).to_open3d()
    assert np.array_equal(back.vertex.positions.numpy(), POINTS)
    assert np.array_equal(back.triangle.indices.numpy(), triangles)
    assert np.array_equal(back.vertex["height"].numpy(), HEIGHT)
    assert np.array_equal(back.triangle["cell"].numpy(), triangles[:, 0])
    assert np.allclose(back.vertex.colors.numpy(), POINTS * 0.75, rtol=0, atol=1e-6)
    with pytest.raises(TypeError, match=r"Open3D, .* got open3d.*PointCloud"):
        rw.Scene(o3d.geometry.PointCloud())


@pytest.mark.slow
@QUIETLY
@pytest.mark.filterwarnings("ignore")
def test_cadquery_shapes_are_as_close_as_they_are_to_be():
    cq = library("cadquery")
    box, ball = cq.Workplane().box(1, 2, 3), cq.Workplane().sphere(1.0)
    mesh = rw.Mesh.of(box)
    assert is_closed(mesh)
    assert volume(mesh) == pytest.approx(6, rel=1e-14)
    assert set(mesh.cells) == set(range(6))
    counts = []
    for tolerance in (3e-3, 1e-3, 3e-4, 1e-3):
        found = rw.Mesh.of(ball.val(), tolerance=tolerance)
        center = found.vertices[found.faces].mean(axis=1)
        # Open CASCADE exceeds the tolerance at the poles.
        away = 1 - np.linalg.norm(center, axis=1)
        assert away.max() <= 2 * tolerance
        assert np.quantile(away, 0.99) <= tolerance
        counts.append(len(found.faces))
    assert counts[0] <= counts[1] < counts[2]
    # Earlier tessellations make no difference.
    assert counts[3] == counts[1]
    parts = cq.Assembly().add(box, name="box", color=cq.Color("red"), loc=cq.Location((5, 0, 0)))
    parts.add(ball, name="ball")
    scene = rw.Scene(parts)
    assert scene.names == ("box", "ball")
    assert scene.shapes[0].material == rw.Diffuse((1.0, 0.0, 0.0))
    assert np.allclose(scene.shapes[0].bounds, [(4.5, -1, -1.5), (5.5, 1, 1.5)], rtol=0, atol=1e-12)
    for wrong in (cq.Workplane(), cq.Edge.makeLine((0, 0, 0), (1, 0, 0))):
        with pytest.raises(ValueError, match="must have faces to become"):
            rw.Scene(wrong)
    with pytest.raises(ValueError, match="tolerance must be greater than 0, got 0"):
        rw.Mesh.of(box, tolerance=0)


@pytest.mark.slow
@QUIETLY
@pytest.mark.filterwarnings("ignore")
def test_build123d_shapes_have_labels_and_colors():
    bd = library("build123d")
    box, ball = bd.Box(1, 2, 3), bd.Pos(5, 0, 0) * bd.Sphere(1)
    box.label, box.color, ball.label = "box", bd.Color("red"), "ball"
    scene = rw.Scene(bd.Compound(label="both", children=[box, ball]))
    assert scene.names == ("box", "ball")
    assert scene.shapes[0].material == rw.Diffuse((1.0, 0.0, 0.0))
    assert volume(scene.shapes[0]) == pytest.approx(6, rel=1e-14)
    assert is_closed(scene.shapes[0])
    assert np.allclose(scene.shapes[1].bounds[:, 2], (-1, 1), rtol=0, atol=2e-3)
    with bd.BuildPart() as part:
        bd.Cylinder(1, 2)
    assert volume(rw.Mesh.of(part)) == pytest.approx(2 * np.pi, rel=1e-2)
    assert rw.Mesh.of(part).cells.max() == 2
    assert rw.Mesh.of(box.wrapped).bounds.tolist() == [[-0.5, -1, -1.5], [0.5, 1, 1.5]]
    for wrong in (bd.Compound(), bd.Edge.make_line((0, 0, 0), (1, 0, 0))):
        with pytest.raises(ValueError, match="must have faces to become"):
            rw.Scene(wrong)
