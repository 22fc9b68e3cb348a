"""Path tracing."""

from dataclasses import dataclass

from ..arrays import integer

# Larger patches ask for more rays than they are worth.
_SIDES = (1, 2, 4, 8)


@dataclass(frozen=True)
class Path:
    """Path tracing with next-event estimation, multiple importance sampling and Russian roulette.

    The estimator is Kajiya's (1986); emitters are sampled at every bounce and combined with the path's own
    hits by the power heuristic (Veach 1997).

    Parameters
    ----------
    max_depth : int or None
        Greatest number of surface bounces: 0 shows emitters only, 1 adds direct light. None ends paths by
        Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.
    reuse : int
        Side of the square patches of pixels whose paths are shared, 1, 2, 4 or 8: what a path finds from its
        second surface on counts, in its place, for each pixel of the patch whose first surface sees that
        (Bekaert, Sbert and Halton 2002). The mean stays what it is. What is left of the noise by a patch of
        4 is some tenth of it where most light is indirect, at twice the time. 1 shares nothing.

        Shared is what goes from a `Diffuse` surface to another; the rest of a picture stays as it is. Nothing
        is shared in a scene where something moves, with masks, with media within one another, or with images
        that are filtered by width. Pixels of a patch err together, which looks like spots of its size: the
        error estimate knows it.

    Raises
    ------
    ValueError
        If a number is negative, or `reuse` none of the four.
    TypeError
        If it is not an integer.
    """

    max_depth: int | None = None
    roulette_depth: int = 4
    reuse: int = 1

    def __post_init__(self) -> None:
        most = 2**32 - 1
        if self.max_depth is not None:
            object.__setattr__(self, "max_depth", integer("max_depth", self.max_depth, 0, most))
        object.__setattr__(self, "roulette_depth", integer("roulette_depth", self.roulette_depth, 0, most))
        reuse = integer("reuse", self.reuse, 1)
        if reuse not in _SIDES:
            raise ValueError(f"reuse must be 1, 2, 4 or 8, got {reuse}")
        object.__setattr__(self, "reuse", reuse)
