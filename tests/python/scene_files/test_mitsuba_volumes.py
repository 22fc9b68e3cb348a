"""Mitsuba's textures that are volumes: of meshes, the colors of a grid."""

import struct

import numpy as np
import pytest

import raywright as rw


def written(path, numbers):
    """Write a grid of numbers, x first, as Mitsuba does."""
    numbers = np.asarray(numbers, np.float32)
    channels = numbers.shape[3] if numbers.ndim == 4 else 1
    head = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, *numbers.shape[:3], channels, 0, 0, 0, 1, 1, 1)
    path.write_bytes(head + numbers.reshape(*numbers.shape[:3], channels).transpose(2, 1, 0, 3).tobytes())
    return path


def grid(path, **more):
    return {"type": "volume", "volume": {"type": "gridvolume", "filename": str(path), **more}}


def read(color, **shape):
    bsdf = {"type": "diffuse", "reflectance": color}
    scene = {"type": "scene", "sensor": {"type": "perspective"}, "shape": {"bsdf": bsdf, **shape}}
    return rw.from_mitsuba(scene).scene.shapes[0]


RAMP = np.broadcast_to((np.arange(8) + 0.5)[:, None, None] / 8, (8, 2, 2))
HALF = [[0.5, 0, 0, 0.5], [0, 0.5, 0, 0.5], [0, 0, 0.5, 0.5], [0, 0, 0, 1]]


def test_a_ramp_is_one_on_a_rectangle(tmp_path):
    path = written(tmp_path / "ramp.vol", RAMP)
    # From 0 to 1 along x and y, and 0.5 along z.
    found = read(grid(path), type="rectangle", to_world=HALF)
    assert isinstance(found, rw.Mesh)
    assert found.material.front.reflectance == rw.VertexColors()
    # Values are constant beyond the middles of the first and the last cell.
    expected = found.vertices[:, 0].clip(0.5 / 8, 7.5 / 8)
    assert np.allclose(found.colors, expected[:, None], rtol=0, atol=1e-6)
    corners = found.vertices[found.faces]
    assert np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max() <= 0.5 / 8
    assert found.uv.shape == (len(found.vertices), 2)
    assert np.allclose(found.uv, found.vertices[:, :2], rtol=0, atol=1e-6)


def test_colors_lie_where_a_transform_puts_them_and_repeat(tmp_path):
    numbers = np.random.default_rng(5).uniform(0, 1, (3, 4, 5, 3)).astype(np.float32)
    path = written(tmp_path / "dots.vol", numbers)
    scale = [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]
    for wrap in ("clamp", "repeat"):
        found = read(grid(path, to_world=scale, wrap_mode=wrap), type="cube", to_world=HALF)
        at = found.vertices / 2 * (3, 4, 5) - 0.5
        expected = np.zeros((len(at), 3))
        for i in range(-1, 4):
            for j in range(-1, 5):
                for k in range(-1, 6):
                    # Each cell has a tent-shaped weight around its middle, with neighbors beyond the ends
                    # too.
                    weight = np.clip(1 - np.abs(at - (i, j, k)), 0, None).prod(axis=1)
                    where = np.array((i, j, k))
                    where = where % (3, 4, 5) if wrap == "repeat" else where.clip(0, (2, 3, 4))
                    expected += weight[:, None] * numbers[tuple(where)]
        assert np.allclose(found.colors, expected, rtol=0, atol=1e-6)


def test_a_volume_that_is_the_same_everywhere_is_a_color():
    even = {"type": "constvolume", "value": {"type": "rgb", "value": [0.2, 0.4, 0.6]}}
    found = read({"type": "volume", "volume": even}, type="sphere")
    assert found.material.front.reflectance == (0.2, 0.4, 0.6)


@pytest.mark.parametrize(
    ("shape", "color", "message"),
    [
        ("sphere", {}, "a volume of a grid is read as a texture of meshes only"),
        (
            "rectangle",
            {"volume": {"type": "rgb", "value": 1.0}},
            "a volume must be within, of type constvolume",
        ),
        ("rectangle", {"volume": None}, "a volume must be within"),
    ],
)
def test_what_is_not_read_is_refused(tmp_path, shape, color, message):
    given = grid(written(tmp_path / "ramp.vol", RAMP)) | color
    with pytest.raises(ValueError, match=message):
        read({key: value for key, value in given.items() if value is not None}, type=shape)
