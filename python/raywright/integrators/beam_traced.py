"""Beam tracing."""

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..arrays import Triple, colour
from . import counts


@dataclass(frozen=True, init=False)
class BeamTraced:
    """Beam tracing (Heckbert and Hanrahan 1984): polygonal beams in place of rays, and edges that are exact.

    All that the camera sees is one beam. Faces part it into polygons, flat mirrors throw these back, panes
    let them through, and beams from lights part them into lit and shadowed. A pixel is the sum over the
    polygons in its square of their areas there, each times its radiance at the middle of that; so the picture
    has no noise, and one sample is as good as many (with two, the error is 0 where with one it is not known).
    It is `Whitted`'s picture: what is scattered otherwise than as by a mirror is left to `ambient`.

    Beams meet meshes alone, of any opaque material or `ThinDielectric`, in the light of lights without extent
    (`PointLight`, `SpotLight`, `Projector`, `DirectionalLight`; 64 at most), seen through a pinhole and a
    `BoxFilter`. The time grows with the square of the number of faces in view.

    Parameters
    ----------
    max_depth : int
        Greatest number of surfaces that light comes by.
    ambient : float or 3 floats
        Radiance that arrives from everywhere in place of what is not followed; of which surfaces reflect
        their ambient share, as in `RayCast`.

    Raises
    ------
    ValueError
        If a number is out of its range. When rendering, of what beams cannot do: shapes that are no meshes,
        shine, have masks, are of glass, or mirror with bent normals; environments; other cameras and filters.
    TypeError
        If an argument is of the wrong kind.
    """

    max_depth: int
    ambient: Triple

    def __init__(self, max_depth: int = 8, ambient: ArrayLike = 0.0) -> None:
        object.__setattr__(self, "max_depth", counts.depth("max_depth", max_depth))
        object.__setattr__(self, "ambient", colour("ambient", ambient))
