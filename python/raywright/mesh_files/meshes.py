"""Meshes from files."""

from __future__ import annotations

import errno
from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np

from ..io.quiet import quiet, reason
from ..shapes.mesh import Mesh
from ..shapes.welding import Weld, welded
from .trimesh_objects import of_scene

# Formats that error messages name.
_COMMON = ("3mf", "dae", "glb", "gltf", "obj", "off", "ply", "stl")
# The Python package or program that trimesh needs for each further format.
_NEEDED = {
    "3dxml": "lxml and networkx",
    "3mf": "lxml and networkx",
    "ctm": "openctm",
    "dae": "pycollada",
    "drc": "the program draco_decoder",
    "step": "cascadio",
    "stp": "cascadio",
    "xaml": "lxml",
    "zae": "pycollada",
}


def load(path: str | PathLike[str], weld: Weld = "auto") -> tuple[Mesh, ...]:
    """Read a mesh file: one mesh for each node of the file that holds triangles.

    glTF, OBJ, PLY, OFF and STL are read here, OBJ with a mesh for each of its materials, and all else by
    trimesh.

    Faces stay in the file's order, and so do vertices; corners that differ by rounding are put in one place,
    as `welded` does. Only STL, which repeats every corner, has its equal corners joined. Polygons become
    triangles as `triangulation.triangulate` says.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If the file is not a mesh that can be read, or holds no faces.
    ImportError
        If it is of a kind for which trimesh needs a package that is not installed.

    Warns
    -----
    RuntimeWarning
        Once for each kind of feature in the file that is ignored or approximated.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    if path.is_dir():
        raise ValueError(f"{path} is a folder, not a mesh file")
    read = _reader(path)
    result = read(path)
    if not any(len(mesh.faces) for mesh in result):
        raise ValueError(f"{path} holds no faces")
    result = welded(result, weld)
    return tuple(map(_joined, result)) if path.suffix.lower() in (".stl", ".stl_ascii") else result


def _reader(path: Path) -> Callable[[Path], tuple[Mesh, ...]]:
    """Return what reads files of a suffix."""
    suffix = path.suffix.lower()
    if suffix in (".glb", ".gltf"):
        from .gltf import read_meshes

        return read_meshes
    if suffix == ".obj":
        from .obj import read_obj

        return read_obj
    if suffix == ".ply":
        from .ply import read_ply

        return read_ply
    if suffix == ".off":
        from .off import read_off

        return read_off
    if suffix in (".stl", ".stl_ascii"):
        from .stl import read_stl

        return read_stl
    import trimesh

    kinds = trimesh.available_formats()
    if not any(path.name.lower().endswith(f".{kind}") for kind in kinds):
        needed = _NEEDED.get(suffix.removeprefix("."))
        if needed is not None:
            install = needed if needed.startswith("the ") else f"pip install {needed.replace(' and ', ' ')}"
            raise ImportError(f"{path}: trimesh needs {needed} to read {suffix} files ({install})")
        told = f"suffix {path.suffix}" if suffix else "a name without a suffix"
        # With meshio, trimesh reads dozens.
        known = ", ".join(kind for kind in _COMMON if kind in kinds)
        raise ValueError(f"{path}: {told} is not a mesh format; known are {known} and {len(kinds)} in all")
    return _read


def load_whole(path: Path, kind: str) -> Mesh:
    """Read all of an OBJ or PLY file as one mesh, with its normals and coordinates but not its looks.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If the file is not a mesh that can be read, or holds no faces.
    """
    if kind == "obj":
        from .obj import read_obj_whole

        mesh = read_obj_whole(path)
    else:
        from .ply import read_ply_whole

        mesh = read_ply_whole(path)
    if mesh is None or not len(mesh.faces):
        raise ValueError(f"{path} holds no faces")
    return mesh


def _read(path: Path) -> tuple[Mesh, ...]:
    import trimesh

    try:
        with quiet():
            found = trimesh.load_scene(str(path), process=False)
            return tuple(of_scene(found, loaded=True))
    except MemoryError:
        raise
    except Exception as error:
        # Parsers raise any exception on bad bytes; the caller needs one type of error and one line.
        if isinstance(error, OSError) and error.filename == str(path):
            raise
        raise ValueError(f"{path} is not a mesh that can be read ({reason(error)})") from error


def _joined(mesh: Mesh) -> Mesh:
    """Join corners that are exactly equal; trimesh's own way rounds to 1e-8, too coarse for small scenes."""
    # Adding 0 turns -0 into 0, so that equal vertices have equal bits.
    rows = np.ascontiguousarray(mesh.vertices + 0.0)
    keys = rows.view(np.dtype((np.void, rows.dtype.itemsize * 3))).reshape(-1)
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1)[mesh.faces]
    return Mesh(rows[first], faces, material=mesh.material, emission=mesh.emission, name=mesh.name)
