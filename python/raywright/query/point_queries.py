"""Queries of points: inside or outside, the closest point, the signed distance."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import CompiledScene
from ..io.quiet import warn_caller
from .closest_points import ClosestPoints
from .compilable import Compilable
from .masks import ShapeMask, counted, names_of
from .rays import nearest_arguments, point_arguments


class PointQueries(Compilable):
    """Queries of points; the first one compiles the scene."""

    _tolerance: float | None
    _is_inverted_told = False

    def _enclosing(self) -> CompiledScene:
        """Return the scene whose meshes are welded, which decides what is closed."""
        raise NotImplementedError

    def contains(
        self, points: ArrayLike, threads: int | None = None, shapes: ShapeMask | None = None
    ) -> NDArray[np.bool_]:
        """Find whether each point is inside a closed shape.

        Decided exactly; points on a closed surface count as inside. Shapes that are not closed have no
        inside: a plane, a disk, a terrain, a box without its lid. The union counts: a point in two shapes at
        once is inside.

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        shapes : (S,) bool array, str or sequence of str, optional
            Shapes to test: a bool for each of ``scene.shapes``, or names. The result is that of a scene of
            these shapes only. An `Instance` counts as a whole.

        Returns
        -------
        (...) bool
            With the leading shape of the points. False for points that are NaN or infinite.

        Raises
        ------
        ValueError
            If the last dimension is not 3, a mask has the wrong shape, or no shape has a name of `shapes`.
        TypeError
            If the array does not hold real numbers, or a mask is not bool.

        Warns
        -----
        RuntimeWarning
            Once of meshes whose normals point into them, and of instances of such: they enclose the same as
            if they pointed out. A transform that mirrors turns no normals, as for hits.

        See Also
        --------
        Scene.signed_distance : The distance too.
        measure.topology : Report why a mesh is not closed.

        Notes
        -----
        A mesh is taken apart into faces that hang together by edges, where corners that differ by rounding
        are one (see `Scene`). Parts without an open edge enclose the points that they wind around. If two
        faces run along an edge the same way, winding is undefined: points that a ray leaves through an odd
        number of crossings are enclosed. Winding numbers in one mesh add up: a cavity whose normals point
        into it is outside, and where parts overlap is inside. A mesh whose normals point in is the wall of a
        cavity where it lies within another shape. Faces with the same corners count once, whichever way they
        turn, and a wall between two parts not at all. Meshes that only close together, as the walls of a
        room, are one.

        One ray decides if all closed shapes are meshes with equal corners at shared edges, and two opposite
        ones otherwise. If these do not agree there is a crack left by rounding, and the majority of seven
        rays decides.

        Examples
        --------
        >>> scene = rw.Scene(rw.Box((0, 0, 0), (1, 1, 1)))
        >>> scene.contains([[0.5, 0.5, 0.5], [1, 1, 1], [2, 0, 0]]).tolist()
        [True, True, False]
        """
        return self._inside(points, threads, shapes)

    def _inside(self, points: ArrayLike, threads: int | None, shapes: ShapeMask | None) -> NDArray[np.bool_]:
        core = self._enclosing()
        mask = _mask(shapes, core)
        found = core.contains(*point_arguments(points, threads), mask, self._tolerance)
        if not self._is_inverted_told and (inverted := core.inverted(mask, self._tolerance)):
            self._is_inverted_told = True
            known = names_of(core.shapes)
            names = ", ".join(f"{i} {known[i]!r}" if known[i] else str(i) for i in inverted[:5])
            more = f" and {len(inverted) - 5} more" if len(inverted) > 5 else ""
            warn_caller(
                f"normals of shape {names}{more} point inward and are treated as outward; flip them by "
                "Mesh(vertices, faces[:, ::-1])"
            )
        return found

    def closest_point(
        self,
        points: ArrayLike,
        max_distance: ArrayLike = np.inf,
        threads: int | None = None,
        shapes: ShapeMask | None = None,
    ) -> ClosestPoints:
        """Find the closest point of any surface to each point.

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        max_distance : float or (...) array
            Maximum distance, inclusive; smaller values are faster.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        shapes : (S,) bool array, str or sequence of str, optional
            Shapes to test, as for `contains`.

        Returns
        -------
        ClosestPoints
            With the leading shape of the points. Ties go to the lowest (shape_id, primitive_id).

        Raises
        ------
        ValueError
            If the last dimension is not 3, shapes do not broadcast, `max_distance` is negative or NaN, a mask
            has the wrong shape, or no shape has a name of `shapes`.
        TypeError
            If an array does not hold real numbers, or a mask is not bool.

        See Also
        --------
        Scene.signed_distance : The distance alone, with its sign.

        Notes
        -----
        Points that are NaN or infinite have no closest point. Moving instances are where they are as the
        shutter opens.

        Shapes that are not meshes, and instances, are found through a tree of their boxes, which is built by
        the first query. Distances to shapes in an instance are measured in the scene's space, so that
        transforms that scale some lengths more than others, nested ones too, are as good as any.

        Most shapes have a closed form; for ellipsoids bisection finds the root of a falling sum to the last
        digit (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013). Disks,
        cylinders, cones, paraboloids and tori under such a transform are a curve at each turn about their
        axis; its closest point is found by bounds on the derivative of the distance (Piyavskii 1972). For an
        `Implicit`, intervals exclude parts of the box that are farther; if all of it is about as far, as from
        the middle of a sphere, the result is a close point.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere())
        >>> found = scene.closest_point([[0, 0, 3], [0, 0, 9]], max_distance=5)
        >>> found.distance.tolist(), found.position[0].tolist()
        ([2.0, inf], [0.0, 0.0, 1.0])
        """
        core = self._core or self._compiled()
        arguments = nearest_arguments(points, max_distance, threads)
        return ClosestPoints(*core.nearest(*arguments, _mask(shapes, core)), core)

    def signed_distance(
        self, points: ArrayLike, threads: int | None = None, shapes: ShapeMask | None = None
    ) -> NDArray[np.float64]:
        """Compute the signed distance of each point to the surface: negative inside, positive outside.

        Points are inside where `contains` finds them inside, with its warnings. The nearest surface may
        belong to an open shape. (Open3D and most CAD use this sign, trimesh the opposite one.)

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        shapes : (S,) bool array, str or sequence of str, optional
            Shapes to test, as for `contains`.

        Returns
        -------
        (...) float64
            With the leading shape of the points; inf for points that are NaN or infinite, and for all points
            if there are no shapes to test. On curved shapes it is 0 to within the rounding of the point.

        Raises
        ------
        ValueError
            If the last dimension is not 3, a mask has the wrong shape, or no shape has a name of `shapes`.
        TypeError
            If the array does not hold real numbers, or a mask is not bool.

        See Also
        --------
        Scene.contains : Inside or outside alone.
        Scene.closest_point : The closest point itself.

        Examples
        --------
        >>> scene = rw.Scene(rw.Box((0, 0, 0), (2, 2, 2)))
        >>> scene.signed_distance([[1, 1, 1], [1, 1, 5], [2, 1, 1]]).tolist()
        [-1.0, 3.0, 0.0]
        """
        core = self._core or self._compiled()
        distance = core.nearest(*nearest_arguments(points, np.inf, threads), _mask(shapes, core))[0]
        # In place, without two more arrays of its size.
        np.negative(distance, out=distance, where=self._inside(points, threads, shapes) & (distance > 0))
        return distance


def _mask(shapes: ShapeMask | None, core: CompiledScene) -> list[bool] | None:
    """Return whether each shape counts, None if all do."""
    what = counted(shapes, None, core.shapes)
    return None if what is None else what[0]
