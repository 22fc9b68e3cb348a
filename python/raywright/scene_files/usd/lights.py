"""Lights of a USD stage."""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read_linear
from ...lights import ConstantEnvironment, DirectionalLight, EnvironmentMap
from ...materials import Diffuse
from ...shapes import Cylinder, Disk, Sphere
from ...shapes.mesh import Mesh
from .notes import Notes

Matrix = NDArray[np.float64]

# The middle of a dome's picture is seen along +z, ours along -z.
_HALF_TURN = np.diag([-1.0, 1.0, -1.0])


class Lit(NamedTuple):
    """A light, a shape that shines, or what is around."""

    kind: str
    thing: Any


def light(prim: Any, matrix: Matrix, time: Any, notes: Notes) -> Lit | None:
    """Return what a prim shines as; None if it is no light."""
    from pxr import UsdLux

    api = UsdLux.LightAPI(prim)
    if not api:
        return None
    kind = prim.GetTypeName()
    colour = np.array(api.GetColorAttr().Get(time), np.float64)
    if api.GetEnableColorTemperatureAttr().Get(time):
        notes.tell("the colour temperature of lights is left out")
    shine = colour * float(api.GetIntensityAttr().Get(time)) * 2.0 ** float(api.GetExposureAttr().Get(time))
    normalised = bool(api.GetNormalizeAttr().Get(time))
    if UsdLux.ShapingAPI(prim).GetShapingConeAngleAttr().HasAuthoredValue():
        notes.tell("the cones of lights are left out")

    def number(name: str, default: float) -> float:
        value = prim.GetAttribute(f"inputs:{name}").Get(time)
        return default if value is None else float(value)

    if kind == "DistantLight":
        half = math.radians(0.5 * number("angle", 0.53))
        size = 1.0 if normalised else math.pi * math.sin(half) ** 2
        return Lit("light", DirectionalLight(-matrix[:3, 2], shine * size))
    if kind in ("DomeLight", "DomeLight_1"):
        return Lit("around", _dome(prim, matrix, time, shine))
    look: dict[str, Any] = {"material": Diffuse(0.0)}
    shape: Any
    if kind == "SphereLight":
        shape = Sphere(radius=number("radius", 0.5), transform=matrix, **look)
    elif kind == "DiskLight":
        shape = Disk((0, 0, 0), (0, 0, -1), number("radius", 0.5), transform=matrix, **look)
    elif kind == "CylinderLight":
        length = number("length", 1.0)
        ends = (-0.5 * length, 0, 0), (0.5 * length, 0, 0)
        shape = Cylinder(*ends, number("radius", 0.5), capped=False, transform=matrix, **look)
    elif kind == "RectLight":
        if prim.GetAttribute("inputs:texture:file").Get(time):
            notes.tell("the pictures of RectLights are left out")
        x, y = 0.5 * number("width", 1.0), 0.5 * number("height", 1.0)
        # Its front is along -z.
        corners = [(-x, -y, 0), (-x, y, 0), (x, y, 0), (x, -y, 0)]
        shape = Mesh(corners, [(0, 1, 2), (0, 2, 3)], **look).transformed(matrix)
    else:
        notes.tell(f"lights of type {kind} are left out")
        return Lit("light", DirectionalLight((0, 0, -1), 0.0))
    area = 1.0
    if normalised:
        area = _area(shape) if isinstance(shape, Mesh) else shape.area
    return Lit("shape", _shining(shape, shine / area))


def _shining(shape: Any, radiance: Matrix) -> Any:
    values = {name: getattr(shape, name) for name in shape.__dataclass_fields__}
    return type(shape)(**{**values, "emission": radiance})


def _area(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _dome(prim: Any, matrix: Matrix, time: Any, shine: Matrix) -> ConstantEnvironment | EnvironmentMap:
    given = prim.GetAttribute("inputs:texture:file").Get(time)
    if not given:
        return ConstantEnvironment(shine)
    kind = prim.GetAttribute("inputs:texture:format").Get(time)
    if kind not in (None, "automatic", "latlong"):
        raise ValueError(f"{prim.GetPath()} must have a picture of format latlong, got {kind!r}")
    image = read_linear(given.resolvedPath or given.path) * shine
    linear = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    return EnvironmentMap(image, linear @ _HALF_TURN)
