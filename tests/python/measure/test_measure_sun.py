"""Where the sun is and what it sends, against closed forms and pvlib."""

import numpy as np
import pytest

import raywright as rw

measure = rw.measure


def course(latitude, declination, count):
    """The sun through a day of one declination, at the middles of even steps, y up and north along -z;
    and its hours.
    """
    hour = (np.arange(count) + 0.5) / count * 2 * np.pi - np.pi
    phi, delta = np.radians(latitude), np.radians(declination)
    up = np.sin(phi) * np.sin(delta) + np.cos(phi) * np.cos(delta) * np.cos(hour)
    north = np.cos(phi) * np.sin(delta) - np.sin(phi) * np.cos(delta) * np.cos(hour)
    west = np.cos(delta) * np.sin(hour)
    return np.stack([-west, up, -north], axis=-1), 24 / count


@pytest.mark.parametrize(("latitude", "declination"), [(47.4, 23.4), (-10.0, -5.0), (60.0, -15.0)])
def test_a_day_on_level_ground(latitude, declination):
    """The sun is up for 2 w hours of angle, cos w = -tan(latitude) tan(declination), and its sine
    integrates to
    sin w cos cos + w sin sin. The midpoint rule of 20,000 steps errs by up to two steps of the day's length.
    """
    suns, hours = course(latitude, declination, 20_000)
    found = measure.solar_exposure([], (0, 0, 0), (0, 1, 0), sun=suns, weights=hours)
    phi, delta = np.radians(latitude), np.radians(declination)
    w = np.arccos(-np.tan(phi) * np.tan(delta))
    height = np.sin(w) * np.cos(phi) * np.cos(delta) + w * np.sin(phi) * np.sin(delta)
    assert found.exposure == pytest.approx(24 / np.pi * height, rel=1e-6)
    assert found.sunlit == pytest.approx(24 / np.pi * w, abs=2 * hours)
    assert found.day == pytest.approx(found.sunlit, rel=1e-12)


def test_a_wall_takes_the_sun_that_its_shadow_says():
    """A place before a wall along z, of height h, at a distance d, is in the sun while it stands above h
    / d.
    """
    wall = rw.Mesh([(1, 0, -1e6), (1, 0, 1e6), (1, 2, 1e6), (1, 2, -1e6)], [(0, 1, 2), (0, 2, 3)])
    high = np.radians(np.linspace(1, 179, 357))
    suns = np.stack([np.cos(high), np.sin(high), np.zeros_like(high)], axis=-1)
    found = measure.solar_exposure(wall, [(0, 0, 0), (-3.0, 0, 0)], (0, 1, 0), sun=3 * suns, offset=0.0)
    for i, distance in enumerate((1.0, 4.0)):
        free = (suns[:, 0] <= 0) | (suns[:, 1] / np.maximum(suns[:, 0], 1e-300) > 2 / distance)
        assert found.sunlit[i] == free.sum()
        assert found.exposure[i] == pytest.approx(suns[free, 1].sum(), rel=1e-12)
    # Surfaces that face away from the sun, or suns below the horizon, give none.
    for normal, up in (((0, -1, 0), (0, 1, 0)), ((0, 1, 0), (0, -1, 0))):
        none = measure.solar_exposure(wall, (-3, 0, 0), normal, sun=suns, up=up)
        assert (none.exposure, none.sunlit) == (0, 0)


def test_times_and_places_are_those_of_daylight():
    times = np.arange("2025-06-21T00", "2025-06-22T00", dtype="datetime64[h]")
    suns = measure.sun_directions(times, 47.4, 8.5)
    assert suns.shape == (24, 3)
    assert np.allclose(np.linalg.norm(suns, axis=1), 1, rtol=1e-15)
    skies = np.array([sky.sun for sky in rw.SunSky.at(times, 47.4, 8.5)])
    assert np.array_equal(suns, skies)
    assert np.array_equal(measure.sun_directions("2025-06-21T12:00Z", 47.4, 8.5), suns[12])
    by_time = measure.solar_exposure([], (0, 0, 0), (0, 1, 0), times=times, latitude=47.4, longitude=8.5)
    by_sun = measure.solar_exposure([], (0, 0, 0), (0, 1, 0), sun=suns)
    assert by_time.exposure == by_sun.exposure
    assert by_sun.sunlit == (suns[:, 1] > 0).sum() == 16
    turned = measure.sun_directions(times, 47.4, 8.5, up=(0, 0, 2), north=(0, 3, 0))
    assert np.allclose(turned, suns[:, [0, 2, 1]] * (1, -1, 1), atol=1e-15)


def test_a_year_is_that_of_pvlib():
    """pvlib's is the algorithm of Reda and Andreas, right to 0.0003 degrees; ours to 0.01."""
    pvlib = pytest.importorskip("pvlib")
    pandas = pytest.importorskip("pandas")
    times = np.arange("2024-01-01T00:30", "2025-01-01", dtype="datetime64[h]") + np.timedelta64(30, "m")
    for latitude, longitude in ((47.4, 8.5), (-33.9, 151.2), (71.0, -156.8)):
        index = pandas.DatetimeIndex(times, tz="UTC")
        known = pvlib.solarposition.get_solarposition(index, latitude, longitude)
        suns = measure.sun_directions(times, latitude, longitude, up=(0, 0, 1), north=(0, 1, 0))
        zenith, azimuth = np.radians(known["zenith"].to_numpy()), np.radians(known["azimuth"].to_numpy())
        level = np.sin(zenith)
        there = np.stack([level * np.sin(azimuth), level * np.cos(azimuth), np.cos(zenith)], axis=-1)
        apart = np.degrees(2 * np.arcsin(np.linalg.norm(suns - there, axis=1) / 2))
        assert apart.max() < 0.012


def test_wrong_suns_get_one_line(box):
    place = {"points": (0.5, 2.0, 0.5), "normals": (0, 1, 0)}
    for given, told in [
        ({}, "sun must be given, or times, latitude and longitude"),
        (
            {"times": ["2025-06-21T12:00Z"], "latitude": 3},
            "sun must be given, or times, latitude and longitude",
        ),
        ({"sun": (0, 1, 0), "latitude": 3}, "either sun or times, latitude and longitude must be given"),
        ({"sun": (0, 0, 0)}, "sun must not contain zero vectors"),
        (
            {"sun": (0, 1, 0), "weights": [1, 2]},
            r"weights must be one number or have shape \(1,\), got \(2,\)",
        ),
        ({"sun": (0, 1, 0), "weights": np.nan}, "weights must be finite"),
        (
            {"times": ["2025-06-21T12:00Z"], "latitude": 91, "longitude": 0},
            "latitude must be between -90 and 90",
        ),
        ({"times": ["2025-06-21T12:00"], "latitude": 1, "longitude": 0}, r"times\[0\] must have a time zone"),
    ]:
        with pytest.raises(ValueError, match=told):
            measure.solar_exposure(box, **place, **given)
