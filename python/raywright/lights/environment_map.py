"""A picture of all that surrounds a scene."""

from __future__ import annotations

from dataclasses import dataclass
from os import PathLike

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import frozen, number, real_array
from .light import Environment
from .pictured import Pictured, Texels, texels


@dataclass(frozen=True, init=False, eq=False, repr=False)
class EnvironmentMap(Pictured, Environment):
    """An equirectangular picture around the scene, importance sampled by its radiance.

    The middle of the picture is seen along -z, its top at +y, and its right half towards +x: as a `Camera`
    sees it that looks along -z. Radiance is interpolated between the middles of texels, and sampled exactly:
    a sun of one texel causes no extra noise.

    Parameters
    ----------
    image : (H, W, 3) or (H, W) array, or path
        Linear radiance from the top row on, at least 0, kept as read-only float32. A path names an .exr, .hdr
        or .npy file of linear colors, or an 8-bit picture, which is taken as sRGB. Negative values become 0,
        with a warning, if they come from a file or are at most a hundredth of all light.
    to_world : (3, 3) or (4, 4) array, optional
        A rotation, or a reflection, from the picture's space to the world.
    scale : float
        Factor from the image to radiance in W·sr⁻¹·m⁻², at least 0.

    Raises
    ------
    ValueError
        If the image is empty, of another shape, negative or not finite; if `to_world` is not a rotation; or
        if `scale` is negative or not finite.
    TypeError
        If an argument does not hold numbers.
    FileNotFoundError
        If a file is missing.

    See Also
    --------
    ConstantEnvironment : The same radiance everywhere.

    Examples
    --------
    >>> sky = np.zeros((8, 16, 3), np.float32)
    >>> sky[:4] = [0.2, 0.4, 0.8]
    >>> scene = rw.Scene([], environment=rw.EnvironmentMap(sky, scale=2.0))
    >>> camera = rw.Camera((0, 0, 0), (0, 1, 0), up=(0, 0, 1), width=1, height=1)
    >>> print(rw.render(scene, camera, samples=1, progress=False).rgb[0, 0].round(3))
    [0.4 0.8 1.6]
    """

    image: Texels
    to_world: NDArray[np.float64]
    scale: float

    def __init__(
        self,
        image: ArrayLike | str | PathLike[str],
        to_world: ArrayLike | None = None,
        scale: float = 1.0,
    ) -> None:
        factor = number("scale", scale)
        if factor < 0:
            raise ValueError(f"scale must be at least 0, got {scale}")
        turned = np.eye(3) if to_world is None else to_world
        object.__setattr__(self, "image", texels("image", image))
        object.__setattr__(self, "to_world", _rotation("to_world", turned))
        object.__setattr__(self, "scale", factor)


def _rotation(name: str, value: ArrayLike) -> NDArray[np.float64]:
    matrix = real_array(name, value).astype(np.float64)
    if matrix.shape == (4, 4) and np.array_equal(matrix[3], (0, 0, 0, 1)) and not matrix[:3, 3].any():
        matrix = matrix[:3, :3]
    if matrix.shape != (3, 3):
        raise ValueError(f"{name} must be a rotation of shape (3, 3) or (4, 4), got {matrix.shape}")
    if not np.abs(matrix @ matrix.T - np.eye(3)).max() < 1e-6:
        raise ValueError(f"{name} must be a rotation, with orthonormal rows")
    return frozen(matrix + 0.0)
