"""Path tracing."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import choice, integer
from .base import CoreIntegrator

# Larger patches need more rays than they save.
_SIDES = (1, 2, 4, 8)
GUIDING = ("none", "photons", "learned")


@dataclass(frozen=True)
class Path(CoreIntegrator):
    """Path tracing with next-event estimation, multiple importance sampling and Russian roulette.

    The estimator is Kajiya's (1986). Emitters are sampled at every bounce, and the power heuristic combines
    these samples with emitters that the path hits (Veach 1997).

    Parameters
    ----------
    max_depth : int or None
        Maximum number of surface bounces: 0 shows emitters only, 1 adds direct light. (Mitsuba's max_depth
        minus 1.) None ends paths by Russian roulette alone, which leaves no bias.
    roulette_depth : int
        Bounces before Russian roulette begins, at least 0.
    reuse : int, optional
        Side of the square patches of pixels that share paths: 1, 2, 4 or 8, where 1 shares nothing. If not
        given, `render` chooses 1, 4 or 8 by a pilot, and 1 for small pictures of few samples. The radiance
        that a path finds from its second surface on also counts for all pixels of the patch whose first
        surface sees that second surface (Bekaert, Sbert and Halton 2002). It is weighted by the sampling
        density of each pixel, so there is no bias. Sharing pays where surfaces are matt and most light is
        indirect, as in a room: the rays between these points cost time, and direct light gains nothing.

        Only light from one `Diffuse` surface to another is shared; other paths are unaffected. Nothing is
        shared in scenes with motion, masks, nested media or filtered textures. With `Homogeneous` media,
        light is shared from the first scattering of a path in a medium to the next one in the same medium, or
        to a `Diffuse` surface in it or beyond its end, unless there are point lights. It pays where most
        light is scattered often, and the mean free path is large compared to a pixel. The grid of patches is
        shifted for each sample. Errors of neighboring pixels are correlated, and noise is as coarse as a
        patch; by wavelength, all pixels have the same color noise. The error estimate accounts for this: its
        interval is wider, most of all in small pictures.
    guiding : str, optional
        How matt surfaces guide paths: "none", "photons" or "learned". If not given, `render` chooses by a
        pilot, and "none" for small pictures of few samples. Guided paths sample some of their directions
        towards the origins of known light, and the others as usual; both are weighted by the combined
        density, so there is no bias.

        "photons" traces photons from the lights through mirrors and glass before the first render of a scene
        (Jensen 1995). It pays where small lamps shine through glass or into mirrors, because it removes most
        fireflies; without mirrors and smooth glass it has no effect.

        "learned" traces paths from the camera before the first render of a view, guided by photons if there
        are any, and learns where indirect light comes from (Müller, Gross and Novák 2017). It pays where
        light comes through small openings, such as a keyhole. Elsewhere both cost time. In media, paths are
        guided at surfaces alone.

    Raises
    ------
    ValueError
        If a number is negative, `reuse` is not one of the four, or `guiding` not one of the three.
    TypeError
        If a number is not an integer.

    See Also
    --------
    Direct : One bounce alone.
    Bidirectional : Paths from both ends.
    PhotonMap : For caustics seen through glass.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(material=rw.Mirror(0.5)), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, rw.Path(max_depth=4), samples=4, progress=False)
    >>> image.rgb[1, 1].tolist(), image.rgb[0, 0].tolist()
    ([0.5, 0.5, 0.5], [1.0, 1.0, 1.0])
    """

    max_depth: int | None = None
    roulette_depth: int = 4
    reuse: int | None = None
    guiding: str | None = None

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
        if self.guiding is not None:
            choice("guiding", self.guiding, GUIDING)
