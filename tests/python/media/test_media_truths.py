"""Light in media against closed forms and solved equations of radiative transfer."""

import math

import media_scenes as media
import numpy as np
import pytest
from long_runs import error_of_part, part

import raywright as rw

SKY = rw.ConstantEnvironment(1.0)
slow = pytest.mark.slow
BLACK = rw.Diffuse(0.0)


def ground(height, reflectance=0.0):
    return rw.Plane((0, 0, height), material=rw.Diffuse(reflectance))


@pytest.mark.parametrize("depth", [1.0, 5.0, 10.0])
def test_light_is_dimmed_by_beers_law(depth):
    scene = rw.Scene([media.slab(media.of_depth(depth, 0.0))], environment=SKY)
    for way in (rw.Path(), rw.Direct(), rw.Whitted()):
        mean, error = media.seen(scene, media.looking(), 1, way)
        assert mean == pytest.approx(math.exp(-depth), rel=1e-6)
        assert error < 1e-7


def test_a_slab_of_glass_that_absorbs():
    # Stokes, 1862: index 1.5, optical depth 1, seen straight on.
    glass = rw.Dielectric(1.5, interior=media.of_depth(1.0, 0.0))
    solid = rw.Box((-media.FLAT, -media.FLAT, -1), (media.FLAT, media.FLAT, 0), material=glass)
    through = rw.Scene([solid], environment=SKY)
    media.assert_seen(through, media.looking(), 512, 0.0449900804155487 + 0.339111122903388)
    back = rw.Scene([solid, ground(-2.0)], environment=SKY)
    media.assert_seen(back, media.looking(), 1024, 0.0449900804155487, most=0.01)


def test_a_flask_of_what_absorbs():
    """Two panes of index 1.5, each of which reflects R = 2 r / (1 + r) with r = 0.04, and an optical depth of
    1 between (Stokes, 1862): T² e⁻¹ / (1 - R² e⁻²) comes through, and comes back R + R T² e⁻² over that."""
    reflected, left = 0.08 / 1.04, math.exp(-1)
    through = (1 - reflected) ** 2 * left / (1 - (reflected * left) ** 2)
    back = reflected * (1 + through * left)
    pane = rw.ThinDielectric(1.5, interior=media.of_depth(1.0, 0.0))
    flask = rw.Box((-media.FLAT, -media.FLAT, -1), (media.FLAT, media.FLAT, 0), material=pane)
    media.assert_seen(rw.Scene([flask], environment=SKY), media.looking(), 512, through + back, most=0.003)
    black = rw.Scene([flask, ground(-2.0)], environment=SKY)
    media.assert_seen(black, media.looking(), 2048, back, most=0.01)
    # Straight transmission is no bounce, and shadow rays pass.
    media.assert_seen(
        rw.Scene([flask], environment=SKY),
        media.looking(),
        512,
        (1 - reflected) ** 2 * left,
        rw.Path(0),
        0.005,
    )
    sun = rw.DirectionalLight((0, 0, -1), math.pi)
    lit = rw.Scene([flask, ground(-2.0, 0.5)], lights=[sun])
    below = media.looking(distance=-1.5)
    media.assert_seen(lit, below, 4, 0.5 * (1 - reflected) ** 2 * left, rw.Path(1))
    # From a lamp aside, by Fresnel's formulas.
    lamp = rw.PointLight((1.5, 0, 1), 4.0)
    cosine = 3 / math.hypot(1.5, 3)
    within = math.sqrt(1 - (1 - cosine**2) / 1.5**2)
    across, along = (
        (cosine - 1.5 * within) / (cosine + 1.5 * within),
        (1.5 * cosine - within) / (1.5 * cosine + within),
    )
    once = (across**2 + along**2) / 2
    passed = (1 - 2 * once / (1 + once)) ** 2 * math.exp(-1 / cosine)
    aside = rw.Scene([flask, ground(-2.0, 0.5)], lights=[lamp])
    irradiance = 4 * cosine / (1.5**2 + 3**2)
    media.assert_seen(aside, below, 4, 0.5 / math.pi * irradiance * passed, rw.Path(1))


def test_a_flask_of_white_smoke_is_invisible():
    smoke = rw.Homogeneous(0.0, (0.5, 2.0, 5.0), rw.HenyeyGreenstein(0.5))
    flask = rw.Sphere((0, 0, 0), 1.0, material=rw.ThinDielectric(1.5, interior=smoke))
    camera = rw.Camera((0, 0, 3), (0, 0, 0), fov=30, width=16, height=16)
    for way, samples in ((rw.Path(), 16), (rw.Bidirectional(), 64)):
        image = rw.render(rw.Scene([flask], environment=SKY), camera, way, samples, progress=False)
        values = image.rgb.reshape(-1, 3).astype(float)
        error = values.std(axis=0, ddof=1) / 16
        assert (np.abs(values.mean(axis=0) - 1) <= 4 * error + 1e-6).all(), (values.mean(axis=0), error)
        assert error.max() < 0.02


@pytest.mark.parametrize(
    ("depth", "share"), [(1.0, 0.296997075145081), pytest.param(20.0, 0.00125, marks=slow)]
)
def test_a_ball_that_absorbs_lets_through_what_its_chords_do(depth, share):
    # van de Hulst, 1957. The picture is a square around the disk.
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(media.of_depth(depth, 0.0)))
    scene = rw.Scene([ball, ground(-2.0)], lights=[], environment=SKY)
    lit = rw.Plane((0, 0, -2), material=BLACK, emission=1.0)
    scene = rw.Scene([ball, lit])
    camera = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=2.0, width=100, height=100)
    mean = media.seen(scene, camera, 32 if depth < 10 else 256)[0]
    disk = math.pi / 4
    assert (mean - (1 - disk)) / disk == pytest.approx(share, rel=0.002, abs=5e-5)


def test_an_absorbing_slab_lets_through_diffuse_light():
    # The slab transmits 2 E3(0.7) of diffuse light, and the matt sheet below reflects half.
    scene = rw.Scene([media.slab(media.of_depth(0.7, 0.0)), ground(-1.5, 0.5)], environment=SKY)
    below = media.looking(distance=-1.2)
    for way in (rw.Path(1), rw.Direct()):
        media.assert_seen(scene, below, 256, 0.5 * 0.332122324321842, way)


def test_gas_that_glows_before_a_wall_that_does():
    gas = rw.Homogeneous(absorption=0.8, emission=1.6)
    wall = rw.Plane((0, 0, -3), material=BLACK, emission=5.0)
    scene = rw.Scene([media.slab(gas, 3.0), wall])
    mean, error = media.seen(scene, media.looking(), 1)
    assert mean == pytest.approx(2.27215385986824, rel=1e-6)
    assert error < 1e-7
    # The same by a grid, which needs random sampling.
    box = [(-1, -1, -3), (1, 1, 0)]
    flame = rw.GridMedium(np.full((2, 2, 9), 2.0), box, absorption=0.4, emission=0.8)
    shape = rw.Box(*box, material=rw.MediumInterface(flame))
    media.assert_seen(rw.Scene([shape, wall]), media.looking(), 1024, 2.27215385986824)
    apart = rw.GridMedium(np.full((2, 2, 9), 2.0), box, absorption=0.4, emission=np.full((1, 3, 2), 1.6))
    shape = rw.Box(*box, material=rw.MediumInterface(apart))
    media.assert_seen(rw.Scene([shape, wall]), media.looking(), 1024, 2.27215385986824)


@pytest.mark.parametrize(
    ("albedo", "cosine", "expected"),
    [
        pytest.param(0.5, 0.1, 0.241720776436028, marks=slow),
        (0.5, 0.5, 0.160144433435235),
        pytest.param(0.5, 1.0, 0.115225877707205, marks=slow),
        pytest.param(0.9, 0.5, 0.5079389, marks=slow),
        pytest.param(0.9, 1.0, 0.414947479130817, marks=slow),
        pytest.param(0.95, 0.1, 0.732738042447422, marks=slow),
        pytest.param(0.95, 0.5, 0.626176773375176, marks=slow),
        pytest.param(0.95, 1.0, 0.535540989172548, marks=slow),
        pytest.param(0.99, 0.5, 0.815139898355215, marks=slow),
        pytest.param(0.99, 1.0, 0.752720717160297, marks=slow),
    ],
)
def test_half_spaces_reflect_what_chandrasekhar_says(albedo, cosine, expected):
    scene = rw.Scene([media.slab(media.of_depth(100.0, albedo)), ground(-2.0)], environment=SKY)
    media.assert_seen(scene, media.looking(cosine), 1024, expected, most=0.004)


@pytest.mark.parametrize(
    ("albedo", "expected"), [(0.5, 0.0394217495018523), pytest.param(0.95, 0.175011324877836, marks=slow)]
)
def test_half_spaces_scatter_sunlight_where_they_should(albedo, expected):
    sun = rw.DirectionalLight((0, 0, -1), 1.0)
    scene = rw.Scene([media.slab(media.of_depth(100.0, albedo))], lights=[sun])
    media.assert_seen(scene, media.looking(0.5), 1024, expected, most=0.004)


@pytest.mark.parametrize(
    "extinction",
    [pytest.param(60, marks=slow), pytest.param(600, marks=slow), pytest.param(6000, marks=slow), 1e6],
)
def test_no_optical_depth_is_lost_at_a_boundary(extinction):
    # Independent of density: half a space's albedo, of 0.9, from straight above.
    medium = rw.Homogeneous(0.1 * extinction, 0.9 * extinction)
    box = rw.Box((-5, -5, -1), (5, 5, 0), material=rw.MediumInterface(medium))
    scene = rw.Scene([box, ground(-2.0)], environment=SKY)
    media.assert_seen(scene, media.looking(), 1536, 0.414947479130817)


SLABS = {
    "1": (2.0, 0.9, 0.75, [0.0973946386706, 0.233569487515], [0.660957700163, 0.415890432957]),
    "3": (1.0, 0.5, 0.0, [0.0991191855366, 0.149753839073], [0.446058389891, 0.23028520169]),
    "4": (8.0, 0.99, 0.75, [0.433048223114, 0.587260886166], [0.416335702811, 0.275956515456]),
    "9": (0.001, 1.0, 0.0, [0.000499750381796, 0.00099900185965], [0.999500249618, 0.99900099814]),
}


@pytest.mark.parametrize("name", ["3", *(pytest.param(name, marks=slow) for name in "149")])
def test_slabs_reflect_and_let_through_what_discrete_ordinates_say(name):
    # van de Hulst 1980; Stamnes 1988. Under an even sky, over black.
    depth, albedo, g, reflected, let_through = SLABS[name]
    scene = rw.Scene([media.slab(media.of_depth(depth, albedo, g)), ground(-2.0)], environment=SKY)
    for cosine, above, below in zip((1.0, 0.5), reflected, let_through, strict=True):
        # One path in a thousand finds light scattered by a thin slab.
        most = 0.004 if depth > 0.01 else 0.1
        count, share = (1024, 1) if name == "3" else (8192, 4)
        media.assert_seen(scene, media.looking(cosine), count, above, most=most, share=share)
        under = media.looking(cosine, below=True, distance=1.5 / cosine)
        media.assert_seen(scene, under, 512 if name == "3" else 4096, below, most=most, share=share)


@slow
def test_a_deep_white_slab():
    scene = rw.Scene([media.slab(media.of_depth(64.0, 1.0, 0.75)), ground(-2.0)], environment=SKY)
    for cosine, expected in [(1.0, 0.902856379523), (0.5, 0.933540952854)]:
        media.assert_seen(scene, media.looking(cosine), 512, expected, most=0.006, share=4)
    media.assert_seen(
        scene, media.looking(below=True, distance=1.5), 1024, 0.0971436204762, most=0.02, share=4
    )


@slow
def test_a_slab_over_ground_in_the_sun():
    slab = media.slab(media.of_depth(8.0, 0.99, 0.75))
    scene = rw.Scene([slab, ground(-2.0, 0.7)], environment=SKY)
    media.assert_seen(scene, media.looking(), 1024, 0.583448663125, most=0.004)
    sunny = rw.Scene([slab, ground(-2.0, 0.7)], lights=[rw.DirectionalLight((0, 0, -1), math.pi)])
    media.assert_seen(sunny, media.looking(distance=-1.5), 1024, 0.7 * 0.66720867236, most=0.01)


@slow
def test_a_slab_that_scatters_within_surfaces():
    # Albedo 1, optical depth 2, index 1.33: Fresnel's reflection at both surfaces with it.
    water = rw.Dielectric(1.33, interior=media.of_depth(2.0, 1.0))
    solid = rw.Box((-media.FLAT, -media.FLAT, -1), (media.FLAT, media.FLAT, 0), material=water)
    scene = rw.Scene([solid, ground(-2.0)], environment=SKY)
    media.assert_seen(scene, media.looking(), 4096, 0.487683267974, most=0.004)
    media.assert_seen(scene, media.looking(below=True, distance=1.5), 4096, 0.512316732016, most=0.004)


def hg(cosine, g):
    return (1 - g * g) / (4 * math.pi * (1 + g * g - 2 * g * cosine) ** 1.5)


@pytest.mark.parametrize(
    ("w", "depth", "mu0", "mu", "g", "azimuth", "expected"),
    [
        (1.0, 0.5, 1.0, 0.5, 0.0, 0.0, (0.129478306641928, 0.119325609270596)),
        (0.9, 2.0, 0.5, 0.5, 0.75, 60.0, (0.0305162257168885, 0.0145956221937679)),
        (0.5, 1.0, 0.8, 0.6, 0.0, 0.0, (0.06756330241265561, None)),
    ],
)
def test_light_that_is_scattered_once(w, depth, mu0, mu, g, azimuth, expected):
    # Chandrasekhar 1960: the sun's irradiance is pi across its rays.
    sun = rw.DirectionalLight((math.sqrt(1 - mu0 * mu0), 0, -mu0), math.pi)
    scene = rw.Scene([media.slab(media.of_depth(depth, w, g))], lights=[sun])
    up, down = expected
    # Light continues towards the viewer, so that the viewer looks from the other side.
    camera = media.looking(mu, azimuth=azimuth + 180)
    media.assert_seen(scene, camera, 1024, up, rw.Path(1))
    if down is not None:
        camera = media.looking(mu, azimuth=azimuth + 180, below=True, distance=3.0)
        media.assert_seen(scene, camera, 2048, down, rw.Path(1))


@pytest.mark.parametrize(
    ("s", "k", "g", "ahead", "aside", "expected"),
    [
        (0.5, 1.0, 0.0, 2.0, 1.0, 0.00446658092660298),
        (1.0, 1.0, 0.8, 3.0, 0.1, 0.339555767458997),
        (0.5, 0.5, 0.0, 2.0, 1.0, 0.018787040858002604),
    ],
)
def test_the_glow_around_a_lamp_in_fog(s, k, g, ahead, aside, expected):
    # Sun et al. 2005; Pegoraro and Parker 2009.
    phase = rw.HenyeyGreenstein(g)
    fog = rw.Homogeneous(k - s, s, phase)
    scene = rw.Scene([], lights=[rw.PointLight((ahead, aside, 0), 1.0)], medium=fog)
    camera = rw.Orthographic((0, 0, 0), direction=(1, 0, 0), scale=1e-6, width=8, height=8)
    media.assert_seen(scene, camera, 2048, expected, rw.Path(1))


def test_the_glow_in_fog_so_thin_that_nothing_is_dimmed():
    # I s π / (4π h), as s goes to 0, for any distance sampler.
    scene = rw.Scene([], lights=[rw.PointLight((0, 1, 0), 1.0)], medium=rw.Homogeneous(0, 1e-9))
    camera = rw.Orthographic((-1e5, 0, 0), direction=(1, 0, 0), scale=1e-6, width=4, height=4)
    mean, error = media.seen(scene, camera, 64, rw.Path(1))
    assert mean / 1e-9 == pytest.approx(0.25, rel=2e-4)
    assert error / mean < 1e-6


def fluence(albedo, r, samples, seed=0):
    """Radiance over all directions, but for what comes straight from the lamp, and its standard error."""
    fog = rw.Homogeneous(1 - albedo, albedo)
    lamp = rw.PointLight((r, 0, 0), 1 / (4 * math.pi))
    scene = rw.Scene([], lights=[lamp], medium=fog)
    camera = rw.Panorama((0, 0, 0), direction=(1, 0, 0), up=(0, 0, 1), width=32, height=16)
    image = rw.render(scene, camera, rw.Path(), samples, seed=seed, progress=False)
    # Solid angle of each row of pixels.
    edges = np.cos(np.linspace(0, math.pi, 17))
    solid = (edges[:-1] - edges[1:])[:, None] * 2 * math.pi / 32
    rgb, error = image.rgb[..., 1].astype(float), image.standard_error[..., 1].astype(float)
    return (rgb * solid).sum(), math.sqrt(((error * solid) ** 2).sum())


@slow
@pytest.mark.parametrize(
    ("albedo", "r", "expected", "most"),
    [
        (0.9, 1.0, 0.143283861525453, 0.01),
        (0.99, 5.0, 0.0198417362186256, 0.02),
        (0.9, 10.0, 0.000104897173898545, 0.1),
    ],
)
def test_the_fluence_around_a_lamp_in_endless_fog(albedo, r, expected, most):
    # Case, de Hoffmann and Placzek 1953.
    mean, error = fluence(albedo, r, part(1024, 4))
    scattered = expected - math.exp(-r) / (4 * math.pi * r * r)
    assert error < error_of_part(most, 4) * scattered, (error, scattered)
    assert abs(mean - scattered) < 4 * error, (mean, error, scattered)


def test_a_ball_that_scatters_and_absorbs():
    # Solved as an integral equation: optical radius 1, albedo 0.5.
    ball = rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(media.of_depth(1.0, 0.5)))
    scene = rw.Scene([ball], environment=SKY)
    center = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=1e-3, width=8, height=8)
    media.assert_seen(scene, center, 512, 0.4104990458)
    disk = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=2.0, width=64, height=64)
    image = rw.render(scene, disk, rw.Path(), 16, progress=False)
    mean, share = image.rgb[..., 1].mean(dtype=float), math.pi / 4
    error = math.sqrt((image.standard_error[..., 1].astype(float) ** 2).sum()) / 64**2
    assert error < 0.002
    assert abs(mean - (1 - share * 0.457742891)) < 3 * error


@pytest.mark.parametrize("g", [0.0, 0.9, -0.9])
@pytest.mark.parametrize("depth", [0.1, 1.0, 10.0])
def test_the_mean_way_through_a_ball_is_that_of_its_chords(g, depth):
    # 4 V / S, for any scattering (Blanco and Fournier 2003): gas that scatters all and emits 1 per length
    # shows the mean path length.
    phase = rw.HenyeyGreenstein(g)
    gas = rw.Homogeneous(0.0, depth, phase, emission=1.0)
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1.0, material=rw.MediumInterface(gas))])
    camera = rw.Orthographic((0, 0, 3), (0, 0, 0), scale=2.0, width=32, height=32)
    image = rw.render(scene, camera, rw.Path(), 32, progress=False)
    mean = image.rgb[..., 1].mean(dtype=float) / (math.pi / 4)
    error = math.sqrt((image.standard_error[..., 1].astype(float) ** 2).sum()) / 32**2 / (math.pi / 4)
    assert error < 0.02
    assert abs(mean - 4 / 3) < 4 * error, (mean, error)


@slow
@pytest.mark.parametrize(
    ("size", "mean_chord"),
    [((1, 1, 1), 0.666666666666667), ((1, 2, 3), 1.09090909090909)],
)
def test_the_mean_way_through_boxes(size, mean_chord):
    # Pictures from many directions, each covering the visible box.
    gas = rw.Homogeneous(0.0, 2.0, rw.HenyeyGreenstein(0.5), emission=1.0)
    size = np.array(size, float)
    scene = rw.Scene([rw.Box(-size / 2, size / 2, material=rw.MediumInterface(gas))])
    cover = np.linalg.norm(size)
    count, light, variance, area = 100, 0.0, 0.0, 0.0
    for i in range(count):
        # Evenly over an octant: the box looks the same from the others.
        z = (i + 0.5) / count
        angle = math.pi / 2 * ((i * 0.6180339887498949) % 1)
        way = np.array([math.sqrt(1 - z * z) * math.cos(angle), math.sqrt(1 - z * z) * math.sin(angle), z])
        camera = rw.Orthographic(way * 3, (0, 0, 0), up=(0.1, 0.2, 0.3), scale=cover, width=8, height=8)
        image = rw.render(scene, camera, rw.Path(), 64, seed=i, progress=False)
        light += image.rgb[..., 1].mean(dtype=float) * cover**2
        variance += (image.standard_error[..., 1].astype(float) ** 2).sum() / 64**2 * cover**4
        area += float(np.abs(way) @ (size.prod() / size))
    error = math.sqrt(variance) / area
    assert error < 0.01
    # The directions are a quadrature rule, good to 0.3 % for the visible area of a box.
    assert abs(light / area - mean_chord) < 4 * error + 0.003 * mean_chord
