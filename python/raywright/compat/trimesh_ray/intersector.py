"""Ray queries on one trimesh mesh."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from ...arrays import integer, real_array
from ...query.rays import point_arguments
from ...scene.scene import Scene
from ...shapes.mesh import Mesh

Int64s = NDArray[np.int64]
Points = NDArray[np.float64]
_Cache: Any = trimesh.caching.Cache


class RayMeshIntersector:
    """Ray queries on a mesh, which may change between them.

    Parameters
    ----------
    geometry : trimesh.Trimesh
        The mesh.
    scale_to_box : bool
        Changes nothing: no size of a mesh needs scaling here. It exists for compatibility with
        ``trimesh.ray.ray_pyembree.RayMeshIntersector``.

    Raises
    ------
    TypeError
        If `geometry` is not a trimesh.Trimesh.

    See Also
    --------
    install : Replaces ``mesh.ray`` by it.
    Scene : Raywright's own interface.

    Notes
    -----
    Directions need not be unit. Rays with NaN, infinity or a zero direction hit nothing.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_ray import RayMeshIntersector
    >>> rays = RayMeshIntersector(trimesh.creation.box((2, 2, 2)))
    >>> rays.intersects_any([[0.1, 0.2, 5], [9, 9, 5]], [[0, 0, -1]] * 2).tolist()
    [True, False]
    """

    def __init__(self, geometry: trimesh.Trimesh, scale_to_box: bool = True) -> None:
        if not isinstance(geometry, trimesh.Trimesh):
            raise TypeError(f"geometry must be a trimesh.Trimesh, got {type(geometry).__name__}")
        self.mesh = geometry
        self._scale_to_box = scale_to_box
        self._cache = _Cache(id_function=geometry.__hash__)

    def intersects_location(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
    ) -> tuple[Points, Int64s, Int64s]:
        """Find where rays hit the mesh.

        Arguments, errors and order are those of `intersects_id`.

        Parameters
        ----------
        ray_origins, ray_directions, multiple_hits, max_hits
            As for `intersects_id`.

        Returns
        -------
        locations : (m, 3) float64
            Hit points.
        index_ray : (m,) int64
            Index of each hit's ray.
        index_tri : (m,) int64
            Index of each hit's face.

        See Also
        --------
        Scene.intersect_all : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_ray import RayMeshIntersector
        >>> rays = RayMeshIntersector(trimesh.creation.box((2, 2, 2)))
        >>> locations, index_ray, index_tri = rays.intersects_location([[0.1, 0.2, 5]], [[0, 0, -1]])
        >>> locations.round(6).tolist(), index_ray.tolist()
        ([[0.1, 0.2, 1.0], [0.1, 0.2, -1.0]], [0, 0])
        """
        primitive, ray, position = self._hits(ray_origins, ray_directions, multiple_hits, max_hits, True)
        return position, ray, primitive

    def intersects_id(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool = True,
        max_hits: int | None = None,
        return_locations: bool = False,
    ) -> tuple[Int64s, Int64s] | tuple[Int64s, Int64s, Points]:
        """Find which faces rays hit.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays
            The rays.
        multiple_hits : bool
            True for every hit of a ray, False for the first.
        max_hits : int, optional
            The most hits of a ray that are wanted, from the first on; all of them if not given.
        return_locations : bool
            Whether to return the hit points, too.

        Returns
        -------
        index_tri : (m,) int64
            Which face. All first hits of rays come first, then all second ones, and so on.
        index_ray : (m,) int64
            Index of each hit's ray.
        locations : (m, 3) float64
            Hit points; only with `return_locations`.

        Raises
        ------
        ValueError
            If an array is not (n, 3), the two differ in shape, or `max_hits` is less than 0.
        TypeError
            If an array does not hold real numbers, or `max_hits` is not an integer.

        See Also
        --------
        Scene.intersect_all : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_ray import RayMeshIntersector
        >>> rays = RayMeshIntersector(trimesh.creation.box((2, 2, 2)))
        >>> index_tri, index_ray = rays.intersects_id([[0.1, 0.2, 5]], [[0, 0, -1]], max_hits=1)
        >>> len(index_tri), index_ray.tolist()
        (1, [0])
        """
        primitive, ray, position = self._hits(
            ray_origins, ray_directions, multiple_hits, max_hits, return_locations
        )
        return (primitive, ray, position) if return_locations else (primitive, ray)

    def intersects_first(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.int32]:
        """Find the first face that each ray hits.

        Arguments and errors are those of `intersects_id`.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays
            The rays.

        Returns
        -------
        (n,) int32
            Index of the face; -1 for none.

        See Also
        --------
        Scene.intersect : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_ray import RayMeshIntersector
        >>> rays = RayMeshIntersector(trimesh.creation.box((2, 2, 2)))
        >>> bool((rays.intersects_first([[0.1, 0.2, 5], [9, 9, 5]], [[0, 0, -1]] * 2) >= 0).sum() == 1)
        True
        """
        hits = self._scene.intersect(*_rays(ray_origins, ray_directions))
        return hits.primitive_id.copy()

    def intersects_any(self, ray_origins: ArrayLike, ray_directions: ArrayLike) -> NDArray[np.bool_]:
        """Find whether each ray hits anything: (n,) bool.

        Arguments and errors are those of `intersects_id`.

        Parameters
        ----------
        ray_origins, ray_directions : (n, 3) arrays
            The rays.

        Returns
        -------
        (n,) bool array

        See Also
        --------
        Scene.occluded : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_ray import RayMeshIntersector
        >>> rays = RayMeshIntersector(trimesh.creation.box((2, 2, 2)))
        >>> rays.intersects_any([[0.1, 0.2, 5], [9, 9, 5]], [[0, 0, -1]] * 2).tolist()
        [True, False]
        """
        return self._scene.occluded(*_rays(ray_origins, ray_directions))

    def contains_points(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Find whether each point is inside the mesh: (n,) bool.

        As in trimesh, a point is inside if a ray from there crosses the mesh an odd number of times. The test
        is exact; for open meshes it is the majority of seven rays.

        Parameters
        ----------
        points : (n, 3) array
            The points.

        Returns
        -------
        (n,) bool array

        Raises
        ------
        ValueError
            If the array is not (n, 3).
        TypeError
            If it does not hold real numbers.

        See Also
        --------
        Scene.contains : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_ray import RayMeshIntersector
        >>> box = trimesh.creation.box((2, 2, 2))
        >>> RayMeshIntersector(box).contains_points([[0, 0, 0], [0, 0, 3]]).tolist()
        [True, False]
        """
        core = self._scene._compiled()
        return core.contains(*point_arguments(triples("points", points), None), is_even_odd=True)

    @property
    def _scene(self) -> Scene:
        """The current mesh."""

        def make() -> Scene:
            # No precision of the vertices is lost; the core stores float32 if that is exact.
            return Scene(Mesh(self.mesh.vertices, self.mesh.faces), precision="double").welded()

        scene: Scene = self._kept("scene", make)
        return scene

    def _kept(self, name: str, make: Callable[[], Any]) -> Any:
        """Return what was made of the mesh as it is now, and make it if that has not been done."""
        # The cache clears itself when the hash of the mesh changes.
        value = self._cache[name]
        if value is None:
            value = self._cache[name] = make()
        return value

    def _hits(
        self,
        ray_origins: ArrayLike,
        ray_directions: ArrayLike,
        multiple_hits: bool,
        max_hits: int | None,
        with_positions: bool,
    ) -> tuple[Int64s, Int64s, Points]:
        """Find faces, rays and, if wanted, positions, in the order of `intersects_id`."""
        rays = _rays(ray_origins, ray_directions)
        most = None if max_hits is None else integer("max_hits", max_hits, 0)
        if multiple_hits and most != 1:
            found = self._scene.intersect_all(*rays)
            depth = np.arange(found.t.size) - found.ray_splits[found.ray]
            # Small integers are radix-sorted, in linear time.
            depth = depth.astype(np.min_scalar_type(depth.max(initial=0)), copy=False)
            which = np.argsort(depth, kind="stable")
            if most is not None:
                which = which[: np.searchsorted(depth, most, sorter=which)]
            primitive, ray = found.primitive_id[which], found.ray[which]
            position = found.position[which] if with_positions else np.empty((0, 3))
        else:
            first = self._scene.intersect(*rays)
            ray = np.flatnonzero(first.hit) if most != 0 else np.empty(0, np.intp)
            primitive = first.primitive_id[ray]
            position = first.position[ray] if with_positions else np.empty((0, 3))
        return primitive.astype(np.int64), ray.astype(np.int64, copy=False), position

    def __getstate__(self) -> dict[str, Any]:
        return {"mesh": self.mesh, "_scale_to_box": self._scale_to_box}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self.__init__(state["mesh"], state["_scale_to_box"])  # type: ignore[misc]

    def __copy__(self) -> RayMeshIntersector:
        return RayMeshIntersector(self.mesh, self._scale_to_box)

    def __deepcopy__(self, memo: dict[int, Any]) -> RayMeshIntersector:
        # The copy shares the mesh, as in trimesh.
        return self.__copy__()

    def __repr__(self) -> str:
        return f"RayMeshIntersector({len(self.mesh.faces)} faces)"


def triples(name: str, value: ArrayLike) -> NDArray[Any]:
    """Return an array of shape (n, 3); an empty list is one of shape (0, 3)."""
    array = real_array(name, value)
    if array.shape == (0,):
        array = array.reshape(0, 3)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} must have shape (n, 3), got {array.shape}")
    return array


def _rays(origins: ArrayLike, directions: ArrayLike) -> tuple[NDArray[Any], NDArray[Any]]:
    starts, ways = triples("ray_origins", origins), triples("ray_directions", directions)
    if starts.shape != ways.shape:
        raise ValueError(f"ray_origins and ray_directions differ in shape: {starts.shape} and {ways.shape}")
    return starts, ways
