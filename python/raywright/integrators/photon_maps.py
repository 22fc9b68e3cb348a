"""Photon mapping."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from ..arrays import choice, integer, number, positive
from . import counts
from .base import CoreIntegrator

PhotonFilter: TypeAlias = Literal["box", "cone", "epanechnikov"]

_FILTERS = ("box", "cone", "epanechnikov")
_MOST_MAPS = 2**16


def _photons(count: int) -> int:
    """Return a number of paths from lights."""
    return integer("photons", count, 1, counts.MOST_PHOTONS)


def _settle(of: PhotonMap | ProgressivePhotonMap) -> None:
    """Check the common arguments, and settle their types."""
    settled = {
        "radius": None if of.radius is None else positive("radius", of.radius),
        "gather": integer("final_gather", of.final_gather, 0, counts.MOST_SAMPLES),
        "max_depth": None if of.max_depth is None else counts.depth("max_depth", of.max_depth),
        "roulette_depth": counts.depth("roulette_depth", of.roulette_depth),
    }
    choice("filter", of.filter, _FILTERS)
    for name, value in settled.items():
        object.__setattr__(of, name, value)


@dataclass(frozen=True)
class PhotonMap(CoreIntegrator):
    """Photon mapping (Jensen 1996, 2001): radiance from the density of photons.

    Light paths store photons on matt surfaces: those that scatter more widely than a roughness of 0.2. Camera
    paths continue through mirrors, glass and gloss up to such a surface. There, lights are sampled directly,
    and a caustic map adds light from mirrors and glass. Final gather rays do the same at the next matt
    surface, with a global map for all other light. So even caustics that are seen through glass are found,
    which no path finds. Without matt surfaces, the picture equals that of path tracing. Where a medium
    scatters the camera's path, the photons nearby in the medium give its light (Jensen and Christensen 1998).

    Density estimation blurs: the picture is biased, however many samples it has, and ``image.bias`` estimates
    the bias, with the error ``image.bias_error``; ``image.standard_error`` is the noise. Each batch of
    samples (``image.plan.sampler``) has its own maps, so the standard error includes the noise of maps.

    Parameters
    ----------
    photons : int
        Paths from lights for each map, 1 to 2**31 - 1. Maps take about 100 bytes for each photon kept.
    k_nearest : int or None
        Number N of photons in a density estimate: the farthest one sets the radius, and N - 1 count (García
        et al. 2012). With None, all photons within `radius` count.
    radius : float, optional
        Maximum distance of photons, at surfaces and in media. If not given, 8 times the median distance of a
        photon's N-th neighbor or, with ``k_nearest=None``, the median distance of its 24th neighbor.
    caustic : bool
        True for a separate caustic map, which is looked up at the first matt surface. If False, final gather
        rays have to find caustics or, with ``final_gather=0``, they are part of the global map.
    final_gather : int
        Rays from the first matt surface, 0 to 1024; with 0, the global map is looked up at that surface.
    maps : int
        Number of maps for each batch of samples, 1 to 65536, but at most one for each sample.
    filter : {"box", "cone", "epanechnikov"}
        Kernel of the density estimate: constant, or falling with the distance (Jensen's cone with k = 1;
        Epanechnikov 1969), which blurs less and is noisier.
    max_depth : int or None
        Maximum number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light
        (Mitsuba's max_depth minus 1). None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.

    Raises
    ------
    ValueError
        If a number is out of its range, or `filter` is not one of the three. When rendering: with
        `adaptive=True`, or if no photon can start at a light of the scene (infinite emitters, emitters that
        move in instances, media that glow).
    TypeError
        If an argument is not a number.

    See Also
    --------
    ProgressivePhotonMap : Its bias vanishes with more samples.
    Path : Without bias.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=4, height=4)
    >>> integrator = rw.PhotonMap(photons=1000, k_nearest=16, final_gather=0)
    >>> image = rw.render(scene, camera, integrator, samples=4, progress=False)
    >>> image.biased, image.bias.shape
    (True, (4, 4, 3))
    """

    photons: int = 100_000
    k_nearest: int | None = 64
    radius: float | None = None
    caustic: bool = True
    final_gather: int = 1
    maps: int = 8
    filter: PhotonFilter = "box"
    max_depth: int | None = None
    roulette_depth: int = 4

    def __post_init__(self) -> None:
        _settle(self)
        object.__setattr__(self, "photons", _photons(self.photons))
        if self.k_nearest is not None:
            # The estimate counts N - 1 photons: none of a single one.
            object.__setattr__(self, "nearest", integer("k_nearest", self.k_nearest, 2, counts.MOST_PHOTONS))
        object.__setattr__(self, "maps", integer("maps", self.maps, 1, _MOST_MAPS))
        if not isinstance(self.caustic, bool):
            raise TypeError(f"caustic must be True or False, got {self.caustic!r}")


@dataclass(frozen=True)
class ProgressivePhotonMap(CoreIntegrator):
    """Progressive photon mapping (Hachisuka et al. 2008; Knaus and Zwicker 2011): blur that vanishes.

    Like `PhotonMap`, with a map for each sample of all pixels and a shrinking radius: the squared radius (in
    media, the cubed radius) of map s + 1 is that of map s times (s + alpha) / (s + 1). Both noise and bias
    vanish with more samples, so ``error=`` and ``seconds=`` may be as strict as needed. With ``alpha=2/3``
    the error falls with the power -1/3 of the number of samples, and relMSE with the power -2/3, which is
    optimal. ``image.error`` is the noise alone; ``image.bias`` is the remaining bias.

    Parameters
    ----------
    photons : int, optional
        Paths from lights for each map, 1 to 2**31 - 1. If not given, four for each pixel, from 20,000 to
        500,000: about as much work as the rest.
    radius : float, optional
        Maximum distance of photons in the first map, at surfaces and in media. If not given, the median
        distance of a photon's 24th neighbor, estimated from the scene and the number of photons.
    alpha : float
        Share of new photons that is kept, above 0 and at most 1. A larger share shrinks the radius more
        slowly: less noise, more bias.
    final_gather : int
        Rays from the first matt surface, 0 to 1024; with 0, the map is looked up at that surface.
    filter : {"box", "cone", "epanechnikov"}
        Kernel of the density estimate.
    max_depth : int or None
        Maximum number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light
        (Mitsuba's max_depth minus 1). None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.

    Raises
    ------
    ValueError
        If a number is out of its range, or `filter` is not one of the three. When rendering, as for
        `PhotonMap`.
    TypeError
        If an argument is not a number.

    See Also
    --------
    PhotonMap : Faster, with a bias that stays.
    Bidirectional : Without bias, or with vertex merging.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=4, height=4)
    >>> integrator = rw.ProgressivePhotonMap(photons=1000)
    >>> image = rw.render(scene, camera, integrator, samples=4, progress=False)
    >>> image.biased, bool(image.rgb.mean() > 0)
    (True, True)
    """

    photons: int | None = None
    radius: float | None = None
    alpha: float = 2 / 3
    final_gather: int = 0
    filter: PhotonFilter = "box"
    max_depth: int | None = None
    roulette_depth: int = 4

    def __post_init__(self) -> None:
        _settle(self)
        if self.photons is not None:
            object.__setattr__(self, "photons", _photons(self.photons))
        alpha = number("alpha", self.alpha)
        if not 0 < alpha <= 1:
            raise ValueError(f"alpha must be above 0 and at most 1, got {alpha:g}")
        object.__setattr__(self, "alpha", alpha)
