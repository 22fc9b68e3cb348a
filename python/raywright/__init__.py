"""Ray tracing for Python: exact hits from numpy arrays, and pictures with an estimate of their error.

`Scene` takes meshes, files and curved shapes, and traces rays: `Scene.intersect`, `Scene.occluded`,
`Scene.contains`, `Scene.closest_point`. `measure` has measurements by rays, such as sky view and thickness;
`view_factors`, `radiosity` and `radiative_exchange` compute diffuse exchange. `load` reads scene files, and
`render` makes pictures of a scene with a `Camera`.

>>> import raywright as rw
>>> rw.Scene(rw.Sphere()).intersect([0.0, 0.0, 3.0], [0.0, 0.0, -1.0]).t.item()
2.0
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from . import _core

if TYPE_CHECKING:
    from . import accelerators as accelerators
    from . import cameras as cameras
    from . import exchange as exchange
    from . import gpu as gpu
    from . import integrators as integrators
    from . import io as io
    from . import lights as lights
    from . import materials as materials
    from . import measure as measure
    from . import media as media
    from . import query as query
    from . import rendering as rendering
    from . import report as report
    from . import scene as scene
    from . import scenes as scenes
    from . import shapes as shapes
    from . import textures as textures
    from . import viewer as viewer
    from ._core import simd as simd
    from .accelerators import BVH as BVH
    from .accelerators import BruteForce as BruteForce
    from .cameras import Camera as Camera
    from .cameras import Fisheye as Fisheye
    from .cameras import Orthographic as Orthographic
    from .cameras import Panorama as Panorama
    from .cameras import Pose as Pose
    from .cameras import ThinLens as ThinLens
    from .exchange.radiative import radiative_exchange as radiative_exchange
    from .exchange.radiosity import radiosity as radiosity
    from .exchange.view_factors import view_factors as view_factors
    from .gpu import Gpu as Gpu
    from .integrators import AmbientOcclusion as AmbientOcclusion
    from .integrators import Bidirectional as Bidirectional
    from .integrators import Direct as Direct
    from .integrators import LightTraced as LightTraced
    from .integrators import Path as Path
    from .integrators import PhotonMap as PhotonMap
    from .integrators import ProgressivePhotonMap as ProgressivePhotonMap
    from .integrators import Radiosity as Radiosity
    from .integrators import RayCast as RayCast
    from .integrators import Whitted as Whitted
    from .lights import ConstantEnvironment as ConstantEnvironment
    from .lights import DirectionalLight as DirectionalLight
    from .lights import Emission as Emission
    from .lights import EnvironmentMap as EnvironmentMap
    from .lights import PointLight as PointLight
    from .lights import ProjectorLight as ProjectorLight
    from .lights import SpotLight as SpotLight
    from .lights import SunSky as SunSky
    from .materials import BumpMap as BumpMap
    from .materials import Conductor as Conductor
    from .materials import Dielectric as Dielectric
    from .materials import Diffuse as Diffuse
    from .materials import Mask as Mask
    from .materials import MediumInterface as MediumInterface
    from .materials import MetallicRough as MetallicRough
    from .materials import Mirror as Mirror
    from .materials import Mix as Mix
    from .materials import NormalMap as NormalMap
    from .materials import Plastic as Plastic
    from .materials import Principled as Principled
    from .materials import ThinDielectric as ThinDielectric
    from .materials import TwoSided as TwoSided
    from .media import GridMedium as GridMedium
    from .media import HenyeyGreenstein as HenyeyGreenstein
    from .media import Homogeneous as Homogeneous
    from .rendering.aovs import aovs as aovs
    from .rendering.frames import render_frames as render_frames
    from .rendering.image import Image as Image
    from .rendering.render import render as render
    from .scene.instance import Instance as Instance
    from .scene.scene import Scene as Scene
    from .scene_files.load import load as load
    from .scene_files.mitsuba import from_mitsuba as from_mitsuba
    from .shapes import Box as Box
    from .shapes import Cone as Cone
    from .shapes import Cylinder as Cylinder
    from .shapes import Disk as Disk
    from .shapes import Plane as Plane
    from .shapes import Polygon as Polygon
    from .shapes import Sphere as Sphere
    from .shapes import Torus as Torus
    from .shapes.mesh import Mesh as Mesh
    from .textures import Blackbody as Blackbody
    from .textures import Checker as Checker
    from .textures import ImageTexture as ImageTexture
    from .textures import Spectrum as Spectrum
    from .textures import VertexColors as VertexColors
    from .viewer import view as view

__version__ = _core.VERSION

# A type checker reads the imports above. At run time a name is imported when it is first used.
if not TYPE_CHECKING:
    _NAMES = {
        "_core": "simd",
        "accelerators": "BVH BruteForce",
        "cameras": "Camera Fisheye Orthographic Panorama Pose ThinLens",
        "exchange": "",
        "exchange.radiative": "radiative_exchange",
        "exchange.radiosity": "radiosity",
        "exchange.view_factors": "view_factors",
        "gpu": "Gpu",
        "integrators": (
            "AmbientOcclusion Bidirectional Direct LightTraced Path PhotonMap "
            "ProgressivePhotonMap Radiosity RayCast Whitted"
        ),
        "io": "",
        "lights": (
            "ConstantEnvironment DirectionalLight Emission EnvironmentMap PointLight "
            "ProjectorLight SpotLight SunSky"
        ),
        "materials": (
            "BumpMap Conductor Dielectric Diffuse Mask MediumInterface MetallicRough Mirror Mix "
            "NormalMap Plastic Principled ThinDielectric TwoSided"
        ),
        "measure": "",
        "media": "GridMedium HenyeyGreenstein Homogeneous",
        "query": "",
        "rendering": "",
        "rendering.aovs": "aovs",
        "rendering.frames": "render_frames",
        "rendering.image": "Image",
        "rendering.render": "render",
        "report": "",
        "scene": "",
        "scene.instance": "Instance",
        "scene.scene": "Scene",
        "scene_files.load": "load",
        "scene_files.mitsuba": "from_mitsuba",
        "scenes": "",
        "shapes": "Box Cone Cylinder Disk Plane Polygon Sphere Torus",
        "shapes.mesh": "Mesh",
        "textures": "Blackbody Checker ImageTexture Spectrum VertexColors",
        "viewer": "view",
    }
    _MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
    _ROOMS = {module.split(".")[0] for module in _NAMES} - {"_core", "scene_files"}
    __all__ = sorted({*_MODULES, *_ROOMS})

    def __getattr__(name: str) -> object:
        if name in _MODULES:
            value = getattr(import_module(f".{_MODULES[name]}", __name__), name)
            globals()[name] = value
            return value
        # A subpackage brings its public modules: `raywright.rendering.image` needs no import of its own.
        inner = [module for module in _NAMES if module.split(".")[0] == name]
        for module in inner:
            import_module(f".{module}", __name__)
        if inner:
            return globals()[name]
        homes = (room for room in sorted(_ROOMS) if name in import_module(f".{room}", __name__).__all__)
        home = None if name.startswith("_") else next(homes, None)
        where = f"; it is raywright.{home}.{name}" if home else ""
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}{where}")

    def __dir__() -> list[str]:
        return import_module(".public_names", __name__).public_names(__name__)()
