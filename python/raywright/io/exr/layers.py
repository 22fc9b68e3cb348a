"""EXR files of a picture and its auxiliary buffers, in layers with the names of compositing programs."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import cryptomatte
from .writer import write_exr

# Channel names of each layer; one of unknown name has "X".
_CHANNELS = {
    "alpha": "A",
    "albedo": "RGB",
    "depth": "Z",
    "motion": "XYZ",
    "normal": "XYZ",
    "position": "XYZ",
    "screen_motion": "XY",
    "shading_normal": "XYZ",
    "standard_error": "RGB",
    "uv": "UV",
}


def write_layers(
    path: Path,
    rgb: NDArray[np.float32],
    standard_error: NDArray[np.float32],
    alpha: NDArray[np.float32] | None = None,
    aov: Mapping[str, NDArray[Any]] | None = None,
) -> None:
    """Write linear colors as R, G, B, those that are multiplied by an `alpha` with that as A, and layers."""
    channels = dict(zip("RGB", np.moveaxis(rgb, -1, 0), strict=True))
    attributes: dict[str, str] = {}
    if alpha is not None:
        channels["A"] = alpha
    for layer, array in {"standard_error": standard_error, **(aov or {})}.items():
        if layer == "cryptomatte":
            more, told = cryptomatte.layers(array)
            channels |= more
            attributes |= told
            continue
        deep = array if array.ndim == 3 else array[..., np.newaxis]
        for i, name in enumerate(_CHANNELS.get(layer, "X")):
            channels[f"{layer}.{name}"] = deep[..., i]
    write_exr(path, channels, attributes)
