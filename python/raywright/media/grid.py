"""A medium that differs from place to place."""

from __future__ import annotations

from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Triple, choice, number, real_array
from ..descriptions import restored, state
from ..textures.spectrum import Spectrum, color_or_spectrum
from .files import read_grids
from .medium import Medium
from .phases import Isotropic, Phase
from .phases import phase as checked
from .sparse_grid import SparseGrid

At: TypeAlias = Literal["corners", "centers"]
Numbers: TypeAlias = NDArray[np.float32] | SparseGrid
_ONE, _MANY = (3,), (3, 4)
_NONE = (0.0, 0.0, 0.0)
_UNIT = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class GridMedium(Medium):
    """A medium whose density is given on a regular grid: smoke, fire, a cloud.

    Its coefficients are multiplied by the density, which is interpolated linearly along each axis. Outside of
    the grid the density is 0. The grid is in the same space as its shape; in an `Instance` it moves with the
    copy, and lengths are in world units.

    Parameters
    ----------
    density : (X, Y, Z) or (X, Y, Z, 3) array, or SparseGrid
        Numbers that are finite and at least 0, for all colors or for each of red, green and blue, kept as
        read-only float32; such arrays are not copied. The first axis is x.
    bounds : (2, 3) array, optional
        Least and greatest corner of the grid; the unit cube if not given.
    transform : (4, 4) array, optional
        Transform of the grid from there.
    absorption, scattering : float, 3 floats or Spectrum
        The share of light that is absorbed, and scattered, per unit of length where the density is 1.
    phase : HenyeyGreenstein, Rayleigh or Isotropic
        Phase function.
    emission : float, 3 floats, Spectrum, array of (X', Y', Z') or (X', Y', Z', 3), or SparseGrid
        Emitted radiance per unit of length. Numbers are for a density of 1; an array, over the same bounds,
        is independent of the density.
    at : {"corners", "centers"}
        Positions of the numbers. "corners": the outermost numbers lie on the faces of the bounds. "centers":
        each number is in the middle of a cell, and constant from there to the faces of the bounds, as in
        OpenVDB, pbrt and Mitsuba.
    extinction : float, 3 floats or Spectrum
        With `albedo`, and in place of `absorption` and `scattering`: the share of light that is absorbed or
        scattered per unit of length where the density is 1.
    albedo : (X', Y', Z') or (X', Y', Z', 3) array, or SparseGrid, optional
        Scattered share of the extinction, at most 1, over the same bounds.
    temperature : (X', Y', Z') array or SparseGrid, optional
        Kelvin, over the same bounds. Hot points emit like a black body, in proportion to their absorption
        (Kirchhoff 1860); points below 500 K emit nothing.
    brightness : float
        Radiance of a black body at the wavelength of its maximum, as pbrt's ``Lescale``; 1 is the radiance of
        a `Spectrum` with a value of 1. The maximum of a cool body is in the infrared, so the visible part
        rises with the temperature, up to about that of the sun.

    Raises
    ------
    ValueError
        If an array is negative, not finite, or of another shape, a transform has no inverse, or an albedo
        exceeds 1 or does not come with an extinction alone.
    TypeError
        If an argument has another type.

    See Also
    --------
    SparseGrid : A grid of few numbers above 0.
    Homogeneous : The same everywhere.

    Examples
    --------
    >>> density = np.ones((4, 4, 4), np.float32)
    >>> fog = rw.GridMedium(density, bounds=[[0, 0, 0], [2, 1, 1]], absorption=0.5)
    >>> box = rw.Box((0, 0, 0), (2, 1, 1), material=rw.MediumInterface(fog))
    >>> rw.Scene(box).optical_depth([-1, 0.5, 0.5], [1, 0, 0]).round(6).tolist()
    [1.0, 1.0, 1.0]
    """

    density: Numbers
    bounds: tuple[Triple, Triple]
    transform: NDArray[np.float64] | None
    absorption: Triple | Spectrum
    scattering: Triple | Spectrum
    phase: Phase
    emission: Triple | Spectrum | Numbers
    at: At
    extinction: Triple | Spectrum
    albedo: Numbers | None
    temperature: Numbers | None
    brightness: float

    def __init__(
        self,
        density: ArrayLike | SparseGrid,
        bounds: ArrayLike | None = None,
        *,
        transform: ArrayLike | None = None,
        absorption: ArrayLike | Spectrum = 0.0,
        scattering: ArrayLike | Spectrum = 0.0,
        phase: Phase = Isotropic(),  # noqa: B008
        emission: ArrayLike | Spectrum | SparseGrid = 0.0,
        at: At = "corners",
        extinction: ArrayLike | Spectrum = 0.0,
        albedo: ArrayLike | SparseGrid | None = None,
        temperature: ArrayLike | SparseGrid | None = None,
        brightness: float = 1.0,
    ) -> None:
        choice("at", at, get_args(At))
        values: dict[str, Any] = {
            "density": _numbers("density", density, _MANY),
            "bounds": _UNIT if bounds is None else _bounds(bounds),
            "transform": None if transform is None else _transform(transform),
            "absorption": color_or_spectrum("absorption", absorption),
            "scattering": color_or_spectrum("scattering", scattering),
            "phase": checked("phase", phase),
            "emission": _emission(emission),
            "at": at,
            "extinction": color_or_spectrum("extinction", extinction),
            "albedo": None if albedo is None else _numbers("albedo", albedo, _MANY),
            "temperature": None if temperature is None else _numbers("temperature", temperature, _ONE),
            "brightness": number("brightness", brightness),
        }
        if values["brightness"] < 0:
            raise ValueError(f"brightness must be at least 0, got {brightness}")
        _one_of_both(values)
        if isinstance(values["emission"], np.ndarray | SparseGrid) and temperature is not None:
            raise ValueError("emission must be one number or 3 where there is a temperature, got a grid")
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @classmethod
    def load(
        cls,
        path: str | PathLike[str],
        bounds: ArrayLike | None = None,
        *,
        density: str = "density",
        **arguments: Any,
    ) -> GridMedium:
        """Read the density from a file, with the other arguments of `GridMedium`.

        Parameters
        ----------
        path : str or path
            A file of numpy's (``.npy``), Mitsuba's (``.vol``, version 3, of one or three channels of
            float32), or OpenVDB's (``.vdb``, of float grids). Most of the last are compressed by Blosc, and
            need ``pip install 'raywright[vdb]'``.
        bounds : (2, 3) array, optional
            Bounds of the grid, in place of the file's.
        density : str
            Name of the density grid of an OpenVDB file. `emission`, `albedo` and `temperature` may be names
            of grids of that file, too.
        **arguments
            Of `GridMedium`, by name. `at` is "centers" for files other than numpy's, if it is not given.

        Returns
        -------
        GridMedium

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ImportError
            If it is compressed by Blosc, and the package numcodecs is not installed.
        ValueError
            If it cannot be read, and why; also as raised by `GridMedium`.
        TypeError
            As `GridMedium` does.

        See Also
        --------
        SparseGrid.of : Arrays larger than memory.

        Examples
        --------
        >>> np.save("smoke.npy", np.full((2, 2, 2), 0.5, np.float32))
        >>> smoke = rw.GridMedium.load("smoke.npy", scattering=1.0)
        >>> box = rw.Box((0, 0, 0), (1, 1, 1), material=rw.MediumInterface(smoke))
        >>> rw.Scene(box).optical_depth([0.5, 0.5, 5], [0, 0, -1]).round(6).tolist()
        [0.5, 0.5, 0.5]
        """
        named = {
            name: given for name, given in arguments.items() if isinstance(given, str) and name in _GRIDS
        }
        found = read_grids(path, {"density": density, **named})
        places = {} if bounds is not None else found.place
        return cls(**{"bounds": bounds, **places, **found.told, **arguments, **found.grids})

    def _place(self) -> list[list[float]]:
        """Return the first three rows of the transform from the unit cube to the grid."""
        low, high = np.asarray(self.bounds)
        matrix = np.diag([*(high - low), 1.0])
        matrix[:3, 3] = low
        placed = matrix if self.transform is None else self.transform @ matrix
        return [[float(number) for number in row] for row in placed[:3]]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GridMedium):
            return NotImplemented
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return all(
            type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b)
            for a, b in pairs
        )

    def __hash__(self) -> int:
        told = (self.absorption, self.scattering, self.extinction, self.phase, self.at)
        return hash((self.density.shape, self.bounds, *told))

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (type(self), state(self))

    def __repr__(self) -> str:
        parts = [_told(self.density)]
        for name, usual in _USUAL.items():
            value = getattr(self, name)
            if isinstance(value, np.ndarray | SparseGrid) or value != usual:
                parts.append(f"{name}={_told(value)}")
        return f"GridMedium({', '.join(parts)})"


_USUAL: dict[str, Any] = {
    "bounds": _UNIT,
    "transform": None,
    "absorption": _NONE,
    "scattering": _NONE,
    "phase": Isotropic(),
    "emission": _NONE,
    "at": "corners",
    "extinction": _NONE,
    "albedo": None,
    "temperature": None,
    "brightness": 1.0,
}
_GRIDS = ("emission", "albedo", "temperature")


def _told(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return repr(value)
    return repr(value.tolist()) if value.shape == (4, 4) else f"<{' x '.join(map(str, value.shape))}>"


def _emission(given: ArrayLike | Spectrum | SparseGrid) -> Triple | Spectrum | Numbers:
    is_grid = isinstance(given, SparseGrid) or (
        not isinstance(given, Spectrum) and real_array("emission", given).ndim >= 3
    )
    return _numbers("emission", given, _MANY) if is_grid else color_or_spectrum("emission", given)  # type: ignore[arg-type]


def _one_of_both(values: dict[str, Any]) -> None:
    """Check that there is either absorption and scattering, or extinction and albedo."""
    albedo = values["albedo"]
    if albedo is None and values["extinction"] != _NONE:
        raise ValueError("extinction must come with an albedo; else give absorption and scattering")
    if albedo is not None and (values["absorption"] != _NONE or values["scattering"] != _NONE):
        raise ValueError("absorption and scattering must be 0 with an albedo, which comes with an extinction")
    if albedo is not None and albedo.max() > 1:
        raise ValueError(f"albedo must be at most 1, got {albedo.max():.6g}")


def _numbers(name: str, value: ArrayLike | SparseGrid, dimensions: tuple[int, ...]) -> Numbers:
    if isinstance(value, SparseGrid):
        if len(value.shape) not in dimensions:
            raise ValueError(f"{name} must have shape (X, Y, Z), got {value.shape}")
        return value
    array = real_array(name, value)
    shape = "(X, Y, Z) or (X, Y, Z, 3)" if 4 in dimensions else "(X, Y, Z)"
    if array.ndim not in dimensions or (array.ndim == 4 and array.shape[3] != 3) or 0 in array.shape:
        raise ValueError(f"{name} must have shape {shape}, and not be empty, got {array.shape}")
    single = array
    if array.dtype != np.float32 or not array.flags.c_contiguous or array.flags.writeable:
        # Overflow to infinity is reported below.
        with np.errstate(over="ignore"):
            single = array.astype(np.float32, order="C", copy=True, subok=False)
        single.setflags(write=False)
    # NaN fails both comparisons.
    if not (single.min() >= 0 and single.max() < np.inf):
        place = np.argwhere(~((single >= 0) & (single < np.inf)))[0]
        came, where = float(array[tuple(place)]), place.tolist()
        raise ValueError(f"{name} must be finite and at least 0, got {came} at {where}")
    return single


def _bounds(value: ArrayLike) -> tuple[Triple, Triple]:
    array = real_array("bounds", value)
    if array.shape != (2, 3):
        raise ValueError(f"bounds must have shape (2, 3), got {array.shape}")
    if not (np.isfinite(array).all() and (array[0] < array[1]).all()):
        raise ValueError(f"bounds must be finite, the first corner below the second, got {array.tolist()}")
    low, high = ((float(x), float(y), float(z)) for x, y, z in array)
    return low, high


def _transform(value: ArrayLike) -> NDArray[np.float64]:
    array = real_array("transform", value).astype(np.float64)
    if array.shape != (4, 4):
        raise ValueError(f"transform must have shape (4, 4), got {array.shape}")
    if not (np.isfinite(array).all() and (array[3] == (0, 0, 0, 1)).all()):
        raise ValueError("transform must be finite, and its last row 0, 0, 0, 1")
    array.setflags(write=False)
    return array
