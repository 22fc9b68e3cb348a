"""Points on surfaces, drawn by matplotlib."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import choice
from ..io.plots import plotted
from ..io.value_plots import AXES, COLORS, Axis, bar, draw_picture, draw_points, frame, scale

# Integer attributes, where -1 stands for a miss.
_COUNTED = ("shape_id", "primitive_id", "cell")


class PlottedPoints:
    """Plots of points on surfaces."""

    def plot(self, ax: Any = None, name: str | None = None, up: Axis = "y", cmap: Any = COLORS) -> Any:
        """Draw the points with matplotlib: as a picture if there are rows and columns of them, or in space.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes, which have three dimensions but for pictures, or a file,
            .png, .svg or .pdf.
        name : str, optional
            Values that are colored: "t" of hits or "distance" of closest points, as if not given; "shape_id",
            "primitive_id", "cell", or the name of an attribute. Misses are gray in pictures.
        up : {"x", "y", "z"}
            The axis that points up in space.
        cmap : str or matplotlib.colors.Colormap
            The colors, from the least finite value to the largest.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed (``pip install 'raywright[plot]'``).
        ValueError
            If there is no such name, an attribute has several numbers per point, a file has another suffix,
            or axes have another number of dimensions.
        TypeError
            If `ax` or `name` is something else.
        OSError
            If the file cannot be written.

        See Also
        --------
        measure.plot : Plot values on the faces of a scene.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=16, height=12)
        >>> _, axes = plt.subplots()
        >>> axes = rw.Scene(rw.Sphere()).first_hits(camera).plot(axes)
        >>> axes.get_images()[0].get_array().shape
        (12, 16)
        """
        choice("up", up, AXES)
        points: Any = self
        shown = ("t" if hasattr(points, "t") else "distance") if name is None else name
        values = _values(points, shown)
        label = str(shown).replace("_", " ")
        if values.ndim == 2:
            return plotted(ax, lambda ax: draw_picture(ax, values, label, cmap))
        places = np.where(np.isfinite(values)[..., None], points.position, np.nan).reshape(-1, 3)

        def draw(ax: Any) -> None:
            mapped = scale(values.reshape(-1), cmap)
            draw_points(ax, places, mapped, up)
            frame(ax, places, up)
            bar(ax, mapped, label)

        return plotted(ax, draw, solid=True)


def _values(points: Any, name: str) -> NDArray[np.float64]:
    """Return the colored values of points: NaN or infinity for a miss."""
    if name in _COUNTED:
        counted = np.asarray(getattr(points, name), np.float64)
        return np.where(np.asarray(points.primitive_id) >= 0, counted, np.nan)
    if name in ("t", "distance") and hasattr(points, name):
        return np.asarray(getattr(points, name), np.float64)
    found: NDArray[np.float64] = points.interpolate(name)
    if found.shape != points.primitive_id.shape:
        told = found.shape[points.primitive_id.ndim :]
        raise ValueError(f"name must be an attribute of one number per point, {name!r} has {told}")
    return found
