"""Cameras of a USD stage."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...cameras import AnyCamera, Camera, Orthographic, ThinLens

_HEIGHT = 480


def camera(prim: Any, matrix: NDArray[np.float64], time: Any) -> AnyCamera:
    """Return a camera as a prim has it; its picture is 480 points high."""
    from pxr import UsdGeom

    seen = UsdGeom.Camera(prim).GetCamera(time)
    across, high = float(seen.horizontalAperture), float(seen.verticalAperture)
    if not (across > 0 and high > 0):
        raise ValueError(f"{prim.GetPath()} must have apertures above 0, got {across:g} and {high:g}")
    width = max(round(_HEIGHT * across / high), 1)
    # It looks along its -z, with y up.
    place, ahead, up = matrix[:3, 3], -matrix[:3, 2], matrix[:3, 1]
    common: dict[str, Any] = {"direction": ahead, "up": up, "width": width, "height": _HEIGHT}
    if seen.projection.name == "Orthographic":
        # Apertures are in tenths of the scene's unit.
        return Orthographic(place, scale=0.1 * high * float(np.linalg.norm(matrix[:3, 1])), **common)
    length = float(seen.focalLength)
    if not length > 0:
        raise ValueError(f"{prim.GetPath()} must have a focalLength above 0, got {length:g}")
    fov = 2 * math.degrees(math.atan(high / (2 * length)))
    stop, distance = float(seen.fStop), float(seen.focusDistance)
    if stop > 0 and distance > 0:
        return ThinLens(
            place, fov=fov, aperture_radius=0.05 * length / stop, focus_distance=distance, **common
        )
    shift = [float(seen.horizontalApertureOffset) / across, float(seen.verticalApertureOffset) / high]
    if shift == [0.0, 0.0]:
        return Camera(place, fov=fov, **common)
    focal = 0.5 * _HEIGHT / math.tan(math.radians(0.5 * fov))
    middle = width * (0.5 - shift[0]), _HEIGHT * (0.5 + shift[1])
    return Camera(place, focal=(focal, focal), principal=middle, **common)
