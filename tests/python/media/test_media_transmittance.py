"""How much light gets through media: exact for even ones and for grids, in calls and in pictures."""

import math

import numpy as np
import pytest

import raywright as rw

BOX = [(-1, -1, -3), (1, 1, 0)]
BLACK = rw.Diffuse(0.0)
RNG = np.random.default_rng(7)
BLOBS = RNG.uniform(0, 4, (11, 9, 13)).astype(np.float32) * (RNG.random((11, 9, 13)) < 0.4)


def smoke(density, **more):
    return rw.Box(
        *BOX, material=rw.MediumInterface(rw.GridMedium(density, BOX, **{"absorption": 1.0, **more}))
    )


def trilinear(density, box, points, *, centers=False):
    """Numbers at the corners of cells, or in their middles, interpolated along each axis."""
    low, high = np.array(box, float)
    count = np.array(density.shape[:3])
    u = (points - low) / (high - low)
    steps = np.clip(u * count - 0.5 if centers else u * (count - 1), 0, count - 1)
    first = np.minimum(steps.astype(int), np.maximum(count - 2, 0))
    part = steps - first
    value = 0.0
    for corner in np.ndindex(2, 2, 2):
        at = np.minimum(first + corner, count - 1)
        weight = np.prod(np.where(np.array(corner) == 1, part, 1 - part), axis=-1)
        value = value + weight * density[at[..., 0], at[..., 1], at[..., 2]]
    return value * ((u >= 0) & (u <= 1)).all(axis=-1)


def borders(density, box, origin, direction, end, *, centers=False):
    """The parameters at which a ray comes from one cell into another, its ends among them."""
    low, high = np.array(box, float)
    found = [np.array([0.0, end])]
    for axis, count in enumerate(density.shape[:3]):
        steps = (np.arange(count) + 0.5) / count if centers else np.linspace(0, 1, count)
        places = np.concatenate([[0.0, 1.0], steps]) * (high[axis] - low[axis]) + low[axis]
        found.append((places - origin[axis]) / direction[axis])
    return np.sort(np.clip(np.concatenate(found), 0.0, end))


@pytest.mark.parametrize("at", ["corners", "centers"])
def test_optical_depths_of_grids_are_the_integrals_of_their_densities(at):
    scene = rw.Scene(smoke(BLOBS, at=at))
    origins = RNG.uniform(-4, 4, (40, 3))
    directions = RNG.uniform([-0.9, -0.9, -2.9], [0.9, 0.9, -0.1], (40, 3)) - origins
    t_max = RNG.uniform(0.5, 3, 40)
    found = scene.optical_depth(origins, directions, t_max)
    # Gauss's rule of three points between borders of cells, by an interpolation of its own.
    nodes, weights = np.polynomial.legendre.leggauss(3)
    for origin, direction, end, depth in zip(origins, directions, t_max, found, strict=True):
        t = borders(BLOBS, BOX, origin, direction, end, centers=at == "centers")
        middle, half = (t[1:] + t[:-1]) / 2, (t[1:] - t[:-1]) / 2
        points = origin + (middle[:, None] + half[:, None] * nodes)[..., None] * direction
        density = trilinear(BLOBS, BOX, points, centers=at == "centers")
        expected = (density * weights * half[:, None]).sum() * np.linalg.norm(direction)
        np.testing.assert_allclose(depth, expected, rtol=1e-9, atol=1e-9)
    assert found.max() > 1


def test_transmittance_keeps_its_digits_at_any_depth():
    scene = rw.Scene(smoke(np.full((3, 4, 5), 2.0), absorption=(14 / 6, 300 / 6, 0.0)))
    depth = scene.optical_depth((0.1, 0.2, 5), (0, 0, -1))
    np.testing.assert_allclose(depth, (14, 300, 0), rtol=1e-12)
    np.testing.assert_allclose(
        scene.transmittance((0.1, 0.2, 5), (0, 0, -1)), (math.exp(-14), math.exp(-300), 1), rtol=1e-12
    )
    # From within, in units of the direction's length, and for many rays at once.
    np.testing.assert_allclose(scene.optical_depth((0, 0, -1), (0, 0, -2), t_max=0.5)[0], 14 / 3, rtol=1e-12)
    found = scene.transmittance(np.zeros((2, 1, 3)), [(0, 0, 1.0), (0, 0, -1), (1, 0, 0)])
    assert found.shape == (2, 3, 3)


def test_media_in_one_another_and_around_all():
    glass = rw.Dielectric(1.5, interior=rw.Homogeneous(absorption=0.25))
    shapes = [
        rw.Sphere(
            (0, 0, 0), 2.0, material=rw.MediumInterface(rw.Homogeneous(absorption=1.0, scattering=1.0))
        ),
        rw.Sphere((0, 0, 0), 1.0, material=glass),
        rw.Mesh([(-9, -9, 0), (9, -9, 0), (0, 9, 0)], [(0, 1, 2)], material=BLACK),
    ]
    scene = rw.Scene(shapes, medium=rw.Homogeneous(absorption=0.125))
    # A meter of air, two of smoke, two of glass, and so on; walls do not count.
    expected = 1 * 0.125 + 1 * 2 + 2 * 0.25 + 1 * 2 + 3 * 0.125
    np.testing.assert_allclose(scene.optical_depth((0, 0, 3), (0, 0, -1), 8.0), expected, rtol=1e-12)
    assert np.isinf(scene.optical_depth((0, 0, 3), (0, 0, -1))).all()
    assert (scene.transmittance((0, 0, 3), (0, 0, -1)) == 0).all()
    clear = rw.Scene(shapes[2])
    assert (clear.optical_depth((0, 0, 3), (0, 0, -1)) == 0).all()
    assert (clear.transmittance((0, 0, 3), (0, 0, -1)) == 1).all()
    # In a copy, lengths are in world units.
    copy = rw.Scene(rw.Instance(smoke(np.full((2, 2, 2), 0.5)), np.diag([2.0, 2.0, 2.0, 1.0])))
    np.testing.assert_allclose(copy.optical_depth((0, 0, 9), (0, 0, -1)), 3.0, rtol=1e-12)


def test_scenes_by_wavelength_tell_what_those_in_colors_do():
    aside = rw.Sphere((500, 0, 0), 1.0, material=rw.Diffuse(rw.Spectrum([360, 830], [0.2, 0.6])))
    ray = (0.1, 0.2, 5), (0, 0.05, -1)
    for how in (
        {"absorption": (0.5, 1.0, 2.0), "scattering": 0.5},
        {"extinction": (1.5, 0.5, 1.0), "albedo": np.full((2, 2, 2), 0.5)},
    ):
        medium = rw.GridMedium(BLOBS, BOX, **how)
        box = rw.Box(*BOX, material=rw.MediumInterface(medium))
        plain, waved = rw.Scene(box), rw.Scene([box, aside])
        assert waved.wavelengths is not None
        np.testing.assert_allclose(waved.optical_depth(*ray), plain.optical_depth(*ray), rtol=1e-12)


@pytest.mark.parametrize("noise", [0.0, 1e-3, 0.3])
def test_shadows_of_thin_blocks_are_near_enough(noise):
    # 14 in all, with blocks that vary too little for a walk through cells.
    density = 14 / 3 + noise * np.random.default_rng(1).uniform(-1, 1, (64, 64, 64))
    box = smoke(density)
    sun = rw.DirectionalLight((0, 0, -1), math.pi)
    found, error = lit_through(box, rw.Direct(), samples=256, lights=[sun])
    expected = rw.Scene(box).transmittance((0, 0, 5), (0, 0, -1), 9.0)[1]
    # Five standard errors, which chance exceeds once in a million.
    assert abs(found - expected) <= 5 * error + 2e-6 * expected
    assert error <= (1e-6 if noise == 0 else 0.1) * expected


def lit_through(medium, integrator, samples=64, **lights):
    """Radiance of a white plate below a medium that it is lit through, seen from beside, and its error."""
    plate = rw.Mesh(
        [(-9, -9, -4), (9, -9, -4), (9, 9, -4), (-9, 9, -4)], [(0, 1, 2), (0, 2, 3)], material=rw.Diffuse(1.0)
    )
    camera = rw.Camera((0, -9, -3), (0, 0, -4), up=(0, 0, 1), fov=0.01, width=1, height=1)
    scene = rw.Scene([plate, medium], **lights)
    image = rw.render(scene, camera, integrator, samples=samples, seed=3, progress=False)
    return float(image.rgb[0, 0, 1]), float(image.standard_error.max())


SHADOWS = [rw.Direct(), rw.Whitted(), rw.Path(max_depth=1), rw.Bidirectional(max_depth=1)]


@pytest.mark.parametrize("integrator", SHADOWS, ids=lambda one: type(one).__name__)
def test_shadows_of_grids_are_exact(integrator):
    # Straight down through 3 of a density of 14 / 3, even or rising from 0 to twice that, scattering or not.
    even, rising = np.full((9, 9, 9), 14 / 3), np.linspace(0, 28 / 3, 9) * np.ones((9, 9, 1))
    sun = rw.DirectionalLight((0, 0, -1), math.pi)
    for density in (even, rising):
        for how in ({}, {"absorption": 0.5, "scattering": 0.5}):
            found, error = lit_through(smoke(density, **how), integrator, lights=[sun])
            assert abs(found - math.exp(-14)) <= 2e-6 * math.exp(-14)
            assert error <= 1e-6 * math.exp(-14)


def test_what_is_seen_through_smoke_that_only_absorbs_is_exact():
    lamp = rw.Mesh([(-9, -9, -4), (9, -9, -4), (0, 9, -4)], [(0, 1, 2)], material=BLACK, emission=1.0)
    camera = rw.Camera((0.1, 0.2, 3), (0.1, 0.2, 0), up=(0, 1, 0), fov=0.01, width=1, height=1)
    scene = rw.Scene([smoke(BLOBS, absorption=(1.0, 2.0, 0.5)), lamp])
    expected = scene.transmittance((0.1, 0.2, 3), (0, 0, -1))
    for integrator in (rw.Path(), rw.Bidirectional(), rw.Direct()):
        image = rw.render(scene, camera, integrator, samples=16, progress=False)
        np.testing.assert_allclose(image.rgb[0, 0], expected, rtol=2e-3)


@pytest.mark.parametrize("integrator", [rw.Path(), rw.Bidirectional()], ids=["path", "bidirectional"])
@pytest.mark.parametrize(
    "density", [np.full((4, 4, 4), 0.6), BLOBS * 0.4, BLOBS * 4], ids=["even", "uneven", "deep"]
)
def test_white_smoke_in_an_even_light_is_not_seen(integrator, density):
    # Single and multiple scattering compensate the loss.
    scene = rw.Scene(smoke(density, absorption=0.0, scattering=1.0), environment=1.0)
    camera = rw.Camera((0.4, 0.2, 4), (0, 0, -1.5), up=(0, 1, 0), fov=15, width=8, height=8)
    image = rw.render(scene, camera, integrator, samples=256, seed=4, progress=False)
    values = image.rgb[..., 1].ravel().astype(float)
    error = values.std(ddof=1) / math.sqrt(values.size)
    # Five standard errors, which chance exceeds once in a million.
    assert abs(values.mean() - 1) <= 5 * error + 1e-4
    assert error < 0.02


def test_an_even_grid_looks_as_what_is_even_everywhere():
    def picture(medium, integrator):
        box = rw.Box(*BOX, material=rw.MediumInterface(medium))
        lamp = rw.Sphere((0, 0, 2), 0.5, material=BLACK, emission=8.0)
        scene = rw.Scene([box, lamp], environment=0.2)
        camera = rw.Camera((0, -6, 1), (0, 0, -1.5), up=(0, 0, 1), fov=30, width=8, height=8)
        image = rw.render(scene, camera, integrator, samples=256, seed=2, progress=False)
        return image.rgb.astype(float), image.standard_error.astype(float)

    gray = {"absorption": (0.2, 0.3, 0.1), "scattering": (0.5, 0.2, 0.8)}
    for integrator in (rw.Path(), rw.Bidirectional(max_depth=3)):
        a, b = (
            picture(rw.GridMedium(np.full((3, 3, 3), 1.0), BOX, **gray), integrator),
            picture(rw.Homogeneous(**gray), integrator),
        )
        off = (a[0].mean((0, 1)) - b[0].mean((0, 1))) / np.hypot(
            *(np.sqrt((e**2).mean((0, 1)) / 64) for _, e in (a, b))
        )
        # Over three colors, five standard errors: once in half a million.
        assert (np.abs(off) < 5).all(), off


def test_what_is_wrong_is_told():
    scene = rw.Scene(smoke(BLOBS))
    with pytest.raises(ValueError, match="shape"):
        scene.transmittance((0, 0), (0, 0, 1))
    with pytest.raises(ValueError, match="t_max"):
        scene.optical_depth((0, 0, 0), (0, 0, 1), t_max=math.nan)
