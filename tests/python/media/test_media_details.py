"""What a little haze must not change: filtered textures, and how often lights are asked."""

import math

import numpy as np
import pytest

import raywright as rw

BLACK = rw.Diffuse(0.0)
#: So thin that no path is scattered in it.
HAZE = rw.Homogeneous(absorption=1e-12, scattering=0.0)


def picture_on_a_floor():
    rows = np.indices((64, 64)).sum(axis=0) % 2
    return rw.ImageTexture(rows[..., None].astype(np.float32), transform=8.0)


def floor(**how):
    corners = [(-50, -50, 0), (50, -50, 0), (50, 50, 0), (-50, 50, 0)]
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], uv=[(0, 0), (1, 0), (1, 1), (0, 1)], **how)


@pytest.mark.parametrize(
    "integrator",
    [
        rw.Path(),
        rw.Path(max_depth=2),
        rw.Direct(),
        rw.Whitted(),
        rw.Bidirectional(max_depth=2),
        rw.LightTraced(),
        rw.PhotonMap(2000),
    ],
    ids=lambda one: type(one).__name__,
)
@pytest.mark.parametrize("how", ["reflects", "shines"])
def test_haze_leaves_textures_filtered(integrator, how):
    # Far away a checker is finer than pixels: unfiltered samples are black or white, filtered ones gray.
    texture = picture_on_a_floor()
    looks = {"material": rw.Diffuse(texture)} if how == "reflects" else {"emission": texture}
    ground = floor(**{"material": BLACK, **looks})
    mirror = rw.Mesh(
        [(-50, 30, 0), (50, 30, 0), (50, 30, 50), (-50, 30, 50)], [(0, 1, 2), (0, 2, 3)], material=rw.Mirror()
    )
    lamp = rw.Sphere((0, 0, 30), 1.0, material=BLACK, emission=700.0)
    camera = rw.Camera((0, -45, 4), (0, 0, 0), up=(0, 0, 1), fov=40, width=24, height=16)
    samples = 64 if isinstance(integrator, rw.LightTraced | rw.PhotonMap) else 4
    found = []
    for medium in (None, HAZE):
        scene = rw.Scene([ground, mirror, lamp], medium=medium)
        assert "filtered textures" in scene.plan().needed
        image = rw.render(scene, camera, integrator, samples=samples, seed=4, progress=False)
        found.append(image.rgb[..., 1].astype(float))
    clear, hazy = found
    spread = [np.abs(np.diff(one[2:9], axis=1)).mean() / one[2:9].mean() for one in found]
    # The floor far away and in the mirror is as smooth in haze as without.
    assert spread[1] < 1.3 * spread[0] + 0.02, spread
    np.testing.assert_allclose(hazy.mean(), clear.mean(), rtol=0.05)


def lit(integrator, medium, samples=1024):
    """A matt floor below three lamps of other sizes, and the variance of a sample of it."""
    lamps = [
        rw.Sphere((x, 0, 2), radius, material=BLACK, emission=4.0 / radius**2)
        for x, radius in ((-1.5, 0.3), (0, 0.5), (1.5, 0.2))
    ]
    camera = rw.Camera((0, -5, 3), (0, 0, 0), up=(0, 0, 1), fov=0.01, width=1, height=1)
    scene = rw.Scene([floor(material=rw.Diffuse(0.5)), *lamps], medium=medium)
    image = rw.render(
        scene, camera, integrator, samples=samples, seed=2, sampler=rw.rendering.Independent(), progress=False
    )
    return float(image.rgb[0, 0, 1]), float(image.standard_error[0, 0].max())


@pytest.mark.parametrize(
    "kind",
    [
        lambda n: rw.Direct(light_samples=n),
        lambda n: rw.Direct(light_samples=n, surface_samples=3),
        lambda n: rw.Whitted(light_samples=n),
    ],
    ids=["direct", "direct split", "Whitted"],
)
def test_haze_leaves_as_many_light_samples(kind):
    once, often = lit(kind(1), HAZE), lit(kind(16), HAZE)
    clear = lit(kind(16), None)
    # The error of 16 light samples is a quarter, and less if they are stratified over the lights.
    assert often[1] < 0.35 * once[1]
    assert math.isclose(often[1], clear[1], rel_tol=0.3)
    # Five standard errors, which chance exceeds once in a million.
    assert abs(often[0] - clear[0]) < 5 * math.hypot(often[1], clear[1])
    assert abs(once[0] - clear[0]) < 5 * math.hypot(once[1], clear[1])


def test_haze_leaves_as_many_surface_samples():
    def metal(surface_samples, medium):
        lamp = rw.Sphere((0, 2, 2), 0.8, material=BLACK, emission=3.0)
        camera = rw.Camera((0, -3, 3), (0, 0, 0), up=(0, 0, 1), fov=0.01, width=1, height=1)
        ground = floor(material=rw.Conductor("Ag", roughness=0.5))
        scene = rw.Scene([ground, lamp], medium=medium)
        how = rw.Direct(surface_samples=surface_samples)
        image = rw.render(
            scene, camera, how, samples=256, seed=2, sampler=rw.rendering.Independent(), progress=False
        )
        return float(image.rgb[0, 0, 1]), float(image.standard_error[0, 0].max())

    # Equal random numbers make the same picture, unlike that of one direction per sample.
    np.testing.assert_allclose(metal(8, HAZE), metal(8, None), rtol=1e-5)
    assert not math.isclose(metal(8, HAZE)[1], metal(1, HAZE)[1], rel_tol=0.1)
