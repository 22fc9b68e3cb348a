"""From a scene and a camera to a picture."""

import numpy as np

from . import _core
from .arrays import integer, positive
from .cameras import AnyCamera
from .filters import BoxFilter, Filter
from .image import HISTORY, ErrorEstimate, Image
from .integrators import AnyIntegrator, Path, check_integrator
from .progress import Report, bar
from .samplers import Independent, Sampler
from .scene import Scene

_PATH = Path()
_SAMPLER: Sampler = Independent()
_FILTER: Filter = BoxFilter()
_DEFAULT_SAMPLES = 64


def render(
    scene: Scene,
    camera: AnyCamera,
    integrator: AnyIntegrator = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    *,
    seed: int = 0,
    threads: int | None = None,
    progress: bool = True,
    adaptive: bool = False,
    clamp: float | None = None,
    sampler: Sampler = _SAMPLER,
    filter: Filter = _FILTER,
) -> Image:
    """Render a picture, until the first of the limits that are given is met.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : Camera or another kind
        From where.
    integrator : Path or another kind
        What turns rays into radiance; an `Integrator` may be written in Python.
    samples : int, optional
        Limit on samples per pixel; 64 if no limit at all is given.
    error : float, optional
        Limit on the relMSE of the picture (see `ErrorEstimate`): the whole 95 % interval of its estimate is
        at or below. At least 16 samples a pixel are taken, as what was never seen is in no estimate.
    seconds : float, optional
        Limit on run time in seconds, to the nearest sample of all pixels.
    seed : int
        Picks the random numbers, 0 to 2**64 - 1. The same seed and samples give the same picture, bit for
        bit, for any number of threads.
    threads : int, optional
        How many to use; all cores if not given.
    progress : bool
        Whether to show a bar on stderr.
    adaptive : bool
        Whether more samples go to the pixels where more of the estimated relMSE is; `samples` is then their
        mean, and ``image.aov["samples"]`` tells how many each pixel has. It begins after 16 samples. No pixel
        is biased by it: each has two halves, and what is seen in one decides how many samples the other gets.
    clamp : float, optional
        Radiance, in the largest channel, to which brighter samples are dimmed. It takes fireflies away, and
        light with them: the picture is biased, and says so. If not given, samples count as they are.
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
        ("camera", camera, AnyCamera),
    ):
        if not isinstance(value, kind):
            told = kind.__name__.removeprefix("Any")
            raise TypeError(f"{name} must be a raywright.{told}, got {type(value).__name__}")
    check_integrator("integrator", integrator)
    if not isinstance(adaptive, bool):
        raise TypeError(f"adaptive must be True or False, got {adaptive!r}")
    if not isinstance(sampler, Sampler):
        raise TypeError(f"sampler must be one of raywright's, got {type(sampler).__name__}")
    if not isinstance(filter, Filter):
        raise TypeError(f"filter must be one of raywright's, got {type(filter).__name__}")
    samples = None if samples is None else integer("samples", samples, 1, 2**32 - 1)
    error = None if error is None else positive("error", error)
    seconds = None if seconds is None else positive("seconds", seconds)
    clamp = None if clamp is None else positive("clamp", clamp)
    if samples is None and error is None and seconds is None:
        samples = _DEFAULT_SAMPLES
    seed = integer("seed", seed, 0, 2**64 - 1)
    threads = None if threads is None else integer("threads", threads, 1)
    compiled = scene._compiled()
    limits = (samples, error, seconds)

    def run(report: Report | None) -> _core.Rendering:
        return _core.render(
            compiled,
            camera,
            integrator,
            scene,
            *limits,
            seed,
            threads,
            adaptive,
            clamp,
            report,
            sampler,
            filter,
        )

    if not progress:
        return _image(run(None), adaptive, clamp)
    with bar(*limits) as report:
        done = run(report)
    return _image(done, adaptive, clamp)


def _image(done: _core.Rendering, adaptive: bool, clamp: float | None) -> Image:
    history = np.empty(len(done.history), HISTORY)
    for i, name in enumerate(HISTORY.names or ()):
        history[name] = done.history[:, i]
    warnings = []
    if done.dropped:
        warnings.append(f"{_samples(done.dropped)} not finite or negative, and count as black")
    clamped, taken = done.clamped
    if clamped:
        warnings.append(
            f"biased: {_samples(clamped)} clamped to {clamp:g}, "
            f"which took {100 * taken:.2g} % of the radiance"
        )
    if done.carried is not None:
        few, share = done.carried
        carriers = "one sample carries" if few == 1 else f"{few} samples carry"
        warnings.append(f"{carriers} {100 * share:.0f} % of the error estimate: it cannot be trusted yet")
    return Image(
        done.rgb,
        done.standard_error,
        ErrorEstimate(*done.error, trusted=done.carried is None),
        history,
        done.seconds,
        done.samples,
        tuple(warnings),
        biased=clamped > 0,
        aov={"samples": done.counts} if adaptive else {},
    )


def _samples(count: int) -> str:
    return f"{count} sample{' was' if count == 1 else 's were'}"
