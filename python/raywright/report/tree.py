"""The boxes of a tree, drawn."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias, get_args

import numpy as np

from ..arrays import choice, integer
from ..io.plots import plotted
from ..scene.scene import Scene
from .heatmap import COLORS

Plane: TypeAlias = Literal["xy", "xz", "yz"]

# Corners share an edge if their numbers differ in one bit.
_EDGES = np.array([(i, i | 1 << bit) for i in range(8) for bit in range(3) if not i >> bit & 1])


def tree(
    scene: Scene, depth: int | None = None, plane: Plane = "xy", leaves: bool = False, ax: Any = None
) -> Any:
    """Draw the boxes of a scene's accelerator, seen along an axis; deeper boxes are lighter.

    Parameters
    ----------
    scene : Scene
        Scene with the tree; `Scene.tree_boxes` gives the boxes themselves.
    depth : int, optional
        The last level to be drawn; all, if not given.
    plane : {"xy", "xz", "yz"}
        Plane of the projection.
    leaves : bool
        True to draw leaves alone.
    ax : matplotlib.axes.Axes, str or path, optional
        Target: a new figure if not given, axes, or a file, .png, .svg or .pdf.

    Returns
    -------
    matplotlib.axes.Axes

    Raises
    ------
    ImportError
        If matplotlib is not installed (``pip install 'raywright[plot]'``).
    ValueError
        If `plane` is not one of those, `depth` is negative, a file has another suffix, or the scene's
        accelerator has no boxes.
    OSError
        If the file cannot be written.
    TypeError
        If `scene` or `ax` is of another kind.

    See Also
    --------
    Scene.tree_boxes : The boxes.

    Examples
    --------
    >>> from matplotlib import pyplot as plt
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> _, axes = plt.subplots()
    >>> axes = rw.report.tree(scene, depth=2, ax=axes)
    >>> len(axes.collections)
    1
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
    choice("plane", plane, get_args(Plane))
    boxes = scene.tree_boxes()
    deepest = int(boxes.depth[-1]) if len(boxes) else 0
    last = deepest if depth is None else min(integer("depth", depth, 0), deepest)
    drawn = boxes.depth <= last
    drawn &= boxes.leaf | (not leaves)
    axes = ["xyz".index(axis) for axis in plane]
    lines = boxes.corners[drawn][:, _EDGES][..., axes].reshape(-1, 2, 2)
    # The lightest shade still is visible on white at any level.
    shades = np.linspace(0, 180, last + 1).astype(int)[boxes.depth[drawn]]

    def draw(ax: Any) -> None:
        from matplotlib.collections import LineCollection

        colors = np.repeat(COLORS[shades] / 255, len(_EDGES), axis=0)
        widths = np.repeat(2.0 / (1 + boxes.depth[drawn]) + 0.4, len(_EDGES))
        ax.add_collection(LineCollection(list(lines), colors=colors, linewidths=widths))
        ax.autoscale_view()
        ax.set_aspect("equal")
        count = f"{np.count_nonzero(drawn):,} {'leaves' if leaves else 'boxes'}"
        title = f"{scene.accelerator_info.kind}\n{count} to depth {last} of {deepest}"
        ax.set(xlabel=plane[0], ylabel=plane[1], title=title)

    return plotted(ax, draw, figsize=(7, 7))
