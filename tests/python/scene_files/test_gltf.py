"""glTF files: where things stand, what lights them, who looks at them. All numbers are worked out by hand."""

import json
import math

import numpy as np
import pytest
import trimesh
from gltf_writer import CORNERS, SQUARE, Writer, own, square

import raywright as rw
from raywright.scene_files.gltf import read_gltf

TURN = math.sqrt(0.5)  # sine and cosine of half a quarter turn


@pytest.fixture
def read(tmp_path):
    def write_and_read(writer: Writer, text: bool = False):
        path = tmp_path / ("scene.gltf" if text else "scene.glb")
        path.write_bytes(writer.gltf() if text else writer.glb())
        return read_gltf(path)

    return write_and_read


@pytest.mark.parametrize("text", [False, True], ids=["glb", "gltf"])
def test_a_square_is_read_as_it_is(read, text):
    (mesh,) = own(read(square(), text))
    assert np.array_equal(mesh.vertices, SQUARE)
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert (mesh.normals, mesh.uv, mesh.emission, mesh.material) == (None, None, None, rw.Diffuse())


@pytest.mark.parametrize("suffix", ["glb", "gltf"])
def test_what_trimesh_writes_is_read(tmp_path, suffix):
    scene = trimesh.Scene()
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere()
    scene.add_geometry(box, node_name="box", transform=trimesh.transformations.translation_matrix((4, 5, 6)))
    scene.add_geometry(ball, parent_node_name="box", transform=np.diag([2.0, 2, 2, 1]))
    folder = tmp_path / "scene"
    folder.mkdir()
    if suffix == "glb":
        scene.export(folder / "scene.glb")
    else:
        for name, data in scene.export(file_type="gltf").items():
            (folder / name).write_bytes(data)
    (path,) = (path for path in folder.iterdir() if path.suffix == f".{suffix}")
    sizes = {len(mesh.faces): mesh for mesh in own(read_gltf(path))}
    assert np.allclose(sizes[12].bounds, [(3.5, 4.5, 5.5), (4.5, 5.5, 6.5)], rtol=0, atol=1e-6)
    assert np.allclose(sizes[1280].bounds, [(2, 3, 4), (6, 7, 8)], rtol=0, atol=1e-5)
    # rw.Scene has the same meshes.
    assert rw.Scene(path).shapes == own(read_gltf(path))


def test_transforms_are_those_of_the_parents_first(read):
    writer = Writer()
    # A quarter turn about y takes +x to -z, and +z to +x.
    top = writer.node(translation=[10, 0, 0], rotation=[0, TURN, 0, TURN])
    middle = writer.node(top, matrix=[2, 0, 0, 0, 0, 3, 0, 0, 0, 0, 4, 0, 1, 2, 3, 1])
    writer.node(middle, mesh=writer.mesh(), scale=[1, 1, 5], translation=[0, 0, 1])
    (mesh,) = own(read(writer))
    # (x, y, 0) -> (x, y, 1) -> (2 x + 1, 3 y + 2, 7) -> (7 + 10, 3 y + 2, -(2 x + 1)).
    expected = [(17, 3 * y + 2, -(2 * x + 1)) for x, y, _ in SQUARE]
    assert np.allclose(mesh.vertices, expected, rtol=0, atol=1e-12)


def test_mirrored_nodes_show_the_same_side(read):
    (mesh,) = own(read(square(scale=[-1, 1, 1])))
    assert mesh.bounds.tolist() == [[-1, 0, 0], [0, 1, 0]]
    assert rw.Scene(mesh).intersect((-0.5, 0.25, 1), (0, 0, -1)).normal.tolist() == [0, 0, 1]


def test_strips_and_fans_and_corners_without_indices(read):
    def faces(mode, indices, points):
        writer = Writer()
        writer.node(mesh=writer.mesh(indices=indices, POSITION=points))
        writer.json["meshes"][0]["primitives"][0]["mode"] = mode
        return own(read(writer))[0].faces.tolist()

    five = np.concatenate([SQUARE, [(2, 2, 0)]]).astype(np.float32)
    assert faces(5, None, five) == [[0, 1, 2], [1, 3, 2], [2, 3, 4]]
    assert faces(6, None, five) == [[1, 2, 0], [2, 3, 0], [3, 4, 0]]
    assert faces(5, np.array([4, 2, 0, 1], np.uint8), five) == [[4, 2, 0], [2, 1, 0]]
    assert faces(4, None, SQUARE[:3]) == [[0, 1, 2]]


def test_points_and_lines_are_left_out(read):
    writer = square()
    held = writer.json["meshes"][0]["primitives"]
    held.insert(0, {**held[0], "mode": 0})
    held.append({**held[0], "mode": 3})
    assert len(own(read(writer))) == 1


def test_numbers_may_be_shared_sparse_and_apart(read):
    """KHR_mesh_quantization, sparse accessors, and views with a stride."""
    writer = Writer()
    whole = np.zeros((4, 8), np.int16)
    whole[:, :3] = SQUARE * 32767
    whole[:, 4:7] = SQUARE * -32768
    view = writer.view(whole.tobytes(), byteStride=16)
    for offset in (0, 8):
        writer.add(
            "accessors",
            {
                "bufferView": view,
                "byteOffset": offset,
                "componentType": 5122,
                "count": 4,
                "type": "VEC3",
                "normalized": True,
            },
        )
    sparse = writer.accessor(SQUARE)
    writer.json["accessors"][sparse]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": writer.view(np.array([0, 3], np.uint8).tobytes()), "componentType": 5121},
        "values": {"bufferView": writer.view(np.array([(7, 7, 7), (8, 8, 8)], np.float32).tobytes())},
    }
    nothing = dict(writer.json["accessors"][sparse])
    del nothing["bufferView"]
    empty = writer.add("accessors", nothing)
    for position in (0, 1, sparse, empty):
        writer.node(mesh=writer.mesh(POSITION=position))
    positive, negative, replaced, zeros = own(read(writer))
    assert np.array_equal(positive.vertices, SQUARE)
    # The least integer is one more than the greatest, and stands for -1 too.
    assert np.array_equal(negative.vertices, -SQUARE)
    assert replaced.vertices.tolist() == [[7, 7, 7], [1, 0, 0], [1, 1, 0], [8, 8, 8]]
    assert zeros.vertices.tolist() == [[7, 7, 7], [0, 0, 0], [0, 0, 0], [8, 8, 8]]


def test_coordinates_begin_below_and_normals_and_colors_are_kept(read):
    writer = Writer()
    uv = np.array([(0, 0), (65535, 0), (65535, 65535), (0, 13107)], np.uint16)
    colors = np.array([(255, 0, 0, 255), (0, 51, 0, 255), (0, 0, 255, 255), (255, 255, 255, 255)], np.uint8)
    normals = np.tile(np.float32([0, 0.6, 0.8]), (4, 1))
    shared = {"normalized": True}
    mesh = writer.mesh(
        NORMAL=normals, TEXCOORD_0=writer.accessor(uv, **shared), COLOR_0=writer.accessor(colors, **shared)
    )
    writer.node(mesh=mesh)
    (mesh,) = own(read(writer))
    assert np.allclose(mesh.uv, [(0, 1), (1, 1), (1, 0), (0, 0.8)], rtol=0, atol=1e-15)
    assert np.array_equal(mesh.normals, normals)
    # Linear as they are: 51 is a fifth.
    assert mesh.colors.tolist() == [[1, 0, 0], [0, 0.2, 0], [0, 0, 1], [1, 1, 1]]
    assert mesh.material == rw.Diffuse(rw.VertexColors())


def test_lights_stand_and_shine_as_told(read):
    writer = square()
    point = writer.light(type="point", color=[1, 0.5, 0], intensity=683.0)
    spot = writer.light(
        type="spot", intensity=1366.0, spot={"innerConeAngle": math.pi / 6, "outerConeAngle": math.pi / 3}
    )
    sun = writer.light(type="directional", intensity=68.3)
    dark = writer.light(type="point", intensity=0)
    # A quarter turn about x takes -z to +y.
    top = writer.node(translation=[1, 2, 3], rotation=[TURN, 0, 0, TURN], scale=[2, 2, 2])
    for held in (point, spot, sun, dark):
        writer.node(top, translation=[0, 0, -1], extensions=held)
    made, cone, far = read(writer).scene.lights
    assert isinstance(made, rw.PointLight)
    assert made.position == pytest.approx((1, 4, 3), abs=1e-12)
    assert made.intensity == (1, 0.5, 0)
    assert isinstance(cone, rw.SpotLight)
    assert cone.intensity == (2, 2, 2)
    assert (cone.angle, cone.falloff) == pytest.approx((60, 30), abs=1e-12)
    axis = np.subtract(cone.target, cone.position)
    assert axis / np.linalg.norm(axis) == pytest.approx((0, 1, 0), abs=1e-12)
    assert isinstance(far, rw.DirectionalLight)
    assert far.direction == pytest.approx((0, 1, 0), abs=1e-12)
    assert far.irradiance == pytest.approx((0.1, 0.1, 0.1), rel=1e-15)


def test_a_square_below_a_point_light_has_its_irradiance(read):
    """I cos θ / d² of the closed form, times reflectance over π."""
    writer = Writer()
    white = {"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.5, 0.5, 1]}}
    white["extensions"] = {"KHR_materials_unlit": {}}
    writer.node(mesh=writer.mesh(white), scale=[10, 10, 1], translation=[-5, -5, 0])
    writer.node(translation=[0, 0, 2], extensions=writer.light(type="point", intensity=68300.0))
    # It looks down at (1, 0, 0), which is off by half the height.
    eye = {"type": "orthographic", "orthographic": {"xmag": 1e-4, "ymag": 1e-4, "znear": 0, "zfar": 9}}
    writer.node(translation=[1, 0, 5], camera=writer.add("cameras", eye))
    with pytest.warns(RuntimeWarning, match="unlit"):
        shot = read(writer)
    assert shot.scene.shapes[0].material == rw.Diffuse(0.5)
    assert shot.scene.environment is None
    picture = shot.render(samples=1, integrator=rw.Path(max_depth=1), progress=False).rgb
    d = math.sqrt(5)
    expected = 0.5 / math.pi * (100 * (2 / d) / d**2)
    assert picture == pytest.approx(expected, rel=2e-4)


def test_cameras_look_as_told(read):
    writer = square()
    eye = {"type": "perspective", "perspective": {"yfov": math.pi / 2, "aspectRatio": 2.0, "znear": 0.1}}
    top = writer.node(translation=[1, 2, 3], rotation=[0, TURN, 0, TURN], scale=[3, 3, 3])
    writer.node(top, translation=[0, 0, 2], camera=writer.add("cameras", eye))
    camera = read(writer).camera
    assert isinstance(camera, rw.Camera)
    assert (camera.width, camera.height, camera.fov) == (960, 480, pytest.approx(90))
    # The quarter turn takes +z to +x, so that it stands at x = 1 + 6 and looks along -x.
    origins, ways = camera.rays_through([(480, 240), (480, 0), (960, 240)])
    assert np.allclose(origins, (7, 2, 3), rtol=0, atol=1e-12)
    root = math.sqrt(0.5)
    expected = [(-1, 0, 0), (-root, root, 0), (-1 / math.sqrt(5), 0, -2 / math.sqrt(5))]
    assert np.allclose(ways, expected, rtol=0, atol=1e-12)


def test_parallel_cameras_and_those_without_a_width(read):
    writer = square()
    flat = {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 2, "znear": 0, "zfar": 9}}
    writer.node(translation=[0, 0, 4], camera=writer.add("cameras", flat))
    camera = read(writer).camera
    assert (camera.width, camera.height, camera.scale) == (720, 480, 4)
    origins, ways = camera.rays_through([(0, 0), (720, 480)])
    assert np.allclose(origins, [(-3, 2, 4), (3, -2, 4)], rtol=0, atol=1e-12)
    assert np.allclose(ways, (0, 0, -1), rtol=0, atol=1e-12)
    other = square()
    wide = {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}
    for _ in range(2):
        other.node(camera=other.add("cameras", wide))
    with pytest.warns(RuntimeWarning, match=r"scene.glb: the first of its 2 cameras is taken"):
        camera = read(other).camera
    assert (camera.width, camera.height) == (640, 480)


def test_what_has_no_camera_is_framed_and_what_has_no_light_is_lit(read):
    shot = read(square(scale=[1e3, 1e3, 1e3]))
    mesh = shot.scene.shapes[0]
    assert shot == rw.rendering.RenderSetup(*rw.scenes.studio(mesh))
    seen = shot.scene.intersect(*shot.camera.rays()).shape_id == 0
    border = np.concatenate([seen[0], seen[-1], seen[:, 0], seen[:, -1]])
    assert seen.any()
    assert not border.any()


def test_lamps_light_what_has_a_camera(read):
    def lit(**more):
        writer = Writer()
        # A hundredth of the least light without a camera.
        writer.node(mesh=writer.mesh({"emissiveFactor": [2e-4] * 3}), **more)
        if more:
            writer.json["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1, "znear": 1}}]
        scene = read(writer).scene
        return scene.environment is not None, len(scene.shapes)

    assert lit() == (True, 3)
    assert lit(camera=0) == (False, 1)


def test_large_meshes_at_many_nodes_are_instances(read):
    ball = trimesh.creation.icosphere(subdivisions=6)
    writer = Writer()
    vertices, faces = ball.vertices.astype(np.float32), ball.faces.astype(np.uint32).ravel()
    mesh = writer.mesh(indices=faces, POSITION=vertices)
    for x in (0, 3):
        writer.node(mesh=mesh, translation=[x, 0, 0])
    for x in (6, 9):
        writer.node(mesh=mesh, translation=[x, 0, 0], scale=[1, 1, -1])
    writer.node(mesh=mesh, translation=[12, 0, 0], scale=[1, 1, 0])
    shot = read(writer)
    copies, mirrored, flat = own(shot)
    assert [type(one) for one in own(shot)] == [rw.Instance, rw.Instance, rw.Mesh]
    assert copies.transform[:, :3, 3].tolist() == [[0, 0, 0], [3, 0, 0]]
    assert mirrored.transform[:, :3, 3].tolist() == [[6, 0, 0], [9, 0, 0]]
    assert flat.bounds[:, 2].tolist() == [0, 0]
    x, y, z = 0.5, 0.3, math.sqrt(1 - 0.5**2 - 0.3**2)
    origins = [(at + x, y, 9) for at in (0, 3, 6, 9)] + [(1.5, 0, 9)]
    hits = shot.scene.intersect(origins, (0, 0, -1))
    assert hits.hit.tolist() == [True] * 4 + [False]
    # A mesh of a ball deviates by the square of an edge, and its normals by half of an edge.
    assert hits.t[:4] == pytest.approx(9 - z, abs=1e-3)
    assert np.allclose(hits.normal[:4], (x, y, z), rtol=0, atol=0.02)
    # The generated camera sees all of them, and the floor, which is the fourth.
    assert set(shot.scene.intersect(*shot.camera.rays()).shape_id.ravel()) == {0, 1, 2, 3}


def test_vertices_that_many_primitives_share_are_kept_by_those_that_use_them(read):
    writer = square()
    held = writer.json["meshes"][0]["primitives"]
    many = writer.accessor(np.arange(90, dtype=np.float32).reshape(30, 3) ** 2)
    held[0] = {"attributes": {"POSITION": many}, "indices": writer.accessor(np.array([8, 2, 29], np.uint8))}
    (mesh,) = own(read(writer))
    assert mesh.vertices.tolist() == [[36, 49, 64], [576, 625, 676], [7569, 7744, 7921]]
    assert mesh.faces.tolist() == [[1, 0, 2]]


def test_copies_of_an_extension_are_made(read):
    writer = square(translation=[0, 0, 1])
    writer.json["extensionsRequired"] = writer.json["extensionsUsed"] = ["EXT_mesh_gpu_instancing"]
    attributes = {
        "TRANSLATION": writer.accessor(np.float32([(0, 0, 0), (5, 0, 0)])),
        "SCALE": writer.accessor(np.float32([(1, 1, 1), (2, 2, 2)])),
    }
    writer.json["nodes"][0]["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
    bounds = [mesh.bounds.tolist() for mesh in own(read(writer))]
    assert bounds == [[[0, 0, 1], [1, 1, 1]], [[5, 0, 1], [7, 2, 1]]]


def test_shapes_are_bent_as_they_are_at_rest(read):
    writer = Writer()
    which = np.zeros((4, 4), np.uint8)
    which[:, 1] = 1
    share = np.float32([(1, 0, 0, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0.25, 0.25, 0, 0)])
    normals = np.tile(np.float32([0, 0, 1]), (4, 1))
    mesh = writer.mesh(JOINTS_0=which, WEIGHTS_0=share, NORMAL=normals)
    target = {"POSITION": writer.accessor(SQUARE + np.float32([0, 0, 1]))}
    writer.json["meshes"][0]["primitives"][0]["targets"] = [target]
    writer.json["meshes"][0]["weights"] = [1.0]
    # A skinned mesh ignores the transform of its node.
    writer.node(mesh=mesh, skin=0, translation=[99, 99, 99])
    first = writer.node(translation=[0, 0, 5])
    second = writer.node(first, translation=[10, 0, 0])
    bound = np.tile(np.eye(4, dtype=np.float32), (2, 1, 1))
    bound[1, 3, 0] = -1  # columns: moved by -1 along x
    skin = {"joints": [first, second], "inverseBindMatrices": writer.accessor(bound)}
    writer.json["skins"] = [skin]
    writer.json["animations"] = [{}]
    with pytest.warns(RuntimeWarning, match="its animations are left out: it is shown at rest"):
        (mesh,) = own(read(writer))
    # The shape makes it twice as large and lifts it by 1; joints lift by 5, the second moves by 10 - 1.
    expected = [(0, 0, 6), (2, 0, 6), (2 + 9, 2, 6), (0 + 4.5, 2, 6)]
    assert np.allclose(mesh.vertices, expected, rtol=0, atol=1e-12)
    assert np.allclose(mesh.normals, (0, 0, 1), rtol=0, atol=1e-12)
    assert CORNERS.size == mesh.faces.size


def test_files_are_found_whatever_the_case_of_their_letters(tmp_path):
    writer = Writer()
    writer.node(mesh=writer.mesh())
    path = tmp_path / "a.gltf"
    (tmp_path / "Parts").mkdir()
    (tmp_path / "Parts" / "DATA.BIN").write_bytes(writer.data)
    writer.json["buffers"] = [{"uri": "parts/data.bin", "byteLength": len(writer.data)}]
    path.write_text(json.dumps(writer.json))
    assert len(read_gltf(path).scene.shapes) > 0
    writer.json["buffers"][0]["uri"] = "parts/other.bin"
    path.write_text(json.dumps(writer.json))
    with pytest.raises(ValueError, match=r"there is no file 'parts/other.bin' beside it"):
        read_gltf(path)
