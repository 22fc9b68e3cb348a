"""EXR files of a picture and what is known of it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .pictures import NO_EXR


def write_exr(path: Path, rgb: NDArray[np.float32], standard_error: NDArray[np.float32]) -> None:
    """Write linear colours as channels R, G, B, and their standard error as channels standard_error.R, .G, .B.

    Raises
    ------
    ImportError
        If OpenEXR is not installed.
    """
    try:
        import OpenEXR
    except ImportError as error:
        raise ImportError(NO_EXR) from error

    channels = {}
    for i, name in enumerate("RGB"):
        channels[name] = np.ascontiguousarray(rgb[..., i], np.float32)
        channels[f"standard_error.{name}"] = np.ascontiguousarray(standard_error[..., i], np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    with OpenEXR.File(header, channels) as file:
        file.write(str(path))
