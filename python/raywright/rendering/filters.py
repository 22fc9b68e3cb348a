"""Reconstruction filters. Lengths are in pixels.

Samples are drawn by the size of the filter around their own pixel (Ernst, Stamminger and Greiner, "Filter
Importance Sampling", 2006), so that the errors of pixels stay independent.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import integer, number

_LEAST, _MOST = 1e-6, 64.0
_MOST_LOBES = 16


@dataclass(frozen=True)
class BoxFilter:
    """The mean over a square.

    Parameters
    ----------
    radius : float
        Half its side, 1e-6 to 64; 0.5 is the pixel's own square.

    Raises
    ------
    ValueError
        If `radius` is out of range.
    TypeError
        If it is not a number.

    See Also
    --------
    TriangleFilter, GaussianFilter, MitchellFilter, BlackmanHarrisFilter, LanczosFilter

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(emission=2.0))
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, samples=4, filter=rw.rendering.BoxFilter(), progress=False)
    >>> image.rgb[1, 1].tolist()
    [2.0, 2.0, 2.0]
    """

    radius: float = 0.5

    def __post_init__(self) -> None:
        _lengths(self, "radius")


@dataclass(frozen=True)
class TriangleFilter:
    """A tent: linear from the pixel's center to 0 at `radius`, along each axis.

    Parameters
    ----------
    radius : float
        Radius, 1e-6 to 64; 1 interpolates between pixels.

    Raises
    ------
    ValueError
        If `radius` is out of range.
    TypeError
        If it is not a number.

    See Also
    --------
    BoxFilter : The default.

    Examples
    --------
    >>> rw.rendering.TriangleFilter(radius=1.5)
    TriangleFilter(radius=1.5)
    """

    radius: float = 1.0

    def __post_init__(self) -> None:
        _lengths(self, "radius")


@dataclass(frozen=True)
class GaussianFilter:
    """A Gaussian minus its value at `radius`, so it ends without a step (Pharr, Jakob and Humphreys 2023).

    Parameters
    ----------
    radius : float
        Radius, 1e-6 to 64.
    sigma : float
        Its standard deviation, 1e-6 to 64.

    Raises
    ------
    ValueError
        If a number is out of range.
    TypeError
        If it is not a number.

    See Also
    --------
    BoxFilter : The default.
    MitchellFilter : A sharper one.

    Examples
    --------
    >>> rw.rendering.GaussianFilter(sigma=0.6)
    GaussianFilter(radius=1.5, sigma=0.6)
    >>> rw.rendering.GaussianFilter(sigma=-1.0)
    Traceback (most recent call last):
        ...
    ValueError: sigma must be between 1e-06 and 64, got -1
    """

    radius: float = 1.5
    sigma: float = 0.5

    def __post_init__(self) -> None:
        _lengths(self, "radius", "sigma")


@dataclass(frozen=True)
class MitchellFilter:
    """A cubic spline with negative lobes, which sharpens edges (Mitchell and Netravali 1988).

    Parameters
    ----------
    radius : float
        Radius, 1e-6 to 64.
    b, c : float
        Blur and ringing, 0 to 1; the authors advise ``b + 2 * c == 1``.

    Raises
    ------
    ValueError
        If a number is out of range.
    TypeError
        If it is not a number.

    See Also
    --------
    GaussianFilter : A filter without negative lobes.

    Examples
    --------
    >>> rw.rendering.MitchellFilter(b=0, c=0.5)
    MitchellFilter(radius=2.0, b=0.0, c=0.5)
    """

    radius: float = 2.0
    b: float = 1 / 3
    c: float = 1 / 3

    def __post_init__(self) -> None:
        _lengths(self, "radius")
        _within(self, 0.0, 1.0, "b", "c")


@dataclass(frozen=True)
class BlackmanHarrisFilter:
    """A smooth window of four cosines, nowhere negative (Harris 1978).

    Parameters
    ----------
    radius : float
        Radius, 1e-6 to 64.

    Raises
    ------
    ValueError
        If `radius` is out of range.
    TypeError
        If it is not a number.

    See Also
    --------
    GaussianFilter : A bell with a width of its own.

    Examples
    --------
    >>> rw.rendering.BlackmanHarrisFilter(radius=2)
    BlackmanHarrisFilter(radius=2.0)
    """

    radius: float = 1.5

    def __post_init__(self) -> None:
        _lengths(self, "radius")


@dataclass(frozen=True)
class LanczosFilter:
    """A sinc in the window of a wider one (Duchon 1979): the sharpest filter, with lobes that ring.

    Parameters
    ----------
    lobes : int
        Radius in pixels, 1 to 16.

    Raises
    ------
    ValueError
        If `lobes` is out of range.
    TypeError
        If it is not an integer.

    See Also
    --------
    MitchellFilter : It rings less.

    Examples
    --------
    >>> rw.rendering.LanczosFilter(lobes=2)
    LanczosFilter(lobes=2)
    """

    lobes: int = 3

    def __post_init__(self) -> None:
        object.__setattr__(self, "lobes", integer("lobes", self.lobes, 1, _MOST_LOBES))


WholeFilter = (
    BoxFilter | TriangleFilter | GaussianFilter | MitchellFilter | BlackmanHarrisFilter | LanczosFilter
)


@dataclass(frozen=True)
class CroppedFilter:
    """Another filter, cropped at the border of the film.

    Pixels nearer to the film's edge than the radius use the part of the filter on the film, normalized; other
    pixels are unaffected. Mitsuba's films do so, unless they have a ``sample_border``.

    Parameters
    ----------
    filter : BoxFilter, TriangleFilter, GaussianFilter, MitchellFilter, BlackmanHarrisFilter or LanczosFilter
        The filter.

    Raises
    ------
    TypeError
        If `filter` is none of these.

    See Also
    --------
    GaussianFilter : One of the filters that it takes.

    Examples
    --------
    >>> rw.rendering.CroppedFilter(rw.rendering.GaussianFilter()).filter
    GaussianFilter(radius=1.5, sigma=0.5)
    """

    filter: WholeFilter

    def __post_init__(self) -> None:
        if not isinstance(self.filter, WholeFilter):
            raise TypeError(f"filter must be one that is not cropped, got {type(self.filter).__name__}")


Filter = WholeFilter | CroppedFilter


def _lengths(values: object, *names: str) -> None:
    _within(values, _LEAST, _MOST, *names)


def _within(values: object, least: float, most: float, *names: str) -> None:
    for name in names:
        value = number(name, getattr(values, name))
        if not least <= value <= most:
            raise ValueError(f"{name} must be between {least:g} and {most:g}, got {value:g}")
        object.__setattr__(values, name, value)
