"""Metals have the colors of their spectra: those of spectral renderers, and of the integral."""

import itertools

import mitsuba_metals
import numpy as np
import pytest
from mitsuba_metals import METALS, SMOOTH, VIEWS, View

import raywright as rw


def looked_at(metal, view, side=1, samples=1):
    """A picture of a plate, as `mitsuba_metals` looks at it."""
    angle = np.radians(view.angle)
    eye = np.array((np.sin(angle), 0, np.cos(angle)))
    plate = rw.Polygon([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], material=metal)
    if view.light == "sky":
        scene = rw.Scene(plate, environment=1.0)
    else:
        scene = rw.Scene(plate, lights=[rw.DirectionalLight((np.sin(angle), 0, -np.cos(angle)), 1.0)])
    camera = rw.Orthographic(10 * eye, (0, 0, 0), scale=0.01, width=side, height=side)
    return rw.render(scene, camera, rw.Path(max_depth=1), samples=samples, progress=False)


def seen(metal, view):
    """The color of it."""
    return looked_at(metal, view).rgb[0, 0].astype(np.float64)


def fresnel(cosine, eta, k):
    """The reflectance of unpolarized light, by Fresnel's equations for a complex index."""
    index = np.asarray(eta) + 1j * np.asarray(k)
    through = np.sqrt(index**2 - (1 - cosine**2))
    s = (cosine - through) / (cosine + through)
    p = (index**2 * cosine - through) / (index**2 * cosine + through)
    return (abs(s) ** 2 + abs(p) ** 2) / 2


@pytest.mark.parametrize(
    ("symbol", "color"),
    # Colors of a plate in a uniform white sky, by Mitsuba's spectral variants: Mitsuba 3.9,
    # `mitsuba_metals`.
    [
        ("Au", (1.0216, 0.7823, 0.3436)),
        ("Ag", (0.9714, 0.9598, 0.9155)),
        ("Cr", (0.6345, 0.6621, 0.7047)),
    ],
)
def test_metals_in_a_white_furnace_have_their_colors(symbol, color):
    plate = seen(rw.Conductor(symbol), View("sky", 0.0, 0.0))
    assert np.allclose(plate, color, rtol=2e-3, atol=0)


@pytest.mark.parametrize("symbol", METALS)
def test_metals_look_as_in_spectral_renderers(symbol):
    """Smooth and rough, and from straight above to nearly grazing: within 1 %, and what chance left there."""
    compared = 0
    for metal, view, mean, error in mitsuba_metals.references():
        if metal == symbol:
            off = abs(seen(rw.Conductor(symbol, alpha=view.alpha), view) - mean)
            assert (off <= 0.01 * mean).all(), (view, off / mean)
            assert (error <= 0.0025 * mean).all(), view
            compared += 1
    assert compared == len(VIEWS)


def test_all_metals_that_both_know_are_compared():
    known = {symbol for symbol, *_ in mitsuba_metals.references()}
    assert known == set(METALS)
    names = [rw.Conductor(symbol).metal for symbol in METALS]
    assert len(set(names)) == len(names)


@pytest.mark.slow
@pytest.mark.parametrize("symbol", ["Ag", "Al", "Au", "Cr", "Cu"])
def test_mitsuba_shows_what_was_written(symbol):
    """Of other samples, where Mitsuba is installed: within five of the errors of both, and 1 % of ours."""
    pytest.importorskip("mitsuba")
    for metal, view, mean, error in mitsuba_metals.references():
        if metal == symbol:
            now, spread = mitsuba_metals.by_mitsuba(symbol, view, seed=1, samples=64)
            assert (abs(now - mean) <= 5 * np.hypot(error, spread)).all(), view
            ours = seen(rw.Conductor(symbol, alpha=view.alpha), view)
            assert (abs(ours - now) <= 0.01 * now + 3 * spread).all(), view


def test_one_reflection_is_the_integral_of_what_was_measured():
    """By numpy, with the eye and daylight as the core has them, which are tested there."""
    wavelengths = np.arange(360.0, 831.0)
    for symbol, angle in itertools.product(("Au", "K", "TiN", "Zr"), (0, 30, 60, 80, 89)):
        measured = rw.materials.metal_index(symbol)
        assert measured.wavelengths[0] <= 360
        assert measured.wavelengths[-1] >= 830
        assert (np.diff(measured.wavelengths) > 0).all()
        eta, k = (np.interp(wavelengths, measured.wavelengths, x) for x in measured[1:])
        shares = fresnel(np.cos(np.radians(angle)), eta, k)
        truth = rw._core.spectrum_rgb(np.stack([wavelengths, shares], axis=1).tolist(), True)
        plate = seen(rw.Conductor(symbol), View("sky", 0.0, angle))
        assert np.allclose(plate, truth, rtol=2e-3, atol=0), (symbol, angle)


def test_constants_are_fresnels_in_each_channel():
    eta, k = (0.2, 1.1, 1.3), (3.9, 2.6, 2.4)
    for view in SMOOTH:
        truth = fresnel(np.cos(np.radians(view.angle)), eta, k)
        assert np.allclose(seen(rw.Conductor(eta=eta, k=k), view), truth, rtol=1e-6, atol=0)


def test_gold_is_not_brighter_than_all_there_is_for_ever():
    """In a hollow ball of gold that shines, at its center: each wavelength gives 1 / (1 - F), at most 36."""
    shining = rw.Emission(1.0, both_sides=True)
    inside = rw.Scene(rw.Sphere(material=rw.Conductor("gold"), emission=shining))
    eye = rw.Camera((0, 0, 0), (0, 0, -1), width=16, height=16)
    gained, again = 1.02183, 0.96236
    for depth in (1, 2, 5):
        image = rw.render(
            inside, eye, rw.Path(max_depth=depth, roulette_depth=99), samples=1, progress=False
        ).rgb
        red = 1 + gained * (1 - again**depth) / (1 - again)
        assert np.allclose(image[..., 0], red, rtol=1e-3, atol=0), depth
    image = rw.render(inside, eye, samples=64, progress=False).rgb
    assert np.isfinite(image).all()
    red = 1 + gained / (1 - again)
    assert 0.9 * red < image[..., 0].mean() < 1.1 * red


def test_rough_gold_gives_no_more_than_smooth_gold_does():
    """Of light from everywhere, within the 0.5 % to which rough white is white, and four standard errors."""
    for alpha in (0.1, 0.4, 1.0):
        for angle in (0, 70):
            pixels = looked_at(rw.Conductor("Au", alpha=alpha), View("sky", alpha, angle), 64, 16).rgb
            pixels = pixels.reshape(-1, 3).astype(np.float64)
            mean, error = pixels.mean(axis=0), pixels.std(axis=0) / len(pixels) ** 0.5
            assert mean[0] < 1.0219 * 1.005 + 4 * error[0]
            assert mean[0] > mean[1] > mean[2] > 0.1
