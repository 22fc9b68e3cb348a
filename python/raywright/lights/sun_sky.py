"""Daylight."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, color, number
from .light import Environment
from .sun_position import sun_directions, way
from .times import Time, Times, one_or_many


@dataclass(frozen=True, init=False)
class SunSky(Environment):
    """A clear sky, the sun in it, and a plain below the horizon that reflects both.

    The sky is that of Preetham, Shirley and Smits ("A Practical Analytic Model for Daylight", 1999). The sun
    is a disk of 0.53°, a black body of 5778 K seen through the air of the same paper. Radiance is in
    W·sr⁻¹·m⁻², weighted by the eye's sensitivity: its luminance times 683 lm·W⁻¹ is in cd·m⁻².

    The formula of the sky ends at sunset. In twilight it is the sky of sunset, dimmed by the illuminance of
    the ground (Seidelmann, "Explanatory Supplement to the Astronomical Almanac", 1992), and black once the
    sun is 18° below the horizon: moon and stars are not included.

    Parameters
    ----------
    sun : 3 floats
        The direction of the sun, of any length but 0; at night it is below the horizon. See `at` for that of
        a time and place.
    turbidity : float
        Turbidity of the air: 2, very clear, to 10, hazy.
    ground_albedo : float or 3 floats
        Share of the light that the plain reflects, in [0, 1].
    up : 3 floats
        The direction of the zenith, of any length but 0.
    sun_scale, sky_scale : float
        Factors of the light of the sun and of the sky, at least 0.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite.
    TypeError
        If an argument is not a number.

    See Also
    --------
    measure.solar_exposure : Hours of sun.

    Examples
    --------
    >>> sky = rw.SunSky((0, 1, 0), turbidity=3)
    >>> round(sky.elevation, 6)
    90.0
    """

    sun: Triple
    turbidity: float
    ground_albedo: Triple
    up: Triple
    sun_scale: float
    sky_scale: float

    def __init__(
        self,
        sun: ArrayLike,
        turbidity: float = 3.0,
        ground_albedo: ArrayLike = 0.2,
        up: ArrayLike = (0.0, 1.0, 0.0),
        sun_scale: float = 1.0,
        sky_scale: float = 1.0,
    ) -> None:
        values = {
            "sun": way("sun", sun),
            "turbidity": number("turbidity", turbidity),
            "ground_albedo": color("ground_albedo", ground_albedo, most=1.0),
            "up": way("up", up),
            "sun_scale": number("sun_scale", sun_scale),
            "sky_scale": number("sky_scale", sky_scale),
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)
        if not 2 <= self.turbidity <= 10:
            raise ValueError(f"turbidity must be between 2 and 10, got {turbidity}")
        for name in ("sun_scale", "sky_scale"):
            if getattr(self, name) < 0:
                raise ValueError(f"{name} must be at least 0, got {getattr(self, name)}")

    @property
    def elevation(self) -> float:
        """The angle of the sun above the horizon, in degrees; negative at night."""
        sun, up = (np.array(to) / np.abs(to).max() for to in (self.sun, self.up))
        return math.degrees(math.atan2(float(sun @ up), float(np.linalg.norm(np.cross(sun, up)))))

    @overload
    @classmethod
    def at(  # type: ignore[overload-overlap]  # A text is not taken letter by letter.
        cls,
        when: Time,
        latitude: float,
        longitude: float,
        turbidity: float = 3.0,
        ground_albedo: ArrayLike = 0.2,
        up: ArrayLike = (0.0, 1.0, 0.0),
        north: ArrayLike = (0.0, 0.0, -1.0),
        sun_scale: float = 1.0,
        sky_scale: float = 1.0,
    ) -> SunSky: ...

    @overload
    @classmethod
    def at(
        cls,
        when: Times,
        latitude: float,
        longitude: float,
        turbidity: float = 3.0,
        ground_albedo: ArrayLike = 0.2,
        up: ArrayLike = (0.0, 1.0, 0.0),
        north: ArrayLike = (0.0, 0.0, -1.0),
        sun_scale: float = 1.0,
        sky_scale: float = 1.0,
    ) -> tuple[SunSky, ...]: ...

    @classmethod
    def at(
        cls,
        when: Time | Times,
        latitude: float,
        longitude: float,
        turbidity: float = 3.0,
        ground_albedo: ArrayLike = 0.2,
        up: ArrayLike = (0.0, 1.0, 0.0),
        north: ArrayLike = (0.0, 0.0, -1.0),
        sun_scale: float = 1.0,
        sky_scale: float = 1.0,
    ) -> SunSky | tuple[SunSky, ...]:
        """Return the daylight at a time and place, or at each of several times.

        The position of the sun is that of the low-precision formulas of the Astronomical Almanac, to 0.01°
        from 1950 to 2050 (Michalsky, "The Astronomical Almanac's Algorithm for Approximate Solar Position",
        1988).

        Parameters
        ----------
        when : datetime, numpy.datetime64, str, or sequence or (N,) array of these
            The time. A datetime must have a time zone, and so must ISO 8601 text, such as
            ``"2025-06-21T12:00+02:00"``, or ``Z`` for UTC. A datetime64 is in UTC.
        latitude, longitude : float
            The place in degrees, north and east positive.
        north : 3 floats
            The direction of the north; only its component at right angles to `up` counts.
        turbidity, ground_albedo, up, sun_scale, sky_scale
            As the class takes them.

        Returns
        -------
        SunSky, or tuple of SunSky
            One for each time, if there are several. Its `elevation` is negative at night.

        Raises
        ------
        ValueError
            If a time has no zone or cannot be read, the latitude is not between -90 and 90, or `north` is
            along `up`; also as raised by `SunSky`.
        TypeError
            If `when` is something else; also as raised by `SunSky`.

        See Also
        --------
        measure.sun_directions : The directions alone.

        Examples
        --------
        >>> noon = rw.SunSky.at("2025-06-21T12:00+00:00", latitude=51.48, longitude=0.0)
        >>> round(noon.elevation, 1)
        62.0
        >>> night, day = rw.SunSky.at(["2025-06-21T00:00Z", "2025-06-21T12:00Z"], latitude=51.48, longitude=0)
        >>> night.elevation < 0 < day.elevation
        True
        """
        times = one_or_many("when", when)
        many = times if isinstance(times, list) else [times]
        suns = sun_directions(many, latitude, longitude, way("up", up), way("north", north))
        days = tuple(cls(sun, turbidity, ground_albedo, up, sun_scale, sky_scale) for sun in suns)
        return days if isinstance(times, list) else days[0]
