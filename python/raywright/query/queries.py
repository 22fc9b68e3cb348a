"""The questions that rays and points ask of a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from .._core import CompiledScene
from ..arrays import SeedLike, indices, last_axis, number, thread_limit
from ..cameras import AnyCamera, pixel_offsets
from .all_hits import AllHits
from .cones import ConeCoverage, ConeFaces, cone_arguments, cone_solid_angle
from .fields import Asked
from .hits import Hits, TraversalCost, rewritten
from .interactions import Interactions, Rays
from .masks import Counted, Cull, ShapeMask, asked, counted
from .photons import Photons, photon_arguments
from .points import PointQueries
from .previews import Previews
from .rays import AskedRays, ray_arguments, written_to


class Queries(PointQueries, Previews):
    """What a compiled scene answers; asking compiles it."""

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
        out: Hits | Mapping[str, NDArray[Any]] | None = None,
        mask: ArrayLike | None = None,
        shapes: ShapeMask | None = None,
        cull: Cull | None = None,
        fields: str | Sequence[str] | None = None,
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
            Number of threads; all cores if not given. The answer does not depend on it.
        time : float or (...) array, optional
            When the rays are asked, from 0 as the shutter opens, which it is if not given, to 1 as it closes:
            instances that move are where they then are.
        out : Hits or mapping of str to arrays, optional
            An earlier answer, of this scene or another, to as many rays of the same leading shape. Its arrays
            are written to and it is returned, so that a loop over batches allocates nothing; what it told
            before is gone. Or arrays by name of field, such as ``{"t": distances}``, C-contiguous and of the
            shape that the field has: of any float type for t and uv, int32 for numbers, bool for hit.
        mask : (...) bool array, optional
            Rays to trace, broadcast to their leading shape; the others hit nothing.
        shapes : (S,) bool array, str or sequence of str, optional
            Shapes that count, one bool for each of ``scene.shapes`` or their names: as in a scene of these
            alone. An `Instance` counts as a whole.
        cull : {"back"}, optional
            Leaves out what is met from behind, where the geometric normal goes along with the ray. Of
            triangles that is decided exactly; of curved shapes and of copies by the normal as float64 has it.
        fields : str or sequence of str, optional
            The parts of the answer that are wanted, of "t", "shape_id", "primitive_id", "uv", "instance_id"
            and "hit"; only these are computed and written. "hit" alone is a byte a ray, as `occluded` has it.
            Those of the arrays in `out` if not given, and all without such arrays.

        Returns
        -------
        Hits
            With the leading shape of the rays. Of hits at the same `t`, the one of the lowest
            (shape_id, instance_id, primitive_id). Where `fields` are given, or arrays, it has these parts and
            what follows from them; an AttributeError tells which parts others would need.

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, `t_min` or `t_max` is NaN, or
            `time` is not between 0 and 1; if `out` is of another shape, or its arrays are among the rays or
            cannot be written to; if a mask has the wrong shape, or no shape has a name of `shapes`; if a
            field is not known, or `out` has an array that is not among `fields`.
        TypeError
            If an array does not hold real numbers, `out` is neither `Hits` nor a mapping, an array in it has
            another type, or a mask is not bool.

        See Also
        --------
        Scene.occluded : Test whether each ray hits anything.
        Scene.intersect_all : Find every hit of each ray.
        Scene.first_hits : Find the hits of a camera's pixels.

        Notes
        -----
        Rays with NaN, infinity or a zero direction (or one shorter than the least normal number) hit nothing.
        Hits are watertight: no ray passes between two faces that share an edge or a corner and count.

        Examples
        --------
        >>> scene = rw.Scene(rw.Box((-1, -1, -1), (1, 1, 1)))
        >>> hits = scene.intersect([[0, 0, 5], [3, 0, 5]], [0, 0, -1])
        >>> hits.hit.tolist(), hits.t.tolist()
        ([True, False], [4.0, inf])
        >>> hits.position[0].tolist(), hits.normal[0].tolist()
        ([0.0, 0.0, 1.0], [0.0, 0.0, 1.0])
        """
        core = self._core
        are_usual = threads is None and time is None and mask is None and shapes is None and cull is None
        if core and are_usual and out is None and fields is None:
            found = core.intersect_plain(origins, directions, t_min, t_max)
            if found is not None:
                return Hits._on_meshes(*found, core)
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        if fields is not None or isinstance(out, Mapping):
            return _some_of(core, rays, what, fields, out)
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

        The same as ``intersect(...).hit``, and faster: a ray ends at the first hit that it meets. Arguments
        and errors are those of `intersect`, but for `out`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time, mask, shapes, cull
            As for `intersect`.
        out : (...) bool array, optional
            Array for the answer, with the leading shape of the rays and C-contiguous; it is returned.

        Returns
        -------
        (...) bool
            With the leading shape of the rays.

        See Also
        --------
        Scene.intersect : Find the closest hit.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere())
        >>> scene.occluded([0, 0, 5], [[0, 0, -1], [0, 0, 1], [1, 0, 0]]).tolist()
        [True, False, False]
        >>> scene.occluded([0, 0, 5], [0, 0, -1], t_max=3.0).item()
        False
        """
        core = self._core
        are_usual = threads is None and time is None and mask is None and shapes is None and cull is None
        if core and are_usual and out is None:
            found = core.occluded_plain(origins, directions, t_min, t_max)
            if found is not None:
                return found
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        if out is not None:
            written_to("out", out, rays[4], (np.dtype(np.bool_),))
        return core.occluded(rays, out, what)

    def optical_depth(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Compute the optical depth of the media along each ray: the integral of their extinction.

        Surfaces do not stop the rays; only the media that they enclose count, and the scene's own medium.
        `occluded` tests for surfaces in the way.

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
        """Compute the share of light that media leave along each ray: exp(-`optical_depth`).

        Surfaces do not stop the rays, as for `optical_depth`, which keeps its digits for tiny transmittances.

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

    def interactions(self, rays: Rays) -> Interactions:
        """Find the surface interaction of each ray: the hit, with its scattering and its light.

        It is for integrators written in Python (see `Integrator`): the result has the emission, and samples
        scattering and light for the whole batch.

        Parameters
        ----------
        rays : Rays
            Rays of unit direction, as an integrator is given them or `Interactions.spawn_rays` makes them.

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

        See Also
        --------
        integrators.Integrator : The base class of integrators written in Python.
        Scene.intersect : Hits alone, of rays of any length.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere(material=rw.Diffuse(0.8)), environment=1.0)
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = scene.interactions(rays)
        >>> met.t.tolist(), met.albedo.round(2).tolist()
        ([2.0], [[0.8, 0.8, 0.8]])
        """
        if not isinstance(rays, Rays):
            raise TypeError(f"rays must be raywright.query.Rays, got {type(rays).__name__}")
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

        Arguments and errors are those of `intersect`, and the first hit of each ray is that of `intersect`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time, mask, shapes, cull
            As for `intersect`.

        Returns
        -------
        AllHits
            All hits one after the other, by ray, then `t`, then (shape_id, instance_id, primitive_id).

        See Also
        --------
        Scene.count_hits : Count the hits alone.
        Scene.intersect : Find the closest hit.

        Notes
        -----
        A surface is crossed once where a ray goes through an edge or a vertex of it, not once for each face
        there. A ray that only touches an edge or a vertex gets two hits there, as if in and out: of two
        faces, or twice of the same one if the ray meets no other. A closed surface thus has an even number of
        hits seen from outside, and an odd number from inside, for every ray. Hits of coincident faces are all
        listed.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere())
        >>> hits = scene.intersect_all([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
        >>> hits.count.tolist(), hits.t.tolist()
        ([2, 0], [4.0, 6.0])
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), mask)
        core = self._core or self._compiled()
        what = None if shapes is None and cull is None else counted(shapes, cull, core.shapes)
        return AllHits(*core.intersect_all(rays, what), rays[4], core, known_by(core, rays))

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.int32]:
        """Count the hits of each ray, as `intersect_all` finds them, without the memory for them.

        Arguments and errors are those of `intersect`.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        (...) int32
            With the leading shape of the rays.

        See Also
        --------
        Scene.intersect_all : The hits themselves.

        Examples
        --------
        >>> scene = rw.Scene([rw.Sphere(), rw.Disk(radius=9)])
        >>> scene.count_hits([[0, 0, 5], [4, 0, 5]], [0, 0, -1]).tolist()
        [3, 1]
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        return (self._core or self._compiled()).count_hits(rays)

    def traversal_cost(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> TraversalCost:
        """Count the nodes visited and primitives tested for the closest hit of each ray.

        Arguments and errors are those of `intersect`. Neighbouring rays share visits, so a ray's cost may
        depend on the others of the batch. A copy of an instance counts as one primitive.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time
            As for `intersect`.

        Returns
        -------
        TraversalCost
            With the leading shape of the rays.

        See Also
        --------
        report.heatmap : The cost of a camera's rays, as a picture.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> cost = scene.traversal_cost([0, 0, 9], [[0, 0, -1], [0, 0, 1]])
        >>> cost.nodes.shape, int(cost.primitives[1])
        ((2,), 0)
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        return TraversalCost(*(self._core or self._compiled()).traversal_cost(rays))

    def pick(
        self,
        camera: AnyCamera,
        x: ArrayLike,
        y: ArrayLike,
        offsets: ArrayLike = (0.5, 0.5),
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> Hits:
        """Find the shape, face, place and distance at a pixel, or at many.

        Parameters
        ----------
        camera : Camera or another kind
            Camera of the picture.
        x, y : int or (...) integer arrays
            Column and row of the pixel, broadcast against each other: (0, 0) is the upper left of the
            picture, (width - 1, height - 1) its lower right. For points between, such as mouse clicks in
            floating point, use ``intersect(*camera.rays_through(points))``.
        offsets : (2,) or (..., 2) array
            Place in the pixel, for all or for each, as in `Camera.rays`: (0, 0) is its upper left, (1, 1) its
            lower right. The default is the centre.
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
        instead, and all of it is if there are more faces than a quarter of its pixels, something in the scene
        is no mesh, or the camera is not a pinhole that stands still. ``report.first_hits`` measures the gain.

        Parameters
        ----------
        camera : Camera or another kind
            Camera of the picture.
        offsets : (2,) or (height, width, 2) array
            Place in the pixel, for all or for each, as in `Camera.rays`.
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

    def faces_in_cone(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        half_angle: ArrayLike,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
    ) -> ConeFaces:
        """Find all faces that solid cones touch, the nearest first.

        A face is touched if any point of it, its edges and corners included, is in the cone, its surface
        included. There is no occlusion.

        Parameters
        ----------
        origins, directions : (..., 3) arrays
            Apexes and axes, broadcast against each other; directions need not be unit.
        half_angle : float or (...) array
            Angle between the axis and the surface, in degrees, at least 0 and less than 90. A cone of 0 is a
            ray.
        t_max : float or (...) array
            Maximum distance from the apex, inclusive, in the scene's unit whatever the length of the
            direction. A cone then ends in a part of a sphere.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.

        Returns
        -------
        ConeFaces
            Faces by cone, then distance, then (shape_id, primitive_id).

        Raises
        ------
        ValueError
            If a last dimension is not 3, leading shapes do not broadcast, `half_angle` is NaN or out of
            range, `t_max` is NaN, or something in the scene is no mesh.
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
        """Compute the covered share of solid cones: the share of their directions that meet something.

        It is exact for meshes, whose faces hide parts of each other, and for one sphere (Tovchigrechko and
        Vakser 2001). Beyond that, coverage behind a sphere counts by the share of the cone that the sphere
        leaves, as if both were spread evenly (Amanatides 1984).

        Parameters
        ----------
        origins, directions, half_angle, threads
            As in `faces_in_cone`; `half_angle` is above 0.
        t_max : float or (...) array
            Maximum distance: a shape whose nearest point is farther from the apex does not count.

        Returns
        -------
        ConeCoverage
            Solid angles and shares, (...) float64 each; 0 for cones with infinity or no direction, which
            touch nothing, as rays of that kind do, and NaN for cones with NaN.

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

    def photons(
        self,
        count: int,
        max_depth: int | None = None,
        roulette_depth: int = 4,
        seed: SeedLike = 0,
        threads: int | None = None,
    ) -> Photons:
        """Trace photons from the lights, and record them at each surface that they meet.

        Paths start at lights, chosen by their power, at points by area and in directions by the cosine. They
        are scattered from surface to surface as light is, until they leave the scene, are absorbed by
        roulette, or have met `max_depth` surfaces. Absorption and scattering events in media count as
        surfaces, and are recorded as well.

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
            Number of threads; all cores if not given. The answer does not depend on it.

        Returns
        -------
        Photons
            In the order of the paths, and along each of the surfaces that it comes to.

        Raises
        ------
        ValueError
            If a number is out of its range, or no path can start at a light of the scene: infinite emitters,
            emitters that move in instances, light from outside on infinite shapes, or media that glow.
        TypeError
            If a number is not an integer.
        KeyboardInterrupt
            At once, when Ctrl-C is pressed.

        See Also
        --------
        PhotonMap : Renders from photons.

        Examples
        --------
        >>> lamp = rw.PointLight((0, 0, 3), intensity=1.0)
        >>> scene = rw.Scene(rw.Sphere(material=rw.Diffuse(0.5)), lights=[lamp])
        >>> photons = scene.photons(1000, max_depth=1)
        >>> photons.positions.shape[1], np.round(photons.emitted, 4).tolist()
        (3, [12.5664, 12.5664, 12.5664])
        """
        arguments = photon_arguments(count, max_depth, roulette_depth, seed, threads)
        return Photons._of(*_core.photons(self._core or self._compiled(), *arguments))


def known_by(core: CompiledScene, rays: AskedRays) -> tuple[Any, ...] | None:
    """Return the data of rays that hits need for their points: none on meshes."""
    return (*rays[:2], 0.0 if rays[6] is None else rays[6]) if core.curved else None


def _some_of(core: CompiledScene, rays: AskedRays, what: Counted, fields: Any, out: Any) -> Hits:
    """Return hits of which only some parts are computed."""
    if isinstance(out, Hits):
        raise TypeError("out must be arrays by name where fields are given, got Hits")
    if out is not None and not isinstance(out, Mapping):
        raise TypeError(f"out must be arrays by name where fields are given, got {type(out).__name__}")
    asked_for = Asked(fields, out or {}, rays[4])
    if asked_for.is_hit_alone:
        parts = {"hit": core.occluded(rays, asked_for.out.get("hit"), what)}
    else:
        parts = asked_for.told(core.intersect(rays, asked_for.given(), what, asked_for.bits))
    hits = Hits.__new__(Hits)
    return hits._tell_some(parts, asked_for.names, None if asked_for.is_lent else core, known_by(core, rays))
