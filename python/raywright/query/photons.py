"""Light at the surfaces that it comes to."""

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple, integer
from .hits import same, sealed

Floats = NDArray[np.float64]
# Bounces that are told apart: a bit each.
_TOLD = 64


@dataclass(frozen=True, eq=False, repr=False)
class Photons:
    """Light at the surfaces that it comes to: K photons, path by path, and along each in order.

    ``photons[mask]`` has some of them; `emitted` and `escaped` stay those of all. All arrays are read-only.

    Attributes
    ----------
    positions : (K, 3) float64
        Where they came to a surface.
    directions : (K, 3) float64
        Unit, along which they came.
    normals : (K, 3) float64
        Unit geometric normals there, on the side that they came to.
    powers : (K, 3) float64
        The flux, W, that each stands for: power over area is irradiance.
    shape_id, primitive : (K,) int32
        Which shape they came to, and which primitive of it.
    path : (K,) int64
        On which path, from 0 on.
    bounces : (K,) int64
        At how many surfaces they were scattered before.
    sharp : (K,) uint64
        At which of these sharply, by mirrors, glass or gloss: a bit each, of the first 64, the lowest for the
        first.
    emitted, escaped : tuple of 3 floats
        The flux of all light that sets out, and what of it leaves the scene.
    """

    positions: Floats
    directions: Floats
    normals: Floats
    powers: Floats
    shape_id: NDArray[np.int32]
    primitive: NDArray[np.int32]
    path: NDArray[np.int64]
    bounces: NDArray[np.int64]
    sharp: NDArray[np.uint64]
    emitted: Triple
    escaped: Triple

    def __post_init__(self) -> None:
        for name in _ARRAYS:
            object.__setattr__(self, name, sealed(getattr(self, name)))

    @classmethod
    def of(cls, vectors: tuple[Any, ...], numbers: tuple[Any, ...], sharp: Any, flux: Any) -> "Photons":
        """Return what the core gave."""
        positions, directions, normals, powers = vectors
        shape_id, primitive, path, bounces = numbers
        hits = positions, directions, normals, powers, shape_id, primitive, path, bounces, sharp
        return cls(*hits, *map(tuple, flux))

    @cached_property
    def chains(self) -> NDArray[np.str_]:
        """The ways that they took, (K,) str: "L" for the light, then a letter for each bounce.

        "S" is a sharp one and "D" any other. The notation is Heckbert's (1990): "LS" has come from a lamp by
        one mirror, "LSS" through a ball of glass. Of more than 64 bounces the first are told.
        """
        told = min(int(self.bounces.max(initial=0)), _TOLD)
        places = np.arange(told, dtype=np.uint64)
        is_sharp = (self.sharp[:, None] >> places & np.uint64(1)).astype(bool)
        letters = np.where(is_sharp, "S", "D").astype("U1")
        letters[places[None, :] >= self.bounces[:, None].astype(np.uint64)] = ""
        whole = np.concatenate([np.full((len(self), 1), "L", "U1"), letters], axis=1)
        return sealed(np.ascontiguousarray(whole).view(f"U{told + 1}")[:, 0])

    def __len__(self) -> int:
        return len(self.path)

    def __getitem__(self, which: Any) -> "Photons":
        chosen: dict[str, Any] = {name: np.atleast_1d(getattr(self, name)[which]) for name in _ARRAYS[4:]}
        chosen |= {name: getattr(self, name)[which].reshape(-1, 3) for name in _ARRAYS[:4]}
        return replace(self, **chosen)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Photons):
            return NotImplemented
        arrays = all(same(getattr(self, name), getattr(other, name)) for name in _ARRAYS)
        return arrays and (self.emitted, self.escaped) == (other.emitted, other.escaped)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        paths = len(np.unique(self.path))
        return f"Photons({len(self)} on {paths} paths, {sum(self.emitted) / 3:.4g} W emitted)"


_ARRAYS = tuple(field.name for field in fields(Photons) if field.name not in ("emitted", "escaped"))


def photon_arguments(
    count: int, max_depth: int | None, roulette_depth: int, seed: int, threads: int | None
) -> tuple[int, int | None, int, int, int | None]:
    """Return the arguments of `Queries.photons`, checked."""
    return (
        integer("count", count, 1, 2**31 - 1),
        None if max_depth is None else integer("max_depth", max_depth, 1, 2**32 - 1),
        integer("roulette_depth", roulette_depth, 0, 2**32 - 1),
        integer("seed", seed, 0, 2**64 - 1),
        None if threads is None else integer("threads", threads, 1),
    )
