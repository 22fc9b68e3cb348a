"""All that becomes meshes: files, objects of other libraries, arrays, and lists and dicts of these.

A library is never imported to recognize its objects: whoever made one has imported it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from importlib import import_module
from itertools import repeat
from numbers import Number
from os import PathLike
from typing import Any, NamedTuple

import numpy as np

from ..descriptions import changed
from .mesh import Mesh
from .welding import Weld, welded


class Source(NamedTuple):
    """A kind of object that meshes are made of.

    Attributes
    ----------
    module : str
        The module that must be imported for such objects to exist.
    reader : str
        The file and the function of ``raywright.mesh_files`` that yields its meshes.
    kinds : tuple of str
        Classes of the module; an object is of one of them.
    attributes : tuple of str
        Or an attribute of objects that are of none of them.
    is_cad : bool
        True if it has curved faces: readers get the tolerance of the triangles.
    is_welded : bool
        True if corners of its faces that differ by rounding are merged.
    """

    module: str
    reader: str
    kinds: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()
    is_cad: bool = False
    is_welded: bool = False

    def is_of(self, given: object) -> bool:
        """Return whether an object is of this kind."""
        module = sys.modules.get(self.module)
        if module is None:
            return False
        if any(isinstance(given, _class(module, kind)) for kind in self.kinds):
            return True
        return bool(self.attributes) and all(hasattr(given, name) for name in self.attributes)


# Subclasses with a reader of their own precede their base class.
SOURCES = (
    Source("trimesh", "trimesh_objects.of_trimesh", ("Trimesh",), is_welded=True),
    Source("trimesh", "trimesh_objects.of_scene", ("Scene",), is_welded=True),
    # pyvista's objects are those of VTK.
    Source("vtkmodules.vtkCommonDataModel", "vtk_objects.of_vtk", ("vtkDataObject",)),
    Source("open3d", "open3d_objects.of_legacy", ("geometry.TriangleMesh",)),
    Source("open3d", "open3d_objects.of_tensors", ("t.geometry.TriangleMesh",)),
    Source("meshio", "meshio_objects.of_meshio", ("Mesh",)),
    Source("manifold3d", "manifold_objects.of_manifold", ("Manifold", "Mesh", "Mesh64")),
    Source(
        "bpy", "blender_objects.of_object", ("types.Object",), ("evaluated_get", "to_mesh", "matrix_world")
    ),
    Source("bpy", "blender_objects.of_mesh", ("types.Mesh",), ("vertices", "polygons", "loops")),
    Source(
        "bpy", "blender_objects.of_objects", ("types.Collection", "types.Scene", "types.bpy_prop_collection")
    ),
    *(
        Source(module, f"cad_objects.{reader}", (kind,), is_cad=True, is_welded=True)
        for module, kind, reader in (
            ("cadquery", "Assembly", "of_assembly"),
            ("cadquery", "Workplane", "of_workplane"),
            ("cadquery", "Shape", "of_shape"),
            ("build123d", "Shape", "of_labeled"),
            ("build123d", "Builder", "of_builder"),
            ("OCP.TopoDS", "TopoDS_Shape", "of_topology"),
        )
    ),
)

EXPECTED = (
    "a Mesh, another raywright shape, an Instance, a mesh of trimesh, pyvista, VTK, Open3D, meshio, "
    "manifold3d or Blender, a shape of CadQuery or build123d, a (vertices, faces) pair of arrays, a path, "
    "or a list or dict of these"
)


def _class(module: Any, kind: str) -> type | tuple[()]:
    """Return a class of a module, or nothing if the module has none of that name."""
    found = module
    for name in kind.split("."):
        found = getattr(found, name, None)
    return found if isinstance(found, type) else ()


def leaves(given: Any, name: str | None = None) -> Iterator[tuple[str | None, Any]]:
    """Yield what nested lists and dicts hold, each with the name that dicts give it.

    Names of dicts within dicts are joined by a slash.

    Raises
    ------
    ValueError
        If a list contains itself.
    TypeError
        If a key of a dict is not a str.
    """
    # An explicit stack of open iterators, since they may nest to any depth.
    left, within = [iter(((name, given),))], [0]
    while left:
        for called, one in left[-1]:
            if not isinstance(one, list | tuple | Mapping) or is_pair(one):
                yield called, one
            elif id(one) in within:
                kind = "dict" if isinstance(one, Mapping) else "list"
                raise ValueError(f"shapes must not be a {kind} that contains itself")
            else:
                entries = (
                    _named(one, called)
                    if isinstance(one, Mapping)
                    else zip(repeat(called), one, strict=False)
                )
                left.append(iter(entries))
                within.append(id(one))
                break
        else:
            left.pop()
            within.pop()


def _named(given: Mapping[Any, Any], outer: str | None) -> Iterator[tuple[str, Any]]:
    for key, value in given.items():
        if not isinstance(key, str):
            raise TypeError(f"shapes must have names of type str as the keys of a dict, got {key!r}")
        yield (key if outer is None else f"{outer}/{key}"), value


def is_pair(given: object) -> bool:
    """Return whether something is a pair of arrays, or of lists of rows of numbers: vertices and faces."""
    return (
        isinstance(given, list | tuple) and len(given) == 2 and all(is_array(x) or is_rows(x) for x in given)
    )


def is_rows(given: object) -> bool:
    """Return whether something is a list or tuple of rows of numbers, by its first number."""
    if not isinstance(given, list | tuple) or not given:
        return False
    first = given[0]
    return isinstance(first, list | tuple | np.ndarray) and len(first) > 0 and isinstance(first[0], Number)


def is_array(given: object) -> bool:
    """Return whether something is an array or a tensor, of any library, of at least one dimension."""
    if isinstance(given, np.ndarray):
        return given.ndim > 0
    if isinstance(given, type) or not hasattr(given, "shape"):
        return False
    return any(hasattr(given, name) for name in ("__array__", "__dlpack__", "__array_interface__"))


def meshes_of(
    given: Any, weld: Weld = None, tolerance: float | None = None, name: str | None = None
) -> tuple[Mesh, ...] | None:
    """Return the meshes of a path, a pair of arrays or an object of another library; None if it is none.

    Parameters
    ----------
    given : object
        Of one of `SOURCES`, a path or a pair.
    weld : "auto", float or None
        Welding distance, of files and of sources that are welded.
    tolerance : float, optional
        Distance of triangles from curved faces; see `Mesh.of`.
    name : str, optional
        Name of the meshes, in place of their own.

    Raises
    ------
    ValueError, TypeError, FileNotFoundError, ImportError
        If it cannot be read.
    """
    if isinstance(given, str | PathLike):
        found = _reader("meshes.load")(given, weld)
    elif is_pair(given):
        found = tuple(_reader("array_pairs.of_pair")(*given))
    else:
        source = next((source for source in SOURCES if source.is_of(given)), None)
        if source is None:
            return None
        found = tuple(_reader(source.reader)(given, *((tolerance,) if source.is_cad else ())))
        found = welded(found, weld) if source.is_welded else found
    return tuple(named(mesh, name) for mesh in found)


def _reader(name: str) -> Any:
    # Imported here, because only some files and objects need it (import time).
    file, function = name.split(".")
    return getattr(import_module(f"..mesh_files.{file}", __package__), function)


def named(shape: Any, name: str | None) -> Any:
    """Return a shape with another name; the same if None is given."""
    if name is None or shape.name == name:
        return shape
    return changed(shape, name=name)


def only_mesh(given: Any, tolerance: float | None) -> Mesh:
    """Return all that becomes meshes as one.

    Raises
    ------
    TypeError
        If there is something that becomes none.
    ValueError
        If there is nothing; otherwise as `meshes_of`.
    """
    found: list[Mesh] = []
    for name, one in leaves(given):
        if isinstance(one, Mesh):
            found.append(named(one, name))
            continue
        made = meshes_of(one, tolerance=tolerance, name=name)
        if made is None:
            raise refused("source", _expected_mesh(), one, name)
        found += made
    if not found:
        raise ValueError(f"source must hold a mesh, got {described(given)} with none")
    if len(found) == 1:
        return found[0]
    from .joined import joined

    return joined(found)


def _expected_mesh() -> str:
    return EXPECTED.replace("another raywright shape, an Instance, ", "")


def refused(what: str, expected: str, given: object, name: str | None) -> TypeError:
    """Return the error for something that becomes no shape, by the name that a dict gave it."""
    subject = what if name is None else f"shape {name!r}"
    return TypeError(f"{subject} must be {expected}, got {described(given)}{hint(given)}")


def described(given: object) -> str:
    """Return the full name of the type of something."""
    if isinstance(given, type):
        return f"the class {given.__module__}.{given.__qualname__}"
    return f"{type(given).__module__}.{type(given).__qualname__}"


def hint(given: object) -> str:
    """Return a hint for arrays in place of a shape."""
    is_numbers = isinstance(given, np.ndarray | np.generic | int | float) or is_array(given)
    return "; of vertices and faces make a mesh: raywright.Mesh(vertices, faces)" if is_numbers else ""
