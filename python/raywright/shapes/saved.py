"""Meshes as files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from ..io.quiet import warn_caller
from .exported import face_values, to_pyvista, to_trimesh
from .ply_writer import write_ply

_BY_TRIMESH = (".glb", ".obj", ".off", ".stl")


def save(mesh: Any, path: str | os.PathLike[str]) -> None:
    """Write a mesh to a file of a format that its suffix says."""
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix == ".ply":
        write_ply(mesh, path)
        return
    if suffix in (".vtp", ".vtk"):
        to_pyvista(mesh).save(path)
        return
    if suffix not in _BY_TRIMESH:
        known = ", ".join((".ply", *_BY_TRIMESH, ".vtp", ".vtk"))
        raise ValueError(f"path must end in one of {known}, got {path.name!r}")
    lost = [*mesh.vertex_attributes, *face_values(mesh)]
    if lost:
        warn_caller(f"left out of {path.name}: {', '.join(map(repr, lost))}; .ply keeps attributes")
    to_trimesh(mesh, attributes=False).export(path)
