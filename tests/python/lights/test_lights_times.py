"""Daylight by the clock: times as people write them, and nights."""

import math
import re
from datetime import date, datetime, timedelta, timezone

import numpy as np
import pytest

import raywright as rw

TYPES = "when must be a datetime, a numpy.datetime64, or ISO 8601 text, or a sequence of these, got "
PLACE = {"latitude": 47.4, "longitude": 8.5}
NOON = datetime(2025, 6, 21, 11, 30, tzinfo=timezone.utc)


@pytest.mark.parametrize(
    "when",
    [
        NOON.astimezone(timezone(timedelta(hours=2))),
        np.datetime64("2025-06-21T11:30"),
        np.datetime64("2025-06-21T11:30:00.000000000"),
        np.array("2025-06-21T11:30", "datetime64[s]"),
        "2025-06-21T11:30Z",
        "2025-06-21T11:30:00+00:00",
        "2025-06-21 13:30+02:00",
        np.str_("2025-06-21T06:30:00.000-05:00"),
    ],
    ids=repr,
)
def test_a_time_may_be_written_in_any_way(when):
    assert rw.SunSky.at(when, **PLACE) == rw.SunSky.at(NOON, **PLACE)


def test_a_day_alone_is_its_beginning_in_utc_for_numpy():
    midnight = datetime(2025, 6, 21, tzinfo=timezone.utc)
    assert rw.SunSky.at(np.datetime64("2025-06-21"), **PLACE) == rw.SunSky.at(midnight, **PLACE)


@pytest.mark.parametrize("make", [np.asarray, list, tuple, iter, lambda hours: hours.astype(object).tolist()])
def test_several_times_give_as_many_skies(make):
    hours = np.arange("2025-06-21T00", "2025-06-22T00", dtype="datetime64[h]")
    one_by_one = tuple(rw.SunSky.at(hour, **PLACE) for hour in hours)
    given = make(hours)
    if isinstance(given, list) and isinstance(given[0], datetime):
        given = [hour.replace(tzinfo=timezone.utc) for hour in given]
    assert rw.SunSky.at(given, **PLACE) == one_by_one
    # Night, day, and night again.
    up = [sky.elevation > 0 for sky in one_by_one]
    assert up == sorted(up[:12]) + sorted(up[12:], reverse=True)
    assert 0 < sum(up) < 24


def test_no_times_are_no_skies():
    assert rw.SunSky.at([], **PLACE) == ()
    assert rw.SunSky.at(np.array([], "datetime64[s]"), **PLACE) == ()


@pytest.mark.parametrize(
    ("when", "kind", "message"),
    [
        (NOON.replace(tzinfo=None), ValueError, "when must have a time zone, got datetime."),
        ("2025-06-21T11:30", ValueError, "when must have a time zone, got '2025-06-21T11:30': add an "),
        ([NOON, "2025-06-21"], ValueError, "when[1] must have a time zone, got '2025-06-21'"),
        ("noon", ValueError, "when must be ISO 8601, as '2025-06-21T12:00+02:00', got 'noon'"),
        ("", ValueError, "when must be ISO 8601, as '2025-06-21T12:00+02:00', got ''"),
        (np.datetime64("NaT", "s"), ValueError, "when must be a time, got "),
        (np.array(["2025-06-21", "NaT"], "datetime64[D]"), ValueError, "when[1] must be a time, got "),
        (np.datetime64("12025-06-21"), ValueError, "when must be between the years 1 and 9999"),
        (np.datetime64(10**12, "Y"), ValueError, "when must be between the years 1 and 9999, got "),
        (np.zeros((2, 3), "datetime64[s]"), ValueError, "when must be one time or a row of them, got"),
        (1750500000, TypeError, TYPES + "1750500000"),
        (date(2025, 6, 21), TypeError, TYPES + "datetime.date(2025, 6, 21)"),
        (None, TypeError, TYPES + "None"),
        (np.arange(3.0), TypeError, TYPES.replace("when", "when[0]")),
    ],
    ids=repr,
)  # fmt: skip
def test_what_is_no_time_is_told(when, kind, message):
    with pytest.raises(kind, match=re.escape(message)):
        rw.SunSky.at(when, **PLACE)


def sky(degrees, **more):
    way = math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0.0
    return rw.SunSky(way, **more)


def zenith(environment):
    camera = rw.Camera((0, 0, 0), (0, 1, 0), up=(1, 0, 0), fov=1e-4, width=1, height=1)
    scene = rw.Scene([], environment=environment)
    return rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].astype(float)


def test_the_sky_goes_out_as_almanacs_say():
    # Lux on level ground at sunset, and as civil and nautical twilight end.
    evening = [zenith(sky(degrees)) for degrees in (0, -6, -12)]
    assert evening[1] / evening[0] == pytest.approx(np.full(3, 3.4 / 759), rel=0.02)
    assert evening[2] / evening[0] == pytest.approx(np.full(3, 0.0081 / 759), rel=0.02)
    # Without a step where the sun sets.
    assert zenith(sky(1e-7)) == pytest.approx(zenith(sky(-1e-7)), rel=1e-5)


def test_night_is_black_and_lamps_shine_in_it():
    night = rw.SunSky.at("2025-06-21T23:30Z", **PLACE)
    assert night.elevation < -18
    assert (zenith(night) == 0).all()
    floor = rw.Plane((0, 0, 0), (0, 1, 0), material=rw.Diffuse(0.5))
    camera = rw.Camera((0, 1, 0), (0, 0, 0), up=(0, 0, 1), fov=0.1, width=1, height=1)
    for environment in (None, night):
        scene = rw.Scene(floor, lights=rw.PointLight((0, 2, 0), 8.0), environment=environment)
        seen = rw.render(scene, camera, samples=4, progress=False)
        assert seen.rgb[0, 0] == pytest.approx(np.full(3, 0.5 / math.pi * 8 / 4), rel=1e-5)
        assert seen.warnings == ()
    dark = rw.render(rw.Scene(floor, environment=night), camera, samples=16, progress=False)
    assert (dark.rgb == 0).all()


def test_elevation_is_negative_below_the_horizon():
    for degrees in (-90, -18, -1e-3, 0, 45):
        assert sky(degrees).elevation == pytest.approx(degrees, abs=1e-9)
