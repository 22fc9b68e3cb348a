"""Textures: what they keep, what they refuse, and that they lie where they should."""

import math
import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
from PIL import Image

import raywright as rw

PIXELS = np.arange(2 * 3 * 4, dtype=np.uint8).reshape(2, 3, 4)
TURNED = rw.textures.UvTransform((4, 2), 90, (0.5, 0.25))

TEXTURES = [
    rw.Checker((0.1, 0.2, 0.3), 0.5, 8),
    rw.Checker(transform=rw.textures.ObjectTransform(3, (0.5, 0, 0))),
    rw.textures.Stripes(0.2, 0.7, 0.25, TURNED),
    rw.textures.Noise(seed=7),
    rw.textures.FBm(0.2, rw.textures.Noise(), octaves=4, gain=0.6),
    rw.textures.Marble(distortion=2),
    rw.textures.Wood(transform=rw.textures.UvTransform(8)),
    rw.textures.MixTexture(rw.textures.Noise(), 0.5, rw.Checker(0, 1)),
    rw.textures.ProductTexture(rw.Checker(), (1, 0.5, 0.25)),
    rw.VertexColors(),
    rw.ImageTexture(PIXELS),
    rw.ImageTexture(
        PIXELS, linear=True, channel="g", filter="nearest", wrap=("clamp", "mirror"), transform=2
    ),
    rw.ImageTexture(np.linspace(0, 3, 12).reshape(3, 4)),
]


@pytest.mark.parametrize("texture", TEXTURES, ids=lambda t: type(t).__name__)
def test_textures_pickle_compare_hash_and_print(texture):
    back = pickle.loads(pickle.dumps(texture))
    assert back == texture
    assert hash(back) == hash(texture)
    assert repr(back) == repr(texture)
    assert repr(texture).startswith(type(texture).__name__ + "(")
    assert "\n" not in repr(texture)
    assert [texture == other for other in TEXTURES].count(True) == 1


def test_textures_are_frozen_and_so_are_pictures():
    with pytest.raises(FrozenInstanceError):
        TEXTURES[0].a = 1
    texture = rw.ImageTexture(PIXELS)
    assert texture.image is not PIXELS
    with pytest.raises(ValueError, match="read-only"):
        texture.image[0] = 1
    with pytest.raises(ValueError, match="read-only"):
        pickle.loads(pickle.dumps(texture)).image[0] = 1


def test_transforms_scale_then_turn_then_move():
    (a, b, c), (d, e, f) = TURNED.matrix
    assert (a, b, c, d, e, f) == pytest.approx((0, -2, 0.5, 4, 0, 0.25), abs=1e-15)
    assert rw.textures.UvTransform(matrix=TURNED.matrix) == TURNED
    assert rw.textures.ObjectTransform((1, 2, 3), (4, 5, 6)).matrix == (
        (1, 0, 0, 4),
        (0, 2, 0, 5),
        (0, 0, 3, 6),
    )
    assert rw.textures.ObjectTransform(matrix=np.diag([2.0, 2, 2, 1])) == rw.textures.ObjectTransform(2)


def test_ranges_are_those_of_what_can_come_out():
    assert rw.Checker((0.1, 0.5, 0.3), 0.2).range == ((0.1, 0.2, 0.2), (0.2, 0.5, 0.3))
    assert rw.textures.ProductTexture(rw.Checker(-1, 2), rw.Checker(-3, 0.5)).range == (
        (-6.0,) * 3,
        (3.0,) * 3,
    )
    assert rw.ImageTexture(np.array([[0, 255]], np.uint8)).range == ((0.0,) * 3, (1.0,) * 3)
    gray = rw.ImageTexture(np.array([[188, 51]], np.uint8))
    assert gray.range[1] == pytest.approx((0.502886,) * 3, abs=1e-6)
    assert rw.ImageTexture(gray.image, linear=True).range[0] == (0.2,) * 3
    assert rw.ImageTexture(PIXELS, channel="a").range == ((3 / 255,) * 3, (23 / 255,) * 3)
    assert rw.textures.MixTexture(0.5, rw.textures.Noise(0.2, 0.7)).range == ((0.2,) * 3, (0.7,) * 3)


def test_sixteen_bits_are_decoded_as_eight():
    eight = np.array([[0, 10, 188, 255]], np.uint8)
    sixteen = eight.astype(np.uint16) * 257
    decoded = rw.ImageTexture(sixteen)
    assert decoded.image.dtype == np.float32
    assert decoded.image[0, :, 0] == pytest.approx([0, 0.003035, 0.502886, 1], abs=1e-6)
    assert rw.ImageTexture(sixteen, linear=True).image[0, 2, 0] == pytest.approx(188 / 255)


@pytest.mark.parametrize("mode", ["L", "LA", "RGB", "RGBA", "P"])
def test_pictures_are_read_from_files(tmp_path, mode):
    rng = np.random.default_rng(3)
    picture = Image.fromarray(rng.integers(0, 255, (5, 7, 4), np.uint8), "RGBA")
    picture = picture.convert("RGB").convert("P") if mode == "P" else picture.convert(mode)
    picture.save(tmp_path / "picture.png")
    expected = np.asarray(picture.convert("RGB") if mode == "P" else picture).reshape(5, 7, -1)
    assert np.array_equal(rw.ImageTexture(tmp_path / "picture.png").image, expected)


def test_exr_and_npy_are_read_from_files(tmp_path, picture):
    for name in ("picture.exr", "picture.npy"):
        picture.save(tmp_path / name)
        assert np.array_equal(rw.ImageTexture(str(tmp_path / name)).image, picture.rgb)


def test_the_order_of_bytes_does_not_matter():
    sixteen = np.random.default_rng(1).integers(0, 65536, (3, 4, 3)).astype(np.uint16)
    assert np.array_equal(rw.ImageTexture(sixteen.astype(">u2")).image, rw.ImageTexture(sixteen).image)
    shares = sixteen.astype(np.float32)
    assert np.array_equal(rw.ImageTexture(shares.astype(">f4")).image, shares)


def test_files_that_are_no_pictures_are_refused(tmp_path):
    with pytest.raises(FileNotFoundError, match="no such file"):
        rw.ImageTexture(tmp_path / "none.png")
    (tmp_path / "bad.png").write_bytes(b"no picture")
    with pytest.raises(ValueError, match=r"bad\.png is not a picture that can be read \(.+\)$"):
        rw.ImageTexture(tmp_path / "bad.png")


@pytest.mark.parametrize(
    ("make", "error", "told"),
    [
        (lambda: rw.Checker(math.nan), ValueError, r"a must be finite, got nan"),
        (lambda: rw.Checker((1, 2)), ValueError, r"a must be one number or 3, got shape \(2,\)"),
        (lambda: rw.Checker(0, "red"), TypeError, r"b must be real numbers, got 'red'"),
        (
            lambda: rw.Checker(transform="big"),
            TypeError,
            r"transform must be a UvTransform, an ObjectTransform",
        ),
        (lambda: rw.textures.Stripes(fraction=1.5), ValueError, r"fraction must be between 0 and 1, got 1.5"),
        (lambda: rw.textures.Noise(seed=-1), ValueError, r"seed must be between 0 and 4294967295, got -1"),
        (lambda: rw.textures.FBm(octaves=0), ValueError, r"octaves must be between 1 and 32, got 0"),
        (
            lambda: rw.textures.FBm(lacunarity=1),
            ValueError,
            r"lacunarity must be greater than 1 and at most 16, got 1",
        ),
        (lambda: rw.textures.FBm(gain=-0.5), ValueError, r"gain must be between 0 and 1, got -0.5"),
        (lambda: rw.textures.Wood(distortion=math.inf), ValueError, r"distortion must be finite, got inf"),
        (lambda: rw.textures.MixTexture(0, 1, 2), ValueError, r"amount must be between 0 and 1, got 2"),
        (
            lambda: rw.textures.MixTexture(0, 1, rw.textures.Noise(0, 3)),
            ValueError,
            r"amount must be .*a texture of 0 to 3",
        ),
        (lambda: rw.textures.UvTransform(math.nan), ValueError, r"scale must be finite"),
        (
            lambda: rw.textures.UvTransform(matrix=np.eye(3)),
            ValueError,
            r"matrix must have shape \(2, 3\), got \(3, 3\)",
        ),
        (
            lambda: rw.textures.ObjectTransform(matrix=np.ones((4, 4))),
            ValueError,
            r"\(0, 0, 0, 1\) as its last row",
        ),
        (lambda: rw.ImageTexture(np.zeros((2, 0))), ValueError, r"image must have shape \(H, W\) or"),
        (lambda: rw.ImageTexture(np.zeros((2, 2, 5))), ValueError, r"image must have .* got \(2, 2, 5\)"),
        (
            lambda: rw.ImageTexture(np.zeros((2, 2), int)),
            TypeError,
            r"uint8, uint16 or floats, got dtype int64",
        ),
        (lambda: rw.ImageTexture(np.full((2, 2), np.nan)), ValueError, r"NaN or infinity in row 0, column 0"),
        (
            lambda: rw.ImageTexture(np.zeros((2, 2)), channel="a"),
            ValueError,
            r"channel is 'a', but .* 1 channels",
        ),
        (lambda: rw.ImageTexture(PIXELS, channel="x"), ValueError, r"channel must be one of"),
        (lambda: rw.ImageTexture(PIXELS, filter="cubic"), ValueError, r"filter must be one of"),
        (lambda: rw.ImageTexture(PIXELS, wrap=("clamp", "border")), ValueError, r"wrap must be one of"),
        (lambda: rw.ImageTexture(PIXELS, linear=1), TypeError, r"linear must be True or False, got 1"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(make, error, told):
    with pytest.raises(error, match=told) as caught:
        make()
    assert "\n" not in str(caught.value)


SQUARE = [(-1.0, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)]
FACES = [(0, 1, 2), (0, 2, 3)]
UV = [(0.0, 0), (1, 0), (1, 1), (0, 1)]


def seen(material, size=8, samples=16, sampler=None, **more) -> rw.Image:
    """A square that fills the picture, in light of radiance 1: a matt one is as bright as it reflects."""
    mesh = rw.Mesh(SQUARE, FACES, uv=UV, material=material, **more)
    fov = 2 * math.degrees(math.atan(0.1))
    camera = rw.Camera((0, 0, 10), (0, 0, 0), fov=fov, width=size, height=size)
    scene = rw.Scene(mesh, environment=1)
    return rw.render(scene, camera, rw.Path(max_depth=1), samples=samples, sampler=sampler)


def test_pictures_lie_with_their_lower_left_at_zero():
    picture = np.linspace(0, 1, 8 * 8 * 3).reshape(8, 8, 3)
    shown = seen(rw.Diffuse(rw.ImageTexture(picture, filter="nearest"))).rgb
    assert shown == pytest.approx(picture, abs=2e-6)
    eight = (picture * 255).astype(np.uint8)
    shares = eight / 255
    linear = np.where(shares <= 0.04045, shares / 12.92, ((shares + 0.055) / 1.055) ** 2.4)
    assert seen(rw.Diffuse(rw.ImageTexture(eight, filter="nearest"))).rgb == pytest.approx(linear, abs=2e-6)
    plain = seen(rw.Diffuse(rw.ImageTexture(eight, linear=True, filter="nearest"))).rgb
    assert plain == pytest.approx(shares, abs=2e-6)
    green = seen(rw.Diffuse(rw.ImageTexture(eight, linear=True, channel="g", filter="nearest"))).rgb
    assert green == pytest.approx(np.repeat(shares[..., 1:2], 3, axis=2), abs=2e-6)


def test_procedurals_lie_in_coordinates_or_in_space():
    rows, columns = np.indices((8, 8))
    expected = np.where((columns + (7 - rows)) % 2 == 1, 0.75, 0.25)[..., np.newaxis]
    on = rw.Checker(0.25, 0.75, 8)
    inside = rw.Checker(0.25, 0.75, rw.textures.ObjectTransform(4, (4, 4, 0.5)))
    for texture in (on, inside):
        # The middle one of five by five pixels: beside edges, a pixel's footprint has both colors.
        shown = seen(rw.Diffuse(texture), size=40).rgb[2::5, 2::5]
        assert shown == pytest.approx(np.repeat(expected, 3, axis=2), abs=2e-6)


def test_colors_of_vertices_are_seen():
    colors = [(0.0, 0, 0.5), (1, 0, 0.5), (1, 1, 0.5), (0, 1, 0.5)]
    image = seen(rw.Diffuse(rw.VertexColors()), samples=64, sampler=rw.rendering.Independent(), colors=colors)
    rows, columns = np.indices((8, 8))
    expected = np.stack([(columns + 0.5) / 8, (7.5 - rows) / 8, np.full((8, 8), 0.5)], axis=-1)
    # 192 numbers, each within 8 standard errors of its own, from 64 independent samples.
    assert (np.abs(image.rgb - expected) <= 8 * image.standard_error + 1e-5).all()
    # White if a mesh has none.
    assert seen(rw.Diffuse(rw.VertexColors())).rgb == pytest.approx(np.ones((8, 8, 3)), abs=2e-6)


def test_meshes_keep_colors():
    colors = np.linspace(0, 1, 12, dtype=np.float32).reshape(4, 3)
    mesh = rw.Mesh(SQUARE, FACES, colors=colors)
    assert np.array_equal(mesh.colors, colors)
    assert mesh != rw.Mesh(SQUARE, FACES)
    assert pickle.loads(pickle.dumps(mesh)) == mesh
    assert np.array_equal(mesh.transformed(np.eye(4)).colors, colors)
    assert "colors" in repr(mesh)
    with pytest.raises(
        ValueError, match=r"colors must be between 0 and 1, got \[0.0, 2.0, 0.0\] of vertex 1"
    ):
        rw.Mesh(SQUARE, FACES, colors=[(0, 0, 0), (0, 2, 0), (0, 0, 0), (0, 0, 0)])
    with pytest.raises(ValueError, match=r"colors must have shape \(4, 3\)"):
        rw.Mesh(SQUARE, FACES, colors=colors[:3])
