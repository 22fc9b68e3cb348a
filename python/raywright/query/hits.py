"""What rays hit."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from . import rows
from .masks import names_of
from .plotted import PlottedPoints
from .spawned_rays import SpawnedRays, leaving
from .surface import Surface
from .tabular import Tabular
from .values import cells, interpolated

# Attributes that the compiled scene computes on first access. A pickle keeps those already computed.
_ASKED = ("position", "normal", "_error", "surface", "names", "cell")


Points = TypeVar("Points", bound="SurfacePoints")


class Known:
    """Private data of points, kept apart so that `dataclasses.asdict` gives the public fields."""

    primitive_id: NDArray[np.int32]
    _compiled: _core.CompiledScene
    # Origins, directions and times, if shapes need them to compute hit points.
    _rays: tuple[Any, ...] | None

    @cached_property
    def instance_id(self) -> NDArray[np.int32]:
        """Which instance the point is on: (...) int32; -1 for none and for what is not instanced."""
        if "instance_id" not in vars(self).get("_fields", ("instance_id",)):
            raise AttributeError
        # One number seen from every index: scenes without instances spend no memory on them.
        return np.broadcast_to(np.int32(-1), _lead(vars(self)))


@dataclass(frozen=True, eq=False, repr=False, init=False)
class SurfacePoints(Known, Tabular, PlottedPoints):
    """Points on the surfaces of a scene; numbers of shapes and faces are read-only.

    Attributes
    ----------
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for none.
    primitive_id : (...) int32
        Face of that shape, 0 if it is no mesh; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the point is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a shape that is no mesh, its own u and v.
    """

    shape_id: NDArray[np.int32]
    primitive_id: NDArray[np.int32]
    uv: NDArray[np.float64]
    # A field, too, although computed on first access.
    instance_id: NDArray[np.int32]

    # Fields that decide equality.
    _parts: ClassVar[tuple[str, ...]] = ("shape_id", "primitive_id", "uv")

    @cached_property
    def names(self) -> NDArray[np.str_]:
        """What the shape is called that the point is on: (...) str; "" for none, and where it has no name."""
        # The last name is that of shape -1.
        known = names_of(self._known("names").shapes)
        return sealed(np.asarray(np.array([*known, ""])[self.shape_id]))

    @cached_property
    def cell(self) -> NDArray[np.int64]:
        """Cell of the original mesh, such as a polygon or a volume cell: (...) int64; -1 for none.

        The face where ``Mesh.cells`` is None, and 0 on a shape that is no mesh.
        """
        return sealed(cells(self._known("cell").shapes, self.shape_id, self.primitive_id))

    def interpolate(self, name: str) -> NDArray[np.float64]:
        """Return a vertex or face attribute of the meshes at the points.

        Parameters
        ----------
        name : str
            Name in ``Mesh.vertex_attributes``, which are linear on each face, or else in
            ``Mesh.face_attributes``.

        Returns
        -------
        (..., S) float64 array
            S is the shape of one value. NaN for none, and on shapes without the attribute.

        Raises
        ------
        ValueError
            If no shape of the scene has the attribute, or its values have different shapes.
        TypeError
            If `name` is no str.

        See Also
        --------
        Mesh : Holds the attributes.

        Examples
        --------
        >>> corners = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
        >>> mesh = rw.Mesh(corners, [[0, 1, 2]], vertex_attributes={"heat": [0.0, 100.0, 0.0]})
        >>> hits = rw.Scene(mesh).intersect([[0.25, 0.25, 1], [5, 5, 1]], [0, 0, -1])
        >>> hits.interpolate("heat").tolist()
        [25.0, nan]
        """
        if self._compiled is None:
            raise ValueError("pickled hits have no attributes: interpolate them before pickling")
        shapes = self._compiled.shapes
        return interpolated(shapes, name, self.shape_id, self.primitive_id, self.uv)

    def _known(self, name: str) -> _core.CompiledScene:
        """Return the scene of the points."""
        if self._compiled is None:
            why = "is not in pickled hits unless it was computed before pickling"
            if vars(self).get("_fields") is not None:
                why += ", nor in hits that were written to given arrays"
            raise ValueError(f"{name.strip('_')} {why}")
        return self._compiled

    @cached_property
    def position(self) -> NDArray[np.float64]:
        """Position of the point, from the corners of the face: (..., 3) float64; NaN for none."""
        if self._rays is not None:
            return self.surface.position
        points = self._known("position").positions(
            self.shape_id.reshape(-1), self.primitive_id.reshape(-1), self.uv.reshape(-1, 2)
        )
        return points.reshape(*self.primitive_id.shape, 3)

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """Unit geometric normal as the winding gives it: (..., 3) float64; NaN for none."""
        if self._rays is not None:
            return self.surface.normal
        normals = self._known("normal").normals(self.shape_id.reshape(-1), self.primitive_id.reshape(-1))
        return normals.reshape(*self.primitive_id.shape, 3)

    @cached_property
    def _error(self) -> NDArray[np.float64]:
        """Bound on how far each coordinate of `position` is from the surface: (...) float64; NaN for none."""
        if self._rays is not None:
            return self.surface.error
        errors = self._known("_error").errors(self.shape_id.reshape(-1), self.primitive_id.reshape(-1))
        return sealed(errors.reshape(self.primitive_id.shape))

    def spawn_rays(self, directions: ArrayLike) -> SpawnedRays:
        """Return rays that leave the points along some directions without meeting the same surface.

        Their origins are offset from the surface, to the side of each direction:
        ``scene.intersect(*hits.spawn_rays(ways))``.

        Parameters
        ----------
        directions : (..., 3) array
            Directions of the rays; they need not be unit. They and the points broadcast as arrays do: of
            points of shape (N,), directions of shape (3,) or (N, 3) give a ray each, and (S, N, 3) S of them.

        Returns
        -------
        SpawnedRays
            Origins and directions, both of the shape that points and directions broadcast to. Origins are NaN
            for misses, and such rays hit nothing.

        Raises
        ------
        ValueError
            If the last dimension is not 3, or leading shapes do not broadcast.
        TypeError
            If the array does not hold real numbers.

        See Also
        --------
        Scene.occluded : Takes the rays.

        Notes
        -----
        Rays should not start at `position` itself: it is rounded, so that it lies a little before the surface
        or behind it, and about half of the rays from there meet the face that they leave. Origins are offset
        along the normal by 8 times ``surface.error``, as far as rounding can matter and no farther (Pharr,
        Jakob and Humphreys 2023, 6.8.6), as in renders: some 1e-14 of the largest coordinate, so that a plate
        of 1e-5 of its distance from the origin does not leak.

        On flat surfaces, faces and copied faces included, no ray meets the surface that it leaves; on a
        curved shape, only rays that go through it meet it again. A direction along the surface, at right
        angles to the normal, starts on the side of the normal and stays there. If the angle to the surface is
        within rounding, 1e-16 or so (on a sliver, that times its length over its height), so is the side.

        If copies move, trace the rays at the `time` of the hits.

        Examples
        --------
        >>> scene = rw.Scene([rw.Plane(), rw.Sphere((0, 0, 2), radius=1)])
        >>> hits = scene.intersect([[0, 4, 4], [4, 0, 4]], [[0, -1, -1], [0, 0, -1]])
        >>> scene.occluded(*hits.spawn_rays([0, 0, 1])).tolist()
        [True, False]
        """
        return leaving(self.primitive_id.shape, self.position, self._error, self.normal, directions)

    @cached_property
    def surface(self) -> Surface:
        """All about the points: normals, derivatives by the coordinates, bounds on errors."""
        return self._surface(None)

    def _surface(self, ray: NDArray[np.int64] | None) -> Surface:
        """Ask all about the points; `ray` says which ray each is of, where they are not in turn."""
        # Hit points of meshes follow from barycentric weights alone.
        t = np.ascontiguousarray(getattr(self, "t", np.zeros(self.primitive_id.shape))).reshape(-1)
        origins, directions, time = self._rays or (np.zeros((1, 3)), np.ones((1, 3)), 0.0)
        instance_id = vars(self).get("instance_id")
        parts = _core.points(
            self._known("surface"),
            self.shape_id.reshape(-1),
            self.primitive_id.reshape(-1),
            None if instance_id is None else np.ascontiguousarray(instance_id).reshape(-1),
            self.uv.reshape(-1, 2),
            t,
            origins.reshape(-1, 3),
            directions.reshape(-1, 3),
            time.reshape(-1) if isinstance(time, np.ndarray) else time,
            ray,
        )
        lead = self.primitive_id.shape
        return Surface(*(part.reshape(lead + part.shape[1:]) for part in parts))

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return the data as flat arrays by name, an entry or a row for each point.

        Returns
        -------
        dict
            One entry a ray or point for `Hits` and `ClosestPoints`, one entry a hit for `AllHits`, with its
            `ray`. Arrays of three columns are apart, as x, y and z, and those of two as u and v.

        See Also
        --------
        Hits.to_dataframe : The same as a table of pandas.

        Examples
        --------
        >>> hits = rw.Scene(rw.Sphere()).intersect([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
        >>> columns = hits.to_dict()
        >>> columns["t"].tolist(), columns["shape_id"].tolist()
        ([4.0, inf], [0, -1])
        """
        return rows.flat(self)

    def _first_rows(self, count: int) -> tuple[int, dict[str, NDArray[Any]]]:
        # Nothing is worked out for the others.
        shape = _lead(vars(self))
        size = math.prod(shape)
        of: Any = self
        return size, rows.flat(of[np.unravel_index(np.arange(min(count, size)), shape)] if shape else of)

    def __eq__(self, other: object) -> bool:
        if type(other) is not type(self):
            return NotImplemented
        if self._more() != other._more():
            return False
        names = self._asked()
        if names != other._asked():
            return False
        copies = ("instance_id",) if "instance_id" in vars(self) or "instance_id" in vars(other) else ()
        return all(
            same(getattr(self, name), getattr(other, name)) for name in dict.fromkeys((*names, *copies))
        )

    def _asked(self) -> tuple[str, ...]:
        """Return the parts that there are of the arrays."""
        names = vars(self).get("_fields", self._parts)
        return tuple(name for name in (*self._parts, "instance_id", "hit") if name in names)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        # Pickles omit the scene, and attributes not computed so far.
        own = vars(self)
        kept = {name: own[name] for name in (*self._parts, "instance_id", *_ASKED, "_fields") if name in own}
        if "hit" in own.get("_fields", ()):
            kept["hit"] = own["hit"]
        # Where hits know their points by their rays, and the scene is gone, those are of no use.
        return restored, (type(self), kept, self._more())

    def __copy__(self) -> SurfacePoints:
        copy = type(self).__new__(type(self))
        vars(copy).update(vars(self))
        return copy

    def __deepcopy__(self, memo: dict[int, Any]) -> SurfacePoints:
        # The compiled scene never changes, so copies share it; `out` may write to the arrays.
        copy = restored(type(self), rows.copied(vars(self), memo), {})
        vars(copy).update(_compiled=self._compiled, _rays=self._rays)
        return copy

    def _more(self) -> dict[str, Any]:
        """Return the data kept besides the arrays."""
        return {}


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Hits(SurfacePoints):
    """The closest hit of each ray; every array begins with the leading shape of the rays.

    Arrays of floats and bools belong to the caller. Arrays of integers are read-only, since further data is
    looked up by them; computed results do not follow a change.

    Attributes
    ----------
    t : (...) float64
        Distance in lengths of the ray's direction, so that the hit is at ``origin + t * direction``; inf for
        a miss.
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for a miss.
    primitive_id : (...) int32
        Face of that shape, 0 if it is no mesh; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the hit is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a shape that is no mesh, its own u and v.

    See Also
    --------
    Scene.intersect : Makes it.
    AllHits : Every hit of each ray.

    Examples
    --------
    >>> scene = rw.Scene({"ball": rw.Sphere()})
    >>> hits = scene.intersect([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
    >>> hits
    Hits(shape=(2,), 1 of 2 rays hit)
    >>> hits.shape_id.tolist(), hits.names.tolist()
    ([0, -1], ['ball', ''])
    """

    t: NDArray[np.float64]

    _parts = ("t", "shape_id", "primitive_id", "uv")

    def __init__(
        self,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
        rays: tuple[Any, ...] | None = None,
    ) -> None:
        self._tell(t, shape_id, primitive_id, uv, instance_id, compiled, rays)

    @classmethod
    def _on_meshes(
        cls,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
    ) -> "Hits":
        """Return hits as `__init__` makes them, in half the time."""
        hits = cls.__new__(cls)
        own = hits.__dict__
        own["t"] = t
        own["shape_id"] = shape_id
        own["primitive_id"] = primitive_id
        own["uv"] = uv
        own["_compiled"] = compiled
        own["_rays"] = None
        if instance_id is not None:
            own["instance_id"] = instance_id
        return hits

    def _tell_some(
        self,
        parts: dict[str, NDArray[Any]],
        fields: tuple[str, ...],
        compiled: _core.CompiledScene | None,
        rays: tuple[Any, ...] | None,
    ) -> Hits:
        """Tell of these hits no more than some parts, forget what was worked out of others, and return it."""
        self.__dict__.clear()
        self.__dict__.update(parts, _fields=fields, _compiled=compiled, _rays=rays)
        return self

    def _tell(
        self,
        t: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
        rays: tuple[Any, ...] | None,
    ) -> None:
        """Take these hits, and forget results computed for others."""
        self.__dict__.clear()
        # Setting the fields of a frozen dataclass takes longer than tracing a ray.
        self.__dict__.update(
            t=t, shape_id=shape_id, primitive_id=primitive_id, uv=uv, _compiled=compiled, _rays=rays
        )
        if instance_id is not None:
            self.__dict__["instance_id"] = instance_id

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            fields = vars(self).get("_fields")
            if fields is None or name.startswith("__"):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            raise AttributeError(f"hits that were found with fields={fields} have no {name}")

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """Whether each ray hits anything: (...) bool."""
        own = vars(self)
        if "primitive_id" not in own and "shape_id" in own:
            return np.asarray(self.shape_id >= 0)
        return np.asarray(self.primitive_id >= 0)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the rays."""
        return _lead(vars(self))

    def __getitem__(self, index: Any) -> Hits:
        """Return the hits at some places of the leading shape, which is indexed as arrays are."""
        return one_or_some(Hits, self, index)

    def __iter__(self) -> Iterator[Hits]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return rows.length(self.shape)

    def __repr__(self) -> str:
        if not {"hit", "primitive_id", "shape_id"} & set(vars(self)):
            return f"Hits(shape={self.shape}, fields={self._asked()})"
        count = int(np.count_nonzero(self.hit))
        return f"Hits(shape={self.shape}, {count} of {self.hit.size} rays hit)"


@dataclass(frozen=True, eq=False, repr=False, init=False)
class ClosestPoints(SurfacePoints):
    """The closest point of the surface to each point; every array begins with their leading shape.

    Arrays of integers are read-only, as in `Hits`.

    Attributes
    ----------
    distance : (...) float64
        Distance to the closest point; inf if none is near enough.
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for none.
    primitive_id : (...) int32
        Face of that shape, 0 if it is no mesh; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the closest point is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a shape that is no mesh, its own u and v.

    See Also
    --------
    Scene.closest_point : Makes it.

    Examples
    --------
    >>> found = rw.Scene(rw.Sphere()).closest_point([[0, 0, 3], [0, 2, 0]])
    >>> found.distance.tolist(), found.position.round(9).tolist()
    ([2.0, 1.0], [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])
    """

    distance: NDArray[np.float64]

    _parts = ("distance", "shape_id", "primitive_id", "uv")

    def __init__(
        self,
        distance: NDArray[np.float64],
        position: NDArray[np.float64],
        shape_id: NDArray[np.int32],
        primitive_id: NDArray[np.int32],
        uv: NDArray[np.float64],
        instance_id: NDArray[np.int32] | None,
        compiled: _core.CompiledScene,
    ) -> None:
        parts = {"distance": distance, "shape_id": shape_id, "primitive_id": primitive_id, "uv": uv}
        if instance_id is not None:
            parts["instance_id"] = instance_id
        # The position is known already, and goes where cached_property keeps its values.
        self.__dict__.update(parts, position=position, _compiled=compiled, _rays=None)

    @cached_property
    def _site(self) -> NDArray[np.float64]:
        """The unit normal, and a bound on how far each coordinate of `position` is off: (..., 4) float64."""
        instance_id = vars(self).get("instance_id")
        copies = None if instance_id is None else np.ascontiguousarray(instance_id).reshape(-1)
        places = self.uv.reshape(-1, 2), self.position.reshape(-1, 3), copies
        known = self._known("normal")
        sites = known.sites(self.shape_id.reshape(-1), self.primitive_id.reshape(-1), *places)
        return sealed(sites.reshape(*self.primitive_id.shape, 4))

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """Unit geometric normal, outward on closed shapes: (..., 3) float64; NaN for none."""
        return self._site[..., :3].copy() if self._known("normal").curved else super().normal

    @cached_property
    def _error(self) -> NDArray[np.float64]:
        return sealed(self._site[..., 3].copy()) if self._known("_error").curved else super()._error

    @cached_property
    def found(self) -> NDArray[np.bool_]:
        """Mask of points with a surface near enough: (...) bool."""
        return np.asarray(self.primitive_id >= 0)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the points."""
        return self.distance.shape

    def __getitem__(self, index: Any) -> ClosestPoints:
        """Return the closest points at some places of the leading shape, which is indexed as arrays are."""
        return one_or_some(ClosestPoints, self, index)

    def __iter__(self) -> Iterator[ClosestPoints]:
        return (self[i] for i in range(len(self)))

    def __len__(self) -> int:
        return len(self.distance)

    def __repr__(self) -> str:
        count = int(np.count_nonzero(self.found))
        return f"ClosestPoints(shape={self.shape}, {count} of {self.distance.size} found)"


@dataclass(frozen=True, eq=False)
class TraversalCost:
    """Traversal cost of closest hits; arrays with the leading shape of the rays, read-only.

    Attributes
    ----------
    nodes : (...) int32
        Nodes of the accelerator that are visited: the boxes of a node's children are tested together.
    primitives : (...) int32
        Primitives in the leaves that are visited: each is tested.

    See Also
    --------
    Scene.traversal_cost : Makes it.

    Examples
    --------
    >>> cost = rw.Scene(rw.Sphere()).traversal_cost([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
    >>> cost.primitives.tolist()
    [1, 0]
    """

    nodes: NDArray[np.int32]
    primitives: NDArray[np.int32]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TraversalCost):
            return NotImplemented
        return same(self.nodes, other.nodes) and same(self.primitives, other.primitives)

    __hash__ = None  # type: ignore[assignment]


def _lead(own: Mapping[str, Any]) -> tuple[int, ...]:
    """Return the leading shape of what is known of hits."""
    name = next(name for name in ("t", "primitive_id", "shape_id", "hit", "instance_id", "uv") if name in own)
    shape: tuple[int, ...] = own[name].shape
    return shape[:-1] if name == "uv" else shape


@contextmanager
def rewritten(out: Hits, shape: tuple[int, ...]) -> Iterator[tuple[Any, ...]]:
    """Give the arrays of hits of rays of a leading shape, which can be written to meanwhile."""
    if not isinstance(out, Hits):
        raise TypeError(f"out must be Hits or arrays by name, got {type(out).__name__}")
    if out.shape != shape:
        raise ValueError(f"out has shape {out.shape}, expected {shape}")
    instance_id = vars(out).get("instance_id")
    if instance_id is not None and not instance_id.flags.owndata:
        # One element seen from every index.
        instance_id = None
    # What an earlier answer left out, or told in another type, is new.
    types = {"t": np.float64, "shape_id": np.int32, "primitive_id": np.int32, "uv": np.float64}
    own = {name: vars(out).get(name) for name in types}
    arrays = tuple(a if a is not None and a.dtype == types[name] else None for name, a in own.items())
    known = [array for array in (*arrays, instance_id) if array is not None]
    try:
        for array in known:
            if not array.flags.owndata:
                raise ValueError("out cannot be written to: its arrays are views of other memory")
            array.setflags(write=True)
        yield (*arrays, instance_id)
    finally:
        for array in known:
            rows.kept(array)


def one_or_some(kind: type[Points], of: Any, index: Any) -> Points:
    """Return the points at some places of the leading shape, which is indexed as arrays are."""
    one = rows.place(of.shape, index)
    if one is None:
        which = rows.places(of.shape, index)
        return chosen(kind, of, rows.picked(vars(of), which), which)
    # Only this point is computed, so that iterating takes linear time.
    points = kind.__new__(kind)
    rays = None if of._rays is None else rows.rays_of(of._rays, rows.run(of.shape, one))
    vars(points).update(rows.cut(vars(of), one), _compiled=of._compiled, _rays=rays)
    return points


def chosen(kind: type[Points], of: SurfacePoints, own: dict[str, Any], rays: NDArray[np.int64]) -> Points:
    """Return a selection of points, with the private data of all; `rays` are places of theirs."""
    points = kind.__new__(kind)
    vars(points).update(own, _compiled=of._compiled, _rays=rows.rays_of(of._rays, rays))
    return points


def sealed(array: NDArray[Any]) -> NDArray[Any]:
    """Return the array, which can be read only from now on."""
    array.setflags(write=False)
    return array


def same(a: NDArray[Any], b: NDArray[Any]) -> bool:
    """Return whether two arrays are equal; NaN is equal to NaN."""
    return np.array_equal(a, b, equal_nan=a.dtype.kind == "f")


def restored(kind: type[Points], arrays: dict[str, Any], more: dict[str, Any]) -> Points:
    """Return points that know only their arrays."""
    points = kind.__new__(kind)
    for array in arrays.values():
        if isinstance(array, np.ndarray):
            rows.kept(array)
    # Stored where cached_property keeps its values, too.
    vars(points).update(arrays, **more, _compiled=None, _rays=None)
    return points
