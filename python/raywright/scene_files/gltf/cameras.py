"""Cameras of a glTF file (glTF 2.0, 3.10)."""

from __future__ import annotations

import math

from ...cameras import AnyCamera, Camera, Orthographic
from ...mesh_files.gltf.document import Document
from ...mesh_files.gltf.nodes import Node
from ...mesh_files.gltf.part import Part

# Size of pictures if the file does not state an aspect ratio.
_WIDTH, _HEIGHT = 640, 480


def camera(document: Document, nodes: list[Node]) -> AnyCamera | None:
    """Return the first camera of the nodes, None if there is none. Pictures are 480 points high."""
    parts = document.root.parts("cameras")
    held = [node for node in nodes if "camera" in node.part]
    if not held:
        return None
    if len(held) > 1:
        document.tell(f"the first of its {len(held)} cameras is taken")
    node = held[0]
    made = parts[node.part.reference("camera", "cameras", len(parts))]
    kind = made.text("type")
    if kind not in ("perspective", "orthographic"):
        raise ValueError(f"{made.at('type')} must be perspective or orthographic, and is {kind[:20]!r}")
    try:
        return _made(made.part(kind), kind, node)
    except ValueError as error:
        raise ValueError(f"{made.place} at {node.part.place}: {error}") from error


def _made(part: Part, kind: str, node: Node) -> AnyCamera:
    # The camera looks along its -z with y up; scale and shear of its node do not count.
    position, ahead, up = node.world[:3, 3], -node.world[:3, 2], node.world[:3, 1]
    if kind == "perspective":
        fov = math.degrees(part.number("yfov", None, 0, math.pi))
        aspect = part.number("aspectRatio", _WIDTH / _HEIGHT, 0)
        return Camera(position, None, up, fov, _width(aspect), _HEIGHT, direction=ahead)
    # Some programs mirror by negative values, which have no meaning for a picture.
    across, high = abs(part.number("xmag")), abs(part.number("ymag"))
    aspect = across / high if high else 0.0
    return Orthographic(position, None, up, 2 * high, _width(aspect), _HEIGHT, direction=ahead)


def _width(aspect: float) -> int:
    width = round(_HEIGHT * aspect) if aspect < 1000 else 0
    if width < 1:
        raise ValueError(f"a picture cannot be {aspect:g} times as wide as high")
    return width
