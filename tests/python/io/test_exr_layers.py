"""EXR files that are saved: their layers, and that OpenEXR reads the bits that were written."""

import json

import numpy as np
import OpenEXR
import pytest
from exr_files import write

import raywright as rw
from raywright.io.cryptomatte import identity, murmur3
from raywright.io.exr.writer import write_exr
from raywright.io.pictures import read


@pytest.mark.parametrize(
    ("text", "expected"),
    # Values of Appleby's own code.
    [
        ("", 0),
        ("test", 0xBA6BD213),
        ("Hello, world!", 0xC0363E43),
        ("The quick brown fox jumps over the lazy dog", 0x2E4FF723),
    ],
)
def test_names_hash_as_murmur3(text, expected):
    assert murmur3(text.encode()) == expected


def test_identities_are_normal_numbers():
    bits = np.array([identity(f"shape {i}") for i in range(2000)], np.uint32)
    numbers = bits.view(np.float32)
    assert np.isfinite(numbers).all()
    assert (np.abs(numbers) >= np.finfo(np.float32).tiny).all()
    assert len(set(bits.tolist())) == 2000


@pytest.fixture(scope="module")
def saved(tmp_path_factory):
    scene, camera = rw.scenes.cornell_box(width=12, height=9)
    image = rw.render(scene, camera, samples=8, adaptive=True, aov=rw.rendering.AOVS, progress=False)
    path = tmp_path_factory.mktemp("exr") / "a.exr"
    image.save(path)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return image, {name: one.pixels for name, one in file.channels().items()}, dict(file.header())


def test_every_aov_is_a_layer(saved):
    image, channels, _ = saved
    names = {
        "depth": "Z", "position": "XYZ", "normal": "XYZ", "shading_normal": "XYZ", "uv": "UV",
        "albedo": "RGB", "motion": "XYZ", "screen_motion": "XY", "alpha": "A", "shape_id": "X",
        "primitive_id": "X", "samples": "X", "standard_error": "RGB",
    }  # fmt: skip
    expected = {*"RGB"} | {f"{layer}.{c}" for layer, all_ in names.items() for c in all_}
    assert set(channels) == expected | {f"CryptoObject{i:02}.{c}" for i in range(3) for c in "RGBA"}
    for layer in names.keys() - {"standard_error"}:
        array = image.aov[layer]
        deep = array if array.ndim == 3 else array[..., None]
        for i, c in enumerate(names[layer]):
            found = channels[f"{layer}.{c}"]
            assert found.dtype == (np.float32 if array.dtype == np.float32 else np.uint32)
            assert np.array_equal(found, deep[..., i].astype(found.dtype))


def test_shapes_are_told_as_cryptomatte(saved):
    image, channels, header = saved
    (key,) = {name.split("/")[1] for name in header if name.startswith("cryptomatte/")}
    assert key == f"{murmur3(b'CryptoObject'):08x}"[:7]
    assert header[f"cryptomatte/{key}/name"] == "CryptoObject"
    assert header[f"cryptomatte/{key}/hash"] == "MurmurHash3_32"
    assert header[f"cryptomatte/{key}/conversion"] == "uint32_to_float32"
    manifest = json.loads(header[f"cryptomatte/{key}/manifest"])
    ranked = image.aov["cryptomatte"]
    assert set(manifest) == {f"shape {int(n)}" for n in np.unique(ranked[..., 0]) if n >= 0}
    for name, bits in manifest.items():
        mask = np.zeros(image.rgb.shape[:2])
        for i in range(3):
            for id_, cover in ("RG", "BA"):
                same = channels[f"CryptoObject{i:02}.{id_}"].view(np.uint32) == int(bits, 16)
                mask += np.where(same, channels[f"CryptoObject{i:02}.{cover}"], 0)
        mine = np.where(ranked[..., 0] == int(name.split()[1]), ranked[..., 1], 0).sum(axis=-1)
        np.testing.assert_allclose(mask, mine, atol=1e-7)


@pytest.mark.parametrize("size", [(1, 1), (1, 33), (33, 1), (16, 7), (47, 20), (500, 130)])
def test_every_bit_is_read_again(tmp_path, size):
    rng = np.random.default_rng(sum(size))
    smooth = np.add.outer(np.arange(size[0]), np.arange(size[1])).astype(np.float32)
    channels = {c: rng.integers(0, 2**32, size, np.uint32).view(np.float32) for c in "RGBA"}
    channels |= {
        "depth.Z": smooth,
        "id.X": rng.integers(0, 2**32, size, np.uint32),
        "z" * 200: smooth.T.copy().T,
    }
    write_exr(tmp_path / "a.exr", channels, {"comments": "größer", "n" * 200: ""})
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        found = {name: one.pixels for name, one in file.channels().items()}
        header = dict(file.header())
    assert set(found) == set(channels)
    for name, array in channels.items():
        assert found[name].dtype == array.dtype
        assert np.array_equal(found[name].view(np.uint32), array.view(np.uint32))
    assert header["comments"] == "größer"
    assert header["n" * 200] == ""
    same = np.stack([channels[c] for c in "RGBA"], -1)
    assert np.array_equal(read(tmp_path / "a.exr"), same, equal_nan=True)


def test_the_header_is_that_of_the_library(tmp_path):
    channels = {c: np.ones((5, 3), np.float32) for c in ("R", "B", "G", "normal.X")}
    channels["id.X"] = np.ones((5, 3), np.uint32)
    told = {"cryptomatte/1234567/name": "CryptoObject", "zebra": "x"}
    write_exr(tmp_path / "a.exr", channels, told)
    write(tmp_path / "b.exr", channels, "ZIP", **told)
    # Up to the table of chunks, all is the same.
    ours, theirs = ((tmp_path / name).read_bytes() for name in ("a.exr", "b.exr"))
    length = ours.index(b"zebra") + len("zebra\0string\0") + 4 + 1 + 1
    assert ours[:length] == theirs[:length]
