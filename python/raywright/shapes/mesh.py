"""Triangle meshes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import frozen, label, last_axis, positive, rows, same, triangles
from ..descriptions import as_kind, changed
from ..lights.emission import EmissionLike, Emitted
from ..lights.emission import emission as checked_emission
from ..materials import Diffuse, Material
from .attributes import Attributes, attributes, cell_numbers, same_attributes

if TYPE_CHECKING:
    import open3d
    import pyvista
    import trimesh


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Mesh:
    """A mesh of triangles. All arrays are read-only; arrays that are read-only already are not copied.

    Parameters
    ----------
    vertices : (V, 3) array
        Corners. float32 and float64 are kept as they are, other real types become float64. NaN and infinity
        are allowed: faces that use them are left out, with a warning, when the scene is compiled.
    faces : (F, 3) integer array
        Indices of three vertices per face; kept as uint32. Seen from the side that the normal points to, they
        run anticlockwise.
    normals : (V, 3) array, optional
        Shading normals, one per vertex.
    uv : (V, 2) array, optional
        Texture coordinates, one pair per vertex; (0, 0) is the lower left.
    material : Material, optional
        Material of the surface; ``Diffuse()`` if not given.
    emission : float, 3 floats, Texture or Emission, optional
        Radiance in W·sr⁻¹·m⁻² that leaves the side of the geometric normal: one number, or red, green and
        blue. None, the default, for a mesh that does not shine.
    colors : (V, 3) array, optional
        Linear red, green and blue, one color per vertex, each between 0 and 1; the texture `VertexColors`
        shows them.
    name : str, optional
        Name that `Hits.names` returns.
    vertex_attributes : dict of (V, ...) arrays, optional
        Values of vertices by name; `Hits.interpolate` reads them.
    face_attributes : dict of (F, ...) arrays, optional
        Values of faces by name; `Hits.interpolate` reads them where no vertex attribute has the name.
    cells : (F,) integer array, optional
        Number of the cell that each face is part of, such as the polygon that was cut into triangles;
        `Hits.cell` returns it. None if each face is a cell.

    Raises
    ------
    ValueError
        If an array has the wrong shape, a face index is negative or not below V (the error names the face), a
        color is not between 0 and 1 (the error names the vertex), or a cell is negative.
    TypeError
        If an array has the wrong type, such as float faces.

    See Also
    --------
    Mesh.of : From files and other libraries.
    load : Scenes of other renderers.

    Examples
    --------
    >>> mesh = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], name="triangle")
    >>> mesh.bounds.tolist()
    [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0]]
    >>> rw.Scene(mesh).intersect([0.25, 0.25, 1], [0, 0, -1]).names.item()
    'triangle'
    """

    vertices: NDArray[np.floating[Any]]
    faces: NDArray[np.uint32]
    normals: NDArray[np.floating[Any]] | None
    uv: NDArray[np.floating[Any]] | None
    material: Material
    emission: Emitted | None
    colors: NDArray[np.floating[Any]] | None
    name: str | None
    vertex_attributes: Attributes
    face_attributes: Attributes
    cells: NDArray[np.int64] | None
    # Distance between equal corners through rounding, if larger than the precision of vertices suggests.
    _noise = 0.0
    # True if the mesh belongs to the same object as the one before, and continues its cell numbers.
    _continues = False

    def __init__(
        self,
        vertices: ArrayLike,
        faces: ArrayLike,
        normals: ArrayLike | None = None,
        uv: ArrayLike | None = None,
        material: Material | None = None,
        emission: EmissionLike | None = None,
        colors: ArrayLike | None = None,
        name: str | None = None,
        vertex_attributes: Mapping[str, ArrayLike] | None = None,
        face_attributes: Mapping[str, ArrayLike] | None = None,
        cells: ArrayLike | None = None,
    ) -> None:
        if material is None:
            material = Diffuse()
        elif not isinstance(material, Material):
            raise TypeError(f"material must be a raywright material, got {type(material).__name__}")
        corners = rows("vertices", vertices, 3)
        count = len(corners)
        triples = triangles("faces", faces, count)
        values = {
            "vertices": corners,
            "faces": triples,
            "normals": None if normals is None else rows("normals", normals, 3, count),
            "uv": None if uv is None else rows("uv", uv, 2, count),
            "material": material,
            "emission": checked_emission(emission),
            "colors": None if colors is None else _shares("colors", colors, count),
            "name": label("name", name),
            "vertex_attributes": attributes("vertex_attributes", vertex_attributes, count),
            "face_attributes": attributes("face_attributes", face_attributes, len(triples)),
            "cells": None if cells is None else cell_numbers("cells", cells, len(triples)),
        }
        for field, kept in values.items():
            object.__setattr__(self, field, kept)

    @classmethod
    def of(cls, source: Any, tolerance: float | None = None) -> Mesh:
        """Return a file, an object of another library, or several of these, as one mesh.

        Vertices stay where they are, polygons become triangles, and attributes keep their names.

        Parameters
        ----------
        source : object
            Everything that a `Scene` accepts as meshes: a path; a mesh of trimesh, pyvista, VTK, Open3D,
            meshio, manifold3d or Blender; a shape of CadQuery or build123d; a ``(vertices, faces)`` pair of
            arrays, tensors or lists of rows; a list of these, or a dict by name. Several meshes are joined,
            with the attributes that all have.
        tolerance : float, optional
            Maximum distance of triangles from the curved faces of CAD shapes, in their unit. Open CASCADE may
            exceed it twofold in a few places, such as poles of spheres. A thousandth of the diagonal of the
            shape's box if not given.

        Returns
        -------
        Mesh
            Its `cells` are those of `source`, if they differ from the faces: polygons, volume cells under the
            surface, faces of a CAD shape.

        Raises
        ------
        TypeError
            If `source` is of a type that is not listed.
        ValueError
            If `source` cannot be read, has no mesh in it, or `tolerance` is not greater than 0.
        FileNotFoundError
            If a file is missing.

        Warns
        -----
        RuntimeWarning
            Once for parts that are left out, such as points and curves, and for differing materials.

        See Also
        --------
        Scene : Takes the same sources.

        Examples
        --------
        >>> import trimesh
        >>> box = rw.Mesh.of(trimesh.creation.box((1, 1, 1)))
        >>> box.faces.shape
        (12, 3)
        >>> rw.Mesh.of(([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])).faces.tolist()
        [[0, 1, 2], [0, 2, 3]]
        """
        # Imported here: converters depend on meshes, and only objects of other libraries need them.
        sources = import_module(".sources", __package__)
        made: Mesh = sources.only_mesh(
            source, None if tolerance is None else positive("tolerance", tolerance)
        )
        return made

    def to_trimesh(self) -> trimesh.Trimesh:
        """Return the mesh as a trimesh.Trimesh, with vertices, faces, normals, attributes, and colors or uv.

        `cells` are the face attribute "cell". A plain diffuse color of the material is kept.

        Returns
        -------
        trimesh.Trimesh

        See Also
        --------
        Mesh.of : The inverse.

        Examples
        --------
        >>> round(float(rw.scenes.torus_knot(along=40, around=8).to_trimesh().area), 1)
        28.0
        """
        from .exported import to_trimesh

        made: trimesh.Trimesh = to_trimesh(self)
        return made

    def to_pyvista(self) -> pyvista.PolyData:
        """Return the mesh as a pyvista.PolyData, with attributes as point and cell data.

        `cells` are the cell data "cell"; normals, uv and colors are point data of these names.

        Returns
        -------
        pyvista.PolyData

        Raises
        ------
        ImportError
            If pyvista is not installed.

        See Also
        --------
        Mesh.of : The inverse.

        Examples
        --------
        >>> import pyvista
        >>> rw.scenes.torus_knot(along=40, around=8).to_pyvista().n_cells
        640
        """
        from .exported import to_pyvista

        return to_pyvista(self)

    def to_open3d(self) -> open3d.t.geometry.TriangleMesh:
        """Return the mesh as one of Open3D, with attributes as vertex and triangle attributes.

        `cells` are the triangle attribute "cell". Its ``to_legacy()`` has no attributes.

        Returns
        -------
        open3d.t.geometry.TriangleMesh

        Raises
        ------
        ImportError
            If Open3D is not installed.

        See Also
        --------
        Mesh.of : The inverse.

        Examples
        --------
        >>> import open3d
        >>> len(rw.scenes.torus_knot(along=40, around=8).to_open3d().triangle.indices)
        640
        """
        from .exported import to_open3d

        return to_open3d(self)

    def save(self, path: str | PathLike[str]) -> None:
        """Write the mesh to a file.

        Parameters
        ----------
        path : path
            Its suffix sets the format. ``.ply`` holds everything but the material: float64 as it is,
            attributes as properties by name (those with more than one number per row as ``name_0``,
            ``name_1``,
            ...), and `cells` as the face property "cell". ``.vtp`` and ``.vtk`` hold the data of
            `to_pyvista`. ``.glb``, ``.obj``, ``.off`` and ``.stl`` hold no attributes.

        Raises
        ------
        ValueError
            If the suffix is none of these, or an attribute cannot be written to a PLY file.
        ImportError
            If pyvista is needed and not installed.

        Warns
        -----
        RuntimeWarning
            If the format holds no attributes, and the mesh has some.

        See Also
        --------
        Mesh.of : Reads files.

        Examples
        --------
        >>> knot = rw.scenes.torus_knot(along=40, around=8)
        >>> knot.save("knot.ply")
        >>> bool((rw.Mesh.of("knot.ply").faces == knot.faces).all())
        True
        """
        from .saved import save

        save(self, path)

    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """Least and greatest corner of the finite vertices of faces, (2, 3) float64; None without any."""
        points = self.used_vertices()
        return np.stack([points.min(axis=0), points.max(axis=0)]) if len(points) else None

    def used_vertices(self) -> NDArray[np.float64]:
        """Return the finite vertices that faces use: (N, 3) float64.

        Returns
        -------
        (N, 3) float64 array

        See Also
        --------
        Mesh.bounds : Their bounding box.

        Examples
        --------
        >>> mesh = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [9, 9, 9]], [[0, 1, 2]])
        >>> len(mesh.used_vertices())
        3
        """
        used = np.zeros(len(self.vertices), np.bool_)
        used[self.faces.reshape(-1)] = True
        used &= np.isfinite(self.vertices).all(axis=1)
        return self.vertices[used].astype(np.float64)

    # NaN and infinity are reported when the scene is compiled.
    @np.errstate(over="ignore", invalid="ignore")
    def transformed(self, matrix: ArrayLike) -> Mesh:
        """Return the mesh moved by an affine matrix, computed in float64.

        A mirroring matrix also swaps the second and third corner of every face, so normals still point
        outside.

        Parameters
        ----------
        matrix : (4, 4) array
            Acts on column vectors (x, y, z, 1); the last row must be (0, 0, 0, 1).

        Returns
        -------
        Mesh

        Raises
        ------
        ValueError
            If the matrix has another shape, is not finite, or is not affine.

        See Also
        --------
        Instance : Copies without new vertices.

        Examples
        --------
        >>> mesh = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> mesh.transformed(np.diag([2, 2, 2, 1])).vertices.tolist()
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]]
        >>> mesh.transformed(np.diag([-1, 1, 1, 1])).faces.tolist()
        [[0, 2, 1]]
        """
        full = last_axis("matrix", matrix, 4).astype(np.float64)
        if full.shape != (4, 4) or not np.isfinite(full).all() or not np.array_equal(full[3], (0, 0, 0, 1)):
            raise ValueError("matrix must be a finite (4, 4) array with (0, 0, 0, 1) as its last row")
        linear, shift = full[:3, :3], full[:3, 3]
        mirrors = bool(np.linalg.det(linear) < 0)
        normals = self.normals
        if normals is not None:
            # Normals transform by the matrix of cofactors: the inverse transpose without its division, so
            # that a flattening matrix works too.
            x, y, z = linear
            cofactors = np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)])
            normals = (normals.astype(np.float64) @ cofactors.T) * (-1.0 if mirrors else 1.0)
            length = np.linalg.norm(normals, axis=1, keepdims=True)
            normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
        result = changed(
            self,
            vertices=frozen(self.vertices.astype(np.float64) @ linear.T + shift),
            faces=frozen(self.faces[:, [0, 2, 1]]) if mirrors else self.faces,
            normals=None if normals is None else frozen(normals),
        )
        return noisy(result, stretched(rounding(self), linear))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Mesh):
            return NotImplemented
        return (
            same(self.vertices, other.vertices)
            and same(self.faces, other.faces)
            and same(self.normals, other.normals)
            and same(self.uv, other.uv)
            and same(self.colors, other.colors)
            and self.material == other.material
            and self.emission == other.emission
            and self.name == other.name
            and same(self.cells, other.cells)
            and same_attributes(self.vertex_attributes, other.vertex_attributes)
            and same_attributes(self.face_attributes, other.face_attributes)
        )

    def __hash__(self) -> int:
        # Equal meshes agree in these; hashing every vertex would be slow.
        return hash((self.vertices.shape, self.faces.shape, self.material, self.emission))

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, because unpickled arrays would be writeable.
        look = (self.material, self.emission, self.colors, self.name)
        values = (dict(self.vertex_attributes), dict(self.face_attributes), self.cells)
        parts = (self.vertices, self.faces, self.normals, self.uv, *look, *values)
        # What a subclass has of its own, and the noise where there is any.
        own = {name: value for name, value in vars(self).items() if name not in _UNPICKLED}
        if self._noise:
            own["_noise"] = self._noise
        return _unpickled, (type(self), parts), own or None

    def __repr__(self) -> str:
        parts = [f"{len(self.vertices)} vertices", f"{len(self.faces)} faces", repr(self.material)]
        parts += [name for name in ("normals", "uv", "colors") if getattr(self, name) is not None]
        parts += [] if self.name is None else [f"name={self.name!r}"]
        for name in ("vertex_attributes", "face_attributes"):
            parts += [f"{name}={list(found)}"] if (found := getattr(self, name)) else []
        if self.emission is not None:
            parts.append(f"emission={self.emission}")
        return f"Mesh({', '.join(parts)})"


def _shares(name: str, given: ArrayLike, count: int) -> NDArray[np.floating[Any]]:
    """Return a read-only copy of (count, 3) numbers, each between 0 and 1."""
    array = rows(name, given, 3, count)
    inside = ((array >= 0) & (array <= 1)).all(axis=1)
    if not inside.all():
        first = int(np.argmin(inside))
        raise ValueError(f"{name} must be between 0 and 1, got {array[first].tolist()} of vertex {first}")
    return array


_UNPICKLED = {*(field.name for field in fields(Mesh)), "_noise", "_continues"}


def _unpickled(kind: type[Mesh], parts: tuple[Any, ...]) -> Mesh:
    return as_kind(kind, Mesh(*parts))


def face_count(shape: object) -> int:
    """Return how many faces a shape has: none if it is not a mesh."""
    return len(shape.faces) if isinstance(shape, Mesh) else 0


def rounding(mesh: Mesh) -> float:
    """Return how close corners of a mesh are that differ by rounding."""
    return max(_core.weld_rounding(mesh.vertices, mesh.faces), mesh._noise)


def stretched(distance: float, linear: NDArray[np.float64]) -> float:
    """Return how far apart points may be that were so close before one of some linear maps, (..., 3, 3)."""
    if not np.isfinite(linear).all():
        return 0.0
    return distance * float(np.max(np.linalg.norm(linear, 2, axis=(-2, -1)), initial=0.0))


def noisy(mesh: Mesh, noise: float) -> Mesh:
    """Return the mesh with the distance by which rounding parted its corners before it was transformed."""
    object.__setattr__(mesh, "_noise", noise)
    return mesh


def has_noise(shape: object) -> bool:
    """Return whether rounding may have parted corners of a shape by more than its digits tell."""
    return isinstance(shape, Mesh) and shape._noise > 0
