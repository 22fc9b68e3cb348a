"""The page of benchmarks is what its figures say, and its script counts wrong answers rightly."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import raywright as rw

ROOT = Path(__file__).parents[3]
BENCHES = ROOT / "benches"

if not (BENCHES / "benchmarks_page.py").exists():
    pytest.skip("only the repository has the script", allow_module_level=True)
pytest.importorskip("trimesh")
sys.path.append(str(BENCHES))
import benchmarks_page  # noqa: E402
import points  # noqa: E402
import stress  # noqa: E402
from page_sections import SECTIONS, TINY, Sizes  # noqa: E402
from page_text import page  # noqa: E402
from peers_engines import Raywright  # noqa: E402


def test_the_page_shows_the_figures_beside_it():
    text = (ROOT / "docs" / "benchmarks.md").read_text(encoding="utf-8")
    found = benchmarks_page.read(ROOT / "docs")
    assert text == page(found)
    for name in SECTIONS:
        assert (f"--section {name}" in text) == (name not in found)
    for name in {"rays", "pictures"} & found.keys():
        assert (ROOT / "docs" / "benchmarks" / f"{name}.svg").stat().st_size < 150_000


def test_every_case_of_stress_is_float32_and_raywright_answers_it_exactly():
    records = stress.measured([Raywright()], 300)
    assert len({r["case"] for r in records}) == len(records) == 8
    assert all(r["wrong_hit_or_miss"] == r["another_surface"] == 0 for r in records)
    for case in stress.cases(10):
        assert case.vertices.dtype == case.rays.origins.dtype == case.rays.directions.dtype == np.float32


def test_wrong_answers_are_counted():
    """Of eight rays: a leak, an invented hit, another surface, and five right answers, one rounded."""
    case = next(stress.cases(8))
    exact = np.array([1.0, np.inf, 1.0, 1.0, 2.0, np.inf, np.inf, 0.5])
    told = np.array([np.inf, 1.0, 9.0, 1.00001, 2.0, np.inf, np.inf, 0.5])
    case = case._replace(rays=case.rays._replace(directions=np.ones((8, 3), np.float32)))
    assert stress.wrong(case, told, exact) == (2 / 8 * 1e6, 1 / 8 * 1e6)


def test_nothing_leaves_a_closed_mesh():
    (case,) = (case for case in stress.cases(200) if case.name == "leaks of a closed mesh")
    assert np.isfinite(stress.truth(case)).all()


def test_signed_points_have_either_sign(monkeypatch):
    monkeypatch.setattr(points, "installed", lambda: [points.Raywright()])
    from peers_meshes import MADE

    subject = MADE["torus"](500, np.random.default_rng(0))
    some = points.some_points(subject.vertices, subject.faces, 2000, np.random.default_rng(1))
    distance = rw.Scene(rw.Mesh(subject.vertices, subject.faces)).signed_distance(some)
    assert 0.1 < np.mean(distance < 0) < 0.9
    records = points.measured(subject, 100, 1)
    assert [(r["query"], r["greatest_difference"]) for r in records] == [
        ("closest", 0),
        ("signed", 0),
        ("inside", 0),
    ]


def test_a_section_is_kept_and_resumed(tmp_path, monkeypatch, capsys):
    calls = []
    monkeypatch.setattr(benchmarks_page, "SECTIONS", dict.fromkeys(SECTIONS))

    def timed(name, sizes):
        calls.append((name, sizes.ray_side))
        return [], 1.0

    monkeypatch.setattr(benchmarks_page, "timed", timed)
    # Sections without records have no tables.
    monkeypatch.setattr(benchmarks_page, "write", lambda out: None)
    command = ["benchmarks_page.py", "--out", str(tmp_path)]
    monkeypatch.setattr(sys, "argv", [*command, "--tiny", "--section", "wrong"])
    benchmarks_page.main()
    assert calls == [("wrong", TINY.ray_side)]
    kept = json.loads((tmp_path / "benchmarks" / "wrong.json").read_text())
    assert kept["records"] == []
    assert kept["machine"]["raywright"] == rw.__version__
    monkeypatch.setattr(sys, "argv", [*command, "--resume"])
    benchmarks_page.main()
    assert calls[1:] == [(name, Sizes().ray_side) for name in SECTIONS if name != "wrong"]
    monkeypatch.setattr(sys, "argv", ["benchmarks_page.py", "--tiny"])
    with pytest.raises(SystemExit):
        benchmarks_page.main()
    assert "--tiny wants --out" in capsys.readouterr().err
