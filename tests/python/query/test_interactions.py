"""What batches of rays meet: faces, colors, and where smooth surfaces send them."""

import numpy as np
import pytest

import raywright as rw


def rays(origins, directions):
    directions = np.asarray(directions, float)
    directions = directions / np.linalg.norm(directions, axis=1)[:, None]
    return rw.query.Rays(
        np.broadcast_to(np.asarray(origins, float), directions.shape), directions, np.zeros(len(directions))
    )


def around(count, seed=0):
    return np.random.default_rng(seed).normal(size=(count, 3))


def test_faces_and_coordinates_are_those_of_hits(box):
    scene = rw.Scene([box, rw.Sphere((0.5, 0.5, 3), 1)])
    batch = rays((0.4, 0.5, 0.6), around(500))
    here, hits = scene.interactions(batch), scene.intersect(batch.origins, batch.directions)
    assert np.array_equal(here.primitive_id, hits.primitive_id)
    assert np.array_equal(here.shape_id, hits.shape_id)
    assert np.array_equal(here.uv, hits.uv)
    outside = scene.interactions(rays((9, 9, 9), [(1.0, 1, 1)]))
    assert outside.primitive_id[0] == -1
    for name in ("uv", "albedo", "ior"):
        assert np.isnan(getattr(outside, name)).all()


def test_colors_and_indices_are_those_of_materials():
    materials = [rw.Diffuse((0.2, 0.4, 0.6)), rw.Mirror(0.7), rw.Dielectric(1.33), rw.ThinDielectric(1.5)]
    shapes = [rw.Sphere((3.0 * i, 0, 0), 1, material=material) for i, material in enumerate(materials)]
    here = rw.Scene(shapes).interactions(rays([(3.0 * i, 0, 5) for i in range(4)], [(0.0, 0, -1)] * 4))
    assert here.albedo[0] == pytest.approx((0.2, 0.4, 0.6), abs=1e-12)
    assert here.albedo[1] == pytest.approx((0.7, 0.7, 0.7), abs=1e-12)
    assert here.ior == pytest.approx((1, 1, 1.33, 1))


def test_mirrors_reflect_and_matt_surfaces_send_nothing_anywhere(box):
    scene = rw.Scene(rw.Mesh(box.vertices, box.faces, material=rw.Mirror((0.9, 0.8, 0.7))))
    batch = rays((0.4, 0.5, 0.6), around(100))
    here = scene.interactions(batch)
    to = here.reflected()
    mirrored = batch.directions - 2 * np.sum(batch.directions * here.normal, axis=1)[:, None] * here.normal
    assert to.direction == pytest.approx(mirrored, abs=1e-12)
    assert to.weight == pytest.approx(np.tile((0.9, 0.8, 0.7), (100, 1)))
    assert np.all(np.isinf(to.pdf))
    assert not here.refracted().any.any()
    matt = rw.Scene(box).interactions(batch)
    for none in (matt.reflected(), matt.refracted()):
        assert not none.any.any()
        assert np.isnan(none.direction).all()
        assert np.all(none.pdf == 0)


@pytest.mark.parametrize("start", [(0, 0, 5), (0.2, 0.1, -0.3)])
def test_glass_sends_light_both_ways_by_snell_and_fresnel(start):
    ior = 1.5
    scene = rw.Scene(rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(ior)))
    way = around(400) if np.linalg.norm(start) < 1 else around(400) * (0.4, 0.4, 0) - np.array(start)
    here = scene.interactions(rays(start, way))
    here = here[here.hit]
    eta = ior if np.linalg.norm(start) > 1 else 1 / ior
    back, through = here.reflected(), here.refracted()
    cosine = -np.sum(here.rays.directions * here.normal, axis=1)
    sine = np.sqrt(1 - cosine**2) / eta
    goes = sine < 1
    assert np.array_equal(through.any, goes)
    beyond = -np.sum(through.direction * here.normal, axis=1)[goes]
    assert beyond == pytest.approx(np.sqrt(1 - sine[goes] ** 2), abs=1e-9)
    # Fresnel's law, without absorption: radiance decreases by the square of the index.
    c, b = cosine[goes], beyond
    law = 0.5 * (((c - eta * b) / (c + eta * b)) ** 2 + ((eta * c - b) / (eta * c + b)) ** 2)
    assert back.weight[goes, 0] == pytest.approx(law, abs=1e-9)
    assert back.weight[~goes] == pytest.approx(1)
    assert back.weight[goes] + through.weight[goes] * eta**2 == pytest.approx(1)
    # Rays leave on their own side.
    again = scene.interactions(here.spawn_rays(through.direction)[goes])
    assert again.hit.all() == (np.linalg.norm(start) > 1)


def test_reports_make_frames_with_names(box):
    pandas = pytest.importorskip("pandas")
    table = rw.report.Table(
        "two", [rw.report.Column("a", "A"), rw.report.Column("b", "B [m]")], [(1, "x"), (2, None)]
    )
    frame = table.to_dataframe()
    assert list(frame.columns) == ["a", "b"]
    assert frame["a"].tolist() == [1, 2]
    assert frame["b"][0] == "x"
    assert pandas.isna(frame["b"][1])
    report = rw.report.accelerators(
        rw.Scene(box), accelerators=[rw.BVH(), rw.accelerators.KdTree()], repeats=1
    )
    frame = report.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert list(frame.columns) == [column.name for column in report.columns]
    assert len(frame) == len(report.rows)
