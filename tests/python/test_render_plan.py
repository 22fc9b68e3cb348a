"""What is chosen for a render where nothing is named, and that a picture says so."""

import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest

import raywright as rw


@pytest.fixture(scope="module")
def box():
    return rw.scenes.cornell_box(width=8, height=8)


def render(box, **how):
    return rw.render(*box, progress=False, **how)


def test_samples_are_placed_where_nothing_is_named(box):
    image = render(box)
    assert image.samples == 64
    assert isinstance(image.plan.sampler, rw.Lattice)
    assert np.array_equal(image.rgb, render(box, samples=64, sampler=image.plan.sampler).rgb)
    assert [row.what for row in image.plan.rows] == ["sampler", "batch"]
    assert image.plan["sampler"].chosen == "Lattice"
    assert int(image.plan["batch"].chosen) == image.plan.sampler.batch
    assert all(row.why for row in image.plan.rows)


@pytest.mark.parametrize("adaptive", [False, True])
@pytest.mark.parametrize(
    "limits",
    [{"samples": n} for n in (1, 2, 3, 8, 16, 40, 64, 128, 256, 1000)]
    + [{"seconds": 1e-9}, {"error": 10.0}, {"samples": 512, "error": 10.0}],
)
def test_lattices_unless_of_few_points(box, limits, adaptive):
    sampler = render(box, **limits, adaptive=adaptive).plan.sampler
    batch = 1 if sampler == rw.Independent() else sampler.batch
    kind = rw.Independent if batch == 1 else rw.Sobol if batch <= 4 else rw.Lattice
    assert type(sampler) is kind
    if "samples" in limits:
        # There are two batches of each half to tell the error by, but for pictures that have no two samples.
        assert batch * 2 * (1 + adaptive) <= max(limits["samples"], 2 * (1 + adaptive))


def test_what_is_named_is_used_as_named(box):
    for sampler in (rw.Independent(), rw.Halton(8), rw.Sobol(2), rw.Stratified(64)):
        image = render(box, samples=16, sampler=sampler)
        assert image.plan.sampler == sampler
        assert {row.why for row in image.plan.rows} == {"as named"}
    image = render(box, samples=64, sampler=rw.Sobol())
    assert isinstance(image.plan.sampler, rw.Sobol)
    assert image.plan["sampler"].why == "as named"
    assert image.plan["batch"].why != "as named"


def test_time_and_errors_leave_room_for_few_samples():
    box = rw.scenes.cornell_box(width=32, height=32)
    for limits, batch in (
        ({"seconds": 1e-9}, 16),
        ({"samples": 10**6, "seconds": 1e-9}, 16),
        ({"error": 10.0}, 4),
        ({"samples": 10**6, "error": 10.0}, 4),
        ({"seconds": 1e-9, "error": 1e-6}, 16),
        ({"samples": 1, "error": 1e-6}, 1),
    ):
        image = render(box, **limits)
        assert image.samples <= 16
        assert image.plan["batch"].chosen == str(batch)
    assert render(box, samples=1, error=1e-4).plan == render(box, samples=1).plan
    assert "an error of 10" in render(box, error=10.0).plan["batch"].why


def test_a_plan_prints_as_a_table_and_stays(box):
    image = render(box, samples=16)
    lines = repr(image.plan).split("\n")
    assert len(lines) == 1 + len(image.plan.rows)
    assert lines[0].split() == ["chosen", "why"]
    for line, row in zip(lines[1:], image.plan.rows, strict=True):
        assert line.startswith(row.what)
        assert row.chosen in line
        assert line.endswith(row.why)
    back = pickle.loads(pickle.dumps(image))
    assert back == image
    assert back.plan == image.plan
    with pytest.raises(FrozenInstanceError):
        image.plan.rows = ()
    with pytest.raises(KeyError, match="weather"):
        image.plan["weather"]


def test_shots_and_views_leave_it_to_render(box):
    assert rw.Shot(*box).sampler is None
    assert isinstance(rw.Shot(*box).render(samples=64, progress=False).plan.sampler, rw.Lattice)
    named = rw.Shot(*box, sampler=rw.Halton(4)).render(samples=64, progress=False)
    assert named.plan.sampler == rw.Halton(4)
