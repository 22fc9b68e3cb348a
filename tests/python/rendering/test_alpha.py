"""What covers pixels: alpha, transparent backgrounds, and which shapes."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import OpenEXR
import pytest
from PIL import Image as Pillow

import raywright as rw

CAMERA = rw.Camera((0, 0, 5), (0, 0, 0), fov=40, width=25, height=19)
HOW = {"samples": 32, "seed": 5, "progress": False}
BLACK = rw.Diffuse(0.0)


def lamp(radius=1.0, material=BLACK, emission=1.0):
    """A ball that shines evenly and reflects nothing."""
    return rw.Sphere((0.1, 0, 0), radius, material=material, emission=emission)


@pytest.mark.parametrize(
    "filter", [rw.rendering.BoxFilter(), rw.rendering.GaussianFilter(), rw.rendering.LanczosFilter()]
)
@pytest.mark.parametrize("more", [{}, {"adaptive": True}, {"sampler": rw.rendering.Sobol(batch=4)}])
def test_what_shines_evenly_is_as_bright_as_it_covers(filter, more):
    scene = rw.Scene(lamp(), environment=1e5)
    image = rw.render(scene, CAMERA, filter=filter, background="transparent", aov="alpha", **HOW, **more)
    # The same samples and weights, in sums rounded to float32.
    np.testing.assert_allclose(image.rgb, np.repeat(image.alpha[..., None], 3, -1), rtol=2e-6, atol=1e-7)
    np.testing.assert_array_equal(image.alpha, image.aov["alpha"])
    assert image.alpha[9, 12] == pytest.approx(1, abs=1e-6) if filter == rw.rendering.BoxFilter() else True
    assert image.alpha[0, 0] == 0
    assert not image.alpha.flags.writeable


def test_alpha_is_the_area_that_is_covered():
    # Seen in parallel, a disk covers its own area of the film; each pixel is 0.2 units wide.
    camera = rw.Orthographic((0, 0, 5), (0, 0, 0), scale=4.0, width=20, height=20)
    scene = rw.Scene(rw.Disk((0.03, -0.02, 0), (0, 0, 1), 1.3, material=BLACK))
    alpha = rw.render(scene, camera, background="transparent", samples=256, progress=False).alpha
    # 256 samples of some 40 rim pixels, each off by 1/32 of a pixel at most: 3 standard errors.
    assert alpha.sum() * 0.04 == pytest.approx(np.pi * 1.3**2, abs=3 * 0.04 * np.sqrt(42) / 32)


def test_the_background_lights_what_it_is_not_seen_behind():
    white = rw.Sphere((0.1, 0, 0), 1.0, material=rw.Diffuse(1.0))
    scene = rw.Scene(white, environment=2.0)
    image = rw.render(scene, CAMERA, rw.Path(), background="transparent", **HOW)
    # In even light a white ball has that light's radiance, so the picture is the light times alpha.
    off = image.rgb - 2.0 * image.alpha[..., None]
    assert np.abs(off).max() <= 5 * image.standard_error.max() + 1e-6
    assert image.rgb[9, 12, 0] > 1
    shown = rw.render(scene, CAMERA, rw.Path(), **HOW)
    # The difference is the background times the uncovered share, from the same samples.
    np.testing.assert_allclose(
        shown.rgb - image.rgb, 2.0 * (1 - image.alpha[..., None]) + 0 * shown.rgb, atol=1e-5
    )
    assert shown.alpha is None


def test_mirrors_and_glass_show_the_background_and_cover():
    for material in (rw.Mirror(), rw.ThinDielectric()):
        scene = rw.Scene(rw.Sphere((0, 0, 0), 1.0, material=material), environment=3.0)
        image = rw.render(scene, CAMERA, rw.Path(), background="transparent", **HOW)
        assert image.alpha[9, 12] == 1
        assert image.rgb[9, 12, 0] > 2


@pytest.mark.parametrize("integrator", [rw.Path(), rw.Direct(), rw.RayCast(), rw.Whitted(), rw.LightTraced()])
def test_masks_let_through_what_of_them_is_open(integrator):
    sheet = rw.Mesh(
        [(-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0)],
        [(0, 1, 2), (0, 2, 3)],
        material=rw.Mask(BLACK, opacity=0.3),
        emission=0.0,
    )
    scene = rw.Scene(sheet, environment=4.0)
    image = rw.render(scene, CAMERA, integrator, background="transparent", **HOW)
    # 475 pixels of 32 samples with probability 0.3: the standard error of the mean is 0.0037; three are
    # allowed.
    assert image.alpha.mean() == pytest.approx(0.3, abs=3 * np.sqrt(0.21 / (475 * 32)))
    assert np.abs(image.rgb).max() == 0


def test_a_python_integrator_is_asked_about_all_and_heard_where_it_is_covered():
    class One(rw.integrators.Integrator):
        def radiance(self, scene, rays, rng):
            return np.ones((len(rng.next_1d()), 3))

    image = rw.render(rw.Scene(lamp()), CAMERA, One(), background="transparent", **HOW)
    np.testing.assert_allclose(image.rgb[..., 0], image.alpha, atol=1e-6)
    assert 0.05 < image.alpha.mean() < 0.5


def test_bits_stay_on_threads_elsewhere_and_after_a_break(tmp_path):
    scene = rw.Scene([lamp(0.8), rw.Sphere((-1, 0.5, 0), 0.4)], environment=1.0)
    how = {
        **HOW,
        "background": "transparent",
        "aov": ["alpha", "cryptomatte"],
        "sampler": rw.rendering.Lattice(batch=8),
    }
    whole = rw.render(scene, CAMERA, rw.Path(), **how)
    with ThreadPoolExecutor(2) as pool:
        kept = {"checkpoint": tmp_path / "kept"}
        rw.render(scene, CAMERA, rw.Path(), **{**how, **kept, "samples": 8})
        ways = ({"threads": 1}, {"executor": pool}, kept)
        others = [rw.render(scene, CAMERA, rw.Path(), **how, **way) for way in ways]
    for other in [*others, pickle.loads(pickle.dumps(whole))]:
        for one, same in (
            (whole.rgb, other.rgb),
            (whole.alpha, other.alpha),
            (whole.standard_error, other.standard_error),
            (whole.aov["cryptomatte"], other.aov["cryptomatte"]),
        ):
            assert np.array_equal(one, same)
    with pytest.raises(ValueError, match="it has background transparent instead of shown"):
        rw.render(scene, CAMERA, rw.Path(), **{**how, "background": "shown"}, **kept)


def test_shapes_are_told_by_their_shares():
    scene = rw.Scene([lamp(0.8), rw.Sphere((-1, 0.5, 0), 0.4)])
    how = {**HOW, "samples": 64}
    image = rw.render(scene, CAMERA, aov=["alpha", "cryptomatte"], **how)
    ranked = image.aov["cryptomatte"]
    assert ranked.shape == (19, 25, 6, 2)
    shapes, shares = ranked[..., 0], ranked[..., 1]
    assert set(np.unique(shapes)) == {-1, 0, 1}
    assert (np.diff(shares, axis=-1) <= 0).all()
    assert ((shapes == -1) == (shares == 0)).all()
    np.testing.assert_allclose(shares.sum(axis=-1), image.aov["alpha"], atol=1e-6)
    alone = rw.render(rw.Scene(scene.shapes[1]), CAMERA, aov="alpha", **how).aov["alpha"]
    # The small ball is nowhere in front of the other: where it is alone, its share is its own alpha.
    apart = (alone > 0) & ~((shapes == 0).any(axis=-1))
    mine = np.where(shapes == 1, shares, 0).sum(axis=-1)
    assert apart.sum() > 5
    np.testing.assert_allclose(mine[apart], alone[apart], atol=1e-6)


def test_aovs_alone_take_their_own_samples():
    scene = rw.Scene(lamp())
    alpha = rw.aovs(scene, CAMERA, "alpha", samples=64, seed=2)["alpha"]
    again = rw.render(
        scene, CAMERA, samples=64, seed=2, sampler=rw.rendering.Independent(), aov="alpha", progress=False
    )
    assert np.array_equal(alpha, again.aov["alpha"])


def test_png_holds_colors_by_themselves_and_exr_those_times_alpha(tmp_path):
    scene = rw.Scene(lamp(emission=(0.4, 0.2, 0.1)), environment=50.0)
    image = rw.render(scene, CAMERA, background="transparent", aov="alpha", **HOW)
    for name in ("a.png", "a.webp", "a.exr", "a.jpg"):
        image.save(tmp_path / name)
    with Pillow.open(tmp_path / "a.png") as file:
        assert file.mode == "RGBA"
        pixels = np.asarray(file).astype(int)
    rim = (image.alpha > 0.1) & (image.alpha < 0.9)
    assert rim.sum() > 10
    whole = rw.io.shown.srgb(np.array([[[0.4, 0.2, 0.1]]], np.float32))[0, 0].astype(int)
    # However small the coverage of a pixel, its color is that of the surface.
    assert np.abs(pixels[image.alpha > 0][:, :3] - whole).max() <= 1
    assert np.array_equal(pixels[..., 3], np.floor(image.alpha.clip(0, 1).astype(float) * 255 + 0.5))
    assert np.array_equal(pixels, image.srgb())
    with Pillow.open(tmp_path / "a.webp") as file:
        assert file.mode == "RGBA"
    with Pillow.open(tmp_path / "a.jpg") as file:
        assert (file.mode, file.getpixel((0, 0))) == ("RGB", (0, 0, 0))
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        assert np.array_equal(file.channels()["A"].pixels, image.alpha)
        assert np.array_equal(file.channels()["R"].pixels, image.rgb[..., 0])


@pytest.mark.parametrize("name", ["background", "on_interrupt"])
def test_unknown_choices_are_refused(name):
    with pytest.raises(ValueError, match=f"^{name} must be one of .*, got 'clear'$"):
        rw.render(rw.Scene(lamp()), CAMERA, **{name: "clear"}, **HOW)
