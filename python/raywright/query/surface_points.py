"""Points on the surfaces of a scene, and what follows from them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import same, sealed
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
        """Index of the copy at the point: (...) int32; -1 for none and outside of instances."""
        if "instance_id" not in vars(self).get("_fields", ("instance_id",)):
            raise AttributeError
        # One number seen from every index: scenes without instances spend no memory on them.
        return np.broadcast_to(np.int32(-1), leading_shape(vars(self)))


@dataclass(frozen=True, eq=False, repr=False, init=False)
class SurfacePoints(Known, Tabular, PlottedPoints):
    """Points on the surfaces of a scene; numbers of shapes and faces are read-only.

    Attributes
    ----------
    shape_id : (...) int32
        Index in ``scene.shapes``; -1 for none.
    primitive_id : (...) int32
        Face of that shape, 0 for a curved shape; on an instance, a number for `Instance.locate`.
    uv : (..., 2) float64
        Barycentric weights of the face's second and third corner, so that the point is at
        ``(1 - u - v) * a + u * b + v * c`` for corners a, b, c; on a curved shape, its own u and v.
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
        """Name of the shape at the point: (...) str; "" for none, and for shapes without a name."""
        # The last name is that of shape -1.
        known = names_of(self._known("names").shapes)
        return sealed(np.asarray(np.array([*known, ""])[self.shape_id]))

    @cached_property
    def cell(self) -> NDArray[np.int64]:
        """Cell of the original mesh, such as a polygon or a volume cell: (...) int64; -1 for none.

        The face if ``Mesh.cells`` is None, and 0 on a curved shape.
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
            If `name` is not a str.

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
        """Return rays that leave the points in given directions without hitting the same surface.

        Their origins are offset from the surface, to the side of each direction:
        ``scene.intersect(*hits.spawn_rays(ways))``.

        Parameters
        ----------
        directions : (..., 3) array
            Directions of the rays; they need not be unit. Directions and points broadcast: for points of
            shape (N,), directions of shape (3,) or (N, 3) give one ray for each point, and (S, N, 3) give S.

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
        """Differential geometry at the points: normals, derivatives with respect to u and v, error bounds."""
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
        """Return a dict of flat arrays, the columns of a table.

        Returns
        -------
        dict
            Arrays with one entry per ray (`Hits`), per query point (`ClosestPoints`) or per hit (`AllHits`,
            with the index of its ray in `ray`). A position becomes the columns x, y and z, and the other
            vectors columns such as normal_x.

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
        shape = leading_shape(vars(self))
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


def leading_shape(own: Mapping[str, Any]) -> tuple[int, ...]:
    """Return the leading shape of what is known of hits."""
    name = next(name for name in ("t", "primitive_id", "shape_id", "hit", "instance_id", "uv") if name in own)
    shape: tuple[int, ...] = own[name].shape
    return shape[:-1] if name == "uv" else shape


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


def restored(kind: type[Points], arrays: dict[str, Any], more: dict[str, Any]) -> Points:
    """Return points that know only their arrays."""
    points = kind.__new__(kind)
    for array in arrays.values():
        if isinstance(array, np.ndarray):
            rows.kept(array)
    # Stored where cached_property keeps its values, too.
    vars(points).update(arrays, **more, _compiled=None, _rays=None)
    return points
