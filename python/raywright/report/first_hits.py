"""The first hits of a picture by rays and by rasterizing, side by side."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from .. import _core
from ..arrays import integer, thread_limit
from ..cameras import AnyCamera
from ..scene.scene import Scene
from .table import Column, Table

_COLUMNS = (
    Column("way", "way"),
    Column("ms", "ms", ".2f"),
    Column("mrays", "Mrays/s", ".2f"),
    Column("speedup", "speed-up", ".2f"),
    Column("by_tree", "asked the tree", ".1%"),
    Column("wrong", "wrong", ",d"),
)


def first_hits(scene: Scene, camera: AnyCamera, threads: int | None = 1, repeats: int = 5) -> Table[Any]:
    """Time `Scene.intersect` and `Scene.first_hits` on the same picture.

    Both are timed in turns, and medians are returned. `intersect` is timed with given rays, and including the
    generation of rays, which rasterization also does. Rasterization pays with few faces per pixel and little
    occlusion. Otherwise rays are traced: for parts of the picture, or for all of it with more faces than a
    quarter of its pixels.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another kind
        Camera of the picture.
    threads : int, optional
        Number of threads; all cores if None.
    repeats : int
        Number of timings of each.

    Returns
    -------
    Table
        A row for each method: milliseconds, million rays a second, the speed-up over `intersect` with rays at
        hand, the share of pixels that the tree traced, and the number of pixels that differ from `intersect`
        (0, or there is a bug).

    Raises
    ------
    ValueError
        If `repeats` or `threads` is below 1, or something in the scene is not a mesh.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Scene.first_hits : Rasterization.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=20, around=6))
    >>> camera = rw.Camera((0, 0, 9), (0, 0, 0), width=32, height=32)
    >>> len(rw.report.first_hits(scene, camera, repeats=1).rows)
    3
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
    if not isinstance(camera, AnyCamera):
        raise TypeError(f"camera must be a Camera, got {type(camera).__name__}")
    repeats = integer("repeats", repeats, 1, 10_000)
    threads = thread_limit(threads)
    rays = camera.rays()
    wanted, found = scene.intersect(*rays, threads=threads), scene.first_hits(camera, threads=threads)
    core = scene._compiled()
    if core.curved:
        raise ValueError("only meshes can be rasterized, and the scene has other shapes")
    by_tree = _core.first_hits(core, camera, np.array((0.5, 0.5)), threads)[4]
    pixels = camera.width * camera.height
    differ = wanted.t.view(np.int64) != found.t.view(np.int64)
    differ |= (wanted.shape_id != found.shape_id) | (wanted.primitive_id != found.primitive_id)
    differ |= (wanted.uv.view(np.int64) != found.uv.view(np.int64)).any(axis=-1)
    ways: dict[str, Callable[[], object]] = {
        "rays at hand": lambda: scene.intersect(*rays, threads=threads),
        "rays made": lambda: scene.intersect(*camera.rays(), threads=threads),
        "rasterized": lambda: scene.first_hits(camera, threads=threads),
    }
    seconds: dict[str, list[float]] = {way: [] for way in ways}
    for _ in range(repeats):
        for way, ask in ways.items():
            began = time.perf_counter()
            ask()
            seconds[way].append(time.perf_counter() - began)
    medians = {way: statistics.median(of) for way, of in seconds.items()}
    rows = [
        (
            way,
            1e3 * median,
            1e-6 * pixels / median,
            medians["rays at hand"] / median,
            by_tree / pixels if way == "rasterized" else 1.0,
            int(np.count_nonzero(differ)) if way == "rasterized" else 0,
        )
        for way, median in medians.items()
    ]
    title = f"first hits of {camera.width} by {camera.height} pixels on {core.accelerator.primitives:,} faces"
    return Table(title, _COLUMNS, tuple(rows))
