"""Interiors of clear materials of a glTF file, and films on them (KHR_materials_volume, and others)."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..pbr import Film, Picture, Within
from .part import Part

# Replaces a transmittance of 0, which no finite distance reaches.
_LEAST = 1e-6
# Abbe's number for a dispersion of 1 (KHR_materials_dispersion).
_ABBE = 20.0


def within(part: Part) -> Within | None:
    """Return what a material encloses, None if it is a thin sheet."""
    volume = part.extension("KHR_materials_volume")
    if volume is None or volume.number("thicknessFactor", 0.0, 0) == 0:
        return None
    # The mesh itself has the thickness. Without a distance, nothing is absorbed.
    told = "attenuationDistance" in volume
    distance = volume.number("attenuationDistance", least=0) if told else math.inf
    color = volume.numbers("attenuationColor", 3, (1.0, 1.0, 1.0), 0, 1)
    red, green, blue = (max(float(share), _LEAST) for share in color)
    spread = part.extension("KHR_materials_dispersion")
    dispersion = 0.0 if spread is None else spread.number("dispersion", 0.0, 0)
    return Within((red, green, blue), distance, _ABBE / dispersion if dispersion else None)


def film(part: Part, picture: Callable[[Part, str], Picture | None]) -> Film | None:
    """Return the film on a material, None if there is none."""
    thin = part.extension("KHR_materials_iridescence")
    factor = 0.0 if thin is None else thin.number("iridescenceFactor", 0.0, 0, 1)
    if thin is None or factor == 0:
        return None
    return Film(
        factor,
        picture(thin, "iridescenceTexture"),
        thin.number("iridescenceIor", 1.3, 1),
        thin.number("iridescenceThicknessMinimum", 100.0, 0),
        thin.number("iridescenceThicknessMaximum", 400.0, 0),
        picture(thin, "iridescenceThicknessTexture"),
    )
