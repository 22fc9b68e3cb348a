"""A scene as a line of text, and as a table that notebooks show."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from ..html_tables import html_table
from ..shapes.mesh import Mesh, face_count
from .instance import Instance

# A scene of this many faces compiles in some 50 ms, fast enough for a display.
_QUICK = 100_000
_DEFAULTS = {
    "precision": "auto",
    "quality": "medium",
    "medium": None,
    "shading_normals": "faded",
    "weld": "auto",
}


def scene_html(scene: Any) -> str:
    """Return a scene's contents, its accelerator and its plan as a table in HTML.

    A large scene that is not compiled is not compiled for that.
    """
    return html_table(f"Scene of {_counted(len(scene.shapes), 'shape')}", (), _rows(scene))


def scene_repr(scene: Any) -> str:
    """Return a scene in one line: numbers of its parts, and arguments other than the defaults."""
    parts = [_counted(len(scene.shapes), "shape"), _counted(sum(map(face_count, scene.shapes)), "face")]
    if scene.lights:
        parts.append(_counted(len(scene.lights), "light"))
    if scene.environment is not None:
        parts.append(repr(scene.environment))
    parts.append(repr(scene.accelerator))
    for name, default in _DEFAULTS.items():
        if (value := getattr(scene, name)) != default:
            parts.append(f"{name}={value!r}")
    return f"Scene({', '.join(parts)})"


def _counted(count: int, name: str) -> str:
    return f"{count} {name}{'' if count == 1 else 's'}"


def _rows(scene: Any) -> Iterator[tuple[str, str]]:
    meshes = [shape for shape in scene.shapes if isinstance(shape, Mesh)]
    copies = sum(len(shape) for shape in scene.shapes if isinstance(shape, Instance))
    faces = sum(map(face_count, meshes))
    yield "vertices", f"{sum(len(mesh.vertices) for mesh in meshes):,}"
    yield "faces", f"{faces:,}"
    if len(meshes) < len(scene.shapes):
        yield "no meshes", f"{len(scene.shapes) - len(meshes):,}"
    if copies:
        yield "copies", f"{copies:,}"
    if scene.lights:
        yield "lights", f"{len(scene.lights):,}"
    for name in ("environment", "medium"):
        if getattr(scene, name) is not None:
            yield name, repr(getattr(scene, name))
    if scene._core is None and (faces > _QUICK or copies):
        yield "accelerator", f"{scene.accelerator!r}, built by the first query or .build()"
        return
    info, bounds = scene.accelerator_info, scene.bounds
    if bounds is not None:
        yield "bounds", " to ".join(f"({', '.join(f'{x:.6g}' for x in corner)})" for corner in bounds)
    yield "precision", info.precision
    yield "accelerator", info.kind
    size = f"{info.nodes:,} nodes, {info.leaves:,} leaves, depth {info.depth}"
    yield "tree", f"{size}, SAH cost {info.sah_cost:.4g}"
    yield "built in", f"{info.build_seconds:.4f} s"
    yield "memory", f"{scene.bytes:,} bytes"
    yield "needs", ", ".join(scene.plan().needed) or "nothing more than rays"
