"""Glass with a color at its surface: stained glass, slides, what loads from files as such."""

import copy
import pickle

import numpy as np
import pytest

import raywright as rw

SKY = rw.ConstantEnvironment(1.0)
# Straight down, so that all rays hit flat glass at right angles.
DOWN = rw.Orthographic((0, 0, 5), (0, 0, 0), scale=2.0, width=8, height=8)
COLOR = np.array((0.9, 0.5, 0.2))


def sheet(half, material):
    """A square about the middle, across which u goes along x and v along y."""
    corners = [(-half, -half, 0), (half, -half, 0), (half, half, 0), (-half, half, 0)]
    return rw.Polygon(corners, material=material)


def slab(material):
    return rw.Box((-9, -9, -1), (9, 9, 0), material=material)


def seen(*shapes, way=None, samples=4, environment=SKY, **more):
    scene = rw.Scene(shapes, environment=environment)
    return rw.render(scene, DOWN, way or rw.Path(), samples, progress=False, **more).rgb


@pytest.mark.parametrize("way", [rw.Path(), rw.Whitted()], ids=["path", "whitted"])
def test_of_an_index_that_is_around_it_a_solid_shows_its_color_twice_and_a_pane_once(way):
    solid = seen(slab(rw.materials.Tinted(rw.Dielectric(1.0), COLOR)), way=way)
    assert np.allclose(solid, COLOR**2, rtol=1e-6, atol=0)
    pane = sheet(9, rw.materials.Tinted(rw.ThinDielectric(1.0), COLOR))
    assert np.allclose(seen(pane, way=way), COLOR, rtol=1e-6, atol=0)


@pytest.mark.parametrize("ior", [1.5, 2.4])
def test_all_ways_to_and_fro_are_tinted_at_every_surface(ior):
    # The tints scale reflection by r and transmission by t, on either side. Whitted's tree is exact.
    mirror, r, t = ((ior - 1) / (ior + 1)) ** 2, 0.8, COLOR
    inside = r * mirror
    through = (t * (1 - mirror)) ** 2 / (1 - inside**2)
    back = r * mirror + (t * (1 - mirror)) ** 2 * inside / (1 - inside**2)
    glass = slab(rw.materials.Tinted(rw.Dielectric(ior), t, r))
    every = rw.Whitted(max_depth=40, contribution=0.0)
    lit = rw.Plane((0, 0, -2), material=rw.Diffuse(0.0), emission=1.0)
    dark = rw.Plane((0, 0, -2), material=rw.Diffuse(0.0))
    assert np.allclose(seen(glass, lit, way=every, environment=None), through, rtol=1e-6, atol=0)
    assert np.allclose(seen(glass, dark, way=every), back, rtol=1e-6, atol=0)
    # Paths agree, within five standard errors of the mean over all pixels.
    image = rw.render(rw.Scene([glass, lit]), DOWN, rw.Path(), 1024, progress=False)
    error = np.sqrt(np.mean(image.standard_error.astype(float) ** 2, axis=(0, 1)) / 64)
    assert (np.abs(image.rgb.mean(axis=(0, 1)) - through) < 5 * error).all()


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("again", [True, False])
def test_rough_glass_shows_its_colors_as_much_as_clear_one(distribution, again):
    # With the same gray in both, each sample is the untinted one times a power: one factor per crossing.
    rough = rw.Dielectric(1.5, 0.5, distribution=distribution, multiple_scattering=again)
    floor = rw.Plane((0, 0, -1), material=rw.Diffuse(0.0), emission=1.0)
    below = sheet(9, rough)
    tinted = sheet(9, rw.materials.Tinted(rough, 0.5, 0.5))
    how = {"samples": 8, "seed": 3, "environment": None}
    one = rw.Path(max_depth=1, roulette_depth=9)
    plain = seen(below, floor, way=one, **how)
    assert plain.max() > 0
    assert np.allclose(seen(tinted, floor, way=one, **how), 0.5 * plain, rtol=1e-6)


def test_of_white_it_is_what_it_is_without():
    plain, glass = slab(rw.Dielectric(1.5)), slab(rw.materials.Tinted(rw.Dielectric(1.5)))
    assert np.array_equal(seen(plain, samples=16), seen(glass, samples=16))


def test_a_slide_shows_its_picture():
    pixels = np.random.default_rng(1).uniform(0.1, 1, (4, 4, 3))
    slide = rw.ImageTexture(pixels, linear=True, filter="nearest")
    pane = sheet(1, rw.materials.Tinted(rw.ThinDielectric(1.0), slide))
    picture = seen(pane)
    assert np.allclose(picture[::2, ::2], pixels.astype(np.float32), rtol=1e-5)
    assert np.array_equal(picture[1::2, 1::2], picture[::2, ::2])


def test_it_is_described_and_compared():
    made = rw.materials.Tinted(rw.Dielectric(1.4), (1, 0.5, 0.25), reflectance=0.5)
    assert pickle.loads(pickle.dumps(made)) == copy.deepcopy(made) == made
    assert made != rw.materials.Tinted(rw.Dielectric(1.4), (1, 0.5, 0.25))


@pytest.mark.parametrize(
    ("arguments", "error", "message"),
    [
        ((rw.Diffuse(),), TypeError, "base must be a Dielectric or a ThinDielectric, got Diffuse"),
        ((rw.Dielectric(), 1.5), ValueError, "transmittance must be between 0 and 1, got 1.5"),
        ((rw.Dielectric(), 1.0, -0.5), ValueError, "reflectance must be between 0 and 1, got -0.5"),
        (
            (rw.ThinDielectric(interior=rw.Homogeneous(1.0)),),
            ValueError,
            "base must have no interior",
        ),
    ],
)
def test_what_it_cannot_be_is_refused(arguments, error, message):
    with pytest.raises(error, match=message):
        rw.materials.Tinted(*arguments)


@pytest.mark.parametrize("kind", ["dielectric", "roughdielectric", "thindielectric"])
def test_glass_of_mitsuba_keeps_the_colors_of_its_surface(kind):
    texture = {"type": "checkerboard", "color0": 0.25, "color1": 0.75}
    bsdf = {"type": kind, "specular_transmittance": texture, "specular_reflectance": 0.5}
    ball = {"type": "sphere", "bsdf": bsdf}
    shot = rw.from_mitsuba({"type": "scene", "a": ball, "sensor": {"type": "perspective"}})
    (shape,) = shot.scene.shapes
    assert isinstance(shape.material, rw.materials.Tinted)
    assert shape.material.reflectance == (0.5, 0.5, 0.5)
    assert isinstance(shape.material.transmittance, rw.ImageTexture)
    assert isinstance(shape.material.base, rw.ThinDielectric if kind == "thindielectric" else rw.Dielectric)
