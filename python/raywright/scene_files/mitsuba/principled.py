"""The principled models."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...materials import Material, Principled, PrincipledThin
from ...textures import ProductTexture
from ...textures.texture import Number, Texture, ends
from .plugin import Plugin
from .textures import scalar, value
from .uv import Uv

# Names here, if they differ.
_NAMES = {
    "roughness": "roughness",
    "anisotropic": "anisotropic",
    "spec_trans": "transmission",
    "spec_tint": "specular_tint",
    "sheen": "sheen",
    "sheen_tint": "sheen_tint",
    "flatness": "flatness",
}


def principled(plugin: Plugin, uv: Uv) -> tuple[Material, bool]:
    """Return the material of a ``principled``, and whether its back is black."""
    plugin.ignore(
        "diffuse_reflectance_sampling_rate", "main_specular_sampling_rate", "clearcoat_sampling_rate"
    )
    if plugin.has("eta"):
        if plugin.has("specular"):
            plugin.fail("either eta or specular must be given, got both")
        ior = plugin.number("eta", 1.5)
    else:
        specular = plugin.number("specular", 0.5)
        if not 0 <= specular <= 1:
            plugin.fail(f"specular must be between 0 and 1, got {specular:g}")
        ior = 2 / (1 - math.sqrt(0.08 * max(specular, 1e-3))) - 1
    made = Principled(
        metallic=scalar(plugin, "metallic", 0.0, uv),
        ior=ior,
        clearcoat=scalar(plugin, "clearcoat", 0.0, uv),
        clearcoat_gloss=scalar(plugin, "clearcoat_gloss", 0.0, uv),
        energy_conserving=False,
        **_common(plugin, uv),
    )
    return made, ends(_wide(made.transmission))[1][0] == 0


def principled_thin(plugin: Plugin, uv: Uv) -> Material:
    """Return the material of a ``principledthin``."""
    plugin.ignore(
        "specular_reflectance_sampling_rate",
        "specular_transmittance_sampling_rate",
        "diffuse_transmittance_sampling_rate",
        "diffuse_reflectance_sampling_rate",
    )
    # From 0 to 2 in Mitsuba.
    across = scalar(plugin, "diff_trans", 0.0, uv)
    half: Number = ProductTexture(across, 0.5) if isinstance(across, Texture) else 0.5 * across
    eta = plugin.number("eta", 1.5)
    return PrincipledThin(ior=eta, diffuse_transmission=half, energy_conserving=False, **_common(plugin, uv))


def _common(plugin: Plugin, uv: Uv) -> dict[str, Any]:
    default = {"roughness": 0.5}
    numbers = {ours: scalar(plugin, name, default.get(name, 0.0), uv) for name, ours in _NAMES.items()}
    if uv.turned and np.max(ends(_wide(numbers["anisotropic"]))) > 0:
        plugin.fail("anisotropic on a disk is not supported")
    return {"base_color": value(plugin, "base_color", 0.5, uv), **numbers}


def _wide(given: Number) -> Any:
    return given if isinstance(given, Texture) else (given, given, given)
