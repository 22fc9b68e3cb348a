"""Queries of the media along rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .compilable import Compilable
from .masks import asked
from .rays import ray_arguments


class MediumQueries(Compilable):
    """Queries of the media along rays; the first one compiles the scene."""

    def optical_depth(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Compute the optical depth of the media along each ray: the integral of their extinction.

        Surfaces do not stop the rays: only media count, those inside shapes and that of the scene. `occluded`
        tests for surfaces.

        Parameters
        ----------
        origins, directions, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        (..., 3) float64
            For red, green and blue; 0 without media, and infinite for an infinite ray in an infinite medium.

        Raises
        ------
        ValueError
            As `intersect` does.
        TypeError
            As `intersect` does.

        See Also
        --------
        Scene.transmittance : The share of light that is left.

        Notes
        -----
        It is exact but for rounding, on a `GridMedium` too: its density is a polynomial along a ray in each
        of its cells. For a medium given by spectra, it is that of its colors.

        Examples
        --------
        >>> fog = rw.Homogeneous(absorption=0.5, scattering=0.25)
        >>> ball = rw.Sphere(radius=1, material=rw.MediumInterface(fog))
        >>> rw.Scene(ball).optical_depth([0, 0, 5], [0, 0, -1]).round(6).tolist()
        [1.5, 1.5, 1.5]
        """
        rays = asked(ray_arguments(origins, directions, 0.0, t_max, threads, time), None)
        core = self._core or self._compiled()
        return core.optical_depth(rays)

    def transmittance(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Compute the transmittance of the media along each ray: exp(-`optical_depth`).

        Surfaces do not stop the rays. For tiny transmittances, `optical_depth` is more accurate.

        Parameters
        ----------
        origins, directions, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        (..., 3) float64
            For red, green and blue, from 0 to 1.

        Raises
        ------
        ValueError
            As `intersect` does.
        TypeError
            As `intersect` does.

        See Also
        --------
        Scene.optical_depth : Its negative logarithm.

        Examples
        --------
        >>> ink = rw.Homogeneous(absorption=(0.0, 0.5, 1.0))
        >>> slab = rw.Box((-1, -1, 0), (1, 1, 2), material=rw.MediumInterface(ink))
        >>> rw.Scene(slab).transmittance([0, 0, 5], [0, 0, -1]).round(4).tolist()
        [1.0, 0.3679, 0.1353]
        """
        return np.exp(-self.optical_depth(origins, directions, t_max, threads, time))
