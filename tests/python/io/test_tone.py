"""From light to what a screen shows: curves, exposure, and the files that hold it."""

import io

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image as Pillow

import raywright as rw
from raywright.io import pictures, shown
from raywright.io.tone import toned

COLORS = st.lists(st.floats(0, 1e6, width=32), min_size=3, max_size=3).map(np.array)


def film(*rgb):
    return toned(np.array(rgb, float), 0.0, "filmic")


def test_what_is_no_brighter_than_half_of_white_stays_as_it_is():
    dark = np.random.default_rng(1).uniform(0, 0.5, (1000, 3))
    np.testing.assert_allclose(toned(dark, 0.0, "filmic"), dark, rtol=1e-15)


@pytest.mark.parametrize("gray", [0.18, 0.5, 0.75, 1.0, 2.0, 17.0, 1e4])
def test_grays_go_by_the_shoulder(gray):
    # 1 - (1 - k)² / (x + 1 - 2k), with k = 0.5, is the shoulder of Khronos' PBR Neutral.
    expected = gray if gray <= 0.5 else 1 - 0.25 / gray
    assert film(gray, gray, gray) == pytest.approx([expected] * 3, rel=1e-14)


@given(COLORS)
def test_shown_colors_are_in_range_and_keep_their_hue(rgb):
    there = film(*rgb)
    assert (there >= 0).all()
    assert (there <= 1).all()
    # The order of channels stays, and so does the middle one's relative place: that is the hue.
    low, mid, high = np.argsort(rgb, kind="stable")
    if rgb[high] > 1e-30 and rgb[high] - rgb[low] > 1e-6 * rgb[high]:
        place = (rgb[mid] - rgb[low]) / (rgb[high] - rgb[low])
        between = there[mid] - there[low]
        # Rounding of numbers up to 1 in float64.
        assert between == pytest.approx(place * (there[high] - there[low]), rel=1e-6, abs=1e-14)


@given(COLORS, st.floats(1.01, 4))
def test_brighter_light_is_shown_brighter(rgb, times):
    assert (film(*(rgb * times)).max() - film(*rgb).max()) >= 0


def test_the_shoulder_begins_without_a_bend():
    below, above = (film(x, x, x)[0] for x in (0.5 - 1e-5, 0.5 + 1e-5))
    # The second derivative of the shoulder is -4 where it begins: half of that times the square is the error.
    assert (above - below) / 2e-5 == pytest.approx(1, abs=4e-5)


def test_lamps_fade_to_white():
    for bright in (film(1e5, 2e4, 0), film(0, 0, 1e5)):
        assert bright.min() > 0.99
    assert film(1, 0, 0).tolist() == pytest.approx([0.75, *[0.75 * (1 - 1 / (0.15 * 0.25 + 1))] * 2])


@pytest.mark.parametrize("tone", ["filmic", "linear"])
def test_exposure_counts_in_stops(tone):
    rgb = np.random.default_rng(2).uniform(0, 3, (50, 3))
    for stops in (-3.5, 0.0, 1.0, 4.0):
        assert np.array_equal(toned(rgb, stops, tone), toned(rgb * 2.0**stops, 0.0, tone))


@pytest.mark.parametrize("tone", ["filmic", "linear"])
def test_what_is_no_color_is_shown_as_black_or_white(tone):
    odd = np.array([[np.nan] * 3, [-1] * 3, [np.inf] * 3, [3e38] * 3], np.float32)
    for stops in (-0.0, 100.0):
        assert shown.srgb(odd, None, stops, tone)[:, 0].tolist() == [0, 0, 255, 255]


def test_a_share_of_a_pixel_has_the_color_of_what_covers_it():
    whole = np.array([[[0.2, 0.9, 3.0]]])
    for alpha in (1.0, 0.5, 0.1):
        pixel = shown.srgb(whole * alpha, np.full((1, 1), alpha))[0, 0]
        assert pixel[:3].tolist() == shown.srgb(whole)[0, 0].tolist()
        assert pixel[3] == int(alpha * 255 + 0.5)
    assert shown.srgb(whole, np.zeros((1, 1))).tolist() == [[[0, 0, 0, 0]]]


@pytest.mark.parametrize(
    ("name", "format", "off"),
    # Lossy formats by their maximal error; the mean is a tenth of that.
    [
        ("a.png", "PNG", 0),
        ("a.jpg", "JPEG", 12),
        ("a.JPEG", "JPEG", 12),
        ("a.webp", "WEBP", 40),
        ("a.avif", "AVIF", 20),
    ],
)
def test_files_for_the_eye_hold_what_is_shown(tmp_path, name, format, off):
    if format == "AVIF" and "avif" not in __import__("PIL.features").features.get_supported_modules():
        pytest.skip("this Pillow has no AVIF")
    ramps = np.stack(np.meshgrid(np.linspace(0, 2, 64), np.linspace(0, 1, 48)), axis=-1)
    rgb = np.concatenate([ramps, 0.5 * np.ones((48, 64, 1))], axis=-1).astype(np.float32)
    history = np.empty(0, rw.rendering.image.HISTORY)
    image = rw.Image(rgb, rgb, rw.rendering.ErrorEstimate(0, 0, 0), history, 0.0, 1)
    for how in ({}, {"exposure": -1.0, "tone": "linear"}):
        image.save(tmp_path / name, **how)
        with Pillow.open(tmp_path / name) as file:
            assert file.format == format
            away = np.abs(np.asarray(file.convert("RGB"), float) - image.srgb(**how))
        assert away.max() <= off
        assert away.mean() <= off / 10


def test_a_pillow_without_a_format_is_told_of_before_the_work(tmp_path, monkeypatch):
    from PIL import features

    monkeypatch.setattr(features, "get_supported_modules", lambda: ["webp"])
    with pytest.raises(ImportError, match=r"^saving \.avif needs a Pillow that has AVIF: pip install"):
        pictures.check_writable(tmp_path / "a.avif")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("how", "error", "told"),
    [
        ({"exposure": "bright"}, TypeError, "exposure must be"),
        ({"exposure": float("nan")}, ValueError, "exposure must be finite, got nan"),
        ({"exposure": 101}, ValueError, "exposure must be between -100 and 100 stops, got 101"),
        ({"tone": "aces"}, ValueError, "tone must be one of filmic, linear, got 'aces'"),
        ({"tone": None}, ValueError, "tone must be one of filmic, linear, got None"),
    ],
)
def test_wrong_tones_are_refused_and_nothing_is_written(picture, tmp_path, how, error, told):
    with pytest.raises(error, match=told):
        picture.save(tmp_path / "a.png", **how)
    with pytest.raises(error, match=told):
        picture.srgb(**how)
    assert list(tmp_path.iterdir()) == []


def test_notebooks_and_files_show_the_same(picture, tmp_path):
    picture.save(tmp_path / "a.png")
    assert (tmp_path / "a.png").read_bytes() == picture._repr_png_()
    with Pillow.open(io.BytesIO(picture._repr_png_())) as file:
        assert np.array_equal(np.asarray(file), picture.srgb())
