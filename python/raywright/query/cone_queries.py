"""Queries of solid cones."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from .compilable import Compilable
from .cones import ConeCoverage, ConeFaces, cone_arguments, cone_solid_angle


class ConeQueries(Compilable):
    """Queries of solid cones; the first one compiles the scene."""

    def faces_in_cone(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        half_angle: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> ConeFaces:
        """Find all faces that solid cones touch, the nearest first.

        A cone touches a face if they have a common point, borders included. Occlusion is ignored.

        Parameters
        ----------
        origins, directions : (..., 3) arrays
            Apexes and axes, broadcast against each other; directions need not be unit.
        half_angle : float or (...) array
            Angle between the axis and the surface, in degrees, at least 0 and less than 90. A cone of 0 is a
            ray.
        t_max : float or (...) array
            Maximum distance from the apex, inclusive, in the scene's unit whatever the length of the
            direction. A cone thus ends in a spherical cap.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.

        Returns
        -------
        ConeFaces
            Faces in order of cone, then distance, then (shape_id, primitive_id).

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, `half_angle` is NaN or out of
            range, `t_max` is NaN, or something in the scene is not a mesh.
        TypeError
            If an array does not hold real numbers.

        See Also
        --------
        Scene.cone_coverage : The share of the cone that is covered.

        Notes
        -----
        Cones with NaN, infinity or a zero direction touch nothing. No face that has a point in the cone is
        missed. With M the distance from the apex to the farthest corner of a face, a face that misses the
        cone by less than 2**-43 M may be included, and distances are those of a cone whose surface is moved
        by no more than that. Accelerators agree to the last bit.

        Examples
        --------
        >>> triangle = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> touches = rw.Scene(triangle).faces_in_cone([0, 0, 4], [0, 0, -1], half_angle=5)
        >>> touches.primitive_id.tolist(), touches.distance.tolist()
        ([0], [4.0])
        """
        core = self._core or self._compiled()
        arguments = cone_arguments(origins, directions, half_angle, t_max, threads)
        splits, distance, shape_id, primitive_id = _core.cones(core, *arguments)
        return ConeFaces(splits, shape_id, primitive_id, distance, arguments[4])

    def cone_coverage(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        half_angle: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> ConeCoverage:
        """Compute the covered share of solid cones: the share of their directions that hit something.

        It is exact for meshes, whose faces hide parts of each other, and for one sphere (Tovchigrechko and
        Vakser 2001). Otherwise, coverage behind a sphere is multiplied by the share of the cone that the
        sphere leaves uncovered, as if both were spread evenly (Amanatides 1984).

        Parameters
        ----------
        origins, directions, half_angle, threads
            As in `faces_in_cone`; `half_angle` is above 0.
        t_max : float or (...) array
            Maximum distance: a shape whose nearest point is farther from the apex does not count.

        Returns
        -------
        ConeCoverage
            Solid angles and shares, (...) float64 each; 0 for cones with infinite values or without
            direction, which touch nothing, and NaN for cones with NaN.

        Raises
        ------
        ValueError
            As `faces_in_cone`, and if `half_angle` is 0, or something in the scene is neither a mesh nor a
            `Sphere`.
        TypeError
            If an array does not hold real numbers.

        See Also
        --------
        Scene.faces_in_cone : The faces in a cone.
        measure.ambient_visibility : The uncovered share of a hemisphere.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere((0, 0, 10), radius=1))
        >>> seen = scene.cone_coverage([0, 0, 0], [0, 0, 1], half_angle=10)
        >>> round(seen.share.item(), 4)
        0.3299
        >>> round(float((1 - np.cos(np.arcsin(1 / 10))) / (1 - np.cos(np.radians(10)))), 4)
        0.3299
        """
        core = self._core or self._compiled()
        arguments = cone_arguments(origins, directions, half_angle, t_max, threads)
        whole = cone_solid_angle(arguments[2])
        share = _core.cone_coverage(core, *arguments)
        return ConeCoverage(share * whole.reshape(share.shape if whole.ndim else ()), share)
