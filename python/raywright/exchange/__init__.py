"""Diffuse exchange between surfaces: view factors, radiosity, radiative heat transfer."""

from __future__ import annotations

from ..public_names import public_names
from .radiative import RadiativeExchange
from .solution import RadiositySolution, RadiosityStep
from .view_factor_matrix import ViewFactors

__all__ = [
    "RadiativeExchange",
    "RadiositySolution",
    "RadiosityStep",
    "ViewFactors",
]
__dir__ = public_names(__name__)
