"""Path tracing."""

from dataclasses import dataclass

from ..arrays import integer


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

    Raises
    ------
    ValueError
        If a number is negative.
    TypeError
        If it is not an integer.
    """

    max_depth: int | None = None
    roulette_depth: int = 4

    def __post_init__(self) -> None:
        most = 2**32 - 1
        if self.max_depth is not None:
            object.__setattr__(self, "max_depth", integer("max_depth", self.max_depth, 0, most))
        object.__setattr__(self, "roulette_depth", integer("roulette_depth", self.roulette_depth, 0, most))
