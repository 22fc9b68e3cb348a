"""``raywright report``, as a shell sees it."""

import csv
import io
import re

import pytest
import trimesh
from command_line import run_command
from PIL import Image as Pillow

from raywright.accelerators import every

QUICK = ["--rays", "100", "--repeats", "1"]


def shell(*arguments, cwd):
    return run_command("report", "accelerators", *arguments, cwd=cwd)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("report")
    trimesh.creation.icosphere(subdivisions=2).export(path / "ball.ply")
    return path


def test_every_accelerator_is_in_the_table(folder):
    done = shell("ball.ply", *QUICK, cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    lines = done.stdout.splitlines()
    assert lines[0] == "Accelerators over 320 primitives"
    assert "of 100, " in done.stdout
    for name in every():
        assert sum(line.startswith(f"{name} ") and line.endswith(" 0") for line in lines) >= 1


def test_csv_has_all_of_it(folder):
    done = shell("ball.ply", *QUICK, "--csv", "--accelerators", "bruteforce, BVH Binned", cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    assert [row["accelerator"] for row in rows] == ["BruteForce", "BVH binned"]
    assert [row["wrong"] for row in rows] == ["0", "0"]
    assert float(rows[0]["tests_per_ray"]) == 320


def test_markdown_is_a_table(folder):
    done = shell("ball.ply", *QUICK, "--markdown", "--accelerators", "bruteforce", cwd=folder)
    assert done.returncode == 0
    lines = done.stdout.splitlines()
    assert len(lines) == 3
    assert all(line.startswith("| ") and line.endswith(" |") for line in lines)


def test_plot_is_saved(folder):
    pytest.importorskip("matplotlib")
    done = shell("ball.ply", *QUICK, "--accelerators", "bruteforce", "--plot", "plot.png", cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    with Pillow.open(folder / "plot.png") as picture:
        assert min(picture.size) > 300


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["gone.ply"], r"gone\.ply: no such file"),
        (["ball.ply", "--plot", "a.svg"], r"a plot is saved as \.png; a\.svg is none of these"),
        (["ball.ply", "--plot", "gone/a.png"], "gone: no such folder"),
    ],
)
def test_failures_are_one_line_and_status_1(folder, arguments, message):
    done = shell(*arguments, cwd=folder)
    assert (done.returncode, done.stdout) == (1, "")
    assert re.fullmatch(f"raywright: error: {message}\n", done.stderr)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "the following arguments are required: MESH"),
        (["ball.ply", "--accelerators", "oak"], r"argument --accelerators: 'oak' is not one of: BVH .*"),
        (["ball.ply", "--rays", "0"], "argument --rays: must be between 1 and .*, got 0"),
        (["ball.ply", "--csv", "--markdown"], "argument --markdown: not allowed with argument --csv"),
    ],
)
def test_wrong_use_is_one_line_and_status_2(folder, arguments, message):
    done = shell(*arguments, cwd=folder)
    assert (done.returncode, done.stdout) == (2, "")
    assert re.fullmatch(rf"raywright: error: {message} \(see raywright.* --help\)\n", done.stderr)


def test_a_report_has_a_name(folder):
    done = run_command("report", cwd=folder)
    told = "raywright: error: the following arguments are required: REPORT (see raywright report --help)\n"
    assert (done.returncode, done.stderr) == (2, told)
