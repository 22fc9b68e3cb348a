"""glTF files, .gltf and .glb: their meshes with materials and attributes."""

from __future__ import annotations

import errno
from os import PathLike
from pathlib import Path

from ...io.quiet import refused
from ...public_names import public_names
from ...shapes.mesh import Mesh
from .document import Document
from .nodes import placed
from .stands import meshes

__all__ = ["read_meshes", "there"]
__dir__ = public_names(__name__)


def read_meshes(path: Path) -> tuple[Mesh, ...]:
    """Read the meshes of a glTF 2.0 file, with their materials: one for each node and primitive of triangles.

    Raises
    ------
    ValueError
        As `read_gltf` does.
    """
    try:
        document = Document(path)
        found = tuple(meshes(document, placed(document)))
    except Exception as error:
        raise refused(path, "mesh", error) from error
    document.warn()
    return found


def there(path: str | PathLike[str]) -> Path:
    """Return the path of a file that is there, or raise."""
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    if path.is_dir():
        raise ValueError(f"{path} is a folder, not a glTF file")
    return path
