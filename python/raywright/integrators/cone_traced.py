"""Cone tracing."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, colour, number
from . import counts


@dataclass(frozen=True, init=False)
class ConeTraced:
    """Cone tracing (Amanatides 1984): one cone a pixel in place of samples.

    A cone has the solid angle of its pixel. What it meets counts by the share that it covers of it, the
    nearest first. A lamp throws a soft shadow by the share that is free of the cone to it: exact for the
    sphere that one sphere hides; a face is taken for a cone of its solid angle. Mirrors throw cones back,
    wider where they bulge, and a rough `Conductor` (of GGX facets) throws them back as wide as half of its
    light is spread. So a picture has no noise, and one sample is as good as many (with two, the error is 0
    where with one it is not known). It is biased by design, as `Whitted` is, and where what a cone meets
    differs much within it: surfaces are shaded at one point of each face, spheres dim what is behind them
    evenly, and rough metal seen at a grazing angle is too dark, by what of its cone is below the surface.

    Cones meet meshes and spheres, of any opaque material or `ThinDielectric`, in the light of surfaces that
    shine and of lights without extent, seen through a pinhole and a `BoxFilter`.

    Parameters
    ----------
    max_depth : int
        Greatest number of surfaces that light comes by.
    contribution : float
        Cones that contribute less than this share to their pixel are not followed: 0 (all are) to below 1.
    ambient : float or 3 floats
        Radiance that arrives from everywhere in place of what is not followed; of which surfaces reflect
        their ambient share, as in `RayCast`.

    Raises
    ------
    ValueError
        If a number is out of its range. When rendering, of what cones cannot do: shapes that are neither
        meshes nor spheres, have masks, or are of glass; environments; other cameras and filters.
    TypeError
        If an argument is of the wrong kind.
    """

    max_depth: int
    contribution: float
    ambient: Triple

    def __init__(self, max_depth: int = 8, contribution: float = 1 / 512, ambient: ArrayLike = 0.0) -> None:
        share = number("contribution", contribution)
        if not 0 <= share < 1:
            raise ValueError(f"contribution must be at least 0 and below 1, got {contribution!r}")
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "contribution", share)
        object.__setattr__(self, "ambient", colour("ambient", ambient))
