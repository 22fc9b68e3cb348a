"""Meshes from trimesh objects, from files that trimesh reads, and from lists of these."""

import errno
import sys
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..instance import AnyShape, Instance
from ..mesh import Mesh
from ..shapes import Shape
from .claims import check_mesh_file
from .looks import look_of
from .quiet import quiet, reason

_GLTF = (".glb", ".gltf")


def meshes(shapes: Any) -> tuple[AnyShape, ...]:
    """Lay out shapes, instances, trimesh objects, paths and nested lists of them as one flat tuple.

    Raises
    ------
    FileNotFoundError
        If a file is missing.
    ValueError
        If a file is not a mesh that can be read.
    TypeError
        If something is none of these.
    """
    return tuple(_each(shapes))


def only_meshes(shapes: Any) -> tuple[Mesh, ...]:
    """Lay out shapes as `meshes` does, where other shapes will not do.

    Raises
    ------
    TypeError
        If one of them is no mesh; and what `meshes` raises.
    """
    found = []
    for shape in _each(shapes):
        if not isinstance(shape, Mesh):
            raise TypeError(f"only meshes can be taken here, got {type(shape).__name__}")
        found.append(shape)
    return tuple(found)


def load(path: str | PathLike[str]) -> tuple[Mesh, ...]:
    """Read a mesh file: one mesh for each node of the file that holds triangles.

    glTF is read by `raywright.io.gltf`, all else by trimesh.

    Faces stay in the file's order, and vertices as they are. Only STL, which repeats every corner, has its
    equal corners joined.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If the file is not a mesh that can be read, or holds no faces.
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
        suffix = f"suffix {path.suffix}" if path.suffix else "a name without a suffix"
        raise ValueError(f"{path}: {suffix} is not a mesh format; known are {', '.join(sorted(kinds))}")
    if name.endswith(_GLTF):
        from .gltf import read_meshes

        result = read_meshes(path)
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
    import trimesh

    how: dict[str, Any] = {"group_material": False, "skip_materials": True} if kind == "obj" else {}
    try:
        check_mesh_file(path)
        with quiet(), open(path, "rb") as file:
            found = trimesh.load(file, file_type=kind, process=False, **how)
            parts = tuple(_of_scene(found)) if hasattr(found, "geometry") else (_of_trimesh(found, True),)
    except (MemoryError, OSError):
        raise
    except Exception as error:
        raise ValueError(f"{path} is not a mesh that can be read ({reason(error)})") from error
    if len(parts) != 1 or not len(parts[0].faces):
        raise ValueError(f"{path} holds no faces")
    return parts[0]


def _read(path: Path) -> tuple[Mesh, ...]:
    import trimesh

    try:
        check_mesh_file(path)
        with quiet():
            found = trimesh.load_scene(str(path), process=False)
            return tuple(_of_scene(found, loaded=True))
    except MemoryError:
        raise
    except Exception as error:
        # Parsers fail on bad bytes in every way there is; the caller needs one kind of error, and one line.
        if isinstance(error, OSError) and error.filename == str(path):
            raise
        raise ValueError(f"{path} is not a mesh that can be read ({reason(error)})") from error


def _each(shapes: Any) -> Iterator[AnyShape]:
    # trimesh is never imported only to ask: whoever made such an object has imported it.
    trimesh = sys.modules.get("trimesh")
    if isinstance(shapes, Mesh | Shape | Instance):
        yield shapes
    elif isinstance(shapes, str | PathLike):
        yield from load(shapes)
    elif isinstance(shapes, list | tuple):
        for shape in shapes:
            yield from _each(shape)
    elif isinstance(shapes, getattr(trimesh, "Trimesh", ())):
        yield _of_trimesh(shapes)
    elif isinstance(shapes, getattr(trimesh, "Scene", ())):
        yield from _of_scene(shapes)
    else:
        came = f"{type(shapes).__module__}.{type(shapes).__qualname__}"
        raise TypeError(
            "shapes must be a Mesh, another raywright shape, an Instance, a trimesh.Trimesh, "
            f"a trimesh.Scene, a path, or a list of these, got {came}"
        )


def _of_scene(scene: Any, loaded: bool = False) -> Iterator[Mesh]:
    order = {name: i for i, name in enumerate(scene.geometry)}
    placed = [scene.graph[node] for node in scene.graph.nodes_geometry]
    made: dict[str, Mesh] = {}
    for matrix, name in sorted(placed, key=lambda place: order[place[1]]):
        geometry = scene.geometry[name]
        if not hasattr(geometry, "faces"):
            continue  # points or curves
        if name not in made:
            made[name] = _of_trimesh(geometry, loaded)
        moved = not np.array_equal(matrix, np.eye(4))
        yield made[name].transformed(matrix) if moved else made[name]


def _of_trimesh(mesh: Any, loaded: bool = False) -> Mesh:
    vertices = np.asarray(mesh.vertices)
    faces = np.asarray(mesh.faces)
    uv = getattr(mesh.visual, "uv", None)
    if uv is not None and np.shape(uv) != (len(vertices), 2):
        uv = None
    look = look_of(mesh.visual, len(vertices))
    return Mesh(vertices, faces, _given_normals(mesh, loaded), uv, look.material, look.emission, look.colors)


def _given_normals(mesh: Any, loaded: bool) -> NDArray[np.float64] | None:
    """Vertex normals that came with the mesh, not those that trimesh worked out because someone looked."""
    if "vertex_normals" not in mesh._cache:
        return None
    normals = np.asarray(mesh._cache["vertex_normals"])
    if normals.shape != (len(mesh.vertices), 3):
        return None
    if loaded:
        return normals  # nobody else has looked
    own = _angle_weighted(np.asarray(mesh.faces), mesh.face_normals, mesh.face_angles, len(normals))
    return None if np.allclose(normals, own, rtol=0, atol=1e-10) else normals


def _angle_weighted(faces: Any, face_normals: Any, angles: Any, count: int) -> NDArray[np.float64]:
    """Vertex normals as trimesh works them out: the faces' own, weighted by their angle at the vertex."""
    weighted = angles[:, :, np.newaxis] * face_normals[:, np.newaxis]
    total = [np.bincount(faces.reshape(-1), weighted[..., k].reshape(-1), count) for k in range(3)]
    result = np.stack(total, axis=1).astype(np.float64, copy=False)
    length = np.linalg.norm(result, axis=1, keepdims=True)
    np.divide(result, length, out=result, where=length > 0)
    return result


def _joined(mesh: Mesh) -> Mesh:
    """Join corners that are exactly equal; trimesh's own way rounds to 1e-8, too coarse for small scenes."""
    # Adding 0 makes -0 equal to 0 in its bits as well.
    rows = np.ascontiguousarray(mesh.vertices + 0.0)
    keys = rows.view(np.dtype((np.void, rows.dtype.itemsize * 3))).reshape(-1)
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    return Mesh(rows[first], inverse.reshape(-1)[mesh.faces], material=mesh.material, emission=mesh.emission)
