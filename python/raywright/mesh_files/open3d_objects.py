"""Meshes from the objects of Open3D."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..materials import Diffuse, Material
from ..shapes.mesh import Mesh
from ..shapes.mesh_changes import continued
from ..textures import ImageTexture
from .look import Look, color_look
from .pbr import Pbr, Picture
from .polygons import LeftOut
from .textured import by_number, split_corners

# Texture maps that are converted.
_MAPS = ("albedo", "normal", "metallic", "roughness", "ao_rough_metal")
# Properties without effect here, and their neutral values; other values are reported.
_NEUTRAL = {"clear_coat": 0.0, "anisotropy": 0.0, "reflectance": 0.5}


def of_legacy(mesh: Any) -> Iterator[Mesh]:
    """Yield a mesh of an open3d.geometry.TriangleMesh with normals and colors for each of its textures.

    Vertices with several texture coordinates are added behind the others, if there is a texture.
    """
    look = color_look(np.asarray(mesh.vertex_colors)) if mesh.has_vertex_colors() else Look()
    normals = np.asarray(mesh.vertex_normals) if mesh.has_vertex_normals() else None
    points, faces = np.asarray(mesh.vertices), np.asarray(mesh.triangles)
    uv = np.asarray(mesh.triangle_uvs).reshape(-1, 2)
    pictures = [None if picture.is_empty() else np.asarray(picture) for picture in mesh.textures]
    if len(uv) != faces.size or all(picture is None for picture in pictures):
        kept = {"texture_uvs": uv.reshape(-1, 3, 2)} if len(faces) and len(uv) == faces.size else None
        yield Mesh(points, faces, normals, None, look.material, None, look.colors, face_attributes=kept)
        return
    sources, corners, uv = split_corners(faces.reshape(-1), uv, len(points))
    faces = corners.reshape(-1, 3)
    ids = np.asarray(mesh.triangle_material_ids)
    if len(ids) != len(faces):
        ids = np.zeros(len(faces), np.int64)
    colors = None if look.colors is None else look.colors[sources]
    made: dict[int, Material | None] = {
        # Open3D's first row is that of v = 0.
        i: None if picture is None else Diffuse(ImageTexture(picture[::-1]))
        for i, picture in enumerate(pictures)
    }
    yield from _parts(
        Mesh(
            points[sources],
            faces[which],
            None if normals is None else normals[sources],
            uv,
            made.get(number) or look.material,
            None,
            colors,
            cells=_cells(which),
        )
        for number, which in by_number(ids, len(pictures))
    )


def of_tensors(mesh: Any) -> Iterator[Mesh]:
    """Yield the mesh of an open3d.t.geometry.TriangleMesh, with normals, colors, attributes and material.

    Tensors of other devices are copied. Vertices with several texture coordinates are added behind the
    others, if there is a texture.

    Warns
    -----
    RuntimeWarning
        Once, for attributes that are not rows of real numbers, and parts of the material without an effect.
    """
    left_out = LeftOut("open3d.t.geometry.TriangleMesh")
    of_vertices, of_faces = _arrays(mesh.vertex), _arrays(mesh.triangle)
    points = of_vertices.pop("positions", np.empty((0, 3), np.float32))
    faces = of_faces.pop("indices", np.empty((0, 3), np.int64))
    normals, colors, uv = (of_vertices.pop(name, None) for name in ("normals", "colors", "texture_uvs"))
    # Open3D computes normals of faces from the faces, so they add nothing.
    of_faces.pop("normals", None)
    look = Look() if colors is None else color_look(colors)
    given = _material(mesh, look.colors is not None, left_out)
    if given is not None:
        look = Look(given.material(), given.emitted(), look.colors if given.colored else None)
    corner_uv = of_faces.get("texture_uvs")
    if corner_uv is not None and corner_uv.shape == (len(faces), 3, 2) and _has_picture(given):
        del of_faces["texture_uvs"]
        count = len(points)
        sources, corners, uv = split_corners(faces.reshape(-1), corner_uv.reshape(-1, 2), count)
        points, faces = points[sources], corners.reshape(-1, 3)
        normals = None if normals is None else normals[sources]
        look = look._replace(colors=None if look.colors is None else look.colors[sources])
        of_vertices = {
            name: array[sources] if array.ndim and len(array) == count else array
            for name, array in of_vertices.items()
        }
    vertex_attributes = left_out.values(of_vertices, len(points), "vertex attribute")
    face_attributes = left_out.values(of_faces, len(faces), "triangle attribute")
    left_out.warn()
    yield Mesh(
        points,
        faces,
        normals,
        uv,
        look.material,
        look.emission,
        look.colors,
        None,
        vertex_attributes,
        face_attributes,
    )


def _material(mesh: Any, is_colored: bool, left_out: LeftOut) -> Pbr | None:
    """Return what the material of a mesh of tensors says; None if it says nothing."""
    if not mesh.has_valid_material():
        return None
    material = mesh.material
    numbers: Mapping[str, float] = dict(material.scalar_properties.items())
    vectors = {name: np.asarray(value, np.float64) for name, value in material.vector_properties.items()}
    maps = {name: _pixels(picture) for name, picture in material.texture_maps.items()}
    for name in maps:
        if name not in _MAPS and name != "ao":
            left_out.add(f"texture map {name!r}")
    for name, neutral in _NEUTRAL.items():
        if numbers.get(name, neutral) != neutral:
            left_out.add(f"material property {name!r}")
    color, emission = vectors.get("base_color"), vectors.get("emissive_color")
    is_plain = color is None or bool((color[:3] == 1).all())
    says_color = "albedo" in maps or not is_plain
    if not says_color and not maps and (emission is None or not emission[:3].any()) and is_colored:
        # A default material says less than the colors.
        return None
    if not numbers and not vectors and not maps:
        return None
    is_blended = material.material_name == "defaultLitTransparency"
    return Pbr(
        color=color,
        color_picture=maps.get("albedo"),
        metallic=float(numbers.get("metallic", numbers.get("base_metallic", 0.0))),
        roughness=float(numbers.get("roughness", numbers.get("base_roughness", 1.0))),
        rough_picture=_packed(maps),
        normal_picture=maps.get("normal"),
        emission=None if emission is None else emission[:3],
        alpha_mode="BLEND" if is_blended else None,
        colored=is_colored,
        unlit=material.material_name == "defaultUnlit",
    )


def _has_picture(given: Pbr | None) -> bool:
    return given is not None and any(
        picture is not None for picture in (given.color_picture, given.rough_picture, given.normal_picture)
    )


def _packed(maps: Mapping[str, Picture]) -> Picture | None:
    """Return roughness in green and metalness in blue, as glTF has them."""
    if "ao_rough_metal" in maps:
        return maps["ao_rough_metal"]
    rough, metal = maps.get("roughness"), maps.get("metallic")
    if rough is None and metal is None:
        return None
    sizes = [one.pixels.shape[:2] for one in (rough, metal) if one is not None]
    if len(sizes) == 2 and sizes[0] != sizes[1]:
        return rough
    full = np.full((*sizes[0], 3), 255, np.uint8)
    for channel, one in ((1, rough), (2, metal)):
        if one is not None:
            full[..., channel] = one.pixels[..., 0]
    return Picture(full)


def _pixels(picture: Any) -> Picture:
    """Return an image of Open3D's tensors, whose rows are from the top."""
    pixels = picture.as_tensor().cpu().numpy()
    return Picture(pixels if pixels.ndim == 3 else pixels[..., np.newaxis])


def _parts(meshes: Iterator[Mesh]) -> Iterator[Mesh]:
    """Yield the meshes of one object, whose cells are counted together."""
    for i, mesh in enumerate(meshes):
        yield continued(mesh) if i else mesh


def _cells(which: Any) -> NDArray[np.int64] | None:
    return None if isinstance(which, slice) else which


def _arrays(tensors: Any) -> dict[str, NDArray[Any]]:
    return {str(name): tensor.cpu().numpy() for name, tensor in tensors.items()}
