"""Light tracing."""

from dataclasses import dataclass

from . import counts


@dataclass(frozen=True, init=False)
class LightTraced:
    """Light tracing (Arvo 1986; Dutré, Lafortune and Willems 1993): paths that start at lights.

    For each sample of each pixel a path starts at a light, chosen by its power, and is scattered from surface
    to surface; at each of them it is connected to the camera, wherever on the film that is seen. Emitters are
    seen by the camera's own rays. So it finds caustics, light that mirrors and glass throw on matt surfaces,
    which path tracing hardly finds. It never finds light that the camera sees in a mirror or through glass:
    only emitters are seen there. Where media scatter light on its way counts as a surface.

    Error estimates hold as usual, since contributions of different samples are independent.

    Parameters
    ----------
    max_depth : int or None
        Greatest number of bounces, off surfaces or in media: 0 shows emitters only, 1 adds direct light. None
        ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.

    Raises
    ------
    ValueError
        If a number is negative. When rendering, with `adaptive=True`, and of a scene where a light is that no
        path can start at: one that has no end, or that moves in instances, or a medium that glows.
    TypeError
        If it is not an integer.

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
