"""Rays on graphics processors, with the CPU's answers to the bit.

Needs the extra ``raywright[gpu]``, PyPI's ``wgpu``. A kernel in float32 finds what each ray may hit, with a
certain bound on every error, and the core decides among that, exactly.
"""

from .device import Gpu
from .held import GpuScene
from .stats import GpuStats

__all__ = ["Gpu", "GpuScene", "GpuStats"]
