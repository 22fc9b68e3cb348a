"""Light at the surfaces that it comes to, and among media."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import SeedLike, Triple, integer, same, sealed, seed_number, thread_limit

Floats = NDArray[np.float64]
# Bounces recorded, one bit each.
_TOLD = 64


@dataclass(frozen=True, eq=False, repr=False)
class Photons:
    """Photons at surfaces and at scattering events in media: K of them, in order along each path.

    ``photons[mask]`` selects some of them; emitted, escaped and absorbed flux stay those of all photons. All
    arrays are read-only.

    Attributes
    ----------
    positions : (K, 3) float64
        Positions on surfaces, or of absorption or scattering in a medium.
    directions : (K, 3) float64
        Unit directions of travel on arrival.
    normals : (K, 3) float64
        Unit geometric normals on the side of arrival; 0 in a medium.
    powers : (K, 3) float64
        Flux of each photon, W: power over area is irradiance, and power over volume and extinction is
        fluence.
    shape_id, primitive_id : (K,) int32
        Shape and primitive of the surface; -1 in a medium.
    path : (K,) int64
        Index of the path, from 0 on.
    bounces : (K,) int64
        Number of previous scattering events.
    specular : (K,) uint64
        Bits of specular bounces, by mirrors, glass or gloss: the lowest bit for the first bounce, up to 64.
    in_medium : (K,) uint64
        Bits of the bounces in media, in the same order.
    emitted, escaped, absorbed : tuple of 3 floats
        Flux of all emitted light, of light that leaves the scene, and of light absorbed by media. For gray
        materials and media, the balance of each path is exact; otherwise, or with a heterogeneous medium
        without scattering, it holds on average.

    See Also
    --------
    Scene.photons : Makes them.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 1), intensity=1.0)])
    >>> photons = scene.photons(100, max_depth=1)
    >>> arrived = photons.powers.sum(axis=0)
    >>> np.allclose(photons.emitted, arrived + photons.escaped)
    True
    >>> set(photons.chains.tolist())
    {'L'}
    """

    positions: Floats
    directions: Floats
    normals: Floats
    powers: Floats
    shape_id: NDArray[np.int32]
    primitive_id: NDArray[np.int32]
    path: NDArray[np.int64]
    bounces: NDArray[np.int64]
    specular: NDArray[np.uint64]
    in_medium: NDArray[np.uint64]
    emitted: Triple
    escaped: Triple
    absorbed: Triple

    def __post_init__(self) -> None:
        for name in _ARRAYS:
            object.__setattr__(self, name, sealed(getattr(self, name)))

    @classmethod
    def _of(cls, vectors: tuple[Any, ...], numbers: tuple[Any, ...], bits: Any, flux: Any) -> Photons:
        """Return what the core gave."""
        positions, directions, normals, powers = vectors
        shape_id, primitive_id, path, bounces = numbers
        hits = positions, directions, normals, powers, shape_id, primitive_id, path, bounces, *bits
        return cls(*hits, *map(tuple, flux))

    @cached_property
    def chains(self) -> NDArray[np.str_]:
        """Light path of each photon, (K,) str: "L" for the light, then a letter for each bounce.

        "S" is a specular bounce, "V" one in a medium, and "D" any other. The notation is Heckbert's (1990):
        "LS" has come from a lamp by one mirror, "LSS" through a ball of glass, "LVD" by smoke and a wall.
        Only the first 64 bounces are recorded.
        """
        told = min(int(self.bounces.max(initial=0)), _TOLD)
        places = np.arange(told, dtype=np.uint64)
        is_sharp, is_adrift = (
            (bits[:, None] >> places & np.uint64(1)).astype(bool) for bits in (self.specular, self.in_medium)
        )
        letters = np.where(is_adrift, "V", np.where(is_sharp, "S", "D")).astype("U1")
        letters[places[None, :] >= self.bounces[:, None].astype(np.uint64)] = ""
        whole = np.concatenate([np.full((len(self), 1), "L", "U1"), letters], axis=1)
        return sealed(np.ascontiguousarray(whole).view(f"U{told + 1}")[:, 0])

    def __len__(self) -> int:
        return len(self.path)

    def __getitem__(self, which: Any) -> Photons:
        chosen: dict[str, Any] = {name: np.atleast_1d(getattr(self, name)[which]) for name in _ARRAYS[4:]}
        chosen |= {name: getattr(self, name)[which].reshape(-1, 3) for name in _ARRAYS[:4]}
        return replace(self, **chosen)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Photons):
            return NotImplemented
        arrays = all(same(getattr(self, name), getattr(other, name)) for name in _ARRAYS)
        return arrays and all(getattr(self, name) == getattr(other, name) for name in _FLUXES)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        paths = len(np.unique(self.path))
        return f"Photons({len(self)} on {paths} paths, {sum(self.emitted) / 3:.4g} W emitted)"


_FLUXES = ("emitted", "escaped", "absorbed")
_ARRAYS = tuple(field.name for field in fields(Photons) if field.name not in _FLUXES)


def photon_arguments(
    count: int, max_depth: int | None, roulette_depth: int, seed: SeedLike, threads: int | None
) -> tuple[int, int | None, int, int, int | None]:
    """Return the arguments of `LightQueries.photons`, checked."""
    return (
        integer("count", count, 1, 2**31 - 1),
        None if max_depth is None else integer("max_depth", max_depth, 1, 2**32 - 1),
        integer("roulette_depth", roulette_depth, 0, 2**32 - 1),
        seed_number(seed),
        thread_limit(threads),
    )
