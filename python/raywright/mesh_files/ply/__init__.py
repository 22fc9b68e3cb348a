"""PLY files, of text and of bytes.

They are read here since trimesh refuses bytes with polygons of several sizes, and reads text by lines.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ...io.quiet import refused
from ...public_names import public_names
from ...shapes.mesh import Mesh
from ..elements import Data, read_bytes, read_text
from ..tokens import plain_text, without_mark
from .attributes import attributes
from .faces import faces_of, indices_of
from .header import Header, read_header
from .looks import columns, coordinates, look_of

__all__ = ["elements_of", "indices_of", "read_ply", "read_ply_whole"]
__dir__ = public_names(__name__)


def elements_of(path: Path) -> dict[str, Data]:
    """Return all that a PLY file tells of its elements, by their names.

    Raises
    ------
    OSError
        If it cannot be opened.
    ValueError
        If it is none that can be read.
    """
    return _read(path)[1]


def read_ply(path: Path) -> tuple[Mesh, ...]:
    """Read a PLY file as one mesh with its picture or colors; no mesh if it has no faces.

    Vertices are those of the file, in its order, unless faces have texture coordinates for their corners.
    Faces are in the order of the file; polygons as in `triangulate`. Numbers of vertices and faces that are
    neither places, normals, coordinates nor colors are attributes.

    Raises
    ------
    ValueError
        If it is none that can be read.

    Warns
    -----
    RuntimeWarning
        If its picture is not shown.
    """
    try:
        mesh = _mesh(path, True)
    except Exception as error:
        raise refused(path, "mesh", error) from error
    return () if mesh is None else (mesh,)


def read_ply_whole(path: Path) -> Mesh | None:
    """Read a PLY file as one mesh without its looks; None if it has no faces.

    Raises
    ------
    ValueError
        As `read_ply` does.
    """
    try:
        return _mesh(path, False)
    except Exception as error:
        raise refused(path, "mesh", error) from error


def _read(path: Path) -> tuple[Header, dict[str, Data]]:
    data = without_mark(path.read_bytes())
    header = read_header(data)
    # Elements without properties take no bytes.
    elements = [element for element in header.elements if element.properties]
    if header.order:
        return header, read_bytes(data, header.order, header.end, elements)
    body = re.sub(rb"(?m)^ *comment\b[^\n]*", b"", plain_text(data[header.end :]))
    return header, read_text(body, elements)


def _mesh(path: Path, looks: bool) -> Mesh | None:
    header, elements = _read(path)
    vertices = elements.get("vertex")
    if vertices is None:
        return None
    points = columns(vertices, ("x", "y", "z"))
    if points is None:
        raise ValueError("its vertices have no x, y and z")
    found = faces_of(elements, points)
    if found is None:
        return None
    normals = columns(vertices, ("nx", "ny", "nz"), ("normal_x", "normal_y", "normal_z"))
    uv = coordinates(vertices) if found.uv is None else found.uv
    used = found.used
    # Some programs write zeros for unknown normals.
    if normals is not None and not normals.any():
        normals = None
    normals = None if normals is None else normals[used]
    if not looks:
        return Mesh(points[used], found.faces, normals, uv)
    look = look_of(path, elements, header.pictures, uv is not None)
    colors = None if look.colors is None else look.colors[used]
    of_vertices = {name: array[used] for name, array in attributes(vertices).items()}
    polygon = found.polygon
    of_faces = {} if polygon is None else attributes(elements["face"])
    # If all polygons are triangles, the number of the face suffices.
    is_plain = polygon is None or np.array_equal(polygon, np.arange(len(polygon)))
    return Mesh(
        points[used],
        found.faces,
        normals,
        uv,
        look.material,
        look.emission,
        colors,
        path.name,
        of_vertices,
        {name: array[polygon] for name, array in of_faces.items()},
        None if is_plain else polygon,
    )
