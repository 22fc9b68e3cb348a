"""Textures, colors and materials of the meshes of other libraries."""

import json
import subprocess
import sys
import types
import warnings

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

import raywright as rw
from raywright.mesh_files.blender_objects import of_mesh
from raywright.mesh_files.textured import split_corners
from raywright.mesh_files.vtk_objects import _look

QUAD = np.array([(0.0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)])
FACES = np.array([(0, 1, 2), (0, 2, 3)])
UV = np.array([(0.0, 0), (1, 0), (1, 1), (0, 1)], np.float32)
# Rows from the top: red, green, blue and yellow.
PIXELS = np.array([[(255, 0, 0)] * 2, [(0, 255, 0)] * 2, [(0, 0, 255)] * 2, [(255, 255, 0)] * 2], np.uint8)


def library(name):
    # An installed library may lack a system library.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return pytest.importorskip(name, exc_type=ImportError)


@given(st.integers(0, 12), st.integers(1, 5), st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_split_corners_keep_vertices_and_coordinates(faces, count, seed):
    rng = np.random.default_rng(seed)
    corners = rng.integers(0, count, 3 * faces)
    uv = rng.integers(0, 3, (3 * faces, 2)).astype(np.float32) / 4
    sources, new, placed = split_corners(corners, uv, count)
    assert np.array_equal(sources[:count], np.arange(count))
    assert np.array_equal(sources[new], corners)
    assert np.array_equal(placed[new], uv)
    # At most one vertex for each pair of a vertex and a coordinate.
    pairs = {(int(c), *map(float, t)) for c, t in zip(corners, uv, strict=True)}
    assert len(sources) == len(pairs) + count - len(set(corners.tolist()))


def test_parts_of_one_object_count_its_cells_together():
    mesh = trimesh.Trimesh(QUAD, FACES, process=False)
    materials = [
        trimesh.visual.material.SimpleMaterial(diffuse=color) for color in ([255, 0, 0], [0, 0, 255])
    ]
    mesh.visual = trimesh.visual.TextureVisuals(
        uv=UV, material=trimesh.visual.material.MultiMaterial(materials), face_materials=[1, 0]
    )
    assert [shape.cells.tolist() for shape in rw.Scene(mesh).shapes] == [[1], [0]]
    with pytest.warns(RuntimeWarning, match="different materials"):
        twice = rw.Mesh.of([mesh, mesh])
    assert twice.cells.tolist() == [1, 0, 3, 2]


def test_colors_of_faces_that_differ_are_told_once():
    mesh = trimesh.Trimesh(QUAD, FACES, process=False)
    mesh.visual.face_colors = [[255, 0, 0, 255], [0, 0, 255, 255]]
    with pytest.warns(
        RuntimeWarning, match=r"left out of trimesh\.Trimesh: colors of faces, for which"
    ) as told:
        rw.Scene(mesh)
    assert len(told) == 1


class Node(types.SimpleNamespace):
    """A stand-in for a node of Blender: its inputs have values, or other nodes."""

    def __init__(self, type, inputs=None, **more):
        made = {}
        for name, value in (inputs or {}).items():
            source = value if isinstance(value, Node) else None
            links = [] if source is None else [types.SimpleNamespace(from_node=source)]
            # A linked input has a value of its own, which does not count.
            own = (0.8, 0.8, 0.8, 1.0) if "Color" in name else 0.5
            made[name] = types.SimpleNamespace(default_value=own if links else value, links=links)
        super().__init__(type=type, inputs=made, **more)


def picture(space="sRGB", floats=False):
    image = types.SimpleNamespace(
        size=(2, 4),
        channels=3,
        is_float=floats,
        # Rows from the bottom.
        pixels=(PIXELS[::-1].reshape(-1) / 255).tolist(),
        colorspace_settings=types.SimpleNamespace(name=space),
    )
    return Node("TEX_IMAGE", image=image, extension="EXTEND", interpolation="Linear")


def material(surface, name="m"):
    output = Node("OUTPUT_MATERIAL", {"Surface": surface}, is_active_output=True)
    plain = {"diffuse_color": (0.1, 0.2, 0.3, 1.0), "metallic": 0.25, "roughness": 0.75}
    return types.SimpleNamespace(name=name, node_tree=types.SimpleNamespace(nodes=[output]), **plain)


def blender_mesh(materials, uv=None):
    item = types.SimpleNamespace
    corners = [0, 1, 2, 0, 2, 3]
    layer = None if uv is None else item(data=[item(uv=tuple(uv[k])) for k in range(len(corners))])
    return item(
        name="quad",
        vertices=[item(co=tuple(point)) for point in QUAD],
        loops=[item(vertex_index=i) for i in corners],
        polygons=[item(loop_start=3 * i, loop_total=3, material_index=i % len(materials)) for i in range(2)],
        attributes=[],
        materials=materials,
        uv_layers=item(active=layer),
    )


def test_principled_shaders_of_blender_are_materials():
    glow = {"Emission Color": (1.0, 0.5, 0.0, 1.0), "Emission Strength": 2.0}
    first = material(
        Node("BSDF_PRINCIPLED", {"Base Color": (0.5, 0.25, 0.125, 1.0), "Metallic": 1.0, **glow})
    )
    glass = material(Node("BSDF_PRINCIPLED", {"Transmission Weight": 1.0, "IOR": 1.25, "Roughness": 0.0}))
    metal, clear = of_mesh(blender_mesh([first, glass]))
    assert metal.material == rw.MetallicRough((0.5, 0.25, 0.125), 1.0, 0.5)
    assert metal.emission == rw.Emission((2.0, 1.0, 0.0), both_sides=True)
    assert isinstance(clear.material, rw.materials.Tinted)
    assert clear.material.base == rw.Dielectric(1.25, 0.0)
    assert metal.cells.tolist() == [0]
    assert clear.cells.tolist() == [1]


@pytest.mark.parametrize(("space", "floats"), [("sRGB", False), ("Non-Color", False), ("Linear", True)])
def test_pictures_of_blender_are_textures(space, floats):
    uv = UV[[0, 1, 2, 0, 2, 3]].copy()
    uv[3] += 1  # Where the second face leaves a seam.
    shader = Node("BSDF_PRINCIPLED", {"Base Color": picture(space, floats)})
    [mesh] = of_mesh(blender_mesh([material(shader)], uv))
    image = mesh.material.base_color
    assert image.wrap == ("clamp", "clamp")
    assert image.image.dtype == (np.uint8 if space == "sRGB" else np.float32)
    assert np.allclose(image.image, PIXELS if space == "sRGB" else PIXELS / 255)
    assert np.array_equal(mesh.vertices[mesh.faces], QUAD[FACES])
    assert np.array_equal(mesh.uv[mesh.faces].reshape(-1, 2), uv)
    assert len(mesh.vertices) == 5


def test_nodes_of_blender_that_are_not_known_are_told_once():
    noise = Node("TEX_NOISE")
    shader = Node("BSDF_PRINCIPLED", {"Base Color": noise, "Roughness": noise, "Coat Weight": 0.5})
    toon = material(Node("BSDF_TOON"), "toon")
    with pytest.warns(RuntimeWarning, match="^left out of the objects of Blender: ") as told:
        known, plain = of_mesh(blender_mesh([material(shader), toon]))
    assert len(told) == 1
    for part in (
        "'Coat Weight' of material 'm'",
        "tex_noise node for 'Base Color' of material 'm'",
        "tex_noise node for 'Roughness' of material 'm'",
        "bsdf_toon shader of material 'toon'",
    ):
        assert part in str(told[0].message)
    assert isinstance(known.material, rw.MetallicRough)
    assert plain.material == rw.MetallicRough((0.1, 0.2, 0.3), 0.25, 0.75)


def seen(source):
    """What a camera sees of the first unit square from above, in an even light."""
    camera = rw.Camera((0.5, 0.5, 3), (0.5, 0.5, 0), fov=18.0, width=12, height=12)
    scene = rw.Scene(source, environment=1.0)
    return rw.render(scene, camera, rw.Path(max_depth=0), samples=64).rgb


QUIETLY = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning", "ignore::pytest.PytestUnraisableExceptionWarning"
)


def squares(folder):
    """A file with a square with a picture, and a triangle of one color."""
    from PIL import Image

    Image.fromarray(PIXELS).save(folder / "t.png")
    (folder / "q.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd t.png\nnewmtl b\nKd 0.2 0.4 0.6\n")
    lines = ["mtllib q.mtl", "v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 0", "v 2 0 0"]
    lines += ["vt 0 0", "vt 1 0", "vt 1 1", "vt 0 1", "usemtl a", "f 1/1 2/2 3/3", "f 1/1 3/3 4/4"]
    path = folder / "q.obj"
    path.write_text("\n".join([*lines, "usemtl b", "f 2/1 5/2 3/3", ""]))
    return path


@pytest.mark.slow
@QUIETLY
def test_textures_of_open3d_are_those_of_the_file(tmp_path):
    o3d = library("open3d")
    path = squares(tmp_path)
    expected = seen(path)
    # Tensor meshes have one material, the first of a file.
    legacy = o3d.io.read_triangle_mesh(str(path))
    assert np.array_equal(seen(legacy), expected)
    assert [shape.cells.tolist() for shape in rw.Scene(legacy).shapes] == [[0, 1], [2]]
    tensors = o3d.t.io.read_triangle_mesh(str(path))
    # A rough surface of glTF reflects a little more than a matt one.
    assert np.abs(seen(tensors) - expected).max() < 0.05
    tensors.material.scalar_properties["clear_coat"] = 1.0
    with pytest.warns(RuntimeWarning, match="left out of open3d.*: material property 'clear_coat'") as told:
        rw.Scene(tensors)
    assert len(told) == 1
    box = o3d.geometry.TriangleMesh.create_box(create_uv_map=True)
    mesh = rw.Mesh.of(box)
    assert len(mesh.vertices) == 8
    assert np.array_equal(mesh.face_attributes["texture_uvs"].reshape(-1, 2), np.asarray(box.triangle_uvs))


BLENDER = """
import json, sys, bpy
import raywright as rw
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath="q.obj", up_axis="Z", forward_axis="Y")
shapes = rw.Scene(bpy.data.objects).shapes
[mesh] = [shape for shape in shapes if len(shape.faces) == 2]
told = [shape.cells.tolist() for shape in shapes], mesh.vertices[mesh.faces].tolist()
print(json.dumps([*told, mesh.uv[mesh.faces].tolist(), mesh.material.base_color.image.tolist()]))
"""


@pytest.mark.slow
def test_textures_of_blender_are_those_of_the_file(tmp_path):
    # In a separate process: Blender's data would be shared by all tests.
    squares(tmp_path)
    done = subprocess.run([sys.executable, "-c", BLENDER], capture_output=True, text=True, cwd=tmp_path)
    if "No module named 'bpy'" in done.stderr:
        pytest.skip("Blender is not here")
    assert done.returncode == 0, done.stderr
    cells, corners, uv, pixels = json.loads(done.stdout.splitlines()[-1])
    assert cells == [[0, 1], [2]]
    assert np.array_equal(np.array(corners)[..., :2], uv)
    assert np.array_equal(np.array(pixels)[..., :3], PIXELS)


@pytest.mark.slow
@QUIETLY
@pytest.mark.parametrize(("name", "factor"), [("RGB", 255), ("colors", 1.0)])
def test_colors_of_pyvista_are_colors_of_vertices(name, factor):
    pv = library("pyvista")
    surface = pv.PolyData.from_regular_faces(QUAD, FACES)
    shares = np.array([(1.0, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)])
    surface.point_data[name] = (shares * factor).astype(np.uint8 if factor == 255 else np.float64)
    mesh = rw.Mesh.of(surface)
    assert np.array_equal(mesh.colors, shares)
    assert mesh.material == rw.Diffuse(rw.VertexColors())
    assert name in mesh.vertex_attributes
    back = rw.Mesh.of(mesh.to_pyvista())
    assert np.array_equal(back.colors, shares)
    surface.point_data[name] = shares * 7.0
    assert rw.Mesh.of(surface).colors is None


def test_textures_that_pyvista_kept_with_a_mesh_are_textures():
    """Versions before 0.43 had them, by name."""
    texture = types.SimpleNamespace(to_array=lambda: PIXELS)
    look = _look(types.SimpleNamespace(textures={"wood": texture}), {})
    assert np.array_equal(look.material.reflectance.image, PIXELS)
