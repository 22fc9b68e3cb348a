"""Pictures of a ray and a shadow ray per pixel."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from .. import _core
from ..arrays import color, number, thread_limit, triple
from ..cameras import AnyCamera
from ..lights import DirectionalLight, PointLight
from .compilable import Compilable
from .rays import written_to

_HEADLIGHT = "headlight"
_TYPES = (np.dtype(np.uint8), np.dtype(np.float32))


class Previews(Compilable):
    """Pictures that a compiled scene draws at once; the first one compiles it."""

    def preview(
        self,
        camera: AnyCamera,
        light: str | ArrayLike | DirectionalLight | PointLight = _HEADLIGHT,
        out: NDArray[Any] | None = None,
        *,
        dtype: DTypeLike | None = None,
        ambient: float = 0.0,
        background: ArrayLike = 0.0,
        threads: int | None = None,
    ) -> NDArray[Any]:
        """Draw the scene by one ray and one shadow ray per pixel: a picture for frames in real time.

        A pixel is the albedo of the surface seen at its center times the cosine between the geometric normal,
        on the side that is seen, and the light (Lambert 1760), 0 in shadow. The core completes each tile of
        pixels before the next, so a frame takes no more memory than its array.

        Parameters
        ----------
        camera : Camera or another kind
            Camera of any kind; a `ThinLens` is taken as a pinhole, and a moving camera as its shutter opens.
        light : "headlight", 3 floats, DirectionalLight or PointLight
            The only light; those of the scene are ignored. "headlight" is at the camera and casts no visible
            shadows; 3 floats are the direction towards a sun, of any length but 0; of a light object, only
            direction or position count.
        out : (height, width, 3) array of uint8 or float32, optional
            Array that the picture is written to, C-contiguous; it is returned.
        dtype : uint8 or float32, optional
            Type of a new array, uint8 if not given. uint8 is sRGB, for display; float32 is linear.
        ambient : float
            The share of the light, from 0 to 1, that reaches every point: the picture is
            ``albedo * (ambient + (1 - ambient) * cosine)``.
        background : float or 3 floats
            Linear color of pixels that show nothing, at least 0.
        threads : int, optional
            Number of threads; all cores if not given. The picture does not depend on it.

        Returns
        -------
        (height, width, 3) uint8 or float32
            The picture, row 0 on top.

        Raises
        ------
        ValueError
            If `out` has another shape, is read-only or not C-contiguous, `dtype` contradicts it, the sun's
            direction has no length, or a number is out of its range or not finite.
        TypeError
            If `camera` is not a camera, `light` is not a light, or the dtype is neither uint8 nor float32.
        KeyboardInterrupt
            When Ctrl-C is pressed; `out` then holds part of the picture.

        Notes
        -----
        Hits are those of ``intersect(*camera.rays())``, and shadow rays start where ``hits.spawn_rays`` has
        them: what is lit is decided as exactly as by `occluded`. The albedo is `Interactions.albedo` of what
        is surrounded by nothing; shapes that give off light are white. Masks and media do not count.

        Examples
        --------
        >>> import raywright as rw
        >>> scene = rw.Scene([rw.Sphere((0, 0, 0), 1), rw.Sphere((0, 1.4, 0), 0.2)])
        >>> camera = rw.Camera((0, 1, 4), (0, 0, 0), fov=40, width=64, height=48)
        >>> frame = scene.preview(camera, light=(1, 2, 1))
        >>> frame.shape, frame.dtype
        ((48, 64, 3), dtype('uint8'))
        >>> again = scene.preview(camera, light=(1, 2, 1), out=frame)
        >>> again is frame
        True
        """
        if not isinstance(camera, AnyCamera):
            raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
        place, is_place = _place(light)
        share = number("ambient", ambient)
        if not 0 <= share <= 1:
            raise ValueError(f"ambient must be between 0 and 1, got {ambient}")
        behind = color("background", background)
        limit = thread_limit(threads)
        shape = (camera.height, camera.width, 3)
        kind = None if dtype is None else _type("dtype", dtype)
        if out is None:
            out = np.empty(shape, kind or np.uint8)
        else:
            written_to("out", out, shape, _TYPES)
            if kind not in (None, out.dtype):
                raise ValueError(f"dtype must be that of out, {out.dtype}, got {kind}")
        core = self._core or self._compiled()
        _core.preview(core, camera, place, is_place, share, behind, out, limit)
        return out


def _place(light: Any) -> tuple[tuple[float, float, float] | None, bool]:
    """Return the direction towards a light, or its position; None for one at the eye."""
    if isinstance(light, str):
        if light != _HEADLIGHT:
            raise ValueError(f"light must be {_HEADLIGHT!r} or the direction towards the sun, got {light!r}")
        return None, False
    if isinstance(light, PointLight):
        return light.position, True
    if isinstance(light, DirectionalLight):
        x, y, z = light.direction
        return (-x, -y, -z), False
    if light is None or isinstance(light, bool | dict | set):
        told = f"{_HEADLIGHT!r}, 3 floats, a DirectionalLight or a PointLight"
        raise TypeError(f"light must be {told}, got {type(light).__name__}")
    sun = triple("light", light)
    if sun == (0, 0, 0):
        raise ValueError(f"light must be a direction with a length, got {sun}")
    return sun, False


def _type(name: str, dtype: DTypeLike) -> np.dtype[Any]:
    kind = np.dtype(dtype)
    if kind not in _TYPES:
        raise TypeError(f"{name} must be uint8 or float32, got {kind}")
    return kind
