"""Lights of a glTF file: KHR_lights_punctual, in watts."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ...lights import DirectionalLight, Light, PointLight, SpotLight
from ...mesh_files.gltf.document import Document
from ...mesh_files.gltf.nodes import Node
from ...mesh_files.gltf.part import Part

# Lumens per watt at 555 nm, by the definition of the candela. It converts candela and lux of the file,
# channel by channel, and is the factor in Blender's exporter.
LUMENS_PER_WATT = 683.0

_EXTENSION = "KHR_lights_punctual"


def lights(document: Document, nodes: list[Node]) -> Iterator[Light]:
    """Yield the lights of the nodes; those of no intensity are left out."""
    parts = document.root.part("extensions").part(_EXTENSION).parts("lights")
    for node in nodes:
        held = node.part.extension(_EXTENSION)
        if held is not None:
            light = parts[held.reference("light", "lights", len(parts))]
            made = _light(light, node)
            if made is not None:
                yield made


def _light(part: Part, node: Node) -> Light | None:
    color = part.numbers("color", 3, (1.0, 1.0, 1.0), 0)
    amount = color * part.number("intensity", 1.0, 0) / LUMENS_PER_WATT
    kind = part.text("type")
    if kind not in ("point", "spot", "directional"):
        raise ValueError(f"{part.at('type')} must be point, spot or directional, and is {kind[:20]!r}")
    if not amount.any():
        return None
    position = node.world[:3, 3]
    if kind == "point":
        return PointLight(position, amount)
    length = np.linalg.norm(node.world[:3, 2])
    if not length > 0:
        raise ValueError(f"{node.part.place} has a scale of 0, and a light with a direction")
    ahead = -node.world[:3, 2] / length
    if kind == "directional":
        return DirectionalLight(ahead, amount)
    cone = part.part("spot")
    outer = cone.number("outerConeAngle", math.pi / 4, 0, math.pi / 2 + 1e-6)
    inner = cone.number("innerConeAngle", 0.0, 0)
    if not inner < outer:
        raise ValueError(f"{cone.place} must have an inner angle below the outer one, and has {inner:g}")
    # Far from the origin, rounding would remove a step of 1.
    reach = max(1.0, float(np.abs(position).max()))
    rim = min(math.degrees(outer), 90.0)
    return SpotLight(position, position + reach * ahead, amount, rim, min(math.degrees(outer - inner), rim))
