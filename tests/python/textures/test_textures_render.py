"""Textures in pictures: what shines by one, and what is too fine for a pixel, against closed forms."""

import math

import numpy as np
import pytest

import raywright as rw

UV = [(0, 0), (1, 0), (1, 1), (0, 1)]
# Radiance of 2 rows and 4 columns of texels, the first row on top; no two alike.
TEXELS = np.array([[1, 7, 2, 9], [5, 3, 8, 4]], np.float32)


def quad(corners, **kwargs):
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], uv=UV, **kwargs)


def mean(image):
    """Mean of the green channel, and its standard error."""
    count = image.rgb.shape[0] * image.rgb.shape[1]
    variances = np.square(image.standard_error[..., 1].astype(float))
    return float(image.rgb[..., 1].mean(dtype=float)), math.sqrt(float(variances.sum())) / count


def texels(**how):
    return rw.ImageTexture(np.repeat(TEXELS[..., None], 3, axis=2), filter="nearest", wrap="clamp", **how)


def test_a_lamp_shows_its_texture():
    lamp = quad([(-2, -1, 0), (2, -1, 0), (2, 1, 0), (-2, 1, 0)], material=rw.Diffuse(0), emission=texels())
    camera = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=2.0, width=16, height=8)
    image = rw.render(rw.Scene(lamp), camera, samples=4, progress=False).rgb[..., 1]
    np.testing.assert_allclose(image, np.kron(TEXELS, np.ones((4, 4))), rtol=1e-6)


def corner(x, y):
    """The irradiance, over pi L, of a rectangle from (0, 0) to (x, y) at height 1 (Lambert 1760)."""
    a, b = math.hypot(x, 1), math.hypot(y, 1)
    return (x / a * math.atan(y / a) + y / b * math.atan(x / b)) / (2 * math.pi)


@pytest.mark.parametrize("both", [False, True], ids=["white", "colored"])
@pytest.mark.parametrize("place", [(0.0, 0.0), (1.7, -0.6), (-3.0, 2.0)])
def test_a_textured_lamp_lights_by_the_form_factors_of_its_texels(place, both):
    # A lamp of 4 by 2 at height 1, which faces down: u runs along x, v along -y.
    corners = [(-2, 1, 1), (2, 1, 1), (2, -1, 1), (-2, -1, 1)]
    scale = (2, 1, 0.5) if both else 1
    lamp = quad(corners, material=rw.Diffuse(0), emission=rw.textures.ProductTexture(texels(), scale))
    expected = 0.0
    for row in range(2):
        for column in range(4):
            # The first row has the greatest v.
            west, east = (x - 2 - place[0] for x in (column, column + 1))
            south, north = (y - 1 - place[1] for y in (row, row + 1))
            share = corner(east, north) - corner(west, north) - corner(east, south) + corner(west, south)
            expected += float(TEXELS[row, column]) * share
    floor = rw.Disk((0, 0, 0), (0, 0, 1), 9, material=rw.Diffuse(0.8))
    at = (*place, 0)
    camera = rw.Camera((place[0] + 3, place[1], 0.1), at, up=(0, 0, 1), fov=1e-3, width=8, height=8)
    image = rw.render(rw.Scene([floor, lamp]), camera, rw.Path(max_depth=1), samples=512, progress=False)
    value, error = mean(image)
    # Four standard errors, which chance exceeds once in 16,000 pictures.
    assert abs(value - 0.8 * expected) <= 4 * error + 1e-4 * expected, (
        f"{value} ± {error}, not {0.8 * expected}"
    )
    assert error < 0.01 * value


def test_a_textured_cavity_shines_by_the_mean_exitance_of_its_texture():
    # In a sphere all patches have form factors equal to their share of the area. A wall of emission M and
    # reflectance r gets the mean of M over 1 - r everywhere, and shows its texel plus r / pi of that.
    around = rw.ImageTexture(TEXELS[:1, :, None].repeat(3, axis=2), filter="nearest")
    wall = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0.5), emission=rw.Emission(around, both_sides=True))
    seen = set()
    for direction in np.random.default_rng(2).normal(size=(12, 3)):
        camera = rw.Camera((0, 0, 0), direction, fov=1e-3, width=8, height=8)
        value, error = mean(rw.render(rw.Scene(wall), camera, samples=32, progress=False))
        texel = value - 0.5 * float(TEXELS[0].mean()) / (1 - 0.5)
        nearest = float(TEXELS[0][abs(TEXELS[0] - texel).argmin()])
        # Four standard errors: chance exceeds one of these twelve once in 1,300 times.
        assert abs(texel - nearest) <= 4 * error, f"{value} ± {error}"
        assert error < 0.05
        seen.add(nearest)
    assert seen == set(TEXELS[0].tolist())


# Two radiances in equal shares, some hundred times across a pixel.
FINE = {
    "checker": rw.Checker(0.9, 0.1, 2000),
    "checker in space": rw.Checker(0.9, 0.1, rw.textures.ObjectTransform(60)),
    "stripes": rw.textures.Stripes(0.9, 0.1, 0.5, 2000),
    "picture": rw.ImageTexture(np.indices((64, 64)).sum(axis=0) % 2 * 0.8 + 0.1, transform=32),
}
VIEWS = {
    "perspective": (rw.Camera((0, -8, 6), (0, 0, 0), up=(0, 0, 1), fov=30, width=32, height=32), []),
    "orthographic": (
        rw.Orthographic((0, -8, 6), (0, 0, 0), up=(0, 0, 1), scale=8, width=32, height=32),
        [],
    ),
    "mirror": (
        rw.Camera((0, 3, 3), (0, 9, 1.5), up=(0, 0, 1), fov=10, width=32, height=32),
        [quad([(-9, 9, 0), (9, 9, 0), (9, 9, 9), (-9, 9, 9)], material=rw.Mirror())],
    ),
    "ball": (
        rw.Camera((0, -20, 3), (0, 0, 2.3), up=(0, 0, 1), fov=1, width=32, height=32),
        [rw.Sphere((0, 0, 3), 1, material=rw.Mirror())],
    ),
    "pane": (
        rw.Camera((0, 8, 4), (0, 0, 0), up=(0, 0, 1), fov=10, width=32, height=32),
        [quad([(-9, 3, 0), (9, 3, 0), (9, 3, 9), (-9, 3, 9)], material=rw.ThinDielectric(1.0))],
    ),
}


def one_sample_of_a_floor(texture, view):
    """Radiance of a floor that shines by a texture, one sample a pixel."""
    camera, shapes = VIEWS[view]
    floor = quad([(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)], material=rw.Diffuse(0), emission=texture)
    image = rw.render(rw.Scene([floor, *shapes]), camera, samples=1, progress=False).rgb[..., 1]
    assert (image > 0).all()
    return image


@pytest.mark.parametrize("texture", FINE)
@pytest.mark.parametrize("view", VIEWS)
def test_what_is_finer_than_a_pixel_is_its_mean_in_a_single_sample(texture, view):
    image = one_sample_of_a_floor(FINE[texture], view)
    # Unfiltered, the standard deviation is 0.4, and that of the mean of 1024 pixels 0.0125.
    assert image.std() < 0.02
    assert abs(image.mean() - 0.5) < 0.002


def test_without_a_filter_it_is_noise():
    picture = rw.ImageTexture(FINE["picture"].image, filter="nearest", transform=32)
    assert one_sample_of_a_floor(picture, "perspective").std() > 0.39


def test_what_is_coarser_than_a_pixel_is_not_blurred():
    # Cells of 2 by 2, from close by: nearly all pixels are one or the other, half of each.
    camera = rw.Orthographic((0, 0, 5), (0, 0, 0), scale=16, width=64, height=64)
    floor = quad(
        [(-8, -8, 0), (8, -8, 0), (8, 8, 0), (-8, 8, 0)],
        material=rw.Diffuse(0),
        emission=rw.Checker(0.9, 0.1, 8),
    )
    image = rw.render(rw.Scene(floor), camera, samples=1, progress=False).rgb[..., 1]
    sharp = (abs(image - 0.9) < 1e-6) | (abs(image - 0.1) < 1e-6)
    # At most two of a cell's eight pixels either way contain an edge.
    assert sharp.mean() >= (6 / 8) ** 2
    assert abs(image.mean() - 0.5) < 0.02
