"""The questions that points ask of a scene."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import CompiledScene
from .hits import ClosestPoints
from .rays import nearest_arguments, point_arguments


class PointQueries:
    """What a compiled scene answers to points; asking compiles it."""

    _core: CompiledScene | None

    def _compiled(self) -> CompiledScene:
        raise NotImplementedError

    def contains(self, points: ArrayLike, threads: int | None = None) -> NDArray[np.bool_]:
        """Find whether each point is inside a closed surface.

        A point is inside if a ray from there crosses the surface an odd number of times, which is decided
        exactly; what is on the surface counts as inside. So where closed surfaces overlap, or one is within
        the other, what is inside two of them is outside again (the even-odd rule).

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        (...) bool
            With the leading shape of the points. False for points that are NaN or infinite.

        Raises
        ------
        ValueError
            If the last dimension is not 3.
        TypeError
            If the array does not hold real numbers.

        Notes
        -----
        From a point two opposite ways out are tried, which agree if the surface is closed. Where they do not
        there is a hole, and the majority of seven ways decides.
        """
        return (self._core or self._compiled()).contains(*point_arguments(points, threads))

    def closest_point(
        self, points: ArrayLike, max_distance: ArrayLike = np.inf, threads: int | None = None
    ) -> ClosestPoints:
        """Find the closest point of any surface to each point.

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        max_distance : float or (...) array
            How far to look, this distance included; the less, the faster.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        ClosestPoints
            With the leading shape of the points. Of faces at the same distance, the one of the lowest
            (shape_id, primitive).

        Raises
        ------
        ValueError
            If the last dimension is not 3, shapes do not broadcast, or `max_distance` is negative or NaN.
        TypeError
            If an array does not hold real numbers.

        Notes
        -----
        Points that are NaN or infinite have no closest point. What moves is where it is as the shutter opens.

        Shapes that are no meshes, and instances, are found through a tree of their boxes, which is built when
        the first point is asked. What is in an instance is measured where it stands, so that transforms that
        scale some lengths more than others, within each other too, are as good as any.

        Most shapes have a closed form; of ellipsoids the closest point is where a sum that falls is 1, which
        halving finds to the last digit (Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a
        Hyperellipsoid", 2013). Disks, cylinders, cones, paraboloids and tori under such a transform are a
        curve at each turn about their axis, of which the closest is found by bounds on how fast its distance
        changes (Piyavskii 1972). Of an `Implicit` no part of the box is left out that intervals cannot rule
        out; where all of it is about as far, as from the middle of a sphere, it is a close one.
        """
        core = self._core or self._compiled()
        return ClosestPoints(*core.nearest(*nearest_arguments(points, max_distance, threads)), core)

    def signed_distance(self, points: ArrayLike, threads: int | None = None) -> NDArray[np.float64]:
        """Find how far each point is from the surface: negative inside, positive outside, zero on it.

        Inside is what `contains` finds so. (Open3D and most of CAD have this sign, trimesh has the other.)

        Parameters
        ----------
        points : (..., 3) array
            C-contiguous float32 and float64 are read without a copy.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        (...) float64
            With the leading shape of the points; inf for points that are NaN or infinite, and for all if the
            scene is empty. On shapes that are no meshes it is 0 to within the rounding of the point.

        Raises
        ------
        ValueError
            If the last dimension is not 3.
        TypeError
            If the array does not hold real numbers.
        """
        core = self._core or self._compiled()
        distance = core.nearest(*nearest_arguments(points, np.inf, threads))[0]
        inside = core.contains(*point_arguments(points, threads)) & (distance > 0)
        return np.asarray(np.where(inside, -distance, distance))
