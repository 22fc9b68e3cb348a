"""A render chooses open options, and its picture reports them."""

import pickle
import threading
import time
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
import rare_scenes

import raywright as rw
from raywright import _core
from raywright.rendering import auto_options as ways
from raywright.rendering.auto_options import StoppedError


@pytest.fixture(scope="module")
def box():
    return rw.scenes.cornell_box(width=8, height=8)


def render(box, **how):
    return rw.render(*box, progress=False, **how)


def test_samples_are_placed_where_nothing_is_named(box):
    image = render(box)
    assert image.samples == 64
    assert isinstance(image.plan.sampler, rw.rendering.Lattice)
    assert np.array_equal(image.rgb, render(box, samples=64, sampler=image.plan.sampler).rgb)
    assert [row.what for row in image.plan.rows] == ["sampler", "batch", "reuse", "guiding"]
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
    batch = 1 if sampler == rw.rendering.Independent() else sampler.batch
    kind = (
        rw.rendering.Independent if batch == 1 else rw.rendering.Sobol if batch <= 4 else rw.rendering.Lattice
    )
    assert type(sampler) is kind
    if "samples" in limits:
        # Each half has two batches for its error, except for pictures without two samples.
        assert batch * 2 * (1 + adaptive) <= max(limits["samples"], 2 * (1 + adaptive))


def test_what_is_named_is_used_as_named(box):
    path = rw.Path(reuse=2, guiding="none")
    for sampler in (
        rw.rendering.Independent(),
        rw.rendering.Halton(8),
        rw.rendering.Sobol(2),
        rw.rendering.Stratified(64),
    ):
        image = render(box, integrator=path, samples=16, sampler=sampler)
        assert image.plan.sampler == sampler
        assert image.plan.path == path
        assert {row.why for row in image.plan.rows} == {"as named"}
    image = render(box, samples=64, sampler=rw.rendering.Sobol())
    assert isinstance(image.plan.sampler, rw.rendering.Sobol)
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
    assert rw.rendering.RenderSetup(*box).sampler is None
    assert isinstance(
        rw.rendering.RenderSetup(*box).render(samples=64, progress=False).plan.sampler, rw.rendering.Lattice
    )
    named = rw.rendering.RenderSetup(*box, sampler=rw.rendering.Halton(4)).render(samples=64, progress=False)
    assert named.plan.sampler == rw.rendering.Halton(4)


# Enough samples for a pilot.
SIDE, SAMPLES = 128, 64
WAYS = [
    rw.Path(reuse=reuse, guiding=guiding) for reuse in (1, 4) for guiding in ("none", "photons", "learned")
]


def made(name, side=SIDE):
    return getattr(rw.scenes, name)(width=side, height=side)


def chosen(scene, camera, path=None, samples=SAMPLES, **how):
    """Return the plan of a render that is stopped once its pilot is back."""
    stop = threading.Event()
    how |= {"progress": lambda image: stop.set(), "stop": stop}
    return rw.render(scene, camera, path or rw.Path(), samples=samples, **how).plan


@pytest.fixture
def eager(monkeypatch):
    """Pilots of small pictures too: a render of as many samples as its pilot sends one."""
    monkeypatch.setattr(ways, "_SHARE", 1)
    assert _core.PILOT == 32 * 32 * 16


@pytest.mark.parametrize(
    ("name", "reuse", "guiding", "why"),
    [
        ("cornell_box", 8, "none", ("error times time is 0.", "no light comes by way of mirrors or glass")),
        ("veach_plates", 1, "none", ("error times time is ", "error times time is ")),
        ("glass_spheres", 1, "photons", ("error times time is ", "error times time is 0.")),
    ],
)
def test_paths_go_as_a_pilot_finds(name, reuse, guiding, why):
    scene, camera = made(name)
    plan = chosen(scene, camera)
    assert plan.path == rw.Path(reuse=reuse, guiding=guiding)
    assert (plan["reuse"].chosen, plan["guiding"].chosen) == (str(reuse), guiding)
    assert why[0] in plan["reuse"].why
    assert why[1] in plan["guiding"].why
    # Neither the seed nor the number of threads matters.
    assert chosen(scene, camera, seed=5, threads=3) == plan


@pytest.mark.parametrize(
    ("name", "plain"), [("cornell_box", False), ("veach_plates", True), ("glass_spheres", False)]
)
def test_what_a_pilot_finds_is_the_same_picture_when_it_is_named(eager, name, plain):
    scene, camera = made(name, 32)
    image = rw.render(scene, camera, samples=16, progress=False)
    path = image.plan.path
    assert "by a pilot" in image.plan["reuse"].why
    assert (path == rw.Path(reuse=1, guiding="none")) is plain
    again = rw.render(scene, camera, path, samples=16, threads=3, progress=False)
    assert np.array_equal(again.rgb, image.rgb)


def test_sharing_and_a_learned_guide_are_chosen_where_light_is_rare():
    scene, camera = rare_scenes.keyhole(SIDE)
    plan = chosen(scene, camera)
    assert plan.path.reuse > 1
    assert plan.path.guiding == "learned"
    assert "error times time is 0." in plan["reuse"].why
    assert "error times time is 0." in plan["guiding"].why
    # Named options apply as named.
    named = chosen(scene, camera, rw.Path(reuse=4))
    assert named.path.reuse == 4


def test_a_pilot_says_the_same_on_any_number_of_threads():
    scene, camera = made("glass_spheres", 40)
    said = [
        _core.pilot(scene._compiled(), camera, WAYS, n, None, rw.rendering.BoxFilter(), None)
        for n in (1, 2, 5, None)
    ]
    assert said == [said[0]] * 4
    assert _core.pilot(scene._compiled(), camera, [], None, None, rw.rendering.BoxFilter(), None) == []


def test_a_pilot_tells_the_error_of_the_picture():
    # Two parts make the whole.
    box = rw.scenes.cornell_box(width=32, height=16)
    for path in (rw.Path(reuse=1, guiding="none"), rw.Path(reuse=4, guiding="none")):
        # Its own error is less than an eightieth of that of 8 samples.
        truth = render(box, integrator=path, samples=1024).rgb.astype(float)
        pictures = [
            render(box, integrator=path, samples=8, sampler=rw.rendering.Sobol(4), seed=seed).rgb
            for seed in range(50)
        ]
        errors = [np.mean((rgb - truth) ** 2 / (truth**2 + 0.01)) for rgb in pictures]
        (said,) = _core.pilot(box[0]._compiled(), box[1], [path], None, None, rw.rendering.BoxFilter(), None)
        # It is one picture, whose pixels have two batches each.
        off = (said - np.mean(errors)) / np.std(errors)
        assert abs(off) < 4, (said, np.mean(errors), np.std(errors))


def test_pilots_stay_where_there_is_nothing_to_choose():
    scene, camera = made("cornell_box")
    for path, why in (
        (rw.Path(max_depth=1), "no paths can be shared here"),
        (rw.Path(reuse=1), "as named"),
    ):
        plan = chosen(scene, camera, path)
        assert plan.path == replace(path, reuse=1, guiding="none")
        assert plan["reuse"].why == why
        assert plan["guiding"].why == "no light comes by way of mirrors or glass"
    for limits in (
        {"samples": SAMPLES - 1},
        {"seconds": 1e-3, "samples": None},
        {"error": 10.0, "samples": None},
    ):
        plan = chosen(scene, camera, **limits)
        assert plan.path == rw.Path(reuse=1, guiding="none")
        assert {plan[what].why for what in ("reuse", "guiding")} == {
            "the picture has too few samples to send a pilot"
        }


def test_what_is_no_path_has_none(box):
    plan = render(box, integrator=rw.Direct(), samples=16).plan
    assert plan.path is None
    with pytest.raises(KeyError, match="reuse"):
        plan["reuse"]


def test_checkpoints_keep_what_was_chosen(box, tmp_path, eager):
    scene, camera = made("cornell_box", 32)
    begun = rw.render(scene, camera, samples=16, checkpoint=tmp_path / "large", progress=False)
    assert begun.plan.path.reuse == 4
    # Too few for a pilot, had there been none.
    on = rw.render(scene, camera, samples=1, checkpoint=tmp_path / "large", progress=False)
    assert on.plan.path == begun.plan.path
    assert {on.plan[what].why for what in ("reuse", "guiding")} == {"as the checkpoint has it"}
    assert np.array_equal(on.rgb, begun.rgb)
    with pytest.raises(ValueError, match="another integrator, reuse 4 instead of 8"):
        render((scene, camera), integrator=rw.Path(reuse=8), checkpoint=tmp_path / "large")
    # A render that began without sharing continues without it.
    render(box, samples=16, checkpoint=tmp_path / "small")
    assert render(box, samples=20, checkpoint=tmp_path / "small").plan.path.reuse == 1


class Stop:
    """Says that it is set when it has been asked so often."""

    def __init__(self, asked):
        self.left = asked

    def is_set(self):
        self.left -= 1
        return self.left < 0


def test_a_pilot_is_called_back_when_the_render_is_stopped():
    # A pilot over paths of thousands of bounces takes seconds, and checks often for cancellation.
    walls = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.Diffuse(0.9999))
    lamp = rw.PointLight((0, 0, 0), 1.0)
    camera = rw.Camera((0.5, 0.2, 0.1), (0, 0, -1), width=512, height=512)
    began = time.perf_counter()
    image = rw.render(
        rw.Scene([walls], [lamp]), camera, rw.Path(roulette_depth=10**6), stop=Stop(1), progress=False
    )
    assert time.perf_counter() - began < 5
    assert image.samples == 0
    assert image.plan["reuse"].why == "it was stopped before a pilot was back"


def test_so_are_photons():
    scene = made("glass_spheres", 64)[0]
    compiled = scene._compiled()

    def look():
        raise StoppedError

    # On one thread they take many times as long as the interval between checks.
    with pytest.raises(StoppedError):
        _core.chances(compiled, rw.Path(), 1, look)
    # A pilot that was stopped counts as no result.
    assert _core.chances(compiled, rw.Path(), None, None) == (True, True, True)


def test_a_pilot_is_part_of_the_time():
    scene, camera = made("glass_spheres", 64)
    scene.build()
    began = time.perf_counter()
    image = rw.render(scene, camera, seconds=1.5, progress=False)
    took = time.perf_counter() - began
    assert "by a pilot" in image.plan["guiding"].why
    assert abs(image.seconds - took) < 0.3
    assert took < 3
