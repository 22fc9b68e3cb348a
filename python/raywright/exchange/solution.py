"""What radiosity finds."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple, choice, number, same
from ..io.plots import plotted
from ..io.value_plots import AXES, COLORS, Axis, bar, draw_faces, frame, scale
from ..query.tabular import Tabular

if TYPE_CHECKING:
    import trimesh

Floats = NDArray[np.float64]
Per = Literal["face", "vertex"]
Method = Literal["stochastic", "progressive", "matrix"]


_LUMINANCE = (0.2126, 0.7152, 0.0722)


class RadiosityStep(NamedTuple):
    """The progress of a solution at some time.

    Attributes
    ----------
    seconds : float
        Seconds since the start.
    rays : int
        Rays so far.
    bound : float
        Bound on the radiosity that unshot power can still add, as a share of the total: ‖unshot‖ / (1 -
        reflectance) over ‖radiosity‖.

    See Also
    --------
    RadiositySolution : Lists them in `history`.

    Examples
    --------
    >>> scene, _ = rw.scenes.cornell_box()
    >>> step = rw.radiosity(scene, rays=1000, progress=False).history[-1]
    >>> step.rays > 0, 0 <= step.bound < 1
    (True, True)
    """

    seconds: float
    rays: int
    bound: float


@dataclass(frozen=True, eq=False, repr=False)
class RadiositySolution(Tabular):
    """Diffuse light between patches; all arrays are read-only. Made by `radiosity`.

    There is a row for each side of a patch: all fronts, where the normals point, then all backs, if they take
    part.

    Attributes
    ----------
    radiosity : (N, 3) float64
        Leaving flux, emitted and reflected, W/m²: π times the radiance.
    irradiance : (N, 3) float64
        Arriving flux, W/m².
    standard_error : (N, 3) float64
        Standard error of `radiosity`: from independent replicates, plus a bound on the effect of unshot
        power; 0 without sampling. Variation within a patch, such as the edge of a shadow, is not part of it.
    irradiance_error : (N, 3) float64
        The standard error of `irradiance`.
    emission, reflectance : (N, 3) float64
        Emission, W/m², and reflectance of each: the means of four points.
    areas : (N,) float64
        Areas in m²; 0 for a face that coincides with one before it, which counts for both and has the same
        light.
    patches : (N,) structured
        Index of the "shape", its "face", the "cell" of the face, and the "side": 1 for the front, -1 for the
        back. In an `Instance`, "copy" is the index of the copy, and "face" is numbered as in
        `Instance.locate`; "copy" is -1 elsewhere.
    corners : (N, 3, 3) float64
        Positions of the corners, in the order of the face's; NaN for shapes without triangles.
    cuts : (F,) uint32
        Number of strips of each face, all copies counted.
    mirrored : (F,) bool
        True for faces of mirrored copies: their second and third corners change places.
    per : {"face", "vertex"}
        "face": pictures show one value for each patch. "vertex": they interpolate linearly between corners.
    method : {"stochastic", "progressive", "matrix"}
        The method of the solution.
    emitted, absorbed, escaped, unshot : tuple of 3 floats
        Balance of power, W: emitted by lights and surfaces, absorbed by patches, escaped from the scene or
        absorbed by black backs, and unshot. Emitted power is the sum of the others.
    history : tuple of RadiosityStep
        Progress of the solution over time.
    dropped : int
        Number of faces without exchange of their own: without area, not finite, or coincident with another.
    surface_area : float
        Area of all faces except copies, with each coincident face counted, m².

    See Also
    --------
    radiosity : Makes it.
    Radiosity : Renders it.

    Examples
    --------
    >>> scene, _ = rw.scenes.cornell_box()
    >>> solution = rw.radiosity(scene, rays=1000, progress=False)
    >>> solution.radiosity.shape == solution.irradiance.shape
    True
    >>> np.allclose(solution.emitted, np.add(solution.absorbed, solution.escaped) + solution.unshot)
    True
    """

    radiosity: Floats
    irradiance: Floats
    standard_error: Floats
    irradiance_error: Floats
    emission: Floats
    reflectance: Floats
    areas: Floats
    patches: NDArray[Any]
    corners: Floats
    cuts: NDArray[np.uint32]
    mirrored: NDArray[np.bool_]
    per: Per
    method: Method
    emitted: Triple
    absorbed: Triple
    escaped: Triple
    unshot: Triple
    history: tuple[RadiosityStep, ...]
    dropped: int
    surface_area: float

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, np.ndarray):
                value.setflags(write=False)

    @property
    def error(self) -> float:
        """Root mean square of `irradiance_error`, by area, over that of `irradiance`."""
        return relative_error(self.irradiance_error, self.irradiance, self.areas)

    @property
    def bound(self) -> float:
        """The last bound of `history`."""
        return self.history[-1].bound if self.history else 0.0

    @cached_property
    def corner_irradiance(self) -> Floats:
        """The irradiance at each patch's corners, (N, 3, 3): the patch's own, or that of `per="vertex"`."""
        if self.per == "face":
            result = np.repeat(self.irradiance[:, None, :], 3, axis=1)
        else:
            from .corners import at_corners

            sides = [self.patches["side"] == side for side in (1, -1)]
            result = np.empty((len(self.areas), 3, 3))
            for rows in sides:
                parts = (
                    self.irradiance[rows],
                    self.corners[rows],
                    self.areas[rows],
                    self.patches["shape"][rows],
                )
                result[rows] = at_corners(*parts)
        result.setflags(write=False)
        return result

    @cached_property
    def corner_radiosity(self) -> Floats:
        """The radiosity at each patch's corners, (N, 3, 3), as `corner_irradiance`."""
        result = self.emission[:, None, :] + self.reflectance[:, None, :] * self.corner_irradiance
        result.setflags(write=False)
        return result

    def to_mesh(
        self, exposure: float | None = None, side: Literal["front", "back"] = "front"
    ) -> trimesh.Trimesh:
        """Return a mesh of the patches with their light as vertex colors.

        Each patch has separate corners, so patches that share an edge keep their colors. Only meshes are
        included.

        Parameters
        ----------
        exposure : float, optional
            Factor of radiance before it is clipped to 0..1 and coded as sRGB; by default, 99 % of the
            reflecting patches are below 1.
        side : {"front", "back"}
            Side of the patches.

        Returns
        -------
        trimesh.Trimesh

        Raises
        ------
        ValueError
            If `exposure` is not above 0, the solution has no such side, or the scene is of no meshes.

        See Also
        --------
        RadiositySolution.save : Write it to a file.

        Examples
        --------
        >>> scene, _ = rw.scenes.cornell_box()
        >>> mesh = rw.radiosity(scene, rays=1000, progress=False).to_mesh()
        >>> mesh.visual.kind
        'vertex'
        """
        import trimesh

        from ..io.shown import srgb

        rows = self._drawn(side)
        radiance = self.corner_radiosity[rows] / np.pi
        if exposure is None:
            reflecting = radiance[~self.emission[rows].any(axis=1)]
            most = float(np.percentile(reflecting if reflecting.size else radiance, 99))
            exposure = 1.0 / most if most > 0 else 1.0
        elif number("exposure", exposure) <= 0:
            raise ValueError(f"exposure must be greater than 0, got {exposure}")
        colors = srgb(exposure * radiance.reshape(-1, 3), tone="linear")
        faces = np.arange(3 * int(rows.sum())).reshape(-1, 3)
        if side == "back":
            faces = faces[:, ::-1]
        return trimesh.Trimesh(self.corners[rows].reshape(-1, 3), faces, vertex_colors=colors, process=False)

    def plot(
        self,
        ax: Any = None,
        name: Literal["radiosity", "irradiance", "standard_error", "irradiance_error"] = "radiosity",
        side: Literal["front", "back"] = "front",
        up: Axis = "y",
        cmap: Any = COLORS,
    ) -> Any:
        """Draw patches in the color of their luminance with matplotlib. Only meshes are drawn.

        Parameters
        ----------
        ax : matplotlib.axes.Axes, str or path, optional
            Target: a new figure if not given, axes with three dimensions, or a file, .png, .svg or .pdf.
        name : {"radiosity", "irradiance", "standard_error", "irradiance_error"}
            Name of the array; red, green and blue are weighted as in ITU-R BT.709.
        side : {"front", "back"}
            Side of the patches.
        up : {"x", "y", "z"}
            The axis that points up.
        cmap : str or matplotlib.colors.Colormap
            The colors, from the least value to the largest.

        Returns
        -------
        matplotlib.axes.Axes

        Raises
        ------
        ImportError
            If matplotlib is not installed (``pip install 'raywright[plot]'``).
        ValueError
            If there is no such name, the solution has no such side, the scene is of no meshes, a file has
            another suffix, or axes have two dimensions.
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
        >>> scene, _ = rw.scenes.cornell_box()
        >>> solution = rw.radiosity(scene, rays=1000, progress=False)
        >>> axes = solution.plot(plt.figure().add_subplot(projection="3d"))
        >>> len(axes.collections)
        1
        """
        choice("name", name, ("radiosity", "irradiance", "standard_error", "irradiance_error"))
        choice("up", up, AXES)
        rows = self._drawn(side)
        values = (getattr(self, name)[rows] * _LUMINANCE).sum(axis=1)

        def draw(ax: Any) -> None:
            mapped = scale(values, cmap)
            draw_faces(ax, self.corners[rows], mapped, up)
            frame(ax, self.corners[rows], up)
            bar(ax, mapped, f"{name.replace('_', ' ')} in W/m²")

        return plotted(ax, draw, solid=True)

    def _drawn(self, side: Literal["front", "back"]) -> NDArray[np.bool_]:
        """Return which patches are those of a side that are triangles."""
        choice("side", side, ("front", "back"))
        rows = self.patches["side"] == (1 if side == "front" else -1)
        rows &= np.isfinite(self.corners).all(axis=(1, 2))
        if not rows.any():
            raise ValueError(f"the solution has no {side} side of a mesh to draw")
        return np.asarray(rows)

    def save(
        self,
        path: str | os.PathLike[str],
        exposure: float | None = None,
        side: Literal["front", "back"] = "front",
    ) -> None:
        """Write `to_mesh` to a file of a format that holds vertex colors: ``.ply``, ``.glb`` or ``.obj``.

        Parameters
        ----------
        path : str or path
            File to write.
        exposure, side
            As for `to_mesh`.

        Raises
        ------
        ValueError
            If the name ends otherwise; also as raised by `to_mesh`.

        See Also
        --------
        RadiositySolution.to_mesh : The mesh itself.

        Examples
        --------
        >>> import os
        >>> scene, _ = rw.scenes.cornell_box()
        >>> rw.radiosity(scene, rays=1000, progress=False).save("light.ply")
        >>> os.path.exists("light.ply")
        True
        """
        kind = os.path.splitext(os.fspath(path))[1].lower()
        if kind not in (".ply", ".glb", ".obj"):
            raise ValueError(f"path must end in .ply, .glb or .obj, got {os.fspath(path)!r}")
        self.to_mesh(exposure, side).export(os.fspath(path))

    def __len__(self) -> int:
        return len(self.areas)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, RadiositySolution):
            return NotImplemented
        pairs = ((getattr(self, field.name), getattr(other, field.name)) for field in fields(self))
        return all(same(a, b) if isinstance(a, np.ndarray) else a == b for a, b in pairs)

    __hash__ = None  # type: ignore[assignment]

    def __setstate__(self, state: dict[str, Any]) -> None:
        for value in state.values():
            if isinstance(value, np.ndarray):
                value.setflags(write=False)
        vars(self).update(state)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each side of a patch, with the fields of `patches`.

        Colors are apart, as ``radiosity_red``, ``radiosity_green``, ``radiosity_blue``, and so on.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> scene, _ = rw.scenes.cornell_box()
        >>> columns = rw.radiosity(scene, rays=1000, progress=False).to_dict()
        >>> columns["radiosity_red"].shape == columns["face"].shape
        True
        """
        columns = {name: self.patches[name] for name in ("shape", "copy", "face", "cell", "side")}
        columns["area"] = self.areas
        of_light = ("radiosity", "standard_error", "irradiance", "irradiance_error")
        for name in (*of_light, "emission", "reflectance"):
            values = getattr(self, name)
            columns |= {f"{name}_{one}": values[:, i] for i, one in enumerate(("red", "green", "blue"))}
        return columns

    def __getstate__(self) -> dict[str, Any]:
        # Cached results are recomputed, not pickled.
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def __repr__(self) -> str:
        rays = self.history[-1].rays if self.history else 0
        return (
            f"RadiositySolution({len(self)} sides of patches, {self.method}, {rays} rays, "
            f"error {self.error:.2g}, bound {self.bound:.2g})"
        )


def relative_error(standard_error: Floats, values: Floats, areas: Floats) -> float:
    """Return the root mean square, by area, of errors over that of the values."""
    whole = float((areas[:, None] * values**2).sum())
    return float(np.sqrt((areas[:, None] * standard_error**2).sum() / whole)) if whole > 0 else 0.0
