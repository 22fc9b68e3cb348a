"""Shapes."""

from __future__ import annotations

import gzip
import math
import shutil
import tempfile
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...lights import Emission
from ...materials import Mask, Material
from ...mesh_files.meshes import load_whole
from ...shapes import Cylinder, Disk, Shape, Sphere
from ...shapes.mesh import Mesh
from ...shapes.mesh_changes import wound
from ..tubes import b_spline
from .lights import imaged
from .parameters import Floats, Parameters
from .spectra import color
from .textures import Textures

# Converts control points of a cubic Bézier curve to those of the equivalent uniform B-spline.
_BEZIER = np.array([(6.0, -7, 2, 0), (0, 2, -1, 0), (0, -1, 2, 0), (0, 2, -7, 6)])
# Cells along each side of a bilinear patch.
_CELLS = 16


class Look(NamedTuple):
    """Material and emission of a shape, and its orientation."""

    material: Material
    emission: Any
    flipped: bool


def emission(parameters: Parameters, imaging: Floats) -> Emission:
    """Return what an area light gives off, as a film gets it.

    Parameters
    ----------
    parameters : Parameters
        Those of the light.
    imaging : (3, 3) array
        Matrix from radiance to the film's pixels.

    Raises
    ------
    ValueError
        If a parameter of it is not supported; the error names it.
    """
    for name in ("filename", "power"):
        if parameters.has(name):
            parameters.fail(f"{name} is not supported")
    scale = parameters.number("scale", 1.0)
    given = color(parameters, "L", 1.0, emits=True)
    radiance = tuple(float(x) for x in imaged(given, scale * imaging, parameters))
    side = "both" if parameters.switch("twosided", False) else "front"
    parameters.done()
    return Emission(radiance, side=side)


def shape(kind: str, parameters: Parameters, matrix: Floats, look: Look, textures: Textures) -> Mesh | Shape:
    """Return a shape where a matrix puts it.

    Raises
    ------
    FileNotFoundError
        If its file is missing.
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    readers: dict[str, Callable[..., Mesh | Shape]] = {
        "trianglemesh": _triangles,
        "plymesh": _ply,
        "bilinearmesh": _bilinear,
        "loopsubdiv": _subdivided,
        "sphere": _sphere,
        "disk": _disk,
        "cylinder": _cylinder,
        "curve": _curve,
    }
    if kind not in readers:
        parameters.fail(f"a shape {kind!r} is not supported")
    if parameters.has("alpha"):
        look = look._replace(material=Mask(look.material, textures.number(parameters, "alpha", 1.0)))
    try:
        made = readers[kind](parameters, matrix, look, textures)
    except (ValueError, TypeError) as error:
        if str(error).startswith(parameters.where):
            raise
        parameters.fail(str(error))
    parameters.done()
    return made


def _mesh(
    vertices: Any,
    faces: Any,
    matrix: Floats,
    look: Look,
    normals: Any = None,
    uv: Any = None,
) -> Mesh:
    """Return a mesh in the world. The outside is where faces turn anticlockwise, or where normals point."""
    mesh = Mesh(vertices, faces, normals, uv, look.material, look.emission).transformed(matrix)
    faces, pointing = mesh.faces, mesh.normals
    if pointing is not None:
        a, b, c = (mesh.vertices[faces[:, k]] for k in range(3))
        against = np.einsum("ij,ij->i", np.cross(b - a, c - a), pointing[faces].sum(1)) < 0
        faces = np.where(against[:, None], faces[:, ::-1], faces)
    if look.flipped:
        faces, pointing = faces[:, ::-1], None if pointing is None else -pointing
    return wound(mesh, faces, pointing)


def _triangles(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Mesh:
    vertices, faces = _corners(parameters, 3)
    parameters.leave_out("S")
    # Ptex face numbers are useless without Ptex textures.
    parameters.ignore("faceIndices")
    return _mesh(vertices, faces, matrix, look, parameters.numbers("N", 3), parameters.numbers("uv", 2))


def _corners(parameters: Parameters, count: int) -> tuple[Floats, Any]:
    vertices = parameters.numbers("P", 3)
    if vertices is None or not len(vertices):
        parameters.fail("P must be given")
    given = parameters.numbers("indices")
    if given is not None and not len(given):
        # pbrt ignores empty indices, too.
        given = None
    if given is None and len(vertices) != count:
        parameters.fail("indices must be given")
    numbers = np.arange(count, dtype=np.float64) if given is None else given
    if len(numbers) % count or (np.floor(numbers) != numbers).any():
        parameters.fail(f"indices must be whole numbers, {count} each")
    if not (numbers.min() >= 0 and numbers.max() < len(vertices)):
        parameters.fail(f"indices must be at least 0 and below {len(vertices)}")
    return vertices, numbers.astype(np.int64).reshape(-1, count)


def _ply(parameters: Parameters, matrix: Floats, look: Look, textures: Textures) -> Mesh:
    if parameters.has("displacement"):
        parameters.fail("displacement is not supported")
    parameters.ignore("edgelength")
    mesh = _ply_file(textures.folder / parameters.text("filename"))
    return _mesh(mesh.vertices, mesh.faces, matrix, look, mesh.normals, mesh.uv)


def _ply_file(path: Path) -> Mesh:
    """Read a PLY file, by way of a decompressed copy if it ends in ``.gz``."""
    if path.suffix.lower() != ".gz" or not path.exists():
        return load_whole(path, "ply")
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / path.stem
        try:
            with gzip.open(path) as packed, open(copy, "wb") as plain:
                shutil.copyfileobj(packed, plain)
        except (gzip.BadGzipFile, EOFError, zlib.error) as error:
            raise ValueError(f"{path} is not a gzip file that can be read ({error})") from error
        try:
            return load_whole(copy, "ply")
        except ValueError as error:
            raise ValueError(str(error).replace(str(copy), str(path))) from error


def _bilinear(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Mesh:
    if parameters.has("emissionfilename"):
        parameters.fail("emissionfilename is not supported")
    vertices, quads = _corners(parameters, 4)
    normals, uv = parameters.numbers("N", 3), parameters.numbers("uv", 2)
    corners = vertices[quads]
    twist = np.abs(corners[:, 0] - corners[:, 1] - corners[:, 2] + corners[:, 3]).max()
    cells = 1 if twist <= 1e-9 * np.abs(vertices).max() else _CELLS
    u, v = (part.reshape(-1) for part in np.meshgrid(*2 * [np.linspace(0, 1, cells + 1)]))
    weights = np.stack([(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v])

    def between(values: Floats) -> Floats:
        return np.asarray(np.einsum("kp,qkc->qpc", weights, values).reshape(-1, values.shape[-1]))

    corner = np.arange((cells + 1) ** 2).reshape(cells + 1, cells + 1)
    a, b, c, d = (corner[rows, columns].reshape(-1) for rows, columns in _SQUARE)
    faces = np.concatenate([np.stack([a, b, d], -1), np.stack([a, d, c], -1)])
    faces = (faces[None] + (np.arange(len(quads)) * (cells + 1) ** 2)[:, None, None]).reshape(-1, 3)
    own = np.broadcast_to(np.array([(0.0, 0), (1, 0), (0, 1), (1, 1)]), (len(quads), 4, 2))
    return _mesh(
        between(corners),
        faces,
        matrix,
        look,
        None if normals is None else between(normals[quads]),
        between(own if uv is None else uv[quads]),
    )


_LOW, _HIGH = slice(None, -1), slice(1, None)
_SQUARE = ((_LOW, _LOW), (_LOW, _HIGH), (_HIGH, _LOW), (_HIGH, _HIGH))


def _subdivided(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Mesh:
    from trimesh import remesh

    loop: Any = remesh.subdivide_loop

    vertices, faces = _corners(parameters, 3)
    parameters.ignore("scheme")
    levels = parameters.integer("levels", 3)
    if not 0 <= levels <= 7:
        parameters.fail(f"levels must be between 0 and 7, got {levels}")
    try:
        vertices, faces = loop(vertices, faces, levels) if levels else (vertices, faces)
    except (ValueError, IndexError):
        parameters.fail("its faces must form a surface, with at most two faces at each edge")
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    normals = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(normals, faces[:, k], np.cross(b - a, c - a))
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return _mesh(vertices, faces, matrix, look, normals / np.maximum(length, 1e-300))


def _look(look: Look) -> dict[str, Any]:
    given = look.emission
    if look.flipped and given is not None and given.side == "front":
        given = Emission(given.radiance, side="back")
    return {"material": look.material, "emission": given}


def _sphere(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Sphere:
    radius = parameters.number("radius", 1.0)
    _whole(parameters, ("zmin", -radius), ("zmax", radius), ("phimax", 360.0))
    return Sphere(radius=radius, transform=matrix, **_look(look))


def _disk(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Disk:
    _whole(parameters, ("innerradius", 0.0), ("phimax", 360.0))
    height, radius = parameters.number("height", 0.0), parameters.number("radius", 1.0)
    return Disk((0, 0, height), (0, 0, 1), radius, transform=matrix, **_look(look))


def _cylinder(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Cylinder:
    _whole(parameters, ("phimax", 360.0))
    low, high = parameters.number("zmin", -1.0), parameters.number("zmax", 1.0)
    radius = parameters.number("radius", 1.0)
    return Cylinder((0, 0, low), (0, 0, high), radius, capped=False, transform=matrix, **_look(look))


def _whole(parameters: Parameters, *ends: tuple[str, float]) -> None:
    for name, all_of_it in ends:
        value = parameters.number(name, all_of_it)
        if not math.isclose(value, all_of_it, rel_tol=1e-6) and abs(value) < abs(all_of_it or value + 1):
            parameters.fail(f"a part of it is not supported: {name} must be {all_of_it:g}, got {value:g}")


def _curve(parameters: Parameters, matrix: Floats, look: Look, _: Textures) -> Mesh:
    if parameters.text("type", "flat") != "cylinder":
        parameters.notes.tell("flat curves and ribbons are approximated by round ones")
    basis = parameters.text("basis", "bezier")
    if parameters.integer("degree", 3) != 3 or basis not in ("bezier", "bspline"):
        parameters.fail("a curve must be cubic, of basis bezier or bspline")
    points = parameters.numbers("P", 3)
    if points is None or len(points) < 4:
        parameters.fail("P must be at least 4 points")
    parameters.ignore("N", "splitdepth")
    width = parameters.number("width", 1.0)
    ends = parameters.number("width0", width), parameters.number("width1", width)
    points = points @ matrix[:3, :3].T + matrix[:3, 3]
    size = abs(np.linalg.det(matrix[:3, :3])) ** (1 / 3)
    if basis == "bspline":
        parts = [points]
    else:
        if len(points) % 3 != 1:
            parameters.fail(f"P must be 4 points, and 3 more for each further piece, got {len(points)}")
        parts = [_BEZIER @ points[k : k + 4] for k in range(0, len(points) - 1, 3)]
    count = len(parts) if basis == "bezier" else len(points) - 3
    curves = []
    for k, part in enumerate(parts):
        # Widths are linear along the curve, and a B-spline reproduces linear functions.
        at = np.arange(len(part)) - 1 + k
        radii = np.clip(ends[0] + (ends[1] - ends[0]) * at / count, 0.0, None) * 0.5 * size
        curves.append(np.column_stack([part, radii]))
    vertices, faces, normals, uv = b_spline(curves)
    mesh = Mesh(vertices, faces, normals, uv, look.material, look.emission)
    return mesh
