"""Meshes from files."""

import errno
import re
from importlib.util import find_spec
from os import PathLike
from pathlib import Path

import numpy as np

from ..io.quiet import quiet, reason, refused
from ..shapes.mesh import Mesh
from .claims import check_mesh_file
from .trimesh_objects import of_scene, of_trimesh

_GLTF = (".glb", ".gltf")
# What trimesh needs for a kind of file, where that is more than one package.
_PACKAGES = {".3mf": ("lxml", "networkx"), ".3dxml": ("lxml", "networkx")}


def load(path: str | PathLike[str]) -> tuple[Mesh, ...]:
    """Read a mesh file: one mesh for each node of the file that holds triangles.

    glTF is read by `raywright.mesh_files.gltf`, OBJ by `raywright.mesh_files.obj`, with a mesh for each of
    its materials, and all else by trimesh.

    Faces stay in the file's order, and vertices as they are. Only STL, which repeats every corner, has its
    equal corners joined.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If the file is not a mesh that can be read, or holds no faces.
    ImportError
        If trimesh reads such files with a package that is not installed: which.

    Warns
    -----
    RuntimeWarning
        Once of each kind of thing in the file that is not shown as it says.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    if path.is_dir():
        raise ValueError(f"{path} is a folder, not a mesh file")
    import trimesh

    kinds = trimesh.available_formats()
    name = path.name.lower()
    if not any(name.endswith(f".{kind}") for kind in kinds):
        _missing(path)
        suffix = f"suffix {path.suffix}" if path.suffix else "a name without a suffix"
        raise ValueError(f"{path}: {suffix} is not a mesh format; known are {', '.join(sorted(kinds))}")
    if name.endswith(_GLTF):
        from .gltf import read_meshes

        result = read_meshes(path)
    elif name.endswith(".obj"):
        from .obj import read_obj

        result = read_obj(path)
    else:
        result = _read(path)
    if not any(len(mesh.faces) for mesh in result):
        raise ValueError(f"{path} holds no faces")
    return tuple(map(_joined, result)) if name.endswith((".stl", ".stl_ascii")) else result


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
        mesh = _whole_ply(path)
    if mesh is None or not len(mesh.faces):
        raise ValueError(f"{path} holds no faces")
    return mesh


def _whole_ply(path: Path) -> Mesh | None:
    import trimesh

    try:
        check_mesh_file(path)
        with quiet(), open(path, "rb") as file:
            found = trimesh.load(file, file_type="ply", process=False)
            parts = tuple(of_scene(found) if hasattr(found, "geometry") else of_trimesh(found, True))
    except Exception as error:
        raise refused(path, "mesh", error) from error
    return parts[0] if len(parts) == 1 else None


def _read(path: Path) -> tuple[Mesh, ...]:
    import trimesh

    try:
        check_mesh_file(path)
        with quiet():
            found = trimesh.load_scene(str(path), process=False)
            return tuple(of_scene(found, loaded=True))
    except MemoryError:
        raise
    except ModuleNotFoundError as error:
        raise _needs(path, error) from error
    except Exception as error:
        # Parsers fail on bad bytes in every way there is; the caller needs one kind of error, and one line.
        if isinstance(error, OSError) and error.filename == str(path):
            raise
        raise ValueError(f"{path} is not a mesh that can be read ({reason(error)})") from error


def _missing(path: Path) -> None:
    """Raise an ImportError if trimesh reads such files with a package that is not installed."""
    from trimesh.exchange.load import mesh_loaders

    name = path.name.lower()
    for kind, loader in mesh_loaders.items():
        if not name.endswith(f".{kind}"):
            continue
        try:
            # What could not be imported stands in its place, and raises whatever is asked of it.
            loader.__name__  # noqa: B018
        except ImportError as error:
            raise _needs(path, error) from error
        except Exception:
            return


def _needs(path: Path, error: ImportError) -> ImportError:
    """Return what to raise where packages are missing that trimesh reads a file with."""
    suffix = path.suffix.lower()
    # trimesh tells the first that is missing, in words.
    told = re.search(r"No module named '([^'.]+)|pip install ([\w-]+)", str(error))
    first = [name for name in told.groups() if name] if told else []
    missing = [name for name in _PACKAGES.get(suffix, ()) if find_spec(name) is None] or first
    if not missing:
        return ImportError(f"{path}: trimesh cannot read {suffix} here ({reason(error)})")
    names, packages = " and ".join(missing), " ".join(missing)
    return ImportError(f"{path}: trimesh reads {suffix} with {names}, not installed: pip install {packages}")


def _joined(mesh: Mesh) -> Mesh:
    """Join corners that are exactly equal; trimesh's own way rounds to 1e-8, too coarse for small scenes."""
    # Adding 0 makes -0 equal to 0 in its bits as well.
    rows = np.ascontiguousarray(mesh.vertices + 0.0)
    keys = rows.view(np.dtype((np.void, rows.dtype.itemsize * 3))).reshape(-1)
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    faces = inverse.reshape(-1)[mesh.faces]
    return Mesh(rows[first], faces, material=mesh.material, emission=mesh.emission, name=mesh.name)
