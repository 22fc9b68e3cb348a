"""Triangles of a glTF file: meshes from its primitives (glTF 2.0, 3.7)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import _core
from ...shapes.mesh import Mesh, noisy, stretched
from .accessors import Accessors
from .deform import Deform
from .document import Document
from .draco import decompressed
from .materials import Materials, Surface, Vertices
from .part import Part

Floats = NDArray[np.floating[Any]]

_TRIANGLES, _STRIP, _FAN = 4, 5, 6


class Geometry:
    """The meshes of a document, each made once for all the nodes where it stands."""

    def __init__(self, document: Document, accessors: Accessors) -> None:
        self._document = document
        self._all = document.root.parts("meshes")
        self._accessors = accessors
        self._materials = Materials(document)
        self._made: dict[int, tuple[Mesh, ...]] = {}

    def index(self, node: Part) -> int:
        """Return which mesh a node shows."""
        return node.reference("mesh", "meshes", len(self._all))

    def meshes(self, index: int, deform: Deform | None = None) -> tuple[Mesh, ...]:
        """Return the meshes that a mesh of the file is made of; points and lines are left out."""
        if deform is not None:
            return self._primitives(index, deform)
        if index not in self._made:
            self._made[index] = self._primitives(index, None)
        return self._made[index]

    def is_morphed(self, index: int) -> bool:
        """Return whether a mesh has shapes to be blended to."""
        return any("targets" in primitive for primitive in self._all[index].parts("primitives"))

    def weights(self, index: int) -> Part:
        """Return the part that holds how much of each shape a mesh has by itself."""
        return self._all[index]

    def _primitives(self, index: int, deform: Deform | None) -> tuple[Mesh, ...]:
        called = self._all[index].text("name", "")
        made = (self._mesh(part, deform, called) for part in self._all[index].parts("primitives"))
        return tuple(mesh for mesh in made if mesh is not None)

    def _mesh(self, primitive: Part, deform: Deform | None, name: str) -> Mesh | None:
        mode = primitive.integer("mode", _TRIANGLES, most=_FAN)
        attributes = primitive.part("attributes")
        if mode < _TRIANGLES or "POSITION" not in attributes:
            return None
        for part, of, array in decompressed(self._document, primitive):
            self._accessors.hold(part, of, array)
        given = vertices = self._accessors.vectors(attributes, "POSITION", 3)
        normals = self._accessors.vectors(attributes, "NORMAL", 3) if "NORMAL" in attributes else None
        if deform is not None:
            vertices, normals = deform.applied(primitive, vertices, normals)
        colors = self._accessors.vectors(attributes, "COLOR_0", 3, 4) if "COLOR_0" in attributes else None
        surface = self._materials.of(primitive, Vertices(colors is not None))
        uv: Floats | None = self._coordinates(attributes, f"TEXCOORD_{surface.coordinates or 0}")
        if colors is not None and surface.alpha_mode != "OPAQUE" and colors.shape[1] == 4:
            surface, colors, uv = self._with_alpha(primitive, surface, np.clip(colors, 0, 1), uv)
        corners = self._corners(primitive, len(vertices))
        for others in (normals, uv, colors):
            if others is not None and len(others) != len(vertices):
                both = f"{len(vertices)} of POSITION, and {len(others)} of others"
                raise ValueError(f"{attributes.place} has {both}")
        used: Any = slice(None)
        if 2 * len(corners) < len(vertices):
            # This primitive uses few of the shared vertices.
            used, corners = np.unique(corners, return_inverse=True)
        made = Mesh(
            vertices[used],
            _faces(corners.reshape(-1), mode, primitive),
            None if normals is None else normals[used],
            None if uv is None else uv[used],
            surface.material,
            surface.emission,
            # Colors of vertices are linear in glTF, unlike those of other files from trimesh.
            None if colors is None else np.clip(colors[used, :3], 0, 1),
            name,
        )
        if deform is None:
            return made
        return noisy(made, stretched(_core.weld_rounding(given[used], made.faces), deform.linear))

    def _with_alpha(
        self, primitive: Part, surface: Surface, colors: Floats, uv: Floats | None
    ) -> tuple[Surface, Floats | None, Floats | None]:
        """Return a material, colors and coordinates in which the alpha of vertex colors counts."""
        tint, alpha = colors[0, :3], colors[:, 3]
        plain = bool((colors[:, :3] == tint).all())
        if (alpha == alpha[0]).all():
            return self._materials.of(primitive, Vertices(True, alpha=float(alpha[0]))), colors, uv
        if surface.coordinates is None:
            # Texture coordinates are free, so that u can carry alpha.
            along = np.column_stack([u_of_alpha(surface, alpha), np.full(len(alpha), 0.5)])
            return self._materials.of(primitive, Vertices(True, alpha="u")), colors, along
        if plain and surface.alpha_mode == "BLEND":
            red, green, blue = tint.tolist()
            found = self._materials.of(primitive, Vertices(False, (red, green, blue), "colors"))
            return found, np.repeat(alpha[:, None], 3, axis=1), uv
        self._document.tell("alpha that varies over colors of vertices is left out of textured materials")
        return surface, colors, uv

    def _corners(self, primitive: Part, count: int) -> NDArray[np.int64]:
        if "indices" not in primitive:
            return np.arange(count)
        corners = self._accessors.integers(primitive, "indices")[:, 0].astype(np.int64)
        if corners.max() >= count:
            raise ValueError(f"{primitive.place} has index {corners.max()}, and there are {count} vertices")
        return corners

    def _coordinates(self, attributes: Part, name: str) -> NDArray[np.float64] | None:
        if name not in attributes:
            return None
        uv = self._accessors.vectors(attributes, name, 2).astype(np.float64)
        # v of glTF runs from the top of pictures downwards.
        uv[:, 1] = 1 - uv[:, 1]
        return uv


def u_of_alpha(surface: Surface, alpha: Floats) -> NDArray[np.float64]:
    """Return where the alpha of vertices lies along the picture of two texels for it."""
    total = alpha.astype(np.float64) * surface.alpha
    return 0.25 + total / 2 if surface.alpha_mode == "BLEND" else 0.5 + (total - surface.cutoff) / 4


def _faces(corners: NDArray[np.int64], mode: int, primitive: Part) -> NDArray[np.int64]:
    """Return the triangles of a list, a strip or a fan of corners (3.7.2.1)."""
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise ValueError(
                f"{primitive.place} has {len(corners)} corners of triangles, which is not a multiple of 3"
            )
        return corners.reshape(-1, 3)
    first = np.arange(max(len(corners) - 2, 0))
    if mode == _FAN:
        return corners[np.stack([first + 1, first + 2, np.zeros_like(first)], axis=1)]
    odd = first % 2
    return corners[np.stack([first, first + 1 + odd, first + 2 - odd], axis=1)]
