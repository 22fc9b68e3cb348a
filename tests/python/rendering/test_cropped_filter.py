"""A filter that is cropped takes nothing from beyond the film's edge."""

import numpy as np
import pytest

import raywright as rw

BELL = rw.rendering.GaussianFilter(2.0, 0.5)
SIZE = 6


def picture(filter, shapes, way=None, samples=256, seed=0):
    """What is seen of x from 0 to 6 on the plane z = 0, one unit a pixel, y up."""
    eye = rw.Orthographic((3, 3, 5), (3, 3, 0), up=(0, 1, 0), scale=SIZE, width=SIZE, height=SIZE)
    scene = rw.Scene(shapes)
    return rw.render(
        scene, eye, way or rw.Direct(), samples=samples, filter=filter, seed=seed, progress=False
    )


def plate(left, right, radiance):
    corners = [[left, -5.0, 0], [right, -5, 0], [right, 11, 0], [left, 11, 0]]
    light = rw.Emission(radiance)
    return rw.Mesh(corners, [[0, 1, 2], [0, 2, 3]], material=rw.Diffuse(0.0), emission=light)


def bell(x):
    return np.exp(-2 * x * x) - np.exp(-8.0)


def share(low, high):
    """The integral of the bell, less its value at its end."""
    x = np.linspace(low, high, 40_001)
    return np.trapezoid(bell(x), x)


def test_what_shines_beyond_the_edge_counts_for_no_pixel():
    lamp = [plate(-3, 0, 100.0), plate(0, 9, 1.0)]
    whole, cropped = picture(BELL, lamp).rgb, picture(rw.rendering.CroppedFilter(BELL), lamp).rgb
    assert np.allclose(cropped, 1, rtol=2e-3)
    assert (whole[:, 0] > 10).all()


def test_edges_take_the_part_that_is_on_the_film():
    dark = [plate(0, 1, 2.0), plate(1, 9, 0.0)]
    image = picture(rw.rendering.CroppedFilter(BELL), dark, samples=1024)
    expected = 2 * share(-0.5, 0.5) / share(-0.5, 2), 2 * share(-1.5, -0.5) / share(-1.5, 2)
    for column, value in enumerate(expected):
        middle, error = image.rgb[:, column, 0], image.standard_error[:, column, 0]
        assert abs(middle.mean() - value) < 4 * np.sqrt((error**2).mean() / SIZE) + 1e-3 * value
    # Farther from the edge than the filter reaches, nothing changes.
    whole = picture(BELL, dark, samples=1024).rgb
    assert np.allclose(image.rgb[2:4, 2:4], whole[2:4, 2:4], rtol=0, atol=5e-3)


@pytest.mark.parametrize(
    "filter",
    [BELL, rw.rendering.MitchellFilter(), rw.rendering.LanczosFilter(), rw.rendering.BoxFilter(1.2)],
    ids=repr,
)
def test_an_even_picture_stays_so(filter):
    image = picture(rw.rendering.CroppedFilter(filter), [plate(-9, 19, 1.0)])
    # Negative lobes turn uniform light into noise.
    assert abs(image.rgb - 1).max() < 5 * image.standard_error.max() + 3e-3


def test_light_that_comes_to_the_film_is_cropped_alike():
    floor = rw.Mesh([[-9, -9, 0], [15, -9, 0], [15, 15, 0], [-9, 15, 0]], [[0, 1, 2], [0, 2, 3]])
    lamp = rw.Sphere((3, 3, 9), 1.0, emission=50.0)
    cropped = rw.rendering.CroppedFilter(BELL)
    one = picture(cropped, [floor, lamp], rw.Path(max_depth=1), 64, seed=1)
    two = picture(cropped, [floor, lamp], rw.LightTraced(max_depth=1), 2048, seed=2)
    for part in (np.s_[0], np.s_[:, 0], np.s_[2:4, 2:4]):
        a, b = one.rgb[part][..., 0], two.rgb[part][..., 0]
        error = (
            np.sqrt(((one.standard_error[part] ** 2 + two.standard_error[part] ** 2)[..., 0]).sum()) / a.size
        )
        assert abs(a.mean() - b.mean()) < 4 * error
        assert error < 0.05 * a.mean()


def test_what_cannot_be_cropped_is_told():
    with pytest.raises(TypeError, match="filter must be one that is not cropped, got CroppedFilter"):
        rw.rendering.CroppedFilter(rw.rendering.CroppedFilter(BELL))
    with pytest.raises(TypeError, match="filter must be one that is not cropped, got float"):
        rw.rendering.CroppedFilter(0.5)
    assert rw.rendering.CroppedFilter(BELL) == rw.rendering.CroppedFilter(
        rw.rendering.GaussianFilter(2.0, 0.5)
    )
