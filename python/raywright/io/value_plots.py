"""Values on surfaces, at points and in pictures, drawn by matplotlib with a color bar."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import NDArray

Axis: TypeAlias = Literal["x", "y", "z"]
AXES: tuple[Axis, ...] = ("x", "y", "z")
COLORS = "viridis"
# Colors for missing values, and for surfaces without values.
_NONE, _BARE = (0.6, 0.6, 0.6, 1.0), (0.82, 0.82, 0.82, 1.0)
# Area of a marker in square points; more points get smaller ones.
_LARGEST, _SMALLEST = 30.0, 1.0


def scale(values: NDArray[Any], cmap: Any = COLORS) -> Any:
    """Return the color map of values: from the least finite one to the largest; NaN is gray."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Colormap, Normalize

    colors = cmap if isinstance(cmap, Colormap) else colormaps[cmap]
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (0.0, 1.0)
    shown = colors.with_extremes(bad=_NONE)
    is_less, is_more = bool((values == -np.inf).any()), bool((values == np.inf).any())
    # matplotlib's attribute for the default ends of a color bar.
    ends: Any = ("neither", "min", "max", "both")[is_less + 2 * is_more]
    shown.colorbar_extend = ends
    mapped = ScalarMappable(Normalize(low, high), shown)
    # Infinity is masked as NaN is.
    mapped.set_array(np.clip(values, low, high))
    return mapped


def bar(ax: Any, mapped: Any, label: str) -> None:
    """Draw the color bar of a scale; it has a tip where values are infinite."""
    ax.figure.colorbar(mapped, ax=ax, label=label, shrink=0.75)


def draw_faces(ax: Any, corners: NDArray[np.float64], mapped: Any = None, up: Axis = "y") -> None:
    """Draw triangles, (F, 3, 3), each in the color of its value, or all in gray; shaded by their normals."""
    from matplotlib.colors import LightSource
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    colors = np.tile(_BARE, (len(corners), 1)) if mapped is None else mapped.to_rgba(mapped.get_array())
    whole = np.isfinite(corners).all(axis=(1, 2))
    if whole.any():
        # Colors encode values, so that shading changes them only a little.
        light = LightSource(azdeg=225, altdeg=45)
        faces = _turned(corners[whole], up)
        normals = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
        length = np.linalg.norm(normals, axis=1)
        toward = np.divide(
            np.abs(normals @ light.direction), length, out=np.ones(len(faces)), where=length > 0
        )
        shaded = colors[whole].copy()
        shaded[:, :3] *= (0.8 + 0.2 * toward)[:, None]
        ax.add_collection3d(Poly3DCollection(faces, facecolors=shaded, edgecolors=shaded, linewidths=0.2))


def draw_points(ax: Any, places: NDArray[np.float64], mapped: Any, up: Axis = "y") -> None:
    """Draw points, (N, 3), each in the color of its value."""
    whole = np.isfinite(places).all(axis=1)
    size = np.clip(5_000.0 / max(int(whole.sum()), 1), _SMALLEST, _LARGEST)
    colors = mapped.to_rgba(mapped.get_array())[whole]
    ax.scatter(*_turned(places[whole], up).T, c=colors, s=size, depthshade=False, linewidths=0)


def frame(ax: Any, places: NDArray[np.float64], up: Axis = "y") -> None:
    """Show all of some points, with one scale on all axes, and name the axes."""
    shown = _turned(places.reshape(-1, 3), up)
    shown = shown[np.isfinite(shown).all(axis=1)]
    low, high = (shown.min(axis=0), shown.max(axis=0)) if len(shown) else (np.zeros(3), np.ones(3))
    largest = float((high - low).max())
    # Flat extents need some room too.
    half = np.maximum(high - low, 0.05 * largest if largest > 0 else 1.0) / 2
    middle = (low + high) / 2
    for set_limits, center, reach in zip((ax.set_xlim, ax.set_ylim, ax.set_zlim), middle, half, strict=True):
        set_limits(center - reach, center + reach)
    ax.set_box_aspect(half)
    names = _names(up)
    for set_label, name in zip((ax.set_xlabel, ax.set_ylabel, ax.set_zlabel), names, strict=True):
        set_label(name)


def draw_picture(ax: Any, picture: NDArray[Any], label: str, cmap: Any = COLORS) -> None:
    """Draw a picture of values, (H, W), with its color bar."""
    values = np.where(np.isinf(picture), np.nan, np.asarray(picture, np.float64))
    mapped = scale(values, cmap)
    ax.imshow(values, cmap=mapped.cmap, norm=mapped.norm, interpolation="nearest")
    bar(ax, mapped, label)


def _turned(places: NDArray[np.float64], up: Axis) -> NDArray[np.float64]:
    """Return places with the axis that points up as the last, which is the one that plots have upright."""
    return np.roll(places, 2 - AXES.index(up), axis=-1)


def _names(up: Axis) -> list[str]:
    """Return the names of the axes of a plot."""
    first = (AXES.index(up) + 1) % 3
    return [AXES[(first + k) % 3] for k in range(3)]
