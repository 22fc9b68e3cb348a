"""Shapes put in many places."""

from __future__ import annotations

import bisect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate
from os import PathLike
from typing import Any, NamedTuple, TypeAlias, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..accelerators import BVH, Accelerator
from ..arrays import frozen, integer, label, real_array
from ..descriptions import as_kind
from ..shapes import Shape
from ..shapes.mesh import Mesh, face_count, stretched
from ..shapes.sources import EXPECTED, leaves, meshes_of, named, refused
from ..shapes.welding import Weld, welded

AnyShape = Union[Mesh, Shape, "Instance"]
# Objects of other libraries have no type here, since none of these libraries need be installed.
Shapes: TypeAlias = Union[AnyShape, str, PathLike[str], "Sequence[Shapes]", "Mapping[str, Shapes]", Any]
Places: TypeAlias = NDArray[np.integer[Any]]
_BVH = BVH()
_MOST = 2**31


class Location(NamedTuple):
    """Where a primitive of an instance is.

    Attributes
    ----------
    path : tuple of (int, int)
        For instances within the instance, from the outside in: which of its shapes is an instance, and which
        copy of that. Empty where there is none.
    shape : Mesh or another shape
        The shape that the primitive is of.
    shape_id : int
        Index among the ``shapes`` of the innermost instance.
    face : int
        Face of the shape; 0 if the shape is not a mesh.
    """

    path: tuple[tuple[int, int], ...]
    shape: Mesh | Shape
    shape_id: int
    face: int


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Instance:
    """Shapes copied to one place or to many, compiled once: a copy takes some 150 bytes.

    Materials and emission are those of the shapes. Emission of copies that stand still, at most 4096 in all,
    is sampled as a light, each face of each copy by itself. Emission of other copies (moving, nested, or more
    of them) is not sampled: only paths that hit it find it, so avoid small bright lights there.

    Parameters
    ----------
    shapes : Mesh or another shape, Instance, path, object of another library, or list or dict of these
        Shapes to copy: everything that a `Scene` takes. Instances of identical objects share the compiled
        form.
    transform : (4, 4) or (N, 4, 4) array
        Transforms of the copies: affine matrices that act on column vectors (x, y, z, 1), each with (0, 0, 0,
        1) as its last row, and invertible.
    transform_end : array of the same shape, optional
        Transforms as the shutter closes, for copies that move. At a time between 0 and 1 the matrix is
        ``transform + (transform_end - transform) * time``, number by number: every point moves on a straight
        line, so large rotations need several steps. At times without an inverse matrix, the copy is
        invisible.
    accelerator : BVH or another accelerator, optional
        The accelerator over the shapes; ``BVH()`` if not given.
    name : str, optional
        Name that `Hits.names` returns for every hit in the instance.

    Raises
    ------
    ValueError
        If a matrix has the wrong shape, is not finite, has another last row or no inverse, or is too badly
        conditioned for rays to keep their digits (the error says which and why), or there are 2^31 primitives
        or more, all copies within counted.
    TypeError
        If an argument has another type.

    See Also
    --------
    Scene : Takes instances beside other shapes.
    scenes.forest : A scene of 100,000 copies.

    Notes
    -----
    ``hits.instance_id`` is the index of the copy. ``hits.primitive_id`` numbers all primitives of a copy,
    shape after shape: the faces of a mesh, or for each copy of a nested instance all of its primitives.
    `locate` decodes such a number.

    Rays are transformed to the space of the shapes by the inverse of the matrix, rounded to float64, and hits
    are exact for the transformed ray. Compared with transformed vertices, hits differ by the rounding of
    these vertices, and not at all if neither is rounded, as with integers and powers of two. The difference
    grows with the condition of the matrix: the greatest row sum of ``|L| |L⁻¹|`` for its linear part ``L``.
    It is at most 3 for a scaling along the axes followed by a rotation; above 2^20 a matrix is refused.

    ``contains`` includes closed surfaces of copies, and ``closest_point`` all of their surfaces.

    Examples
    --------
    >>> places = np.tile(np.eye(4), (3, 1, 1))
    >>> places[:, 0, 3] = [0, 5, 10]
    >>> scene = rw.Scene(rw.Instance(rw.Sphere(), places, name="row"))
    >>> hits = scene.intersect([[0, 0, 3], [10, 0, 3], [20, 0, 3]], [0, 0, -1])
    >>> hits.instance_id.tolist(), hits.t.tolist()
    ([0, 2, -1], [2.0, 2.0, inf])
    """

    shapes: tuple[AnyShape, ...]
    transform: NDArray[np.float64]
    transform_end: NDArray[np.float64] | None
    accelerator: Accelerator
    name: str | None

    def __init__(
        self,
        shapes: Shapes,
        transform: ArrayLike,
        transform_end: ArrayLike | None = None,
        accelerator: Accelerator | None = None,
        name: str | None = None,
    ) -> None:
        start = _matrices("transform", transform)
        end = None if transform_end is None else _matrices("transform_end", transform_end)
        if end is not None and end.shape != start.shape:
            raise ValueError(f"transform_end must have shape {start.shape} as transform, got {end.shape}")
        if accelerator is not None and not isinstance(accelerator, Accelerator):
            raise TypeError(f"accelerator must be a raywright accelerator, got {type(accelerator).__name__}")
        values = {
            "shapes": meshes(shapes),
            "transform": start,
            "transform_end": end,
            "accelerator": _BVH if accelerator is None else accelerator,
            "name": label("name", name),
        }
        for field, value in values.items():
            object.__setattr__(self, field, value)
        if self.primitives >= _MOST:
            told = f"{self.primitives} primitives, all copies in it counted"
            raise ValueError(f"an instance must hold fewer than 2^31 primitives, got {told}")
        if len(self) >= _MOST:
            raise ValueError(f"transform must have fewer than 2^31 matrices, got {len(self)}")

    def __len__(self) -> int:
        return 1 if self.transform.ndim == 2 else len(self.transform)

    @cached_property
    def _first(self) -> tuple[int, ...]:
        """Where the primitives of each shape begin, and how many there are."""
        sizes = (
            len(shape) * shape.primitives if isinstance(shape, Instance) else _count(shape)
            for shape in self.shapes
        )
        return (0, *accumulate(sizes))

    @property
    def primitives(self) -> int:
        """Number of primitives in one copy, nested copies included."""
        return self._first[-1]

    def locate(self, primitive_id: int) -> Location:
        """Decode a number of ``hits.primitive_id``.

        Parameters
        ----------
        primitive_id : int
            Number of a primitive of one copy, as in ``hits.primitive_id``.

        Returns
        -------
        Location
            The nested instances, the shape, its index, and its face.

        Raises
        ------
        ValueError
            If `primitive_id` is negative or not below `primitives`.
        TypeError
            If `primitive_id` is not an integer.

        See Also
        --------
        Instance.parts : Decode an array of numbers.

        Examples
        --------
        >>> copies = rw.Instance([rw.Sphere(), rw.Box()], np.eye(4))
        >>> copies.locate(1).shape_id
        1
        >>> copies.locate(1).shape == rw.Box()
        True
        """
        rest = integer("primitive_id", primitive_id, 0, self.primitives - 1)
        within = self
        path: list[tuple[int, int]] = []
        while True:
            shape_id = bisect.bisect_right(within._first, rest) - 1
            rest -= within._first[shape_id]
            shape = within.shapes[shape_id]
            if not isinstance(shape, Instance):
                return Location(tuple(path), shape, shape_id, rest)
            copy, rest = divmod(rest, shape.primitives)
            path.append((shape_id, copy))
            within = shape

    def parts(self, primitive_id: NDArray[np.integer[Any]]) -> Iterator[tuple[AnyShape, Places, Places]]:
        """Yield each shape that primitives belong to, the entries on it, and their numbers in it.

        For a nested instance, the numbers are arguments of its own `parts`.

        Parameters
        ----------
        primitive_id : array of ints
            Numbers of primitives of one copy, as in ``hits.primitive_id``.

        Yields
        ------
        shape : Mesh, another shape or Instance
            One of the shapes that occur.
        which : array of ints
            Indices into `primitive_id` of the entries on this shape.
        number : array of ints
            Their faces on this shape.

        See Also
        --------
        Instance.locate : Decode one number, through nested instances.

        Examples
        --------
        >>> copies = rw.Instance([rw.Sphere(), rw.Box()], np.eye(4))
        >>> for shape, which, number in copies.parts(np.array([1, 0, 1])):
        ...     print(type(shape).__name__, which.tolist(), number.tolist())
        Sphere [1] [0]
        Box [0, 2] [0, 0]
        """
        shape_id = np.searchsorted(self._first, primitive_id, "right") - 1
        for i in np.unique(shape_id):
            which = np.flatnonzero(shape_id == i)
            shape, own = self.shapes[i], primitive_id[which] - self._first[i]
            yield shape, which, own % shape.primitives if isinstance(shape, Instance) else own

    def moved(self, transform: ArrayLike, transform_end: ArrayLike | None = None) -> Instance:
        """Return an instance of the same shapes with other transforms; both share the compiled form.

        Parameters
        ----------
        transform : (4, 4) or (N, 4, 4) array
            Transforms of the copies, as for `Instance`.
        transform_end : array of the same shape, optional
            Transforms as the shutter closes.

        Returns
        -------
        Instance
            With the same shapes, accelerator and name.

        Raises
        ------
        ValueError, TypeError
            As `Instance` does.

        Examples
        --------
        >>> here = rw.Instance(rw.Sphere(), np.eye(4))
        >>> there = here.moved([[1, 0, 0, 7], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])
        >>> rw.Scene(there).bounds.round(3).tolist()
        [[6.0, -1.0, -1.0], [8.0, 1.0, 1.0]]
        """
        result = Instance(self.shapes, transform, transform_end, self.accelerator, self.name)
        if len(result) != len(self):
            raise ValueError(f"transform must have {len(self)} matrices, got {len(result)}")
        return result

    def _parts(self) -> tuple[Any, ...]:
        return self.shapes, self.transform, self.transform_end, self.accelerator, self.name

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Instance):
            return NotImplemented
        pairs = ((self.transform, other.transform), (self.transform_end, other.transform_end))
        return (
            self.accelerator == other.accelerator
            and self.name == other.name
            and all(a is b or (a is not None and b is not None and np.array_equal(a, b)) for a, b in pairs)
            and self.shapes == other.shapes
        )

    def __hash__(self) -> int:
        return hash((self.shapes, self.transform.shape, self.accelerator))

    def __reduce__(self) -> tuple[Any, ...]:
        return _unpickled, (type(self), self._parts())

    def __repr__(self) -> str:
        shapes, copies = len(self.shapes), len(self)
        parts = [
            f"{shapes} shape{'' if shapes == 1 else 's'}",
            f"{copies} {'copy' if copies == 1 else 'copies'}",
        ]
        parts += [] if self.transform_end is None else ["moving"]
        parts += [] if self.name is None else [f"name={self.name!r}"]
        parts += [] if self.accelerator == _BVH else [repr(self.accelerator)]
        return f"Instance({', '.join(parts)})"


def _unpickled(kind: type[Instance], parts: tuple[Any, ...]) -> Instance:
    return as_kind(kind, Instance(*parts))


def _count(shape: Mesh | Shape) -> int:
    """Return how many primitives a shape is: one if it is not a mesh."""
    return face_count(shape) if isinstance(shape, Mesh) else 1


def _matrices(name: str, value: ArrayLike) -> NDArray[np.float64]:
    """Return a read-only copy of (4, 4) or (N, 4, 4) affine matrices that have inverses."""
    array = real_array(name, value).astype(np.float64, copy=False)
    if array.ndim not in (2, 3) or array.shape[-2:] != (4, 4):
        raise ValueError(f"{name} must have shape (4, 4) or (N, 4, 4), got {array.shape}")

    def which(index: int) -> str:
        return name if array.ndim == 2 else f"{name}[{index}]"

    each = array.reshape(-1, 4, 4)
    finite = np.isfinite(each).all(axis=(1, 2))
    if not finite.all():
        raise ValueError(f"{which(int(np.argmin(finite)))} must be finite, got NaN or infinity")
    affine = (each[:, 3] == (0, 0, 0, 1)).all(axis=1)
    if not affine.all():
        first = int(np.argmin(affine))
        row = ", ".join(f"{x:g}" for x in each[first, 3])
        raise ValueError(f"{which(first)} must have (0, 0, 0, 1) as its last row, got ({row})")
    array = frozen(array)
    if (singular := _core.singular_transform(array)) is not None:
        index, why = singular
        kept = " that keeps its digits" if "condition" in why else ""
        raise ValueError(f"{which(index)} must have an inverse{kept}: {why}")
    return array


def meshes(shapes: Any, weld: Weld = "auto") -> tuple[AnyShape, ...]:
    """Lay out all that `Scene` takes, nested lists and dicts of it too, as one flat tuple.

    Corners of converted meshes are welded by `weld`; a distance welds across all meshes.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If a file or an object is not a mesh that can be read.
    TypeError
        If something is none of these.
    """
    found = tuple(_each(shapes, weld))
    return closed(found, weld) if isinstance(weld, int | float) else found


def closed(shapes: Sequence[AnyShape], weld: Weld) -> tuple[AnyShape, ...]:
    """Return shapes with corners of meshes welded, as `welded` does, and those in instances among themselves.

    A distance is that in the scene, in each of the copies.
    """
    return _closed(shapes, weld, {})


def _closed(shapes: Sequence[AnyShape], weld: Weld, known: dict[Any, Any]) -> tuple[AnyShape, ...]:
    result = list(shapes)
    for i, shape in enumerate(shapes):
        if isinstance(shape, Instance):
            own = _weld_within(shape, weld)
            # Instances of the same shapes share their compiled form.
            key = (tuple(map(id, shape.shapes)), own)
            if key not in known:
                known[key] = _closed(shape.shapes, own, known)
            if any(a is not b for a, b in zip(known[key], shape.shapes, strict=True)):
                result[i] = Instance(known[key], *shape._parts()[1:])
    return welded(result, weld)


def _weld_within(instance: Instance, weld: Weld) -> Weld:
    if isinstance(weld, str | bool) or weld is None or not len(instance):
        return weld
    ends = (instance.transform, instance.transform_end)
    return weld / max(stretched(1.0, end[..., :3, :3]) for end in ends if end is not None)


def only_meshes(shapes: Any) -> tuple[Mesh, ...]:
    """Lay out shapes as `meshes` does, where other shapes will not do.

    Raises
    ------
    TypeError
        If one of them is not a mesh; otherwise as `meshes`.
    """
    found = []
    for shape in _each(shapes, "auto"):
        if not isinstance(shape, Mesh):
            raise TypeError(f"only meshes are supported here, got {type(shape).__name__}")
        found.append(shape)
    return tuple(found)


def _each(shapes: Any, weld: Weld) -> Iterator[AnyShape]:
    for name, one in leaves(shapes):
        if isinstance(one, Mesh | Shape | Instance):
            yield named(one, name)
            continue
        found = meshes_of(one, weld, name=name)
        if found is None:
            raise refused("shapes", EXPECTED, one, name)
        yield from found
