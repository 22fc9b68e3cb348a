"""Clear solids that have a tint: what is left of light after a way inside."""

import copy
import math
import pickle

import media_scenes as media
import numpy as np
import pytest

import raywright as rw

SKY = rw.ConstantEnvironment(1.0)


def test_a_tint_is_the_interior_that_beers_law_has():
    tint = rw.Dielectric(1.4, 0.2, transmittance=(0.5, 0.25, 1.0), distance=2.0)
    absorption = (math.log(2) / 2, math.log(4) / 2, 0.0)
    assert tint == rw.Dielectric(1.4, 0.2, interior=rw.Homogeneous(absorption))
    assert rw.Dielectric(transmittance=0.5).interior == rw.Homogeneous(math.log(2))
    assert pickle.loads(pickle.dumps(tint)) == copy.deepcopy(tint) == tint


def test_what_takes_nothing_is_no_medium():
    clear = rw.Dielectric(transmittance=(1, 1, 1), distance=3)
    assert clear == rw.Dielectric()
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1, material=clear)], environment=SKY)
    assert "smoke and haze" not in scene.plan().needed


def slab(ior, share, thickness):
    material = rw.Dielectric(ior, transmittance=share, distance=thickness)
    return rw.Box((-media.FLAT, -media.FLAT, -thickness), (media.FLAT, media.FLAT, 0), material=material)


@pytest.mark.parametrize(("ior", "share", "thickness"), [(1.5, 0.5, 1.0), (2.4, 0.9, 0.25)])
def test_a_slab_lets_through_what_its_passes_sum_to(ior, share, thickness):
    # With all internal reflections: (1 - R)² τ / (1 - R² τ²) is transmitted, R + R (1 - R)² τ² / (1 - R² τ²)
    # reflected.
    mirror = ((ior - 1) / (ior + 1)) ** 2
    series = (1 - mirror) ** 2 / (1 - (mirror * share) ** 2)
    through, back = series * share, mirror + mirror * series * share**2
    lit = rw.Plane((0, 0, -2), material=rw.Diffuse(0.0), emission=1.0)
    below = rw.Scene([slab(ior, share, thickness), lit])
    media.assert_seen(below, media.looking(), 1024, through, most=0.01)
    dark = rw.Plane((0, 0, -2), material=rw.Diffuse(0.0))
    above = rw.Scene([slab(ior, share, thickness), dark], environment=SKY)
    media.assert_seen(above, media.looking(), 1024, back, most=0.04)


@pytest.mark.parametrize("way", [rw.Path(), rw.Direct(), rw.Whitted()], ids=["path", "direct", "whitted"])
def test_of_an_index_that_is_around_it_the_tint_alone_is_seen(way):
    image = rw.render(
        rw.Scene([slab(1.0, (0.5, 0.25, 1.0), 2.0)], environment=SKY),
        media.looking(),
        way,
        4,
        progress=False,
    )
    assert np.allclose(image.rgb, (0.5, 0.25, 1.0), rtol=1e-6, atol=0)


def test_whitted_sums_the_passes_that_its_depth_allows():
    # Without an internal reflection: (1 - R)² τ, and two of them add R² τ² of it.
    lit = rw.Plane((0, 0, -2), material=rw.Diffuse(0.0), emission=1.0)
    scene = rw.Scene([slab(1.5, 0.5, 1.0), lit])
    mean, _ = media.seen(scene, media.looking(), 1, rw.Whitted(max_depth=12, contribution=0.0))
    assert mean == pytest.approx(0.96**2 * 0.5 / (1 - 0.02**2), rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"transmittance": 0.0}, r"transmittance must be above 0, got 0\.0"),
        ({"transmittance": (0.5, 0, 1)}, r"transmittance must be above 0, got \(0\.5, 0, 1\)"),
        ({"transmittance": 1.5}, r"transmittance must be between 0 and 1, got 1\.5"),
        ({"transmittance": -0.5}, r"transmittance must be between 0 and 1, got -0\.5"),
        ({"transmittance": math.nan}, r"transmittance must be finite"),
        ({"transmittance": (0.5, 0.5)}, r"transmittance must be one number or 3, got shape \(2,\)"),
        ({"transmittance": 0.5, "distance": 0}, r"distance must be greater than 0, got 0"),
        ({"transmittance": 0.5, "distance": 1e-320}, r"distance is too small, .* infinite: 1e-320 for 0\.5"),
        ({"distance": 2.0}, r"distance requires transmittance, got 2\.0"),
        (
            {"transmittance": 0.5, "interior": rw.Homogeneous(1.0)},
            r"only one of interior and transmittance can be given",
        ),
    ],
)
def test_what_is_no_tint_is_refused_in_one_line(arguments, message):
    with pytest.raises(ValueError, match=message) as caught:
        rw.Dielectric(**arguments)
    assert "\n" not in str(caught.value)
