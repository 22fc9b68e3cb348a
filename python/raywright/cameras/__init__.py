"""Where pictures are taken from, a kind of camera a file."""

from __future__ import annotations

from ..public_names import public_names
from .any_camera import AnyCamera
from .any_camera import pixel_offsets as pixel_offsets
from .fisheye import Fisheye
from .orthographic import Orthographic
from .panorama import Panorama
from .perspective import Camera
from .pose import Pose
from .thin_lens import ThinLens

__all__ = [
    "AnyCamera",
    "Camera",
    "Fisheye",
    "Orthographic",
    "Panorama",
    "Pose",
    "ThinLens",
]
__dir__ = public_names(__name__)
