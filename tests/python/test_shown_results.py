"""Results as tables: in notebooks as HTML, for pandas, and what is logged meanwhile."""

import logging
from html.parser import HTMLParser

import numpy as np
import pytest

import raywright as rw
from raywright.report.table import Column, Table

CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
CUBE = rw.Mesh(CORNERS, [face for a, b, c, d in SIDES for face in ((a, b, c), (a, c, d))], name="<cube>")


class Cells(HTMLParser):
    """The texts of a table, row by row; raises where an element is not closed."""

    def __init__(self, text):
        super().__init__()
        self.open, self.rows, self.all = [], [], []
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.open.append(tag)
        if tag == "tr":
            self.rows.append([])
        if tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.all.append(data)
        if self.open[-1] in ("td", "th"):
            self.rows[-1][-1] += data


def cells(value):
    return Cells(value._repr_html_())


@pytest.fixture
def scene():
    return rw.Scene(CUBE)


def test_a_scene_shows_its_size_its_tree_and_its_plan(scene):
    rows = dict(cells(scene).rows)
    assert (rows["vertices"], rows["faces"]) == ("8", "12")
    assert rows["bounds"] == "(0, 0, 0) to (1, 1, 1)"
    assert rows["memory"] == f"{scene.bytes:,} bytes"
    assert f"{scene.accelerator_info.nodes:,} nodes" in rows["tree"]
    assert rows["needs"] == (", ".join(scene.plan().needed) or "nothing more than rays")
    plan = cells(scene.plan())
    assert [row[0] for row in plan.rows[1:]] == [row.what for row in scene.plan().rows]


def test_a_large_scene_is_not_built_for_a_look():
    many = rw.Instance(rw.Scene(CUBE).shapes, np.tile(np.eye(4), (3, 1, 1)))
    scene = rw.Scene(many)
    rows = dict(cells(scene).rows)
    assert rows["copies"] == "3"
    assert "built by the first query" in rows["accelerator"]
    assert scene._core is None
    scene.build(progress=False)
    assert "tree" in dict(cells(scene).rows)


def test_hits_show_the_first_of_them(scene):
    origins = np.full((3, 7, 3), (0.5, 0.25, 3.0))
    origins[0, 0] = 9
    hits = scene.intersect(origins, (0, 0, -1))
    shown = cells(hits)
    assert len(shown.rows) == 11
    head = dict(zip(shown.rows[0], zip(*shown.rows[1:], strict=True), strict=True))
    assert head["t"] == ("inf", *["2"] * 9)
    assert head["name"][1] == "<cube>"
    assert "10 of 21 rows" in shown.all
    assert "10 of 21 rows" not in cells(hits[0]).all
    one = cells(hits[1, 1])
    assert len(one.rows) == 2
    every = scene.intersect_all(origins, (0, 0, -1))
    shown = cells(every)
    assert "10 of 40 rows" in shown.all
    assert [int(row[0]) for row in shown.rows[1:]] == every.ray[:10].tolist()
    assert [float(row[1]) for row in shown.rows[1:]] == every.t[:10].tolist()
    assert len(cells(scene.closest_point(origins)).rows) == 11
    assert len(cells(scene.intersect_all(origins[:0], (0, 0, 1))).rows) == 1


def results(scene):
    """A result of each kind, by name, and how many rows it has."""
    points = np.array([(0.5, 0.5, 1.0), (0.25, 0.5, 1.0)])
    up = np.tile([0.0, 0, 1], (2, 1))
    room = rw.Scene(rw.Mesh(CUBE.vertices, CUBE.faces[:, ::-1]))
    scanner = rw.measure.SpinningLidar(position=(0.5, 0.5, 0.5), elevations=[0.0], columns=8)
    return {
        "Estimate": (rw.measure.sky_view(scene, points, up, up=(0, 0, 1), rays=64), 2),
        "LidarScan": (rw.measure.lidar(scene, scanner), 8),
        "LineOfSight": (rw.measure.line_of_sight(scene, [(-1, 0.5, 0.5)] * 3, (2, 0.5, 0.5)), 3),
        "SolarExposure": (rw.measure.solar_exposure(scene, points, up, sun=[(0, 0, 1)], up=(0, 0, 1)), 2),
        "CrossSection": (rw.measure.cross_section(scene, (0, 0, 0.5), (0, 0, 1)), None),
        "Topology": (rw.measure.topology(scene), 1),
        "ViewFactors": (rw.view_factors(room, rays=64, progress=False), None),
        "RadiativeExchange": (rw.radiative_exchange(room, 300.0, rays=64, progress=False), 12),
        "ConeFaces": (scene.faces_in_cone((0.5, 0.25, 3), (0, 0, -1), 5.0), None),
    }


def test_results_are_columns_of_one_length(scene):
    for name, (result, count) in results(scene).items():
        assert type(result).__name__ == name
        columns = result.to_dict()
        sizes = {len(column) for column in columns.values()}
        assert len(sizes) == 1, name
        size = sizes.pop()
        assert count in (None, size), name
        assert size, name
        shown = cells(result)
        assert shown.all[0] == repr(result)
        assert shown.rows[0] == list(columns), name
        assert len(shown.rows) == 1 + min(size, 10), name


def test_columns_hold_what_the_results_tell(scene):
    found = {name: result for name, (result, _) in results(scene).items()}
    scan = found["LidarScan"]
    places = np.column_stack([scan.to_dict()[axis] for axis in "xyz"])
    np.testing.assert_array_equal(places, scan.position)
    line = found["CrossSection"]
    table = line.to_dict()
    assert table["closed"].all()
    np.testing.assert_array_equal(table["x"][table["line"] == 0], line.lines[0][:, 0])
    factors = found["ViewFactors"]
    table = factors.to_dict()
    matrix = np.zeros(factors.matrix.shape)
    matrix[table["from"], table["to"]] = table["factor"]
    np.testing.assert_array_equal(matrix, factors.matrix)
    assert (np.diff(table["from"]) >= 0).all()
    np.testing.assert_array_equal(found["LineOfSight"].to_dict()["visible"], [False] * 3)
    assert found["Topology"].to_dict()["bodies"].tolist() == [1]


def test_radiosity_and_sparse_view_factors_are_columns_too():
    room = rw.Scene(rw.Mesh(CUBE.vertices, CUBE.faces[:, ::-1], emission=1.0))
    solution = rw.radiosity(room, rays=2000, progress=False)
    columns = solution.to_dict()
    assert {len(column) for column in columns.values()} == {len(solution)}
    np.testing.assert_array_equal(columns["radiosity_green"], solution.radiosity[:, 1])
    assert cells(solution).all[0] == repr(solution)


def test_results_become_frames_of_pandas(scene):
    pandas = pytest.importorskip("pandas")
    for name, (result, _) in results(scene).items():
        frame = result.to_dataframe()
        assert isinstance(frame, pandas.DataFrame), name
        assert list(frame.columns) == list(result.to_dict()), name


def test_reports_and_render_plans_are_tables():
    columns = Column("name", "who"), Column("share", "share, %", ".1f")
    table = cells(Table("What & how", columns, [("<a>", 12.34), ("b", None)], ["a note"]))
    assert table.rows == [["who", "share, %"], ["<a>", "12.3"], ["b", "-"]]
    assert (table.all[0], table.all[-1]) == ("What & how", "a note")
    camera = rw.Camera((0.5, 0.5, 4), (0.5, 0.5, 0), width=8, height=8)
    plan = rw.render(rw.Scene(CUBE, environment=1.0), camera, samples=4, progress=False).plan
    rows = cells(plan).rows
    assert rows[0] == ["", "chosen", "why"]
    assert [row[0] for row in rows[1:]] == [row.what for row in plan.rows]


def test_builds_and_plans_are_logged(caplog):
    camera = rw.Camera((0.5, 0.5, 4), (0.5, 0.5, 0), width=8, height=8)
    scene = rw.Scene(CUBE, environment=1.0)
    with caplog.at_level(logging.DEBUG, "raywright"):
        image = rw.render(scene, camera, samples=4, progress=False)
    told = [record.getMessage() for record in caplog.records if record.name == "raywright"]
    assert any(
        line.startswith(f"scene built: {scene.accelerator_info.kind} of 12 primitives") for line in told
    )
    assert any(line.startswith("render: sampler: ") for line in told)
    assert len(image.plan.rows) == sum(line.startswith("render: ") for line in told)
    caplog.clear()
    rw.Scene(CUBE).build(progress=False)
    assert not [record for record in caplog.records if record.name == "raywright"]
