"""Lights of a USD stage."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...lights import ConstantEnvironment, DirectionalLight, EnvironmentMap, PointLight, SpotLight
from ...materials import Diffuse
from ...shapes import Cylinder, Disk, Sphere
from ...shapes.mesh import Mesh
from .reading import Reading

Matrix = NDArray[np.float64]

# The middle of a dome's picture is along +z, ours along -z.
_HALF_TURN = np.diag([-1.0, 1.0, -1.0])
# From a dome with its pole along +y to one along +z: directions along +z turn to -y.
_POLE_UP = np.array([(1.0, 0, 0), (0, 0, -1), (0, 1, 0)])
_RECT, _SPHERE, _DISK, _CYLINDER = "RectLight", "SphereLight", "DiskLight", "CylinderLight"


class Lit(NamedTuple):
    """A light, an emissive shape, or an environment."""

    kind: str
    thing: Any


def is_light(prim: Any) -> bool:
    """Return whether a prim is a light, and no emissive shape."""
    from pxr import UsdGeom, UsdLux

    return bool(UsdLux.LightAPI(prim)) and not prim.IsA(UsdGeom.Gprim)


def light(prim: Any, reading: Reading) -> Lit | None:
    """Return a light; None if it is left out, which is noted."""
    kind = str(prim.GetTypeName())
    matrix = reading.matrix(prim)
    source = Source(prim, reading)
    if kind == "DistantLight":
        return Lit("light", DirectionalLight(-matrix[:3, 2], source.shine * _irradiance(source)))
    if kind in ("DomeLight", "DomeLight_1"):
        return Lit("around", _dome(source, matrix))
    shape = _shape(kind, source, matrix)
    if shape is None:
        return None
    if kind == _SPHERE and (shape.radius == 0 or reading.value(prim.GetAttribute("treatAsPoint"), False)):
        return Lit("light", _point(source, matrix, shape))
    source.tell_cone()
    area = 1.0
    if source.normalized:
        area = mesh_area(shape) if isinstance(shape, Mesh) else shape.area
    return Lit("shape", shining(shape, source.shine / area))


class Source:
    """The attributes that all lights have.

    Parameters
    ----------
    prim : Usd.Prim
        The light.
    reading : Reading
        The stage.

    Attributes
    ----------
    shine : (3,) array
        Intensity times color times the camera's exposure: a radiance, or a power of its unit where it is
        normalized.
    normalized : bool
        True if the size of the light does not change its power.
    """

    def __init__(self, prim: Any, reading: Reading) -> None:
        from pxr import UsdLux

        self.prim, self.reading = prim, reading
        api = UsdLux.LightAPI(prim)
        color = np.array(reading.value(api.GetColorAttr()), np.float64)
        if reading.value(api.GetEnableColorTemperatureAttr()):
            kelvin = float(reading.value(api.GetColorTemperatureAttr()))
            color = color * np.array(UsdLux.BlackbodyTemperatureAsRgb(kelvin), np.float64)
        strength = float(reading.value(api.GetIntensityAttr())) * 2.0 ** float(
            reading.value(api.GetExposureAttr())
        )
        self.shine = color * strength * reading.exposure
        self.normalized = bool(reading.value(api.GetNormalizeAttr()))
        self._cone = UsdLux.ShapingAPI(prim).GetShapingConeAngleAttr()
        self._tell(api)

    def number(self, name: str, default: float) -> float:
        """Return an input of the light."""
        return float(self.reading.value(self.prim.GetAttribute(f"inputs:{name}"), default))

    def text(self, name: str) -> Any:
        """Return an input of the light that is not a number; None if it has none."""
        return self.reading.value(self.prim.GetAttribute(f"inputs:{name}"))

    @property
    def cone(self) -> float | None:
        """Half the angle of its cone in degrees; None if it shines to all sides."""
        return float(self.reading.value(self._cone)) if self._cone.HasAuthoredValue() else None

    def tell_cone(self) -> None:
        """Note that a cone is left out."""
        if self.cone is not None:
            self.reading.notes.tell("the cones of lights are left out")

    def _tell(self, api: Any) -> None:
        tell = self.reading.notes.tell
        for linked, what in (
            (api.GetLightLinkCollectionAPI(), "lights"),
            (api.GetShadowLinkCollectionAPI(), "shadows"),
        ):
            if not self.reading.value(linked.GetIncludeRootAttr(), True) or any(
                relation.GetTargets() for relation in (linked.GetIncludesRel(), linked.GetExcludesRel())
            ):
                tell(f"links of {what} are left out: each light shines on everything")
        if api.GetFiltersRel().GetTargets():
            tell("the filters of lights are left out")
        if any(self.number(name, 1.0) != 1 for name in ("diffuse", "specular")):
            tell("the diffuse and specular multipliers of lights are left out")
        if self.reading.value(self.prim.GetAttribute("inputs:shadow:enable"), True) is False:
            tell("lights without shadows cast shadows here")
        if self.number("shaping:focus", 0.0) or self.text("shaping:ies:file"):
            tell("the focus and the IES profiles of lights are left out")


def _irradiance(source: Source) -> float:
    """Return the irradiance of a distant light across its direction, for an intensity of 1."""
    angle = source.number("angle", 0.53)
    if source.prim.GetAttribute("inputs:angle").HasAuthoredValue() and angle > 0:
        source.reading.notes.tell("the angle of DistantLights is left out of their shadows, which are sharp")
    if source.normalized or angle == 0:
        return 1.0
    return math.pi * math.sin(math.radians(0.5 * angle)) ** 2


def _point(source: Source, matrix: Matrix, ball: Any) -> PointLight | SpotLight:
    """Return a sphere from afar: its radiance times the area that is seen of it, a quarter of its own."""
    power = 1.0
    if ball.radius > 0 and not source.normalized:
        power = ball.area
    elif not source.normalized:
        source.reading.notes.tell("SphereLights without a radius are taken as normalized")
    intensity, place, angle = 0.25 * power * source.shine, matrix[:3, 3], source.cone
    if angle is None or angle >= 180:
        return PointLight(place, intensity)
    soft = min(max(source.number("shaping:cone:softness", 0.0), 0.0), 1.0) * angle
    return SpotLight(place, place - matrix[:3, 2], intensity, angle, soft, "smooth")


def _shape(kind: str, source: Source, matrix: Matrix) -> Any:
    """Return the shape of a light; None if there is none."""
    look: dict[str, Any] = {"material": Diffuse(0.0)}
    if kind == _SPHERE:
        radius = source.number("radius", 0.5)
        return _Dot() if radius == 0 else Sphere(radius=radius, transform=matrix, **look)
    if kind == _DISK:
        return Disk((0, 0, 0), (0, 0, -1), source.number("radius", 0.5), transform=matrix, **look)
    if kind == _CYLINDER:
        length = source.number("length", 1.0)
        ends = (-0.5 * length, 0, 0), (0.5 * length, 0, 0)
        return Cylinder(*ends, source.number("radius", 0.5), capped=False, transform=matrix, **look)
    if kind == _RECT:
        if source.text("texture:file"):
            source.reading.notes.tell("the pictures of RectLights are left out")
        x, y = 0.5 * source.number("width", 1.0), 0.5 * source.number("height", 1.0)
        # The light emits along -z.
        corners = [(-x, -y, 0), (-x, y, 0), (x, y, 0), (x, -y, 0)]
        return Mesh(corners, [(0, 1, 2), (0, 2, 3)], **look).transformed(matrix)
    source.reading.notes.tell(f"lights of type {kind} are left out")
    return None


class _Dot(NamedTuple):
    """A sphere without a size."""

    radius: float = 0.0


def shining(shape: Any, emission: Any, **changes: Any) -> Any:
    """Return a shape that gives off light."""
    values = {name: getattr(shape, name) for name in shape.__dataclass_fields__}
    return type(shape)(**{**values, "emission": emission, **changes})


def mesh_area(mesh: Mesh) -> float:
    """Return the area of a mesh."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def _dome(source: Source, matrix: Matrix) -> ConstantEnvironment | EnvironmentMap:
    given = source.text("texture:file")
    if not given:
        return ConstantEnvironment(source.shine)
    kind = source.text("texture:format")
    if kind not in (None, "automatic", "latlong"):
        raise ValueError(f"{source.prim.GetPath()} must have a picture of format latlong, got {kind!r}")
    image = source.reading.pictures.read(given, linear=True) * source.shine
    linear = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    if _pole(source.prim) == "Z":
        linear = linear @ _POLE_UP
    return EnvironmentMap(image, linear @ _HALF_TURN)


def _pole(prim: Any) -> str:
    """Return the axis of a dome's pole: y, unless it is of the kind that says so."""
    from pxr import UsdGeom

    given = prim.GetAttribute("poleAxis")
    axis = str(given.Get()) if given else "Y"
    return str(UsdGeom.GetStageUpAxis(prim.GetStage())) if axis == "scene" else axis
