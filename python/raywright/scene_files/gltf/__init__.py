"""glTF files, .gltf and .glb: all that is in them, as far as it is to be seen."""

from os import PathLike

from ...lights import ConstantEnvironment
from ...mesh_files.gltf import refused, there
from ...mesh_files.gltf.document import Document
from ...mesh_files.gltf.nodes import placed
from ...rendering.shot import Shot
from ...scene.framing import framed
from ...scene.instance import AnyShape, Instance
from ...scene.scene import Scene
from ...shapes import Shape
from ...shapes.mesh import Mesh, face_count
from .cameras import camera
from .lights import lights
from .shapes import shapes

__all__ = ["read_gltf"]


def read_gltf(path: str | PathLike[str]) -> Shot:
    """Read a glTF 2.0 file, .gltf or .glb: meshes with their materials, lights and a camera.

    Parameters
    ----------
    path : str or path
        The file. What it names beside itself must be in its folder, or in a folder within that.

    Returns
    -------
    Shot
        The file's scene. Large meshes that stand at several nodes are an `Instance` each. The camera is the
        first of the file, or else one from three quarters that has all in its picture. Where there is no
        light, that is no light of KHR_lights_punctual and, in a file with a camera, nothing that shines, an
        even environment of radiance 1 is around it.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is no glTF file that can be read, is broken anywhere, needs an extension that is not supported,
        names files outside of its folder, or holds no faces.

    Warns
    -----
    RuntimeWarning
        Once of each kind of thing in the file that is not shown as it says.

    Notes
    -----
    Lights are told in candela and lux, which are divided by 683 lm/W, channel by channel, to be W·sr⁻¹ and
    W·m⁻²; Blender multiplies by as much when it writes them. Emission is taken as it is, so that a factor of
    1 is a radiance of 1 W·sr⁻¹·m⁻²: that, too, is as Blender writes it, and as most programs show it.

    Of materials there is the metallic-roughness model with its pictures, alpha, normals and emission, and of
    the extensions KHR_materials_emissive_strength, KHR_materials_transmission (a `ThinDielectric`, or a
    `Dielectric` where KHR_materials_volume says that there is a volume), KHR_materials_ior and
    KHR_texture_transform; trimesh turns KHR_materials_pbrSpecularGlossiness into that model.

    Spots fall off between their two angles as a `SpotLight` does; the range of lights is a hint, and of no
    account. Skins and blended shapes are shown as the file has them at rest.
    """
    path = there(path)
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
        shown = bool(lit) or (seen is not None and any(map(_shines, found)))
        environment = None if shown else ConstantEnvironment(1.0)
        shot = Shot(Scene(found, lit, environment), framed(found) if seen is None else seen)
    except Exception as error:
        raise refused(path, "glTF file", error) from error
    document.warn(stacklevel=2)
    return shot


def _faces(shape: AnyShape) -> int:
    return shape.primitives if isinstance(shape, Instance) else face_count(shape)


def _shines(shape: AnyShape) -> bool:
    if isinstance(shape, Instance):
        return any(map(_shines, shape.shapes))
    return isinstance(shape, Mesh | Shape) and shape.emission is not None
