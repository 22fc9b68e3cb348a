"""Layers of EXR files: what each is called, and what is in it."""

import json

import numpy as np
import OpenEXR
import pytest

import raywright as rw
from raywright.io.cryptomatte import identity, murmur3


@pytest.mark.parametrize(
    ("text", "expected"),
    # What Appleby's own gives.
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
    image = rw.render(scene, camera, samples=8, adaptive=True, aov=rw.AOVS, progress=False)
    path = tmp_path_factory.mktemp("exr") / "a.exr"
    image.save(path)
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return image, {name: one.pixels for name, one in file.channels().items()}, dict(file.header())


def test_every_aov_is_a_layer(saved):
    image, channels, _ = saved
    names = {
        "depth": "Z", "position": "XYZ", "normal": "XYZ", "shading_normal": "XYZ", "uv": "UV",
        "albedo": "RGB", "motion": "XYZ", "screen_motion": "XY", "alpha": "A", "shape_id": "X",
        "primitive": "X", "samples": "X", "standard_error": "RGB",
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
