"""Ray tracing for Python: exact hits from numpy arrays, and pictures that say how wrong they still are."""

from typing import TYPE_CHECKING

from . import _core, scenes
from ._core import AcceleratorInfo, simd
from .accelerators import BSP, BVH, BruteForce, Grid, KdTree, NestedGrid, Octree
from .cameras import AnyCamera, Camera, Fisheye, Orthographic, Panorama, Pose, ThinLens
from .exchange.solution import RadiositySolution, RadiosityStep
from .integrators import (
    AmbientOcclusion,
    BeamTraced,
    Bidirectional,
    ConeTraced,
    Direct,
    Distributed,
    LightTraced,
    Path,
    PhotonMap,
    ProgressivePhotonMap,
    Radiosity,
    RayCast,
    Whitted,
)
from .integrators.base import Integrator
from .integrators.rng import Rng
from .io.pictures import check_writable
from .lights import (
    ConstantEnvironment,
    DirectionalLight,
    Emission,
    EnvironmentMap,
    PointLight,
    ProjectorLight,
    SpotLight,
    SunSky,
)
from .materials import (
    BlinnPhong,
    Boundary,
    BumpMap,
    Cauchy,
    Conductor,
    Dielectric,
    Diffuse,
    Dispersion,
    Mask,
    MetalIndex,
    MetallicRough,
    Mirror,
    Mix,
    NormalMap,
    OrenNayar,
    Phong,
    Plastic,
    Principled,
    PrincipledThin,
    Sellmeier,
    SoapFilm,
    ThinDielectric,
    ThinFilm,
    Tinted,
    TwoSided,
    glasses,
    metal_index,
    metals,
)
from .media import GridMedium, HenyeyGreenstein, Homogeneous, Isotropic, Medium, Rayleigh, SparseGrid
from .query.all_hits import AllHits
from .query.cones import ConeCoverage, ConeTouches
from .query.flats import FlatArrays
from .query.hits import ClosestPoints, Hits, QueryCost
from .query.interactions import Interactions, LightSamples, Rays, Scattered, power_heuristic
from .query.leaving import LeavingRays
from .query.photons import Photons
from .query.surface import Surface
from .query.trees import TreeBoxes
from .rendering.aovs import AOVS, aovs
from .rendering.filters import (
    BlackmanHarrisFilter,
    BoxFilter,
    CroppedFilter,
    GaussianFilter,
    LanczosFilter,
    MitchellFilter,
    TriangleFilter,
)
from .rendering.frames import render_frames
from .rendering.halves import Halves
from .rendering.image import ErrorEstimate, Image
from .rendering.plan import Choice, RenderPlan
from .rendering.render import render
from .rendering.samplers import Halton, Independent, Lattice, Sobol, Stratified
from .rendering.shot import Shot
from .scene.instance import Instance
from .scene.plan import Plan, PlanRow
from .scene.scene import Scene
from .shapes import Box, Cone, Cylinder, Disk, Ellipsoid, Implicit, Paraboloid, Plane, Polygon, Sphere, Torus
from .shapes.mesh import Mesh
from .textures import (
    Blackbody,
    Checker,
    FBm,
    Illuminants,
    ImageTexture,
    Marble,
    MixTexture,
    Noise,
    ObjectTransform,
    ProductTexture,
    Spectrum,
    Stripes,
    UvTransform,
    VertexColors,
    Wood,
    illuminants,
)

if TYPE_CHECKING:
    from . import measure, report
    from .exchange.radiative import RadiativeExchange, radiative_exchange
    from .exchange.radiosity import radiosity
    from .exchange.view_factors import ViewFactors, view_factors
    from .gpu import Gpu, GpuScene, GpuStats
    from .scene_files.load import load
    from .scene_files.mitsuba import from_mitsuba
    from .viewer import Viewer, view

__all__ = [
    "AOVS",
    "BSP",
    "BVH",
    "AcceleratorInfo",
    "AllHits",
    "AmbientOcclusion",
    "AnyCamera",
    "BeamTraced",
    "Bidirectional",
    "Blackbody",
    "BlackmanHarrisFilter",
    "BlinnPhong",
    "Boundary",
    "Box",
    "BoxFilter",
    "BruteForce",
    "BumpMap",
    "Camera",
    "Cauchy",
    "Checker",
    "Choice",
    "ClosestPoints",
    "Conductor",
    "Cone",
    "ConeCoverage",
    "ConeTouches",
    "ConeTraced",
    "ConstantEnvironment",
    "CroppedFilter",
    "Cylinder",
    "Dielectric",
    "Diffuse",
    "Direct",
    "DirectionalLight",
    "Disk",
    "Dispersion",
    "Distributed",
    "Ellipsoid",
    "Emission",
    "EnvironmentMap",
    "ErrorEstimate",
    "FBm",
    "Fisheye",
    "FlatArrays",
    "GaussianFilter",
    "Gpu",
    "GpuScene",
    "GpuStats",
    "Grid",
    "GridMedium",
    "Halton",
    "Halves",
    "HenyeyGreenstein",
    "Hits",
    "Homogeneous",
    "Illuminants",
    "Image",
    "ImageTexture",
    "Implicit",
    "Independent",
    "Instance",
    "Integrator",
    "Interactions",
    "Isotropic",
    "KdTree",
    "LanczosFilter",
    "Lattice",
    "LeavingRays",
    "LightSamples",
    "LightTraced",
    "Marble",
    "Mask",
    "Medium",
    "Mesh",
    "MetalIndex",
    "MetallicRough",
    "Mirror",
    "MitchellFilter",
    "Mix",
    "MixTexture",
    "NestedGrid",
    "Noise",
    "NormalMap",
    "ObjectTransform",
    "Octree",
    "OrenNayar",
    "Orthographic",
    "Panorama",
    "Paraboloid",
    "Path",
    "Phong",
    "PhotonMap",
    "Photons",
    "Plan",
    "PlanRow",
    "Plane",
    "Plastic",
    "PointLight",
    "Polygon",
    "Pose",
    "Principled",
    "PrincipledThin",
    "ProductTexture",
    "ProgressivePhotonMap",
    "ProjectorLight",
    "QueryCost",
    "RadiativeExchange",
    "Radiosity",
    "RadiositySolution",
    "RadiosityStep",
    "RayCast",
    "Rayleigh",
    "Rays",
    "RenderPlan",
    "Rng",
    "Scattered",
    "Scene",
    "Sellmeier",
    "Shot",
    "SoapFilm",
    "Sobol",
    "SparseGrid",
    "Spectrum",
    "Sphere",
    "SpotLight",
    "Stratified",
    "Stripes",
    "SunSky",
    "Surface",
    "ThinDielectric",
    "ThinFilm",
    "ThinLens",
    "Tinted",
    "Torus",
    "TreeBoxes",
    "TriangleFilter",
    "TwoSided",
    "UvTransform",
    "VertexColors",
    "ViewFactors",
    "Viewer",
    "Whitted",
    "Wood",
    "aovs",
    "check_writable",
    "from_mitsuba",
    "glasses",
    "illuminants",
    "load",
    "measure",
    "metal_index",
    "metals",
    "power_heuristic",
    "radiative_exchange",
    "radiosity",
    "render",
    "render_frames",
    "report",
    "scenes",
    "simd",
    "view",
    "view_factors",
]

__version__ = _core.VERSION

if not TYPE_CHECKING:
    # These are for those who ask for them: nothing else waits for their import.
    _LATER = {
        "Gpu": ".gpu",
        "GpuScene": ".gpu",
        "GpuStats": ".gpu",
        "RadiativeExchange": ".exchange.radiative",
        "ViewFactors": ".exchange.view_factors",
        "Viewer": ".viewer",
        "from_mitsuba": ".scene_files.mitsuba",
        "load": ".scene_files.load",
        "measure": ".measure",
        "radiative_exchange": ".exchange.radiative",
        "radiosity": ".exchange.radiosity",
        "report": ".report",
        "view": ".viewer",
        "view_factors": ".exchange.view_factors",
    }

    def __getattr__(name: str) -> object:
        if name in _LATER:
            from importlib import import_module

            module = import_module(_LATER[name], __name__)
            return module if name in ("measure", "report") else getattr(module, name)
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")

    def __dir__() -> list[str]:
        # What is public, whether it is imported yet or not, and none of what it is made of.
        return sorted({*__all__, *(name for name in globals() if name.startswith("__"))})
