"""What is seen first, and what covers a pixel, rather than how bright it is."""

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
    "primitive",
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
        If they are no names.
    """
    if not isinstance(aov, Iterable):
        raise TypeError(f"aov must be names, got {aov!r}")
    names = (aov,) if isinstance(aov, str) else tuple(aov)
    for name in names:
        if not isinstance(name, str):
            raise TypeError(f"aov must be names, got {name!r}")
        if name not in AOVS:
            raise ValueError(f"aov {name!r} is not known, expected some of {', '.join(AOVS)}")
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
    """Return pictures of what is seen first, by their names.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : camera
        From where.
    aov : str or some of them
        ``"depth"`` (distance along the ray; infinite where nothing is seen), ``"position"``, ``"normal"``
        (unit geometric normal, as the winding gives it), ``"shading_normal"``, ``"uv"``, ``"shape_id"`` and
        ``"primitive"`` (-1 where nothing is seen), ``"albedo"``, ``"motion"`` (how far the point goes while
        the shutter is open, in the scene's space), ``"screen_motion"`` (how far it goes in the picture, in
        pixels to the right and down), ``"alpha"`` (the share of the pixel that anything covers, masks by what
        of them is not open; glass covers what is behind it), ``"cryptomatte"`` (the six shapes that cover
        most of the pixel, the largest first, each as its number, -1 for none, and its share of the pixel).
        All of them if not given.
    samples : int
        Samples per pixel, over its square, the lens and the shutter: a pixel is the mean of those that see
        something. Numbers of shapes and primitives are those of its middle.
    seed : int, Generator or SeedSequence
        Picks the random numbers.
    threads : int, optional
        How many to use; all cores if not given.

    Returns
    -------
    dict of str to array
        (H, W), (H, W, 2 or 3) or (H, W, 6, 2) float32, and int32 for numbers of things alone; read-only, row
        0 the top.

    Raises
    ------
    ValueError
        If a name is not known, or a number out of its range.
    TypeError
        If an argument is of the wrong kind.
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
    """Return those of the pictures that tell of what is seen first."""
    mine = [name for name in names if name in _SEEN]
    if not mine:
        return {}
    arrays = _core.aovs(scene._compiled(), camera, mine, samples, seed, threads)
    ids = ("shape_id", "primitive")
    return {
        name: frozen(array.astype(np.int32 if name in ids else np.float32))
        for name, array in zip(mine, arrays, strict=True)
    }


def covers(
    rendering: _core.Rendering, job: Job, names: tuple[str, ...], samples: int | None, threads: int | None
) -> dict[str, NDArray[Any]]:
    """Return those of the pictures that tell of what covers pixels: by a render's own samples and its filter.

    With `samples`, it is by so many of each pixel instead.
    """
    if not any(name in _COVER for name in names):
        return {}
    alpha, shapes, shares = rendering.cover(job.core, job.compiled(), RANKS, samples, threads)
    every = {"alpha": alpha, "cryptomatte": np.stack([shapes.astype(np.float32), shares], axis=-1)}
    return {name: frozen(every[name]) for name in names if name in _COVER}
