"""Values on surfaces and at points, drawn by matplotlib."""

from __future__ import annotations

from os import PathLike
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import choice, last_axis
from ..foreign_arrays import as_array, describe
from ..io.plots import plotted
from ..io.value_plots import AXES, COLORS, Axis, bar, draw_faces, draw_points, frame, scale
from ..query.surface_points import SurfacePoints
from ..query.tabular import Tabular
from ..scene.scene import Scene, SceneLike
from .places import Floats
from .triangles import meshes_in


def plot(
    scene: SceneLike,
    values: ArrayLike,
    points: SurfacePoints | ArrayLike | None = None,
    ax: Any = None,
    label: str = "value",
    up: Axis = "y",
    cmap: Any = COLORS,
) -> Any:
    """Draw values on the faces or vertices of meshes, or at points beside these.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Meshes to draw, including static copies.
    values : (...) array of real numbers or bool
        A value for each point; without points, for each face or each vertex of all meshes in order. NaN is
        drawn in gray, and infinity in the color of the nearest end.
    points : Hits, ClosestPoints or (..., 3) array, optional
        Places of the values. The meshes are gray below them, unless the points are their vertices.
    ax : matplotlib.axes.Axes, str or path, optional
        Target: a new figure if not given, axes with three dimensions, or a file, .png, .svg or .pdf.
    label : str
        Label of the color bar.
    up : {"x", "y", "z"}
        The axis that points up.
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
        If the values are not as many as there are faces, vertices or points, a file has another suffix, or
        axes have two dimensions.
    TypeError
        If the values are not numbers, or `ax` is something else.
    OSError
        If the file cannot be written.

    See Also
    --------
    query.Hits.plot : Draw hits.

    Examples
    --------
    >>> from matplotlib import pyplot as plt
    >>> knot = rw.scenes.torus_knot(along=20, around=6)
    >>> axes = plt.figure().add_subplot(projection="3d")
    >>> axes = rw.measure.plot(knot, np.arange(len(knot.faces)), ax=axes, label="face")
    >>> len(axes.collections)
    1
    """
    choice("up", up, AXES)
    shown = _numbers(values)
    whole = scene if isinstance(scene, Scene) else Scene(scene, weld=None)
    vertices, faces = _meshes(whole, is_all=points is None)
    if isinstance(points, str | PathLike):
        raise TypeError(f"points must be positions, got {str(points)!r}: give a file to draw to as ax=")
    places = None if points is None else _places(points, shown.shape)
    if places is None and shown.shape not in ((len(faces),), (len(vertices),)):
        told = f"({len(faces)},), one per face, or ({len(vertices)},), one per vertex"
        raise ValueError(f"values must have shape {told}, or points be given, got {shown.shape}")
    corners = vertices[faces]
    is_of_vertices = shown.shape == (len(vertices),) and (
        shown.shape != (len(faces),) if places is None else np.array_equal(places, vertices)
    )
    if is_of_vertices:
        shown, places = _means(shown[faces]), None

    def draw(ax: Any) -> None:
        mapped = scale(shown.reshape(-1), cmap)
        if places is None:
            draw_faces(ax, corners, mapped, up)
            frame(ax, corners, up)
        else:
            # Points lie on the surface and are drawn after it.
            ax.computed_zorder = False
            draw_faces(ax, corners, None, up)
            draw_points(ax, places.reshape(-1, 3), mapped, up)
            frame(ax, np.concatenate([corners.reshape(-1, 3), places.reshape(-1, 3)]), up)
        bar(ax, mapped, label)

    return plotted(ax, draw, solid=True)


class Where(NamedTuple):
    """The scene and the points of the values; the middle of every face if None."""

    scene: Scene
    points: SurfacePoints | Floats | None


class Plotted(Tabular):
    """Values at points of a scene, kept unless they are pickled or copied."""

    _where: Where | None = None
    # Names of the arrays that can be drawn, the main one first.
    _drawn: ClassVar[tuple[str, ...]] = ()

    def plot(self, ax: Any = None, name: str | None = None, up: Axis = "y", cmap: Any = COLORS) -> Any:
        """Draw values on the mesh, or at the points beside it, with matplotlib.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes with three dimensions, or a file, .png, .svg or .pdf.
        name : str, optional
            Name of the array; the first if not given.
        up : {"x", "y", "z"}
            The axis that points up.
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
            If there is no array of this name, the values come out of a pickle or a copy, a file has another
            suffix, or axes have two dimensions.
        TypeError
            If `ax` is something else.
        OSError
            If the file cannot be written.

        See Also
        --------
        measure.plot : Draw any values.

        Examples
        --------
        >>> from matplotlib import pyplot as plt
        >>> knot = rw.scenes.torus_knot(along=20, around=6)
        >>> axes = rw.measure.sky_view(knot, rays=16).plot(plt.figure().add_subplot(projection="3d"))
        >>> len(axes.collections)
        1
        """
        shown = self._drawn[0] if name is None else name
        choice("name", shown, self._drawn)
        if self._where is None:
            raise ValueError(
                "pickles and copies have no scene: use raywright.measure.plot(scene, values, points)"
            )
        values = getattr(self, shown)
        return plot(self._where.scene, values, self._where.points, ax, shown.replace("_", " "), up, cmap)

    def _at(self, scene: Scene, points: SurfacePoints | ArrayLike | None) -> None:
        """Remember where the values are."""
        kept = points if points is None or isinstance(points, SurfacePoints) else np.array(points, np.float64)
        object.__setattr__(self, "_where", Where(scene, kept))

    def __getstate__(self) -> dict[str, Any]:
        return {name: value for name, value in vars(self).items() if name != "_where"}


def _numbers(values: ArrayLike) -> Floats:
    array = as_array("values", values)
    if array.dtype.kind not in "iufb":
        raise TypeError(f"values must be real numbers or bool, got {describe(values, array, short=True)}")
    return array.astype(np.float64)


def _places(points: SurfacePoints | ArrayLike, shape: tuple[int, ...]) -> Floats:
    given = points.position if isinstance(points, SurfacePoints) else last_axis("points", points, 3)
    try:
        return np.broadcast_to(np.asarray(given, np.float64), (*shape, 3))
    except ValueError:
        raise ValueError(f"values must have shape {given.shape[:-1]}, one per point, got {shape}") from None


def _means(corners: Floats) -> Floats:
    """Return the mean of the values of each face's corners; NaN only where one is."""
    with np.errstate(invalid="ignore"):
        means: Floats = corners.mean(axis=1)
    return means


def _meshes(scene: Scene, is_all: bool) -> tuple[Floats, NDArray[np.int64]]:
    """Return the vertices and faces of all meshes; `is_all`: there must be nothing else."""
    vertices, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], 0
    for i, shape in enumerate(scene.shapes):
        try:
            found = list(meshes_in(shape, f"shape {i}"))
        except ValueError:
            if is_all:
                raise ValueError(
                    f"points must be given: shape {i} is a {type(shape).__name__}, not a static mesh"
                ) from None
            continue
        for mesh in found:
            vertices.append(mesh.vertices.astype(np.float64))
            faces.append(mesh.faces.astype(np.int64) + count)
            count += len(mesh.vertices)
    return np.concatenate(vertices), np.concatenate(faces)
