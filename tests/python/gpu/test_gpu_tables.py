"""What devices are given, held against formulas and the core; no device is needed."""

import numpy as np
import pytest

import raywright as rw
from raywright import _core
from raywright.gpu.eyes import eye_of
from raywright.gpu.facets import ENTRIES, loss_table, mean_fresnel, mean_of
from raywright.gpu.material_table import LeftError
from raywright.gpu.measured import made_up, reflectances
from raywright.gpu.packing import packed
from raywright.rendering.job import Job


def at(table, cosine):
    return np.interp(np.sqrt(cosine), np.linspace(0, 1, ENTRIES), table)


@pytest.mark.parametrize(
    ("alpha", "truths"),
    [
        (0.1, [0.98830, 0.96929, 0.88346]),
        (0.3, [0.87737, 0.82171, 0.88881]),
        (0.5, [0.68785, 0.69825, 0.86011]),
    ],
)
def test_white_facets_reflect_what_quadratures_say(alpha, truths):
    # Of E(μ) for white facets; compare Kulla and Conty (2017).
    for cosine, truth in zip([1.0, 0.5, 0.1], truths, strict=True):
        assert abs(1 - at(loss_table(alpha), cosine) - truth) < 5e-4


def test_dielectrics_reflect_their_mean():
    # Closed forms (Walsh, 1926; Duntley, 1942).
    assert abs(mean_fresnel(1.5) - 0.0917785) < 1e-5
    for eta in (1.1, 1.33, 2.4):
        # Transmission in equals transmission out, except for the solid angle.
        assert abs((1 - mean_fresnel(eta)) - (1 - mean_fresnel(1 / eta)) * eta**2) < 1e-4


def test_metals_are_those_of_the_core():
    table, again = reflectances("gold")
    np.testing.assert_allclose(table[-1], (1.022, 0.782, 0.344), atol=1e-3)
    # Red keeps no more than the best reflected wavelength.
    np.testing.assert_allclose(again * (table[:, 0].max(), 1, 1), (0.962, 1, 1), atol=1e-3)
    # A white one compensates all loss.
    white = rw.Conductor(eta=1e-5, k=1e5, alpha=0.5)
    loss = mean_of(loss_table(0.5))
    np.testing.assert_allclose(made_up(white, loss) * np.pi * loss, 1, atol=3e-3)


CAMERAS = {
    "plain": {"fov": 50},
    "of a matrix": {"focal_length_px": (70.0, -60.0), "principal_point": (10.0, 30.0), "skew": 3.0},
}


@pytest.mark.parametrize("name", CAMERAS)
def test_eyes_see_what_cameras_see(name):
    camera = rw.Camera((3, 1, 5), (0, 0.5, 0), width=48, height=20, **CAMERAS[name])
    flat = rw.Scene(rw.scenes.torus_knot(along=10, around=3)).gpu_arrays()
    eye = eye_of(camera, flat)
    points = np.random.default_rng(0).random((50, 2))
    ways = eye.corner + eye.across * points[:, :1] + eye.down * points[:, 1:]
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    origins, wanted = camera.rays_through(points * (48, 20))
    np.testing.assert_allclose(ways, wanted, atol=1e-12)
    np.testing.assert_allclose(eye.eye, (origins[0] - flat.center) * flat.scale, atol=1e-12)


def test_shares_of_light_are_what_they_are_told_to_be():
    sky = rw.EnvironmentMap(np.random.default_rng(2).random((5, 8, 3)) ** 4)
    lamps = [
        rw.Mesh(np.eye(3) * size, [(0, 1, 2)], emission=rw.Emission(size, side=side))
        for size, side in [(1.0, "front"), (2.0, "both"), (3.0, "back")]
    ]
    scene = rw.Scene(lamps, lights=rw.PointLight((0, 0, 1), 5.0), environment=sky)
    flat = scene.gpu_arrays()
    found = packed(scene, flat)
    assert found.lights["kind"].tolist() == [0, 0, 0, 1]
    assert found.lights["sides"].tolist() == [1, 3, 2, 0]
    assert abs(found.lights["share"].sum(dtype=float) - 1) < 1e-6
    # As radiance times area, twice for both sides.
    np.testing.assert_allclose(found.lights["share"][1:3] / found.lights["share"][0], [16, 27], rtol=1e-5)
    np.testing.assert_allclose(found.lights["radiance"][3], 5 * flat.scale**2)
    assert found.faces["light"].tolist() == [0, 1, 2]
    first = int(found.lit["sky_shares"])
    rows = np.diff(found.numbers[first : first + 5], prepend=0)
    columns = np.diff(found.numbers[first + 5 : first + 45].reshape(5, 8), prepend=0, axis=1)
    assert (rows > 0).all()
    assert (columns > 0).all()
    np.testing.assert_allclose(columns.sum(axis=1), 1, rtol=1e-6)


def test_what_cannot_be_packed_is_told():
    scene = rw.Scene(rw.Mesh(np.eye(3), [(0, 1, 2)], emission=rw.Checker()))
    with pytest.raises(LeftError, match="the emission of shape 0 is a "):
        packed(scene, scene.gpu_arrays())


def test_sums_of_samples_are_worth_the_samples():
    scene, camera = rw.Scene([]), rw.Camera((0, 0, 1), (0, 0, 0), width=7, height=5)
    job = Job(scene, camera, rw.Path(), 0, False, None, rw.rendering.Independent(), rw.rendering.BoxFilter())
    rendering = _core.Rendering(job.core, 1, 1)
    samples = np.random.default_rng(3).random((24, 35, 3))
    for first, end in ((0, 5), (5, 24)):
        some = samples[first:end]
        largest = np.take_along_axis(some, some.max(axis=2).argmax(axis=0)[None, :, None], axis=0)[0]
        sums = np.concatenate([some.sum(axis=0), (some**2).sum(axis=0), largest], axis=1)
        rendering.begin(end)
        rendering.add(end - first, sums, 1)
        rendering.end(1.0)
        with pytest.raises(ValueError, match="the pass has fewer samples"):
            rendering.add(1, sums, 0)
    assert (rendering.samples, rendering.dropped, rendering.counts.max()) == (24, 2, 24)
    np.testing.assert_allclose(rendering.rgb.reshape(35, 3), samples.mean(axis=0), rtol=1e-6)
    error = samples.std(axis=0, ddof=1) / np.sqrt(24)
    np.testing.assert_allclose(rendering.uncertainty[0].reshape(35, 3), error, rtol=1e-5)
    rendering.begin(25)
    for wrong, why in [
        (sums[:-1], "another size"),
        (np.where(np.arange(9) == 2, np.nan, sums), "sums must be finite and at least 0"),
        (-sums, "sums must be finite"),
    ]:
        with pytest.raises(ValueError, match=why):
            rendering.add(1, wrong, 0)
    with pytest.raises(ValueError, match="more samples were dropped than taken"):
        rendering.add(1, sums, 36)
    clamped = Job(
        scene, camera, rw.Path(), 0, False, 1.0, rw.rendering.Independent(), rw.rendering.BoxFilter()
    )
    other = _core.Rendering(clamped.core, 1, 1)
    other.begin(1)
    with pytest.raises(ValueError, match="stores more than sums"):
        other.add(1, sums, 0)
