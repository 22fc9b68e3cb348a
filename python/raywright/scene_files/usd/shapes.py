"""Shapes of a USD stage."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import choice
from ...materials import Diffuse
from ...shapes import Box, Cone, Cylinder, Sphere
from ...shapes.mesh import Mesh
from ...textures import ProductTexture
from ...textures.texture import Texture, Value
from .lights import Source, mesh_area, shining
from .materials import bound, own_color, own_surface
from .meshes import meshes
from .reading import Reading

Matrix = NDArray[np.float64]


def shapes(prim: Any, reading: Reading, matrix: Matrix) -> list[Any]:
    """Return the shapes that a prim is, where a matrix puts it; none if it is something else."""
    from pxr import UsdGeom, UsdLux

    if prim.IsA(UsdGeom.Mesh):
        found = meshes(UsdGeom.Mesh(prim), reading, matrix)
    else:
        found = _simple(prim, reading, matrix)
    if found and (prim.HasAPI(UsdLux.MeshLightAPI) or prim.HasAPI(UsdLux.VolumeLightAPI)):
        return _lamp(prim, reading, found)
    return found


def _simple(prim: Any, reading: Reading, matrix: Matrix) -> list[Any]:
    from pxr import UsdGeom

    kind = str(prim.GetTypeName())
    if kind not in ("Sphere", "Cube", "Cylinder", "Cone"):
        if prim.IsA(UsdGeom.Gprim):
            reading.notes.tell(f"shapes of type {kind} are left out")
        return []
    # Vertex colors are one color for the whole shape here.
    surface = bound(prim, reading, own_color(prim, reading)) or own_surface(prim, reading)
    if surface.uv is not None:
        reading.notes.tell(f"textures on a {kind} are placed by coordinates of its own")
    look: dict[str, Any] = {"transform": matrix, "material": surface.material, "emission": surface.emission}

    def number(name: str) -> float:
        return float(reading.value(prim.GetAttribute(name)))

    if kind == "Sphere":
        return [Sphere(radius=number("radius"), **look)]
    if kind == "Cube":
        half = 0.5 * number("size")
        return [Box((-half,) * 3, (half,) * 3, **look)]
    axis = str(reading.value(prim.GetAttribute("axis")))
    choice("axis", axis, ("X", "Y", "Z"))
    end = np.zeros(3)
    end["XYZ".index(axis)] = 0.5 * number("height")
    if kind == "Cylinder":
        return [Cylinder(-end, end, number("radius"), **look)]
    return [Cone(-end, end, number("radius"), 0.0, **look)]


def _lamp(prim: Any, reading: Reading, found: list[Any]) -> list[Any]:
    """Return shapes as the light that they are."""
    source = Source(prim, reading)
    source.tell_cone()
    shine = source.shine
    if source.normalized:
        shine = shine / sum(mesh_area(one) if isinstance(one, Mesh) else one.area for one in found)
    mode = str(reading.value(prim.GetAttribute("light:materialSyncMode"), "materialGlowTintsLight"))
    red, green, blue = (float(x) for x in shine)
    lamps = []
    for one in found:
        changes = {"material": Diffuse(0.0)} if mode == "noMaterialResponse" else {}
        tint: Value | None = one.emission if mode == "materialGlowTintsLight" else None
        emission: Value = (red, green, blue)
        if isinstance(tint, Texture):
            emission = ProductTexture(tint, emission)
        elif tint is not None:
            emission = (red * tint[0], green * tint[1], blue * tint[2])
        lamps.append(shining(one, emission, **changes))
    return lamps
