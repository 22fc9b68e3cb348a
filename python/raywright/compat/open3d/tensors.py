"""Tensors of Open3D as arrays, and back."""

from __future__ import annotations

import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray


def is_tensor(value: object) -> bool:
    """Return whether a value is an ``open3d.core.Tensor``."""
    core: Any = getattr(sys.modules.get("open3d"), "core", None)
    return core is not None and isinstance(value, core.Tensor)


def array_of(name: str, value: Any) -> Any:
    """Return a tensor of Open3D as an array without a copy, and any other value as it is.

    Raises
    ------
    ValueError
        If the tensor is not on the CPU.
    """
    if not is_tensor(value):
        return value
    device = str(value.device)
    if not device.startswith("CPU"):
        raise ValueError(f"{name} must be on the CPU, got a Tensor on {device}; pass its .cpu()")
    return value.numpy()


def tensor_of(array: NDArray[Any]) -> Any:
    """Return an array as a tensor of Open3D, which shares its memory where it can be written to."""
    core: Any = sys.modules["open3d"].core
    return core.Tensor.from_numpy(np.require(array, requirements=["C", "W"]))


def single(array: NDArray[Any]) -> NDArray[np.float32]:
    """Return numbers as float32; those that do not fit become infinite."""
    with np.errstate(over="ignore"):
        return array.astype(np.float32)


def ids(numbers: NDArray[np.int32]) -> NDArray[np.uint32]:
    """Return indices as uint32."""
    # -1 becomes INVALID_ID.
    return numbers.astype(np.uint32)
