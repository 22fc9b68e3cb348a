"""Solar exposure of surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import real_array
from ..lights.sun_position import sun_directions as directions_at
from ..lights.sun_position import way
from ..lights.times import Time, Times, one_or_many
from ..query.surface_points import SurfacePoints
from ..scene.progress import BuildProgress, check_progress, watcher
from ..scene.scene import SceneLike
from .places import Floats, places, scene_of, unit, units
from .plots import Plotted

_TOGETHER = 1 << 20


@dataclass(frozen=True, eq=False, repr=False)
class SolarExposure(Plotted):
    """Solar exposure of points; arrays of their leading shape. NaN where there is no point.

    Attributes
    ----------
    exposure : (...) float64
        Sum over the moments at which the sun reaches the point: weight times the cosine between sun and
        normal. With direct normal irradiance times hours as weights, it is the irradiation of the surface.
    sunlit : (...) float64
        Sum of the weights of these moments: their number with a weight of 1, hours of sun with the hours
        between moments as weights.
    day : float
        Sum of the weights of all moments with the sun above the horizon.

    See Also
    --------
    measure.solar_exposure : Makes it.

    Examples
    --------
    >>> plain = rw.Mesh([[-9, 0, 9], [9, 0, 9], [0, 0, -9]], [[0, 1, 2]])
    >>> sun = rw.measure.solar_exposure(plain, sun=[[0, 1, 0], [1, 1, 0], [0, -1, 0]])
    >>> sun.exposure.round(4).tolist(), sun.sunlit.tolist(), sun.day
    ([1.7071], [2.0], 2.0)
    """

    exposure: Floats
    sunlit: Floats
    day: float
    _drawn = ("exposure", "sunlit")

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each point, in C order.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> plain = rw.Mesh([[-9, 0, 9], [9, 0, 9], [0, 0, -9]], [[0, 1, 2]])
        >>> rw.measure.solar_exposure(plain, sun=[[0, 1, 0]]).to_dict()["sunlit"].tolist()
        [1.0]
        """
        return {"exposure": self.exposure.reshape(-1), "sunlit": self.sunlit.reshape(-1)}

    def __repr__(self) -> str:
        return f"SolarExposure(shape={self.exposure.shape}, day={self.day:g})"


def sun_directions(
    times: Time | Times,
    latitude: float,
    longitude: float,
    up: ArrayLike = (0.0, 1.0, 0.0),
    north: ArrayLike = (0.0, 0.0, -1.0),
) -> Floats:
    """Return the direction to the sun at each time, from a place on Earth.

    Parameters
    ----------
    times : datetime, numpy.datetime64, str, or sequence or (T,) array of these
        Times, as in `SunSky.at`: with their zones, datetime64 in UTC.
    latitude, longitude : float
        The place in degrees, north and east positive.
    up, north : 3 floats
        The zenith and the north of the scene.

    Returns
    -------
    (T, 3) or (3,) float64
        Unit directions to the sun's center, to 0.01° from 1950 to 2050; below the horizon at night.

    Raises
    ------
    ValueError, TypeError
        As `SunSky.at` does.

    See Also
    --------
    SunSky.at : The sky at a time.

    Examples
    --------
    >>> rw.measure.sun_directions("2024-03-20T12:07:00Z", latitude=0, longitude=0).round(2).tolist()
    [0.0, 1.0, -0.0]
    """
    known = one_or_many("times", times)
    suns = directions_at(
        known if isinstance(known, list) else [known], latitude, longitude, way("up", up), way("north", north)
    )
    return suns if isinstance(known, list) else suns[0]


def solar_exposure(
    scene: SceneLike,
    points: SurfacePoints | ArrayLike | None = None,
    normals: ArrayLike | None = None,
    sun: ArrayLike | None = None,
    times: Times | None = None,
    latitude: float | None = None,
    longitude: float | None = None,
    weights: ArrayLike | None = None,
    up: ArrayLike = (0.0, 1.0, 0.0),
    north: ArrayLike = (0.0, 0.0, -1.0),
    offset: float | None = None,
    progress: BuildProgress | None = None,
    threads: int | None = None,
) -> SolarExposure:
    """Find the hours of sun of points on surfaces, and the irradiation that falls on them.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Shapes that cast shadows.
    points : Hits, ClosestPoints or (..., 3) array, optional
        Points on surfaces. Rays leave hits exactly as in `Hits.spawn_rays`, and plain points by `offset`. By
        default the centers of all faces; the scene must then consist of meshes.
    normals : (..., 3) array, optional
        Normals of any length; those of the surfaces if not given, for hits only.
    sun : (T, 3) array, optional
        Directions to the sun, of any length; or `times` with `latitude` and `longitude`, as `sun_directions`
        takes them.
    weights : float or (T,) array, optional
        Weight of each moment, such as its share of the year or the direct normal irradiance; 1 if not given.
    up, north : 3 floats
        Zenith and north. The sun does not count below the horizon of the zenith.
    offset : float, optional
        Distance along the normal from plain points to the rays' origins, as for `sky_view`.
    progress : bool or callable, optional
        As for `sky_view`.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.

    Returns
    -------
    SolarExposure
        With the leading shape of the points, or (F,) for all faces of all shapes in order.

    Raises
    ------
    ValueError
        If neither the sun nor times and place are given, or both; if shapes do not fit, a number is not
        finite, a vector has no length, or normals are missing; also as raised by `sun_directions`.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    measure.sun_directions : The directions alone.
    measure.sky_view : The light of the sky.

    Notes
    -----
    The sun is treated as a point, its center, so shadows have sharp edges instead of half a degree of
    penumbra. Nothing is sampled.

    Examples
    --------
    >>> plain = rw.Scene(rw.Plane(normal=(0, 1, 0)))
    >>> times = np.arange("2024-06-21T00", "2024-06-22T00", dtype="datetime64[h]")
    >>> sun = rw.measure.solar_exposure(plain, [0, 0, 0], (0, 1, 0), times=times, latitude=0, longitude=0)
    >>> sun.sunlit.item(), sun.day
    (12.0, 12.0)
    """
    suns = _suns(sun, times, latitude, longitude, up, north)
    counted = np.ones(len(suns)) if weights is None else _weights(weights, len(suns))
    if progress is not None:
        check_progress(progress)
    scene = scene_of(scene)
    where = places(scene, points, normals, offset, threads)
    day = np.flatnonzero(suns @ unit("up", up) > 0)
    exposure, sunlit = np.zeros(len(where)), np.zeros(len(where))
    step = max(_TOGETHER // max(len(where), 1), 1)
    with watcher(progress, "solar exposure") as report:
        for start in range(0, len(day), step):
            some = day[start : start + step]
            cosine = suns[some] @ where.normals.T
            ways = np.broadcast_to(suns[some][:, None], (*cosine.shape, 3))
            starts = np.broadcast_to(where.origins, ways.shape)
            shines = ~scene.occluded(starts, ways, mask=cosine > 0, threads=threads) & (cosine > 0)
            exposure += counted[some] @ np.where(shines, cosine, 0.0)
            sunlit += counted[some] @ shines
            if report is not None:
                report(min(1.0, (start + step) / len(day)))
    for sums in (exposure, sunlit):
        sums[~np.isfinite(where.origins).all(axis=1)] = np.nan
    lead = where.shape
    total = float(counted[day].sum())
    found = SolarExposure(exposure.reshape(lead), sunlit.reshape(lead), total)
    found._at(scene, points)
    return found


def _suns(
    sun: ArrayLike | None,
    times: Times | None,
    latitude: float | None,
    longitude: float | None,
    up: ArrayLike,
    north: ArrayLike,
) -> Floats:
    if sun is None:
        if times is None or latitude is None or longitude is None:
            raise ValueError("sun must be given, or times, latitude and longitude")
        return np.atleast_2d(sun_directions(times, latitude, longitude, up, north))
    if times is not None or latitude is not None or longitude is not None:
        raise ValueError("either sun or times, latitude and longitude must be given, got both")
    suns = np.atleast_2d(units("sun", sun))
    if suns.ndim != 2:
        raise ValueError(f"sun must have shape (T, 3), got {suns.shape}")
    return suns


def _weights(given: ArrayLike, count: int) -> Floats:
    array = real_array("weights", given).astype(np.float64)
    if array.shape not in ((), (count,)):
        raise ValueError(f"weights must be one number or have shape ({count},), got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError("weights must be finite, got NaN or infinity")
    return np.broadcast_to(array, count).astype(np.float64)
