"""Bidirectional path tracing."""

from dataclasses import dataclass

from . import counts


@dataclass(frozen=True, init=False)
class Bidirectional:
    """Bidirectional path tracing (Lafortune and Willems 1993; Veach and Guibas 1994): paths from both ends.

    For each sample of each pixel a path is walked from the camera and another from a light, chosen by its
    power, and every surface of the one is connected to every surface of the other, to a light and to the
    camera. Light that can be found in several of these ways counts in each by the balance heuristic, whose
    weights are gathered along the walks (Georgiev 2012). So it finds what `Path` finds and what `LightTraced`
    does, and by connections also what is hard to reach from either end, such as a room lit by way of a door
    ajar. A sample takes several times as long as one of `Path`, which is better in a scene that has nothing
    hard in it.

    Without bias, and with an error that is told as ever. No connection reaches what the camera sees by way of
    a mirror or glass if it is lit by way of another from a small light: that is found only where a path comes
    upon the light.

    Parameters
    ----------
    max_depth : int or None
        Greatest number of surface bounces: 0 shows emitters only, 1 adds direct light. None ends paths by
        Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, from either end, at least 0.

    Raises
    ------
    ValueError
        If a number is negative. When rendering, with `adaptive=True`, and of a scene where a light is that no
        path can start at: one that has no end, or that moves in instances.
    TypeError
        If it is not an integer.
    """

    max_depth: int | None
    roulette_depth: int

    def __init__(self, max_depth: int | None = None, roulette_depth: int = 4) -> None:
        depth = None if max_depth is None else counts.depth("max_depth", max_depth)
        object.__setattr__(self, "max_depth", depth)
        object.__setattr__(self, "roulette_depth", counts.depth("roulette_depth", roulette_depth))
