"""wgpu, imported with a check that it has everything that the kernels call.

wgpu is below version 1, and each release may rename things. The extra ``raywright[gpu]`` allows a range of
versions; if a release lacks something, an error names it before a device is opened.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

#: The first and the last release that the tests of this folder pass with.
TESTED = ("0.19.3", "0.32.0")
#: What is called, by the object that has it.
CALLED = {
    "gpu": ("enumerate_adapters_sync", "request_adapter_sync"),
    "GPUAdapter": ("info", "limits", "request_device_sync"),
    "GPUDevice": (
        "create_bind_group",
        "create_buffer",
        "create_buffer_with_data",
        "create_command_encoder",
        "create_compute_pipeline",
        "create_shader_module",
        "destroy",
        "limits",
        "queue",
    ),
    "GPUBuffer": ("destroy", "size"),
    "GPUQueue": ("read_buffer", "submit", "write_buffer"),
    "GPUCommandEncoder": ("begin_compute_pass", "clear_buffer", "finish"),
    "GPUComputePassEncoder": (
        "dispatch_workgroups",
        "dispatch_workgroups_indirect",
        "end",
        "set_bind_group",
        "set_pipeline",
    ),
    "GPUComputePipeline": ("get_bind_group_layout",),
    "BufferUsage": ("COPY_DST", "COPY_SRC", "INDIRECT", "STORAGE", "UNIFORM"),
}
_MISSING = "raywright.Gpu needs wgpu, which is not installed: pip install 'raywright[gpu]'"


def imported_wgpu() -> Any:
    """Return the module wgpu.

    Raises
    ------
    ImportError
        If it is not installed, cannot be loaded, or lacks something that is called.
    """
    try:
        wgpu = importlib.import_module("wgpu")
    except Exception as error:
        if isinstance(error, ModuleNotFoundError) and error.name == "wgpu":
            raise ImportError(_MISSING) from error
        raise ImportError(f"wgpu is installed but cannot be loaded: {error}") from error
    lacking = [
        f"{owner}.{name}"
        for owner, names in CALLED.items()
        for name in names
        if not hasattr(getattr(wgpu, owner, None), name)
    ]
    if lacking:
        raise ImportError(_unfit(wgpu, f"lacks {', '.join(lacking)}"))
    return wgpu


@contextmanager
def changes_named() -> Iterator[None]:
    """Turn errors of a first use, which arise from a changed signature or key, into an ImportError."""
    try:
        yield
    except (AttributeError, KeyError, TypeError) as error:
        told = f"{type(error).__name__}: {error}"
        raise ImportError(_unfit(importlib.import_module("wgpu"), f"fails when called ({told})")) from error


def _unfit(wgpu: Any, trouble: str) -> str:
    version = getattr(wgpu, "__version__", "of unknown version")
    first, last = TESTED
    return (
        f"wgpu {version} {trouble}; raywright is tested with wgpu {first} to {last}: "
        f"pip install 'wgpu>={first},<={last}'"
    )
