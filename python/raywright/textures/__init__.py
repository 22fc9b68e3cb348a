"""Textures: every color or number of a material may vary over the surface."""

from __future__ import annotations

from ..public_names import public_names
from .blackbody import Blackbody
from .checker import Checker
from .fbm import FBm
from .illuminants import Illuminants, illuminants
from .image import ImageTexture
from .marble import Marble
from .mix import MixTexture
from .noise import Noise
from .product import ProductTexture
from .spectrum import Spectrum
from .stripes import Stripes
from .texture import Texture as Texture
from .transform import ObjectTransform, UvTransform
from .vertex_colors import VertexColors
from .wood import Wood

__all__ = [
    "Blackbody",
    "Checker",
    "FBm",
    "Illuminants",
    "ImageTexture",
    "Marble",
    "MixTexture",
    "Noise",
    "ObjectTransform",
    "ProductTexture",
    "Spectrum",
    "Stripes",
    "UvTransform",
    "VertexColors",
    "Wood",
    "illuminants",
]
__dir__ = public_names(__name__)
