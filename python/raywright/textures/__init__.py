"""What varies over surfaces: wherever a material takes a colour or a number, a texture may stand."""

from .checker import Checker
from .fbm import FBm
from .image import ImageTexture
from .marble import Marble
from .mix import MixTexture
from .noise import Noise
from .product import ProductTexture
from .stripes import Stripes
from .texture import Texture
from .transform import ObjectTransform, UvTransform
from .vertex_colors import VertexColors
from .wood import Wood

__all__ = [
    "Checker",
    "FBm",
    "ImageTexture",
    "Marble",
    "MixTexture",
    "Noise",
    "ObjectTransform",
    "ProductTexture",
    "Stripes",
    "Texture",
    "UvTransform",
    "VertexColors",
    "Wood",
]
