"""EXR files are read as the library reads them that has written them."""

import itertools
import struct
import subprocess
import sys
import zlib

import numpy as np
import pytest

import raywright as rw
from raywright.io.pictures import read

OpenEXR = pytest.importorskip("OpenEXR")
from exr_files import attribute, head, rows, stored, tile, with_chunks, write  # noqa: E402

LOSSLESS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ")
METHODS = (*LOSSLESS, "PXR24", "B44", "B44A", "DWAA", "DWAB")
SIZES = ((1, 1), (1, 37), (37, 1), (67, 45), (33, 130))


def pictures(kind, height, width):
    """Channels R, G, B and A: flat, smooth, noisy, with an A of another type, and of any bits."""
    rng = np.random.default_rng(height + width)
    y, x = np.mgrid[:height, :width] / 50
    scale = 1000 if kind == np.uint32 else 1
    yield {c: np.full((height, width), 7).astype(kind) for c in "RGBA"}
    yield {c: ((x * 3 + y * k) * scale).astype(kind) for k, c in enumerate("RGBA")}
    noisy = {
        c: (np.abs(x + k + rng.normal(0, 0.3, x.shape)) * scale).astype(kind) for k, c in enumerate("RGBA")
    }
    yield noisy | {"A": noisy["A"].astype(np.float32 if kind == np.float16 else np.float16)}
    yield {c: bits_of(rng, kind, (height, width)) for c in "RGBA"}


def bits_of(rng, kind, shape):
    return rng.integers(0, 256, (*shape, np.dtype(kind).itemsize), np.uint8).view(kind)[..., 0]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", [np.float16, np.float32, np.uint32])
def test_every_method_and_number_is_read(tmp_path, method, kind):
    path = tmp_path / "p.exr"
    for (height, width), size in itertools.product(SIZES, (None, (16, 20))):
        for number, channels in enumerate(pictures(kind, height, width)):
            if number == 3 and method.startswith("DWA"):
                # Cosines of any bits are infinite.
                continue
            write(path, channels, method, size)
            found, same = read(path), stored(path, "RGBA")
            assert (found.dtype, found.shape) == (np.float32, (height, width, 4))
            if method.startswith("DWA"):
                # Its cosines are sums of floats, rounded to halves.
                agree = (found == same) | (np.isnan(found) & np.isnan(same))
                assert np.mean(agree) > 0.95
                assert np.allclose(found, same, rtol=0.01, atol=1e-3, equal_nan=True)
            else:
                assert np.array_equal(found, same, equal_nan=True)
            if method in LOSSLESS:
                expected = np.stack([channels[c].astype(np.float32) for c in "RGBA"], -1)
                assert np.array_equal(found, expected, equal_nan=True)


@pytest.mark.parametrize("method", METHODS)
def test_many_chunks_are_read_in_threads(tmp_path, method):
    rng = np.random.default_rng(2)
    image = rng.uniform(0, 2, (600, 300, 3)).astype(np.float32)
    write(tmp_path / "p.exr", {c: np.ascontiguousarray(image[..., k]) for k, c in enumerate("RGB")}, method)
    found, same = read(tmp_path / "p.exr"), stored(tmp_path / "p.exr", "RGB")
    if method.startswith("DWA"):
        assert np.mean(found == same) > 0.99
        np.testing.assert_allclose(found, same, rtol=0.01, atol=1e-3)
    else:
        assert np.array_equal(found, same)


@pytest.mark.parametrize("method", ["B44", "B44A", "DWAA"])
def test_perceptually_linear_channels(tmp_path, method):
    y, x = np.mgrid[:21, :34] / 20
    made = {c: OpenEXR.Channel((x * k + y).astype(np.float16), 1, 1, c != "G") for k, c in enumerate("RGB")}
    write(tmp_path / "p.exr", made, method)
    assert np.allclose(read(tmp_path / "p.exr"), stored(tmp_path / "p.exr", "RGB"), rtol=2e-3)
    if method != "DWAA":
        assert np.array_equal(read(tmp_path / "p.exr"), stored(tmp_path / "p.exr", "RGB"))
    write(tmp_path / "g.exr", {"Y": made["R"]}, method)
    assert np.allclose(read(tmp_path / "g.exr"), stored(tmp_path / "g.exr", "Y"), rtol=2e-3)


@pytest.mark.parametrize("size", [None, (16, 16)])
def test_windows_and_orders_of_lines(tmp_path, size):
    pixels = np.random.default_rng(3).uniform(0, 1, (50, 20)).astype(np.float32)
    corner = np.int32([-7, 11])
    window = (corner, corner + np.int32([19, 49]))
    for order in (OpenEXR.INCREASING_Y, OpenEXR.DECREASING_Y):
        windows = {"dataWindow": window, "displayWindow": window}
        write(tmp_path / "w.exr", {"Y": pixels}, "ZIP", size, **windows, lineOrder=order)
        assert np.array_equal(read(tmp_path / "w.exr")[..., 0], pixels)


def parts(tmp_path, *kinds):
    """Write parts, of which each is a picture of its number, and return the path."""
    made = []
    for number, kind in enumerate(kinds):
        header = {"name": f"part {number}", "type": kind, "compression": OpenEXR.ZIPS_COMPRESSION}
        pixels = np.full((40, 30), number, np.float32)
        if kind == OpenEXR.deepscanline:
            deep = np.empty(pixels.shape, object)
            for at in np.ndindex(pixels.shape):
                deep[at] = np.float32([1, 2])
            pixels = deep
        if kind == OpenEXR.tiledimage:
            header["tiles"] = OpenEXR.TileDescription()
            header["tiles"].xSize = header["tiles"].ySize = 16
        made.append(OpenEXR.Part(header, {"Y": pixels}))
    with OpenEXR.File(made) as file:
        file.write(str(tmp_path / "parts.exr"))
    return tmp_path / "parts.exr"


@pytest.mark.parametrize("first", [OpenEXR.scanlineimage, OpenEXR.tiledimage])
def test_the_first_part_is_read(tmp_path, first):
    path = parts(tmp_path, first, OpenEXR.scanlineimage, OpenEXR.tiledimage)
    assert np.array_equal(read(path), np.zeros((40, 30, 1)))


def test_deep_parts_are_passed_over(tmp_path):
    path = parts(tmp_path, OpenEXR.deepscanline, OpenEXR.scanlineimage)
    assert np.array_equal(read(path), np.ones((40, 30, 1)))
    assert "it has deep pixels" in refusal(parts(tmp_path, OpenEXR.deepscanline))


@pytest.mark.parametrize("mode", [1, 2])
def test_of_many_levels_the_largest_is_read(tmp_path, mode):
    pixels = np.random.default_rng(4).uniform(0, 1, (6, 5)).astype(np.float32)
    # Levels are 5 x 6, 2 x 3 and 1 x 1, or any of the widths by any of the heights, in tiles of 4 x 4.
    sizes = [(5, 6), (2, 3), (1, 1)]
    levels = [(k, k) for k in range(3)] if mode == 1 else [(x, y) for y in range(3) for x in range(3)]
    chunks = []
    for level in levels:
        width, height = sizes[level[0]][0], sizes[level[1]][1]
        image = pixels if level == (0, 0) else np.full((height, width), 9, np.float32)
        for y, x in itertools.product(range(0, height, 4), range(0, width, 4)):
            chunks.append(tile(x // 4, y // 4, level, image[y : y + 4, x : x + 4].tobytes()))
    more = attribute("tiles", "tiledesc", struct.pack("<2IB", 4, 4, mode))
    path = tmp_path / "levels.exr"
    path.write_bytes(with_chunks(head(5, 6, "Y", flags=0x200, more=more), chunks))
    assert np.array_equal(stored(path, "Y")[..., 0], pixels)
    assert np.array_equal(read(path)[..., 0], pixels)


def test_grays_and_missing_channels(tmp_path):
    gray = np.linspace(0, 2, 12, dtype=np.float32).reshape(3, 4)
    for names, shape in ((("Y",), (3, 4, 1)), (("Y", "A"), (3, 4, 2))):
        write(tmp_path / "g.exr", dict.fromkeys(names, gray))
        assert read(tmp_path / "g.exr").shape == shape
    write(tmp_path / "g.exr", {"R": gray, "B": gray})
    with pytest.raises(ValueError, match="it has no channel G, only B, R"):
        read(tmp_path / "g.exr")


def test_an_environment_is_read_and_saved_without_the_library(tmp_path):
    image = np.random.default_rng(2).uniform(0, 3, (8, 16, 3)).astype(np.float32)
    channels = {name: np.ascontiguousarray(image[..., k]) for k, name in enumerate("RGB")}
    write(tmp_path / "sky.exr", channels, "PIZ")
    assert np.array_equal(rw.EnvironmentMap(tmp_path / "sky.exr").image, image)
    code = (
        "import sys; sys.modules['OpenEXR'] = None\n"
        "import raywright as rw; print(rw.EnvironmentMap('sky.exr').image.sum())\n"
        "rw.render(*rw.scenes.cornell_box(width=4, height=4), samples=1, progress=False).save('a.exr')"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(float(image.sum()), rel=1e-5)
    assert stored(tmp_path / "a.exr", "RGB").shape == (4, 4, 3)


def refusal(path):
    """What is said of a file; nothing if it can be read."""
    try:
        read(path)
    except ValueError as error:
        return str(error)
    return ""


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("size", [None, (16, 20)])
def test_broken_bytes_are_told_in_one_line(tmp_path, method, size):
    rng = np.random.default_rng(1)
    path = tmp_path / "b.exr"
    smooth = (np.add.outer(np.arange(40), np.arange(30)) / 8 + rng.uniform(0, 0.1, (40, 30))).astype(
        np.float16
    )
    write(path, {"Y": smooth, "A": smooth}, method, size)
    data = bytearray(path.read_bytes())
    refused = 0
    for number in range(100):
        broken = bytearray(data)
        # Half of them in the packed data.
        for place in rng.integers(8 if number % 2 else len(data) // 2, len(data), 3):
            broken[place] = rng.integers(256)
        path.write_bytes(bytes(broken))
        told = refusal(path)
        assert "\n" not in told
        assert "Error" not in told
        refused += bool(told)
    assert refused > 10


def chunks_of(count, data=bytes(12)):
    return [rows(k, data) for k in range(count)]


ZEROS = zlib.compress(bytes(10**7))
# A chunk of DWA with Y as it is, and A as no runs, which expand to all of the bomb.
FOUR = zlib.compress(bytes(4))
NO_RUNS = struct.pack("<11QH2s2B", 2, 4, len(FOUR), 0, 0, len(ZEROS), 0, 4, 0, 0, 0, 6, b"A", 2 << 2, 2)
ONE = head(1, 2)
BROKEN = {
    "given twice": (with_chunks(head(1, 3), chunks_of(3), (0, 1, 1)), "chunk 2 is in no place of its own"),
    "another row": (with_chunks(ONE, [rows(0, bytes(12)), rows(2, bytes(12))]), "chunk 1 is in no place"),
    "too few": (with_chunks(ONE, [rows(0, bytes(12)), rows(1, bytes(11))]), "chunk 1 has 11 bytes, too few"),
    "too many": (with_chunks(ONE, chunks_of(2, bytes(13))), "chunk 0 is broken: its length is wrong"),
    "a bomb": (with_chunks(head(1, 1, compression=3), [rows(0, ZEROS)]), "its length is wrong"),
    "a bomb of runs": (
        with_chunks(head(1, 1, "AY", compression=8), [rows(0, NO_RUNS + FOUR + ZEROS)]),
        "chunk 0 is broken: its length is wrong",
    ),
    "no zlib": (with_chunks(head(9, 1, compression=3), [rows(0, b"x" * 50)]), "its zlib stream is broken"),
    "subsampled": (with_chunks(head(4, 2, sampling=3), chunks_of(2)), "its channel B is subsampled by 3 x 3"),
    "unknown type": (with_chunks(head(1, 1, kind=3), chunks_of(1)), "its channel B has an unknown type"),
    "no channels": (with_chunks(head(1, 1, names=""), chunks_of(1)), "it has no channels"),
    "HTJ2K": (with_chunks(head(1, 1, compression=10), chunks_of(1)), "its compression is number 10"),
    "deep": (with_chunks(head(1, 1, flags=0x800), chunks_of(1)), "it has deep pixels"),
    "no tiles": (with_chunks(head(1, 1, flags=0x200), chunks_of(1)), "its header has no tile size"),
    "cut parts": (head(1, 1, flags=0x1000), "it is cut short within its header"),
}  # fmt: skip


@pytest.mark.parametrize("what", BROKEN)
def test_what_is_wrong_is_named(tmp_path, what):
    data, message = BROKEN[what]
    (tmp_path / "b.exr").write_bytes(data)
    assert message in refusal(tmp_path / "b.exr")
