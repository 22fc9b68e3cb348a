"""Memory that an engine holds for a mesh, measured from outside and so in the same way for all of them."""

import ctypes
import multiprocessing
import os
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np


def resident_bytes(engine, vertices, faces):
    """Return by how much a fresh process grows when an engine makes its scene; None where it cannot tell.

    `engine` is its class.
    """
    if not Path("/proc/self/statm").exists():
        return None
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as process:
        return process.submit(_growth, engine, vertices, faces).result()


def _growth(engine, vertices, faces):
    # A small scene first: libraries, threads and kernels count once, whatever the mesh.
    small, large = engine(), engine()
    small.build(np.eye(3, dtype=np.float32), np.array([[0, 1, 2]]))
    before = _resident()
    large.build(vertices, faces)
    return _resident() - before


def _resident():
    # Freed memory that malloc still holds would count otherwise.
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
