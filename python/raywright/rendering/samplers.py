"""Where the random numbers of a picture come from.

The numbers of each sample are uniform, and those of its dimensions independent, for every kind: pictures
differ in their noise only. Those with a `batch` spread that many consecutive samples of a pixel evenly among
each other; batches are independent, and the spread between them gives the error. `render` takes lattices in
few large batches unless another is named.
"""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import integer

_MOST = 64


@dataclass(frozen=True)
class Independent:
    """Independent random numbers: Philox4x32-10 (Salmon et al. 2011).

    See Also
    --------
    Sobol, Lattice, Halton, Stratified

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> image = rw.render(scene, camera, samples=4, sampler=rw.rendering.Independent(), progress=False)
    >>> image.plan.sampler
    Independent()
    """


@dataclass(frozen=True)
class Stratified:
    """Jittered grids, with one point in each row and column of the finer grid too.

    Multi-jittered sampling (Chiu, Shirley and Wang 1994), correlated as in Kensler (2013).

    Parameters
    ----------
    batch : int, optional
        Samples of a batch: 1, 2, 4, ... 64. If not given, a quarter of the requested samples, or of the
        number that an error limit is likely to take; at most 16 with a time limit; half of that if adaptive.
        ``image.plan`` reports it.

    Raises
    ------
    ValueError
        If `batch` is not a power of two, or out of range.
    TypeError
        If it is not an integer.

    See Also
    --------
    Sobol, Lattice, Halton, Independent

    Examples
    --------
    >>> rw.rendering.Stratified(batch=16)
    Stratified(batch=16)
    """

    batch: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "batch", _batch(self.batch))


@dataclass(frozen=True)
class Halton:
    """Radical inverses in prime bases (Halton 1960), scrambled as Owen (1995) does.

    Pairs of dimensions have the bases 2 and 3, 5 and 7, ... 47 and 53, and then these again.

    Parameters
    ----------
    batch : int, optional
        Samples of a batch: 1, 2, 4, ... 64. If not given, a quarter of the requested samples, or of the
        number that an error limit is likely to take; at most 16 with a time limit; half of that if adaptive.
        ``image.plan`` reports it.

    Raises
    ------
    ValueError
        If `batch` is not a power of two, or out of range.
    TypeError
        If it is not an integer.

    See Also
    --------
    Sobol, Lattice, Stratified, Independent

    Examples
    --------
    >>> rw.rendering.Halton(batch=16)
    Halton(batch=16)
    """

    batch: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "batch", _batch(self.batch))


@dataclass(frozen=True)
class Sobol:
    """Sobol's (0, 2)-sequence (1967), scrambled as Owen (1995) does, anew for each pair of dimensions.

    The choice of a light is stratified jointly with the point on it.

    Parameters
    ----------
    batch : int, optional
        Samples of a batch: 1, 2, 4, ... 64. If not given, a quarter of the requested samples, or of the
        number that an error limit is likely to take; at most 16 with a time limit; half of that if adaptive.
        ``image.plan`` reports it.

    Raises
    ------
    ValueError
        If `batch` is not a power of two, or out of range.
    TypeError
        If it is not an integer.

    See Also
    --------
    Lattice : The default where batches are larger.
    Halton, Stratified, Independent

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> image = rw.render(scene, camera, samples=16, sampler=rw.rendering.Sobol(batch=4), progress=False)
    >>> image.plan.sampler
    Sobol(batch=4)
    """

    batch: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "batch", _batch(self.batch))


@dataclass(frozen=True)
class Lattice:
    """Rank-1 lattices, each shifted at random (Cranley and Patterson 1976).

    The generators are those of the least P2 (Sloan and Joe 1994). Errors are smaller than with `Sobol` for
    most batches; the points of a batch of 4 lie on a diagonal, and are worse.

    Parameters
    ----------
    batch : int, optional
        Samples of a batch: 1, 2, 4, ... 64. If not given, a quarter of the requested samples, or of the
        number that an error limit is likely to take; at most 16 with a time limit; half of that if adaptive.
        ``image.plan`` reports it.

    Raises
    ------
    ValueError
        If `batch` is not a power of two, or out of range.
    TypeError
        If it is not an integer.

    See Also
    --------
    Sobol : The default where batches are small.
    Halton, Stratified, Independent

    Examples
    --------
    >>> rw.rendering.Lattice(batch=8)
    Lattice(batch=8)
    """

    batch: int | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "batch", _batch(self.batch))


Sampler = Independent | Stratified | Halton | Sobol | Lattice


@dataclass(frozen=True)
class Unnamed:
    """No sampler, with the reason for the plan of a picture."""

    why: str


def _batch(batch: int | None) -> int | None:
    if batch is None:
        return None
    size = integer("batch", batch, 1, _MOST)
    if size & (size - 1):
        raise ValueError(f"batch must be a power of two, got {batch}")
    return size
