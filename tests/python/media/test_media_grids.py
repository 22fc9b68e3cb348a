"""Grids of albedos, temperatures and colors, and grids that are mostly empty."""

import math
import pickle
import subprocess
import sys

import media_scenes as media
import numpy as np
import pytest

import raywright as rw
from raywright import _core
from raywright.textures.blackbody import planck

SKY = rw.ConstantEnvironment(1.0)
BOX = [(-1, -1, -3), (1, 1, 0)]
ONE = np.ones((1, 1, 1))
RAMP = np.linspace(0, 1, 33).reshape(1, 1, 33)
# A spectral material out of sight makes the whole scene spectral.
ASIDE = rw.Sphere((500, 0, 0), 1.0, material=rw.Diffuse(rw.Spectrum([360, 830], [0.2, 0.6])))
WAYS = pytest.mark.parametrize("by", ["colors", "wavelengths"])


def scene(medium, by="colors", **arguments):
    shapes = [rw.Box(*BOX, material=rw.MediumInterface(medium)), *([ASIDE] if by == "wavelengths" else [])]
    found = rw.Scene(shapes, **arguments)
    assert (found.wavelengths is not None) == (by == "wavelengths")
    return found


def assert_looks(scene, samples, expected, integrator=None, most=0.004):
    """Seen from above, each color within four standard errors, which chance exceeds once in 16,000, and a
    ten-thousandth for tables and float32 ; errors of at most 0.4 % of the brightest."""
    image = rw.render(scene, media.looking(side=16), integrator or rw.Path(), samples, seed=5, progress=False)
    values = image.rgb.reshape(-1, 3).astype(float)
    mean, error = values.mean(axis=0), values.std(axis=0, ddof=1) / math.sqrt(len(values))
    print(mean, error, expected, (mean - expected) / (error + 1e-300))
    assert (np.abs(mean - expected) <= 4 * error + 1e-4 * np.max(expected)).all(), (mean, error, expected)
    assert (error <= most * np.max(expected)).all(), error / np.max(expected)


def black_body(kelvin, brightness=1.0):
    """Red, green and blue of Planck's curve over its greatest value, which Wien's law has."""
    nm = np.arange(360.0, 831.0, 5.0)
    most = planck(np.array(2.8977719551851727e6 / kelvin), kelvin)
    return brightness * np.array(rw.Spectrum(nm, planck(nm, kelvin) / most).rgb)


def seen(color, by):
    """The color of an albedo as rendered: from a table of spectra, a little off at the edge of the gamut."""
    if by == "colors":
        return color
    nm = np.arange(360.0, 831.0)
    shares = _core.smooth_spectrum(color.tolist(), True, True, nm.tolist())
    return _core.spectrum_rgb(np.stack([nm, shares], axis=1).tolist(), True)


@WAYS
def test_albedos_on_a_grid_color_what_is_scattered_once(by):
    """In the sun from above, seen from above: of an albedo w(z) and an extinction s, ∫ w(z) s exp(-2 s z) dz
    over 4, where the sun's irradiance is π. Where all are dimmed alike, that has the albedo's color."""
    albedo = np.concatenate([0.9 * RAMP, 0.2 + 0.3 * RAMP, 0.5 - 0.5 * RAMP], axis=0).transpose(1, 2, 0)
    density = np.full((2, 2, 2), 0.5)
    smoke = rw.GridMedium(density, BOX, extinction=1.6, albedo=albedo[None])
    sun = rw.DirectionalLight((0, 0, -1), math.pi)
    # z from 0, below, to 1: the light goes through 3 (1 - z) of an extinction of 0.8.
    sigma = 0.8 * 3
    nodes, weights = np.polynomial.legendre.leggauss(40)
    z = (nodes + 1) / 2
    single = weights / 8 * sigma * np.exp(-2 * sigma * (1 - z))
    expected = single @ [seen(of, by) for of in np.stack([0.9 * z, 0.2 + 0.3 * z, 0.5 - 0.5 * z], axis=1)]
    assert_looks(scene(smoke, by, lights=[sun]), 256, expected, rw.Path(1))


def test_an_albedo_that_is_the_same_everywhere_is_what_absorption_and_scattering_say():
    density = np.random.default_rng(2).random((9, 4, 5))
    by_albedo = rw.GridMedium(density, BOX, extinction=(2, 4, 3), albedo=np.full((1, 2, 3), 0.75))
    plain = rw.GridMedium(density, BOX, absorption=(0.5, 1, 0.75), scattering=(1.5, 3, 2.25))
    pictures = [
        rw.render(scene(one, environment=SKY), media.looking(0.6), rw.Path(), 16, progress=False).rgb
        for one in (by_albedo, plain)
    ]
    assert np.allclose(*pictures, rtol=1e-5)


def test_colors_of_the_density_dim_each_by_its_own():
    colors = np.array([0.2, 1.0, 0.5])
    smoke = rw.GridMedium(RAMP[..., None] * colors, BOX, absorption=(1.0, 0.5, 2.0))
    # The mean of the ramp over a distance of 3.
    expected = np.exp(-1.5 * colors * (1.0, 0.5, 2.0))
    assert_looks(scene(smoke, environment=SKY), 512, expected)


@WAYS
def test_what_glows_by_the_colors_of_its_density(by):
    colors = np.array([0.9, 0.4, 0.1])
    smoke = rw.GridMedium(RAMP[..., None] * colors, BOX, emission=0.5)
    if by == "wavelengths":
        # Up to the table of smooth spectra, where blue is off by 0.002.
        nm = np.arange(360.0, 831.0)
        smooth = _core.smooth_spectrum(colors.tolist(), False, True, nm.tolist())
        colors = np.array(_core.spectrum_rgb(np.stack([nm, smooth], axis=1).tolist(), True))
    assert_looks(scene(smoke, by), 256, 0.5 * 1.5 * colors)


@WAYS
@pytest.mark.parametrize("depth", [0.01, 2.0])
def test_a_slab_of_one_temperature_is_as_bright_as_its_depth_says(by, depth):
    fire = rw.GridMedium(
        np.full((2, 2, 2), 2.0),
        BOX,
        absorption=depth / 6,
        temperature=np.full((1, 1, 2), 2500.0),
        brightness=3.0,
    )
    assert_looks(scene(fire, by), 256, black_body(2500.0, 3.0) * -math.expm1(-depth))


def test_a_ramp_of_temperatures_is_what_quadrature_says():
    """From 400 K below to 3,000 K above, where the density ends: ∫ s(z) B(T(z)) exp(-∫ s) dz."""
    fire = rw.GridMedium(1 - RAMP, BOX, absorption=1.5, temperature=400 + 2600 * RAMP, brightness=10.0)
    # Gauss quadrature from 500 K on: from z up to 1 the optical depth is 3 times (1 - z)² / 2.
    nodes, weights = np.polynomial.legendre.leggauss(60)
    first = 100 / 2600
    z, weights = first + (1 - first) * (nodes + 1) / 2, (1 - first) * weights / 2
    weights = weights * 3 * 1.5 * (1 - z) * np.exp(-1.5 * 3 * (1 - z) ** 2 / 2)
    light = [black_body(kelvin, 10.0) for kelvin in 400 + 2600 * z]
    assert_looks(scene(fire), 512, (weights[:, None] * light).sum(axis=0))
    # And behind it a wall, dimmed.
    wall = rw.Plane((0, 0, -4), material=rw.Diffuse(0.0), emission=2.0)
    lit = rw.Scene([*scene(fire).shapes, wall])
    assert_looks(lit, 512, (weights[:, None] * light).sum(axis=0) + 2 * math.exp(-1.5 * 3 / 2))


def test_what_is_cold_or_absorbs_nothing_is_dark():
    for absorption, kelvin in [(2.0, 499.9), (0.0, 3000.0)]:
        gas = rw.GridMedium(
            np.ones((2, 2, 2)), BOX, absorption=absorption, temperature=np.full((1, 1, 1), kelvin)
        )
        image = rw.render(scene(gas), media.looking(), rw.Path(), 4, progress=False)
        assert (image.rgb == 0).all()


def puffs(shape=(40, 25, 33)):
    """An array of which a few parts are not 0."""
    numbers = np.zeros(shape, np.float32)
    rng = np.random.default_rng(4)
    numbers[3:12, 7:9, 20:31] = rng.random((9, 2, 11))
    numbers[30:, 20:, :5] = rng.random((shape[0] - 30, shape[1] - 20, 5))
    return numbers


@pytest.mark.parametrize("at", ["corners", "centers"])
def test_a_sparse_grid_gives_the_bits_of_an_array(at):
    numbers = puffs()
    parts = [((30, 20, 0), numbers[30:, 20:, :5]), ((3, 7, 20), numbers[3:12, 7:9, 20:31])]
    sparse = rw.media.SparseGrid(numbers.shape, parts)
    looks = {"absorption": 1.0, "scattering": (8, 4, 2), "at": at}
    heat = 3000 * numbers
    pictures = []
    for density, hot in [
        (numbers, heat),
        (sparse, rw.media.SparseGrid.of(heat)),
        (rw.media.SparseGrid.of(numbers), heat),
    ]:
        cloud = rw.GridMedium(density, [(-1, -1, -1), (1, 1, 1)], temperature=hot, **looks)
        shape = rw.Box((-1, -1, -1), (1, 1, 1), material=rw.MediumInterface(cloud))
        lit = rw.Scene([shape], lights=[rw.PointLight((2, 2, 2), 9)], environment=0.2)
        camera = rw.Camera((0, 1, 4), (0, 0, 0), fov=40, width=12, height=12)
        pictures.append(rw.render(lit, camera, rw.Path(), 4, progress=False).rgb)
    assert np.array_equal(pictures[0], pictures[1])
    assert np.array_equal(pictures[0], pictures[2])


@pytest.mark.parametrize("colored", [False, True])
def test_sparse_grids_keep_their_numbers(colored):
    numbers = puffs()
    if colored:
        numbers = numbers[..., None] * np.array([1, 2, 3], np.float32)
    grid = rw.media.SparseGrid.of(numbers)
    assert np.array_equal(grid.dense(), numbers)
    assert np.array_equal(np.asarray(grid), numbers)
    assert grid.shape == numbers.shape
    assert grid.max() == numbers.max()
    assert grid == rw.media.SparseGrid.of(np.asfortranarray(numbers.astype(float)))
    assert grid == pickle.loads(pickle.dumps(grid)) != rw.media.SparseGrid.of(2 * numbers)
    assert hash(grid) == hash(pickle.loads(pickle.dumps(grid)))
    # Later blocks overwrite earlier ones.
    again = rw.media.SparseGrid(
        numbers.shape, [((8, 8, 8), np.ones((16, 5, 3, *numbers.shape[3:]))), ((0, 0, 0), numbers)]
    )
    assert again == grid
    kept = np.zeros_like(numbers)
    for origin, part in grid.parts:
        kept[tuple(slice(a, a + n) for a, n in zip(origin, part.shape, strict=False))] = part
    assert np.array_equal(kept, numbers)
    assert grid.nbytes < 0.35 * numbers.nbytes
    assert repr(grid).startswith("SparseGrid(<40 x 25 x 33")
    medium = rw.GridMedium(grid, scattering=1)
    assert medium == pickle.loads(pickle.dumps(medium))
    assert "SparseGrid(" in repr(medium)


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (lambda: rw.media.SparseGrid((2, 0, 2)), ValueError, "shape must be"),
        (lambda: rw.media.SparseGrid((2, 2, 2, 4)), ValueError, "shape must be"),
        (lambda: rw.media.SparseGrid((1 << 20, 1 << 20, 1 << 20)), ValueError, "expected fewer"),
        (
            lambda: rw.media.SparseGrid((4, 4, 4), [((3, 0, 0), np.ones((2, 1, 1)))]),
            ValueError,
            "outside the",
        ),
        (
            lambda: rw.media.SparseGrid((4, 4, 4), [((-1, 0, 0), np.ones((1, 1, 1)))]),
            ValueError,
            "outside the",
        ),
        (
            lambda: rw.media.SparseGrid((4, 4, 4), [((0, 0, 0), np.ones((1, 1)))]),
            ValueError,
            "cannot have shape",
        ),
        (
            lambda: rw.media.SparseGrid((4, 4, 4), [((0, 0, 1), [[[1.0, -1.0]]])]),
            ValueError,
            "got -1 at .0, 0, 2",
        ),
        (lambda: rw.media.SparseGrid((4, 4, 4), [((0, 0, 1), [[["a"]]])]), TypeError, "must be real"),
        (lambda: rw.media.SparseGrid.of([[[1e39]]]), ValueError, "at least 0, got inf"),
        (lambda: np.array(rw.media.SparseGrid((1, 1, 1)), copy=False), ValueError, "without a copy"),
        (lambda: rw.GridMedium(ONE, extinction=1.0), ValueError, "extinction must come with an albedo"),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), scattering=1.0, albedo=np.ones((1, 1, 1))),
            ValueError,
            "absorption and scattering must be 0",
        ),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), extinction=1, albedo=np.full((1, 1, 1), 1.5)),
            ValueError,
            "albedo must be at most 1, got 1.5",
        ),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), temperature=np.ones((1, 1, 1, 3))),
            ValueError,
            r"temperature must have shape \(X, Y, Z\)",
        ),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), temperature=rw.media.SparseGrid((1, 1, 1, 3))),
            ValueError,
            r"temperature must have shape \(X, Y, Z\)",
        ),
        (
            lambda: rw.media.SparseGrid.of(3.0),
            ValueError,
            r"numbers must have shape \(X, Y, Z\) or .*, got \(\)",
        ),
        (lambda: rw.media.SparseGrid.of(np.ones((2, 2))), ValueError, "numbers must have shape"),
        (lambda: rw.media.SparseGrid((2.5, 2, 2)), TypeError, r"shape must be integers, got \(2.5, 2, 2\)"),
        (lambda: rw.media.SparseGrid(2), TypeError, "shape must be integers, got 2"),
        (
            lambda: rw.media.SparseGrid((2, 2, 2), [((0.5, 0, 0), np.ones((1, 1, 1)))]),
            TypeError,
            r"origin of a part must be integers, got \(0.5, 0, 0\)",
        ),
        (lambda: rw.GridMedium(ONE, temperature=[[[-1.0]]]), ValueError, "temperature must be finite"),
        (lambda: rw.GridMedium(ONE, brightness=-1), ValueError, "brightness must be at least 0"),
        (
            lambda: rw.GridMedium(
                np.ones((1, 1, 1)), temperature=np.ones((1, 1, 1)), emission=np.ones((1, 1, 1))
            ),
            ValueError,
            "emission must be one number or 3",
        ),
    ],
)
def test_what_cannot_be_is_refused(make, error, says):
    with pytest.raises(error, match=says) as told:
        make()
    assert "\n" not in str(told.value)


def test_arrays_that_cannot_be_read_are_refused_with_their_name(tmp_path):
    path = tmp_path / "fog.npy"
    np.save(path, np.ones((2, 2, 2), np.float32))
    whole = path.read_bytes()
    # A header without an end, one with too large a size, and a truncated one.
    for broken in (
        whole.replace(b"}", b" "),
        whole.replace(b"(2, 2, 2)", b"(9999, 99999, 99999)"),
        whole[:30],
    ):
        path.write_bytes(broken)
        with pytest.raises(ValueError, match=r"fog\.npy cannot be read: ") as told:
            rw.GridMedium.load(path, scattering=1.0)
        assert "\n" not in str(told.value)
    path.write_bytes(whole)
    assert np.array_equal(rw.GridMedium.load(path).density, np.ones((2, 2, 2)))


GROWN = """
import numpy as np
import raywright as rw

def peak():
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmHWM")) * 1024

class Slabs:
    shape = (512, 512, 512)

    def __getitem__(self, planes):
        return np.ones((len(range(*planes.indices(512))), 512, 512), np.float32)

def look(density):
    cloud = rw.GridMedium(density, scattering=1.0)
    scene = rw.Scene([rw.Box((0, 0, 0), (1, 1, 1), material=rw.MediumInterface(cloud))], environment=1.0)
    camera = rw.Camera((2, 2, 2), (0.5, 0.5, 0.5), width=4, height=4)
    return rw.render(scene, camera, rw.Path(), 1, progress=False).rgb

look(np.ones((1, 1, 1)))
before = peak()
"""


@pytest.mark.skipif(sys.platform != "linux", reason="peaks are told in other units elsewhere")
@pytest.mark.parametrize(
    ("grid", "most"),
    [
        # 537 MB of numbers, 1.6 of blocks and 3.1 of majorants, and a slab of 8 planes, 8 MB.
        pytest.param("rw.media.SparseGrid.of(Slabs())", 600e6, marks=pytest.mark.slow),
        # Where blocks are, 1 MB, and majorants.
        ("rw.media.SparseGrid((512, 512, 512), [((200, 100, 50), np.ones((60, 60, 60)))])", 25e6),
    ],
)
def test_large_grids_take_the_memory_of_what_is_in_them(grid, most):
    told = f"{GROWN}\nlook({grid})\nprint(peak() - before)"
    run = subprocess.run([sys.executable, "-c", told], capture_output=True, text=True, check=True)
    print(run.stdout)
    assert int(run.stdout) < most
