"""Materials: how surfaces scatter light."""

from __future__ import annotations

from ..public_names import public_names
from .blinn_phong import BlinnPhong
from .bump_map import BumpMap
from .conductor import Conductor, MetalIndex, metal_index, metals
from .dielectric import Dielectric
from .diffuse import Diffuse
from .dispersion import Cauchy, Dispersion, Sellmeier
from .glasses import Glasses as Glasses
from .glasses import glasses
from .mask import Mask
from .material import Material as Material
from .medium_interface import MediumInterface
from .metallic_rough import MetallicRough
from .mirror import Mirror
from .mix import Mix
from .normal_map import NormalMap
from .oren_nayar import OrenNayar
from .phong import Phong
from .plastic import Plastic
from .principled import Principled, PrincipledThin
from .thin_dielectric import ThinDielectric
from .thin_film import SoapFilm, ThinFilm
from .tinted import Tinted
from .two_sided import TwoSided

__all__ = [
    "BlinnPhong",
    "BumpMap",
    "Cauchy",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "Dispersion",
    "Mask",
    "MediumInterface",
    "MetalIndex",
    "MetallicRough",
    "Mirror",
    "Mix",
    "NormalMap",
    "OrenNayar",
    "Phong",
    "Plastic",
    "Principled",
    "PrincipledThin",
    "Sellmeier",
    "SoapFilm",
    "ThinDielectric",
    "ThinFilm",
    "Tinted",
    "TwoSided",
    "glasses",
    "metal_index",
    "metals",
]
__dir__ = public_names(__name__)
