"""Queries of rays: the closest hit, any hit, all hits, and their cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import CompiledScene
from .all_hits import AllHits
from .compilable import Compilable
from .fields import Asked
from .hits import Hits, rewritten
from .masks import Counted, Cull, ShapeMask, asked, counted
from .rays import AskedRays, ray_arguments, written_to
from .traversal_cost import TraversalCost


class RayQueries(Compilable):
    """Queries of rays; the first one compiles the scene."""

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
            Ends of the ray, in units of the direction's length, both included.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.
        time : float or (...) array, optional
            Time of the rays, from 0 (the default), as the shutter opens, to 1, as it closes; it sets the
            position of moving instances.
        out : Hits or mapping of str to arrays, optional
            An earlier result, of any scene, for rays of the same leading shape. Its arrays are overwritten
            and it is returned, so a loop over batches allocates nothing. Or arrays by field, such as ``{"t":
            distances}``, C-contiguous and of the field's shape: any float type for t and uv, int32 for
            indices, bool for hit.
        mask : (...) bool array, optional
            Rays to trace, broadcast to their leading shape; the others hit nothing.
        shapes : (S,) bool array, str or sequence of str, optional
            Shapes to test: a bool for each of ``scene.shapes``, or names. The result is that of a scene of
            these shapes only. An `Instance` counts as a whole.
        cull : {"back"}, optional
            "back" ignores hits from behind, where the geometric normal points along the ray. The decision is
            exact for triangles; for curved shapes and copies it uses the normal in float64.
        fields : str or sequence of str, optional
            Attributes to compute and write: some of "t", "shape_id", "primitive_id", "uv", "instance_id" and
            "hit". "hit" alone takes a byte for each ray, as in `occluded`. By default those of the arrays in
            `out`, or else all.

        Returns
        -------
        Hits
            With the leading shape of the rays. Of hits at the same `t`, the lowest (shape_id, instance_id,
            primitive_id) wins. With `fields` or arrays, it has only these attributes and those that follow
            from them; an AttributeError names the fields that others need.

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
        core, what = self._counting(shapes, cull)
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

        The same as ``intersect(...).hit``, and faster: a ray ends at the first hit found. Arguments and
        errors are those of `intersect`, but for `out`.

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
        core, what = self._counting(shapes, cull)
        if out is not None:
            written_to("out", out, rays[4], (np.dtype(np.bool_),))
        return core.occluded(rays, out, what)

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
            All hits in order of ray, then `t`, then (shape_id, instance_id, primitive_id).

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
        core, what = self._counting(shapes, cull)
        return AllHits(*core.intersect_all(rays, what), rays[4], core, known_by(core, rays))

    def _counting(self, shapes: ShapeMask | None, cull: Cull | None) -> tuple[CompiledScene, Counted]:
        """Return the compiled scene, and which of its hits count."""
        core = self._core or self._compiled()
        return core, None if shapes is None and cull is None else counted(shapes, cull, core.shapes)

    def count_hits(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.int32]:
        """Count the hits of each ray, without storing them as `intersect_all` does.

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

        Arguments and errors are those of `intersect`. Neighboring rays share visits, so a ray's cost may
        depend on the other rays of the batch. A copy of an instance counts as one primitive.

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
