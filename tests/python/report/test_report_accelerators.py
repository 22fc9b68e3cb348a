"""The report on accelerators: what is in it, and that it would tell if one were wrong."""

import csv
import dataclasses
import io
import statistics
from typing import Literal

import numpy as np
import pytest

import raywright as rw
from raywright import accelerators as kinds
from raywright.report import contest
from raywright.report.per_build import rays_per_build_of

KNOT = rw.scenes.torus_knot(along=40, around=8)
SCENE = rw.Scene(KNOT)
CAMERA = rw.Camera((0, 0, 5), (0, 0, 0), width=24, height=16)


@pytest.fixture(scope="module")
def report():
    return rw.report.accelerators(SCENE, CAMERA, repeats=2)


def row(report, name):
    (found,) = report.where(accelerator=name).rows
    return dict(zip([column.name for column in report.columns], found, strict=True))


def test_every_accelerator_has_a_row_and_none_is_wrong(report):
    assert report.column("accelerator") == tuple(kinds.every())
    assert len(report.rows) >= 2
    assert set(report.column("wrong")) == {0}
    # Few enough for brute force to check all of them.
    hit = SCENE.intersect(*CAMERA.rays()).hit.sum()
    assert set(report.column("checked")) == {24 * 16 + 2 * hit}


def test_what_is_told_of_a_structure_is_what_it_tells_itself(report):
    for one in report.measured:
        info = rw.Scene(KNOT, accelerator=one.accelerator).accelerator_info
        told = row(report, one.name)
        assert (told["bytes"], told["nodes"], told["depth"]) == (info.bytes, info.nodes, info.depth)
        assert told["sah_cost"] == (info.sah_cost if np.isfinite(info.sah_cost) else None)
        assert told["kind"] == type(one.accelerator).__name__
        assert told["build_seconds"] == one.build_seconds > 0


def test_brute_force_visits_no_node_and_tests_every_face(report):
    told = row(report, "BruteForce")
    assert (told["nodes_per_ray"], told["tests_per_ray"], told["depth"]) == (0, len(KNOT.faces), 0)


def test_counts_are_means_over_all_rays(report):
    costs = [
        SCENE.traversal_cost(rays.origins, rays.directions, t_max=rays.t_max)
        for rays in rw.report.typical_rays(SCENE, CAMERA).values()
    ]
    told = row(report, kinds.name_of(rw.BVH()))
    nodes, primitives = (
        np.concatenate([getattr(cost, name).reshape(-1) for cost in costs])
        for name in ("nodes", "primitives")
    )
    assert told["nodes_per_ray"] == pytest.approx(nodes.mean())
    assert told["tests_per_ray"] == pytest.approx(primitives.mean())


def test_rays_a_second_are_those_of_the_medians(report):
    for one in report.measured:
        told = row(report, one.name)
        for name in ("primary", "diffuse", "shadow"):
            assert told[name] == pytest.approx(1e-6 / one.seconds_per_ray[name])
            assert one.seconds_per_ray[name] > 0


def test_set_by_set_the_same_numbers_stand(report):
    split = report.by_rays()
    assert list(dict.fromkeys(split.column("rays"))) == ["primary", "diffuse", "shadow"]
    for one in report.measured:
        mine = split.where(accelerator=one.name)
        assert sum(mine.column("checked")) == row(report, one.name)["checked"]
        assert mine.column("mrays") == tuple(row(report, one.name)[name] for name in mine.column("rays"))


def test_a_wrong_answer_is_counted(monkeypatch):
    right = contest._answer

    def wrong(scene, rays, threads):
        answer = right(scene, rays, threads)
        if isinstance(scene.accelerator, rw.BruteForce):
            return answer
        changed = answer[-1].copy().reshape(-1)
        changed[:3] = ~changed[:3]
        return *answer[:-1], changed.reshape(answer[-1].shape)

    monkeypatch.setattr(contest, "_answer", wrong)
    report = rw.report.accelerators(SCENE, CAMERA, [rw.BVH(), rw.BruteForce()], repeats=1)
    assert report.column("wrong") == (9, 0)


def test_any_rays_by_any_name():
    rng = np.random.default_rng(3)
    pair = rng.normal(size=(2, 200, 3))
    one = rw.report.accelerators(SCENE, tuple(pair), rw.BVH(bins=8), repeats=1)
    assert one.column("accelerator") == ("BVH binned bins=8",)
    assert one.columns[-3].name == "rays"
    sets = {"near": rw.report.Rays(*pair, t_max=0.5, any_hit=True), "far": tuple(pair)}
    two = rw.report.accelerators(SCENE, sets, {"mine": rw.BVH()}, threads=None, repeats=1, check=20)
    assert [column.name for column in two.columns[-4:]] == ["near", "far", "checked", "wrong"]
    assert row(two, "mine")["checked"] == 20
    assert two.measured[0].rays == {"near": 200, "far": 200}


def test_slow_accelerators_get_fewer_rays_and_a_note_tells(monkeypatch):
    monkeypatch.setattr(contest, "_LONGEST_SECONDS", 1e-9)
    report = rw.report.accelerators(SCENE, CAMERA, [rw.BVH()], repeats=1)
    assert set(report.measured[0].rays.values()) == {1}
    assert report.notes[-1] == "Timed on fewer rays: BVH binned (1 primary, 1 diffuse, 1 shadow)."


def test_as_csv_markdown_and_text(report):
    read = list(csv.DictReader(io.StringIO(report.csv())))
    assert [line["accelerator"] for line in read] == list(kinds.every())
    assert float(read[0]["primary"]) == report.rows[0][9]
    assert report.markdown().count("\n") == len(report.rows) + 1
    assert str(report).startswith("Accelerators over 640 primitives\n")


def test_plots(report):
    pytest.importorskip("matplotlib").use("Agg")
    for table in (report, report.by_rays(), report.rays_per_build(), report.rays_per_build().best()):
        ax = table.plot()
        assert {text.get_text() for text in ax.get_legend().get_texts()} >= set(table.column("accelerator"))
        ax.figure.clear()


# Names.


def test_names_tell_what_differs():
    assert kinds.name_of(rw.BVH()) == "BVH binned"
    assert kinds.name_of(rw.BVH(bins=8, traversal_cost=2)) == "BVH binned bins=8 traversal_cost=2.0"
    assert kinds.name_of(rw.BruteForce()) == "BruteForce"


def test_every_choice_among_words_is_varied_alone(monkeypatch):
    @dataclasses.dataclass(frozen=True)
    class Tree:
        builder: Literal["a", "b"] = "a"
        walk: Literal["x", "y"] = "x"
        improve: Literal["i", "j"] | tuple[Literal["i", "j"], ...] | None = None
        depth: int | None = None

        def __post_init__(self):
            if isinstance(self.improve, str):
                object.__setattr__(self, "improve", (self.improve,))

    monkeypatch.setattr(kinds.choices, "Accelerator", Tree | rw.BruteForce)
    assert kinds.every() == {
        "Tree a": Tree(),
        "Tree b": Tree("b"),
        "Tree a walk=y": Tree(walk="y"),
        "Tree a improve=i": Tree(improve="i"),
        "Tree a improve=j": Tree(improve="j"),
        "BruteForce": rw.BruteForce(),
    }
    assert kinds.name_of(Tree(improve=("j", "i"))) == "Tree a improve=j+i"
    assert kinds.name_of(Tree(improve=())) == "Tree a improve=none"


# Rays per build.


def test_a_build_pays_from_the_count_on_that_it_must():
    # 1 s and 3 ms a ray, or nothing and 5 ms: the same after 500 rays.
    table = rays_per_build_of([("tree", 1.0, 0.003), ("none", 0.0, 0.005)], [499, 501, 10])
    assert table.best().column("accelerator") == ("none", "none", "tree")
    assert table.column("rays") == (10, 10, 499, 499, 501, 501)
    last = table.rows[-2]
    assert last.seconds == pytest.approx(1 + 501 * 0.003)
    assert last.mrays == pytest.approx(501e-6 / last.seconds)
    assert last.build_share == pytest.approx(1 / last.seconds)
    assert table.best().rows[-1][-2:] == ("none", pytest.approx(501 * 0.005 / last.seconds))


def test_rays_per_build_are_reckoned_from_the_report(report):
    table = report.rays_per_build([1e4, 1e9])
    for one in report.measured:
        each = statistics.mean(one.seconds_per_ray.values())
        seconds = [r.seconds for r in table.where(accelerator=one.name).rows]
        assert seconds == pytest.approx([one.build_seconds + 1e4 * each, one.build_seconds + 1e9 * each])
    alone = rw.report.rays_per_build(SCENE, rw.BVH(), counts=[100], rays=CAMERA, repeats=1)
    assert alone.best().rows[0][-2:] == (None, None)


@pytest.mark.parametrize(
    ("error", "arguments", "message"),
    [
        (TypeError, {"scene": KNOT}, "scene must be a Scene, got Mesh"),
        (ValueError, {"repeats": 0}, "repeats must be between 1 and 10000, got 0"),
        (ValueError, {"threads": 0}, "threads must be at least 1, got 0"),
        (ValueError, {"check": 0}, "check must be at least 1, got 0"),
        (ValueError, {"accelerators": []}, "accelerators must not be empty"),
        (ValueError, {"accelerators": [rw.BVH(), rw.BVH()]}, "must differ, got BVH binned twice"),
        (TypeError, {"accelerators": "BVH"}, "accelerators must be a list or a dict, got str"),
        (TypeError, {"accelerators": [rw.BVH]}, "must be raywright accelerators, got type"),
        (TypeError, {"rays": 5}, r"rays must be a Camera, Rays, or \(origins, directions\), got int"),
        (TypeError, {"rays": {"a": 5}}, r"rays\['a'\] must be a Camera, Rays"),
        (ValueError, {"rays": {}}, "rays must not be empty"),
        (ValueError, {"rays": (np.empty((0, 3)), (0, 0, 1))}, "rays must not be empty"),
        (ValueError, {"rays": rw.Camera((0, 0, 5), (0, 0, 9), width=8, height=8)}, "no primary ray hits"),
        (ValueError, {"scene": rw.Scene([])}, "the scene is empty, so no rays can be aimed at it"),
    ],
)
def test_bad_arguments_are_refused(error, arguments, message):
    given = {"scene": SCENE, "rays": None if "scene" in arguments else CAMERA} | arguments
    with pytest.raises(error, match=message):
        rw.report.accelerators(**given)


@pytest.mark.parametrize("counts", [[], [0], [1.5], [np.nan], [np.inf], 7])
def test_bad_counts_are_refused_before_anything_is_measured(counts):
    with pytest.raises(ValueError, match=r"counts must be (a list of numbers|whole and at least 1), got"):
        rw.report.rays_per_build(SCENE, counts=counts)
