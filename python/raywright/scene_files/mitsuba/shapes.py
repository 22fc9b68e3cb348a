"""Shapes, groups of them, and their copies."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ...lights import Emission
from ...lights.emission import Emitted
from ...materials import Diffuse, Material, TwoSided
from ...media.files import read_vol
from ...scene.instance import AnyShape, Instance
from ...shapes import Cylinder, Disk, Shape, Sphere
from ...shapes.mesh import Mesh, noisy
from .. import tubes
from . import attributes, bsdfs, curves, height_fields, media, mesh_files, sdf_grids, solid
from .errors import SceneError
from .plugin import Plugin
from .textures import heights, value
from .transforms import Matrix, frame
from .uv import DISK, MIRRORED, SAME, SPHERE, Uv

_CORNER = 1e-6
GROUP, COPY, MERGED = "shapegroup", "instance", "merge"


def shapes_of(plugin: Plugin) -> tuple[Mesh | Shape, ...]:
    """Return the shape of a plugin, or its parts, with its material and emission.

    Raises
    ------
    FileNotFoundError
        If its file is missing.
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    reader = _READERS[plugin.type]
    try:
        if reader is not _mesh and solid.grids_within(plugin):
            plugin.fail("a volume of a grid is read as a texture of meshes only")
        result = reader(plugin)
    except SceneError:
        raise
    except (ValueError, TypeError, np.linalg.LinAlgError) as error:
        raise SceneError(f"{plugin}: {error}") from error
    plugin.done()
    return result if isinstance(result, tuple) else (result,)


def _mesh(plugin: Plugin) -> tuple[Mesh, ...]:
    own = {"rectangle": mesh_files.rectangle, "cube": mesh_files.cube}
    names = attributes.named_within(plugin)
    if len(names) > 1:
        plugin.fail(f"one mesh_attribute of a mesh is read, got {', '.join(sorted(names))}")
    triangles, smooth = (own[plugin.type](), False) if plugin.type in own else mesh_files.of_file(plugin)
    matrix = plugin.to_world()
    vertices, faces, normals, uv = triangles.placed(matrix, plugin.switch("flip_normals", False))
    if smooth:
        normals = mesh_files.smooth_normals(vertices, faces)
    elif plugin.type in own:
        # Faces have flat normals.
        normals = None
    noise = triangles.noise(matrix)
    found = _colored(plugin, mesh_files.Triangles(vertices, faces, normals, uv), names)
    return tuple(noisy(mesh, noise) for mesh in found)


def _colored(plugin: Plugin, placed: mesh_files.Triangles, names: set[str]) -> tuple[Mesh, ...]:
    """Return a mesh with the volume or the attribute that colors it, if there is one."""
    vertices, faces, normals, uv = placed
    solids = solid.grids_within(plugin)
    if len(solids) + len(names) > 1:
        plugin.fail("one volume or mesh_attribute of a mesh is read")
    if solids:
        fine, colors = solid.colored(placed, solids[0])
        return (Mesh(*fine, *_look(plugin, SAME, box=placed.box), colors),)
    if not names:
        return _by_hand(plugin, placed)
    if plugin.type != "ply":
        plugin.fail(f"mesh_attribute is read of ply files only, and {plugin.type} has none")
    of_faces, colors = attributes.read_attribute(plugin.path(), names.pop())
    if of_faces:
        # Faces do not share corners, so that each keeps its color.
        corners = faces.reshape(-1)
        vertices, colors = vertices[corners], np.repeat(colors, 3, axis=0)
        normals, uv = (None if one is None else one[corners] for one in (normals, uv))
        faces = np.arange(len(corners)).reshape(-1, 3)
    return (Mesh(vertices, faces, normals, uv, *_look(plugin, SAME), colors),)


def _by_hand(plugin: Plugin, triangles: mesh_files.Triangles) -> tuple[Mesh, ...]:
    """Return a mesh; where it has a map of normals, in two if only some of its faces are mirrored.

    Along v Mitsuba has what is at right angles to u and the normal, whichever way v goes.
    """
    vertices, faces, normals, uv = triangles
    mirrored = triangles.mirrored() if attributes.has_within(plugin, "normalmap") else np.zeros(1, bool)
    if mirrored.all() or not mirrored.any():
        look = _look(plugin, MIRRORED if mirrored.all() else SAME, box=triangles.box)
        return (Mesh(vertices, faces, normals, uv, *look),)
    again = Plugin(plugin.values, plugin.where, plugin.context)
    return (
        Mesh(vertices, faces[~mirrored], normals, uv, *_look(plugin, SAME)),
        Mesh(vertices, faces[mirrored], normals, uv, *_look(again, MIRRORED)),
    )


def _curves(plugin: Plugin) -> Mesh:
    least, swept = (2, tubes.linear) if plugin.type == "linearcurve" else (4, tubes.b_spline)
    matrix = plugin.to_world()
    # The transform moves control points but not radii.
    placed = [
        np.column_stack([curve[:, :3] @ matrix[:3, :3].T + matrix[:3, 3], curve[:, 3]])
        for curve in curves.read_curves(plugin, least)
    ]
    vertices, faces, normals, uv = swept(placed)
    return Mesh(vertices, faces, normals, uv, *_look(plugin, SAME))


def _distance_grid(plugin: Plugin) -> Mesh:
    # Normals of the grid are smooth across cells, or flat.
    plain = plugin.choice("normals", "smooth", ("smooth", "analytic")) == "analytic"
    if plugin.has("grid"):
        grid = np.asarray(plugin.take("grid"), np.float64)
        if grid.ndim == 4 and grid.shape[3] == 1:
            grid = grid[..., 0]
        if grid.ndim != 3:
            plugin.fail(f"grid must have shape (Z, Y, X) or (Z, Y, X, 1), got {grid.shape}")
    else:
        grid = read_vol(plugin.path())[0].transpose(2, 1, 0).astype(np.float64)
    found = sdf_grids.surface(grid)
    triangles = mesh_files.Triangles(found.vertices, found.faces, found.normals)
    vertices, faces, normals, _ = triangles.placed(plugin.to_world(), plugin.switch("flip_normals", False))
    # The whole surface has the color of the texture's first corner; of a checkerboard, barely within that
    # cell.
    corner = np.full((len(vertices), 2), _CORNER)
    return Mesh(vertices, faces, None if plain else normals, corner, *_look(plugin, SAME))


def _height_field(plugin: Plugin) -> tuple[Mesh, ...]:
    inner = list(plugin.children("bitmap"))
    if len(inner) + plugin.has("filename") != 1:
        plugin.fail("either filename or one texture of type bitmap must be given")
    # Resolution for sampling procedural textures; pictures have their own.
    plugin.ignore("width", "height")
    if inner:
        found = heights(inner[0])
        inner[0].ignore("filter_type", "wrap_mode", "format")
        inner[0].done()
    else:
        found = heights(plugin)
    plain = not plugin.switch("shading_normals", True)
    triangles = height_fields.surface(found * plugin.number("scale", 1.0))
    placed = triangles.placed(plugin.to_world(), plugin.switch("flip_normals", False))
    return _by_hand(plugin, placed._replace(normals=None) if plain else placed)


def _sphere(plugin: Plugin) -> Sphere:
    matrix = plugin.to_world()
    center, radius = plugin.vector("center", (0.0, 0.0, 0.0)), plugin.number("radius", 1.0)
    # In Mitsuba a mirroring transform turns a sphere inside out.
    inside_out = plugin.switch("flip_normals", False) != bool(np.linalg.det(matrix[:3, :3]) < 0)
    material, emission = _look(plugin, SPHERE, inside_out)
    return Sphere(center, radius, transform=_moved(matrix), material=material, emission=emission)


def _disk(plugin: Plugin) -> Disk:
    matrix = plugin.to_world()
    if plugin.switch("flip_normals", False):
        matrix = matrix @ np.diag([1.0, 1.0, -1.0, 1.0])
    material, emission = _look(plugin, DISK)
    return Disk(transform=_moved(matrix), material=material, emission=emission)


def _cylinder(plugin: Plugin) -> Cylinder:
    base, tip = plugin.vector("p0", (0.0, 0.0, 0.0)), plugin.vector("p1", (0.0, 0.0, 1.0))
    radius, length = plugin.number("radius", 1.0), float(np.linalg.norm(tip - base))
    if not length > 0:
        plugin.fail("p0 and p1 must differ")
    axis = (tip - base) / length
    own = np.eye(4)
    own[:3] = np.column_stack([*frame(axis), axis, base])
    material, emission = _look(plugin, SAME, plugin.switch("flip_normals", False))
    return Cylinder(
        tip=(0.0, 0.0, length),
        radius=radius,
        capped=False,
        transform=_moved(plugin.to_world() @ own),
        material=material,
        emission=emission,
    )


_READERS: dict[str, Callable[[Plugin], Mesh | Shape | tuple[Mesh, ...]]] = {
    "obj": _mesh,
    "ply": _mesh,
    "serialized": _mesh,
    "rectangle": _mesh,
    "cube": _mesh,
    "sphere": _sphere,
    "disk": _disk,
    "cylinder": _cylinder,
    "linearcurve": _curves,
    "bsplinecurve": _curves,
    "sdfgrid": _distance_grid,
    "heightfield": _height_field,
}
TYPES = tuple(_READERS)


def _look(
    plugin: Plugin, uv: Uv, inside_out: bool = False, box: media.Box | None = None
) -> tuple[Material, Emitted | None]:
    """Return the material of a shape and its emission, None if it has none.

    `inside_out`, of one whose front is its inside in Mitsuba; `box`, from where to where it is.
    """
    emission: Emitted | None = None
    for emitter in plugin.children("area"):
        if emission is not None:
            plugin.fail("a shape must have one emitter only")
        emission = value(emitter, "radiance", 1.0, uv, emits=True)
        if inside_out:
            emission = Emission(emission, side="back")
        emitter.ignore("sampling_weight")
        emitter.done()
    found = [bsdfs.material(inner, uv) for inner in plugin.children(*bsdfs.TYPES)]
    if len(found) > 1:
        plugin.fail("a shape must have one BSDF only")
    # Default materials: black for lamps, a gray front for all others.
    default = bsdfs.BLACK if emission is not None else TwoSided(Diffuse(0.5), bsdfs.BLACK)
    material = media.filled(plugin, found[0] if found else None, box) or default
    plugin.ignore("silhouette_sampling_weight")
    return bsdfs.turned_round(material, plugin) if inside_out else material, emission


def _moved(matrix: Matrix) -> Matrix | None:
    return None if np.array_equal(matrix, np.eye(4)) else matrix


class Copies:
    """The groups of a scene, each of which is read once, and the transforms of their copies.

    They stand in the scene where the first copy does.
    """

    def __init__(self) -> None:
        self._placed: dict[int, Placed] = {}

    def add(self, plugin: Plugin, to: list[AnyShape | Placed]) -> None:
        """Put a copy of a group into a list of shapes, beside others of that group if there are any."""
        groups = list(plugin.children(GROUP))
        if len(groups) != 1:
            plugin.fail(f"one {GROUP} must be within, got {len(groups)}")
        key = id(groups[0].values)
        if key not in self._placed:
            self._placed[key] = Placed(group(groups[0]), [])
            to.append(self._placed[key])
        self._placed[key].matrices.append(plugin.to_world())
        plugin.done()


class Placed:
    """Shapes of a group, and the matrices of its copies."""

    def __init__(self, shapes: tuple[Mesh | Shape, ...], matrices: list[Matrix]) -> None:
        self.shapes, self.matrices = shapes, matrices

    def instance(self) -> Instance:
        """All copies as one."""
        return Instance(self.shapes, np.stack(self.matrices))


def group(plugin: Plugin) -> tuple[Mesh | Shape, ...]:
    """Return the shapes of a group, or of merged meshes: the layout in memory changes no picture."""
    found: list[Mesh | Shape] = []
    for inner in plugin.children(*TYPES, MERGED):
        if inner.type == MERGED:
            found += group(inner)
        else:
            found += shapes_of(inner)
    plugin.done()
    return tuple(found)


def shines(one: AnyShape | Placed) -> bool:
    """Return whether a shape, or one of a group, gives off light."""
    if isinstance(one, Placed):
        return any(map(shines, one.shapes))
    return not isinstance(one, Instance) and one.emission is not None


def instances(found: list[Any]) -> list[AnyShape]:
    """Return shapes with copies made instances."""
    return [one.instance() if isinstance(one, Placed) else one for one in found]
