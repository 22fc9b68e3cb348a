"""Lights and environments."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read_linear
from ...lights import (
    ConstantEnvironment,
    DirectionalLight,
    Environment,
    EnvironmentMap,
    Light,
    PointLight,
    ProjectorLight,
    SpotLight,
)
from .parameters import Floats, Parameters
from .spectra import color
from .textures import Textures


def light(
    kind: str, parameters: Parameters, matrix: Floats, textures: Textures, imaging: Floats
) -> Light | Environment:
    """Return a light, or an environment.

    Parameters
    ----------
    kind : str
        Its type.
    parameters : Parameters
        Its parameters.
    matrix : (4, 4) array
        To the world.
    textures : Textures
        Folder of files.
    imaging : (3, 3) array
        Matrix from radiance to the film's pixels.

    Raises
    ------
    ValueError
        If its type, or a parameter of it, is not supported; the error names it.
    """
    scale = parameters.number("scale", 1.0)

    def at(name: str, default: tuple[float, float, float]) -> Floats:
        return matrix[:3, :3] @ parameters.vector(name, default) + matrix[:3, 3]

    made: Light | Environment
    if kind == "point":
        scale *= _total(parameters, "power", 4 * math.pi)
        made = PointLight(at("from", (0, 0, 0)), _shine(parameters, "I", scale, imaging))
    elif kind == "spot":
        angle, delta = parameters.number("coneangle", 30.0), parameters.number("conedeltaangle", 5.0)
        place, target = at("from", (0, 0, 0)), at("to", (0, 0, 1))
        delta = min(delta, angle)
        inner, outer = (math.cos(math.radians(one)) for one in (angle - delta, angle))
        # Half of the solid angle between the cones counts.
        scale *= _total(parameters, "power", 2 * math.pi * (1 - 0.5 * (inner + outer)))
        shine = _shine(parameters, "I", scale, imaging)
        made = SpotLight(place, target, shine, angle, delta, "smooth")
    elif kind == "distant":
        way = at("to", (0, 0, 1)) - at("from", (0, 0, 0))
        scale *= _total(parameters, "illuminance", 1.0)
        made = DirectionalLight(way, _shine(parameters, "L", scale, imaging))
    elif kind == "projection":
        made = _projection(parameters, matrix, textures, scale * imaging)
    elif kind == "infinite":
        made = _around(parameters, matrix, textures, scale * imaging)
    else:
        parameters.fail(f"a light {kind!r} is not supported")
    parameters.done()
    return made


def _total(parameters: Parameters, name: str, of_one: float) -> float:
    """Return the factor by which a light has a power, or an illuminance; 1 if the light names none.

    Values not above 0 count as not given, in pbrt too.
    """
    total = parameters.number(name, -1.0)
    return total / of_one if total > 0 else 1.0


def _shine(parameters: Parameters, name: str, scale: float, imaging: Floats) -> tuple[float, float, float]:
    red, green, blue = (
        float(x) for x in imaged(color(parameters, name, 1.0, emits=True), scale * imaging, parameters)
    )
    return red, green, blue


def imaged(radiance: Any, imaging: Floats, parameters: Parameters) -> NDArray[Any]:
    """Return light of any color, (..., 3), as a film gets it. Negative light stays as it is."""
    given = np.asarray(radiance)
    factor, matrix = _factored(imaging)
    if matrix is None:
        return given if factor == 1 else (given * factor).astype(given.dtype)
    balanced = given @ matrix.T
    if balanced[given >= 0].min(initial=0.0) < 0:
        parameters.notes.tell("whitebalance moves some light out of the RGB gamut, where it is clipped")
    return np.where(given < 0, given, np.maximum(balanced, 0.0)).astype(given.dtype)


def _factored(imaging: Floats) -> tuple[float, Floats | None]:
    """Return a matrix as a factor if it is no more than one, or else as a factor of 1 and the matrix."""
    factor = float(imaging[0, 0])
    return (factor, None) if np.array_equal(imaging, factor * np.eye(3)) else (1.0, imaging)


def _projection(
    parameters: Parameters, matrix: Floats, textures: Textures, imaging: Floats
) -> ProjectorLight:
    image = read_linear(textures.folder / parameters.text("filename"))
    fov = parameters.number("fov", 90.0)
    height, width = image.shape[:2]
    # The field of view is that of the shorter side.
    tall = math.tan(math.radians(0.5 * fov)) * max(1.0, height / width)
    place, ahead, up = matrix[:3, 3], matrix[:3, 2], matrix[:3, 1]
    # Oriented like the picture of a camera there: a mirroring transform mirrors the picture.
    if np.linalg.det(matrix[:3, :3]) > 0:
        image = image[:, ::-1]
    # In pbrt the picture is the intensity, without the inverse cube of the cosine.
    rows, columns = image.shape[:2]
    y = (1 - 2 * (np.arange(rows) + 0.5) / rows) * tall
    x = (1 - 2 * (np.arange(columns) + 0.5) / columns) * tall * width / height
    cosine = 1 / np.sqrt(1 + x[None, :] ** 2 + y[:, None] ** 2)
    angle = 2 * math.degrees(math.atan(tall))
    factor, balance = _factored(imaging)
    if balance is not None:
        image = imaged(image, balance, parameters)
    return ProjectorLight(image * cosine[..., None] ** 3, place, place + ahead, up, angle, factor)


def _around(parameters: Parameters, matrix: Floats, textures: Textures, imaging: Floats) -> Environment:
    if parameters.has("portal"):
        parameters.fail("portal is not supported")
    if not parameters.has("filename"):
        return ConstantEnvironment(
            _shine(parameters, "L", _total(parameters, "illuminance", math.pi), imaging)
        )
    if parameters.has("illuminance"):
        parameters.fail("illuminance is not supported for a picture")
    image = read_linear(textures.folder / parameters.text("filename"))
    if image.shape[0] != image.shape[1]:
        parameters.fail(f"its picture must be square, got {image.shape[1]} x {image.shape[0]}")
    linear = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    factor, balance = _factored(imaging)
    if balance is not None:
        image = imaged(image, balance, parameters)
    return EnvironmentMap(unfolded(image), linear, factor)


def unfolded(image: NDArray[Any]) -> NDArray[Any]:
    """Return a square picture of all directions as an equirectangular one, of as many rows.

    A square has the same area to each solid angle (Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere
    using SIMD", 2008). The middle of the result is seen along -z, its top at +y, and its right towards +x.
    """
    side = len(image)
    rows, columns = side, 2 * side
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    turn = 2 * np.pi * (np.arange(columns) + 0.5) / columns - np.pi
    y = np.cos(polar)[:, None] * np.ones(columns)
    x = np.sin(polar)[:, None] * np.sin(turn)
    z = -np.sin(polar)[:, None] * np.cos(turn)
    u, v = folded(x, y, z)
    # Both maps have about the same density, so that the nearest pixel is as good as interpolation.
    column = np.minimum((u * side).astype(np.int64), side - 1)
    row = np.minimum((v * side).astype(np.int64), side - 1)
    return np.asarray(image[row, column])


def folded(x: Floats, y: Floats, z: Floats) -> tuple[Floats, Floats]:
    """Return where unit directions are in a square of equal areas, as u and v from 0 to 1."""
    across, along = np.abs(x), np.abs(y)
    radius = np.sqrt(np.maximum(1 - np.abs(z), 0.0))
    most, least = np.maximum(across, along), np.minimum(across, along)
    share = np.divide(least, most, out=np.zeros_like(most), where=most > 0)
    phi = np.arctan(share) * 2 / np.pi
    phi = np.where(across < along, 1 - phi, phi)
    v = phi * radius
    u = radius - v
    u, v = np.where(z < 0, 1 - v, u), np.where(z < 0, 1 - u, v)
    return 0.5 * (np.copysign(u, x) + 1), 0.5 * (np.copysign(v, y) + 1)
