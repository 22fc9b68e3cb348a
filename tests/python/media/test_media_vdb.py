"""Densities and temperatures from OpenVDB's files, which OpenVDB 10 wrote (`vdb_files`)."""

import contextlib
import struct
import sys
import zlib

import numpy as np
import pytest
import vdb_files as given

import raywright as rw
from raywright.media.vdb import _blosc, _Numbers, _Reader

numcodecs = pytest.importorskip("numcodecs")


def chunk_of_blosc(data, **how):
    return numcodecs.Blosc(**how).encode(np.frombuffer(data, "<f4"))


def test_numbers_are_where_openvdb_has_them():
    fire = rw.GridMedium.load(given.SMOKE, absorption=2, temperature="temperature")
    assert fire.at == "centers"
    assert fire.transform is None
    # Values lie in the middle of cells; the cell of index 0 is around the origin of the file.
    low = np.round((np.array(fire.bounds[0]) - given.MOVED) / given.SCALE + 0.5).astype(int)
    assert np.allclose(fire.bounds[0], (low - 0.5) * given.SCALE + given.MOVED, rtol=0, atol=1e-12)
    size = np.subtract(fire.bounds[1], fire.bounds[0]) / given.SCALE
    assert np.array_equal(size, fire.density.shape)
    density, temperature = np.zeros((2, *fire.density.shape), np.float32)
    for grid, begin, numbers in [
        (density, given.LOW, given.density()),
        (density, given.TILE, np.full((8, 8, 8), given.TILED)),
        (temperature, given.HOT_LOW, given.temperature()),
    ]:
        begin = np.subtract(begin, low)
        grid[tuple(slice(a, a + n) for a, n in zip(begin, numbers.shape, strict=True))] = numbers
    assert np.array_equal(fire.density.dense(), density)
    assert np.array_equal(fire.temperature.dense(), temperature)
    placed = rw.GridMedium.load(given.SMOKE, [(0, 0, 0), (1, 1, 1)], density="temperature", at="corners")
    assert placed.bounds == ((0, 0, 0), (1, 1, 1))
    assert placed.at == "corners"


def test_half_precision_and_a_place_that_is_turned():
    cloud = rw.GridMedium.load(str(given.HALF))
    assert np.array_equal(cloud.transform, given.TURNED)
    low = np.add(cloud.bounds[0], 0.5).astype(int)
    assert np.array_equal(np.subtract(cloud.bounds[1], cloud.bounds[0]), cloud.density.shape)
    begin = np.subtract((1, 2, 3), low)
    numbers = cloud.density.dense()
    found = numbers[tuple(slice(a, a + n) for a, n in zip(begin, given.small().shape, strict=True))]
    assert np.array_equal(found, given.small())
    assert numbers.sum() == given.small().sum()


@pytest.mark.parametrize(
    ("said", "rest", "expected"),
    [
        (0, b"", [1.5, 0, 0, 2.5]),
        (2, struct.pack("<f", 7), [1.5, 7, 7, 2.5]),
        (3, bytes([0b0010]), [1.5, 0, 0, 2.5]),
        (4, struct.pack("<f", 7) + bytes([0b0010]), [1.5, 0, 7, 2.5]),
        (5, struct.pack("<ff", 7, 8) + bytes([0b0010]), [1.5, 8, 7, 2.5]),
    ],
)
@pytest.mark.parametrize("compression", [2, 3, 6])
def test_numbers_that_are_left_out_and_how_the_others_are_packed(said, rest, expected, compression):
    """Of a node of eight, of which the last four are not active: as `writeCompressedValues` has them."""
    numbers = np.array([1.5, 2.5], "<f4").tobytes()
    pack = {2: lambda data: data, 3: zlib.compress, 6: chunk_of_blosc}[compression]
    packed = pack(numbers)
    length = b"" if compression == 2 else struct.pack("<q", len(packed))
    file = _Reader(bytes([said]) + rest + length + packed)
    found = _Numbers(file, compression, False).read(8, bytes([0b1001]))
    assert found[:4].tolist() == expected
    # And stored raw, where that is shorter.
    plain = _Reader(bytes([6]) + (b"" if compression == 2 else struct.pack("<q", -32)) + bytes(range(32)))
    assert _Numbers(plain, compression, False).read(8, b"\0").tobytes() == bytes(range(32))


@pytest.mark.parametrize("cname", ["lz4", "lz4hc", "blosclz", "zlib", "zstd"])
@pytest.mark.parametrize("shuffle", [0, 1, 2])
def test_every_codec_within_blosc_is_read(cname, shuffle):
    numbers = np.arange(512, dtype="<f4").tobytes()
    assert _blosc(chunk_of_blosc(numbers, cname=cname, shuffle=shuffle), len(numbers)) == numbers


def test_chunks_of_blosc_that_lie_about_their_size_are_refused():
    """A decoder that believes the header reads beyond the chunk, and writes beyond the node."""
    numbers = np.arange(512, dtype="<f4").tobytes()
    chunk = chunk_of_blosc(numbers)
    for place, said in [(4, 4096), (4, 2**31 - 1), (12, len(chunk) + 1), (12, 2**31 - 1), (12, 16)]:
        lie = bytearray(chunk)
        struct.pack_into("<I", lie, place, said)
        with pytest.raises(ValueError, match="not a Blosc chunk of 2048 bytes"):
            _blosc(bytes(lie), len(numbers))
    for cut in (chunk[:15], chunk[:-1], chunk + b"\0"):
        with pytest.raises(ValueError, match="not a Blosc chunk of 2048 bytes"):
            _blosc(cut, len(numbers))
    with pytest.raises(ValueError, match="cannot be decompressed"):
        _blosc(chunk[:16] + b"\xff" * (len(chunk) - 16), len(numbers))


@pytest.mark.parametrize(
    ("path", "names", "says"),
    [
        (given.HALF, {"density": "wind"}, "the grid 'wind' is a Tree_vec3s_5_4_3, expected floats"),
        (given.HALF, {"density": "around"}, "is 2 where nothing is active"),
        (given.HALF, {"density": "smoke"}, "no grid 'smoke' among 'density', 'wind', 'around', 'elsewhere'"),
        (given.HALF, {"temperature": "elsewhere"}, "'elsewhere' has another transform than 'density'"),
        (given.FOLDER / "mitsuba_blocks.npz", {}, "must be a .npy, a .vol or a .vdb file"),
    ],
)
def test_what_is_not_read_is_refused_by_name(path, names, says):
    with pytest.raises(ValueError, match=says):
        rw.GridMedium.load(path, **names)


def test_names_of_grids_are_those_of_openvdb_alone(tmp_path):
    np.save(tmp_path / "smoke.npy", np.ones((1, 1, 1)))
    with pytest.raises(ValueError, match="temperature must be numbers"):
        rw.GridMedium.load(tmp_path / "smoke.npy", temperature="temperature")
    with pytest.raises(FileNotFoundError):
        rw.GridMedium.load(tmp_path / "smoke.vdb")


def test_damaged_files_are_refused(tmp_path):
    data = given.SMOKE.read_bytes()
    path = tmp_path / "damaged.vdb"
    for length in [0, 7, 8, 40, 100, 300, 600, 5000, 10_000, 40_000, len(data) - 1]:
        path.write_bytes(data[:length])
        with pytest.raises(ValueError, match=r"damaged\.vdb cannot be read") as told:
            rw.GridMedium.load(path, density="density")
        assert "\n" not in str(told.value)
    rng = np.random.default_rng(1)
    for _ in range(60):
        changed = bytearray(data)
        for place in rng.integers(0, 700, 3):
            changed[place] = rng.integers(256)
        path.write_bytes(bytes(changed))
        # A ValueError about the file is right, whatever it says; anything else fails.
        with contextlib.suppress(ValueError):
            rw.GridMedium.load(path)


def test_without_blosc_it_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "numcodecs", None)
    monkeypatch.delitem(sys.modules, "numcodecs.blosc", raising=False)
    with pytest.raises(ImportError, match=r"pip install 'raywright\[vdb\]'"):
        rw.GridMedium.load(given.SMOKE)
