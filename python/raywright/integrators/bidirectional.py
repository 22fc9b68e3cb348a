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
    Every vertex of the one is connected to every vertex of the other, to a light and to the camera. The
    balance heuristic weights these techniques; its weights are accumulated along the paths (Georgiev 2012).
    It finds the light that `Path` and `LightTraced` find, and by connections also light that is hard to reach
    from either end, such as through a door ajar. A sample takes several times as long as one of `Path`, which
    is better in simple scenes.

    It has no bias, and error estimates hold as usual. One kind of path cannot be connected: a caustic of a
    small light, seen in a mirror or through glass. It is found only if a path hits the light, or with
    ``vertex_merging=True``.

    With vertex merging (vertex connection and merging: Georgiev et al. 2012; Hachisuka et al. 2012), each
    sample number also has its own photons, and camera paths gather the photons around their vertices on matt
    surfaces, in a shrinking radius, as `ProgressivePhotonMap` does. Merging is one more technique among the
    weighted ones: most of a picture is as sharp as without it, and it finds light that no other technique
    finds. Gathered light is blurred while the radius is large; ``image.bias`` estimates the blur. With more
    samples both noise and blur vanish.

    Scattering events in media count as surfaces and are connected, but not merged.

    Parameters
    ----------
    max_depth : int or None
        Maximum number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light
        (Mitsuba's max_depth minus 1). None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, from either end, at least 0.
    vertex_merging : bool
        True to add vertex merging.
    radius : float, optional
        Gathering radius of the first sample, with vertex merging. The squared radius of sample s + 1 is that
        of sample s times (s + 2/3) / (s + 1). If not given, the median distance of a photon's 24th neighbor,
        estimated from the scene and the number of photons.
    photons : int, optional
        Light paths of each sample, with vertex merging: 1 to 2**31 - 1. If not given, the number of pixels,
        but at least 1,024 and at most about a million. Each photon takes some 100 bytes.

    Raises
    ------
    ValueError
        If a number is out of its range, or `radius` or `photons` is given without `vertex_merging`. When
        rendering: with `adaptive=True`; or if no path can start at a light of the scene (infinite emitters,
        emitters that move in instances).
    TypeError
        If an argument is not a number, or `vertex_merging` is neither True nor False.

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
