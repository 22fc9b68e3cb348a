"""Pictures of where the work is, and the estimate of where the time goes."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Pillow
from PIL import ImageDraw, ImageFont

import raywright as rw
from raywright.report.heatmap import COLORS, ticks
from raywright.report.time_share import fitted

KNOT = rw.scenes.torus_knot(along=60, around=10)
SCENE = rw.Scene(KNOT)
CAMERA = rw.Camera((0, 0, 5), (0, 0, 0), width=40, height=30)


@pytest.fixture(scope="module")
def heat():
    return rw.report.heatmap(SCENE, CAMERA, repeats=0)


@pytest.mark.parametrize("what", ["nodes", "primitives"])
def test_counts_are_what_rays_cost(what):
    heat = rw.report.heatmap(SCENE, CAMERA, what, repeats=0)
    cost = SCENE.traversal_cost(*CAMERA.rays())
    assert np.array_equal(heat.nodes, cost.nodes)
    assert np.array_equal(heat.primitives, cost.primitives)
    assert np.array_equal(heat.counts, getattr(cost, what))
    assert heat.vmax == heat.counts.max()
    assert heat.share is None


def test_brute_force_has_one_color():
    heat = rw.report.heatmap(rw.Scene(KNOT, accelerator=rw.BruteForce()), CAMERA, "primitives", repeats=0)
    assert (heat.counts == len(KNOT.faces)).all()
    assert (heat.srgb() == COLORS[-1]).all()
    assert (rw.report.heatmap(rw.Scene([]), CAMERA, repeats=0).srgb() == COLORS[0]).all()


def test_colors_tell_counts(heat):
    picture = heat.srgb()
    assert picture.shape == (30, 40, 3)
    assert (picture[heat.counts == heat.vmax] == COLORS[-1]).all()
    # The level is the nearest of 256 to the count's share of the maximum.
    level = np.floor(255 * heat.counts / heat.vmax + 0.5).astype(int)
    assert np.array_equal(picture, COLORS[level])


def test_colors_rise_evenly_in_lightness():
    assert COLORS[0].tolist() == [0, 0, 0]
    assert COLORS[-1].tolist() == [255, 255, 255]
    # The scheme keeps perceived brightness (NTSC) linear, except for clipping.
    brightness = COLORS @ np.array([0.30, 0.59, 0.11])
    assert np.abs(brightness - np.arange(256)).max() < 3
    assert (np.diff(brightness) > -0.5).all()


def test_what_is_above_the_scale_has_its_last_color(heat):
    low = rw.report.heatmap(SCENE, CAMERA, vmax=2, repeats=0)
    assert low.vmax == 2
    assert (low.srgb()[low.counts >= 2] == COLORS[-1]).all()
    high = rw.report.heatmap(SCENE, CAMERA, vmax=10 * heat.vmax, repeats=0)
    assert not (high.srgb() == COLORS[-1]).all(axis=2).any()


def test_png_shows_the_picture_enlarged_beside_its_bar(heat, tmp_path):
    heat.save(tmp_path / "heat.png")
    with Pillow.open(tmp_path / "heat.png") as file:
        pixels = np.asarray(file.convert("RGB"))
    assert pixels.shape[0] == 240
    assert np.array_equal(pixels[4:240:8, 4:320:8], heat.srgb())
    bar = pixels[:, 335]
    # From the bottom up, every color with enough room, in order.
    found = [np.flatnonzero((color == COLORS).all(axis=1))[0] for color in bar[22:231][::-1]]
    assert found[0] == 0
    assert found[-1] == 255
    assert (np.diff(found) >= 0).all()
    assert (tmp_path / "heat.png").read_bytes() == heat._repr_png_()
    with Pillow.open(io.BytesIO(heat._repr_png_())) as file:
        assert file.size == (pixels.shape[1], 240)


@pytest.mark.parametrize("most", [None, 3, 1])
def test_the_font_has_what_is_written(most, monkeypatch):
    written = []
    draw = ImageDraw.ImageDraw.text

    def text(self, at, told, **how):
        written.append(told)
        draw(self, at, told, **how)

    monkeypatch.setattr(ImageDraw.ImageDraw, "text", text)
    heat = rw.report.heatmap(SCENE, CAMERA, vmax=most, repeats=0)
    heat._repr_png_()
    # Values above the last number share its color, and a plus sign says so.
    *numbers, last = map(str, ticks(heat.vmax))
    assert written == ["nodes", *numbers, last if most is None else f"{last}+"]
    font = ImageFont.load_default()
    missing = bytes(font.getmask("\ue000" if isinstance(font, ImageFont.FreeTypeFont) else "\x00"))
    assert all(bytes(font.getmask(letter)) != missing for letter in set("".join(written)))


def test_npy_holds_the_counts(heat, tmp_path):
    heat.save(tmp_path / "heat.npy")
    assert np.array_equal(np.load(tmp_path / "heat.npy"), heat.counts)


def test_summary_tells_the_numbers(heat):
    row = heat.summary().where(what="nodes visited").rows[0]
    assert row[1:] == (
        pytest.approx(heat.nodes.mean()),
        np.median(heat.nodes),
        pytest.approx(np.quantile(heat.nodes, 0.99)),
        heat.nodes.max(),
    )
    assert str(heat) == str(heat.summary())
    assert repr(heat) == f"Heatmap(40x30, nodes visited, 0 to {heat.vmax})"


def test_plot_shows_the_counts(heat):
    pytest.importorskip("matplotlib").use("Agg")
    ax = heat.plot()
    assert np.array_equal(ax.images[0].get_array(), heat.counts)
    assert ax.images[0].get_clim() == (0, heat.vmax)
    ax.figure.clear()


def test_plot_goes_to_a_file(heat, tmp_path):
    pytest.importorskip("matplotlib")
    ax = heat.plot(tmp_path / "heat.png")
    assert np.array_equal(ax.images[0].get_array(), heat.counts)
    with Pillow.open(tmp_path / "heat.png") as picture:
        assert min(picture.size) > 300


@given(st.integers(1, 10**9))
def test_ticks_are_few_round_and_end_with_the_most(most):
    marks = ticks(most)
    assert marks[0] == 0
    assert marks[-1] == most
    assert len(marks) <= 12
    steps = np.diff(marks)
    assert (steps > 0).all()
    assert len(set(steps[:-1].tolist())) <= 1
    # No two overlap.
    assert steps.min() * 2 >= steps.max() or len(marks) <= 3


# Shares of time.


def test_a_fit_finds_the_costs_that_made_the_times():
    counts = np.random.default_rng(1).integers(100, 1000, (80, 3)).astype(float)
    costs = np.array([7e-9, 3e-9, 11e-9])
    share = fitted(counts, counts @ costs)
    times = costs * counts.sum(axis=0)
    assert [share.node_ns, share.primitive_ns, share.ray_ns] == pytest.approx([7, 3, 11])
    assert [share.boxes, share.primitives, share.rest] == pytest.approx(times / times.sum())
    assert share.boxes_interval == pytest.approx((share.boxes, share.boxes))
    assert share.explained == pytest.approx(1)


def test_an_interval_holds_the_truth_in_spite_of_noise():
    held = 0
    for seed in range(40):
        rng = np.random.default_rng(seed)
        counts = rng.integers(100, 1000, (80, 3)).astype(float)
        times = counts @ np.array([7e-9, 3e-9, 11e-9]) * rng.normal(1, 0.1, 80)
        total = counts.sum(axis=0) * [7, 3, 11]
        low, high = fitted(counts, times, seed).boxes_interval
        held += bool(low <= total[0] / total.sum() <= high)
    # At 95 of 100, 31 or fewer of 40 happen once in 7,000 tries.
    assert held > 31


def test_a_fit_has_no_negative_costs():
    counts = np.random.default_rng(2).integers(100, 1000, (80, 3)).astype(float)
    share = fitted(counts, counts @ np.array([7e-9, -3e-9, 11e-9]))
    assert min(share.boxes, share.primitives, share.rest) >= 0
    assert share.primitive_ns == 0
    assert share.boxes + share.primitives + share.rest == pytest.approx(1)


@pytest.mark.parametrize("rays", [CAMERA, CAMERA.rays(), [ray.reshape(-1, 3) for ray in CAMERA.rays()]])
def test_shares_add_up(rays):
    share = rw.report.time_share(SCENE, rays, repeats=2)
    assert share.boxes + share.primitives + share.rest == pytest.approx(1)
    for value, (low, high) in (
        (share.boxes, share.boxes_interval),
        (share.primitives, share.primitives_interval),
    ):
        assert 0 <= value <= 1
        assert 0 <= low <= high <= 1
    assert str(share).startswith("share of time, estimated: boxes ")


def test_a_heatmap_tells_the_share_if_asked_to():
    heat = rw.report.heatmap(SCENE, CAMERA, repeats=1)
    assert str(heat).splitlines()[-1] == str(heat.share)


@pytest.mark.parametrize(
    ("error", "call", "message"),
    [
        (TypeError, lambda: rw.report.heatmap(KNOT, CAMERA), "scene must be a Scene, got Mesh"),
        (TypeError, lambda: rw.report.heatmap(SCENE, 5), "camera must be a Camera, got int"),
        (
            ValueError,
            lambda: rw.report.heatmap(SCENE, CAMERA, "boxes"),
            "what must be one of 'nodes', 'primi",
        ),
        (ValueError, lambda: rw.report.heatmap(SCENE, CAMERA, vmax=0), "vmax must be at least 1, got 0"),
        (TypeError, lambda: rw.report.time_share(KNOT, CAMERA), "scene must be a Scene, got Mesh"),
        (TypeError, lambda: rw.report.time_share(SCENE, 3), "rays must be a Camera, Rays"),
        (
            ValueError,
            lambda: rw.report.time_share(SCENE, ((0, 0, 5), np.ones((63, 3)))),
            "rays must be at least 64 for an estimate, got 63",
        ),
    ],
)
def test_bad_arguments_are_refused(error, call, message):
    with pytest.raises(error, match=message):
        call()


@pytest.mark.parametrize("name", ["heat.exr", "heat.jpg"])
def test_other_files_are_refused(heat, tmp_path, name):
    with pytest.raises(ValueError, match=r"a heatmap is saved as \.png, \.npy; .* is none of these"):
        heat.save(tmp_path / name)
