"""Rays on graphics processors, with the CPU's answers to the bit.

Needs the extra ``raywright[gpu]``, PyPI's ``wgpu``. A kernel in float32 finds candidate hits of each ray,
with a certain bound on every error, and the core decides among them, exactly.
"""

from __future__ import annotations

from ..public_names import public_names
from .device import Gpu
from .scene_buffers import GpuScene
from .stats import GpuStats

__all__ = ["Gpu", "GpuScene", "GpuStats"]
__dir__ = public_names(__name__)
