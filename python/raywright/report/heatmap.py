"""The picture of where the work is: nodes visited or primitives tested, pixel by pixel."""

from __future__ import annotations

import io
from dataclasses import dataclass
from os import PathLike
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from ..arrays import choice, integer
from ..cameras import AnyCamera
from ..io.pictures import check_writable
from ..io.plots import plotted
from ..scene.scene import Scene
from .table import Column, Table
from .time_share import TimeShare, time_share

What: TypeAlias = Literal["nodes", "primitives"]

_LEVELS = 256
# Least height of saved pictures, so that the numbers of the color bar are readable.
_LEAST_HEIGHT = 240
_GAP, _BAR, _TEXT = 12, 16, 84
_NAMES = {"nodes": "nodes visited", "primitives": "primitives tested"}


@dataclass(frozen=True, eq=False, repr=False)
class Heatmap:
    """The traversal cost of a picture's rays: `heatmap` makes it. Arrays are read-only; row 0 is the top.

    ``print`` shows its numbers, a notebook shows the picture.

    Attributes
    ----------
    nodes, primitives : (H, W) int32
        Nodes visited and primitives tested for each pixel's closest hit.
    what : {"nodes", "primitives"}
        The count in the picture.
    vmax : int
        Count of the last color, which greater counts have too.
    share : TimeShare or None
        Estimated shares of time in boxes and in primitives, if requested.

    See Also
    --------
    report.heatmap : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
    >>> heat = rw.report.heatmap(scene, camera, repeats=0)
    >>> heat.nodes.shape, heat.what, heat.share
    ((6, 8), 'nodes', None)
    """

    nodes: NDArray[np.int32]
    primitives: NDArray[np.int32]
    what: What
    vmax: int
    share: TimeShare | None = None

    @property
    def counts(self) -> NDArray[np.int32]:
        """The count in the picture: (H, W) int32."""
        return self.nodes if self.what == "nodes" else self.primitives

    def srgb(self) -> NDArray[np.uint8]:
        """Return the picture without its color bar: (H, W, 3) uint8, sRGB.

        Returns
        -------
        (H, W, 3) uint8 array

        See Also
        --------
        Heatmap.save : With the color bar.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
        >>> rw.report.heatmap(scene, camera, repeats=0).srgb().shape
        (6, 8, 3)
        """
        level = np.minimum(self.counts.astype(np.int64), self.vmax) * (_LEVELS - 1)
        return np.asarray(COLORS[(level + self.vmax // 2) // self.vmax])

    def summary(self) -> Table[Any]:
        """Return the numbers: mean, median, 99th percentile and maximum of both counts.

        Returns
        -------
        Table

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
        >>> len(rw.report.heatmap(scene, camera, repeats=0).summary().rows)
        2
        """
        columns = (
            Column("what", "a ray"),
            Column("mean", "mean", ".2f"),
            Column("median", "median", ".0f"),
            Column("percentile_99", "99 %", ".0f"),
            Column("most", "max", "d"),
        )
        rows = [
            (
                _NAMES[name],
                float(counts.mean()),
                float(np.median(counts)),
                float(np.quantile(counts, 0.99)),
                int(counts.max()),
            )
            for name, counts in (("nodes", self.nodes), ("primitives", self.primitives))
        ]
        height, width = self.counts.shape
        notes = () if self.share is None else (str(self.share),)
        return Table(f"Work of {width:,} by {height:,} primary rays", columns, tuple(rows), notes)

    def save(self, path: str | PathLike[str]) -> None:
        """Save the picture.

        Parameters
        ----------
        path : str or path
            ``.png`` is the picture with its color bar; pixels of small pictures are enlarged to squares.
            ``.npy`` holds the counts of the picture.

        Raises
        ------
        ValueError
            If the suffix is not supported.
        OSError
            If the file cannot be written.

        See Also
        --------
        Heatmap.plot : With matplotlib.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
        >>> heat = rw.report.heatmap(scene, camera, repeats=0)
        >>> heat.save("nodes.npy")
        >>> bool((np.load("nodes.npy") == heat.counts).all())
        True
        """
        file = check_writable(path, (".png", ".npy"), "a heatmap")
        if file.suffix.lower() == ".npy":
            np.save(file, self.counts)
        else:
            file.write_bytes(self._repr_png_())

    def plot(self, ax: Any = None) -> Any:
        """Draw the picture with matplotlib, with a color bar.

        Parameters
        ----------
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
            If a file has another suffix.
        OSError
            If the file cannot be written.
        TypeError
            If `ax` is something else.

        See Also
        --------
        Heatmap.save : Without matplotlib.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
        >>> _, axes = plt.subplots()
        >>> axes = rw.report.heatmap(scene, camera, repeats=0).plot(axes)
        >>> len(axes.get_images())
        1
        """
        return plotted(ax, self._draw)

    def _draw(self, ax: Any) -> None:
        from matplotlib.colors import ListedColormap

        shown = ax.imshow(self.counts, cmap=ListedColormap(COLORS / 255), vmin=0, vmax=self.vmax)
        extend = "max" if self.counts.max() > self.vmax else "neither"
        ax.figure.colorbar(shown, ax=ax, extend=extend, label=_NAMES[self.what])
        ax.set_axis_off()

    def _repr_png_(self) -> bytes:
        out = io.BytesIO()
        self._drawn().save(out, format="PNG")
        return out.getvalue()

    def _drawn(self) -> Any:
        """Return the picture beside its color bar, as Pillow has pictures."""
        from PIL import Image, ImageDraw

        zoom = -(-_LEAST_HEIGHT // self.counts.shape[0])
        pixels = self.srgb().repeat(zoom, axis=0).repeat(zoom, axis=1)
        height, width = pixels.shape[:2]
        page = Image.new("RGB", (width + _GAP + _BAR + _TEXT, height), "white")
        page.paste(Image.fromarray(pixels), (0, 0))
        draw = ImageDraw.Draw(page)
        left = width + _GAP
        draw.text((left, 2), self.what, fill="black")
        top, bottom = 22, height - 10
        for y in range(top, bottom + 1):
            color = COLORS[round((_LEVELS - 1) * (bottom - y) / (bottom - top))]
            draw.line([(left, y), (left + _BAR - 1, y)], fill=tuple(color.tolist()))
        for count in ticks(self.vmax):
            y = round(bottom - (bottom - top) * count / self.vmax)
            # Pillow's own font is only sure to have ASCII, without a sign for "at least".
            more = "+" if count == self.vmax and self.counts.max() > self.vmax else ""
            draw.line([(left + _BAR, y), (left + _BAR + 3, y)], fill="black")
            draw.text((left + _BAR + 6, y - 6), f"{count:,}{more}", fill="black")
        return page

    def __str__(self) -> str:
        return str(self.summary())

    def __repr__(self) -> str:
        height, width = self.counts.shape
        return f"Heatmap({width}x{height}, {_NAMES[self.what]}, 0 to {self.vmax})"


def heatmap(
    scene: Scene,
    camera: AnyCamera,
    what: What = "nodes",
    vmax: int | None = None,
    repeats: int = 7,
    threads: int | None = None,
) -> Heatmap:
    """Count the traversal work of a picture's primary rays.

    Parameters
    ----------
    scene : Scene
        The scene, whose accelerator is measured.
    camera : Camera or another kind
        Camera whose rays go through the centers of the pixels.
    what : {"nodes", "primitives"}
        The count in the picture: nodes visited, or primitives tested.
    vmax : int, optional
        Count of the last color, at least 1; by default the maximum. Use the same value for pictures to
        compare.
    repeats : int
        Number of timings for the shares of time (`time_share`); 0 leaves them out.
    threads : int, optional
        Number of threads; all cores if not given. The counts do not depend on it.

    Returns
    -------
    Heatmap

    Raises
    ------
    ValueError
        If `what` is not one of those, or a number is out of its range.
    TypeError
        If `scene` or `camera` is of another kind.

    See Also
    --------
    Scene.traversal_cost : The counts of any rays.
    report.time_share : The shares of time.

    Notes
    -----
    The colors are Green's (2011, "A colour scheme for the display of astronomical intensity images"), which
    rise evenly from black to white, also for the color-blind. Some accelerators trace neighboring rays
    together; then these share the counted visits.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=8, height=6)
    >>> heat = rw.report.heatmap(scene, camera, "primitives", repeats=0)
    >>> bool((heat.counts == scene.traversal_cost(*camera.rays()).primitives).all())
    True
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
    if not isinstance(camera, AnyCamera):
        raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
    choice("what", what, get_args(What))
    repeats = integer("repeats", repeats, 0, 10_000)
    rays = camera.rays()
    cost = scene.traversal_cost(*rays, threads=threads)
    counts = cost.nodes if what == "nodes" else cost.primitives
    vmax = max(int(counts.max()), 1) if vmax is None else integer("vmax", vmax, 1)
    share = time_share(scene, rays, repeats) if repeats else None
    return Heatmap(cost.nodes, cost.primitives, what, vmax, share)


def ticks(most: int) -> list[int]:
    """Return some round numbers from 0 to below `most`, and `most` itself."""
    step = max(most // 5, 1)
    size: int = 10 ** (len(str(step)) - 1)
    step = next(size * digit for digit in (1, 2, 5, 10) if size * digit >= step)
    # A tick too near to the last would overlap it.
    return [*range(0, most - step // 2, step), most]


def _cubehelix() -> NDArray[np.uint8]:
    """Colors from black to white of evenly rising lightness, sRGB: (256, 3)."""
    light = np.linspace(0, 1, _LEVELS)
    # Green's defaults: the start is purple, with one and a half turns.
    angle = 2 * np.pi * (0.5 / 3 + 1 - 1.5 * light)
    amplitude = light * (1 - light) / 2
    turns = np.array([[-0.14861, 1.78277], [-0.29227, -0.90649], [1.97294, 0.0]])
    colors = light + amplitude * (turns @ np.stack([np.cos(angle), np.sin(angle)]))
    return np.asarray(np.clip(colors.T, 0, 1) * 255 + 0.5, np.uint8)


COLORS = _cubehelix()
"""What counts are drawn in, from none to the most: (256, 3) uint8, sRGB."""
