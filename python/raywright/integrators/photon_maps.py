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

    Paths from the lights leave photons on matt surfaces, those whose scattering is wider than that of a
    roughness of 0.2. Paths of the camera go through mirrors, glass and gloss until they come to such a
    surface. There lights are sampled directly and a caustic map gives the light of mirrors and glass. Final
    gather rays find the surfaces beyond, where the same holds, with a global map for all other light. So
    light of a small lamp through glass is found that is seen through glass, which no path finds. Without matt
    surfaces, the picture is that of paths. Where a medium scatters the camera's path, photons scattered
    nearby give all of its light (Jensen and Christensen 1998).

    Density estimation blurs: the picture is biased, however many samples it has, and ``image.bias`` estimates
    the bias, with the error ``image.bias_error``; ``image.standard_error`` is the noise besides. Each batch
    of samples (``image.plan.sampler``) has maps of its own, so the error includes the noise of maps.

    Parameters
    ----------
    photons : int
        Paths from lights for each map, 1 to 2**31 - 1. Maps take about 100 bytes for each photon kept.
    k_nearest : int or None
        Number N of photons for a density: the farthest gives the radius, and N - 1 count (García et al.
        2012). With None, all within the radius.
    radius : float, optional
        Maximum distance of photons, at surfaces and in media. If not given, 8 times as far as N neighbours of
        a photon lie there, in half of all cases, or, with ``k_nearest=None``, as far as the 24th does.
    caustic : bool
        True if caustics have a map of their own, which is looked up where the camera's paths end. If not,
        rays have to find it, or with ``final_gather=0`` it is part of the global map.
    final_gather : int
        Rays from the first matt surface, 0 to 1024; with 0, the global map is looked up there at once.
    maps : int
        Maps that each batch of samples is spread over, where it has as many samples, 1 to 65536.
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
        If a number is out of its range, or `filter` none of the three. When rendering: with `adaptive=True`,
        or if no photon can start at a light of the scene (infinite emitters, emitters that move in instances,
        media that glow).
    TypeError
        If a number is none.

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
    """Progressive photon mapping (Hachisuka et al. 2008; Knaus and Zwicker 2011): blur that goes to zero.

    Like `PhotonMap`, with a map for each sample of all pixels and a shrinking radius: the squared radius, or
    in media the cubed radius, of map s + 1 is (s + alpha) / (s + 1) of that of map s. Both noise and bias
    vanish with more samples, so ``error=`` and ``seconds=`` may be as strict as needed. With ``alpha=2/3``
    the error falls as the cube root of the samples' number, relMSE as its 2/3rd power, which is optimal.
    ``image.error`` is the noise alone; ``image.bias`` is the remaining bias.

    Parameters
    ----------
    photons : int, optional
        Paths from lights for each map, 1 to 2**31 - 1. If not given, four for each pixel, from 20,000 to
        500,000: about as much work as the rest.
    radius : float, optional
        Maximum distance of photons in the first map, at surfaces and in media. If not given, the distance of
        a photon's 24th neighbor there in half of all cases, by the scene and the number of photons.
    alpha : float
        The share of new photons that is kept, above 0 and at most 1: with more, radii shrink more slowly,
        for less noise and more bias.
    final_gather : int
        Rays from the first matt surface, 0 to 1024; with 0, all is looked up there.
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
        If a number is out of its range, or `filter` none of the three. When rendering, as for `PhotonMap`.
    TypeError
        If a number is none.

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
