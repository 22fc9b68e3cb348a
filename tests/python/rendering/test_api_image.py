"""Pictures: their numbers, their files, and where they can be written."""

import io
import math
import os
import pickle

import numpy as np
import OpenEXR
import pytest
from PIL import Image as Pillow

import raywright as rw
from raywright.io import shown


def test_linear_srgb_is_the_standard_curve():
    linear = np.array([-1, 0, 0.0031308, 0.05, 0.214041, 0.5, 1, 7, np.nan, np.inf], np.float32)
    rgb = np.repeat(linear[np.newaxis, :, np.newaxis], 3, axis=2)
    image = rw.Image(
        rgb, rgb, rw.rendering.ErrorEstimate(0, 0, 0), np.empty(0, rw.rendering.image.HISTORY), 0.0, 1
    )
    assert image.srgb().dtype == np.uint8
    assert image.srgb(tone="linear")[0, :, 0].tolist() == [0, 0, 10, 63, 127, 188, 255, 255, 0, 255]


def test_srgb_of_eight_bits_comes_back():
    codes = np.arange(256)
    c = codes / 255
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4).astype(np.float32)
    assert np.array_equal(shown.srgb(linear[:, np.newaxis], tone="linear")[:, 0], codes)


def test_arrays_are_read_only(picture):
    for array in (
        picture.rgb,
        picture.standard_error,
        picture.history,
        pickle.loads(pickle.dumps(picture)).rgb,
    ):
        assert not array.flags.writeable


def test_an_image_is_an_array_that_can_be_written_to(picture):
    array = np.asarray(picture)
    assert array.dtype == np.float32
    assert np.array_equal(array, picture.rgb)
    # As torch wants it: torch.from_numpy warns of what is read-only.
    assert array.flags.writeable
    assert array.flags.c_contiguous
    array[:] = -1
    assert picture.rgb.min() == 0
    wide = np.asarray(picture, np.float64)
    assert wide.dtype == np.float64
    assert np.array_equal(wide, picture.rgb)
    assert np.array_equal(np.array(picture), picture.rgb)
    assert np.sum(picture) == picture.rgb.sum()
    assert rw.ImageTexture(picture) == rw.ImageTexture(picture.rgb)


def test_an_image_is_not_copied_if_that_is_forbidden(picture):
    assert picture.__array__(copy=False) is picture.rgb
    assert picture.__array__(np.float32, copy=False) is picture.rgb
    assert picture.__array__(np.dtype("=f4"), copy=False) is picture.rgb
    with pytest.raises(ValueError, match=r"copy must not be False for dtype float64: rgb is float32"):
        picture.__array__(np.float64, copy=False)
    assert not np.shares_memory(picture.__array__(copy=True), picture.rgb)
    if np.lib.NumpyVersion(np.__version__) >= "2.0.0":
        assert np.shares_memory(np.asarray(picture, copy=False), picture.rgb)
        assert not np.shares_memory(np.asarray(picture, copy=True), picture.rgb)


def test_pickle_and_equality(picture):
    assert pickle.loads(pickle.dumps(picture)) == picture
    parts = {name: getattr(picture, name) for name in picture.__dataclass_fields__}
    assert rw.Image(**parts) == picture
    for change in (
        {"rgb": picture.rgb + 1},
        {"samples": 7},
        {"warnings": ("x",)},
        {"history": picture.history[:1]},
    ):
        assert rw.Image(**{**parts, **change}) != picture


def test_repr_is_one_short_line(picture):
    told = "Image(3x2, 32 samples, 2.00 s, relMSE 0.125 (95 % interval 0.1 to 0.15))"
    assert repr(picture) == told


def test_table_is_error_against_time(picture):
    assert picture.table().split("\n") == [
        "  seconds   samples     relMSE",
        "     0.50         8          -",
        "     1.00        16       0.25",
        "     2.00        32      0.125",
    ]


@pytest.mark.parametrize("rows", [1, 2, 5, 12])
def test_table_of_a_long_history_is_thinned(picture, rows):
    history = np.zeros(1000, rw.rendering.image.HISTORY)
    history["samples"] = np.arange(1, 1001) * 8
    history["error"] = 1 / history["samples"]
    image = rw.Image(picture.rgb, picture.rgb, picture.error, history, 1.0, 8000)
    lines = image.table(rows).split("\n")[1:]
    assert len(lines) <= max(rows, 2)
    assert lines[-1].split()[1] == "8000"
    if rows > 1:
        assert lines[0].split()[1] == "8"


def test_error_estimate_is_a_number():
    error = rw.rendering.ErrorEstimate(0.0125, 0.011, 0.014)
    assert float(error) == 0.0125
    assert f"{error:.2e}" == "1.25e-02"
    assert str(error) == f"{error}" == "0.0125 (95 % interval 0.011 to 0.014)"
    assert str(rw.rendering.ErrorEstimate(math.nan, math.nan, math.nan)) == "unknown"
    assert error != rw.rendering.ErrorEstimate(0.0125, 0.011, 0.015)
    assert error != 0.0125


def test_png_is_for_the_eye(picture, tmp_path):
    picture.save(tmp_path / "a.PNG")
    with Pillow.open(tmp_path / "a.PNG") as file:
        assert file.format == "PNG"
        assert file.mode == "RGB"
        assert np.array_equal(np.asarray(file), picture.srgb())
    with Pillow.open(io.BytesIO(picture._repr_png_())) as file:
        assert np.array_equal(np.asarray(file), picture.srgb())


def test_npy_holds_the_numbers(picture, tmp_path):
    picture.save(str(tmp_path / "a.npy"))
    back = np.load(tmp_path / "a.npy")
    assert back.dtype == np.float32
    assert np.array_equal(back, picture.rgb)


def test_exr_holds_the_numbers_and_their_error(picture, tmp_path):
    picture.save(tmp_path / "a.exr")
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        channels = file.channels()
        assert set(channels) == {f"{layer}{c}" for layer in ("", "standard_error.") for c in "RGB"}
        for i, c in enumerate("RGB"):
            assert channels[c].pixels.dtype == np.float32
            assert np.array_equal(channels[c].pixels, picture.rgb[..., i])
            assert np.array_equal(channels[f"standard_error.{c}"].pixels, picture.standard_error[..., i])


@pytest.mark.parametrize("suffix", [".png", ".npy", ".exr"])
def test_check_leaves_nothing_behind_and_spares_what_is_there(tmp_path, suffix):
    path = tmp_path / f"a{suffix}"
    assert rw.io.check_writable(path) == path
    assert list(tmp_path.iterdir()) == []
    path.write_bytes(b"old")
    rw.io.check_writable(str(path))
    assert path.read_bytes() == b"old"


@pytest.mark.parametrize(
    ("path", "error", "message"),
    [
        ("a.gif", ValueError, r"saved as \.png, .*, \.exr, \.npy; .*a\.gif is none of these"),
        ("a", ValueError, r"saved as \.png, "),
        ("gone/a.png", FileNotFoundError, "no such folder: .*gone"),
        ("folder.png", IsADirectoryError, r"is a folder: .*folder\.png"),
        ("file.txt/a.png", NotADirectoryError, r"Not a directory"),
        (f"{'x' * 300}.png", OSError, "File name too long"),
    ],
)
@pytest.mark.parametrize("save", [False, True])
def test_places_that_cannot_be_written(tmp_path, picture, path, error, message, save):
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file.txt").write_text("x")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(error, match=message):
        picture.save(tmp_path / path) if save else rw.io.check_writable(tmp_path / path)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="nothing is denied to root")
@pytest.mark.parametrize("there", [False, True])
def test_folders_and_files_without_permission(tmp_path, there):
    path = tmp_path / "a.png"
    if there:
        path.write_bytes(b"old")
        path.chmod(0o400)
    else:
        tmp_path.chmod(0o500)
    try:
        with pytest.raises(PermissionError, match="Permission denied"):
            rw.io.check_writable(path)
    finally:
        tmp_path.chmod(0o700)


@pytest.mark.parametrize("path", [3, None, b"a.png"])
def test_what_is_no_path_is_told(picture, path):
    for ask in (rw.io.check_writable, picture.save, rw.load):
        with pytest.raises(TypeError, match=f"^path must be a str or a path, got {type(path).__name__}$"):
            ask(path)
