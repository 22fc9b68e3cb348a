"""Every mesh of trimesh with raywright's rays, and back."""

import sys
from types import TracebackType
from typing import Any

import trimesh

from .intersector import RayMeshIntersector


class _Own:
    """The intersector that a mesh has while `install` is in force."""

    def __init__(self, intersector: RayMeshIntersector) -> None:
        self.intersector = intersector

    def __reduce__(self) -> tuple[type[None], tuple[()]]:
        # Nothing at all: a mesh that is pickled can be read where there is no raywright.
        return type(None), ()


# Where a mesh keeps what trimesh or its user gave it, and what it has instead.
_GIVEN, _OWN = "ray", "_raywright_ray"


class _Engines:
    """What was in ``trimesh.ray`` before `install`."""

    def __init__(self) -> None:
        self.has_embree: bool = trimesh.ray.has_embree
        self.ray_pyembree: Any = trimesh.ray.ray_pyembree

    def intersector(self, mesh: trimesh.Trimesh) -> Any:
        """Make what a mesh would have been given."""
        module = self.ray_pyembree if self.has_embree else trimesh.ray.ray_triangle
        return module.RayMeshIntersector(mesh)


_before: _Engines | None = None
_TRIMESH: Any = trimesh.Trimesh


def _ray(mesh: trimesh.Trimesh) -> RayMeshIntersector:
    """Ray queries, answered by raywright."""
    own = vars(mesh).get(_OWN)
    if own is None or own.intersector.mesh is not mesh:
        own = vars(mesh)[_OWN] = _Own(RayMeshIntersector(mesh))
    return own.intersector


def _set_ray(mesh: trimesh.Trimesh, intersector: Any) -> None:
    if isinstance(intersector, RayMeshIntersector) and intersector.mesh is mesh and _before is not None:
        vars(mesh)[_OWN] = _Own(intersector)
        intersector = _before.intersector(mesh)
    vars(mesh)[_GIVEN] = intersector


class Installation:
    """What `install` has done; as a context manager it is undone at the end."""

    def __init__(self, is_first: bool) -> None:
        self._is_first = is_first

    def __enter__(self) -> "Installation":
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._is_first:
            uninstall()

    def __repr__(self) -> str:
        return f"Installation({'in force' if _before is not None else 'undone'})"


def install() -> Installation:
    """Let ``mesh.ray`` of every trimesh mesh be a `RayMeshIntersector`, until `uninstall`.

    So all of trimesh that casts rays does it with raywright (``mesh.contains``, thickness, voxels, ...), and
    so do packages that look for embree there, such as pyvista's ``PolyData.multi_ray_trace``. It holds for
    meshes that there are already and for new ones, whatever was assigned to ``mesh.ray``; that counts again
    after `uninstall`.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.trimesh_ray.install(): ...``.
    """
    global _before
    if _before is not None:
        return Installation(False)
    _before = _Engines()
    # A property comes before what an instance holds, and so holds for meshes that there are already.
    _TRIMESH.ray = property(_ray, _set_ray)
    # Whoever asks for embree is served: what is looked for in its module is in this package.
    trimesh.ray.has_embree = True
    trimesh.ray.ray_pyembree = sys.modules[__package__]
    return Installation(True)


def uninstall() -> None:
    """Give every mesh back the intersector that it was given; nothing happens if there is nothing to undo."""
    global _before
    if _before is None:
        return
    trimesh.ray.has_embree, trimesh.ray.ray_pyembree = _before.has_embree, _before.ray_pyembree
    del _TRIMESH.ray
    _before = None
