"""Light that sets out from lamps by wavelength: what path tracing finds too, and where a prism throws it.

Pictures are compared by their means, in each channel, within four standard errors of both, which chance
exceeds once in 16,000; seeds are fixed.
"""

import math

import numpy as np
import pytest
from long_runs import error_of_part, part

import raywright as rw

NM = np.arange(360.0, 831.0)
FLINT = rw.materials.glasses["SF10"]
RED = rw.Spectrum(NM, 0.4 + 0.4 / (1 + np.exp((NM - 580) / -15)))
GREENISH = rw.Spectrum(NM, 0.35 + 0.4 * np.exp(-(((NM - 540) / 45) ** 2)))
WAYS = {"light": rw.LightTraced(), "both": rw.Bidirectional()}
slow = pytest.mark.slow


def down(height, scale=1.2, side=12):
    """A camera close above the floor, which sees nothing else."""
    return rw.Orthographic(
        (0, 0, height), direction=(0, 0, -1), up=(0, 1, 0), scale=scale, width=side, height=side
    )


def floor(material=rw.Diffuse(RED)):  # noqa: B008
    return rw.Box((-3, -3, -1), (3, 3, 0), material=material)


def lamp(emission, height=1.9, radius=1.0):
    return rw.Disk((0, 0, height), (0, 0, -1), radius, material=rw.Diffuse(0), emission=emission)


def ball(material, center=(0.1, 0, 0.9), radius=0.6):
    return rw.Sphere(center, radius, material=material)


def mean(scene, camera, integrator, samples, seed=0):
    image = rw.render(scene, camera, integrator, samples, seed=seed, progress=False)
    assert image.plan["wavelengths"].chosen == "three a path"
    error = np.sqrt((image.standard_error.astype(float) ** 2).sum(axis=(0, 1))) / image.rgb[..., 0].size
    return image.rgb.astype(float).mean(axis=(0, 1)), error


WHITE = 4 * rw.textures.illuminants["D65"]
GRAY = floor(rw.Diffuse(0.8))
WET = [
    ball(rw.Dielectric(FLINT)),
    ball(rw.Dielectric(rw.materials.glasses["water"], priority=1), radius=0.35),
]
# A scene, a camera, and numbers of samples for a good mean by light tracing and by both.
SCENES = {
    "a ball": (rw.Scene([GRAY, ball(rw.Dielectric(FLINT)), lamp(WHITE)]), down(0.2, 2.4), (1024, 512)),
    "a rough ball": (
        rw.Scene([GRAY, ball(rw.Dielectric(FLINT, roughness=0.4)), lamp(WHITE)]),
        down(0.2, 2.4),
        (1024, 512),
    ),
    "water in glass": (rw.Scene([GRAY, *WET, lamp(WHITE)]), down(0.2, 2.4), (1024, 512)),
    "films and metals": (
        rw.Scene(
            [
                floor(rw.Diffuse(GREENISH)),
                ball(rw.materials.SoapFilm(400.0), (0.5, 0, 0.8), 0.5),
                ball(rw.Conductor("Cu", roughness=0.4), (-0.6, 0, 0.8), 0.4),
                lamp(2 * rw.textures.illuminants["F2"]),
            ],
        ),
        down(0.2, 2.4),
        (3072, 1024),
    ),
    "lamps of all kinds": (
        rw.Scene(
            [floor(rw.Diffuse((0.7, 0.4, 0.2))), ball(rw.Plastic(RED, roughness=0.3), (0, 0, 1.0), 0.4)],
            lights=[
                rw.SpotLight((0, 1, 2), (0, 0, 0), 3 * rw.Blackbody(2800), angle=40),
                rw.DirectionalLight((0.2, 0.1, -1), (0.5, 0.8, 0.3)),
                rw.ProjectorLight(
                    [[(1, 0, 0), (0, 1, 0)], [(0, 0, 1), (1, 1, 1)]], (0.5, 0, 2), (0.5, 0, 0), fov=50
                ),
            ],
        ),
        down(0.2, 2.4),
        (3072, 256),
    ),
}


# Means of these by paths, and standard errors: mean(scene, camera, rw.Path(max_depth=9), samples, seed=10**9)
# for 65,536 samples of "a ball" and "a rough ball", and 8,192 of the others.
BY_PATHS = {
    "films and metals": ((0.1432254, 0.1674664, 0.04653314), (1.70e-04, 1.91e-04, 9.66e-05)),
    "lamps of all kinds": ((0.2619429, 0.1362571, 0.02022548), (1.84e-04, 4.89e-05, 1.87e-05)),
    "water in glass": ((0.4831479, 0.4795283, 0.4796436), (1.71e-03, 1.20e-03, 1.35e-03)),
    "a ball": ((0.5253438, 0.5237347, 0.5203233), (6.21e-04, 4.35e-04, 4.85e-04)),
    "a rough ball": ((0.4628531, 0.4613333, 0.4580543), (5.89e-04, 4.20e-04, 4.66e-04)),
}


def assert_agree(name, way, most, times):
    scene, camera, others = SCENES[name]
    expected, off = map(np.array, BY_PATHS[name])
    count = int(times * others[list(WAYS).index(way)])
    integrator = type(WAYS[way])(max_depth=9)
    found, error = mean(scene, camera, integrator, count, seed=1)
    joint = np.hypot(off, error)
    print(
        name, way, found, expected, (found - expected) / joint, joint / expected.max(), off / expected.max()
    )
    assert (abs(found - expected) <= 4 * joint).all(), (found, expected, joint)
    assert (joint <= most * expected.max()).all(), joint / expected.max()


# Scenes whose mean converges to half a hundredth within a second or two; the others reach a hundredth and a
# half.
SURE = ("films and metals", "lamps of all kinds")
# Each scene in one way, and in both where there is time.
QUICK = {"light": ("a ball", "films and metals"), "both": ("a rough ball", "lamps of all kinds")}
EACH = [
    pytest.param(name, way, marks=() if name in QUICK[way] else slow, id=f"{name}-{way}")
    for way in WAYS
    for name in SCENES
]


@pytest.mark.parametrize(("name", "way"), EACH)
def test_light_from_lamps_is_that_of_paths(name, way):
    assert_agree(name, way, 0.005 if name in SURE else 0.015, 1.0)


@slow
@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("name", [*SURE, "a ball", "a rough ball"])
def test_light_from_lamps_is_that_of_paths_to_two_in_a_thousand(name, way):
    assert_agree(name, way, error_of_part(0.002, 4), part(8.0 if name in SURE else 60.0, 4))


def lantern():
    """White balls in a hollow ball of glass, in white light, all of which comes by way of what parts it."""
    glass = rw.Sphere((0, 0, 0), 2.0, material=rw.Dielectric(FLINT))
    air = rw.Sphere((0, 0, 0), 1.8, material=rw.Dielectric(1.0, priority=1))
    balls = [rw.Sphere((x, 0, 0), 0.6, material=rw.Diffuse(1.0)) for x in (-0.65, 0.65)]
    return rw.Scene([glass, air, *balls], environment=1.0)


WITHIN, WITHOUT = (
    rw.Orthographic(at, direction=(0, 0, -1), up=(0, 1, 0), scale=size, width=12, height=12)
    for at, size in (((0.65, 0, 1.2), 0.7), ((0, 0, 4.0), 2.0))
)


@pytest.mark.parametrize("camera", [WITHIN, WITHOUT], ids=["seen from within", "and from without"])
@pytest.mark.parametrize(("samples", "most"), [(128, 0.005), pytest.param(1024, 0.002, marks=slow)])
def test_what_is_white_is_white_by_way_of_glass(camera, samples, most):
    """All surfaces in uniform light without absorption have its radiance.

    From without, both ends of all paths have parted where they are joined: the hero counts once.
    """
    found, error = mean(lantern(), camera, rw.Bidirectional(), samples)
    print(found, error, (found - 1) / error)
    assert (abs(found - 1) <= 4 * error).all(), (found, error)
    assert (error <= most).all(), error


@pytest.mark.parametrize(
    "integrator",
    [
        rw.Bidirectional(vertex_merging=True, radius=0.15, photons=1000),
        rw.ProgressivePhotonMap(1000, radius=0.3),
        rw.PhotonMap(1000, k_nearest=None, radius=0.3, final_gather=0),
    ],
    ids=lambda integrator: type(integrator).__name__,
)
@pytest.mark.parametrize(
    ("pictures", "samples", "most"), [(6, 16, 0.1), pytest.param(12, 32, 0.04, marks=slow)]
)
def test_photons_have_the_wavelengths_of_who_asks_them(integrator, pictures, samples, most):
    """Samples of a number all have the same, so a picture has a tint of its own: several tell the mean."""
    camera = rw.Orthographic((0, 0, 4), direction=(0, 0, -1), up=(0, 1, 0), scale=2.0, width=6, height=6)

    def seen(scene, seed):
        image = rw.render(scene, camera, integrator, samples, seed=seed, progress=False)
        return image.rgb.astype(float).mean((0, 1))

    found = np.array([seen(lantern(), seed) for seed in range(10, 10 + pictures)])
    expected, off = 1.0, 0.0
    if isinstance(integrator, rw.PhotonMap):
        # Its blur makes the balls brighter, with wavelengths as without.
        glass = rw.Sphere((0, 0, 0), 2.0, material=rw.Dielectric(FLINT.index()))
        plain = rw.Scene([glass, *lantern().shapes[1:]], environment=1.0)
        told = np.array([seen(plain, seed)[0] for seed in range(pictures)])
        expected, off = told.mean(), told.std(ddof=1) / math.sqrt(pictures)
    error = np.hypot(found.std(axis=0, ddof=1) / math.sqrt(pictures), off)
    print(found.mean(axis=0), error, (found.mean(axis=0) - expected) / error)
    assert (abs(found.mean(axis=0) - expected) <= 4 * error).all(), (found.mean(axis=0), error)
    assert (error <= most).all(), error


def prism():
    """A prism of 60 degrees with its edge along y at the origin, whose first face has the normal -x."""
    turn = math.radians(60.0)
    corners = [(0, 0), (0, -2), (2 * math.sin(turn), -2 * math.cos(turn))]
    vertices = [(x, y, z) for y in (-1, 1) for x, z in corners]
    faces = [(0, 1, 2), (3, 5, 4), (0, 4, 1), (0, 3, 4), (1, 5, 2), (1, 4, 5), (2, 3, 0), (2, 5, 3)]
    return rw.Mesh(vertices, faces, material=rw.Dielectric(FLINT))


START = math.radians(60.0)
MEETS = np.array((0.0, -1.0))


def way_of(nm):
    """Where a beam of a wavelength leaves the prism, and where to, in x and z, by Snell's law."""
    index, apex = FLINT.index(nm / 1000), math.radians(60.0)
    inside = math.asin(math.sin(START) / index)
    out = math.asin(index * math.sin(apex - inside))
    # From the first face at x = 0 to the second, which goes down from the edge under 60 degrees to the first.
    across = np.array((math.cos(inside), math.sin(inside)))
    along = np.array((math.sin(apex), -math.cos(apex)))
    t = np.linalg.solve(np.array([across, -along]).T, -MEETS)[0]
    turned = START - (START - apex + out)
    return MEETS + t * across, np.array((math.cos(turned), math.sin(turned)))


WALL = 4.0
LINES = (404.6561, 486.1327, 587.5618, 656.2725)


def places(lines):
    """Where beams meet a wall that stands across the way of yellow light, by the length along it."""
    towards = way_of(587.5618)[1]
    up = np.array((-towards[1], towards[0]))
    found = []
    for line in lines:
        leaves, direction = way_of(line)
        t = (WALL - leaves @ towards) / (direction @ towards)
        found.append((leaves + t * direction) @ up)
    return np.array(found)


@pytest.mark.parametrize(
    ("line", "way"),
    [
        pytest.param(line, way, marks=() if (line in LINES[::3]) == (way == "light") else slow)
        for line in LINES
        for way in WAYS
    ],
)
def test_the_fan_of_a_prism_falls_where_snell_has_it(way, line):
    """A narrow beam of a line of mercury, hydrogen or helium comes to a wall within a pixel."""
    at = places([line])[0]
    low, high = sorted(places([380.0, 720.0]))
    towards = way_of(587.5618)[1]
    up = np.array((-towards[1], towards[0]))
    middle, reach = (low + high) / 2, 0.6 * (high - low)

    def world(point, y=0.0):
        return point[0], y, point[1]

    corners = [WALL * towards + (middle + a * 2 * reach) * up for a in (-1, 1)]
    wall = rw.Mesh(
        [world(corners[0], -1), world(corners[0], 1), world(corners[1], 1), world(corners[1], -1)],
        [(0, 1, 2), (0, 2, 3)],
        material=rw.Diffuse(0.8),
    )
    width, height = 40, 3
    camera = rw.Orthographic(
        world((WALL - 0.5) * towards + middle * up),
        direction=world(towards),
        up=(0, 1, 0),
        scale=2 * reach * height / width,
        width=width,
        height=height,
    )
    beam = np.array((math.cos(START), math.sin(START)))
    source = MEETS - 0.5 * beam
    light = rw.Spectrum([line - 2, line, line + 2], [0, 1, 0])
    spot = rw.SpotLight(world(source), world(MEETS), 1e4 * light, angle=0.02, falloff=0)
    scene = rw.Scene([prism(), wall], lights=[spot])
    image = rw.render(scene, camera, WAYS[way], 256, seed=2, progress=False)
    # A single line has negative values in some channels.
    seen = np.abs(image.rgb.astype(float).sum(axis=0)).sum(axis=1)
    assert seen.max() > 0
    # The camera's right is opposite to `up` of the wall, or along it.
    sign = 1 if np.dot(np.cross(world(towards), (0, 1, 0)), world(up)) > 0 else -1
    expected = (0.5 + sign * (at - middle) / (2 * reach)) * width - 0.5
    found = (seen * np.arange(width)).sum() / seen.sum()
    print(line, expected, found, seen.argmax())
    assert abs(found - expected) < 1
    assert abs(seen.argmax() - expected) < 1
    assert seen[np.abs(np.arange(width) - expected) > 2].sum() < 0.01 * seen.sum()


def test_the_fan_has_its_colors_in_order():
    low, high = sorted(places([380.0, 720.0]))
    fan = places(LINES)
    assert (np.diff(fan) > 0).all() or (np.diff(fan) < 0).all()
    # Some ten degrees of flint from violet to red.
    assert 0.1 < high - low < 1.0


def misty(medium):
    """A lamp over a ball of glass, both in what absorbs and scatters by wavelength."""
    mist = rw.Box((-2.5, -2.5, 0.02), (2.5, 2.5, 1.6), material=rw.MediumInterface(medium))
    return rw.Scene([GRAY, ball(rw.Dielectric(FLINT), radius=0.5), mist, lamp(WHITE)])


def of_waves(least, most):
    return rw.Spectrum(NM, np.linspace(least, most, len(NM)))


VARIES = np.random.default_rng(3).uniform(0, 1, (5, 5, 5))
MEDIA = {
    "fog": rw.Homogeneous(of_waves(0.05, 0.4), of_waves(0.8, 0.2)),
    "smoke": rw.GridMedium(
        VARIES,
        [(-2.5, -2.5, 0.02), (2.5, 2.5, 1.6)],
        absorption=of_waves(1.5, 0.1),
        scattering=of_waves(0.2, 0.8),
    ),
}


# Means of them by paths, and standard errors, as seen by each way:
# mean(scene, camera, rw.Path(max_depth=6), 8192, seed=10**9).
MEDIA_BY_PATHS = {
    ("fog", "light"): ((0.2651632, 0.2863495, 0.3111194), (1.15e-03, 8.36e-04, 9.66e-04)),
    ("fog", "both"): ((0.3160426, 0.3790268, 0.4501865), (1.05e-03, 7.99e-04, 9.07e-04)),
    ("smoke", "light"): ((0.2279057, 0.1794808, 0.1410697), (1.05e-03, 7.41e-04, 7.76e-04)),
    ("smoke", "both"): ((0.2390358, 0.1712499, 0.1193972), (9.52e-04, 6.62e-04, 6.91e-04)),
}


@pytest.mark.parametrize(
    ("name", "way"),
    [
        ("fog", "light"),
        ("smoke", "both"),
        pytest.param("fog", "both", marks=slow),
        pytest.param("smoke", "light", marks=slow),
    ],
)
@pytest.mark.parametrize(("most", "times"), [(0.04, 1), pytest.param(0.01, 16, marks=slow)])
def test_light_goes_through_media_by_wavelength(name, way, most, times):
    """Seen below the ball where connections must not end at glass, and through it by both."""
    scene, camera = misty(MEDIA[name]), down(0.25 if way == "light" else 1.7, 2.4)
    expected, off = map(np.array, MEDIA_BY_PATHS[name, way])
    count = {"light": 256, "both": 96}[way] * times
    found, error = mean(scene, camera, type(WAYS[way])(max_depth=6), count, seed=1)
    joint = np.hypot(off, error)
    print(
        name, way, found, expected, (found - expected) / joint, joint / expected.max(), off / expected.max()
    )
    assert (abs(found - expected) <= 4 * joint).all(), (found, expected, joint)
    assert (joint <= most * expected.max()).all(), joint / expected.max()
