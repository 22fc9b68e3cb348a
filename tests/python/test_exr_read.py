"""EXR files are read by the core, as the library that writes them wrote them."""

import subprocess
import sys

import numpy as np
import pytest

import raywright as rw
from raywright.io.pictures import read

OpenEXR = pytest.importorskip("OpenEXR")
METHODS = ("NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", [np.float16, np.float32])
def test_every_method_and_number_is_read(tmp_path, method, kind):
    rng = np.random.default_rng(5)
    # Smooth with some noise, larger than a block of any method and no multiple of one.
    y, x = np.mgrid[:67, :45] / 50
    pixels = (np.stack([x, y, x * y, np.ones_like(x)], -1) * 3 + rng.normal(0, 0.1, (67, 45, 4))).astype(kind)
    channels = {name: np.ascontiguousarray(pixels[..., k]) for k, name in enumerate("RGBA")}
    header = {"compression": getattr(OpenEXR, f"{method}_COMPRESSION"), "type": OpenEXR.scanlineimage}
    path = tmp_path / "p.exr"
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
    found = read(path)
    assert (found.dtype, found.shape) == (np.float32, (67, 45, 4))
    with OpenEXR.File(str(path), separate_channels=True) as file:
        same = np.stack([file.channels()[name].pixels for name in "RGBA"], -1).astype(np.float32)
    # PXR24 cuts float32 to 24 bits and B44 packs half as four by four: both libraries decode the same bits.
    assert np.array_equal(found, same)
    if method not in ("PXR24", "B44"):
        assert np.array_equal(found, pixels.astype(np.float32))


def test_greys_and_missing_channels(tmp_path):
    grey = np.linspace(0, 2, 12, dtype=np.float32).reshape(3, 4)
    for names, shape in ((("Y",), (3, 4, 1)), (("Y", "A"), (3, 4, 2))):
        with OpenEXR.File({"type": OpenEXR.scanlineimage}, dict.fromkeys(names, grey)) as file:
            file.write(str(tmp_path / "g.exr"))
        assert read(tmp_path / "g.exr").shape == shape
    with OpenEXR.File({"type": OpenEXR.scanlineimage}, {"R": grey, "B": grey}) as file:
        file.write(str(tmp_path / "g.exr"))
    with pytest.raises(ValueError, match="it has no channel G, only"):
        read(tmp_path / "g.exr")


def test_an_environment_is_read_without_the_library(tmp_path):
    image = np.random.default_rng(2).uniform(0, 3, (8, 16, 3)).astype(np.float32)
    channels = {name: np.ascontiguousarray(image[..., k]) for k, name in enumerate("RGB")}
    with OpenEXR.File(
        {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage}, channels
    ) as file:
        file.write(str(tmp_path / "sky.exr"))
    assert np.array_equal(rw.EnvironmentMap(tmp_path / "sky.exr").image, image)
    code = (
        "import sys; sys.modules['OpenEXR'] = None\n"
        "import raywright as rw; print(rw.EnvironmentMap('sky.exr').image.sum())"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(float(image.sum()), rel=1e-5)


def refusal(path):
    """What is said of a file; nothing if it can be read."""
    try:
        read(path)
    except ValueError as error:
        return str(error)
    return ""


def test_broken_bytes_are_told_in_one_line(tmp_path):
    grey = np.random.default_rng(1).uniform(0, 1, (40, 30)).astype(np.float32)
    path = tmp_path / "b.exr"
    with OpenEXR.File(
        {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage}, {"Y": grey}
    ) as file:
        file.write(str(path))
    data = bytearray(path.read_bytes())
    rng = np.random.default_rng(3)
    for _ in range(200):
        broken = bytearray(data)
        for place in rng.integers(8, len(data), 3):
            broken[place] = rng.integers(256)
        path.write_bytes(bytes(broken))
        told = refusal(path)
        assert "\n" not in told
