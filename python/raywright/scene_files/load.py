"""Whatever a file holds, ready to be rendered."""

import errno
from os import PathLike
from pathlib import Path

from ..mesh_files import meshes
from ..rendering.shot import Shot
from ..scenes.studio import studio
from .mitsuba import from_mitsuba

# Files that may have cameras and lights of their own.
SCENES = (".xml", ".glb", ".gltf")


def has_camera(path: str | PathLike[str]) -> bool:
    """Whether a file is of a kind that has scenes rather than meshes only, by its suffix."""
    return Path(path).suffix.lower() in SCENES


def load(path: str | PathLike[str]) -> Shot:
    """Read a scene, or a mesh, with all that it takes to make a picture of it.

    Parameters
    ----------
    path : str or path
        ``.xml``, a scene of Mitsuba 3, as `from_mitsuba` reads it; ``.glb`` or ``.gltf``; or any mesh file
        that trimesh reads, which is framed, lit and put on a floor as `scenes.studio` does.

    Returns
    -------
    Shot
        What ``.render()`` makes a picture of.

    Raises
    ------
    FileNotFoundError
        If the file, or one that it names, is missing.
    ValueError
        If it cannot be read, or holds something that is not supported.
    TypeError
        If `path` is no path.
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path must be a str or a path, got {type(path).__name__}")
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    suffix = path.suffix.lower()
    if suffix == ".xml":
        return from_mitsuba(path)
    if suffix in SCENES:
        from .gltf import read_gltf

        return read_gltf(path)
    return Shot(*studio(meshes.load(path)))
