"""A medium that differs from place to place."""

from dataclasses import dataclass, fields
from os import PathLike
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import Triple, choice, real_array
from ..textures.spectrum import Spectrum, colour_or_spectrum
from .files import read_density
from .medium import Medium
from .phases import Isotropic, Phase
from .phases import phase as checked

At: TypeAlias = Literal["corners", "centres"]
Numbers: TypeAlias = NDArray[np.float32]
_UNIT = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))


@dataclass(frozen=True, init=False, eq=False, repr=False)
class GridMedium(Medium):
    """A medium whose density is given on a regular grid: smoke, fire, a cloud.

    It does to light what its coefficients say, times the density, which is interpolated linearly along each
    axis. Outside of the grid there is nothing. The grid lies in the space that its shape is described in; in
    an `Instance` it goes where the copy goes, and lengths are those of the world there too.

    Parameters
    ----------
    density : (X, Y, Z) array
        Numbers that are finite and at least 0, kept as read-only float32; those that are so already are not
        copied. The first axis is x.
    bounds : (2, 3) array, optional
        Least and greatest corner of the grid; the unit cube if not given.
    transform : (4, 4) array, optional
        What takes the grid elsewhere from there.
    absorption, scattering : float, 3 floats or Spectrum
        The share of light that is absorbed, and scattered, per unit of length where the density is 1.
    phase : HenyeyGreenstein, Rayleigh or Isotropic
        Into which directions it scatters.
    emission : float, 3 floats, or array of shape (X', Y', Z') or (X', Y', Z', 3)
        The radiance that it gives off by itself, per unit of length: numbers where the density is 1, or an
        array, over the same bounds, whatever the density.
    at : {"corners", "centres"}
        Where the numbers stand. "corners": those of the outermost lie on the faces of the bounds. "centres":
        each is in the middle of a cell, and the same up to the face, as OpenVDB's, pbrt's and Mitsuba's are.

    Raises
    ------
    ValueError
        If something is negative, not finite, or of another shape, or a transform has no inverse.
    TypeError
        If something is not of the kinds above.
    """

    density: Numbers
    bounds: tuple[Triple, Triple]
    transform: NDArray[np.float64] | None
    absorption: Triple | Spectrum
    scattering: Triple | Spectrum
    phase: Phase
    emission: Triple | Spectrum | Numbers
    at: At

    def __init__(
        self,
        density: ArrayLike,
        bounds: ArrayLike | None = None,
        *,
        transform: ArrayLike | None = None,
        absorption: ArrayLike | Spectrum = 0.0,
        scattering: ArrayLike | Spectrum = 0.0,
        phase: Phase = Isotropic(),  # noqa: B008
        emission: ArrayLike | Spectrum = 0.0,
        at: At = "corners",
    ) -> None:
        choice("at", at, get_args(At))
        glow = emission if isinstance(emission, Spectrum) else real_array("emission", emission)
        values = {
            "density": _numbers("density", density, (3,)),
            "bounds": _UNIT if bounds is None else _bounds(bounds),
            "transform": None if transform is None else _transform(transform),
            "absorption": colour_or_spectrum("absorption", absorption),
            "scattering": colour_or_spectrum("scattering", scattering),
            "phase": checked("phase", phase),
            "emission": _numbers("emission", glow, (3, 4))
            if isinstance(glow, np.ndarray) and glow.ndim >= 3
            else colour_or_spectrum("emission", glow),
            "at": at,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @classmethod
    def load(
        cls, path: str | PathLike[str], bounds: ArrayLike | None = None, **arguments: Any
    ) -> "GridMedium":
        """Read the density from a file, with all else as the arguments of `GridMedium` say.

        Parameters
        ----------
        path : str or path
            A file of numpy's (``.npy``), or of Mitsuba's (``.vol``, version 3, of one channel of float32).
        bounds : (2, 3) array, optional
            Those of the grid, in place of what the file says of them.
        **arguments
            Of `GridMedium`, by name. `at` is "centres" for Mitsuba's files, if it is not given.

        Returns
        -------
        GridMedium

        Raises
        ------
        FileNotFoundError
            If there is no such file.
        ValueError
            If it cannot be read, and why; and as `GridMedium` does.
        TypeError
            As `GridMedium` does.
        """
        density, found = read_density(path)
        if found is not None:
            arguments = {"at": "centres", **arguments}
        return cls(density, found if bounds is None else bounds, **arguments)

    def _place(self) -> list[list[float]]:
        """Give the first three rows of what takes the unit cube to the grid."""
        low, high = np.asarray(self.bounds)
        matrix = np.diag([*(high - low), 1.0])
        matrix[:3, 3] = low
        placed = matrix if self.transform is None else self.transform @ matrix
        return [[float(number) for number in row] for row in placed[:3]]

    def _glow(self) -> Numbers | None:
        """Give what is given off whatever the density, (X, Y, Z, 3), if that is an array."""
        if not isinstance(self.emission, np.ndarray):
            return None
        given = self.emission if self.emission.ndim == 4 else self.emission[..., None]
        return np.ascontiguousarray(np.broadcast_to(given, (*given.shape[:3], 3)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, GridMedium):
            return NotImplemented
        pairs = ((getattr(self, f.name), getattr(other, f.name)) for f in fields(self))
        return all(
            type(a) is type(b) and (np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b)
            for a, b in pairs
        )

    def __hash__(self) -> int:
        return hash((self.density.shape, self.bounds, self.absorption, self.scattering, self.phase, self.at))

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, because an unpickled array would be writeable.
        return _made, tuple(getattr(self, field.name) for field in fields(self))

    def __repr__(self) -> str:
        parts = [_told(self.density)]
        for name, usual in _USUAL.items():
            value = getattr(self, name)
            if isinstance(value, np.ndarray) or value != usual:
                parts.append(f"{name}={_told(value)}")
        return f"GridMedium({', '.join(parts)})"


_USUAL: dict[str, Any] = {
    "bounds": _UNIT,
    "transform": None,
    "absorption": (0.0, 0.0, 0.0),
    "scattering": (0.0, 0.0, 0.0),
    "phase": Isotropic(),
    "emission": (0.0, 0.0, 0.0),
    "at": "corners",
}


def _made(density: Numbers, bounds: Any, *rest: Any) -> GridMedium:
    names = ("transform", "absorption", "scattering", "phase", "emission", "at")
    return GridMedium(density, bounds, **dict(zip(names, rest, strict=True)))


def _told(value: Any) -> str:
    if not isinstance(value, np.ndarray):
        return repr(value)
    return repr(value.tolist()) if value.shape == (4, 4) else f"<{' x '.join(map(str, value.shape))}>"


def _numbers(name: str, value: ArrayLike, dimensions: tuple[int, ...]) -> Numbers:
    array = real_array(name, value)
    shape = "(X, Y, Z) or (X, Y, Z, 3)" if 4 in dimensions else "(X, Y, Z)"
    if array.ndim not in dimensions or (array.ndim == 4 and array.shape[3] != 3) or 0 in array.shape:
        raise ValueError(f"{name} must have shape {shape}, and not be empty, got {array.shape}")
    single = array
    if array.dtype != np.float32 or not array.flags.c_contiguous or array.flags.writeable:
        # What float32 cannot hold becomes infinite, and is told.
        with np.errstate(over="ignore"):
            single = array.astype(np.float32, order="C", copy=True, subok=False)
        single.setflags(write=False)
    # NaN passes on through both.
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
