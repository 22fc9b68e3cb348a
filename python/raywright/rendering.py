"""From a scene and a camera to a picture."""

import numpy as np

from . import _core
from .arrays import integer, positive
from .camera import Camera
from .filters import BoxFilter, Filter
from .image import HISTORY, ErrorEstimate, Image
from .integrators import Path
from .progress import bar
from .samplers import Independent, Sampler
from .scene import Scene

_PATH = Path()
_SAMPLER: Sampler = Independent()
_FILTER: Filter = BoxFilter()
_DEFAULT_SAMPLES = 64


def render(
    scene: Scene,
    camera: Camera,
    integrator: Path = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: bool = True,
    sampler: Sampler = _SAMPLER,
    filter: Filter = _FILTER,
) -> Image:
    """Render a picture, until the first of the limits that are given is met.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : Camera
        From where.
    integrator : Path
        What turns rays into radiance.
    samples : int, optional
        Limit on samples per pixel; 64 if no limit at all is given.
    error : float, optional
        Limit on the estimated relMSE of the picture (see `ErrorEstimate`).
    seconds : float, optional
        Limit on run time in seconds.
    seed : int
        Picks the random numbers, 0 to 2**64 - 1. The same seed and samples give the same picture, bit for
        bit, for any number of threads.
    threads : int, optional
        How many to use; all cores if not given.
    progress : bool
        Whether to show a bar on stderr.
    sampler : Independent, Stratified, Halton, Sobol or Lattice
        Where the random numbers come from. Samples are rounded up to whole batches.
    filter : BoxFilter, TriangleFilter, GaussianFilter, MitchellFilter, BlackmanHarrisFilter or LanczosFilter
        What part of the film a pixel is the mean of.

    Returns
    -------
    Image
        With its standard error, error estimate and history.

    Raises
    ------
    TypeError
        If an argument is of the wrong kind.
    ValueError
        If a number is out of its range.
    KeyboardInterrupt
        At once, when Ctrl-C is pressed.
    """
    for name, value, kind in (
        ("scene", scene, Scene),
        ("camera", camera, Camera),
        ("integrator", integrator, Path),
    ):
        if not isinstance(value, kind):
            raise TypeError(f"{name} must be a raywright.{kind.__name__}, got {type(value).__name__}")
    if not isinstance(sampler, Sampler):
        raise TypeError(f"sampler must be one of raywright's, got {type(sampler).__name__}")
    if not isinstance(filter, Filter):
        raise TypeError(f"filter must be one of raywright's, got {type(filter).__name__}")
    samples = None if samples is None else integer("samples", samples, 1, 2**32 - 1)
    error = None if error is None else positive("error", error)
    seconds = None if seconds is None else positive("seconds", seconds)
    if samples is None and error is None and seconds is None:
        samples = _DEFAULT_SAMPLES
    seed = integer("seed", seed, 0, 2**64 - 1)
    threads = None if threads is None else integer("threads", threads, 1)
    compiled = scene._compiled()
    limits = (samples, error, seconds)
    if progress:
        with bar(*limits) as report:
            done = _core.render(compiled, camera, integrator, *limits, seed, threads, report, sampler, filter)
    else:
        done = _core.render(compiled, camera, integrator, *limits, seed, threads, None, sampler, filter)
    return _image(done)


def _image(done: _core.Rendering) -> Image:
    history = np.empty(len(done.history), HISTORY)
    for i, name in enumerate(HISTORY.names or ()):
        history[name] = done.history[:, i]
    warnings: tuple[str, ...] = ()
    if done.dropped:
        count = f"{done.dropped} sample{' was' if done.dropped == 1 else 's were'}"
        warnings = (f"{count} not finite or negative, and count as black",)
    return Image(
        done.rgb,
        done.standard_error,
        ErrorEstimate(*done.error),
        history,
        done.seconds,
        done.samples,
        warnings,
    )
