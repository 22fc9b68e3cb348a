"""From a scene and a camera to a picture."""

import numpy as np

from . import _core
from .arrays import integer, positive
from .cameras import AnyCamera
from .image import HISTORY, ErrorEstimate, Image
from .integrators import AnyIntegrator, Path, check_integrator
from .progress import bar
from .scene import Scene

_PATH = Path()
_DEFAULT_SAMPLES = 64


def render(
    scene: Scene,
    camera: AnyCamera,
    integrator: AnyIntegrator = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    seed: int = 0,
    threads: int | None = None,
    progress: bool = True,
) -> Image:
    """Render a picture, until the first of the limits that are given is met.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : Camera or another kind
        From where.
    integrator : Path or another kind
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
        ("camera", camera, AnyCamera),
    ):
        if not isinstance(value, kind):
            told = kind.__name__.removeprefix("Any")
            raise TypeError(f"{name} must be a raywright.{told}, got {type(value).__name__}")
    check_integrator("integrator", integrator)
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
            done = _core.render(compiled, camera, integrator, *limits, seed, threads, report)
    else:
        done = _core.render(compiled, camera, integrator, *limits, seed, threads, None)
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
