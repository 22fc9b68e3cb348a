"""Windows, primaries, and luminance and chroma of EXR files."""

import struct
import zlib

import numpy as np
import pytest
from exr_files import MAGIC, attribute, rows, with_chunks

import raywright as rw
from raywright.io.pictures import read

REC_709 = (0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329)
REC_2020 = (0.708, 0.292, 0.17, 0.797, 0.131, 0.046, 0.3127, 0.329)
ACES = (0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767)
XYZ = (1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 1 / 3, 1 / 3)
# ITU-R BT.2087-0, table 3: from Rec. 2020 to Rec. 709.
TO_709 = np.array([(1.6605, -0.5876, -0.0728), (-0.1246, 1.1329, -0.0083), (-0.0182, -0.1006, 1.1187)])
# The standard matrix from X, Y and Z to Rec. 709 (IEC 61966-2-1).
FROM_XYZ = np.array([(3.2406, -1.5372, -0.4986), (-0.9689, 1.8758, 0.0415), (0.0557, -0.2040, 1.0570)])


def packed(raw, method):
    """Bytes as a method stores them, in order of their halves and as differences."""
    if method == 0:
        return raw
    data = np.frombuffer(raw, np.uint8)
    halves = np.concatenate([data[0::2], data[1::2]])
    halves[1:] -= halves[:-1] + np.uint8(128)
    if method == 1:
        # Only literal runs, of 127 bytes at most.
        parts = [halves[k : k + 127].tobytes() for k in range(0, len(halves), 127)]
        found = b"".join(struct.pack("b", -len(part)) + part for part in parts)
    else:
        found = zlib.compress(halves.tobytes())
    return found if len(found) < len(raw) else raw


def exr(channels, method=0, data=None, display=None, primaries=None, sampling=None):
    """A file of float channels, (H, W) arrays by name; those of `sampling` have fewer samples."""
    sampling = sampling or {}
    full = next(array for name, array in channels.items() if name not in sampling)
    height, width = full.shape
    left, top = data or (0, 0)
    listed = b""
    for name in sorted(channels):
        x, y = sampling.get(name, (1, 1))
        listed += name.encode() + b"\0" + struct.pack("<iB3x2i", 2, 0, x, y)
    window = struct.pack("<4i", left, top, left + width - 1, top + height - 1)
    head = attribute("channels", "chlist", listed + b"\0")
    head += attribute("compression", "compression", bytes([method]))
    head += attribute("dataWindow", "box2i", window)
    head += attribute("displayWindow", "box2i", window if display is None else struct.pack("<4i", *display))
    if primaries is not None:
        head += attribute("chromaticities", "chromaticities", struct.pack("<8f", *primaries))
    chunks, lines = [], (1, 1, 1, 16)[method]
    for first in range(0, height, lines):
        raw = b""
        for y in range(first, min(first + lines, height)):
            for name in sorted(channels):
                step = sampling.get(name, (1, 1))[1]
                if y % step == 0:
                    raw += np.ascontiguousarray(channels[name][y // step], "<f4").tobytes()
        chunks.append(rows(top + first, packed(raw, method)))
    return with_chunks(MAGIC + struct.pack("<I", 2) + head + b"\0", chunks)


def opened(tmp_path, *given, **told):
    (tmp_path / "a.exr").write_bytes(exr(*given, **told))
    return read(tmp_path / "a.exr")


GRAY = np.random.default_rng(0).uniform(0.1, 2, (20, 30)).astype(np.float32)


@pytest.mark.parametrize("method", [0, 1, 2, 3])
@pytest.mark.parametrize(
    ("data", "display"),
    [
        ((0, 0), (0, 0, 29, 19)),
        ((5, -3), (5, -3, 34, 16)),
        ((0, 0), (4, 2, 20, 11)),
        ((0, 0), (-4, -2, 33, 24)),
        ((10, 6), (0, 0, 31, 15)),
        ((-7, 11), (0, 0, 19, 49)),
        ((0, 0), (29, 19, 40, 40)),
        ((0, 0), (30, 0, 40, 19)),
        ((0, 0), (0, -40, 29, -1)),
        ((0, 0), (-900, -900, -899, -890)),
    ],
)
def test_the_picture_is_what_the_display_window_shows(tmp_path, method, data, display):
    found = opened(tmp_path, {"Y": GRAY}, method, data, display)
    left, top, right, bottom = display
    wanted = np.zeros((bottom - top + 1, right - left + 1), np.float32)
    for y, x in np.ndindex(wanted.shape):
        row, column = top + y - data[1], left + x - data[0]
        if 0 <= row < 20 and 0 <= column < 30:
            wanted[y, x] = GRAY[row, column]
    assert np.array_equal(found[..., 0], wanted)


def test_windows_that_are_none_are_passed_over_and_great_ones_refused(tmp_path):
    assert np.array_equal(opened(tmp_path, {"Y": GRAY}, display=(0, 0, -1, 5))[..., 0], GRAY)
    with pytest.raises(ValueError, match="1000000000 x 1000000000 points"):
        opened(tmp_path, {"Y": GRAY}, display=(0, 0, 10**9 - 1, 10**9 - 1))


def colors(image):
    return {name: image[..., k] for k, name in enumerate("RGB")}


IMAGE = np.random.default_rng(1).uniform(0, 1, (6, 8, 3)).astype(np.float32)


@pytest.mark.parametrize(
    ("primaries", "matrix"), [(REC_709, np.eye(3)), (None, np.eye(3)), (REC_2020, TO_709), (XYZ, FROM_XYZ)]
)
def test_colors_are_those_of_rec_709(tmp_path, primaries, matrix):
    found = opened(tmp_path, colors(IMAGE), primaries=primaries)
    # The matrices have four digits, and one of them those of its white.
    assert np.allclose(found, IMAGE @ matrix.T, rtol=0, atol=3e-3 if primaries == XYZ else 3e-4)
    if matrix[0, 1] == 0:
        assert np.array_equal(found, IMAGE)


@pytest.mark.parametrize("primaries", [REC_2020, ACES, XYZ])
def test_primaries_have_the_places_that_the_file_tells(tmp_path, primaries):
    """Red, green, blue and white, taken to CIE's x and y by Rec. 709."""
    image = np.array([[(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)]], np.float32)
    found = opened(tmp_path, colors(image), primaries=primaries)[0].astype(np.float64)
    xyz = found @ np.linalg.inv(FROM_XYZ).T
    assert np.allclose(
        xyz[:, :2] / xyz.sum(axis=1)[:, None], np.reshape(primaries, (4, 2)), rtol=0, atol=2e-3
    )
    assert xyz[3, 1] == pytest.approx(1, abs=1e-3)


def test_alpha_and_depth_are_no_colors(tmp_path):
    alpha = IMAGE[..., 0] * 0.5
    found = opened(tmp_path, {**colors(IMAGE), "A": alpha}, primaries=REC_2020)
    assert np.array_equal(found[..., 3], alpha)
    assert np.array_equal(opened(tmp_path, {"Y": GRAY}, primaries=REC_2020)[..., 0], GRAY)


@pytest.mark.parametrize("primaries", [(0.0,) * 8, (0.3, 0.3) * 4, (np.nan,) * 8])
def test_chromaticities_that_are_none_are_told(tmp_path, primaries):
    with pytest.raises(ValueError, match="its chromaticities are not colors"):
        opened(tmp_path, colors(IMAGE), primaries=primaries)


HALF = {"RY": (2, 2), "BY": (2, 2)}


@pytest.mark.parametrize("method", [0, 1, 2, 3])
@pytest.mark.parametrize("corner", [(0, 0), (-4, 6)])
def test_luminance_and_chroma(tmp_path, method, corner):
    """Chroma that is the same everywhere is so exactly: R = (1 + .25) Y, B = (1 - .5) Y."""
    chroma = {"RY": np.full((10, 15), 0.25), "BY": np.full((10, 15), -0.5)}
    found = opened(tmp_path, {"Y": GRAY, **chroma}, method, corner, sampling=HALF)
    assert found.shape == (20, 30, 3)
    assert np.allclose(found[..., 0], 1.25 * GRAY, rtol=1e-6)
    assert np.allclose(found[..., 2], 0.5 * GRAY, rtol=1e-6)
    weights = np.linalg.inv(FROM_XYZ)[1]
    assert np.allclose(found @ weights, GRAY, rtol=1e-3)


@pytest.mark.parametrize("step", [(2, 2), (2, 1), (1, 2), (4, 4), (1, 1)])
def test_chroma_is_exact_at_its_samples_and_smooth_between(tmp_path, step):
    y, x = np.mgrid[:24, :32] / 24
    luminance, red, blue = 1 + x + y, np.sin(3 * x) * 0.3, np.cos(2 * y) * 0.2
    chroma = {"RY": red[:: step[1], :: step[0]], "BY": blue[:: step[1], :: step[0]]}
    sampling = {} if step == (1, 1) else dict.fromkeys(chroma, step)
    found = opened(tmp_path, {"Y": luminance, **chroma}, 3, sampling=sampling)
    at = found[:: step[1], :: step[0], 0] / luminance[:: step[1], :: step[0]] - 1
    assert np.allclose(at, chroma["RY"], rtol=0, atol=1e-6)
    inside = np.s_[8:16, 12:20]
    # OpenEXR's filter passes smooth chroma to some thousandths. Wider steps are interpolated linearly, to
    # an eighth of the step's square times the second derivative.
    near = 5e-4 if max(step) <= 2 else (4 / 24) ** 2 * 9 * 0.3 / 8
    assert np.allclose((found[..., 0] / luminance - 1)[inside], red[inside], rtol=0, atol=near)
    assert np.allclose((found[..., 2] / luminance - 1)[inside], blue[inside], rtol=0, atol=near)


def test_luminance_has_the_weights_of_its_primaries(tmp_path):
    """Of X, Y and Z in place of red, green and blue, Y is the luminance."""
    chroma = {"RY": np.full((10, 15), 0.25), "BY": np.full((10, 15), -0.5)}
    found = opened(tmp_path, {"Y": GRAY, **chroma}, sampling=HALF, primaries=XYZ)
    wanted = GRAY[..., None] * (FROM_XYZ @ (1.25, 1.0, 0.5))
    assert np.allclose(found, wanted, rtol=2e-3)


@pytest.mark.parametrize(
    ("corner", "sampling", "message"),
    [
        ((1, 0), (2, 2), "its channel BY is subsampled by 2 x 2, which does not divide its window"),
        ((0, 0), (4, 3), "its channel BY is subsampled by 4 x 3, which does not divide its window"),
        ((0, 0), (0, 1), "its channel BY is subsampled by 0 x 1"),
        ((0, 0), (1000, 1), "its channel BY is subsampled by 1000 x 1"),
    ],
)
def test_samples_that_do_not_fit_are_told(tmp_path, corner, sampling, message):
    chroma = dict.fromkeys(("RY", "BY"), np.zeros((20, 15)))
    data = exr({"Y": GRAY, **chroma}, data=corner, sampling=HALF)
    data = data.replace(struct.pack("<2i", 2, 2), struct.pack("<2i", *sampling))
    (tmp_path / "a.exr").write_bytes(data)
    with pytest.raises(ValueError, match=message):
        read(tmp_path / "a.exr")


def test_environments_of_wide_colors_are_clamped(tmp_path):
    (tmp_path / "a.exr").write_bytes(exr(colors(IMAGE), primaries=REC_2020))
    found = read(tmp_path / "a.exr")
    assert found.min() < -0.1
    with pytest.warns(RuntimeWarning, match=rf"image: {(found < 0).sum()} negative values"):
        light = rw.EnvironmentMap(tmp_path / "a.exr")
    assert np.array_equal(light.image, np.maximum(found, 0))
