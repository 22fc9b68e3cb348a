"""Choice of the device among those that wgpu offers."""

from __future__ import annotations

from typing import Any

from .wgpu_api import imported_wgpu

_FIT = ("Vulkan", "Metal", "D3D12")
_NONE = (
    "no Vulkan, Metal or D3D12 driver was found: install that of the graphics processor, "
    "or on Linux mesa-vulkan-drivers, which works in software"
)


def chosen(adapter: Any) -> Any:
    """Return wgpu's adapter of a name, or the one that it prefers.

    Raises
    ------
    ImportError
        If wgpu is not installed, or lacks a required function.
    RuntimeError
        If there is no driver that is fit.
    ValueError
        If no adapter has such a name.
    TypeError
        If `adapter` is anything else.
    """
    wgpu = imported_wgpu()
    if adapter is None:
        try:
            found = wgpu.gpu.request_adapter_sync(power_preference="high-performance")
        except RuntimeError:
            found = None
        # wgpu falls back to OpenGL, which guarantees no accuracy of arithmetic.
        if found is None or found.info["backend_type"] not in _FIT:
            raise RuntimeError(_NONE)
        return found
    if not isinstance(adapter, str):
        if isinstance(adapter, wgpu.GPUAdapter):
            if adapter.info["backend_type"] not in _FIT:
                raise RuntimeError(f"adapter is one of {adapter.info['backend_type']}: {_NONE}")
            return adapter
        raise TypeError(f"adapter must be a name or a wgpu.GPUAdapter, got {type(adapter).__name__}")
    every = [one for one in wgpu.gpu.enumerate_adapters_sync() if one.info["backend_type"] in _FIT]
    if not every:
        raise RuntimeError(_NONE)
    named = [one for one in every if adapter.lower() in name_of(one).lower()]
    if not named:
        raise ValueError(
            f"adapter is {adapter!r}, expected part of one of {sorted(set(map(name_of, every)))}"
        )
    return named[0]


def name_of(adapter: Any) -> str:
    """Return the name of an adapter."""
    return str(adapter.info["device"] or adapter.info["description"])
