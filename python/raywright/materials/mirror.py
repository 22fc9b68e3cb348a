"""Perfect mirrors."""

from __future__ import annotations

from dataclasses import dataclass

from numpy.typing import ArrayLike

from ..textures.texture import Texture, Value, value
from .material import Material


@dataclass(frozen=True, init=False)
class Mirror(Material):
    """A mirror that reflects the same share at every angle, on both sides.

    Parameters
    ----------
    reflectance : float, 3 floats or Texture
        Reflectance, in [0, 1].

    Raises
    ------
    ValueError
        If a reflectance is outside [0, 1] or not finite.
    TypeError
        If an argument has another type.

    See Also
    --------
    Conductor : A metal, by Fresnel's law.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(material=rw.Mirror(0.9)), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=10, width=2, height=2)
    >>> print(rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].round(4))
    [0.9 0.9 0.9]
    """

    reflectance: Value

    def __init__(
        self,
        reflectance: ArrayLike | Texture = 1.0,
    ) -> None:
        self._set(
            reflectance=value("reflectance", reflectance, most=1.0),
        )
