"""Ray tracing for Python: exact hits from numpy arrays, and pictures that say how wrong they still are."""

from importlib import import_module
from typing import TYPE_CHECKING

from . import _core

if TYPE_CHECKING:
    from . import measure as measure
    from . import report as report
    from . import scenes as scenes
    from ._core import AcceleratorInfo as AcceleratorInfo
    from ._core import simd as simd
    from .accelerators import BSP as BSP
    from .accelerators import BVH as BVH
    from .accelerators import BruteForce as BruteForce
    from .accelerators import Grid as Grid
    from .accelerators import KdTree as KdTree
    from .accelerators import NestedGrid as NestedGrid
    from .accelerators import Octree as Octree
    from .cameras import AnyCamera as AnyCamera
    from .cameras import Camera as Camera
    from .cameras import Fisheye as Fisheye
    from .cameras import Orthographic as Orthographic
    from .cameras import Panorama as Panorama
    from .cameras import Pose as Pose
    from .cameras import ThinLens as ThinLens
    from .exchange.radiative import RadiativeExchange as RadiativeExchange
    from .exchange.radiative import radiative_exchange as radiative_exchange
    from .exchange.radiosity import radiosity as radiosity
    from .exchange.solution import RadiositySolution as RadiositySolution
    from .exchange.solution import RadiosityStep as RadiosityStep
    from .exchange.view_factors import ViewFactors as ViewFactors
    from .exchange.view_factors import view_factors as view_factors
    from .gpu import Gpu as Gpu
    from .gpu import GpuScene as GpuScene
    from .gpu import GpuStats as GpuStats
    from .integrators import AmbientOcclusion as AmbientOcclusion
    from .integrators import BeamTraced as BeamTraced
    from .integrators import Bidirectional as Bidirectional
    from .integrators import ConeTraced as ConeTraced
    from .integrators import Direct as Direct
    from .integrators import Distributed as Distributed
    from .integrators import LightTraced as LightTraced
    from .integrators import Path as Path
    from .integrators import PhotonMap as PhotonMap
    from .integrators import ProgressivePhotonMap as ProgressivePhotonMap
    from .integrators import Radiosity as Radiosity
    from .integrators import RayCast as RayCast
    from .integrators import Whitted as Whitted
    from .integrators.base import Integrator as Integrator
    from .integrators.rng import Rng as Rng
    from .io.pictures import check_writable as check_writable
    from .lights import ConstantEnvironment as ConstantEnvironment
    from .lights import DirectionalLight as DirectionalLight
    from .lights import Emission as Emission
    from .lights import EnvironmentMap as EnvironmentMap
    from .lights import PointLight as PointLight
    from .lights import ProjectorLight as ProjectorLight
    from .lights import SpotLight as SpotLight
    from .lights import SunSky as SunSky
    from .materials import BlinnPhong as BlinnPhong
    from .materials import Boundary as Boundary
    from .materials import BumpMap as BumpMap
    from .materials import Cauchy as Cauchy
    from .materials import Conductor as Conductor
    from .materials import Dielectric as Dielectric
    from .materials import Diffuse as Diffuse
    from .materials import Dispersion as Dispersion
    from .materials import Mask as Mask
    from .materials import MetalIndex as MetalIndex
    from .materials import MetallicRough as MetallicRough
    from .materials import Mirror as Mirror
    from .materials import Mix as Mix
    from .materials import NormalMap as NormalMap
    from .materials import OrenNayar as OrenNayar
    from .materials import Phong as Phong
    from .materials import Plastic as Plastic
    from .materials import Principled as Principled
    from .materials import PrincipledThin as PrincipledThin
    from .materials import Sellmeier as Sellmeier
    from .materials import SoapFilm as SoapFilm
    from .materials import ThinDielectric as ThinDielectric
    from .materials import ThinFilm as ThinFilm
    from .materials import Tinted as Tinted
    from .materials import TwoSided as TwoSided
    from .materials import metal_index as metal_index
    from .materials import metals as metals
    from .materials.glasses import glasses as glasses
    from .media import GridMedium as GridMedium
    from .media import HenyeyGreenstein as HenyeyGreenstein
    from .media import Homogeneous as Homogeneous
    from .media import Isotropic as Isotropic
    from .media import Medium as Medium
    from .media import Rayleigh as Rayleigh
    from .media import SparseGrid as SparseGrid
    from .query.all_hits import AllHits as AllHits
    from .query.cones import ConeCoverage as ConeCoverage
    from .query.cones import ConeTouches as ConeTouches
    from .query.flats import FlatArrays as FlatArrays
    from .query.hits import ClosestPoints as ClosestPoints
    from .query.hits import Hits as Hits
    from .query.hits import QueryCost as QueryCost
    from .query.interactions import Interactions as Interactions
    from .query.interactions import LightSamples as LightSamples
    from .query.interactions import Rays as Rays
    from .query.interactions import Scattered as Scattered
    from .query.interactions import power_heuristic as power_heuristic
    from .query.leaving import LeavingRays as LeavingRays
    from .query.photons import Photons as Photons
    from .query.surface import Surface as Surface
    from .query.trees import TreeBoxes as TreeBoxes
    from .rendering.aovs import AOVS as AOVS
    from .rendering.aovs import aovs as aovs
    from .rendering.filters import BlackmanHarrisFilter as BlackmanHarrisFilter
    from .rendering.filters import BoxFilter as BoxFilter
    from .rendering.filters import CroppedFilter as CroppedFilter
    from .rendering.filters import GaussianFilter as GaussianFilter
    from .rendering.filters import LanczosFilter as LanczosFilter
    from .rendering.filters import MitchellFilter as MitchellFilter
    from .rendering.filters import TriangleFilter as TriangleFilter
    from .rendering.frames import render_frames as render_frames
    from .rendering.halves import Halves as Halves
    from .rendering.image import ErrorEstimate as ErrorEstimate
    from .rendering.image import Image as Image
    from .rendering.plan import Choice as Choice
    from .rendering.plan import RenderPlan as RenderPlan
    from .rendering.render import render as render
    from .rendering.samplers import Halton as Halton
    from .rendering.samplers import Independent as Independent
    from .rendering.samplers import Lattice as Lattice
    from .rendering.samplers import Sobol as Sobol
    from .rendering.samplers import Stratified as Stratified
    from .rendering.shot import Shot as Shot
    from .scene.instance import Instance as Instance
    from .scene.plan import Plan as Plan
    from .scene.plan import PlanRow as PlanRow
    from .scene.scene import Scene as Scene
    from .scene_files.load import load as load
    from .scene_files.mitsuba import from_mitsuba as from_mitsuba
    from .shapes import Box as Box
    from .shapes import Cone as Cone
    from .shapes import Cylinder as Cylinder
    from .shapes import Disk as Disk
    from .shapes import Ellipsoid as Ellipsoid
    from .shapes import Implicit as Implicit
    from .shapes import Paraboloid as Paraboloid
    from .shapes import Plane as Plane
    from .shapes import Polygon as Polygon
    from .shapes import Sphere as Sphere
    from .shapes import Torus as Torus
    from .shapes.mesh import Mesh as Mesh
    from .textures import Blackbody as Blackbody
    from .textures import Checker as Checker
    from .textures import FBm as FBm
    from .textures import Illuminants as Illuminants
    from .textures import ImageTexture as ImageTexture
    from .textures import Marble as Marble
    from .textures import MixTexture as MixTexture
    from .textures import Noise as Noise
    from .textures import ObjectTransform as ObjectTransform
    from .textures import ProductTexture as ProductTexture
    from .textures import Spectrum as Spectrum
    from .textures import Stripes as Stripes
    from .textures import UvTransform as UvTransform
    from .textures import VertexColors as VertexColors
    from .textures import Wood as Wood
    from .textures.illuminants import illuminants as illuminants
    from .viewer import Viewer as Viewer
    from .viewer import view as view

__version__ = _core.VERSION

# A type checker reads the imports above. At run time a name is imported when it is first used.
if not TYPE_CHECKING:
    _NAMES = {
        "_core": "AcceleratorInfo simd",
        "accelerators": "BSP BVH BruteForce Grid KdTree NestedGrid Octree",
        "cameras": "AnyCamera Camera Fisheye Orthographic Panorama Pose ThinLens",
        "exchange.radiative": "RadiativeExchange radiative_exchange",
        "exchange.radiosity": "radiosity",
        "exchange.solution": "RadiositySolution RadiosityStep",
        "exchange.view_factors": "ViewFactors view_factors",
        "gpu": "Gpu GpuScene GpuStats",
        "integrators": (
            "AmbientOcclusion BeamTraced Bidirectional ConeTraced Direct Distributed "
            "LightTraced Path PhotonMap ProgressivePhotonMap Radiosity RayCast Whitted"
        ),
        "integrators.base": "Integrator",
        "integrators.rng": "Rng",
        "io.pictures": "check_writable",
        "lights": (
            "ConstantEnvironment DirectionalLight Emission EnvironmentMap PointLight "
            "ProjectorLight SpotLight SunSky"
        ),
        "materials": (
            "BlinnPhong Boundary BumpMap Cauchy Conductor Dielectric Diffuse Dispersion "
            "Mask MetalIndex MetallicRough Mirror Mix NormalMap OrenNayar Phong Plastic "
            "Principled PrincipledThin Sellmeier SoapFilm ThinDielectric ThinFilm Tinted "
            "TwoSided metal_index metals"
        ),
        "materials.glasses": "glasses",
        "measure": "",
        "media": "GridMedium HenyeyGreenstein Homogeneous Isotropic Medium Rayleigh SparseGrid",
        "query.all_hits": "AllHits",
        "query.cones": "ConeCoverage ConeTouches",
        "query.flats": "FlatArrays",
        "query.hits": "ClosestPoints Hits QueryCost",
        "query.interactions": "Interactions LightSamples Rays Scattered power_heuristic",
        "query.leaving": "LeavingRays",
        "query.photons": "Photons",
        "query.surface": "Surface",
        "query.trees": "TreeBoxes",
        "rendering.aovs": "AOVS aovs",
        "rendering.filters": (
            "BlackmanHarrisFilter BoxFilter CroppedFilter GaussianFilter LanczosFilter "
            "MitchellFilter TriangleFilter"
        ),
        "rendering.frames": "render_frames",
        "rendering.halves": "Halves",
        "rendering.image": "ErrorEstimate Image",
        "rendering.plan": "Choice RenderPlan",
        "rendering.render": "render",
        "rendering.samplers": "Halton Independent Lattice Sobol Stratified",
        "rendering.shot": "Shot",
        "report": "",
        "scene.instance": "Instance",
        "scene.plan": "Plan PlanRow",
        "scene.scene": "Scene",
        "scene_files.load": "load",
        "scene_files.mitsuba": "from_mitsuba",
        "scenes": "",
        "shapes": ("Box Cone Cylinder Disk Ellipsoid Implicit Paraboloid Plane Polygon Sphere Torus"),
        "shapes.mesh": "Mesh",
        "textures": (
            "Blackbody Checker FBm Illuminants ImageTexture Marble MixTexture Noise "
            "ObjectTransform ProductTexture Spectrum Stripes UvTransform VertexColors Wood"
        ),
        "textures.illuminants": "illuminants",
        "viewer": "Viewer view",
    }
    _MODULES = {name: module for module, names in _NAMES.items() for name in names.split()}
    __all__ = sorted({*_MODULES, *(module for module, names in _NAMES.items() if not names)})

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
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        # Only public names, imported or not.
        return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
