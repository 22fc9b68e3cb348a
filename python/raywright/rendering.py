"""From a scene and a camera to a picture."""

import os
import warnings as python_warnings
from concurrent.futures import Executor

import numpy as np

from . import _core
from .arrays import integer, positive
from .cameras import AnyCamera
from .checkpoints import Checkpoints
from .identity import digest
from .image import HISTORY, ErrorEstimate, Image
from .integrator import Integrator
from .integrators import Path
from .progress import Report, bar
from .scene import Scene

_PATH = Path()
_DEFAULT_SAMPLES = 64


def render(
    scene: Scene,
    camera: AnyCamera,
    integrator: Path | Integrator = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    *,
    seed: int = 0,
    threads: int | None = None,
    progress: bool = True,
    adaptive: bool = False,
    clamp: float | None = None,
    checkpoint: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
) -> Image:
    """Render a picture, until the first of the limits that are given is met.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : Camera or another kind
        From where.
    integrator : Path or Integrator
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
        How many to use; all cores if not given. With an executor, for each piece of its work; 1 if not given.
    progress : bool
        Whether to show a bar on stderr.
    adaptive : bool
        Whether more samples go to the pixels where more of the estimated relMSE is; `samples` is then their
        mean, and ``image.aov["samples"]`` tells how many each pixel has. It begins after 16 samples. No pixel
        is biased by it: each has two halves, and what is seen in one decides how many samples the other gets.
    clamp : float, optional
        Radiance, in the largest channel, to which brighter samples are dimmed. It takes fireflies away, and
        light with them: the picture is biased, and says so. If not given, samples count as they are.
    checkpoint : str or path, optional
        A file that is kept up to date with the render: every minute, at its end, and when it is interrupted.
        If there is such a file, the render goes on from it, with all limits counted from its first start, and
        ends with the same bits as one that was never interrupted, even by ``kill -9``. The file stays when
        the render is done, so that it can be taken further by other limits. That it cannot be written is told
        in ``image.warnings`` and as a RuntimeWarning, and costs nothing else.
    executor : concurrent.futures.Executor, optional
        Who does the work: a ``ProcessPoolExecutor``, ``client.get_executor()`` of `dask.distributed`, the
        pool of `mpi4py.futures`, or any other. The picture has the same bits as without. What is lost with a
        worker is done again; if the executor breaks, the rest is rendered here, and ``image.warnings`` says
        so. Scene, camera and integrator are pickled, and compiled once in each process.

    Returns
    -------
    Image
        With its standard error, error estimate and history.

    Raises
    ------
    TypeError
        If an argument is of the wrong kind, or cannot be pickled for the executor.
    ValueError
        If a number is out of its range; if `checkpoint` is damaged, or of another scene or other settings.
    OSError
        If `checkpoint` cannot be read, or its folder is missing.
    KeyboardInterrupt
        At once, when Ctrl-C is pressed; a checkpoint is written before.
    """
    for name, value, kinds in (
        ("scene", scene, (Scene,)),
        ("camera", camera, (AnyCamera,)),
        ("integrator", integrator, (Path, Integrator)),
    ):
        if not isinstance(value, kinds):
            told = kinds[-1].__name__.removeprefix("Any")
            raise TypeError(f"{name} must be a raywright.{told}, got {type(value).__name__}")
    if not isinstance(adaptive, bool):
        raise TypeError(f"adaptive must be True or False, got {adaptive!r}")
    samples = None if samples is None else integer("samples", samples, 1, 2**32 - 1)
    error = None if error is None else positive("error", error)
    seconds = None if seconds is None else positive("seconds", seconds)
    clamp = None if clamp is None else positive("clamp", clamp)
    if samples is None and error is None and seconds is None:
        samples = _DEFAULT_SAMPLES
    seed = integer("seed", seed, 0, 2**64 - 1)
    threads = None if threads is None else integer("threads", threads, 1)
    if executor is not None and not isinstance(executor, Executor):
        raise TypeError(f"executor must be a concurrent.futures.Executor, got {type(executor).__name__}")
    kept = None
    if checkpoint is not None:
        if not isinstance(checkpoint, str | os.PathLike):
            raise TypeError(f"checkpoint must be a path, got {type(checkpoint).__name__}")
        of = _identity(scene, camera, integrator, seed, adaptive, clamp)
        kept = Checkpoints(checkpoint, of)
    rendering = _begun(kept, camera, threads, adaptive, clamp)
    if executor is None:
        # Here, so that what there is to warn of is told to the caller.
        scene._compiled()
    limits = (samples, error, seconds)

    def run(report: Report | None) -> list[str]:
        told: list[str] = []
        try:
            if executor is not None:
                told += _elsewhere(
                    rendering, (scene, camera, integrator, seed), executor, limits, threads, report, kept
                )
            if executor is None or told:
                _here(rendering, (scene, camera, integrator, seed), limits, threads, report, kept)
        finally:
            # Nothing is kept of a render that could not begin.
            if kept is not None and rendering.aim:
                kept.write(rendering)
        return told + ([kept.trouble] if kept is not None and kept.trouble else [])

    if not progress:
        return _image(rendering, adaptive, clamp, run(None))
    with bar(*limits) as report:
        problems = run(report)
    return _image(rendering, adaptive, clamp, problems)


_Limits = tuple[int | None, float | None, float | None]
_Of = tuple[Scene, AnyCamera, Path | Integrator, int]


def _here(
    rendering: _core.Rendering,
    of: _Of,
    limits: _Limits,
    threads: int | None,
    report: Report | None,
    kept: Checkpoints | None,
) -> None:
    """Render in this process."""
    scene, camera, integrator, seed = of
    compiled = scene._compiled()
    how = (compiled, camera, integrator, scene, seed, threads, *limits)
    while not rendering.go_on(*how, None if kept is None else kept.wait(), report):
        if kept is not None:
            kept.write_beside(rendering)


def _elsewhere(
    rendering: _core.Rendering,
    of: _Of,
    executor: Executor,
    limits: _Limits,
    threads: int | None,
    report: Report | None,
    kept: Checkpoints | None,
) -> list[str]:
    """Render by an executor; if it breaks, return what there is to say of that."""
    # Who renders here does not wait for the import.
    from .distributed import BrokenError, Distribution
    from .worker import Job

    def rest() -> None:
        if kept is not None and kept.wait() == 0:
            kept.write_beside(rendering)

    distribution = Distribution(rendering, Job(*of), executor, limits, threads or 1)
    try:
        distribution.run(report, rest)
    except BrokenError as error:
        return [f"the executor broke, and the rest was rendered here: {error}"]
    finally:
        for message in distribution.told:
            python_warnings.warn(message, RuntimeWarning, stacklevel=4)
    return []


def _identity(
    scene: Scene,
    camera: AnyCamera,
    integrator: Path | Integrator,
    seed: int,
    adaptive: bool,
    clamp: float | None,
) -> dict[str, str | int | float | bool | None]:
    """Return all that the bits of a picture depend on, by names that users know."""
    return {
        "version": _core.VERSION,
        "width": camera.width,
        "height": camera.height,
        "scene": digest(scene),
        "camera": digest(camera),
        "integrator": digest(integrator),
        "seed": seed,
        "adaptive": adaptive,
        "clamp": clamp,
    }


def _begun(
    kept: Checkpoints | None, camera: AnyCamera, threads: int | None, adaptive: bool, clamp: float | None
) -> _core.Rendering:
    """Return an empty render, or that of a checkpoint."""
    film = None if kept is None else kept.read(_core.Rendering.most_bytes(camera, adaptive))
    if kept is None or film is None:
        return _core.Rendering(camera, threads, adaptive, clamp)
    try:
        return _core.Rendering.from_bytes(film, camera, threads, adaptive, clamp)
    except ValueError as error:
        kept.refuse(f"is damaged: {error}")


def _image(done: _core.Rendering, adaptive: bool, clamp: float | None, told: list[str]) -> Image:
    history = np.empty(len(done.history), HISTORY)
    for i, name in enumerate(HISTORY.names or ()):
        history[name] = done.history[:, i]
    warnings = list(told)
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
