"""Laser scanners: where they stand, and which beams they send."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Triple, frozen, integer, number, positive, real_array, triple
from .places import Floats, unit


@dataclass(frozen=True, kw_only=True)
class _Scanner:
    """The base class of scanners."""

    position: Triple = (0.0, 0.0, 0.0)
    forward: Triple = (1.0, 0.0, 0.0)
    up: Triple = (0.0, 1.0, 0.0)
    min_range: float = 0.0
    max_range: float = math.inf
    divergence: float = 0.0
    rays: int = 16
    resolution: float = 0.3

    def _check(self) -> None:
        for name in ("position", "forward", "up"):
            object.__setattr__(self, name, triple(name, getattr(self, name)))
        axes(self.forward, self.up)
        least = number("min_range", self.min_range)
        if least < 0 or not self.max_range > least:
            raise ValueError(
                f"min_range must be at least 0 and less than max_range, got {least} and {self.max_range}"
            )
        positive("resolution", self.resolution)
        if not 0 <= number("divergence", self.divergence) < 90:
            raise ValueError(f"divergence must be at least 0 and less than 90 degrees, got {self.divergence}")
        integer("rays", self.rays, 1)
        if self.divergence == 0:
            object.__setattr__(self, "rays", 1)


@dataclass(frozen=True, kw_only=True)
class SpinningLidar(_Scanner):
    """A scanner with beams one above the other that rotate about the vertical.

    Parameters
    ----------
    elevations : (R,) array
        Elevations of the beams above the horizon, in degrees, one for each row.
    columns : int
        Number of columns of a turn.
    start, stop : float
        First and last azimuth, in degrees from `forward` on, anticlockwise as seen from above; `stop` is not
        reached.
    position : 3 floats
        Position of the scanner.
    forward, up : 3 floats
        Direction of azimuth 0, and the vertical, by default y; only the component of `forward` at right
        angles to `up` counts.
    min_range, max_range : float
        Limits of the measured range, both included. Nearer surfaces are not measured, but hide surfaces
        behind them.
    divergence : float
        Full angle of a beam's cone, in degrees; 0 for a line.
    rays : int
        Number of rays for a beam with a divergence.
    resolution : float
        Minimum distance between two surfaces with separate returns: the full width at half maximum of the
        pulse, as a length in the scene's unit.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, `forward` is along `up`, or there are no beams.
    TypeError
        If an argument is not a number.

    See Also
    --------
    measure.RasterLidar : A scanner of a rectangular field.
    measure.lidar : Scans with it.

    Examples
    --------
    >>> scanner = rw.measure.SpinningLidar(elevations=[-15, 0, 15], columns=360)
    >>> scanner.shape
    (3, 360)
    """

    elevations: ArrayLike
    columns: int = 1800
    start: float = 0.0
    stop: float = 360.0

    def __post_init__(self) -> None:
        """Check all, and keep the elevations as a tuple."""
        self._check()
        rows = frozen(real_array("elevations", self.elevations).astype(np.float64))
        if rows.ndim != 1 or not len(rows) or not (np.abs(rows) <= 90).all():
            raise ValueError("elevations must be one or more numbers between -90 and 90 degrees")
        object.__setattr__(self, "elevations", tuple(rows.tolist()))
        integer("columns", self.columns, 1)
        number("start", self.start)
        number("stop", self.stop)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of beams."""
        return np.size(self.elevations), self.columns

    def directions(self) -> Floats:
        """Return the unit direction of each beam's middle: (R, C, 3).

        Returns
        -------
        (R, C, 3) float64 array

        Examples
        --------
        >>> scanner = rw.measure.SpinningLidar(elevations=[0], columns=4)
        >>> scanner.directions().round(4).tolist()
        [[[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, -0.0], [-0.0, 0.0, 1.0]]]
        """
        ahead, left, above = axes(self.forward, self.up)
        high = np.radians(np.asarray(self.elevations, np.float64))[:, None, None]
        turn = self.start + (self.stop - self.start) * np.arange(self.columns) / self.columns
        around = np.radians(turn)[:, None]
        level = np.cos(around) * ahead + np.sin(around) * left
        ways: Floats = np.cos(high) * level + np.sin(high) * above
        return ways


@dataclass(frozen=True, kw_only=True)
class RasterLidar(_Scanner):
    """A scanner whose beam scans a rectangular field line by line, in even steps of both angles.

    Parameters
    ----------
    horizontal, vertical : float
        Width and height of the field, in degrees, up to 360 and 180; its outermost beams lie on its edge.
    columns, rows : int
        Beams of a line, from the left to the right, and lines, from above to below.
    position : 3 floats
        Position of the scanner.
    forward, up : 3 floats
        The middle of the field's horizon, and the vertical, y if not given; only the component of `forward`
        at right angles to `up` counts.
    min_range, max_range, divergence, rays, resolution
        As for `SpinningLidar`.

    Raises
    ------
    ValueError
        If a number is out of its range or not finite, or `forward` is along `up`.
    TypeError
        If an argument is not a number.

    See Also
    --------
    measure.SpinningLidar : A scanner that turns.
    measure.lidar : Scans with it.

    Examples
    --------
    >>> scanner = rw.measure.RasterLidar(horizontal=20, vertical=10, columns=3, rows=2)
    >>> scanner.shape
    (2, 3)
    """

    horizontal: float = 60.0
    vertical: float = 40.0
    columns: int = 600
    rows: int = 400

    def __post_init__(self) -> None:
        """Check all."""
        self._check()
        for name, most in (("horizontal", 360.0), ("vertical", 180.0)):
            if not 0 <= number(name, getattr(self, name)) <= most:
                raise ValueError(f"{name} must be between 0 and {most:g} degrees, got {getattr(self, name)}")
        integer("columns", self.columns, 1)
        integer("rows", self.rows, 1)

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns of beams."""
        return self.rows, self.columns

    def directions(self) -> Floats:
        """Return the unit direction of each beam's middle: (rows, columns, 3).

        Returns
        -------
        (rows, columns, 3) float64 array

        Examples
        --------
        >>> scanner = rw.measure.RasterLidar(horizontal=90, vertical=0, columns=3, rows=1)
        >>> scanner.directions().round(4).tolist()
        [[[0.7071, 0.0, -0.7071], [1.0, 0.0, 0.0], [0.7071, 0.0, 0.7071]]]
        """
        ahead, left, above = axes(self.forward, self.up)
        high = np.radians(_steps(self.vertical, self.rows))[:, None, None]
        around = np.radians(_steps(self.horizontal, self.columns))[:, None]
        level = np.cos(around) * ahead + np.sin(around) * left
        ways: Floats = np.cos(high) * level + np.sin(high) * above
        return ways


def _steps(width: float, count: int) -> Floats:
    """Return angles from half the width down to minus half of it; the middle alone if there is one."""
    return np.linspace(width / 2, -width / 2, count) if count > 1 else np.zeros(1)


def axes(forward: Triple, up: Triple) -> tuple[Floats, Floats, Floats]:
    """Return ahead, left and above as unit vectors.

    Raises
    ------
    ValueError
        If one has no length, or `forward` is along `up`.
    """
    ahead, above = unit("forward", forward), unit("up", up)
    level = ahead - above * (ahead @ above)
    if not np.linalg.norm(level) > 1e-12:
        raise ValueError(f"forward must not be parallel to up, got {forward} and {up}")
    level = level / np.linalg.norm(level)
    return level, np.cross(above, level), above
