"""Bidirectional path tracing."""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass

from ..arrays import integer, positive
from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True)
class Bidirectional(CoreIntegrator):
    """Bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994): paths from both ends.

    Each sample of each pixel traces a path from the camera and another from a light, chosen by its power.
    Every surface of the one is connected to every surface of the other, to a light and to the camera. Light
    that can be found in several of these ways counts in each by the balance heuristic, whose weights are
    gathered along the walks (Georgiev 2012). It finds the light that `Path` and `LightTraced` find, and by
    connections also light that is hard to reach from either end, such as in a room lit by way of a door ajar.
    A sample takes several times as long as one of `Path`, which is better in simple scenes.

    It has no bias, and error estimates hold as usual. One kind of path has no connections: from the camera by
    a mirror or glass to a surface lit by another one from a small light. It is found only if a path hits the
    light, or with ``vertex_merging=True``.

    Merged (vertex connection and merging: Georgiev et al. 2012; Hachisuka et al. 2012), each sample of all
    pixels has photons of its own besides, and every path of the camera gathers those that lie about it on
    matt surfaces, as `ProgressivePhotonMap` does, from ever less far away. Merging is one more strategy,
    weighed with all others: most of a picture is as sharp as without it, and light that no other strategy
    finds is found. Gathered light is blurred while radii are long: ``image.bias`` estimates the blur. With
    more samples both noise and blur vanish.

    Scattering events in media count as surfaces, and are connected as such. There nothing can be merged yet.

    Parameters
    ----------
    max_depth : int or None
        Maximum number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light
        (Mitsuba's max_depth minus 1). None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, from either end, at least 0.
    vertex_merging : bool
        True if paths are merged too (vertex merging).
    radius : float, optional
        Merged, how far photons may lie in the first sample; of the squared radii, that of sample s + 1 is (s
        + 2/3) / (s + 1) of that of s. If not given, the distance of a photon's 24th neighbor in half of all
        cases, by the scene and the number of photons.
    photons : int, optional
        Merged, paths from lights for each sample, 1 to 2**31 - 1. If not given, as many as there are pixels,
        but at least 1,024 and at most about a million. They take some 100 bytes for each surface come to.

    Raises
    ------
    ValueError
        If a number is out of its range, or `radius` or `photons` are given and nothing is merged. When
        rendering: with `adaptive=True`; if no path can start at a light of the scene (infinite emitters,
        emitters that move in instances); and merged, if the scene has media.
    TypeError
        If a number is none, or `vertex_merging` is neither True nor False.

    See Also
    --------
    Path : Faster if light is easy to find.
    LightTraced : Paths from lights alone.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=4, height=4)
    >>> image = rw.render(scene, camera, rw.Bidirectional(), samples=4, progress=False)
    >>> image.biased, bool(image.rgb.mean() > 0)
    (False, True)
    """

    max_depth: int | None = None
    roulette_depth: int = 4
    _: KW_ONLY
    vertex_merging: bool = False
    radius: float | None = None
    photons: int | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.vertex_merging, bool):
            raise TypeError(f"vertex_merging must be True or False, got {self.vertex_merging!r}")
        for name in ("radius", "photons"):
            if getattr(self, name) is not None and not self.vertex_merging:
                raise ValueError(f"{name} requires vertex_merging=True")
        photons = None if self.photons is None else integer("photons", self.photons, 1, counts.MOST_PHOTONS)
        settled = {
            "max_depth": None if self.max_depth is None else counts.depth("max_depth", self.max_depth),
            "roulette_depth": counts.depth("roulette_depth", self.roulette_depth),
            "radius": None if self.radius is None else positive("radius", self.radius),
            "photons": photons,
        }
        for name, value in settled.items():
            object.__setattr__(self, name, value)
