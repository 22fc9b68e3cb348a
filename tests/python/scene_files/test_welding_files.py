"""Scene files whose corners rounding has parted: they are welded as those of plain mesh files are."""

import pickle

import numpy as np
import pytest
import trimesh
from gltf_writer import Writer
from pbrt_files import HEAD

import raywright as rw

# A rotation and scale that single precision cannot represent.
PLACE = trimesh.transformations.rotation_matrix(0.7, (1, 2, 3))
PLACE[:3, :3] *= 30.0
PLACE[:3, 3] = 1.0, 2.0, 3.0
TURNS = [trimesh.transformations.rotation_matrix(angle, (1, 1, 0)) for angle in (0.1, 0.4)]


def cracked(seed=0):
    """Return corners and faces of a cube of which each face has corners of its own, an ulp off."""
    box = trimesh.creation.box()
    corners = np.float32(box.vertices + 1.1)[box.faces].reshape(-1, 3)
    off = np.random.default_rng(seed).integers(-1, 2, corners.shape)
    corners = np.where(off > 0, np.nextafter(corners, np.float32(9)), corners)
    corners = np.where(off < 0, np.nextafter(corners, np.float32(-9)), corners)
    return corners, np.arange(36).reshape(-1, 3)


UV = np.random.default_rng(5).random((36, 2)).astype(np.float32)
NORMALS = np.repeat(np.float32(trimesh.creation.box().face_normals), 3, axis=0)
COLORS = np.random.default_rng(6).random((36, 3)).astype(np.float32)


def ply(folder):
    corners, faces = cracked()
    trimesh.Trimesh(corners, faces, process=False).export(folder / "box.ply")


def row(values):
    return " ".join(f"{x!r}" for x in np.asarray(values, float).reshape(-1).tolist())


def gltf(folder):
    writer, (corners, faces) = Writer(), cracked()
    attributes = {"POSITION": corners, "TEXCOORD_0": UV, "NORMAL": NORMALS, "COLOR_0": COLORS}
    index = writer.mesh(indices=faces.reshape(-1).astype(np.uint16), **attributes)
    writer.node(mesh=index, matrix=PLACE.T.reshape(-1).tolist())
    path = folder / "box.gltf"
    path.write_bytes(writer.gltf())
    return path


def usd(folder):
    pytest.importorskip("pxr")
    corners, _ = cracked()
    points = ", ".join(str(tuple(corner)) for corner in corners.astype(float).tolist())
    matrix = ", ".join(str(tuple(line)) for line in PLACE.T.tolist())
    path = folder / "box.usda"
    path.write_text(f"""#usda 1.0
def Mesh "Box" {{
    int[] faceVertexCounts = {[3] * 12}
    int[] faceVertexIndices = {list(range(36))}
    point3f[] points = [{points}]
    uniform token subdivisionScheme = "none"
    matrix4d xformOp:transform = ({matrix})
    uniform token[] xformOpOrder = ["xformOp:transform"]
}}
""")
    return path


def pbrt(folder, shape='Shape "plymesh" "string filename" "box.ply"', world="{}"):
    ply(folder)
    path = folder / "box.pbrt"
    placed = f"Transform [{row(PLACE.T)}]\n{shape}"
    path.write_text(f"{HEAD}\nWorldBegin\nAttributeBegin\n{world.format(placed)}\nAttributeEnd\n")
    return path


def pbrt_inline(folder):
    corners, faces = cracked()
    numbers = " ".join(map(str, faces.reshape(-1)))
    values = f'"point3 P" [{row(corners)}] "integer indices" [{numbers}] "point2 uv" [{row(UV)}]'
    return pbrt(folder, f'Shape "trianglemesh" {values}')


def mitsuba(folder):
    ply(folder)
    path = folder / "box.xml"
    path.write_text(f"""<scene version="3.0.0">
    <sensor type="perspective"/>
    <shape type="ply"><string name="filename" value="box.ply"/>
    <transform name="to_world"><matrix value="{row(PLACE)}"/></transform></shape></scene>""")
    return path


def in_instance(folder):
    objects = 'ObjectBegin "box"\n{}\nObjectEnd\nScale 2 3 4\nObjectInstance "box"'
    return pbrt(folder, world=objects)


FILES = [gltf, usd, pbrt, pbrt_inline, mitsuba]


def mesh_of(shot):
    return next(shape for shape in shot.scene.shapes if len(getattr(shape, "faces", ())) == 12)


@pytest.mark.parametrize("write", FILES, ids=lambda one: one.__name__)
def test_corners_of_scene_files_are_welded_where_they_stand(write, tmp_path):
    path = write(tmp_path)
    mesh = mesh_of(rw.load(path))
    apart = mesh_of(rw.load(path, weld=None))
    assert (len(mesh.vertices), len(apart.vertices)) == (36, 36)
    assert len(np.unique(mesh.vertices, axis=0)) == 8
    assert len(np.unique(apart.vertices, axis=0)) > 20
    assert np.abs(mesh.vertices - apart.vertices).max() < 2e-5
    # All else is unchanged.
    for name in ("normals", "uv", "colors"):
        one, other = getattr(mesh, name), getattr(apart, name)
        assert (one is None) == (other is None)
        assert one is None or np.array_equal(one, other)
    assert np.array_equal(mesh.faces, apart.faces)
    assert mesh.material == apart.material
    points = np.random.default_rng(1).uniform(0, 2.2, (400, 3))
    wanted = (np.abs(points - 1.1) < 0.5).all(axis=1)
    mirror = np.diag([-1.0 if write in (pbrt, pbrt_inline) else 1.0, 1, 1])
    world = (points @ PLACE[:3, :3].T + PLACE[:3, 3]) @ mirror
    assert np.array_equal(rw.Scene(mesh).contains(world), wanted)
    assert rw.measure.topology(mesh).is_closed
    assert not rw.measure.topology(rw.Scene(apart, weld=None)).is_closed


@pytest.mark.parametrize("write", FILES, ids=lambda one: one.__name__)
def test_how_close_corners_of_a_file_are_one_can_be_said(write, tmp_path):
    path = write(tmp_path)
    assert rw.load(path).scene.weld == "auto"
    assert rw.load(path, weld=None).scene.weld is None
    near = rw.load(path, weld=1e-4)
    assert near.scene.weld == 1e-4
    assert len(np.unique(mesh_of(near).vertices, axis=0)) == 8
    assert len(np.unique(mesh_of(rw.load(path, weld=1e-12)).vertices, axis=0)) > 20
    with pytest.raises(ValueError, match="weld must be at least 0, got -1"):
        rw.load(path, weld=-1)


def test_mesh_files_take_a_weld_too(tmp_path):
    ply(tmp_path)
    for weld, count in (("auto", 8), (1e-4, 8), (None, 36)):
        shot = rw.load(tmp_path / "box.ply", weld=weld)
        found = len(np.unique(mesh_of(shot).vertices, axis=0))
        assert found == count if count == 8 else found > 20
        assert shot.scene.weld == weld
    with pytest.raises(ValueError, match="weld must be 'auto', a distance or None"):
        rw.load(tmp_path / "box.ply", weld="near")


def test_mitsuba_scenes_as_dicts_take_a_weld_too(tmp_path):
    ply(tmp_path)
    scene = {"type": "scene", "eye": {"type": "perspective"}, "box": {"type": "ply", "filename": "box.ply"}}
    for weld, is_welded in (("auto", True), (None, False)):
        shot = rw.from_mitsuba(scene, folder=tmp_path, weld=weld)
        assert (len(np.unique(mesh_of(shot).vertices, axis=0)) == 8) == is_welded
        assert shot.scene.weld == weld


def test_meshes_in_instances_are_welded(tmp_path):
    path = in_instance(tmp_path)
    for weld, is_welded in (("auto", True), (None, False), (1e-2, True)):
        scene = rw.load(path, weld=weld).scene
        (copies,) = scene.shapes
        (mesh,) = copies.shapes
        assert (len(np.unique(mesh.vertices, axis=0)) == 8) == is_welded
    # A distance applies in the scene, whatever the scale of copies.
    corners, faces = cracked()
    apart = rw.Mesh(corners + np.random.default_rng(2).uniform(0, 1e-3, corners.shape), faces)
    for scale, is_welded in ((1.0, True), (100.0, False)):
        scene = rw.Scene(rw.Instance(apart, np.diag([scale, scale, scale, 1])), weld=3e-3)
        assert (len(np.unique(scene.shapes[0].shapes[0].vertices, axis=0)) == 8) == is_welded


def test_instances_of_the_same_shapes_still_share_them():
    corners, faces = cracked()
    mesh, ball = rw.Mesh(corners, faces), rw.Sphere()
    one, other = (
        rw.Instance([mesh, ball], np.eye(4)),
        rw.Instance([mesh, ball], 2 * np.eye(4) - np.diag([0, 0, 0, 1])),
    )
    scene = rw.Scene([one, other, ball], weld="auto").welded()
    assert scene.shapes[0].shapes[0] is scene.shapes[1].shapes[0]
    assert scene.shapes[0].shapes[0] is not mesh
    assert scene.shapes[2] is ball


def test_a_mesh_that_was_moved_keeps_its_own_rounding():
    corners, faces = cracked()
    mesh = rw.Mesh(corners, faces).transformed(PLACE).transformed(np.diag([1.0, -1.0, 1.0, 1.0]))
    assert len(np.unique(mesh.vertices, axis=0)) > 20
    points = np.random.default_rng(3).uniform(0, 2.2, (400, 3))
    wanted = (np.abs(points - 1.1) < 0.5).all(axis=1)
    world = (points @ PLACE[:3, :3].T + PLACE[:3, 3]) * (1, -1, 1)
    for scene in (rw.Scene(mesh), pickle.loads(pickle.dumps(rw.Scene(mesh)))):
        assert np.array_equal(scene.contains(world), wanted)
        assert np.array_equal(scene.signed_distance(world) < 0, wanted)
        assert len(np.unique(scene.welded().shapes[0].vertices, axis=0)) == 8
    assert not rw.Scene(mesh, weld=None).contains(world).any()


def test_files_without_cracks_keep_every_bit(tmp_path):
    box = trimesh.creation.box()
    writer = Writer()
    index = writer.mesh(
        indices=box.faces.reshape(-1).astype(np.uint16), POSITION=np.float32(box.vertices + 1.1)
    )
    writer.node(mesh=index, matrix=PLACE.T.reshape(-1).tolist())
    (tmp_path / "box.gltf").write_bytes(writer.gltf())
    for weld in ("auto", 1e-3):
        assert mesh_of(rw.load(tmp_path / "box.gltf", weld=weld)) == mesh_of(
            rw.load(tmp_path / "box.gltf", weld=None)
        )


def parted(**node):
    """Return a glTF document of the cube in two parts at one node."""
    writer, (corners, _) = Writer(), cracked()
    primitives = []
    for some in (corners[:15], corners[15:]):
        index = writer.mesh(indices=None, POSITION=some)
        primitives += writer.json["meshes"][index]["primitives"]
    writer.json["meshes"] = [{"primitives": primitives}]
    writer.node(mesh=0, **node)
    return writer


def corners_of(shot):
    parts = [shape for shape in shot.scene.shapes if len(getattr(shape, "faces", ())) in (5, 7)]
    assert [len(part.faces) for part in parts] == [5, 7]
    return np.concatenate([part.vertices for part in parts])


def test_meshes_are_welded_to_each_other_by_the_lesser_of_their_roundings(tmp_path):
    """Whatever else is in the scene: the floor that a file without a light is put on has all digits."""
    path = tmp_path / "parts.gltf"
    path.write_bytes(parted(matrix=PLACE.T.reshape(-1).tolist()).gltf())
    assert len(np.unique(corners_of(rw.load(path)), axis=0)) == 8
    assert len(np.unique(corners_of(rw.load(path, weld=None)), axis=0)) > 20
    shapes = rw.load(path, weld=None).scene.shapes
    # A copy with all digits stays apart from the others.
    corners, faces = cracked()
    double = rw.Mesh(corners[:15].astype(np.float64) + 1e-9, faces[:5])
    single = rw.Mesh(corners[15:], faces[:7])
    closed = rw.Scene([double, single, *shapes]).welded().shapes
    places = [set(map(tuple, mesh.vertices.tolist())) for mesh in closed[:2]]
    assert not places[0] & places[1]


def test_skins_do_not_keep_corners_apart(tmp_path):
    writer, (corners, _) = Writer(), cracked()
    share = np.tile(np.float32([0.25, 0.75, 0, 0]), (36, 1))
    joints = np.tile(np.uint8([0, 1, 0, 0]), (36, 1))
    index = writer.mesh(indices=None, POSITION=corners, JOINTS_0=joints, WEIGHTS_0=share)
    writer.node(mesh=index, skin=0)
    bones = [writer.node(matrix=(PLACE @ turn).T.reshape(-1).tolist()) for turn in TURNS]
    writer.json["skins"] = [{"joints": bones}]
    path = tmp_path / "bent.gltf"
    path.write_bytes(writer.gltf())
    assert len(np.unique(mesh_of(rw.load(path)).vertices, axis=0)) == 8
    assert len(np.unique(mesh_of(rw.load(path, weld=None)).vertices, axis=0)) > 20
