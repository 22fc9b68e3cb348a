"""Light tracing."""

from __future__ import annotations

from dataclasses import dataclass

from . import counts
from .base import CoreIntegrator


@dataclass(frozen=True, init=False)
class LightTraced(CoreIntegrator):
    """Light tracing (Arvo 1986; Dutré, Lafortune and Willems 1993): paths that start at lights.

    Each sample of each pixel traces a path from a light, chosen by its power; each of its surfaces is
    connected to the camera, at any pixel of the film. Camera rays add emitters that are directly visible. So
    it finds caustics, which path tracing hardly finds. It never finds light that the camera sees in a mirror
    or through glass; only emitters are visible there. Scattering events in media count as surfaces.

    Error estimates hold as usual, since contributions of different samples are independent.

    Parameters
    ----------
    max_depth : int or None
        Maximum number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light
        (Mitsuba's max_depth minus 1). None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.

    Raises
    ------
    ValueError
        If a number is negative. When rendering: with `adaptive=True`, or if no path can start at a light of
        the scene (infinite emitters, emitters that move in instances, media that glow).
    TypeError
        If an argument is not an integer.

    See Also
    --------
    Path : Paths from the camera.
    Bidirectional : Paths from both ends.

    Examples
    --------
    >>> scene, camera = rw.scenes.cornell_box(width=4, height=4)
    >>> image = rw.render(scene, camera, rw.LightTraced(), samples=4, progress=False)
    >>> image.biased, bool(image.rgb.mean() > 0)
    (False, True)
    """

    max_depth: int | None
    roulette_depth: int

    def __init__(self, max_depth: int | None = None, roulette_depth: int = 4) -> None:
        depth = None if max_depth is None else counts.depth("max_depth", max_depth)
        object.__setattr__(self, "max_depth", depth)
        object.__setattr__(self, "roulette_depth", counts.depth("roulette_depth", roulette_depth))
