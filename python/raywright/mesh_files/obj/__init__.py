"""OBJ files: their triangles, and their materials from MTL files."""

from __future__ import annotations

from pathlib import Path

from ...io.quiet import refused
from ...public_names import public_names
from ...shapes.mesh import Mesh
from ..look import colored, shares_of
from .geometry import Geometry, Part
from .library import Library, span_of
from .notes import Notes
from .text import text_of

__all__ = ["read_obj", "read_obj_whole"]
__dir__ = public_names(__name__)


def read_obj(path: Path) -> tuple[Mesh, ...]:
    """Read an OBJ file: a mesh for each material, in the order of their first faces.

    Faces of a mesh are in the order of the file; polygons as in `triangulate`. Vertices are those that faces
    use, one for each that is used with other texture coordinates or another normal.

    Raises
    ------
    ValueError
        If it is none that can be read.

    Warns
    -----
    RuntimeWarning
        Once of each kind of thing that is not shown as the file, or one of its MTL files, says.
    """
    notes = Notes(path.name)
    try:
        geometry = Geometry(text_of(path.read_bytes()))
        library = Library(path, geometry.libraries, notes)
        found = tuple(_mesh(part, library) for part in geometry.parts())
    except Exception as error:
        raise refused(path, "mesh", error) from error
    for lost in geometry.lost:
        notes.add("what faces name, and is not there, is left out", lost)
    notes.warn()
    library.warn()
    return found


def read_obj_whole(path: Path) -> Mesh | None:
    """Read all triangles of an OBJ file as one mesh, without its looks; None if there are none.

    Raises
    ------
    ValueError
        As `read_obj` does.
    """
    try:
        parts = tuple(Geometry(text_of(path.read_bytes()), whole=True).parts())
    except Exception as error:
        raise refused(path, "mesh", error) from error
    return Mesh(parts[0].vertices, parts[0].faces, parts[0].normals, parts[0].uv) if parts else None


def _mesh(part: Part, library: Library) -> Mesh:
    span = None if part.uv is None else span_of(part.vertices, part.faces, part.uv)
    look = library.look(part.material, span)
    # Colors of vertices are taken as sRGB, like those of pictures and scanners.
    look = look or colored(None if part.colors is None else shares_of(part.colors))
    shines = (look.material, look.emission, look.colors)
    # Parts split by material are named after it.
    return Mesh(part.vertices, part.faces, part.normals, part.uv, *shines, part.material, cells=part.cells)
