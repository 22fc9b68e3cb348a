"""Closest points and signed distances of a trimesh mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
import trimesh
from numpy.typing import ArrayLike, NDArray

from ..trimesh_ray.installation import intersector_of
from ..trimesh_ray.intersector import RayMeshIntersector, triples
from .facing import Neighbors, facing

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
_barycentric: Any = trimesh.triangles.points_to_barycentric
_tolerance: float = trimesh.constants.tol.merge


def closest_point(mesh: trimesh.Trimesh, points: ArrayLike) -> tuple[Floats, Floats, Ints]:
    """Find the closest point of a mesh to each point.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        The mesh, which may change between calls.
    points : (n, 3) array
        The points.

    Returns
    -------
    closest : (n, 3) float64
        The closest points; NaN for a point that is not finite, and for all if the mesh has no faces.
    distance : (n,) float64
        Their distances; inf if there is none.
    triangle_id : (n,) int64
        Their faces; -1 if there is none. Of faces that share an edge or a corner and are as close, the one
        whose normal points most towards the point, as in trimesh.

    Raises
    ------
    ValueError
        If the array is not (n, 3).
    TypeError
        If the array does not hold real numbers, or `mesh` is not a trimesh.Trimesh.

    See Also
    --------
    Scene.closest_point : Raywright's own query.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_proximity import closest_point
    >>> closest, distance, face = closest_point(trimesh.creation.box((2, 2, 2)), [[0.1, 0.2, 3]])
    >>> closest.round(6).tolist(), distance.tolist()
    ([[0.1, 0.2, 1.0]], [2.0])
    """
    return closest_of(_intersector(mesh), points)


def signed_distance(mesh: trimesh.Trimesh, points: ArrayLike) -> Floats:
    """Compute the signed distance of each point from a mesh: positive inside, as in trimesh.

    Arguments and errors are those of `closest_point`. The sign is that of the closest face if the point lies
    above or below it, and otherwise by ``contains_points`` of `RayMeshIntersector`. Points within
    ``trimesh.constants.tol.merge`` of the surface are inside.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        The mesh, which may change between calls.
    points : (n, 3) array
        The points.

    Returns
    -------
    (n,) float64
        Minus infinity for points that are not finite, and for all if the mesh has no faces.

    See Also
    --------
    Scene.signed_distance : Raywright's own query, with the other sign.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_proximity import signed_distance
    >>> signed_distance(trimesh.creation.box((2, 2, 2)), [[0, 0, 0], [0, 0, 3]]).tolist()
    [1.0, -2.0]
    """
    return signed(_intersector(mesh), points, _tolerance)


class ProximityQuery(trimesh.proximity.ProximityQuery):
    """Closest points of one mesh; ``mesh.nearest`` is one of trimesh's.

    Parameters
    ----------
    mesh : trimesh.Trimesh
        The mesh, which may change between calls.

    See Also
    --------
    closest_point, signed_distance

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_proximity import ProximityQuery
    >>> query = ProximityQuery(trimesh.creation.box((2, 2, 2)))
    >>> query.signed_distance([[0, 0, 0], [0, 0, 3]]).tolist()
    [1.0, -2.0]
    """

    def on_surface(self, points: ArrayLike) -> tuple[Floats, Floats, Ints]:
        """Find the closest point of the mesh to each point, as `closest_point` does.

        Parameters
        ----------
        points : (n, 3) array
            The points.

        Returns
        -------
        closest : (n, 3) float64
            The closest points.
        distance : (n,) float64
            Their distances.
        triangle_id : (n,) int64
            Their faces.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_proximity import ProximityQuery
        >>> query = ProximityQuery(trimesh.creation.box((2, 2, 2)))
        >>> query.on_surface([[0.1, 0.2, 3]])[1].tolist()
        [2.0]
        """
        return closest_point(self._mesh, points)

    def signed_distance(self, points: ArrayLike) -> Floats:
        """Compute the signed distance of each point from the mesh, as `signed_distance` does.

        Parameters
        ----------
        points : (n, 3) array
            The points.

        Returns
        -------
        (n,) float64
            As of the function.

        Examples
        --------
        >>> import trimesh
        >>> from raywright.compat.trimesh_proximity import ProximityQuery
        >>> ProximityQuery(trimesh.creation.box((2, 2, 2))).signed_distance([[0, 0, 0.5]]).tolist()
        [0.5]
        """
        return signed_distance(self._mesh, points)


def closest_of(intersector: RayMeshIntersector, points: ArrayLike) -> tuple[Floats, Floats, Ints]:
    """Return the result of `closest_point` for the mesh of an intersector."""
    at = triples("points", points)
    found = intersector._scene.closest_point(at)
    position, face = found.position.copy(), found.primitive_id.astype(np.int64)
    mesh = intersector.mesh
    if len(mesh.faces):
        facing(_neighbors(intersector), mesh.face_normals, at, found, position, face)
    return position, found.distance.copy(), face


def signed(intersector: RayMeshIntersector, points: ArrayLike, tolerance: float) -> Floats:
    """Return `signed_distance` for the mesh of an intersector; within a tolerance all is inside."""
    at = triples("points", points)
    position, distance, face = closest_of(intersector, at)
    away = np.flatnonzero(np.isfinite(distance) & (distance > tolerance))
    sign = np.where(np.isfinite(distance), 1.0, -1.0)
    if len(away):
        mesh, of = intersector.mesh, face[away]
        normal = mesh.face_normals[of]
        height = np.einsum("ij,ij->i", at[away] - position[away], normal)
        foot = at[away] - normal * height[:, np.newaxis]
        weights = _barycentric(mesh.triangles[of], foot)
        is_above = ((weights >= -_tolerance) & (weights <= 1 + _tolerance)).all(axis=1) & (height != 0)
        sign[away[is_above]] = -np.sign(height[is_above])
        rest = away[~is_above]
        if len(rest):
            sign[rest] = np.where(intersector.contains_points(at[rest]), 1.0, -1.0)
    result: Floats = distance * sign
    return result


def _intersector(mesh: trimesh.Trimesh) -> RayMeshIntersector:
    if not isinstance(mesh, trimesh.Trimesh):
        raise TypeError(f"mesh must be a trimesh.Trimesh, got {type(mesh).__name__}")
    return intersector_of(mesh)


def _neighbors(intersector: RayMeshIntersector) -> Neighbors:
    """Return the neighbors of the faces of a mesh in its current state."""

    def make() -> Any:
        return Neighbors(np.asarray(intersector.mesh.triangles))

    neighbors: Neighbors = intersector._kept("neighbors", make)
    return neighbors
