"""Meshes as other libraries have them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..materials import Diffuse


def to_trimesh(mesh: Any, attributes: bool = True) -> Any:
    """Return the mesh as a trimesh.Trimesh."""
    import trimesh

    found = trimesh.Trimesh(
        mesh.vertices, mesh.faces, vertex_normals=mesh.normals, process=False, validate=False
    )
    color = _plain_color(mesh.material)
    if mesh.colors is not None:
        found.visual = trimesh.visual.ColorVisuals(found, vertex_colors=_bytes(srgb(mesh.colors)))
    elif mesh.uv is not None:
        rgba = None if color is None else [*_bytes(srgb(np.array(color))), 255]
        visual: Any = trimesh.visual
        found.visual = visual.TextureVisuals(
            uv=mesh.uv, material=visual.material.SimpleMaterial(diffuse=rgba)
        )
    elif color is not None:
        rows = np.tile(_bytes(srgb(np.array(color))), (len(mesh.faces), 1))
        found.visual = trimesh.visual.ColorVisuals(found, face_colors=rows)
    if attributes:
        found.vertex_attributes.update({name: array.copy() for name, array in mesh.vertex_attributes.items()})
        found.face_attributes.update({name: array.copy() for name, array in face_values(mesh).items()})
    return found


def to_pyvista(mesh: Any) -> Any:
    """Return the mesh as a pyvista.PolyData."""
    try:
        import pyvista
    except ImportError:
        raise ImportError("to_pyvista needs pyvista, which is not installed: pip install pyvista") from None
    if len(mesh.faces):
        found = pyvista.PolyData.from_regular_faces(mesh.vertices.copy(), mesh.faces.astype(np.int64))
    else:
        found = pyvista.PolyData(mesh.vertices.copy()) if len(mesh.vertices) else pyvista.PolyData()
    if mesh.colors is not None:
        found.point_data["colors"] = srgb(mesh.colors)
    for name, array in mesh.vertex_attributes.items():
        found.point_data[name] = _flat(array)
    if mesh.normals is not None:
        found.point_data.active_normals = mesh.normals.copy()
    if mesh.uv is not None:
        found.point_data.active_texture_coordinates = mesh.uv.copy()
    if len(mesh.faces):
        for name, array in face_values(mesh).items():
            found.cell_data[name] = _flat(array)
    return found


def to_open3d(mesh: Any) -> Any:
    """Return the mesh as an open3d.t.geometry.TriangleMesh."""
    try:
        import open3d
    except ImportError:
        raise ImportError("to_open3d needs Open3D, which is not installed: pip install open3d") from None

    def tensor(array: NDArray[Any]) -> Any:
        # Open3D lacks float16 only.
        return open3d.core.Tensor(np.array(array, np.float32 if array.dtype == np.float16 else array.dtype))

    found = open3d.t.geometry.TriangleMesh(tensor(mesh.vertices), tensor(mesh.faces.astype(np.int64)))
    for name, array in (("normals", mesh.normals), ("texture_uvs", mesh.uv)):
        if array is not None:
            found.vertex[name] = tensor(array)
    if mesh.colors is not None:
        found.vertex["colors"] = tensor(srgb(mesh.colors).astype(np.float32))
    for name, array in mesh.vertex_attributes.items():
        found.vertex[name] = tensor(array)
    for name, array in face_values(mesh).items():
        found.triangle[name] = tensor(array)
    return found


def face_values(mesh: Any) -> dict[str, NDArray[Any]]:
    """Return the face attributes of a mesh, and its cells as "cell" unless an attribute is called so."""
    cells = {} if mesh.cells is None else {"cell": mesh.cells}
    return {**cells, **mesh.face_attributes}


def _flat(array: NDArray[Any]) -> NDArray[Any]:
    return array.copy() if array.ndim < 3 else array.reshape(len(array), -1).copy()


def srgb(rgb: NDArray[Any]) -> NDArray[np.float64]:
    """Return linear shares as those of sRGB (IEC 61966-2-1)."""
    low = np.asarray(rgb, np.float64)
    return np.where(low <= 0.0031308, 12.92 * low, 1.055 * np.maximum(low, 1e-9) ** (1 / 2.4) - 0.055)


def _bytes(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.rint(np.clip(shares, 0, 1) * 255).astype(np.uint8)


def _plain_color(material: Any) -> tuple[float, float, float] | None:
    """Return the color of a diffuse material that has one everywhere, unless it is the default."""
    color = getattr(material, "reflectance", None)
    is_plain = isinstance(material, Diffuse) and isinstance(color, tuple) and material != Diffuse()
    return color if is_plain else None
