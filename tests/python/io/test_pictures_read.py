"""What pictures of files hold: transparency, integers of many sizes, and Radiance's own files."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image

import raywright as rw
from raywright.io.pictures import read, read_linear


def png(depth, kind, rows, transparent):
    """A PNG of rows of samples, with its tRNS."""
    width = len(rows[0]) // (3 if kind == 2 else 1)
    body = b""
    for row in rows:
        bits = "".join(f"{sample:0{depth}b}" for sample in row)
        bits += "0" * (-len(bits) % 8)
        body += b"\0" + bytes(int(bits[k : k + 8], 2) for k in range(0, len(bits), 8))
    parts = [b"IHDR" + struct.pack(">IIBBBBB", width, len(rows), depth, kind, 0, 0, 0)]
    parts += [b"tRNS" + struct.pack(f">{len(transparent)}H", *transparent)]
    parts += [b"IDAT" + zlib.compress(body), b"IEND"]
    chunks = [struct.pack(">I", len(one) - 4) + one + struct.pack(">I", zlib.crc32(one)) for one in parts]
    return b"\x89PNG\r\n\x1a\n" + b"".join(chunks)


@pytest.mark.parametrize("depth", [1, 2, 4, 8, 16])
def test_one_gray_of_a_png_is_transparent(tmp_path, depth):
    most = 2**depth - 1
    for key in {0, 1, most // 2, most}:
        rows = [[0, key, most], [most, 0, key]]
        (tmp_path / "a.png").write_bytes(png(depth, 0, rows, [key]))
        found = read(tmp_path / "a.png")
        assert found.shape == (2, 3, 2)
        full = np.iinfo(found.dtype).max
        assert np.array_equal(found[..., 0], np.array(rows) * (full // most))
        assert np.array_equal(found[..., 1], np.where(np.array(rows) == key, 0, full))


@pytest.mark.parametrize("depth", [8, 16])
def test_one_color_of_a_png_is_transparent(tmp_path, depth):
    unit = 1 if depth == 8 else 257
    pixels = np.array([[(255, 0, 0), (255, 0, 1)], [(0, 0, 255), (255, 0, 0)]])
    (tmp_path / "a.png").write_bytes(
        png(depth, 2, (pixels.reshape(2, -1) * unit).tolist(), [255 * unit, 0, 0])
    )
    found = read(tmp_path / "a.png")
    assert np.array_equal(found[..., :3], pixels)
    assert found[..., 3].tolist() == [[0, 255], [255, 0]]


def test_palettes_keep_their_alpha(tmp_path):
    picture = Image.new("P", (2, 1))
    picture.putpalette([255, 0, 0, 0, 255, 0])
    picture.putdata([0, 1])
    picture.save(tmp_path / "a.png", transparency=1)
    assert read(tmp_path / "a.png").tolist() == [[[255, 0, 0, 255], [0, 255, 0, 0]]]


def test_pictures_without_transparency_have_no_alpha(tmp_path):
    for mode, channels in (("L", 1), ("RGB", 3), ("1", 3), ("I;16", 1)):
        Image.new(mode, (2, 2)).save(tmp_path / "a.png")
        assert read(tmp_path / "a.png").shape == (2, 2, channels)


def tiff(array, samples):
    """A TIFF of one row of integers of 32 bits."""
    tags = [(256, array.size), (257, 1), (258, 32), (259, 1), (262, 1), (273, 8 + 2 + 12 * 10 + 4)]
    tags += [(277, 1), (278, 1), (279, 4 * array.size), (339, samples)]
    head = b"II*\0\x08\0\0\0" + struct.pack("<H", len(tags))
    return head + b"".join(struct.pack("<HHII", tag, 4, 1, n) for tag, n in tags) + bytes(4) + array.tobytes()


def test_integers_of_32_bits_are_shares_of_the_most_they_hold(tmp_path):
    path = tmp_path / "a.tif"
    unsigned = np.array([0, 65535, 65536, 65537 * 1000, 2**31, 2**32 - 1], np.uint32)
    path.write_bytes(tiff(unsigned, 1))
    assert read(path)[0, :, 0].tolist() == [0, 1, 1, 1000, 32768, 65535]
    signed = np.array([0, -5, 65536, 2**30, 2**31 - 1], np.int32)
    path.write_bytes(tiff(signed, 2))
    assert read(path)[0, :, 0].tolist() == [0, 0, 2, 32768, 65535]
    Image.fromarray(signed[None]).save(path)
    assert read(path)[0, :, 0].tolist() == [0, 0, 2, 32768, 65535]
    # The same pixels without a file.
    from raywright.io.pictures import pixels_of

    assert pixels_of(Image.fromarray(signed[None]))[0, :, 0].tolist() == [0, 0, 2, 32768, 65535]


def test_integers_of_16_bits_are_kept(tmp_path):
    array = np.arange(0, 65536, 257, dtype=np.uint16).reshape(16, 16)
    for name in ("a.png", "a.tif"):
        Image.fromarray(array).save(tmp_path / name)
        assert np.array_equal(read(tmp_path / name)[..., 0], array)


HEAD = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"
# 2, 1 and 0.
PIXEL = bytes((128, 64, 0, 130))


def hdr(path, body, more=b"", size=b"-Y 1 +X 3"):
    path.write_bytes(HEAD + more + b"\n" + size + b"\n" + body)
    return path


@pytest.mark.parametrize(
    ("more", "factor"),
    [
        (b"", (1, 1, 1)),
        (b"EXPOSURE=4\n", (0.25, 0.25, 0.25)),
        (b"EXPOSURE= 4.0\nEXPOSURE=\t.5\n", (0.5, 0.5, 0.5)),
        (b"EXPOSURE=2\nCOLORCORR= 1 2 4\n", (0.5, 0.25, 0.125)),
        (b"# EXPOSURE=2\nVIEW= -vtv\n", (1, 1, 1)),
        (b"EXPOSURE=2\r\n", (0.5, 0.5, 0.5)),
    ],
)
def test_radiances_are_what_they_were_before_the_exposure(tmp_path, more, factor):
    found = read_linear(hdr(tmp_path / "a.hdr", PIXEL * 3, more))
    assert np.array_equal(found, np.tile(np.float32((2, 1, 0)) * np.float32(factor), (1, 3, 1)))
    scene = rw.EnvironmentMap(tmp_path / "a.hdr")
    assert np.array_equal(scene.image, found)


@pytest.mark.parametrize("exposure", [b"0", b"-1", b"nan", b"x", b"1 2", b""])
def test_exposures_that_are_none_are_told(tmp_path, exposure):
    with pytest.raises(ValueError, match=r"a\.hdr .*its EXPOSURE must be positive numbers"):
        read(hdr(tmp_path / "a.hdr", PIXEL * 3, b"EXPOSURE=" + exposure + b"\n"))


@pytest.mark.parametrize(
    ("width", "body", "columns"),
    [
        (5, PIXEL + bytes((1, 1, 1, 4)), [1, 1, 1, 1, 1]),
        (5, PIXEL + bytes((1, 1, 1, 2)) + bytes(4) + PIXEL, [1, 1, 1, 0, 1]),
        # The second run counts 256 times.
        (3 + 512, PIXEL + bytes((1, 1, 1, 1, 1, 1, 1, 2)) + bytes(4), [1] * 514 + [0]),
        (20, PIXEL + bytes((1, 1, 1, 9)) + bytes(4) + bytes((1, 1, 1, 9)), [1] * 10 + [0] * 10),
        (3, PIXEL * 3, [1, 1, 1]),
    ],
)
def test_runs_of_the_old_encoding(tmp_path, width, body, columns):
    path = hdr(tmp_path / "a.hdr", body * 2, size=b"-Y 2 +X %d" % width)
    wanted = np.array(columns, np.float32)[None, :, None] * np.float32((2, 1, 0))
    assert np.array_equal(read_linear(path), np.repeat(wanted, 2, axis=0))
    for wrong in (body * 2)[:-1], body + bytes((1, 1, 1, 255)) * 2:
        with pytest.raises(ValueError, match="cut short"):
            read(hdr(path, wrong, size=b"-Y 2 +X %d" % width))


@pytest.mark.parametrize("rows", [b"-Y", b"+Y"])
@pytest.mark.parametrize("columns", [b"+X", b"-X"])
@pytest.mark.parametrize("is_tall", [False, True])
def test_rows_go_any_way(tmp_path, rows, columns, is_tall):
    levels = np.arange(6, dtype=np.uint8).reshape(2, 3) + 2
    pixels = np.stack([levels, levels, levels, np.full_like(levels, 136)], -1)
    stored = pixels[:: -1 if rows == b"+Y" else 1, :: -1 if columns == b"-X" else 1]
    sizes = [rows + b" 2", columns + b" 3"]
    if is_tall:
        stored, sizes = stored.transpose(1, 0, 2), sizes[::-1]
    found = read_linear(hdr(tmp_path / "a.hdr", stored.tobytes(), size=b" ".join(sizes)))
    assert np.array_equal(found[..., 0], levels)


def test_environments_lose_what_is_hardly_negative(tmp_path):
    image = np.full((4, 8, 3), 0.5, np.float32)
    image[1, 2] = (-6e-6, 0.5, -1e-9)
    with pytest.warns(
        RuntimeWarning, match=r"image: 2 negative values, the least of them -6e-06, are taken as 0"
    ):
        found = rw.EnvironmentMap(image)
    assert np.array_equal(found.image, np.maximum(image, 0))
    np.save(tmp_path / "a.npy", image)
    with pytest.warns(RuntimeWarning, match="2 negative values"):
        assert rw.EnvironmentMap(tmp_path / "a.npy") == found
    with pytest.warns(RuntimeWarning, match="2 negative values"):
        assert rw.ProjectorLight(image, (0, 0, 0), (0, 0, -1)).image.min() == 0
    image[1, 2] = -1
    with pytest.raises(
        ValueError, match=r"image must be finite and at least 0, got \[-1.0, -1.0, -1.0\] in row 1"
    ):
        rw.EnvironmentMap(image)
    image[1, 2] = (-1e-9, np.nan, 0)
    with pytest.raises(ValueError, match="image must be finite"):
        rw.EnvironmentMap(image)
    with pytest.raises(ValueError, match="image must be finite and at least 0"):
        rw.EnvironmentMap(np.full((2, 2), -1e-9))
