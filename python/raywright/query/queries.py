"""The questions that rays and points ask of a scene."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from .._core import CompiledScene
from ..arrays import SeedLike, indices, last_axis, number, thread_limit
from ..cameras import AnyCamera, pixel_offsets
from .all_hits import AllHits
from .cones import ConeCoverage, ConeTouches, cone_arguments, cone_solid_angle
from .hits import Hits, QueryCost, rewritten
from .interactions import Interactions, Rays
from .masks import Cull, ShapeMask, asked, counted
from .photons import Photons, photon_arguments
from .points import PointQueries
from .rays import AskedRays, flags, ray_arguments


class Queries(PointQueries):
    """What a compiled scene answers; asking compiles it."""

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
        out: Hits | None = None,
        mask: ArrayLike | None = None,
        shapes: ShapeMask | None = None,
        cull: Cull | None = None,
    ) -> Hits:
        """Find the closest hit of each ray.

        Parameters
        ----------
        origins, directions : (..., 3) arrays
            Rays, broadcast against each other; directions need not be unit. C-contiguous float32 and float64
            are read without a copy, other real types are converted to float64.
        t_min, t_max : float or (...) arrays
            The part of the ray that counts, in lengths of its direction, both ends included.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.
        time : float or (...) array, optional
            When the rays are asked, from 0 as the shutter opens, which it is if not given, to 1 as it closes:
            instances that move are where they then are.
        out : Hits, optional
            An earlier answer, of this scene or another, to as many rays of the same leading shape. Its arrays
            are written to and it is returned, so that a loop over batches allocates nothing; what it told
            before is gone.
        mask : (...) bool array, optional
            Which rays are asked, broadcast to their leading shape; the others hit nothing.
        shapes : (S,) bool array, str or sequence of str, optional
            Which of ``scene.shapes`` count, one bool for each of them or their names: as in a scene of these
            alone. An `Instance` counts as a whole.
        cull : {"back"}, optional
            Leaves out what is met from behind, where the geometric normal goes along with the ray. Of
            triangles that is decided exactly; of curved shapes and of copies by the normal as float64 has it.

        Returns
        -------
        Hits
            With the leading shape of the rays. Of hits at the same `t`, the one of the lowest
            (shape_id, instance, primitive).

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, `t_min` or `t_max` is NaN, or
            `time` is not between 0 and 1; if `out` is of another shape, or its arrays are among the rays or
            cannot be written to; if a mask has the wrong shape, or no shape has a name of `shapes`.
        TypeError
            If an array does not hold real numbers, `out` is no `Hits`, or a mask is not bool.

        Notes
        -----
        Rays with NaN, infinity or a zero direction (or one shorter than the least normal number) hit nothing.
        Hits are watertight: no ray passes between two faces that share an edge or a corner and count.
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = self._core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        if out is None:
            return Hits(*core.intersect(rays, None, what), core, known_by(core, rays))
        with rewritten(out, rays[4]) as arrays:
            answer = core.intersect(rays, arrays, what)
        out._tell(*answer, core, known_by(core, rays))
        return out

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
        out: NDArray[np.bool_] | None = None,
        mask: ArrayLike | None = None,
        shapes: ShapeMask | None = None,
        cull: Cull | None = None,
    ) -> NDArray[np.bool_]:
        """Find whether each ray hits anything between `t_min` and `t_max`.

        The same as ``intersect(...).hit``, and faster: a ray ends at the first hit that it meets. Takes and
        raises what `intersect` does, but for `out`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time, mask, shapes, cull
            As for `intersect`.
        out : (...) bool array, optional
            Where the answer is written, with the leading shape of the rays and C-contiguous; it is returned.

        Returns
        -------
        (...) bool
            With the leading shape of the rays.
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = self._core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        return core.occluded(rays, None if out is None else flags("out", out, rays[4]), what)

    def optical_depth(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Compute the optical depth of the media along each ray: the integral of their extinction.

        Rays go straight through all surfaces; only what these enclose counts, and what fills the scene.
        Whether a surface is in the way, `occluded` tells.

        Parameters
        ----------
        origins, directions, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        (..., 3) float64
            Of red, green and blue; 0 where there is nothing, and infinite along a ray without end in a medium
            without end.

        Raises
        ------
        ValueError
            As `intersect` does.
        TypeError
            As `intersect` does.

        Notes
        -----
        It is exact but for rounding, on a `GridMedium` too: its density is a polynomial along a ray in each
        of its cells. Where a medium is given by spectra, it is that of its colors.
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
        """Compute the share of light that media leave along each ray: exp(-`optical_depth`).

        Rays go straight through all surfaces, as for `optical_depth`, which keeps its digits where next to
        nothing gets through.

        Parameters
        ----------
        origins, directions, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        (..., 3) float64
            Of red, green and blue, from 0 to 1.

        Raises
        ------
        ValueError
            As `intersect` does.
        TypeError
            As `intersect` does.
        """
        return np.exp(-self.optical_depth(origins, directions, t_max, threads, time))

    def interactions(self, rays: Rays) -> Interactions:
        """Find what each ray of a batch meets, and all that shading needs of it.

        For integrators that are written in Python (see `Integrator`): what comes back tells emission, and
        answers whole batches of questions about scattering and light.

        Parameters
        ----------
        rays : Rays
            Rays of unit direction, as an integrator is given them or `Interactions.leave` makes them.

        Returns
        -------
        Interactions
            An entry a ray.

        Raises
        ------
        TypeError
            If `rays` are no `Rays`.
        ValueError
            If their arrays are not (N, 3), (N, 3) and (N,).
        """
        if not isinstance(rays, Rays):
            raise TypeError(f"rays must be raywright.Rays, got {type(rays).__name__}")
        core = self._core or self._compiled()
        return Interactions(_core.interactions(core, rays.origins, rays.directions, rays.time), rays)

    def intersect_all(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
        mask: ArrayLike | None = None,
        shapes: ShapeMask | None = None,
        cull: Cull | None = None,
    ) -> AllHits:
        """Find every hit of each ray, in order.

        Takes and raises what `intersect` does, and the first hit that it finds of each ray is that of
        `intersect`.

        Returns
        -------
        AllHits
            All hits one after the other, by ray, then `t`, then (shape_id, instance, primitive).

        Notes
        -----
        A surface is crossed once where a ray goes through an edge or a vertex of it, not once for each face
        there. Where a ray only touches an edge or a vertex, that is told twice, as if in and out: by two
        faces, or twice by the same one where the ray meets no other. So a closed surface has an even number
        of hits seen from outside, and an odd number from inside, however the ray is aimed. Faces that lie
        upon each other are all told.
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = self._core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        return AllHits(*core.intersect_all(rays, what), rays[4], core, known_by(core, rays))

    def count(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.int32]:
        """Count the hits of each ray: what `intersect_all` finds, without the memory for it.

        Takes and raises what `intersect` does.

        Returns
        -------
        (...) int32
            With the leading shape of the rays.
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        return (self._core or self._compiled()).count(rays)

    def cost(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> QueryCost:
        """Find what the closest hit of each ray takes: nodes visited and primitives tested.

        Takes and raises what `intersect` does. Neighbouring rays share visits, so a ray's cost may depend on
        which others are asked with it. A copy of an instance counts as one primitive, whatever it takes.

        Returns
        -------
        QueryCost
            With the leading shape of the rays.
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        return QueryCost(*(self._core or self._compiled()).cost(rays))

    def pick(
        self,
        camera: AnyCamera,
        x: ArrayLike,
        y: ArrayLike,
        offsets: ArrayLike = (0.5, 0.5),
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> Hits:
        """Find what is seen at a pixel, or at many: shape, face, place and distance.

        Parameters
        ----------
        camera : Camera or another kind
            Whose picture it is.
        x, y : int or (...) integer arrays
            Column and row of the pixel, broadcast against each other: (0, 0) is the upper left of the
            picture, (width - 1, height - 1) its lower right. For points between, such as mouse clicks in
            floating point, use ``intersect(*camera.rays_through(points))``.
        offsets : (2,) or (..., 2) array
            Where in the pixel, for all or for each, as `Camera.rays` has it: (0, 0) is its upper left, (1, 1)
            its lower right. The default is the centre.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.
        time : float or (...) array, optional
            When, from 0 as the camera's shutter opens, which it is if not given, to 1 as it closes.

        Returns
        -------
        Hits
            With the leading shape of the pixels: the same bits as ``intersect(*camera.rays(...))`` at these
            pixels. As directions are unit, `t` is the distance from the camera.

        Raises
        ------
        ValueError
            If a pixel is outside of the picture, `time` is not between 0 and 1, or shapes do not broadcast.
        TypeError
            If `camera` is not a Camera, `x` or `y` are not integers, or `offsets` are not real numbers.
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
        """Find what is seen at every pixel, by rasterising: what ``intersect(*camera.rays(offsets))`` finds.

        Faces are projected into the picture (Catmull 1974), and at the pixels that one may cover it is
        decided for the pixel's ray, exactly, as `intersect` does. Parts of the picture with too many faces
        are asked of the accelerator, and all of it is if there are more faces than a quarter of its pixels,
        something in the scene is no mesh, or the camera is not a pinhole that stands still.
        ``report.first_hits`` tells where it pays.

        Parameters
        ----------
        camera : Camera or another kind
            Whose picture it is.
        offsets : (2,) or (height, width, 2) array
            Where in the pixel, for all or for each, as `Camera.rays` has it.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.
        time : float, optional
            When, from 0 as the camera's shutter opens, which it is if not given, to 1 as it closes.

        Returns
        -------
        Hits
            Of shape (height, width), row 0 on top: the same bits as ``intersect(*camera.rays(offsets))``. As
            directions are unit, `t` is the distance from the camera.

        Raises
        ------
        ValueError
            If `offsets` has another shape, or `time` is not between 0 and 1.
        TypeError
            If `camera` is not a Camera, or `offsets` are not real numbers.
        """
        if not isinstance(camera, AnyCamera):
            raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
        where = pixel_offsets(camera, offsets)
        core = self._core or self._compiled()
        moment = camera.scene_time(None if time is None else number("time", time))
        if core.curved or (time and camera.moved_to):
            return self.intersect(*camera.rays(where, time=time), threads=threads, time=moment)
        threads = thread_limit(threads)
        t, shape_id, primitive, uv, _ = _core.first_hits(core, camera, where, threads)
        return Hits(t, shape_id, primitive, uv, None, core)

    def cone(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        half_angle: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> ConeTouches:
        """Find all faces that solid cones touch, the nearest first.

        A face is touched if any point of it, its edges and corners included, is in the cone, its surface
        included. Nothing hides what is behind it.

        Parameters
        ----------
        origins, directions : (..., 3) arrays
            Apexes and axes, broadcast against each other; directions need not be unit.
        half_angle : float or (...) array
            Between the axis and the surface, in degrees, at least 0 and less than 90. A cone of 0 is a ray.
        t_max : float or (...) array
            How far from the apex to look, this distance included, in the scene's unit whatever the length of
            the direction. A cone then ends in a part of a sphere.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        ConeTouches
            Faces by cone, then distance, then (shape_id, primitive).

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, `half_angle` is NaN or out of
            range, `t_max` is NaN, or something in the scene is no mesh.
        TypeError
            If an array does not hold real numbers.

        Notes
        -----
        Cones with NaN, infinity or a zero direction touch nothing. No face that has a point in the cone is
        missed. With M the distance from the apex to the farthest corner of a face, one that misses the cone
        by less than 2**-43 M may be told as well, and distances are those of a cone whose surface is moved by
        no more than that. Accelerators agree to the last bit.
        """
        core = self._core or self._compiled()
        arguments = cone_arguments(origins, directions, half_angle, t_max, threads)
        splits, distance, shape_id, primitive = _core.cones(core, *arguments)
        return ConeTouches(splits, shape_id, primitive, distance, arguments[4])

    def cone_coverage(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        half_angle: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> ConeCoverage:
        """Tell how much of solid cones is covered: the share of their directions that meet something.

        It is exact for meshes, whose faces hide parts of each other, and for one sphere (Tovchigrechko and
        Vakser 2001). Beyond that, what is behind a sphere counts by the share of the cone that the sphere
        leaves, as if both were strewn over it (Amanatides 1984).

        Parameters
        ----------
        origins, directions, half_angle, threads
            As in `cone`; `half_angle` is above 0.
        t_max : float or (...) array
            What is farther from the apex at its nearest point does not count.

        Returns
        -------
        ConeCoverage
            Solid angles and shares, (...) float64 each; 0 for cones with infinity or no direction, which
            touch nothing, as rays of that kind do, and NaN for cones with NaN.

        Raises
        ------
        ValueError
            As `cone`, and if `half_angle` is 0, or something in the scene is neither a mesh nor a `Sphere`.
        TypeError
            If an array does not hold real numbers.
        """
        core = self._core or self._compiled()
        arguments = cone_arguments(origins, directions, half_angle, t_max, threads)
        whole = cone_solid_angle(arguments[2])
        share = _core.cone_coverage(core, *arguments)
        return ConeCoverage(share * whole.reshape(share.shape if whole.ndim else ()), share)

    def photons(
        self,
        count: int,
        max_depth: int | None = None,
        roulette_depth: int = 4,
        seed: SeedLike = 0,
        threads: int | None = None,
    ) -> Photons:
        """Follow light from the lights, and note it at each surface that it comes to.

        So many paths start at lights, chosen by their power, at points by area and in directions by the
        cosine, and are scattered from surface to surface as light is, until they leave the scene, are
        absorbed by roulette, or have come to `max_depth` surfaces. Where a medium absorbs or scatters light
        on its way counts as a surface, and is noted as well.

        Parameters
        ----------
        count : int
            Paths, 1 to 2**31 - 1. Each surface that one comes to is a photon of about 200 bytes.
        max_depth : int, optional
            The greatest number of surfaces that a path comes to, at least 1. No limit if not given.
        roulette_depth : int
            Surfaces before Russian roulette begins, at least 0.
        seed : int, Generator or SeedSequence
            Picks the random numbers, 0 to 2**64 - 1.
        threads : int, optional
            How many to use; all cores if not given. The answer does not depend on it.

        Returns
        -------
        Photons
            In the order of the paths, and along each of the surfaces that it comes to.

        Raises
        ------
        ValueError
            If a number is out of its range, or light is in the scene that no path can start at: of what has
            no end, or moves in instances, or from outside on what has no end, or of a medium that glows.
        TypeError
            If a number is not an integer.
        KeyboardInterrupt
            At once, when Ctrl-C is pressed.
        """
        arguments = photon_arguments(count, max_depth, roulette_depth, seed, threads)
        return Photons.of(*_core.photons(self._core or self._compiled(), *arguments))


def known_by(core: CompiledScene, rays: AskedRays) -> tuple[Any, ...] | None:
    """Return what hits have to keep of their rays to know their points: nothing of meshes."""
    return (*rays[:2], 0.0 if rays[6] is None else rays[6]) if core.curved else None
