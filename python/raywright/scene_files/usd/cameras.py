"""Cameras of a USD stage."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cameras import AnyCamera, Camera, Orthographic, ThinLens
from .reading import Reading

_HEIGHT = 480


def camera(prim: Any, reading: Reading) -> AnyCamera:
    """Return a camera as a prim has it; its picture is 480 points high."""
    from pxr import UsdGeom

    seen = UsdGeom.Camera(prim).GetCamera(reading.time)
    matrix = reading.matrix(prim)
    across, high = float(seen.horizontalAperture), float(seen.verticalAperture)
    if not (across > 0 and high > 0):
        raise ValueError(f"{prim.GetPath()} must have apertures above 0, got {across:g} and {high:g}")
    if len(seen.clippingPlanes):
        reading.notes.tell("the clipping planes of cameras are left out")
    width = max(round(_HEIGHT * across / high), 1)
    # The camera looks along its -z, with y up.
    place, ahead, up = matrix[:3, 3], -matrix[:3, 2], matrix[:3, 1]
    offset = np.array((seen.horizontalApertureOffset, seen.verticalApertureOffset), np.float64)
    common: dict[str, Any] = {"direction": ahead, "up": up, "width": width, "height": _HEIGHT}
    if seen.projection.name == "Orthographic":
        # Apertures are in tenths of the scene's unit.
        moved = place + 0.1 * (offset[0] * matrix[:3, 0] + offset[1] * matrix[:3, 1])
        return Orthographic(moved, scale=0.1 * high * _length(matrix[:3, 1]), **common)
    length = float(seen.focalLength)
    if not length > 0:
        raise ValueError(f"{prim.GetPath()} must have a focalLength above 0, got {length:g}")
    fov = 2 * math.degrees(math.atan(high / (2 * length)))
    # A shifted film moves the principal point off the middle.
    middle = None
    if offset.any():
        middle = width * (0.5 - offset[0] / across), _HEIGHT * (0.5 + offset[1] / high)
    stop, distance = float(seen.fStop), float(seen.focusDistance)
    if stop > 0 and distance > 0:
        radius = 0.05 * length / stop
        return ThinLens(
            place, fov=fov, aperture_radius=radius, focus_distance=distance, principal_point=middle, **common
        )
    return Camera(place, fov=fov, principal_point=middle, **common)


def exposure(prim: Any, reading: Reading) -> float:
    """Return the exposure factor of a camera."""
    from pxr import UsdGeom

    seen = UsdGeom.Camera(prim)
    if hasattr(seen, "ComputeLinearExposureScale"):
        factor = float(seen.ComputeLinearExposureScale(reading.time))
    else:
        # For usd-core before 25.5.
        factor = 2.0 ** float(reading.value(seen.GetExposureAttr(), 0.0))
    if not 0 < factor < math.inf:
        raise ValueError(f"{prim.GetPath()} must have an exposure above 0, got a factor of {factor:g}")
    return factor


def _length(vector: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(vector))
