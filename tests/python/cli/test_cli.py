"""The shell command, as a shell sees it."""

import os
import re
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import trimesh
from command_line import run_command as shell
from PIL import Image as Pillow

import raywright as rw

SMALL = ["--width", "16", "--height", "12"]


@pytest.fixture
def ball(tmp_path):
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / "ball.ply")
    return tmp_path / "ball.ply"


def test_demo_renders_the_box_and_tells_its_error(tmp_path):
    done = shell("demo", "--samples", 8, "--width", 24, "--height", 20, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "error against time"
    assert lines[1].split() == ["seconds", "samples", "relMSE"]
    assert re.fullmatch(r" +\d+\.\d\d +8 +\S+", lines[-3])
    assert lines[-2].startswith("relMSE ")
    assert lines[-1] == "picture: cornell.png"
    assert "8 samples, relMSE" in done.stderr
    with Pillow.open(tmp_path / "cornell.png") as picture:
        assert picture.size == (24, 20)


def test_demo_ends_with_its_time(tmp_path):
    began = time.perf_counter()
    done = shell("demo", "--seconds", 0.3, "-o", "a.npy", "--quiet", *SMALL, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert time.perf_counter() - began < 15
    assert np.load(tmp_path / "a.npy").shape == (12, 16, 3)


def test_render_frames_a_mesh_and_keeps_quiet_when_told(ball, tmp_path):
    done = shell(
        "render", ball, "-o", "ball.npy", "--samples", 4, "--quiet", "--up", "z", *SMALL, cwd=tmp_path
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert np.load(tmp_path / "ball.npy").shape == (12, 16, 3)


def test_render_repeats_itself_with_the_same_seed(ball, tmp_path):
    for name, seed, threads in (("a", 3, 1), ("b", 3, 2), ("c", 4, 1)):
        options = ["--samples", 4, "--seed", seed, "--threads", threads, "--quiet", *SMALL]
        assert shell("render", ball, "-o", f"{name}.npy", *options, cwd=tmp_path).returncode == 0
    a, b, c = (np.load(tmp_path / f"{name}.npy") for name in "abc")
    assert np.array_equal(a, b)
    assert not np.array_equal(a, c)


def test_pictures_for_the_eye_have_an_exposure_and_a_tone(ball, tmp_path):
    options = ["--samples", 4, "--quiet", *SMALL]
    for name, how in (("a.npy", []), ("a.webp", []), ("a.png", ["--exposure", -1.5, "--tone", "linear"])):
        assert shell("render", ball, "-o", name, *options, *how, cwd=tmp_path).returncode == 0
    with Pillow.open(tmp_path / "a.webp") as file:
        assert (file.format, file.size) == ("WEBP", (16, 12))
    with Pillow.open(tmp_path / "a.png") as file:
        light = np.load(tmp_path / "a.npy") * 2.0**-1.5
        assert np.array_equal(np.asarray(file), rw.io.shown.srgb(light, tone="linear"))
    assert (
        shell(
            "demo", "-o", "c.png", *options, "--background", "transparent", "--denoise", cwd=tmp_path
        ).returncode
        == 0
    )
    with Pillow.open(tmp_path / "c.png") as file:
        assert file.mode == "RGBA"
    done = shell("render", ball, "-o", "b.png", "--exposure", "1e9", cwd=tmp_path)
    assert done.returncode == 2
    assert "argument --exposure: must be a number between -100 and 100, got 1e9" in done.stderr


def test_info_tells_what_a_mesh_holds(ball, tmp_path):
    done = shell("info", ball, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    told = dict(re.findall(r"^  (\S+(?: \S+)?) {2,}(.*)$", done.stdout, re.MULTILINE))
    assert told["shapes"] == "1"
    assert told["vertices"] == "162"
    assert told["faces"] == "320"
    assert told["bounds"] == "(-1, -1, -1) to (1, 1, 1)"
    assert told["watertight"] == "yes"
    assert told["degenerate"] == "0 faces"
    assert "BVH" in told["accelerator"]
    assert re.fullmatch(r"\d+, and \d+ leaves; depth \d+", told["nodes"])
    assert re.fullmatch(r"[\d,]+ bytes, [\d.]+ a triangle", told["memory"])
    assert told["SIMD"] in ("scalar", "neon", "sse2", "avx2", "avx512")


def test_nan_vertices_are_one_line_of_warning(tmp_path):
    vertices = np.array([(np.nan, 0, 0), (0, 0, 0), (1, 0, 0), (0, 1, 0)])
    trimesh.Trimesh(vertices, [(0, 1, 2), (1, 2, 3)], process=False).export(tmp_path / "nan.ply")
    done = shell("info", "nan.ply", cwd=tmp_path)
    assert done.returncode == 0
    told = "raywright: warning: 1 of 2 faces were dropped: a corner is NaN or infinite\n"
    assert done.stderr == told


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["info", "gone.ply"], r"gone\.ply: no such file"),
        (["info", "noise.ply"], r"noise\.ply is not a mesh that can be read .*"),
        (["info", "noise.stl"], r"noise\.stl is not a mesh that can be read .*"),
        (["info", "text.stl"], r"text\.stl (holds no faces|is not a mesh that can be read .*)"),
        (["info", "."], r"\. is a folder, not a mesh file"),
        (["info", "file.foo"], r"file\.foo: suffix \.foo is not a mesh format; known are .*"),
        (["render", "gone.ply", "-o", "a.png"], r"gone\.ply: no such file"),
        (
            ["render", "ball.ply", "-o", "a.gif"],
            r"a picture is saved as \.png, .*\.npy; a\.gif is none of these",
        ),
        (["render", "gone.ply", "-o", "gone/a.png"], r"gone: no such folder"),
        (["demo", "-o", "folder.png"], r"folder\.png: is a folder"),
        (["demo", "-o", "ball.ply/a.png"], r"ball\.ply/a\.png: not a directory"),
    ],
)
def test_failures_are_one_line_and_status_1(ball, tmp_path, arguments, message):
    noise = np.random.default_rng(5).bytes(3000)
    for name in ("noise.ply", "noise.stl"):
        (tmp_path / name).write_bytes(noise)
    (tmp_path / "text.stl").write_text("hello world\n")
    (tmp_path / "file.foo").write_text("x")
    (tmp_path / "folder.png").mkdir()
    before = sorted(tmp_path.rglob("*"))
    done = shell(*arguments, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stdout == ""
    assert re.fullmatch(f"raywright: error: {message}\n", done.stderr)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "the following arguments are required: VERB"),
        (["fly"], ".*invalid choice: '?fly'?.*"),
        (["info"], "the following arguments are required: SCENE"),
        (["render", "ball.ply"], "the following arguments are required: -o/--output"),
        (
            ["render", "ball.ply", "-o", "a.png", "--samples", "0"],
            r"argument --samples: must be between .*, got 0",
        ),
        (
            ["render", "ball.ply", "-o", "a.png", "--samples", "x"],
            r"argument --samples: invalid whole number value: 'x'",
        ),
        (["render", "ball.ply", "-o", "a.png", "--up", "w"], r"argument --up: invalid choice: '?w'?.*"),
        (["demo", "--seconds", "-1"], r"argument --seconds: must be greater than 0, got -1"),
        (["demo", "--error", "nan"], r"argument --error: must be greater than 0, got nan"),
        (["demo", "--width", "0"], r"argument --width: must be between 1 and 65536, got 0"),
        (["demo", "--seed", "-1"], r"argument --seed: must be between 0 and .*, got -1"),
        (["demo", "--wings"], r"unrecognized arguments: --wings"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(tmp_path, arguments, message):
    done = shell(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stdout == ""
    assert re.fullmatch(rf"raywright: error: {message} \(see raywright.* --help\)\n", done.stderr)


@pytest.mark.parametrize(
    ("verb", "scene"),
    [
        (["render", "-o", "a.png"], "scene.xml"),
        (["view"], "scene.GLB"),
        (["report", "convergence"], "cornell"),
    ],
)
def test_up_is_refused_where_a_scene_knows_it(tmp_path, verb, scene):
    done = shell(*verb, scene, "--up", "z", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    told = f"argument --up: only allowed for mesh files, and {scene} defines its own up"
    use = rf"\(see raywright {verb[0]}.* --help\)"
    assert re.fullmatch(rf"raywright: error: {re.escape(told)} {use}\n", done.stderr)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "arguments", [["--help"], *([verb, "--help"] for verb in ("demo", "render", "view", "info"))]
)
def test_help_is_on_stdout(tmp_path, arguments):
    done = shell(*arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("usage: raywright")


def test_version(tmp_path):
    done = shell("--version", cwd=tmp_path)
    assert done.returncode == 0
    assert re.fullmatch(r"raywright \d+\.\d+\.\d+\S*\n", done.stdout)
    assert done.stdout == f"raywright {rw.__version__}\n"


def test_processes_do_the_same(tmp_path):
    installed = [os.path.join(os.path.dirname(sys.executable), "raywright")]
    module = [sys.executable, "-m", "raywright"]
    for command, arguments in (
        (installed, ["--version"]),
        (module, ["--version"]),
        (installed, ["info", "gone.ply"]),
        (module, ["info"]),
    ):
        done = subprocess.run(
            [*command, *arguments], capture_output=True, text=True, cwd=tmp_path, timeout=60
        )
        here = shell(*arguments, cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (here.returncode, here.stdout, here.stderr)
        assert (done.stdout + done.stderr).startswith("raywright")


def test_ctrl_c_ends_at_once_with_status_130(tmp_path):
    command = [sys.executable, "-m", "raywright", "demo", "--seconds", "60"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, cwd=tmp_path) as process:
        # The first words of the bar show that the render has begun.
        assert process.stderr.read(8) == b"\rrender:"
        time.sleep(0.2)
        began = time.perf_counter()
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=30)
    # Uninterrupted, it renders for a minute.
    assert time.perf_counter() - began < 15
    assert process.returncode == 130
    assert out == b""
    assert err.decode().splitlines()[-1] == "raywright: interrupted"
    assert "Traceback" not in err.decode()
    assert not (tmp_path / "cornell.png").exists()
