"""``raywright sky``, ``thickness``, ``visibility`` and ``lidar``, as a shell sees them."""

import csv
import io
import re

import numpy as np
import pytest
import trimesh
from command_line import run_command as shell

import raywright as rw

VERBS = ("sky", "thickness", "visibility", "lidar")


@pytest.fixture
def folder(tmp_path):
    trimesh.creation.box((2.0, 4.0, 8.0)).export(tmp_path / "box.ply")
    # A floor under a roof of the same size, one unit apart.
    floor = np.array([(-1, 0, 1), (1, 0, 1), (1, 0, -1), (-1, 0, -1)], float)
    faces = np.array([(0, 1, 2), (0, 2, 3)])
    both = np.concatenate([floor, floor + np.array((0, 1, 0))])
    rw.Mesh(both, np.concatenate([faces, faces + 4])).save(tmp_path / "plates.ply")
    return tmp_path


def table(text):
    rows = list(csv.DictReader(io.StringIO(text)))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def run(*arguments, cwd):
    done = shell(*arguments, cwd=cwd)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_thickness_of_a_box_is_that_of_its_sides(folder):
    mesh = rw.Mesh.of(folder / "box.ply")
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    side = np.abs(middle / (1, 2, 4)).argmax(axis=1)
    found = table(run("thickness", "box.ply", cwd=folder))
    assert list(found) == ["x", "y", "z", "value"]
    assert np.allclose(np.stack([found[k] for k in "xyz"], axis=-1), middle, rtol=0, atol=1e-15)
    assert np.array_equal(found["value"], np.array([2.0, 4.0, 8.0])[side])
    told = run("thickness", "box.ply", "-o", "out.ply", cwd=folder)
    assert told == "thickness of 12: least 2, median 4, largest 8\nfile: out.ply\n"
    again = rw.Mesh.of(folder / "out.ply")
    assert np.array_equal(again.vertices, mesh.vertices)
    assert np.array_equal(again.faces, mesh.faces)
    assert np.array_equal(again.face_attributes["value"], found["value"])


@pytest.mark.parametrize(("suffix", "read"), [("csv", None), ("npz", None), ("npy", None)])
def test_files_hold_what_python_finds_to_the_last_bit(folder, suffix, read):
    expected = rw.measure.ambient_visibility(folder / "plates.ply", radius=3.0, rays=64, seed=7)
    options = ["--radius", 3, "--rays", 64, "--seed", 7, "-o", f"out.{suffix}", "--quiet"]
    assert run("visibility", "plates.ply", *options, cwd=folder) == ""
    path = folder / f"out.{suffix}"
    if suffix == "npy":
        assert np.array_equal(np.load(path), expected.value)
        return
    found = table(path.read_text()) if suffix == "csv" else np.load(path)
    assert np.array_equal(found["value"], expected.value)
    assert np.array_equal(found["standard_error"], expected.standard_error)


def test_files_of_several_meshes_are_one(folder):
    scene = trimesh.Scene()
    for k, color in enumerate(((255, 0, 0, 255), (0, 0, 255, 255))):
        ball = trimesh.creation.icosphere(subdivisions=1, radius=1.0)
        ball.visual.face_colors = color
        scene.add_geometry(ball.apply_translation((4.0 * k, 0, 0)))
    scene.export(folder / "two.glb")
    found = table(run("sky", "two.glb", "--rays", 16, cwd=folder))
    assert len(found["value"]) == 160


def test_vertices_have_their_values(folder):
    run("visibility", "box.ply", "--at", "vertices", "--rays", 16, "-o", "out.ply", "--quiet", cwd=folder)
    again = rw.Mesh.of(folder / "out.ply")
    assert np.array_equal(again.vertex_attributes["value"], np.ones(8))
    found = table(run("thickness", "box.ply", "--at", "vertices", "--method", "sphere", cwd=folder))
    # No ball fits into a corner.
    assert np.allclose(found["value"], 0.0, rtol=0, atol=1e-5)


def test_a_vertex_without_a_normal_has_no_value(folder):
    flat = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 0, -1), (5, 5, 5)], [(0, 1, 2)])
    flat.save(folder / "flat.ply")
    done = shell("sky", "flat.ply", "--at", "vertices", "-o", "out.npy", cwd=folder)
    assert done.returncode == 0
    assert done.stderr == "raywright: warning: 1 of 4 have no normal, and no value\n"
    assert np.array_equal(np.isnan(np.load(folder / "out.npy")), [False, False, False, True])


@pytest.mark.parametrize(
    "text",
    [
        "x,y,z,nx,ny,nz\n0,0.5,0,0,-1,0\n0,0,0,0,1,0\n",
        "name;Z;Y;X;NX;NY;NZ\na b;0;0.5;0;0;-1;0\n\nc;0;0;0;0;1;0\n",
        "0 0.5 0 0 -1 0\n# a comment\n0 0 0 0 1 0\n",
        "\ufeffx\ty\tz\tnx\tny\tnz\n0\t.5\t0\t0\t-1\t0\n0\t0\t0\t0\t1\t0\n",
    ],
)
def test_tables_of_points_are_read(folder, text):
    (folder / "p.csv").write_text(text, encoding="utf-8")
    points, normals = np.array([[0, 0.5, 0], [0, 0, 0]]), np.array([[0, -1, 0], [0, 1, 0]])
    expected = rw.measure.sky_view(folder / "plates.ply", points, normals)
    found = table(run("sky", "plates.ply", "--points", "p.csv", cwd=folder))
    assert np.array_equal(np.stack([found[k] for k in "xyz"], axis=-1), points)
    assert np.array_equal(found["value"], expected.value)


def test_arrays_of_points_are_read(folder):
    points = np.random.default_rng(3).uniform(-1, 1, (5, 3))
    np.save(folder / "p.npy", points)
    np.savez(folder / "p.npz", x=points[:, 0], y=points[:, 1], z=points[:, 2])
    expected = rw.measure.sky_view(folder / "plates.ply", points, (0, 1, 0), up=(0, 0, 1), offset=0.01)
    options = ["--normal", 0, 1, 0, "--up", "z", "--offset", 0.01]
    for name in ("p.npy", "p.npz"):
        found = table(run("sky", "plates.ply", "--points", name, *options, cwd=folder))
        assert np.array_equal(found["value"], expected.value)
    run("sky", "plates.ply", "--points", "p.npy", *options, "-o", "cloud.ply", "--quiet", cwd=folder)
    cloud = trimesh.load(folder / "cloud.ply")
    assert np.array_equal(cloud.vertices, points)


def test_points_without_normals_have_those_of_the_nearest_faces(folder):
    (folder / "p.csv").write_text("x,y,z\n0.1,0.1,0.2\n0.1,0.95,0.2\n")
    expected = rw.measure.thickness(folder / "box.ply", [(0.1, 0.1, 0.2)], [(1, 0, 0)])
    found = table(run("thickness", "box.ply", "--points", "p.csv", cwd=folder))
    assert found["value"][0] == expected[0] == 1.1


def test_a_scan_is_a_cloud_of_points(folder):
    where = ["--position", 0, 0, 0, "--columns", 90, "--beams", 3, "--elevations", -10, 10]
    run("lidar", "box.ply", *where, "-o", "scan.npz", "--quiet", cwd=folder)
    found = np.load(folder / "scan.npz")
    place = np.stack([found[k] for k in "xyz"], axis=-1)
    # From inside, every beam ends on a side of the box.
    assert len(place) == 270
    assert np.allclose(np.abs(place / (1, 2, 4)).max(axis=1), 1.0, rtol=0, atol=1e-12)
    assert np.allclose(np.linalg.norm(place, axis=1), found["range"], rtol=1e-14, atol=0)
    told = run("lidar", "box.ply", *where, "-o", "scan.ply", cwd=folder)
    assert told == "270 returns of 270 beams\nfile: scan.ply\n"
    assert np.array_equal(trimesh.load(folder / "scan.ply").vertices, place)
    run("lidar", "box.ply", *where, "-o", "scan.npy", "--quiet", cwd=folder)
    assert np.array_equal(np.load(folder / "scan.npy"), place)


def test_a_place_sees_what_nothing_hides(folder):
    corner = ["--from", 5, 0, 0]
    found = table(run("visibility", "box.ply", *corner, cwd=folder))
    assert list(found) == ["x", "y", "z", "value", "distance"]
    # The side of the box that faces it.
    assert np.array_equal(found["value"], (found["x"] == 1.0).astype(float))
    place = np.stack([found[k] for k in "xyz"], axis=-1)
    assert np.allclose(found["distance"], np.linalg.norm(place - (5, 0, 0), axis=1), rtol=1e-14)
    # In front, and behind.
    np.save(folder / "p.npy", [(2.0, 0, 0), (-2.0, 0, 0)])
    found = table(run("visibility", "box.ply", *corner, "--points", "p.npy", cwd=folder))
    assert found["value"].tolist() == [1, 0]
    run("visibility", "box.ply", *corner, "--at", "vertices", "-o", "seen.ply", "--quiet", cwd=folder)
    seen = rw.Mesh.of(folder / "seen.ply")
    assert np.array_equal(seen.vertex_attributes["value"], seen.vertices[:, 0] == 1.0)


@pytest.mark.parametrize("verb", VERBS)
def test_help_has_an_example_that_is_parsed(verb, tmp_path):
    done = shell(verb, "--help", cwd=tmp_path)
    assert done.returncode == 0
    example = " ".join(done.stdout.partition("example: raywright ")[2].split())
    assert example.startswith(f"{verb} ")
    # Everything is right except for the missing file.
    again = shell(*example.split(), cwd=tmp_path)
    assert again.returncode == 1
    assert re.fullmatch(r"raywright: error: \S+: no such file\n", again.stderr)


@pytest.mark.parametrize("verb", VERBS)
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], r"the following arguments are required: MESH"),
        (["box.ply", "-o", "a.foo"], r"argument -o/--output: a result is saved as .*; a\.foo is none .*"),
        (["box.ply", "--threads", "0"], r"argument --threads: must be at least 1, got 0"),
        (["box.ply", "--wings"], r"unrecognized arguments: --wings"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(folder, verb, arguments, message):
    _refused([verb, *arguments], message, folder)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["sky", "box.ply", "--rays", "3"], r"argument --rays: must be between 16 and .*, got 3"),
        (["sky", "box.ply", "--offset", "-1"], r"argument --offset: must be at least 0, got -1"),
        (["sky", "box.ply", "--offset", "nan"], r"argument --offset: must be at least 0, got nan"),
        (["sky", "box.ply", "--normal", "0", "1", "0"], r"argument --normal: only allowed with --points"),
        (
            ["sky", "box.ply", "--points", "p.csv", "--normal", "0", "0", "0"],
            "argument --normal: must not be zero, got 0 0 0",
        ),
        (
            ["sky", "box.ply", "--points", "p.csv", "--normal", "0", "inf", "0"],
            "argument --normal: must be finite, got inf",
        ),
        (["sky", "box.ply", "--points", "p.csv", "--at", "vertices"], ".*not allowed with argument.*"),
        (["sky", "box.ply", "--points", "p.xls"], r"argument --points: p\.xls: points are read from .*"),
        (
            ["sky", "box.ply", "--points", "p.csv"],
            r"argument --points: p\.csv must have columns x, y, z .*, got lon, lat",
        ),
        (
            ["sky", "box.ply", "--points", "q.csv"],
            r"argument --points: q\.csv, line 3: must have a number in column 2, got 'up'",
        ),
        (
            ["sky", "box.ply", "--points", "r.csv"],
            r"argument --points: r\.csv, line 2: must have a number in column 3, got 2 columns",
        ),
        (["sky", "box.ply", "--points", "s.csv"], r"argument --points: s\.csv holds no points"),
        (
            ["sky", "box.ply", "--points", "t.npy"],
            r"argument --points: t\.npy must hold real numbers of shape .*, got float64 of \(2, 2\)",
        ),
        (["visibility", "box.ply", "--radius", "0"], r"argument --radius: must be greater than 0, got 0"),
        (
            ["visibility", "box.ply", "--radius", "1", "--from", "0", "0", "0"],
            "argument --radius: not allowed with argument --from",
        ),
        (["thickness", "box.ply", "--method", "x"], r"argument --method: invalid choice: .*"),
        (["lidar", "box.ply", "--dropout", "2"], r"argument --dropout: must be between 0 and 1, got 2"),
        (["lidar", "box.ply", "--forward", "0", "1", "0"], r"forward must not be parallel to up, .*"),
        (["lidar", "box.ply", "--elevations", "-100", "0"], r"elevations must be .*"),
        (["lidar", "box.ply", "--min-range", "3", "--max-range", "2"], r"min_range must be .*"),
    ],
)
def test_values_that_do_not_fit_are_status_2(folder, arguments, message):
    for name, text in {
        "p.csv": "lon,lat\n1,2\n",
        "q.csv": "x,y,z\n0,0,0\n0,up,0\n",
        "r.csv": "x,y,z\n0,0\n",
        "s.csv": "# nothing\n\n",
    }.items():
        (folder / name).write_text(text)
    np.save(folder / "t.npy", np.zeros((2, 2)))
    _refused(arguments, message, folder)


@pytest.mark.parametrize("verb", VERBS)
def test_failures_are_one_line_and_status_1(folder, verb):
    done = shell(verb, "gone.ply", "-o", "a.csv", cwd=folder)
    assert (done.returncode, done.stdout) == (1, "")
    assert done.stderr == "raywright: error: gone.ply: no such file\n"
    done = shell(verb, "box.ply", "-o", "gone/a.csv", cwd=folder)
    assert (done.returncode, done.stderr) == (1, "raywright: error: gone: no such folder\n")
    assert not (folder / "a.csv").exists()


def _refused(arguments, message, folder):
    before = sorted(folder.rglob("*"))
    done = shell(*arguments, cwd=folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(rf"raywright: error: {message} \(see raywright.* --help\)\n", done.stderr)
    assert sorted(folder.rglob("*")) == before
