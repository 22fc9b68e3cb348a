"""A scene described in lines of text."""

from __future__ import annotations

from .._core import simd
from ..shapes import Shape
from ..shapes.mesh import Mesh, face_count
from ..shapes.topology import degenerate_faces, is_watertight, open_edges
from .instance import Instance
from .scene import Scene

_MOST_SHAPES = 20


def described(name: str, scene: Scene) -> str:
    """Return a scene's contents and its accelerator's statistics as aligned lines under `name`."""
    meshes = [shape for shape in scene.shapes if isinstance(shape, Mesh)]
    copies = sum(len(shape) for shape in scene.shapes if isinstance(shape, Instance))
    others = len(scene.shapes) - len(meshes)
    info = scene.accelerator_info
    size = scene.bytes
    cracks, junctions = (sum(counts) for counts in zip((0, 0), *map(open_edges, meshes), strict=True))
    rows = [
        ("shapes", f"{len(scene.shapes)}" + (f", {others} of them no meshes" if others else "")),
        ("vertices", f"{sum(len(mesh.vertices) for mesh in meshes):,}"),
        ("faces", f"{sum(map(face_count, meshes)):,}"),
        *([("copies", f"{copies:,}")] if copies else []),
        ("bounds", _bounds(scene)),
        ("watertight", "yes" if all(map(is_watertight, meshes)) else "no"),
        ("open edges", f"{cracks:,}, and {junctions:,} T-junctions"),
        ("degenerate", f"{sum(map(degenerate_faces, meshes)):,} faces"),
        ("accelerator", info.kind),
        ("nodes", f"{info.nodes:,}, and {info.leaves:,} leaves; depth {info.depth}"),
        ("built in", f"{info.build_seconds:.4f} s"),
        ("SAH cost", f"{info.sah_cost:.4g}"),
        ("memory", f"{size:,} bytes, {size / max(info.primitives, 1):.1f} a triangle"),
        ("its tree", f"{info.bytes:,} bytes"),
        ("SIMD", simd()),
    ]
    lines = [name] + [f"  {label:<12} {value}" for label, value in rows]
    if len(scene.shapes) > 1:
        lines += [f"  shape {i:<6} {_counts(shape)}" for i, shape in enumerate(scene.shapes[:_MOST_SHAPES])]
        if len(scene.shapes) > _MOST_SHAPES:
            lines.append(f"  ... and {len(scene.shapes) - _MOST_SHAPES} more")
    return "\n".join(lines)


def _bounds(scene: Scene) -> str:
    if scene.bounds is None:
        return "none"
    low, high = (", ".join(f"{x:.6g}" for x in corner) for corner in scene.bounds)
    return f"({low}) to ({high})"


def _counts(shape: Mesh | Shape | Instance) -> str:
    if isinstance(shape, Instance):
        return f"{len(shape):,} copies of {shape.primitives:,} primitives"
    if not isinstance(shape, Mesh):
        return type(shape).__name__
    return f"{len(shape.vertices):,} vertices, {len(shape.faces):,} faces"
