"""Auxiliary buffers (AOVs): geometry, albedo and coverage of the first hit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import SeedLike, frozen, integer, seed_number, thread_limit
from ..cameras import AnyCamera
from ..integrators import Path
from ..scene.scene import Scene
from .filters import BoxFilter
from .job import Job
from .samplers import Independent

_SEEN = (
    "depth",
    "position",
    "normal",
    "shading_normal",
    "uv",
    "shape_id",
    "primitive_id",
    "albedo",
    "motion",
    "screen_motion",
)
_COVER = ("alpha", "cryptomatte")
AOVS = _SEEN + _COVER
# Shapes recorded per pixel: six, as in Cryptomatte's files.
RANKS = 6


def names_of(aov: str | Iterable[str]) -> tuple[str, ...]:
    """Return the names of pictures that are asked for, each once.

    Raises
    ------
    ValueError
        If one is not known.
    TypeError
        If they are not names.
    """
    if not isinstance(aov, Iterable):
        raise TypeError(f"aov must be names, got {aov!r}")
    names = (aov,) if isinstance(aov, str) else tuple(aov)
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"aov must be names, got {name!r}")
        if name not in AOVS:
            raise ValueError(f"aov {name!r} is unknown, expected some of {', '.join(AOVS)}")
    return tuple(dict.fromkeys(names))


def aovs(
    scene: Scene,
    camera: AnyCamera,
    aov: str | Iterable[str] = AOVS,
    samples: int = 16,
    *,
    seed: SeedLike = 0,
    threads: int | None = None,
) -> dict[str, NDArray[Any]]:
    """Return auxiliary buffers (AOVs) of the first hits, by name.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : camera
        Camera of the picture.
    aov : str or some of them
        Names of buffers: ``"depth"`` (distance along the ray; infinite for the background), ``"position"``,
        ``"normal"`` (unit geometric normal, as the winding gives it), ``"shading_normal"``, ``"uv"``,
        ``"shape_id"`` and ``"primitive_id"`` (-1 for the background), ``"albedo"``, ``"motion"``
        (displacement of the point while the shutter is open, in the scene's space), ``"screen_motion"``
        (displacement in the picture, in pixels to the right and down), ``"alpha"`` (covered share of the
        pixel; masks cover by their opacity, glass covers everything behind it), ``"cryptomatte"`` (the six
        shapes that cover most of the pixel, the largest first, each with its index, -1 for none, and its
        share of the pixel). All of them if not given.
    samples : int
        Samples per pixel, over its square, the lens and the shutter: a value is the mean of the samples that
        hit something. Indices of shapes and primitives are those at the pixel's center.
    seed : int, Generator or SeedSequence
        Seed of the random numbers.
    threads : int, optional
        Number of threads; all cores if not given.

    Returns
    -------
    dict of str to array
        (H, W), (H, W, 2 or 3) or (H, W, 6, 2) float32, and int32 for single indices; read-only, row 0 the
        top.

    Raises
    ------
    ValueError
        If a name is not known, or a number out of its range.
    TypeError
        If an argument has the wrong type.

    See Also
    --------
    Scene.first_hits : The hits of one ray per pixel.
    render : Takes `aov` too.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere())
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=5, height=3)
    >>> found = rw.aovs(scene, camera, ["alpha", "shape_id"], samples=4)
    >>> found["alpha"][1].round(2).tolist(), found["shape_id"][1].tolist()
    ([0.0, 0.25, 1.0, 0.25, 0.0], [-1, -1, 0, -1, -1])
    """
    if not isinstance(scene, Scene):
        raise TypeError(f"scene must be a raywright.Scene, got {type(scene).__name__}")
    if not isinstance(camera, AnyCamera):
        raise TypeError(f"camera must be a raywright.Camera, got {type(camera).__name__}")
    names = names_of(aov)
    samples = integer("samples", samples, 1, 2**32 - 1)
    seed = seed_number(seed)
    threads = thread_limit(threads)
    found = seen(scene, camera, names, samples, seed, threads)
    if any(name in _COVER for name in names):
        job = Job(scene, camera, Path(), seed, False, None, Independent(), BoxFilter())
        found |= covers(_core.Rendering(job.core, threads, 1), job, names, samples, threads)
    return {name: found[name] for name in names}


def seen(
    scene: Scene, camera: AnyCamera, names: tuple[str, ...], samples: int, seed: int, threads: int | None
) -> dict[str, NDArray[Any]]:
    """Return the names of buffers that show the first hit."""
    mine = [name for name in names if name in _SEEN]
    if not mine:
        return {}
    arrays = _core.aovs(scene._compiled(), camera, mine, samples, seed, threads)
    ids = ("shape_id", "primitive_id")
    return {
        name: frozen(array.astype(np.int32 if name in ids else np.float32))
        for name, array in zip(mine, arrays, strict=True)
    }


def covers(
    rendering: _core.Rendering, job: Job, names: tuple[str, ...], samples: int | None, threads: int | None
) -> dict[str, NDArray[Any]]:
    """Return the buffers of coverage: by a render's own samples and its filter.

    With `samples`, each pixel takes that number of samples instead.
    """
    if not any(name in _COVER for name in names):
        return {}
    alpha, shapes, shares = rendering.cover(job.core, job.compiled(), RANKS, samples, threads)
    every = {"alpha": alpha, "cryptomatte": np.stack([shapes.astype(np.float32), shares], axis=-1)}
    return {name: frozen(every[name]) for name in names if name in _COVER}
