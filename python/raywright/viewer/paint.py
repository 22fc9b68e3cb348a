"""One colour for each primitive, for pictures that are drawn while the camera moves."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..shapes.mesh import Mesh

# What tells of a material's colour, the first that it has.
_COLOURS = ("reflectance", "base_color", "diffuse", "transmittance")
_PARTS = ("material", "front", "a")
_GREY = (0.7, 0.7, 0.7)
# In the fourth byte: what shines is not shaded.
_SHINES = 255


def paints(shapes: Sequence[Any], first: NDArray[np.int64]) -> NDArray[np.uint8]:
    """Return a colour for each primitive, as far as one can be told without asking textures where.

    Parameters
    ----------
    shapes : sequence of shapes
        Of a scene.
    first : (S + 1,) int64
        The number of the first primitive of each, as `FlatArrays` has it.

    Returns
    -------
    (N, 4) uint8
        Linear red, green and blue of 255, and 255 if it shines.
    """
    rows = np.zeros((max(int(first[-1]), 1), 4), np.uint8)
    for shape, begin, end in zip(shapes, first[:-1], first[1:], strict=True):
        shines = isinstance(shape, Mesh) and shape.emission is not None
        rows[begin:end, :3] = np.clip(np.round(255 * np.array(_colour(shape))), 0, 255)
        rows[begin:end, 3] = _SHINES * shines
    return rows


def _colour(shape: Any) -> NDArray[np.float64]:
    material, seen = getattr(shape, "material", None), 0
    while material is not None and seen < 4:
        for name in _COLOURS:
            value = _three(getattr(material, name, None))
            if value is not None:
                return value
        inner = (getattr(material, name, None) for name in _PARTS)
        material, seen = next((one for one in inner if one is not None), None), seen + 1
    return np.array(_GREY)


def _three(value: Any) -> NDArray[np.float64] | None:
    """Return three numbers of a colour, if it is one; of an image the mean."""
    if value is None or isinstance(value, bool | str):
        return None
    try:
        pixels = np.asarray(getattr(value, "image", value))
        # Bytes of an image are those of a screen.
        pixels = (pixels / 255.0) ** 2.2 if pixels.dtype == np.uint8 else pixels.astype(float)
    except (TypeError, ValueError):
        return None
    if pixels.ndim > 1:
        pixels = pixels.reshape(-1, pixels.shape[-1])[:, :3].mean(axis=0)
    return np.broadcast_to(pixels, 3) if pixels.shape in ((), (1,), (3,)) else None
