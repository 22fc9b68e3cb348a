"""Pictures by wavelength: glass that disperses, spectra, and what stays red, green and blue."""

import copy
import math
import pickle

import numpy as np
import pytest

import raywright as rw
from raywright import _core

NM = np.arange(360.0, 831.0)
# Colors of daylight of each nm alone; the core's own table, which has tests of its own.
SEEN = np.array(
    [_core.spectrum_rgb([[nm - 1, 0.0], [nm, 1.0], [nm + 1, 0.0]], True) for nm in NM],
)
EVEN = np.array((1.205070523, 0.9482150893, 0.9089785943))
# IEC 61966-2-1, from its primaries and white.
TO_RGB = np.array(
    [
        [3.240969941905, -1.53738317757, -0.498610760293],
        [-0.9692436362809, 1.875967501508, 0.04155505740718],
        [0.05563007969699, -0.203976958889, 1.056971514243],
    ]
)
BK7 = rw.materials.glasses["N-BK7"]
# A dispersion formula with the same index everywhere.
SAME = rw.materials.Cauchy(1.5, 0.0)
# Relative precision of pictures in slow tests.
FINELY = 0.002


def daylit(share):
    """The color of shares of daylight, by an integral in steps of 1 nm."""
    return SEEN.T @ np.broadcast_to(share, NM.shape)


def looked(scene, camera, samples, integrator=None, seed=0):
    """Mean of a picture of one color, and the standard error of each channel, from independent pixels."""
    image = rw.render(scene, camera, integrator or rw.Path(), samples, seed=seed, progress=False)
    values = image.rgb.astype(float).reshape(-1, 3)
    return values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))


def check(scene, camera, samples, expected, integrator, most, finely):
    """Within three standard errors, which chance exceeds once in 370 a channel; the seed is fixed."""
    mean, error = looked(scene, camera, samples, integrator)
    scale = max(np.max(expected), 0.1)
    if finely:
        # The required number of samples, plus a margin.
        more = math.ceil(1.2 * (error.max() / (FINELY * scale)) ** 2)
        most = min(most, FINELY)
        if more > 1:
            mean, error = looked(scene, camera, more * samples, integrator, seed=1)
    print(mean, error, expected, (mean - expected) / error)
    assert (abs(mean - expected) <= 3 * error + 2e-4).all(), (mean, error, expected)
    assert (error <= most * scale).all(), error


@pytest.fixture(params=[False, pytest.param(True, marks=pytest.mark.slow)], ids=["quickly", "finely"])
def assert_looks(request):
    """What checks a picture of one color, to half a hundredth or some hundredths; slowly, to `FINELY`."""

    def looks(scene, camera, samples, expected, integrator=None, most=0.002):
        check(scene, camera, samples, expected, integrator, most, request.param)

    return looks


def downwards(side=8, scale=1e-3):
    """Parallel rays that come down to the origin."""
    return rw.Orthographic(
        (0, 0, 1.5), direction=(0, 0, -1), up=(0, 1, 0), scale=scale, width=side, height=side
    )


def plate(material=None, emission=None):
    return rw.Box((-9, -9, -1), (9, 9, 0), material=material or rw.Diffuse(), emission=emission)


def test_even_light_is_reddish_and_daylight_white(assert_looks):
    nothing = rw.Box((50, 50, 50), (51, 51, 51))
    for light, color in [
        (rw.textures.illuminants["E"], EVEN),
        (rw.textures.illuminants["D65"], (1, 1, 1)),
        (2 * rw.textures.illuminants["A"], 2 * np.array(rw.textures.illuminants["A"].rgb)),
        (rw.Blackbody(3000), rw.Blackbody(3000).rgb),
    ]:
        assert_looks(rw.Scene(nothing, environment=light), downwards(16), 64, np.array(color), most=0.005)


def test_all_that_glass_does_to_white_light_is_white(assert_looks):
    """A clear ball in white light from everywhere: what is ended honestly loses nothing."""
    for material in (rw.Dielectric(BK7), rw.Dielectric(rw.materials.glasses["N-SF11"], roughness=0.3)):
        ball = rw.Sphere((0, 0, 0), 1, material=material)
        camera = rw.Orthographic((0, 0, 5), (0, 0, 0), scale=1.4, width=16, height=16)
        assert_looks(rw.Scene(ball, environment=1.0), camera, 128, np.ones(3), most=0.01)
    # Also with two overlapping ones, if either disperses.
    inner = rw.Sphere((0, 0, 0), 0.6, material=rw.Dielectric(rw.materials.glasses["water"], priority=1))
    outer = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(BK7))
    assert_looks(rw.Scene([inner, outer], environment=1.0), camera, 128, np.ones(3), most=0.01)


def prism(angle=60.0):
    """A prism with its edge along y at the origin, whose first face has the normal -x."""
    a = math.radians(angle)
    corners = [(0, 0), (0, -2), (2 * math.sin(a), -2 * math.cos(a))]
    vertices = [(x, y, z) for y in (-1, 1) for x, z in corners]
    faces = [(0, 1, 2), (3, 5, 4), (0, 4, 1), (0, 3, 4), (1, 5, 2), (1, 4, 5), (2, 3, 0), (2, 5, 3)]
    mesh = rw.Mesh(vertices, faces, material=rw.Dielectric(BK7))
    return mesh


def deviation(index, incidence=50.0, angle=60.0):
    i, a = math.radians(incidence), math.radians(angle)
    inside = np.arcsin(np.sin(i) / index)
    return np.degrees(i - a + np.arcsin(index * np.sin(a - inside)))


def transmittance(index, incidence=50.0, angle=60.0):
    """What light loses at neither face, unpolarized at both."""
    i, a = math.radians(incidence), math.radians(angle)
    inside = np.arcsin(np.sin(i) / index)
    second = a - inside
    out = np.arcsin(index * np.sin(second))

    def through(before, after, n):
        s = (np.cos(before) - n * np.cos(after)) / (np.cos(before) + n * np.cos(after))
        p = (n * np.cos(before) - np.cos(after)) / (n * np.cos(before) + np.cos(after))
        return 1 - (s**2 + p**2) / 2

    return through(i, inside, index) * through(second, out, 1 / index)


@pytest.mark.parametrize(
    ("line", "truth"),
    # N-BK7 at an incidence of 50 degrees by Snell's law: the lines h, F, d, C.
    [
        (404.6561, 39.8354438709604),
        (486.1327, 39.1409736113545),
        (587.5618, 38.6536367592161),
        (656.2725, 38.4384117947059),
    ],
)
def test_a_prism_deviates_each_wavelength_as_computed(assert_looks, line, truth):
    """A far wall shines from the deviation of a line on: what is seen of it are the waves that go farther."""
    assert deviation(BK7.index(line / 1000)) == pytest.approx(truth, abs=1e-9)
    # The ray meets the first face, of normal -x, under 50 degrees, and turns towards the base.
    start = math.radians(50.0)
    towards = np.array((math.cos(start), 0.0, math.sin(start)))
    mesh = prism()
    meets = np.array((0.0, 0.0, -1.0))
    camera = rw.Orthographic(
        meets - 0.5 * towards, direction=towards, up=(0, 1, 0), scale=1e-3, width=8, height=8
    )

    def way(degrees):
        turned = start - math.radians(degrees)
        return np.array((math.cos(turned), 0.0, math.sin(turned)))

    far = 1e7
    near_edge, far_edge = far * way(truth), far * way(truth + 10)
    across = np.array((0.0, 0.2 * far, 0.0))
    corners = [near_edge - across, near_edge + across, far_edge + across, far_edge - across]
    wall = rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], emission=rw.Emission(1.0, both_sides=True))
    # The part of the nm bin below the line.
    share = np.clip(line - (NM - 0.5), 0, 1)
    expected = daylit(share * transmittance(BK7.index(NM / 1000)))
    scene = rw.Scene([mesh, wall])
    assert_looks(scene, camera, 512, expected, rw.Whitted(max_depth=3, contribution=0.0), most=0.01)


def reflectance(incidence, index):
    """Fresnel's, of unpolarized light, by the index beyond over that before."""
    inside = np.arcsin(np.sin(incidence) / index)
    s = (np.cos(incidence) - index * np.cos(inside)) / (np.cos(incidence) + index * np.cos(inside))
    p = (index * np.cos(incidence) - np.cos(inside)) / (index * np.cos(incidence) + np.cos(inside))
    return (s**2 + p**2) / 2


@pytest.mark.parametrize("ring", [(40.0, 41.0), (41.9, 42.6), (43.0, 50.0)])
def test_the_rainbow_is_at_its_angles(ring):
    """A drop of water sends back light: at the violet of its bow, at its red, and in the dark beyond.

    The bow of 400 nm has a radius of 40.567 degrees, that of 700 nm 42.440 (Descartes, 1637).
    """
    water = rw.materials.glasses["water"]
    index = water.index(NM / 1000)[:, None]
    impact = (np.arange(4000) + 0.5) / 4000
    i = np.arcsin(impact)
    r = np.arcsin(impact / index)
    back = np.degrees(abs(4 * r - 2 * i))
    assert [back[int(nm - 360)].max() for nm in (400, 700)] == pytest.approx([40.56742, 42.44048], abs=1e-4)
    mirrored = reflectance(i, index)
    once = (1 - mirrored) ** 2 * mirrored * ((ring[0] < back) & (back < ring[1]))
    outside = mirrored * ((ring[0] < 2 * np.degrees(i)) & (2 * np.degrees(i) < ring[1]))
    expected = daylit(((once + outside) * 2 * math.pi * impact).mean(axis=1) / 4)
    near, far = (1e6 * math.tan(math.radians(angle)) for angle in ring)
    light = rw.Disk((0, 0, 1e6), (0, 0, -1), far, inner_radius=near, emission=1.0)
    drop = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(water))
    camera = rw.Orthographic((0, 0, 2), direction=(0, 0, -1), up=(0, 1, 0), scale=2.0, width=32, height=32)
    image = rw.render(
        rw.Scene([drop, light]), camera, rw.Whitted(max_depth=3, contribution=0.0), 64, progress=False
    )
    mean = image.rgb.astype(float).mean(axis=(0, 1))
    error = np.sqrt((image.standard_error.astype(float) ** 2).sum(axis=(0, 1))) / 32**2
    print(mean, error, expected, (mean - expected) / error)
    assert (abs(mean - expected) <= 3 * error).all(), (mean, error, expected)
    assert (error <= 0.05 * abs(expected).max()).all()


def solid(outline, material):
    """A quadrilateral of the plane y = 0, anticlockwise seen from -y, drawn out along y."""
    vertices = [(x, y, z) for y in (-2, 2) for x, z in outline]
    sides = [(k, (k + 1) % 4) for k in range(4)]
    faces = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]
    faces += [face for a, b in sides for face in ((a, a + 4, b + 4), (a, b + 4, b))]
    return rw.Mesh(vertices, faces, material=material)


def test_the_edge_of_a_doublet_has_less_color_than_that_of_a_lens(assert_looks):
    """A wedge of crown, and one with flint on it: a wall that brightens evenly tells how light is bent."""
    crown, flint = rw.Dielectric(BK7), rw.Dielectric(rw.materials.glasses["F2"])
    a = math.radians(10.0)
    spreads = [glass.ior.index(0.4861327) - glass.ior.index(0.6562725) for glass in (crown, flint)]
    b = a * (1 - spreads[0] / spreads[1])
    t, u = math.tan(a), math.tan(b)
    first = solid([(0, -2), (1 + 2 * t, -2), (1 - 2 * t, 2), (0, 2)], crown)
    second = solid([(1 + 2 * t, -2), (2 + 2 * u, -2), (2 - 2 * u, 2), (1 - 2 * t, 2)], flint)
    n, m = (glass.ior.index(NM / 1000) for glass in (crown, flint))

    def bent(way, normal, index):
        """The angle of a ray beyond a face, and the share of light that goes through."""
        return normal + np.arcsin(np.sin(way - normal) / index), 1 - reflectance(abs(way - normal), index)

    straight = np.zeros_like(NM)
    entered, share = bent(straight, 0.0, n)
    colors = []
    for shapes in ([first], [first, second]):
        if len(shapes) == 1:
            left, last = bent(entered, a, 1 / n)
        else:
            between, cemented = bent(entered, a, m / n)
            left, last = bent(between, b, 1 / m)
            last = last * cemented
        far = 1e7
        heights = far * np.tan(left)
        middle, reach = heights[220], far * 0.01
        corners = [(far, y, middle + z) for z in (-2 * reach, 2 * reach) for y in (-far, far)]
        ramp = rw.ImageTexture(np.array([[[1.0] * 3], [[0.0] * 3]], np.float32), wrap="clamp")
        wall = rw.Mesh(
            corners,
            [(0, 1, 3), (0, 3, 2)],
            uv=[(0, 0), (1, 0), (0, 1), (1, 1)],
            emission=rw.Emission(ramp, both_sides=True),
        )
        assert (abs(heights - middle) < reach).all()
        expected = daylit(share * last * (0.5 + (heights - middle) / (2 * reach)))
        camera = rw.Orthographic(
            (-1, 0, 0), direction=(1, 0, 0), up=(0, 0, 1), scale=1e-3, width=16, height=16
        )
        scene = rw.Scene([*shapes, wall])
        assert_looks(scene, camera, 64, expected, rw.Whitted(max_depth=4, contribution=0.0), most=0.01)
        colors.append(abs(expected[0] - expected[2]))
    assert colors[1] < 0.2 * colors[0], colors


def test_a_formula_that_gives_one_index_gives_the_same_picture():
    """A gray room with glass, by wavelength and in red, green and blue: alike within both errors."""

    def room(ior):
        shapes = [
            rw.Plane((0, 0, 0), (0, 0, 1), material=rw.Diffuse(0.7)),
            rw.Box((-3, -1, 0), (-1.2, 1, 2), material=rw.Plastic(0.4, roughness=0.3)),
            rw.Sphere((0, 0, 1), 0.8, material=rw.Dielectric(ior)),
            rw.Sphere((1.5, 0.5, 0.5), 0.5, material=rw.Conductor(eta=0.2, k=3.9, roughness=0.4)),
            rw.Sphere((0, 0, 6), 1, emission=9.0),
        ]
        return rw.Scene(shapes, environment=0.2)

    camera = rw.Camera((0, -8, 3), (0, 0, 1), fov=40, width=12, height=12)
    pictures = [rw.render(room(ior), camera, samples=512, progress=False) for ior in (1.5, SAME)]
    assert pictures[1].plan["wavelengths"].chosen == "three a path"
    means = [picture.rgb.astype(float).mean(axis=(0, 1)) for picture in pictures]
    spreads = [picture.standard_error.astype(float) ** 2 for picture in pictures]
    errors = [np.sqrt(spread.sum(axis=(0, 1))) / 144 for spread in spreads]
    assert (abs(means[0] - means[1]) <= 3 * np.hypot(*errors)).all(), (means, errors)
    assert (errors[1] < 0.01 * means[1]).all(), (means, errors)


def test_spectra_reflect_and_shine_as_integrals_say(assert_looks):
    share = 0.1 + 0.8 / (1 + np.exp((NM - 580) / 15))
    spectrum = rw.Spectrum(NM, share)
    sky = rw.Scene(plate(rw.Diffuse(spectrum)), environment=1.0)
    assert_looks(sky, downwards(16), 64, daylit(share), most=0.005)
    assert np.allclose(spectrum.reflected_rgb, daylit(share), atol=1e-6)
    # An emitting wall, seen directly; and one that reflects itself infinitely, in a closed box.
    shining = rw.Spectrum([400, 500, 600, 700], [0.0, 2.0, 1.0, 3.0])
    for light, color in [
        (rw.Blackbody(4500), rw.Blackbody(4500).rgb),
        (3 * rw.textures.illuminants["D65"], (3, 3, 3)),
    ]:
        assert_looks(rw.Scene(plate(emission=light)), downwards(16), 64, np.array(color), most=0.01)
    scene = rw.Scene(plate(emission=shining))
    assert_looks(scene, downwards(16), 64, _core.spectrum_rgb(shining._rows(), False), most=0.01)
    box = rw.Box(
        (-1, -1, -1), (1, 1, 1), material=rw.Diffuse(spectrum), emission=rw.Emission(1.0, side="back")
    )
    camera = rw.Camera((0, 0, 0), (1, 0.2, 0.1), width=16, height=16)
    assert_looks(rw.Scene(box), camera, 64, daylit(1 / (1 - share)), most=0.02)


def test_metals_go_by_their_curves(assert_looks):
    mirror = rw.Scene(plate(rw.Conductor("Au")), environment=rw.textures.illuminants["D65"])
    # Computed by numpy from Mitsuba's measured data.
    assert_looks(mirror, downwards(16), 64, np.array((1.0219, 0.7824, 0.3434)), most=0.005)
    nm, eta, k = np.array(_core.metal_index("Au")).T
    own = rw.Conductor(eta=rw.Spectrum(nm, eta), k=rw.Spectrum(nm, k))
    assert_looks(rw.Scene(plate(own), environment=1.0), downwards(16), 64, np.array((1.0219, 0.7824, 0.3434)))


def test_media_absorb_by_wavelength(assert_looks):
    sigma = 0.5 + (NM - 360) / 470
    medium = rw.Homogeneous(rw.Spectrum(NM, sigma))
    slab = rw.Box((-9, -9, -1), (9, 9, 0), material=rw.MediumInterface(medium))
    assert_looks(rw.Scene(slab, environment=1.0), downwards(16), 64, daylit(np.exp(-sigma)), most=0.005)
    # The same by a grid, which light passes at random.
    grid = rw.GridMedium(
        np.full((2, 2, 2), 0.5), ((-9, -9, -1), (9, 9, 0)), absorption=rw.Spectrum(NM, 2 * sigma)
    )
    slab = rw.Box((-9, -9, -1), (9, 9, 0), material=rw.MediumInterface(grid))
    assert_looks(rw.Scene(slab, environment=1.0), downwards(16), 256, daylit(np.exp(-sigma)), most=0.02)
    # A medium that scatters everything is white in white light, whatever its spectrum.
    fog = rw.Homogeneous(0.0, rw.Spectrum(NM, 2 * sigma))
    ball = rw.Sphere((0, 0, 0), 1, material=rw.MediumInterface(fog))
    assert_looks(rw.Scene(ball, environment=1.0), downwards(16, 1.2), 64, np.ones(3), most=0.02)
    # And within glass that disperses.
    tinted = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(BK7, interior=fog))
    assert_looks(rw.Scene(tinted, environment=1.0), downwards(16, 1.2), 64, np.ones(3), most=0.03)


def test_glass_is_tinted_by_wavelength(assert_looks):
    """A slab of filter glass whose surfaces reflect as well, in white light from everywhere."""
    left = 0.05 + 0.9 / (1 + np.exp((NM - 560) / 20))
    filtered = rw.Spectrum(NM, left)
    slab = rw.Box((-9, -9, -2), (9, 9, 0), material=rw.Dielectric(1.0, transmittance=filtered, distance=1.0))
    assert_looks(rw.Scene(slab, environment=1.0), downwards(16), 64, daylit(left**2), most=0.005)
    slab = rw.Box((-9, -9, -2), (9, 9, 0), material=rw.Dielectric(1.5, transmittance=filtered, distance=2.0))
    mirrored = 0.2**2
    through = (1 - mirrored) ** 2 * left / (1 - mirrored * left)
    assert_looks(rw.Scene(slab, environment=1.0), downwards(16), 64, daylit(mirrored + through), most=0.01)
    # Full transmittance means no interior; and values beyond the makers' range are not extrapolated.
    assert rw.Dielectric(transmittance=rw.Spectrum([300, 900], [1, 1])).interior is None
    assert rw.Dielectric(transmittance=filtered).interior.absorption.at(500) == pytest.approx(
        -math.log(left[140])
    )
    for bad in (rw.Spectrum([400, 700], [0.5, 0.5]), rw.Spectrum([300, 600, 900], [1, 0, 1])):
        with pytest.raises(ValueError, match="transmittance must be above 0 and at most 1 from 360 to 830"):
            rw.Dielectric(transmittance=bad)
    with pytest.raises(ValueError, match=r"got 1\.2 at 360 nm"):
        rw.Dielectric(transmittance=rw.Spectrum([300, 900], [1.2, 1.2]))


def test_colors_of_red_green_and_blue_are_upsampled_to_themselves():
    """Of constants exactly, and of textures as a table has them; what is gray, exactly flat."""
    rng = np.random.default_rng(5)
    for color in [*rng.uniform(0.02, 0.95, (30, 3)), (0.9, 0.05, 0.05), (0.02, 0.02, 0.7), (0.8, 0.79, 0.1)]:
        for bounded in (True, False):
            exact, table = (_core.smooth_spectrum(color, bounded, way, NM.tolist()) for way in (False, True))
            assert np.abs(daylit(exact) - color).max() < 2e-5, color
            assert np.abs(daylit(table) - color).max() < 0.01 * np.max(color), (color, daylit(table))
            assert np.min(exact) >= 0
            assert not bounded or np.max(exact) <= 1.021
            # Jakob and Hanika's spectra are smooth: they change little from nm to nm.
            assert np.abs(np.diff(exact)).max() < 0.06 * np.max(exact)
    assert set(_core.smooth_spectrum((0.3,) * 3, True, True, NM.tolist())) == {0.3}


def test_colored_surfaces_and_lights_look_as_they_do_without_wavelengths(assert_looks):
    pixels = np.linspace(0.05, 0.9, 12, dtype=np.float32).reshape(2, 2, 3)
    textures = [(0.7, 0.2, 0.1), rw.ImageTexture(pixels, filter="nearest"), rw.Checker((0.1, 0.6, 0.2), 0.5)]
    clear = rw.Sphere((50, 0, 50), 1, material=rw.Dielectric(SAME))
    for value in textures:
        surface = rw.Mesh(
            [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)],
            [(0, 1, 2), (0, 2, 3)],
            uv=[(0, 0), (1, 0), (1, 1), (0, 1)],
            material=rw.Diffuse(value),
        )
        camera = rw.Orthographic(
            (0.3, 0.4, 1), direction=(0, 0, -1), up=(0, 1, 0), scale=1e-3, width=12, height=12
        )
        plain = rw.render(rw.Scene(surface, environment=1.0), camera, rw.Direct(), 4, progress=False)
        scene = rw.Scene([surface, clear], environment=1.0)
        assert_looks(scene, camera, 64, plain.rgb[0, 0].astype(float), rw.Direct(), most=0.02)
    for light in [
        rw.PointLight((0, 0, 2), (3.0, 1.0, 0.5)),
        rw.SpotLight((0, 0, 2), (0, 0, 0), (0.5, 2.0, 3.0)),
        rw.DirectionalLight((0, 0, -1), (1.0, 0.3, 0.6)),
    ]:
        plain = rw.render(rw.Scene(plate(), lights=[light]), downwards(), rw.Direct(), 1, progress=False)
        scene = rw.Scene([plate(), clear], lights=[light])
        assert_looks(scene, downwards(16), 64, plain.rgb[0, 0].astype(float), rw.Direct(), most=0.02)


def test_errors_cover_with_wavelengths():
    """Of 768 intervals of 95 %, those of a pixel together, fewer than nine in ten once in 10^5 pictures."""
    nothing = rw.Box((50, 50, 50), (51, 51, 51))
    scene = rw.Scene([nothing], environment=rw.textures.illuminants["E"])
    image = rw.render(scene, downwards(16), samples=64, seed=3, progress=False)
    low, high = image.interval(0.95)
    covered = ((low <= EVEN) & (high >= EVEN)).mean()
    assert covered > 0.9, covered


def test_the_plan_says_why():
    ball = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(BK7))
    plain = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(1.5))
    assert "wavelengths" in rw.Scene(ball).plan().needed
    assert "wavelengths" in rw.Scene(plain).plan().left_out
    assert "the ior of glass" in rw.Scene(ball).wavelengths
    assert rw.Scene(plain, environment=(1, 0.5, 0.2)).wavelengths is None
    assert "Blackbody" in rw.Scene(plain, environment=rw.Blackbody(4000)).wavelengths
    assert "reflectance" in rw.Scene(plate(rw.Diffuse(rw.textures.illuminants["E"] * 0.5))).wavelengths
    inside = rw.Instance([ball], np.eye(4))
    assert rw.Scene(inside).wavelengths == rw.Scene(ball).wavelengths
    image = rw.render(rw.Scene(ball, environment=1.0), downwards(2), samples=1, progress=False)
    assert image.plan["wavelengths"].why == rw.Scene(ball).wavelengths
    image = rw.render(rw.Scene(plain, environment=1.0), downwards(2), samples=1, progress=False)
    assert "wavelengths" not in [row.what for row in image.plan.rows]


@pytest.mark.parametrize("integrator", [rw.integrators.ConeTraced(), rw.integrators.BeamTraced()])
def test_who_knows_no_wavelengths_says_so(integrator):
    scene = rw.Scene(rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(BK7)), environment=1.0)
    with pytest.raises(ValueError, match="does not support wavelengths"):
        rw.render(scene, downwards(2), integrator, 1, progress=False)


def test_spectra_are_checked_and_copied():
    for wavelengths, values in [
        ([400], [1]),
        ([500, 400], [1, 1]),
        ([400, 500], [1, -1]),
        ([400, 500], [1, math.nan]),
        ([400, 500], [1, 1, 1]),
    ]:
        with pytest.raises(ValueError, match=r"wavelengths|values"):
            rw.Spectrum(wavelengths, values)
    with pytest.raises(TypeError, match="roughness must be a texture or one number, got a Spectrum"):
        rw.materials.OrenNayar(0.5, rw.Spectrum([400, 500], [0.5, 0.5]))
    with pytest.raises(ValueError, match="reflectance must be between 0 and 1"):
        rw.Diffuse(rw.Spectrum([400, 500], [0.5, 1.5]))
    for bad in (0, -3, 400, math.inf):
        with pytest.raises(ValueError, match="kelvin"):
            rw.Blackbody(bad)
    with pytest.raises(KeyError, match="D65"):
        rw.textures.illuminants["F99"]
    spectrum = rw.Spectrum([400, 600], [0, 1])
    assert pickle.loads(pickle.dumps(spectrum)) == copy.deepcopy(spectrum) == spectrum
    assert [spectrum.at(x) for x in (399, 500, 601)] == [0, 0.5, 0]
    assert rw.Blackbody(5000) == rw.Blackbody(5000) != rw.Blackbody(5001)
    assert rw.Blackbody(5000, 3.0).luminance == pytest.approx(3.0)
    assert (3 * rw.textures.illuminants["A"]).luminance == pytest.approx(3.0)
    # Values of the CIE (CIE 015:2018), to its four digits.
    for name, place in {
        "A": (0.4476, 0.4074),
        "D65": (0.3127, 0.3290),
        "E": (0.3333, 0.3333),
        "F2": (0.3721, 0.3751),
        "F7": (0.3129, 0.3292),
        "F11": (0.3805, 0.3769),
    }.items():
        # Sums over every fifth nm, as in their definition; light is relative to daylight here.
        light = rw.textures.illuminants[name].at(NM[::5]) / rw.textures.illuminants["D65"].at(NM[::5])
        xyz = np.linalg.solve(TO_RGB, SEEN[::5].T @ light)
        assert xyz[:2] / xyz.sum() == pytest.approx(place, abs=2e-4), name
        assert rw.textures.illuminants[name].luminance == pytest.approx(1.0)
    with pytest.raises(ValueError, match="ior must be above 0 from 360"):
        rw.Scene(rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(rw.materials.Cauchy(1.0, -1.0)))).build()
