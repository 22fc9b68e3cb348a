"""Reports that set error against time: what the library's parts cost, and how wrong they are."""

from .table import Chart, Column, Table
from .triangle_kernels import KernelReport, KernelRow, kernels

__all__ = ["Chart", "Column", "KernelReport", "KernelRow", "Table", "kernels"]
