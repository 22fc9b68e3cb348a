"""Every mesh of trimesh with raywright's rays, and back."""

from __future__ import annotations

import sys
from typing import Any

import trimesh

from ..switch import Installation, Kept, Replacement, Switch
from .intersector import RayMeshIntersector

# Attributes of a mesh: the intersector from trimesh or its user, and its replacement.
_GIVEN, _OWN = "ray", "_raywright_ray"

_switch = Switch()
_TRIMESH: Any = trimesh.Trimesh


def intersector_of(mesh: trimesh.Trimesh) -> RayMeshIntersector:
    """Ray queries, answered by raywright."""
    own = vars(mesh).get(_OWN)
    if own is None or own.value.mesh is not mesh:
        own = vars(mesh)[_OWN] = Kept(RayMeshIntersector(mesh))
    intersector: RayMeshIntersector = own.value
    return intersector


def _theirs(mesh: trimesh.Trimesh) -> Any:
    """Make the intersector that a mesh would have been given."""
    has_embree = _switch.before(trimesh.ray, "has_embree")
    module = _switch.before(trimesh.ray, "ray_pyembree") if has_embree else trimesh.ray.ray_triangle
    return module.RayMeshIntersector(mesh)


def _set_ray(mesh: trimesh.Trimesh, intersector: Any) -> None:
    if isinstance(intersector, RayMeshIntersector) and intersector.mesh is mesh and _switch.is_on:
        vars(mesh)[_OWN] = Kept(intersector)
        intersector = _theirs(mesh)
    vars(mesh)[_GIVEN] = intersector


def install() -> Installation:
    """Let ``mesh.ray`` of every trimesh mesh be a `RayMeshIntersector`, until `uninstall`.

    So all of trimesh that casts rays does it with raywright (``mesh.contains``, thickness, voxels, ...), and
    so do packages that look for embree there, such as pyvista's ``PolyData.multi_ray_trace``. It holds for
    existing and for new meshes, whatever was assigned to ``mesh.ray``; that counts again after `uninstall`.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.trimesh_ray.install(): ...``.

    See Also
    --------
    uninstall : Undoes it.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_ray import install
    >>> with install():
    ...     inside = trimesh.creation.box((2, 2, 2)).contains([[0, 0, 0], [0, 0, 3]])
    >>> inside.tolist()
    [True, False]
    """
    return _switch.on(
        [
            # A property on the class overrides instance attributes, so it affects existing meshes too.
            Replacement(_TRIMESH, "ray", property(intersector_of, _set_ray)),
            # Packages that require embree work too: this package has the names of its module.
            Replacement(trimesh.ray, "has_embree", True),
            Replacement(trimesh.ray, "ray_pyembree", sys.modules[__package__]),
        ]
    )


def uninstall() -> None:
    """Give every mesh back the intersector that it was given; nothing happens if there is nothing to undo.

    See Also
    --------
    install : Its inverse.

    Examples
    --------
    >>> from raywright.compat.trimesh_ray import uninstall
    >>> uninstall()
    """
    _switch.off()
