"""glTF files, .gltf and .glb, with all of their visible contents."""

from __future__ import annotations

from os import PathLike

from ...arrays import integer
from ...io.quiet import refused
from ...mesh_files.gltf import there
from ...mesh_files.gltf.document import Document
from ...mesh_files.gltf.nodes import placed
from ...public_names import public_names
from ...rendering.render_setup import RenderSetup
from ...scene.instance import AnyShape, Instance
from ...shapes.mesh import face_count
from ..shown import shown
from .cameras import camera
from .lights import lights
from .shapes import shapes

__all__ = ["read_gltf"]
__dir__ = public_names(__name__)


def read_gltf(path: str | PathLike[str], width: int | None = None, height: int | None = None) -> RenderSetup:
    """Read a glTF 2.0 file, .gltf or .glb: meshes with their materials, lights and a camera.

    Parameters
    ----------
    path : str or path
        The file. Others that it names must be in its folder, or in a folder within that.
    width, height : int, optional
        Size of the picture in pixels, as in `load`.

    Returns
    -------
    RenderSetup
        The file's scene. Large meshes that stand at several nodes are an `Instance` each. The camera is the
        first of the file, or else one from three quarters that has all in its picture. Where there is no
        light of KHR_lights_punctual, and nothing that shines in a file with a camera, or not enough in one
        without, there is the light of `scenes.studio`, and where there is no camera its floor too: the same
        mesh looks the same from any file.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is not a glTF file that can be read, is broken anywhere, needs an extension that is not
        supported, names files outside of its folder, or holds no faces; or if a size is out of range.
    TypeError
        If a size is not an integer.

    Warns
    -----
    RuntimeWarning
        Once for each kind of feature in the file that is ignored or approximated.

    Notes
    -----
    Lights are given in candela and lux, which are divided by 683 lm/W, channel by channel, to be W·sr⁻¹ and
    W·m⁻²; Blender multiplies by as much when it writes them. Emission is taken as it is, so that a factor of
    1 is a radiance of 1 W·sr⁻¹·m⁻²: that, too, is as Blender writes it, and as most programs show it.

    Of materials there is the metallic-roughness model with its pictures, alpha, normals and emission, and of
    the extensions KHR_materials_emissive_strength, KHR_materials_transmission (a `ThinDielectric`, or a
    `Dielectric` where KHR_materials_volume says that there is a volume, with the tint of that; `Tinted` if
    the base color is not white), KHR_materials_dispersion, KHR_materials_iridescence (a `ThinFilm` on clear
    materials and metal, a `SoapFilm` on clear sheets), KHR_materials_ior and KHR_texture_transform; trimesh
    turns KHR_materials_pbrSpecularGlossiness into that model. The thickness of a volume follows from its
    mesh, not from the file's number.

    Spots fall off between their two angles as a `SpotLight` does; the range of lights is a hint, and of no
    account. Skins and blended shapes are shown at rest.
    """
    path = there(path)
    for name, size in (("width", width), ("height", height)):
        if size is not None:
            integer(name, size, 1, 65536)
    try:
        document = Document(path)
        nodes = placed(document)
        seen = camera(document, nodes)
        found = list(shapes(document, nodes))
        lit = list(lights(document, nodes))
        if not any(map(_faces, found)):
            raise ValueError("it holds no faces")
        if "animations" in document.root:
            document.tell("its animations are left out: it is shown at rest")
        shot = shown(found, lit, seen, width=width, height=height)
    except Exception as error:
        raise refused(path, "glTF file", error) from error
    document.warn()
    return shot


def _faces(shape: AnyShape) -> int:
    return shape.primitives if isinstance(shape, Instance) else face_count(shape)
