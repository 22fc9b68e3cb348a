"""The report on triangle routines: who is wrong where; and its oracle and pairs are what they say."""

import csv
import dataclasses
import io
import pickle
import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest

import raywright as rw
from raywright._core import KernelContest
from raywright.report.exact import exact_hits
from raywright.report.pairs import FAMILIES, family

MOLLER, STORED, BADOUEL, VOLUMES, WOOP, EDGE_F32, EDGE_F64 = (
    "Möller, Trumbore 1997",
    "the same, edges stored",
    "Badouel 1990",
    "signed volumes",
    "Woop, Benthin, Wald 2013",
    "edge form, f32",
    "edge form, f64, exact",
)
ROUTINES = [MOLLER, STORED, BADOUEL, VOLUMES, WOOP, EDGE_F32, EDGE_F64]
SINGLE = ROUTINES[:-1]


@pytest.fixture(scope="module")
def report():
    return rw.report.kernels(pairs=3000, repeats=3)


def row(report, routine, name):
    (found,) = report.where(routine=routine, family=name).rows
    return found


# The routines.


def test_every_routine_is_tried_on_every_family(report):
    assert [(r.family, r.routine) for r in report.rows] == [(f, r) for f in FAMILIES for r in ROUTINES]


@pytest.mark.parametrize("routine", ROUTINES)
def test_on_ordinary_pairs_every_routine_decides_rightly(report, routine):
    found = row(report, routine, "ordinary")
    assert found.hits == 1500
    assert found.wrong == 0
    assert found.median_ulps < 2
    assert found.max_ulps < 100


@pytest.mark.parametrize("name", FAMILIES)
def test_the_exact_routine_never_decides_wrongly(report, name):
    found = row(report, EDGE_F64, name)
    assert (found.missed, found.false_hits) == (0, 0)
    # f64 has 29 more bits; its bound allows an error of an ulp of f32 at most.
    assert found.median_ulps < 1e-6
    assert found.max_ulps < 1


@pytest.mark.parametrize("routine", SINGLE)
@pytest.mark.parametrize("name", ["slivers", "grazing", "far origins", "edges, vertices"])
def test_every_routine_in_single_precision_errs_at_the_extremes_in_both_ways(report, routine, name):
    found = row(report, routine, name)
    assert found.missed > 0
    assert found.false_hits > 0


@pytest.mark.parametrize("routine", SINGLE)
def test_products_in_single_precision_underflow_and_overflow(report, routine):
    assert row(report, routine, "huge and tiny").missed > 0


def test_signed_volumes_lose_most_to_cancellation_far_from_the_origin(report):
    wrong = {r: row(report, r, "far origins").wrong for r in SINGLE}
    assert wrong[VOLUMES] > 2 * max(w for r, w in wrong.items() if r != VOLUMES)
    assert row(report, VOLUMES, "far origins").median_ulps > 1e4
    assert row(report, EDGE_F32, "far origins").median_ulps < 2


def test_the_plane_of_a_grazed_triangle_is_lost_in_single_precision(report):
    for routine in SINGLE:
        assert row(report, routine, "grazing").median_ulps > 100


def test_storing_edges_changes_time_only(report):
    for name in FAMILIES:
        once, again = row(report, MOLLER, name), row(report, STORED, name)
        assert once[4:] == again[4:]


def test_a_scale_that_is_a_power_of_two_changes_no_decision_and_no_bit():
    pairs = family("ordinary", 500, seed=3)
    flat = pairs.corners.reshape(-1, 9)
    once = KernelContest(pairs.origins, pairs.directions, flat)
    scaled = KernelContest(pairs.origins * np.float32(1024), pairs.directions, flat * np.float32(1024))
    for i in range(len(ROUTINES)):
        (t, uv), (scaled_t, scaled_uv) = once.answers(i), scaled.answers(i)
        assert np.array_equal(t * 1024, scaled_t)
        assert np.array_equal(uv, scaled_uv)


def test_weights_are_those_of_the_point_that_is_hit():
    pairs = family("ordinary", 500, seed=4)
    contest = KernelContest(pairs.origins, pairs.directions, pairs.corners.reshape(-1, 9))
    a, b, c = np.moveaxis(pairs.corners.astype(np.float64), 1, 0)
    for i in range(len(ROUTINES)):
        t, uv = contest.answers(i)
        hit = np.isfinite(t)
        assert hit.sum() == 250
        along = (pairs.origins + t[:, None] * pairs.directions)[hit]
        inside = (a + uv[:, :1] * (b - a) + uv[:, 1:] * (c - a))[hit]
        assert np.abs(along - inside).max() < 1e-4


@pytest.mark.parametrize("name", FAMILIES)
def test_the_exact_routine_does_not_mind_how_a_triangle_is_walked(name):
    pairs = family(name, 300, seed=5)
    walks = [[0, 1, 2], [1, 2, 0], [2, 1, 0]]
    hits = [
        np.isfinite(
            KernelContest(
                pairs.origins, pairs.directions, np.ascontiguousarray(pairs.corners[:, walk].reshape(-1, 9))
            ).answers(ROUTINES.index(EDGE_F64))[0]
        )
        for walk in walks
    ]
    assert np.array_equal(hits[0], hits[1])
    assert np.array_equal(hits[0], hits[2])


# The oracle.


def by_fractions(origin, direction, corners):
    """Cramer's rule in fractions: t, or None."""
    o, d, a, b, c = ([Fraction(float(x)) for x in v] for v in (origin, direction, *corners))

    def determinant(p, q, r):
        return (
            p[0] * (q[1] * r[2] - q[2] * r[1])
            - p[1] * (q[0] * r[2] - q[2] * r[0])
            + p[2] * (q[0] * r[1] - q[1] * r[0])
        )

    def minus(p, q):
        return [x - y for x, y in zip(p, q, strict=True)]

    s, ab, ac = minus(o, a), minus(b, a), minus(c, a)
    back = [-x for x in d]
    whole = determinant(back, ab, ac)
    if whole == 0:
        return None
    t, u, v = (determinant(*m) / whole for m in ((s, ab, ac), (back, s, ac), (back, ab, s)))
    return t if t >= 0 and u >= 0 and v >= 0 and u + v <= 1 else None


@pytest.mark.parametrize("name", FAMILIES)
def test_the_oracle_says_what_fractions_say(name):
    pairs = family(name, 200, seed=1)
    exact = exact_hits(pairs.origins, pairs.directions, pairs.corners)
    wanted = [
        by_fractions(*pair) for pair in zip(pairs.origins, pairs.directions, pairs.corners, strict=True)
    ]
    assert exact.hit.tolist() == [t is not None for t in wanted]
    assert exact.hit.any()
    assert not exact.hit.all()
    for i in np.flatnonzero(exact.hit):
        assert Fraction(exact.numerator[i], exact.denominator[i]) == wanted[i]
        assert exact.t[i] == float(wanted[i])


def test_the_oracle_takes_borders_for_hits_and_what_has_no_area_for_none():
    triangle = [(0, 0, 0), (4, 0, 0), (0, 4, 0)]
    targets = [(0, 0, 0), (2, 0, 0), (1, 1, 0), (2, 2, 0), (2.5, 2, 0), (-1, 0, 0)]
    origins = np.array([(1, 2, 8)] * len(targets), np.float32)
    corners = np.array([triangle] * len(targets), np.float32)
    directions = np.array(targets, np.float32) - origins
    assert exact_hits(origins, directions, corners).hit.tolist() == [True] * 4 + [False] * 2
    assert not exact_hits(origins, -directions, corners).hit.any()
    corners[:, 2] = (8, 0, 0)
    assert not exact_hits(origins, directions, corners).hit.any()


def test_ulps_are_those_of_float32():
    # At z = 3, from 0: t is 3 in lengths of 1, where an ulp of float32 is 2^-22, and 3/2 in lengths of 2,
    # where it is 2^-23.
    corners = np.array([[(-1, -1, 3), (5, -1, 3), (-1, 5, 3)]] * 4, np.float32)
    directions = np.array([(0, 0, 1), (0, 0, 1), (0, 0, 2), (0, 0, -1)], np.float32)
    exact = exact_hits(np.zeros((4, 3), np.float32), directions, corners)
    assert exact.t.tolist() == [3, 3, 1.5, np.inf]
    found = np.array([3, 3 + 2.0**-22, 1.5 - 2.0**-24, 7])
    assert exact.ulps(found).tolist() == [0, 1, 0.5]
    assert exact.ulps(np.full(4, np.inf)).tolist() == []


# The pairs.


@pytest.mark.parametrize("name", FAMILIES)
@pytest.mark.parametrize("count", [1, 7, 1000])
def test_half_of_the_pairs_hit(name, count):
    pairs = family(name, count, seed=2)
    assert len(pairs) == count
    assert exact_hits(pairs.origins, pairs.directions, pairs.corners).hit.sum() == (count + 1) // 2
    for array in (pairs.origins, pairs.directions, pairs.corners):
        assert array.dtype == np.float32
        assert np.isfinite(array).all()


def sides(corners):
    return np.sort(np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2), axis=1)


def test_families_are_as_extreme_as_they_are_said_to_be():
    def drawn(name):
        pairs = family(name, 2000, seed=6)
        return (x.astype(np.float64) for x in (pairs.origins, pairs.directions, pairs.corners))

    _, _, corners = drawn("slivers")
    aspect = sides(corners)[:, 2] / sides(corners)[:, 0]
    assert aspect.min() < 3e3
    assert aspect.max() > 3e7
    _, directions, corners = drawn("grazing")
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    sine = np.abs((normal * directions).sum(axis=1)) / np.linalg.norm(normal, axis=1)
    assert sine.min() < 1e-6
    assert 3e-4 < sine.max() < 2e-3
    origins, _, corners = drawn("far origins")
    away = np.linalg.norm(origins, axis=1) / sides(corners)[:, 2]
    assert away.min() < 3e3
    assert away.max() > 1e7
    _, _, corners = drawn("huge and tiny")
    assert sides(corners).min() < 1e-17
    assert sides(corners).max() > 1e17


# The report.


def test_the_same_seed_gives_the_same_errors():
    def errors(seed):
        return [(*r[:2], *r[3:]) for r in rw.report.kernels(pairs=200, seed=seed, repeats=1).rows]

    assert errors(1) == errors(1)
    assert errors(1) != errors(2)


def test_times_are_those_of_a_few_hundred_operations(report):
    assert all(0.1 < ns < 1e6 for ns in report.column("ns"))


def test_a_single_pair_is_enough():
    rows = rw.report.kernels(pairs=1, repeats=1).rows
    assert {r.hits for r in rows} == {1}
    # Missed rays have no error.
    assert all((r.max_ulps is None) == (r.missed == 1) for r in rows)


def test_the_summary_has_a_row_for_each_routine(report):
    summary = report.summary()
    assert summary.column("routine") == tuple(ROUTINES)
    for line in summary.rows:
        named = dict(zip((c.name for c in summary.columns), line, strict=True))
        assert named["ns"] == row(report, named["routine"], "ordinary").ns
        for name in FAMILIES:
            assert named[name] == row(report, named["routine"], name).wrong


def test_a_report_pickles_compares_and_is_frozen(report):
    assert pickle.loads(pickle.dumps(report)) == report
    assert hash(report) == hash(pickle.loads(pickle.dumps(report)))
    assert "\n" not in repr(report)
    assert repr(report).startswith("KernelReport(42 rows of family, routine, ns")
    with pytest.raises(dataclasses.FrozenInstanceError):
        report.rows = ()


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"pairs": 0}, ValueError, r"pairs must be between 1 and 100000, got 0"),
        ({"pairs": 100_001}, ValueError, r"pairs must be between 1 and 100000, got 100001"),
        ({"pairs": 10.0}, TypeError, r"pairs must be an integer, got 10.0"),
        ({"pairs": True}, TypeError, r"pairs must be an integer, got True"),
        ({"seed": -1}, ValueError, r"seed must be between 0 and \d+, got -1"),
        ({"seed": None}, TypeError, r"seed must be an integer, got None"),
        ({"repeats": 0}, ValueError, r"repeats must be between 1 and 10000, got 0"),
        ({"repeats": "3"}, TypeError, r"repeats must be an integer, got '3'"),
    ],
)
def test_bad_arguments_are_named(given, error, message):
    with pytest.raises(error, match=f"^{message}$"):
        rw.report.kernels(**given)


def test_the_core_refuses_arrays_that_do_not_belong_together():
    good = np.zeros((2, 3), np.float32)
    with pytest.raises(ValueError, match=r"corners has shape \[2, 8\], expected C-contiguous \(N, 9\)"):
        KernelContest(good, good, np.zeros((2, 8), np.float32))
    with pytest.raises(ValueError, match=r"have lengths \[2, 2, 3\]"):
        KernelContest(good, good, np.zeros((3, 9), np.float32))
    with pytest.raises(IndexError, match="routine is 7, expected less than 7"):
        KernelContest(good, good, np.zeros((2, 9), np.float32)).answers(7)


def test_reports_are_imported_when_they_are_asked_for_and_matplotlib_when_something_is_plotted():
    code = (
        "import sys, raywright as rw; print('raywright.report' in sys.modules);"
        "rw.report.kernels(pairs=10, repeats=1); print('matplotlib' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
    with pytest.raises(AttributeError, match="module 'raywright' has no attribute 'repart'"):
        _ = rw.repart


# The table.


@pytest.fixture
def table():
    columns = (
        rw.report.Column("kind", "kind"),
        rw.report.Column("name", "name"),
        rw.report.Column("n", "count", ",d"),
        rw.report.Column("error", "error", ".2g"),
    )
    rows = [("a", "x|y", 1234567, 0.0), ("a", "z", 3, None), ("b", "x|y", 40, 1.5)]
    return rw.report.Table("Of things", columns, rows, ["A note."], rw.report.Chart("n", "error", "name"))


def test_a_table_prints_text_left_and_numbers_right_with_groups_apart(table):
    assert str(table).splitlines() == [
        "Of things",
        "",
        "kind  name      count  error",
        "----  ----  ---------  -----",
        "a     x|y   1,234,567      0",
        "a     z             3      -",
        "",
        "b     x|y          40    1.5",
        "",
        "A note.",
    ]


def test_a_table_as_markdown(table):
    assert table.markdown().splitlines() == [
        "| kind | name |     count | error |",
        "| ---- | ---- | --------: | ----: |",
        "| a    | x\\|y | 1,234,567 |     0 |",
        "| a    | z    |         3 |     - |",
        "| b    | x\\|y |        40 |   1.5 |",
    ]
    assert table._repr_markdown_() == f"**Of things**\n\n{table.markdown()}\n\nA note."


def test_a_table_without_rows_prints_its_headings(table):
    empty = table.where(kind="c")
    assert empty.rows == ()
    assert "kind  name  count  error" in str(empty)
    assert empty.markdown().count("\n") == 1


def test_csv_keeps_every_digit(report, table):
    assert table.csv() == "kind,name,n,error\na,x|y,1234567,0.0\na,z,3,\nb,x|y,40,1.5\n"
    back = list(csv.DictReader(io.StringIO(report.csv())))
    assert len(back) == len(report.rows)
    for line, wanted in zip(back, report.rows, strict=True):
        assert line["routine"] == wanted.routine
        assert float(line["ns"]) == wanted.ns
        assert float(line["max_ulps"]) == wanted.max_ulps


def test_columns_and_rows_are_found_by_name(table):
    assert table.column("n") == (1234567, 3, 40)
    assert table.where(kind="a", name="z").rows == (("a", "z", 3, None),)
    for ask in (lambda: table.column("size"), lambda: table.where(size=1), lambda: table.plot(x="size")):
        with pytest.raises(ValueError, match=r"^no column is named 'size'; there are kind, name, n, error$"):
            ask()


def test_rows_must_fit_the_columns(table):
    with pytest.raises(ValueError, match=r"^row 1 has 1 entries, but there are 4 columns$"):
        dataclasses.replace(table, rows=[("a", "b", 1, 2.0), ("a",)])


def test_a_plot_shows_each_row_on_logarithmic_axes(report, table):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    ax = report.plot()
    assert (ax.get_xscale(), ax.get_yscale()) == ("log", "log")
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("ns/test", "max ulps")
    drawn = {(float(x), float(y)) for line in ax.lines for x, y in line.get_xydata()}
    assert drawn == {(r.ns, r.max_ulps) for r in report.rows}
    assert [text.get_text() for text in ax.get_legend().get_texts()] == [*ROUTINES, *FAMILIES]
    plt.close(ax.figure)

    # Zero has no logarithm and is drawn below the rest; a row without a number is left out.
    _, mine = plt.subplots()
    ax = table.plot(mine)
    assert ax is mine
    assert {(float(x), float(y)) for line in ax.lines for x, y in line.get_xydata()} == {
        (1234567, 0.75),
        (40, 1.5),
    }
    plt.close(mine.figure)


@pytest.mark.parametrize(
    ("name", "begins"),
    [("a.png", b"\x89PNG"), ("a.svg", b"<?xml"), ("a.pdf", b"%PDF"), ("a.PNG", b"\x89PNG")],
)
def test_a_plot_may_go_to_a_file(table, tmp_path, name, begins):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    before = plt.get_fignums()
    for where in (tmp_path / name, str(tmp_path / name)):
        ax = table.plot(where)
        assert isinstance(ax, matplotlib.axes.Axes)
        assert (tmp_path / name).read_bytes().startswith(begins)
        (tmp_path / name).unlink()
    # It needs no closing: pyplot does not know of it.
    assert plt.get_fignums() == before


@pytest.mark.parametrize(
    ("where", "error", "message"),
    [
        ("plot.jpg", ValueError, "a plot is saved as .png, .svg, .pdf; plot.jpg is none of these"),
        ("plot", ValueError, "a plot is saved as .png, .svg, .pdf; plot is none of these"),
        ("gone/plot.png", FileNotFoundError, "no such folder"),
        (3, TypeError, "ax must be matplotlib axes or a path, got int"),
        ([1], TypeError, "ax must be matplotlib axes or a path, got list"),
    ],
)
def test_a_plot_goes_nowhere_else(table, tmp_path, monkeypatch, where, error, message):
    pytest.importorskip("matplotlib")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(error, match=re.escape(message)) as caught:
        table.plot(where)
    assert "\n" not in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_a_plot_needs_a_chart_and_matplotlib(table, monkeypatch):
    with pytest.raises(ValueError, match=r"^this table has no chart$"):
        dataclasses.replace(table, chart=None).plot()
    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(ImportError, match=r"pip install 'raywright\[plot\]'"):
        table.plot()
