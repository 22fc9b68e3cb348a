"""Queries of the rays of a camera's pixels."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from .. import _core
from ..arrays import indices, last_axis, number, thread_limit
from ..cameras import AnyCamera, pixel_offsets
from .hits import Hits
from .ray_queries import RayQueries


class CameraQueries(RayQueries):
    """Queries of pixels; the first one compiles the scene."""

    def pick(
        self,
        camera: AnyCamera,
        x: ArrayLike,
        y: ArrayLike,
        offsets: ArrayLike = (0.5, 0.5),
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> Hits:
        """Find the hit at a pixel, or at many: shape, face, position and distance.

        Parameters
        ----------
        camera : Camera or another kind
            Camera of the picture.
        x, y : int or (...) integer arrays
            Column and row of the pixel, broadcast against each other: (0, 0) is the upper left of the
            picture, (width - 1, height - 1) its lower right. For points between, such as mouse clicks in
            floating point, use ``intersect(*camera.rays_through(points))``.
        offsets : (2,) or (..., 2) array
            Position within the pixel, for all pixels or for each, as in `Camera.rays`: (0, 0) is its upper
            left, (1, 1) its lower right. The default is the center.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        time : float or (...) array, optional
            Time from 0, the default, as the camera's shutter opens to 1 as it closes.

        Returns
        -------
        Hits
            With the leading shape of the pixels: the same bits as ``intersect(*camera.rays(...))`` at these
            pixels. `t` is the distance from the camera, since directions are unit.

        Raises
        ------
        ValueError
            If a pixel is outside of the picture, `time` is not between 0 and 1, or shapes do not broadcast.
        TypeError
            If `camera` is not a Camera, `x` or `y` are not integers, or `offsets` are not real numbers.

        See Also
        --------
        Scene.first_hits : The hits of all pixels.

        Examples
        --------
        >>> scene = rw.Scene({"ball": rw.Sphere()})
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=9, height=9)
        >>> hits = scene.pick(camera, x=[4, 0], y=[4, 0])
        >>> hits.names.tolist(), hits.t.round(6).tolist()
        (['ball', ''], [4.0, inf])
        """
        if not isinstance(camera, AnyCamera):
            raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
        told = "; ask of points between with intersect(*camera.rays_through(points))"
        column, row = indices("x", x, camera.width, told), indices("y", y, camera.height, told)
        where = last_axis("offsets", offsets, 2)
        try:
            lead = np.broadcast_shapes(column.shape, row.shape, where.shape[:-1])
        except ValueError:
            told = f"x {column.shape}, y {row.shape}, offsets {where.shape[:-1]}"
            raise ValueError(f"leading shapes do not broadcast: {told}") from None
        points = np.stack([np.broadcast_to(i, lead) for i in (column, row)], axis=-1) + where
        rays = camera.rays_through(points, time=time)
        return self.intersect(*rays, threads=threads, time=camera.scene_time(time))

    def first_hits(
        self,
        camera: AnyCamera,
        offsets: ArrayLike = (0.5, 0.5),
        threads: int | None = None,
        time: float | None = None,
    ) -> Hits:
        """Find the hit at every pixel by rasterization: the same as ``intersect(*camera.rays(offsets))``.

        Faces are projected into the picture (Catmull 1974), and tested exactly, as in `intersect`, against
        the rays of the pixels that they may cover. Parts of the picture with too many faces are traced
        instead. The whole picture is traced if there are more faces than a quarter of its pixels, for curved
        shapes, and for cameras other than a static pinhole. ``report.first_hits`` measures the gain.

        Parameters
        ----------
        camera : Camera or another kind
            Camera of the picture.
        offsets : (2,) or (height, width, 2) array
            Position within the pixel, for all pixels or for each, as in `Camera.rays`.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        time : float, optional
            Time from 0, the default, as the camera's shutter opens to 1 as it closes.

        Returns
        -------
        Hits
            Of shape (height, width), row 0 on top: the same bits as ``intersect(*camera.rays(offsets))``. `t`
            is the distance from the camera, since directions are unit.

        Raises
        ------
        ValueError
            If `offsets` has another shape, or `time` is not between 0 and 1.
        TypeError
            If `camera` is not a Camera, or `offsets` are not real numbers.

        See Also
        --------
        aovs : Auxiliary buffers of the first hits, averaged over pixels.
        Scene.pick : The hits of some pixels.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere())
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=5, height=3)
        >>> hits = scene.first_hits(camera)
        >>> hits.hit.astype(int).tolist()
        [[0, 0, 0, 0, 0], [0, 0, 1, 0, 0], [0, 0, 0, 0, 0]]
        """
        if not isinstance(camera, AnyCamera):
            raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
        where = pixel_offsets(camera, offsets)
        core = self._core or self._compiled()
        moment = camera.scene_time(None if time is None else number("time", time))
        if core.curved or (time and camera.end_pose):
            return self.intersect(*camera.rays(where, time=time), threads=threads, time=moment)
        threads = thread_limit(threads)
        t, shape_id, primitive_id, uv, _ = _core.first_hits(core, camera, where, threads)
        return Hits(t, shape_id, primitive_id, uv, None, core)
