"""From a scene and a camera to a picture, with its error against its time."""

from __future__ import annotations

from ..public_names import public_names
from .aovs import AOVS
from .error_estimate import ErrorEstimate
from .filters import (
    BlackmanHarrisFilter,
    BoxFilter,
    CroppedFilter,
    GaussianFilter,
    LanczosFilter,
    MitchellFilter,
    TriangleFilter,
)
from .halves import Halves
from .image import Image
from .plan import Choice, RenderPlan
from .render_setup import RenderSetup
from .samplers import Halton, Independent, Lattice, Sobol, Stratified

__all__ = [
    "AOVS",
    "BlackmanHarrisFilter",
    "BoxFilter",
    "Choice",
    "CroppedFilter",
    "ErrorEstimate",
    "GaussianFilter",
    "Halton",
    "Halves",
    "Image",
    "Independent",
    "LanczosFilter",
    "Lattice",
    "MitchellFilter",
    "RenderPlan",
    "RenderSetup",
    "Sobol",
    "Stratified",
    "TriangleFilter",
]
__dir__ = public_names(__name__)
