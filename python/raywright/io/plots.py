"""Where a plot is drawn: on axes, in a figure of its own, or to a file."""

from __future__ import annotations

from collections.abc import Callable
from os import PathLike
from typing import Any

from .pictures import check_writable

NO_MATPLOTLIB = "plots need matplotlib: pip install 'raywright[plot]'"
_SUFFIXES = (".png", ".svg", ".pdf")


def plotted(where: Any, draw: Callable[[Any], object], solid: bool = False, **figure: Any) -> Any:
    """Draw on axes and return them.

    Parameters
    ----------
    where : matplotlib.axes.Axes, str or path, optional
        Where to: a new figure of `matplotlib.pyplot` if None, and with a path one that goes to that file.
    draw : callable
        Takes axes and draws on them.
    solid : bool
        True if the axes have three dimensions.
    **figure
        Arguments of a new figure, as in `matplotlib.figure.Figure`.

    Raises
    ------
    ImportError
        If matplotlib is not installed.
    ValueError
        If the suffix of the file is not .png, .svg or .pdf, or axes have two dimensions and not three, or the
        other way round.
    OSError
        If the file cannot be written.
    TypeError
        If `where` is something else.
    """
    file = check_writable(where, _SUFFIXES, "a plot") if isinstance(where, str | PathLike) else None
    figure["layout"] = "constrained"
    kind = {"projection": "3d"} if solid else {}
    try:
        if where is None:
            import matplotlib.pyplot as plt

            _, ax = plt.subplots(**figure, subplot_kw=kind)
        else:
            from matplotlib.axes import Axes
            from matplotlib.figure import Figure

            # Without pyplot, which would keep the figure and may need a display.
            ax = where if file is None else Figure(**figure).subplots(subplot_kw=kind)
            if not isinstance(ax, Axes):
                raise TypeError(f"ax must be matplotlib axes or a path, got {type(ax).__name__}")
            if (ax.name == "3d") != solid:
                told = "three dimensions: plt.subplots(subplot_kw={'projection': '3d'})" if solid else "two"
                raise ValueError(f"ax must have {told}{'' if solid else ' dimensions'}")
    except ImportError as error:
        raise ImportError(NO_MATPLOTLIB) from error
    draw(ax)
    if file is not None:
        ax.figure.savefig(file, dpi=120)
    return ax
