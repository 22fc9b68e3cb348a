"""Where the sun stands."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime, timezone

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Triple, number, triple

_EPOCH = datetime(2000, 1, 1, 12, tzinfo=timezone.utc)


def sun_positions(
    times: Sequence[datetime], latitude: float, longitude: float
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return azimuth, from the north over the east, and elevation of the sun's center, both (N,) in radians.

    By the low-precision formulas of the Astronomical Almanac, to 0.01° from 1950 to 2050 (Michalsky, "The
    Astronomical Almanac's Algorithm for Approximate Solar Position", 1988). Air, which lifts the sun by half
    a degree at the horizon, is not in them.

    Parameters
    ----------
    times : sequence of datetime
        With their time zones.
    latitude, longitude : float
        In degrees, north and east positive.

    Raises
    ------
    ValueError
        If the latitude is not between -90 and 90, or a number is not finite.
    """
    place, east = number("latitude", latitude), number("longitude", longitude)
    if not -90 <= place <= 90:
        raise ValueError(f"latitude must be between -90 and 90 degrees, got {latitude}")
    days = np.array([(when - _EPOCH).total_seconds() for when in times], np.float64) / 86400.0
    mean_longitude = np.radians((280.460 + 0.9856474 * days) % 360.0)
    anomaly = np.radians((357.528 + 0.9856003 * days) % 360.0)
    ecliptic = mean_longitude + np.radians(1.915 * np.sin(anomaly) + 0.020 * np.sin(2 * anomaly))
    obliquity = np.radians(23.439 - 0.0000004 * days)
    ascension = np.arctan2(np.cos(obliquity) * np.sin(ecliptic), np.cos(ecliptic))
    declination = np.arcsin(np.sin(obliquity) * np.sin(ecliptic))
    # Greenwich mean sidereal time: the Earth turns once and a 365th per day.
    hour = np.radians((280.46062 + 360.98564737 * days + east) % 360.0) - ascension
    phi = np.radians(place)
    height = np.sin(declination) * np.sin(phi) + np.cos(declination) * np.cos(phi) * np.cos(hour)
    azimuth = np.arctan2(
        -np.cos(declination) * np.sin(hour),
        np.sin(declination) * np.cos(phi) - np.cos(declination) * np.sin(phi) * np.cos(hour),
    )
    return azimuth % (2 * np.pi), np.arcsin(np.clip(height, -1.0, 1.0))


def sun_directions(
    times: Sequence[datetime], latitude: float, longitude: float, up: Triple, north: Triple
) -> NDArray[np.float64]:
    """Return the unit direction of the sun at each time, (N, 3), for the `up` and `north` of a scene.

    Raises
    ------
    ValueError
        If `north` is along `up`; also as raised by `sun_positions`.
    """
    zenith, ahead = np.array(up), np.array(north)
    zenith /= np.linalg.norm(zenith)
    ahead = ahead - zenith * (ahead @ zenith)
    if not np.linalg.norm(ahead) > 1e-12:
        raise ValueError(f"north must not be parallel to up, got {north!r}")
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, zenith)
    azimuth, elevation = (angle[:, None] for angle in sun_positions(times, latitude, longitude))
    level = ahead * np.cos(azimuth) + right * np.sin(azimuth)
    suns: NDArray[np.float64] = level * np.cos(elevation) + zenith * np.sin(elevation)
    return suns


def way(name: str, value: ArrayLike) -> Triple:
    """Return a direction that has a length."""
    given = triple(name, value)
    if given == (0, 0, 0):
        raise ValueError(f"{name} must not be zero, got {given}")
    return given
