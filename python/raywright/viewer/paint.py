"""One color for each primitive, for pictures that are drawn while the camera moves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..query.gpu_arrays import GpuArrays
from ..shapes.mesh import Mesh

# Attributes with a material's color, the first present one counts.
_COLORS = ("reflectance", "base_color", "diffuse", "transmittance")
_PARTS = ("material", "front", "a")
_GRAY = (0.7, 0.7, 0.7)
# Value of the fourth byte: emitting surfaces are not shaded.
_SHINES = 255


def paints(shapes: Sequence[Any], flat: GpuArrays) -> NDArray[np.uint32]:
    """Return a color and the normal of each primitive, as far as they do not depend on the place.

    Parameters
    ----------
    shapes : sequence of shapes
        Of a scene.
    flat : GpuArrays
        Its arrays.

    Returns
    -------
    (N, 2) uint32
        Linear red, green and blue, each a byte of 255, and one that is 255 if it shines; and where the normal
        is on an octahedron, two int16 of 32767 (Cigolle et al. 2014).
    """
    first = flat.first
    rows = np.zeros((max(int(first[-1]), 1), 4), np.uint8)
    for shape, begin, end in zip(shapes, first[:-1], first[1:], strict=True):
        shines = isinstance(shape, Mesh) and shape.emission is not None
        rows[begin:end, :3] = np.clip(np.round(255 * np.array(_color(shape))), 0, 255)
        rows[begin:end, 3] = _SHINES * shines
    packed = np.zeros((len(rows), 2), "<u4")
    packed[:, 0] = rows.view("<u4")[:, 0]
    packed[flat.triangles["primitive"], 1] = _folded(flat.triangles)
    return packed


def _folded(triangles: NDArray[np.void]) -> NDArray[np.uint32]:
    """Return normals of triangles on an octahedron, whose lower half is folded out."""
    across = np.cross(triangles["edge"].astype(float), triangles["other"].astype(float))
    sums = np.abs(across).sum(axis=1, keepdims=True)
    x, y, z = np.divide(across, sums, out=np.zeros_like(across), where=sums > 0).T
    below = z < 0
    u = np.where(below, (1 - np.abs(y)) * np.where(x >= 0, 1, -1), x)
    v = np.where(below, (1 - np.abs(x)) * np.where(y >= 0, 1, -1), y)
    both = np.round(32767 * np.stack([u, v], axis=1)).astype("<i2")
    return np.ascontiguousarray(both).view("<u4")[:, 0]


def _color(shape: Any) -> NDArray[np.float64]:
    material, seen = getattr(shape, "material", None), 0
    while material is not None and seen < 4:
        for name in _COLORS:
            value = _three(getattr(material, name, None))
            if value is not None:
                return value
        inner = (getattr(material, name, None) for name in _PARTS)
        material, seen = next((one for one in inner if one is not None), None), seen + 1
    return np.array(_GRAY)


def _three(value: Any) -> NDArray[np.float64] | None:
    """Return three numbers of a color, if it is one; of an image the mean."""
    if value is None or isinstance(value, bool | str):
        return None
    try:
        pixels = np.asarray(getattr(value, "image", value))
        # Bytes of an image are display-encoded.
        pixels = (pixels / 255.0) ** 2.2 if pixels.dtype == np.uint8 else pixels.astype(float)
    except (TypeError, ValueError):
        return None
    if pixels.ndim > 1:
        pixels = pixels.reshape(-1, pixels.shape[-1])[:, :3].mean(axis=0)
    return np.broadcast_to(pixels, 3) if pixels.shape in ((), (1,), (3,)) else None
