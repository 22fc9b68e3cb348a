"""Ray and point queries on triangle meshes, as in Open3D."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ...arrays import integer
from ...query.rays import point_arguments
from ...scene.scene import Scene
from ...shapes.mesh import Mesh
from .arguments import ends_of, parts_of, points_of, threads_of
from .pinhole import pinhole_rays
from .tensors import array_of, ids, is_tensor, single, tensor_of

_INVALID = 2**32 - 1


class RaycastingScene:
    """Triangle meshes for rays and points; meshes can be added between queries.

    It takes arrays of numpy and anything that becomes one, of any real type, beside tensors of Open3D.
    Results are tensors if an argument, or a mesh of the scene, is of Open3D, and arrays otherwise.

    Parameters
    ----------
    nthreads : int
        Changes nothing: the accelerator is built on all cores, at the first query.
    device : open3d.core.Device or str
        A CPU.

    Raises
    ------
    ValueError
        If the device is not a CPU.

    See Also
    --------
    install : Replaces Open3D's class by this one.
    Scene : Raywright's own interface.

    Notes
    -----
    All results have the dtypes of Open3D: float32 for numbers and uint32 for ids. Vertices and rays are not
    rounded before.

    Examples
    --------
    >>> from raywright.compat.open3d import RaycastingScene
    >>> scene = RaycastingScene()
    >>> _ = scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
    >>> scene.cast_rays([[1, 1, 5, 0, 0, -1]])["t_hit"].tolist()
    [5.0]
    """

    INVALID_ID: ClassVar[int] = _INVALID
    """The id of a miss."""

    _returns_tensors: ClassVar[bool] = False

    def __init__(self, nthreads: int = 0, device: Any = "CPU:0") -> None:
        integer("nthreads", nthreads, 0)
        if not str(device).upper().startswith("CPU"):
            raise ValueError(f"device must be a CPU, got {device}")
        self._meshes: list[Mesh] = []
        self._has_tensors = self._returns_tensors
        self._scene: Scene | None = None

    def add_triangles(
        self, vertex_positions: Any = None, triangle_indices: Any = None, mesh: Any = None
    ) -> int:
        """Add a mesh: ``add_triangles(vertex_positions, triangle_indices)`` or ``add_triangles(mesh)``.

        Parameters
        ----------
        vertex_positions : (V, 3) array or Tensor
            The vertices.
        triangle_indices : (F, 3) integer array or Tensor
            Three vertices for each triangle.
        mesh : open3d.t.geometry.TriangleMesh
            Mesh in place of the two; or anything else with vertices, and triangles or faces.

        Returns
        -------
        int
            The id of the mesh: 0 for the first, 1 for the second, ...

        Raises
        ------
        ValueError
            If an array has the wrong shape, an index has no vertex, or a tensor is not on the CPU.
        TypeError
            If an array has the wrong type, or the arguments are others.

        See Also
        --------
        Mesh.of : Meshes of other libraries.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> scene = RaycastingScene()
        >>> scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        0
        >>> scene.add_triangles([[0, 0, 1], [4, 0, 1], [0, 4, 1]], [[0, 1, 2]])
        1
        """
        vertices, faces = vertex_positions, triangle_indices
        if faces is None:
            if (vertices is None) == (mesh is None):
                raise TypeError("add_triangles takes vertex_positions and triangle_indices, or a mesh")
            vertices, faces = parts_of(vertices if mesh is None else mesh)
        made = Mesh(array_of("vertex_positions", vertices), array_of("triangle_indices", faces))
        self._has_tensors |= is_tensor(vertices) or is_tensor(faces)
        self._meshes.append(made)
        self._scene = None
        return len(self._meshes) - 1

    def cast_rays(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """Find the first hit of each ray.

        Parameters
        ----------
        rays : (..., 6) array or Tensor
            Origin and direction of each ray, which need not be unit.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        dict
            ``t_hit`` (...) float32, inf for a miss; ``geometry_ids`` and ``primitive_ids`` (...) uint32,
            `INVALID_ID` for a miss; ``primitive_uvs`` (..., 2) float32 and ``primitive_normals`` (..., 3)
            float32, 0 for a miss.

        Raises
        ------
        ValueError
            If the last dimension is not 6, or a tensor is not on the CPU.
        TypeError
            If the array does not hold real numbers.

        See Also
        --------
        Scene.intersect : Raywright's own query.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> hits = scene.cast_rays([[1, 1, 5, 0, 0, -1], [9, 9, 5, 0, 0, -1]])
        >>> hits["t_hit"].tolist(), hits["primitive_ids"].tolist()
        ([5.0, inf], [0, 4294967295])
        """
        hits = self._compiled.intersect(*ends_of(rays), threads=threads_of(nthreads))
        answer = {
            "t_hit": single(hits.t),
            "geometry_ids": ids(hits.shape_id),
            "primitive_ids": ids(hits.primitive_id),
            "primitive_uvs": single(hits.uv),
            "primitive_normals": single(np.where(hits.hit[..., np.newaxis], hits.normal, 0)),
        }
        return self._all_told(answer, rays)

    def test_occlusions(self, rays: Any, tnear: float = 0.0, tfar: float = np.inf, nthreads: int = 0) -> Any:
        """Find whether each ray hits anything between `tnear` and `tfar`: (...) bool.

        Arguments and errors are those of `cast_rays`. Both ends count, in lengths of the direction.

        Parameters
        ----------
        rays : (..., 6) array or Tensor
            Origin and direction of each ray, which need not be unit.
        tnear, tfar : float
            The part of the ray that counts, both ends included, in lengths of the direction.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        (...) bool array or Tensor

        See Also
        --------
        Scene.occluded : Raywright's own query.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> scene.test_occlusions([[1, 1, 5, 0, 0, -1], [9, 9, 5, 0, 0, -1]]).tolist()
        [True, False]
        """
        ends = float(tnear), float(tfar)
        return self._told(self._compiled.occluded(*ends_of(rays), *ends, threads=threads_of(nthreads)), rays)

    def count_intersections(self, rays: Any, nthreads: int = 0) -> Any:
        """Count how often each ray crosses the meshes: (...) int32.

        Arguments and errors are those of `cast_rays`.

        Parameters
        ----------
        rays : (..., 6) array or Tensor
            Origin and direction of each ray, which need not be unit.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        (...) int32 array or Tensor

        See Also
        --------
        Scene.count_hits : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.open3d import RaycastingScene
        >>> box = trimesh.creation.box((2, 2, 2))
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles(box.vertices, box.faces)
        >>> scene.count_intersections([[0.1, 0.2, 5, 0, 0, -1]]).tolist()
        [2]
        """
        count = self._compiled.count_hits(*ends_of(rays), threads=threads_of(nthreads))
        return self._told(count.astype(np.int32), rays)

    def list_intersections(self, rays: Any, nthreads: int = 0) -> dict[str, Any]:
        """Find every hit of each ray, by ray and then along it.

        Arguments and errors are those of `cast_rays`.

        Parameters
        ----------
        rays : (..., 6) array or Tensor
            Origin and direction of each ray, which need not be unit.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        dict
            ``ray_splits`` (N + 1,) uint32, between which the K hits of each of the N rays are; ``ray_ids``,
            ``geometry_ids`` and ``primitive_ids`` (K,) uint32; ``t_hit`` (K,) and ``primitive_uvs`` (K, 2)
            float32.

        See Also
        --------
        Scene.intersect_all : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.open3d import RaycastingScene
        >>> box = trimesh.creation.box((2, 2, 2))
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles(box.vertices, box.faces)
        >>> hits = scene.list_intersections([[0.1, 0.2, 5, 0, 0, -1]])
        >>> hits["t_hit"].tolist(), hits["ray_splits"].tolist()
        ([4.0, 6.0], [0, 2])
        """
        hits = self._compiled.intersect_all(*ends_of(rays), threads=threads_of(nthreads))
        answer = {
            "ray_splits": hits.ray_splits.astype(np.uint32),
            "ray_ids": hits.ray.astype(np.uint32),
            "t_hit": single(hits.t),
            "geometry_ids": ids(hits.shape_id),
            "primitive_ids": ids(hits.primitive_id),
            "primitive_uvs": single(hits.uv),
        }
        return self._all_told(answer, rays)

    def compute_closest_points(self, query_points: Any, nthreads: int = 0) -> dict[str, Any]:
        """Find the closest point of the meshes to each point.

        Parameters
        ----------
        query_points : (..., 3) array or Tensor
            The points.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        dict
            ``points`` and ``primitive_normals`` (..., 3) float32, ``primitive_uvs`` (..., 2) float32,
            ``geometry_ids`` and ``primitive_ids`` (...) uint32. Without any mesh, and for points that are
            not finite, coordinates are 0 and ids are `INVALID_ID`.

        Raises
        ------
        ValueError
            If the last dimension is not 3, or a tensor is not on the CPU.
        TypeError
            If the array does not hold real numbers.

        See Also
        --------
        Scene.closest_point : Raywright's own query.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> scene.compute_closest_points([[1, 1, 3]])["points"].tolist()
        [[1.0, 1.0, 0.0]]
        """
        found = self._compiled.closest_point(points_of(query_points), threads=threads_of(nthreads))
        has = found.found[..., np.newaxis]
        answer = {
            "points": single(np.where(has, found.position, 0)),
            "geometry_ids": ids(found.shape_id),
            "primitive_ids": ids(found.primitive_id),
            "primitive_uvs": single(np.where(has, found.uv, 0)),
            "primitive_normals": single(np.where(has, found.normal, 0)),
        }
        return self._all_told(answer, query_points)

    def compute_distance(self, query_points: Any, nthreads: int = 0) -> Any:
        """Compute the distance of each point from the meshes: (...) float32.

        Arguments and errors are those of `compute_closest_points`. It is inf without any mesh.

        Parameters
        ----------
        query_points : (..., 3) array or Tensor
            The points.
        nthreads : int
            Number of threads; 0 for all cores.

        Returns
        -------
        (...) float32 array or Tensor

        See Also
        --------
        Scene.closest_point : Raywright's own query.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles([[0, 0, 0], [4, 0, 0], [0, 4, 0]], [[0, 1, 2]])
        >>> scene.compute_distance([[1, 1, 3]]).tolist()
        [3.0]
        """
        found = self._compiled.closest_point(points_of(query_points), threads=threads_of(nthreads))
        return self._told(single(found.distance), query_points)

    def compute_signed_distance(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """Compute the signed distance of each point from the meshes, negative inside: (...) float32.

        Arguments and errors are those of `compute_occupancy`, which decides what is inside.

        Parameters
        ----------
        query_points : (..., 3) array or Tensor
            The points.
        nthreads : int
            Number of threads; 0 for all cores.
        nsamples : int
            An odd number, which changes nothing: no ray is lost on an edge.

        Returns
        -------
        (...) float32 array or Tensor

        See Also
        --------
        Scene.signed_distance : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.open3d import RaycastingScene
        >>> box = trimesh.creation.box((2, 2, 2))
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles(box.vertices, box.faces)
        >>> scene.compute_signed_distance([[0, 0, 0], [0, 0, 3]]).tolist()
        [-1.0, 2.0]
        """
        inside = self._inside(query_points, nthreads, nsamples)
        found = self._compiled.closest_point(points_of(query_points), threads=threads_of(nthreads))
        signed = np.where(inside & (found.distance > 0), -found.distance, found.distance)
        return self._told(single(signed), query_points)

    def compute_occupancy(self, query_points: Any, nthreads: int = 0, nsamples: int = 1) -> Any:
        """Find whether each point is inside the meshes: (...) float32, 1 inside and 0 outside.

        A point is inside if a ray from there crosses all meshes together an odd number of times. The test is
        exact, with points on a surface inside; for open meshes it is the majority of seven rays.

        Parameters
        ----------
        query_points : (..., 3) array or Tensor
            The points.
        nthreads : int
            Number of threads; 0 for all cores.
        nsamples : int
            An odd number, which changes nothing: no ray is lost on an edge.

        Returns
        -------
        (...) float32 array or Tensor

        Raises
        ------
        ValueError
            If the last dimension is not 3, a tensor is not on the CPU, or `nsamples` is not odd.
        TypeError
            If the array does not hold real numbers.

        See Also
        --------
        Scene.contains : Raywright's own query.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.open3d import RaycastingScene
        >>> box = trimesh.creation.box((2, 2, 2))
        >>> scene = RaycastingScene()
        >>> _ = scene.add_triangles(box.vertices, box.faces)
        >>> scene.compute_occupancy([[0, 0, 0], [0, 0, 3]]).tolist()
        [1.0, 0.0]
        """
        return self._told(single(self._inside(query_points, nthreads, nsamples)), query_points)

    @classmethod
    def create_rays_pinhole(cls, *args: Any, **kwargs: Any) -> Any:
        """Return the rays through the centers of a pinhole camera's pixels: (height_px, width_px, 6) float32.

        Parameters
        ----------
        *args, **kwargs
            In one of two forms. Either ``intrinsic_matrix``, (3, 3), from the camera to pixels,
            ``extrinsic_matrix``, (4, 4), from the world to the camera, ``width_px`` and ``height_px``. Or
            ``fov_deg``, the horizontal field of view in degrees, ``center``, the target of the camera,
            ``eye``, its place, ``up``, the direction in which rows of pixels follow each other, as in Open3D,
            ``width_px`` and ``height_px``.

        Returns
        -------
        array or Tensor
            A tensor if a tensor is passed. Directions reach as far as the plane at a depth of 1.

        Raises
        ------
        ValueError
            If a matrix or vector has the wrong shape, the intrinsic matrix has no inverse, the field of view
            is not between 0 and 180, `up` points along the view, or a size is less than 1.
        TypeError
            If arguments are missing or of the wrong type.

        See Also
        --------
        Camera.rays : Raywright's own cameras.

        Examples
        --------
        >>> from raywright.compat.open3d import RaycastingScene
        >>> rays = RaycastingScene.create_rays_pinhole(
        ...     fov_deg=90, center=[0, 0, 0], eye=[0, 0, 5], up=[0, 1, 0], width_px=4, height_px=2
        ... )
        >>> rays.shape
        (2, 4, 6)
        """
        given = (*args, *kwargs.values())
        rays = pinhole_rays(*args, **kwargs)
        return tensor_of(rays) if cls._returns_tensors or any(map(is_tensor, given)) else rays

    @property
    def _compiled(self) -> Scene:
        """The current meshes."""
        if self._scene is None:
            self._scene = Scene(self._meshes, precision="double")
        return self._scene

    def _inside(self, query_points: Any, nthreads: int, nsamples: int) -> NDArray[np.bool_]:
        if integer("nsamples", nsamples, 1) % 2 == 0:
            raise ValueError(f"nsamples must be odd, got {nsamples}")
        core = self._compiled._compiled()
        arguments = point_arguments(points_of(query_points), threads_of(nthreads))
        return core.contains(*arguments, is_even_odd=True)

    def _all_told(self, answer: dict[str, Any], given: Any) -> dict[str, Any]:
        return {name: self._told(array, given) for name, array in answer.items()}

    def _told(self, array: NDArray[Any], given: Any) -> Any:
        """Return an array as a tensor where one is due."""
        return tensor_of(array) if self._has_tensors or is_tensor(given) else array

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "_scene": None}

    def __repr__(self) -> str:
        faces = sum(len(mesh.faces) for mesh in self._meshes)
        return f"RaycastingScene({len(self._meshes)} meshes, {faces} triangles)"
