"""Meshes from trimesh and from files."""

import errno
import logging
import struct
from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh.visual.material import MultiMaterial, PBRMaterial, SimpleMaterial

import raywright as rw


@pytest.fixture
def ball():
    return trimesh.creation.icosphere(subdivisions=2)


def only(shapes):
    (mesh,) = rw.Scene(shapes).shapes
    return mesh


@pytest.mark.parametrize("suffix", ["ply", "obj", "stl", "glb", "off"])
@pytest.mark.parametrize("kind", [str, Path])
def test_a_file_gives_the_mesh_that_was_saved(tmp_path, ball, suffix, kind):
    path = tmp_path / f"ball.{suffix}"
    ball.export(path)
    mesh = only(kind(path))
    assert len(mesh.vertices) == len(ball.vertices)
    assert len(mesh.faces) == len(ball.faces)
    # Faces keep their order, whatever the numbers of their vertices.
    assert np.allclose(mesh.vertices[mesh.faces], ball.triangles, rtol=0, atol=1e-6)
    assert mesh.normals is None
    assert rw.Scene(path).intersect((0, 0, 3), (0, 0, -1)).t == pytest.approx(2, abs=1e-6)


def test_stl_corners_are_joined_only_where_they_are_equal(tmp_path, ball):
    ball.apply_scale(1e-9)
    ball.export(tmp_path / "tiny.stl")
    mesh = only(tmp_path / "tiny.stl")
    assert len(mesh.vertices) == 162
    assert np.allclose(mesh.vertices[mesh.faces], ball.triangles, rtol=1e-6, atol=0)


def test_a_trimesh_is_taken_as_it_is(ball):
    mesh = only(ball)
    assert np.array_equal(mesh.vertices, ball.vertices)
    assert np.array_equal(mesh.faces, ball.faces)
    assert mesh.material == rw.Diffuse()
    assert mesh.emission is None


def test_trimesh_and_raywright_agree_on_hits(ball):
    origins = np.random.default_rng(4).normal(size=(60, 3)) * 3
    hits = rw.Scene(ball).intersect(origins, -origins)
    assert hits.hit.all()
    corners = ball.triangles[hits.primitive_id]
    u, v = hits.uv.T[..., np.newaxis]
    points = (1 - u - v) * corners[:, 0] + u * corners[:, 1] + v * corners[:, 2]
    assert np.allclose(points, origins * (1 - hits.t[:, np.newaxis]), atol=1e-6)
    assert np.allclose(hits.normal, ball.face_normals[hits.primitive_id], atol=1e-5)


def test_normals_count_only_when_they_were_given(ball, tmp_path):
    logging.getLogger("trimesh").disabled = True
    looked_at = np.array(ball.vertex_normals)
    logging.getLogger("trimesh").disabled = False
    assert only(ball).normals is None
    given = trimesh.Trimesh(
        ball.vertices, ball.faces, vertex_normals=np.roll(looked_at, 1, axis=0), process=False
    )
    assert np.array_equal(only(given).normals, np.roll(looked_at, 1, axis=0))
    given.export(tmp_path / "given.ply")
    assert np.allclose(only(tmp_path / "given.ply").normals, np.roll(looked_at, 1, axis=0), atol=1e-6)


def test_scene_nodes_become_meshes_with_their_transforms(ball, tmp_path):
    scene = trimesh.Scene()
    scene.add_geometry(ball, node_name="first", geom_name="ball")
    moved = trimesh.transformations.translation_matrix((5, 0, 0)) @ np.diag([2.0, 2, 2, 1])
    scene.add_geometry(trimesh.creation.box(), geom_name="box")
    scene.graph.update(frame_to="second", matrix=moved, geometry="ball", geometry_flags={"visible": True})
    scene.add_geometry(trimesh.PointCloud(np.zeros((3, 3))))
    for source in (scene, tmp_path / "scene.glb"):
        if source is scene:
            with pytest.warns(RuntimeWarning, match=r"left out of trimesh.Scene: '.*', a PointCloud") as told:
                shapes = rw.Scene([source]).shapes
            assert len(told) == 1
        else:
            scene.export(source)
            shapes = rw.Scene([source]).shapes
        assert sorted(len(shape.faces) for shape in shapes) == [12, 320, 320]
        spans = sorted(tuple(shape.bounds[:, 0].round(6)) for shape in shapes)
        assert spans == [(-1.0, 1.0), (-0.5, 0.5), (3.0, 7.0)]


def test_mirrored_nodes_stay_wound_outwards(ball):
    scene = trimesh.Scene()
    scene.add_geometry(ball, transform=np.diag([1.0, 1, -1, 1]))
    assert np.dot(rw.Scene(scene).intersect((0, 0.1, 3), (0, 0, -1)).normal, (0, 0, 1)) > 0.9


@pytest.mark.parametrize(
    ("visual", "reflectance"),
    [
        (None, (0.5, 0.5, 0.5)),
        ({"face_colors": [255, 0, 188, 255]}, (1.0, 0.0, 0.502886)),
        ({"vertex_colors": [10, 255, 0, 255]}, (0.003035, 1.0, 0.0)),
        (SimpleMaterial(diffuse=[188, 0, 255, 255]), (0.502886, 0.0, 1.0)),
        # Already linear by the definition of glTF.
        (PBRMaterial(baseColorFactor=[51, 0, 255, 255]), (0.2, 0.0, 1.0)),
        (PBRMaterial(), (0.5, 0.5, 0.5)),
    ],
    ids=["none", "faces", "vertices", "simple", "pbr", "pbr without color"],
)
def test_colors_become_linear_reflectances(visual, reflectance):
    box = trimesh.creation.box()
    if isinstance(visual, dict):
        box.visual = trimesh.visual.ColorVisuals(box, **visual)
    elif visual is not None:
        box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=visual)
    material = only(box).material
    shown = material.base_color if isinstance(material, rw.MetallicRough) else material.reflectance
    assert shown == pytest.approx(reflectance, abs=1e-6)


def test_nan_in_a_file_is_dropped_with_a_warning(tmp_path):
    head = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    (tmp_path / "nan.ply").write_text(head + "nan 0 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 1 2 3\n")
    scene = rw.Scene(tmp_path / "nan.ply")
    with pytest.warns(RuntimeWarning, match="1 of 2 faces were dropped"):
        assert scene.intersect((0.2, 0.3, 1), (0, 0, -1)).primitive_id == 1


NOISE = np.random.default_rng(5).bytes(3000)
STL_HEADER = b"\0" * 80 + struct.pack("<I", 10**6)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        *(
            (f"noise.{suffix}", NOISE, "not a mesh that can be read")
            for suffix in ("ply", "stl", "obj", "glb", "off")
        ),
        ("noise.gltf", NOISE, "not a mesh that can be read"),
        *(
            (f"empty.{suffix}", b"", "(not a mesh that can be read|no faces)")
            for suffix in ("ply", "stl", "obj", "glb")
        ),
        ("text.stl", b"hello world\n" * 9, "(not a mesh that can be read|no faces)"),
        ("text.obj", b"hello world\n" * 9, "holds no faces"),
        ("text.ply", b"hello world\n" * 9, "not a mesh that can be read"),
        ("cut.stl", STL_HEADER, "(not a mesh that can be read|no faces)"),
        ("vertices.obj", b"v 0 0 0\nv 1 0 0\n", "(not a mesh that can be read|no faces)"),
        ("range.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "not a mesh that can be read"),
        ("picture.jpeg", b"x", r"suffix .jpeg is not a mesh format; known are .*glb.*ply.*stl"),
        ("nothing", b"x", "a name without a suffix is not a mesh format"),
    ],
    ids=lambda x: x if isinstance(x, str) and "." in x and " " not in x else "",
)
def test_files_that_are_no_mesh_are_refused_in_one_line(tmp_path, caplog, capfd, name, content, message):
    (tmp_path / name).write_bytes(content)
    # Warnings are errors here, and would be of another kind.
    with pytest.raises(ValueError, match=message) as caught:
        rw.Scene(tmp_path / name)
    told = str(caught.value)
    assert name in told
    assert "\n" not in told
    assert len(told) < 300 + len(str(tmp_path))
    assert not caplog.records
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("suffix", ["dae", "zae", "3mf", "3dxml", "xaml", "step", "STP", "drc", "ctm"])
def test_kinds_that_need_a_package_name_it(tmp_path, suffix, monkeypatch):
    path = tmp_path / f"a.{suffix}"
    path.write_bytes(b"x")
    known = trimesh.available_formats() - {suffix.lower()}
    monkeypatch.setattr(trimesh, "available_formats", lambda: known)
    packages = {"dae": "pycollada", "zae": "pycollada", "drc": "draco_decoder", "ctm": "openctm"}
    packages |= {"step": "cascadio", "stp": "cascadio"}
    for read in (rw.Scene, rw.load):
        with pytest.raises(ImportError, match=packages.get(suffix.lower(), "lxml")) as caught:
            read(path)
        assert str(path) in str(caught.value)


def test_points_alone_are_refused(tmp_path):
    trimesh.PointCloud(np.random.default_rng(6).normal(size=(9, 3))).export(tmp_path / "points.ply")
    with pytest.raises(ValueError, match=r"points.ply holds no faces"):
        rw.Scene(tmp_path / "points.ply")


def test_missing_files_and_folders(tmp_path):
    with pytest.raises(FileNotFoundError, match=r"no such file: .*gone\.ply") as caught:
        rw.Scene(tmp_path / "gone.ply")
    assert caught.value.errno == errno.ENOENT
    assert caught.value.filename == str(tmp_path / "gone.ply")
    with pytest.raises(ValueError, match="is a folder, not a mesh file"):
        rw.Scene(str(tmp_path))


def test_loading_leaves_the_log_as_it_was(tmp_path, ball):
    ball.export(tmp_path / "ball.ply")
    log = logging.getLogger("trimesh")
    assert not log.disabled
    rw.Scene(tmp_path / "ball.ply")
    assert not log.disabled


def many_materials(**which):
    box = trimesh.creation.box()
    red, green = SimpleMaterial(diffuse=[255, 0, 0, 255]), PBRMaterial(baseColorFactor=[0, 255, 0, 255])
    visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=MultiMaterial([red, green]), **which)
    return trimesh.Trimesh(box.vertices, box.faces, process=False, visual=visual)


def test_a_trimesh_of_many_materials_is_a_mesh_of_each(ball):
    box = many_materials(face_materials=[1] * 5 + [0] * 7)
    plain = only(trimesh.Trimesh(box.vertices, box.faces, process=False))
    for given in (box, trimesh.Scene({"box": box})):
        scene = rw.Scene(given)
        red, green = scene.shapes
        assert red.material == rw.Diffuse((1.0, 0.0, 0.0))
        assert green.material.base_color == (0.0, 1.0, 0.0)
        assert np.array_equal(red.faces, box.faces[5:])
        assert np.array_equal(green.faces, box.faces[:5])
        rays = np.random.default_rng(5).normal(size=(2, 500, 3))
        assert np.array_equal(scene.intersect(*rays).t, rw.Scene(plain).intersect(*rays).t)
    with pytest.warns(
        RuntimeWarning, match="2 materials but no face_materials: all of its faces get the first"
    ):
        assert only(many_materials()).material == rw.Diffuse((1.0, 0.0, 0.0))
    ball.visual = trimesh.visual.TextureVisuals(material=MultiMaterial())
    assert only(ball).material == only(trimesh.creation.icosphere()).material
    for wrong, came in (([0] * 11, "got 11"), ([2] * 12, "got 2 to 2"), ([-1] * 12, "got -1 to -1")):
        with pytest.raises(ValueError, match=f"face_materials must be 12 numbers of 2 materials.*{came}"):
            rw.Scene(many_materials(face_materials=wrong))
