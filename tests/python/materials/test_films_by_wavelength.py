"""Thin films in scenes whose paths carry wavelengths, beside the colors that they have without."""

import math

import numpy as np
import pytest

import raywright as rw

# Depends on wavelength formally, with a constant index: paths in such a scene carry wavelengths.
SAME = rw.materials.Cauchy(1.5, 0.0)


def looked(material, by_wave, samples):
    """The color of a plate in even light, at 45 degrees, with nothing but black behind it, and its error."""
    plate = rw.Mesh(
        [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]], [[0, 1, 2], [0, 2, 3]], material=material
    )
    behind = rw.Mesh(
        [[-99, -99, -1], [99, -99, -1], [99, 99, -1], [-99, 99, -1]],
        [[0, 1, 2], [0, 2, 3]],
        material=rw.Diffuse(0.0),
    )
    aside = rw.Sphere((0, 0, -50), 1.0, material=rw.Dielectric(SAME if by_wave else 1.5))
    camera = rw.Orthographic((0, 1, 1), direction=(0, -1, -1), up=(0, 1, -1), scale=0.1, width=16, height=16)
    scene = rw.Scene([plate, behind, aside], environment=rw.ConstantEnvironment(1.0))
    image = rw.render(scene, camera, rw.Path(), samples, progress=False)
    assert ("wavelength" in str(image.plan)) is by_wave
    values = image.rgb.astype(float).reshape(-1, 3)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))


@pytest.mark.parametrize(
    "material",
    [
        rw.materials.SoapFilm(320.0),
        rw.materials.ThinFilm(250.0, 1.47, base=rw.Dielectric(1.33)),
        rw.materials.ThinFilm(120.0, 1.8, base=rw.Conductor("Au")),
    ],
    ids=["soap", "oil on water", "gold"],
)
def test_wavelengths_together_have_the_color_of_the_film(material):
    color, error = looked(material, False, 64)
    seen, spread = looked(material, True, 4096)
    # RGB reflection at one angle has no noise of wavelengths; the other has.
    assert (spread < 0.02 * color.max()).all()
    assert (np.abs(seen - color) <= 3 * np.hypot(error, spread) + 2e-3 * color.max()).all(), (seen, color)
