"""Path tracing."""

from dataclasses import dataclass

from ..arrays import integer

# Larger patches need more rays than they save.
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
    reuse : int, optional
        Side of the square patches of pixels that share paths: 1, 2, 4 or 8, where 1 shares nothing. If not
        given, `render` chooses 1, 4 or 8 by what a pilot finds, and 1 for small pictures of few samples. What
        a path finds from its second surface on counts for every pixel of the patch whose own first surface
        sees that second one (Bekaert, Sbert and Halton 2002), in proportion to how likely each was to come
        there, which leaves no bias. It pays where surfaces are matt and most light is indirect, as in a room:
        rays between all these points cost time, and direct light gains nothing.

        What goes from one `Diffuse` surface to another is shared; all else is as without. Nothing is shared
        where something moves, and in scenes with masks, with media in one another or with textures that are
        filtered by width. In scenes with `Homogeneous` media it is what goes from where such a medium
        scatters a path first to where the same medium does next, or to a `Diffuse` surface in it or beyond
        its end, and nothing else; light of points is left out there, and so are wavelengths. It pays where
        most light is scattered often, and pixels are small beside the way between. Patches are cut
        elsewhere for each sample, so pixels err together with those around them, and noise is as coarse as a
        patch. The error estimate knows it: its interval is wider than without, most so in small pictures.
    caustics : bool, optional
        Whether matt surfaces look for light where it comes to them by way of mirrors and glass; if not given,
        `render` chooses by what a pilot finds, and False for small pictures of few samples. Photons are sent
        from the lights before the first render of a scene, and paths draw some of their directions from where
        those came from (Jensen 1995), the others as ever, weighed by the density of both, which leaves no
        bias. It pays where small lamps shine through glass or into mirrors: what would be fireflies is found
        by most paths. Elsewhere it takes samples from other light, and time, and it has no effect where
        nothing is sharp. With `reuse`, first surfaces do not aim where paths are shared.

    Raises
    ------
    ValueError
        If a number is negative, or `reuse` none of the four.
    TypeError
        If it is not an integer, or `caustics` is not True, False or None.
    """

    max_depth: int | None = None
    roulette_depth: int = 4
    reuse: int | None = None
    caustics: bool | None = None

    def __post_init__(self) -> None:
        most = 2**32 - 1
        if self.max_depth is not None:
            object.__setattr__(self, "max_depth", integer("max_depth", self.max_depth, 0, most))
        object.__setattr__(self, "roulette_depth", integer("roulette_depth", self.roulette_depth, 0, most))
        if self.reuse is not None:
            reuse = integer("reuse", self.reuse, 1, _SIDES[-1])
            if reuse not in _SIDES:
                raise ValueError(f"reuse must be 1, 2, 4 or 8, got {reuse}")
            object.__setattr__(self, "reuse", reuse)
        if not isinstance(self.caustics, bool | None):
            raise TypeError(f"caustics must be True, False or None, got {self.caustics!r}")
