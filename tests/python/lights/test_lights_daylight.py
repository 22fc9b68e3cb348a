"""Sun and sky against the same formulas written once more, in numpy."""

import math

import numpy as np
import pytest
from test_lights_render import assert_irradiance, floor_irradiance

import raywright as rw

# Preetham, Shirley and Smits, "A Practical Analytic Model for Daylight" (1999), appendix A.2.
PEREZ = {
    "Y": ([0.1787, -0.3554, -0.0227, 0.1206, -0.0670], [-1.4630, 0.4275, 5.3251, -2.5771, 0.3703]),
    "x": ([-0.0193, -0.0665, -0.0004, -0.0641, -0.0033], [-0.2592, 0.0008, 0.2125, -0.8989, 0.0452]),
    "y": ([-0.0167, -0.0950, -0.0079, -0.0441, -0.0109], [-0.2608, 0.0092, 0.2102, -1.6537, 0.0529]),
}


def luminance_of_sky(turbidity, sun_zenith, cos_zenith, cos_sun):
    """Luminance over 683 lm/W."""
    slopes, starts = (np.array(v) for v in PEREZ["Y"])
    a, b, c, d, e = slopes * turbidity + starts

    def perez(cos_zenith, cos_sun):
        return (1 + a * np.exp(b / cos_zenith)) * (1 + c * np.exp(d * np.arccos(cos_sun)) + e * cos_sun**2)

    chi = (4 / 9 - turbidity / 120) * (math.pi - 2 * sun_zenith)
    zenith = (4.0453 * turbidity - 4.9710) * math.tan(chi) - 0.2155 * turbidity + 2.4192
    return zenith * 1000 / 683 * perez(cos_zenith, cos_sun) / perez(1.0, math.cos(sun_zenith))


def level(turbidity, sun_zenith):
    """Illuminance of a level floor by the sky, over 683 lm/W."""
    cos_zenith = ((np.arange(1500) + 0.5) / 1500)[:, None]
    turn = ((np.arange(1500) + 0.5) / 1500 * 2 * math.pi)[None]
    sine = np.sqrt(1 - cos_zenith**2)
    cos_sun = np.clip(sine * np.cos(turn) * math.sin(sun_zenith) + cos_zenith * math.cos(sun_zenith), -1, 1)
    return float(
        (luminance_of_sky(turbidity, sun_zenith, cos_zenith, cos_sun) * cos_zenith).mean() * 2 * math.pi
    )


LUMINANCE = np.array([0.212639, 0.715169, 0.072192])


@pytest.mark.parametrize(("turbidity", "degrees"), [(2, 20), (3, 45), (6, 70), (10, 85)])
def test_a_camera_sees_the_sky_of_the_formula(turbidity, degrees):
    zenith = math.radians(degrees)
    sky = rw.SunSky((math.sin(zenith), 0, math.cos(zenith)), turbidity, up=(0, 0, 1), sun_scale=0)
    for towards in [(0.0, 0.6, 0.8), (-0.8, 0.0, 0.6), (0.0, -0.99, 0.1)]:
        towards = np.array(towards) / np.linalg.norm(towards)
        camera = rw.Camera((0, 0, 0), towards, up=(0.1, 0.2, 1), fov=1e-4, width=1, height=1)
        rgb = rw.render(rw.Scene([], environment=sky), camera, samples=1, progress=False).rgb[0, 0]
        expected = luminance_of_sky(
            turbidity, zenith, towards[2], towards @ (math.sin(zenith), 0, math.cos(zenith))
        )
        # As long as no channel was clipped at 0.
        assert rgb.min() > 0
        assert float(rgb @ LUMINANCE) == pytest.approx(expected, rel=1e-4)


def irradiance_of_channels(environment):
    """Luminance of the irradiance of a floor, over 683 lm/W: channel by channel through three pictures."""
    parts = []
    for channel in range(3):
        filtered = np.zeros(3)
        filtered[channel] = 1.0
        floor = rw.Mesh(
            [(-1, -1, 0), (1, -1, 0), (0, 2, 0)], [(0, 1, 2)], material=rw.Diffuse(tuple(filtered))
        )
        camera = rw.Camera((0.3, 0, 0.03), (0, 0, 0), up=(0, 0, 1), fov=1e-3, width=8, height=8)
        image = rw.render(
            rw.Scene(floor, environment=environment),
            camera,
            rw.Path(max_depth=1),
            samples=256,
            progress=False,
        )
        parts.append(math.pi * float(image.rgb[..., channel].mean(dtype=float)))
    return float(np.dot(parts, LUMINANCE))


@pytest.mark.parametrize(("turbidity", "degrees"), [(2.5, 30), (5, 60)])
def test_a_floor_receives_the_integral_of_the_sky(turbidity, degrees):
    zenith = math.radians(degrees)
    sun = (math.sin(zenith), 0, math.cos(zenith))
    sky = rw.SunSky(sun, turbidity, up=(0, 0, 1), sun_scale=0)
    # Some 16,000 samples for each channel, with weights that vary by less than their mean.
    assert irradiance_of_channels(sky) == pytest.approx(level(turbidity, zenith), rel=0.02)


def test_the_sun_alone_is_a_small_disk():
    # Seen by a camera, twice 0.265 degrees wide; its light on the floor is its radiance by its solid angle.
    sun = (0.0, 0.6, 0.8)
    day = rw.SunSky(sun, 3, ground_albedo=0, up=(0, 0, 1), sky_scale=0)
    camera = rw.Camera((0, 0, 0), sun, up=(1, 0, 0), fov=0.6, width=101, height=101)
    seen = rw.render(rw.Scene([], environment=day), camera, samples=4, progress=False).rgb
    bright = seen[..., 1] / seen.max(axis=(0, 1))[1]
    width = 0.6 / 101
    assert float(bright.sum()) * width**2 == pytest.approx(math.pi * 0.265**2, rel=5e-3)
    angle = 2 * math.pi * (1 - math.cos(math.radians(0.265)))
    expected = float(seen.max(axis=(0, 1)).mean()) * angle * 0.8
    assert_irradiance(floor_irradiance(samples=16, environment=day), expected, slack=1e-4)
    # Away from the sun, and behind a roof, there is none.
    roof = rw.Mesh([(-9, -9, 1), (9, -9, 1), (0, 99, 1)], [(0, 1, 2)], material=rw.Diffuse(0))
    assert floor_irradiance([roof], samples=4, environment=day)[0] == 0
