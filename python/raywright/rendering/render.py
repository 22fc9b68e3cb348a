"""From a scene and a camera to a picture."""

from __future__ import annotations

import os
import time
import warnings as python_warnings
from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from numpy.typing import NDArray

from .. import _core
from ..arrays import SeedLike, integer, positive, seed_number, thread_limit
from ..cameras import AnyCamera
from ..debug_log import debug
from ..integrators import AnyIntegrator, Path, ProgressivePhotonMap, check_integrator
from ..integrators.base import Integrator
from ..scene.scene import Scene
from .aovs import covers, names_of, seen
from .auto_options import StoppedError, followed
from .build_image import doubted, doubts, made, overall
from .choices import Limits, chosen, waves
from .denoising import check_method
from .filters import BoxFilter, Filter
from .halves import halves_of
from .image import Image
from .interrupts import ON_INTERRUPT, unless_terminated
from .job import Job
from .notebook import display
from .on_device import OnDevice, check_device
from .partial_image import AtRest, ImageSoFar, Sight
from .photon_bias import is_gathered, rate, with_bias
from .progress import Report, bar
from .samplers import Sampler, Unnamed
from .snapshots import Snapshots

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ..gpu import Gpu
    from .checkpoints import Checkpoints

_PATH = Path()
_FILTER: Filter = BoxFilter()
_DEFAULT_SAMPLES = 64
# Samples per pixel for first hits.
_AOV_SAMPLES = 16
BACKGROUNDS = ("shown", "transparent")


class Stop(Protocol):
    """A request to stop a render, such as a `threading.Event`."""

    def is_set(self) -> bool:
        """Return True if the render should stop."""


def render(
    scene: Scene,
    camera: AnyCamera,
    integrator: AnyIntegrator = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    *,
    seed: SeedLike = 0,
    threads: int | None = None,
    progress: bool | Callable[[Image], object] = True,
    adaptive: bool = False,
    clamp: float | None = None,
    sampler: Sampler | Unnamed | None = None,
    filter: Filter = _FILTER,
    checkpoint: str | os.PathLike[str] | None = None,
    executor: Executor | None = None,
    aov: str | Iterable[str] = (),
    stop: Stop | None = None,
    background: str = "shown",
    on_interrupt: str = "raise",
    halves: bool = False,
    denoise: bool | str = False,
    device: Gpu | None = None,
) -> Image:
    """Render a picture until the first of the given limits is met.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another kind
        Camera of the picture.
    integrator : Path or another kind
        Estimator of radiance; an `Integrator` may be written in Python. Options that a `Path` leaves open are
        chosen: if the picture has a million samples or more, by a pilot, which renders a few parts of it with
        each option. ``image.plan`` lists the choices with reasons.
    samples : int, optional
        Limit on samples per pixel; 64 if no limit at all is given.
    error : float, optional
        Limit on the relMSE of the picture (see `ErrorEstimate`): the whole 95 % interval of its estimate is
        at or below, and the estimate can be trusted. At least 16 samples a pixel are taken, since light that
        was never found is in no estimate. If light is so rare that the estimate stays below the limit and is
        not trusted, the render goes on to 64 times the samples at which it first fell below, or to another
        limit; ``image.error.trusted`` is False then.
    seconds : float, optional
        Limit on run time in seconds, to the nearest sample of all pixels.
    seed : int, Generator or SeedSequence
        Picks the random numbers, 0 to 2**64 - 1. The same seed, samples and sampler give the same picture,
        bit for bit, for any number of threads. What is chosen where it is not named goes by the limits that
        are given. A `numpy.random.Generator` is advanced by one draw, so that the next picture has other
        numbers; a `numpy.random.SeedSequence` is not changed and always stands for the same number.
    threads : int, optional
        Number of threads; all cores if not given. An executor's pieces of work take this number each; 1 if
        not given.
    progress : bool or callable
        Whether to show a bar on stderr and, in a notebook, the picture as it comes; before, where the scene
        takes longer than two seconds to compile, a bar for that. A function is called with the picture so
        far, an Image, ten times a second, less often where it takes more than a tenth of the work, and in the
        end with the final image. Pixels so far are computed when the function reads them, or keeps the image:
        large pictures cost nothing if only the progress is read. Within a pass some pixels have more samples
        than others; before the end of the first, ``image.samples`` is 0. An exception of the function ends
        the render.
    adaptive : bool
        Adaptive sampling: pixels with more of the estimated relMSE get more samples; `samples` is then their
        mean, and ``image.aov["samples"]`` the number for each pixel. It begins after 16 samples. It adds no
        bias: each pixel has two halves, and each half decides the number of samples of the other.
    clamp : float, optional
        Maximum radiance of a sample, in its largest channel; brighter samples are scaled down. It takes
        fireflies away, and light with them: the picture is biased, and says so. If not given, samples are not
        clamped.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, optional
        Sampler of the random numbers. If not given, it is chosen for the least error, and ``image.plan`` has
        the choice and the reason: a `Lattice`, or `Sobol` for batches of 4 samples or fewer. Those with
        batches take fewer samples to the same error, and estimate the error of a single pixel from fewer
        independent parts. A number of samples that is no multiple of its batches is best avoided: part of a
        batch is right as well, but worth less.
    filter : BoxFilter, GaussianFilter or another kind
        Reconstruction filter of pixels.
    checkpoint : str or path, optional
        A file that is kept up to date with the render: every minute, at its end, and when it is interrupted.
        If there is such a file, the render goes on from it, with all limits counted from its first start, and
        ends with the same bits as one that was never interrupted, even by ``kill -9``. A sampler that is not
        given, or given no batch, is that of the file. The file stays when the render is done, so that it can
        be taken further by other limits. If it cannot be written, there is a RuntimeWarning and a note in
        ``image.warnings``, and the render goes on.
    executor : concurrent.futures.Executor, optional
        Executor that does the work: a ``ProcessPoolExecutor``, ``client.get_executor()`` of
        `dask.distributed`, the pool of `mpi4py.futures`, or any other. The picture has the same bits as a
        local one. Work lost with a worker is done again; if the executor breaks, the rest is rendered here,
        with a note in ``image.warnings``. Scene, camera and integrator are pickled, and compiled once in each
        process.
    aov : str or several, optional
        Auxiliary buffers of the first hit, by the names in `AOVS`: ``image.aov["depth"]`` and so on, as in
        `aovs`; coverage comes from the picture's own samples and filter.
    stop : threading.Event, or anything with a method is_set, optional
        Ends the render at once when it is set, from another thread or from `progress`. The picture so far is
        returned, even if some of its pixels have no sample yet, with a note in ``image.warnings``.
    background : str
        ``"transparent"`` leaves the background out where the camera sees it directly, past the scene and
        through the holes of masks: ``image.alpha`` is the covered share of each pixel, and `rgb` and its
        error are premultiplied by it. The background still lights the scene; glass and mirrors show it, and
        cover everything behind them. ``"shown"`` is the picture with its background. The pictures that
        `progress` is shown have no alpha yet, and stand before black.
    on_interrupt : str
        Effect of Ctrl-C during the render: ``"raise"`` raises a KeyboardInterrupt at once, whose ``image`` is
        the picture so far, without alpha and `aov`; ``"return"`` returns it whole. Either way
        ``image.warnings`` mentions pixels without samples.
    halves : bool
        True if ``image.halves`` keeps two independent halves of the picture, with albedo, normal and depth of
        the first hit, for `Image.denoise`. The picture is the same; it takes 290 bytes a pixel more while it
        is rendered, and 130 when it is done.
    denoise : bool or str
        True if `Image.denoise` is applied in the end; a text is its `method`. `error` limits the error before
        denoising. If it has too few samples, it stays as it is, with a note in ``image.warnings``.
    device : Gpu, optional
        Device that traces paths, in place of the CPU: the picture agrees with the CPU's within the errors of
        both, by the same estimator with other random numbers. It does pictures by a `Path` and a `Camera` of
        meshes that are `Diffuse`, `Mirror`, `Dielectric`, `Conductor` or `Plastic`, in the light of emission,
        points, directions and an environment. Pictures with unsupported features are rendered by the CPU,
        whole and with the same bits as ever; ``image.plan["device"]`` names the feature. If the device is
        lost, there is a warning, and the CPU goes on. Limits, `progress`, `stop` and Ctrl-C are heard between
        its pieces of work.

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
        At once, when Ctrl-C is pressed, unless `on_interrupt` says otherwise; a checkpoint is written before.

    See Also
    --------
    RenderSetup.render : Render with the settings of a scene file.
    render_frames : Render an animation.
    aovs : Auxiliary buffers without a picture.
    view : A window with the picture as it comes.

    Notes
    -----
    With a checkpoint, SIGTERM writes it before its usual effect: by default, the end of the process. It is
    heard in the main thread alone.

    Examples
    --------
    >>> scene = rw.Scene([rw.Plane(), rw.Sphere((0, 0, 1))], environment=1.0)
    >>> camera = rw.Camera((0, -6, 2), (0, 0, 1), up=(0, 0, 1), width=16, height=12)
    >>> image = rw.render(scene, camera, samples=16, progress=False)
    >>> image.rgb.shape, image.samples, bool(0 < image.error.estimate < 1)
    ((12, 16, 3), 16, True)

    The same seed gives the same bits:

    >>> again = rw.render(scene, camera, samples=16, progress=False)
    >>> bool((image.rgb == again.rgb).all())
    True
    """
    checked = check(
        scene, camera, integrator, samples, error, seconds, seed, threads, adaptive, clamp, sampler, filter
    )
    limits, seed, threads, clamp = checked
    unnamed = sampler.why if isinstance(sampler, Unnamed) else None
    if isinstance(sampler, Unnamed):
        sampler = None
    if not (callable(progress) or isinstance(progress, bool)):
        raise TypeError(f"progress must be True, False or a function, got {progress!r}")
    show = progress if callable(progress) else display() if progress else None
    if stop is not None and not callable(getattr(stop, "is_set", None)):
        raise TypeError(f"stop must be a threading.Event or the like, got {type(stop).__name__}")
    if executor is not None:
        # Imported here, because only distributed renders need it (import time).
        from concurrent.futures import Executor

        if not isinstance(executor, Executor):
            raise TypeError(f"executor must be a concurrent.futures.Executor, got {type(executor).__name__}")
    for name, value, choices in (
        ("background", background, BACKGROUNDS),
        ("on_interrupt", on_interrupt, ON_INTERRUPT),
    ):
        if value not in choices:
            raise ValueError(f"{name} must be one of {', '.join(choices)}, got {value!r}")
    if not isinstance(halves, bool):
        raise TypeError(f"halves must be True or False, got {halves!r}")
    if not isinstance(denoise, bool | str):
        raise TypeError(f"denoise must be True, False or the name of a method, got {denoise!r}")
    method = (
        check_method("denoise", denoise) if isinstance(denoise, str) else "regression" if denoise else None
    )
    apart = halves or method is not None
    if device is not None:
        check_device(device)
    names = names_of(aov)
    kept, begun = None, {}
    if checkpoint is not None:
        if not isinstance(checkpoint, str | os.PathLike):
            raise TypeError(f"checkpoint must be a path, got {type(checkpoint).__name__}")
        # Imported here, because only checkpoints need it (import time).
        from .checkpoints import Checkpoints, held

        begun = held(checkpoint)
    if executor is None:
        # Compiled here, so that warnings point to the caller.
        scene._compiled(progress is True)
    there, began = None, time.monotonic()
    if device is not None:
        others = {
            "adaptive=True": adaptive,
            "clamp": clamp is not None,
            "background='transparent'": background == "transparent",
            "halves=True": halves,
            "denoise": method is not None,
            "checkpoint": checkpoint is not None,
            "executor": executor is not None,
        }
        there = OnDevice(device, scene, camera, integrator, seed, others, sampler, filter)
    prepared = time.monotonic() - began
    if there is not None and there.works:
        integrator, sampler, plan = there.plan(integrator)
    else:
        photons = isinstance(integrator, ProgressivePhotonMap)
        sampler, plan = chosen(sampler, limits, adaptive, begun.get("sampler"), apart, photons)
        if unnamed is not None:
            plan = plan.explained("sampler", unnamed)

    def look() -> None:
        if stop is not None and stop.is_set():
            raise StoppedError

    looks, spent = None if stop is None else look, 0.0
    if isinstance(integrator, Path) and not (there is not None and there.works):
        what = scene, camera, limits, threads, clamp, filter
        integrator, rows, spent = followed(integrator, *what, begun, looks)
        plan = replace(plan, rows=plan.rows + rows, path=integrator)
    if there is not None and not there.works:
        plan = replace(plan, rows=(there.row(), *plan.rows))
    plan = replace(plan, rows=plan.rows + waves(scene))
    for row in plan.rows:
        debug("render: %s: %s (%s)", row.what, row.chosen, row.why)
    transparent = background == "transparent"
    job = Job(scene, camera, integrator, seed, adaptive, clamp, sampler, filter, transparent, apart)
    if checkpoint is not None:
        kept = Checkpoints(checkpoint, job.identity())
    rendering = _begun(kept, job, threads)
    # The time of the pilot counts as part of the render.
    rendering.spend(spent + prepared)
    sight = _core.Sight(rendering)
    # Integrators written in Python run on the thread that shows pictures.
    alone = isinstance(integrator, Integrator)
    snapshots = None if show is None else Snapshots(show, 1 if alone else threads or _core.cores())

    def whole(done: _core.Rendering, told: Iterable[str] = ()) -> Image:
        return made(done, clamp, {"samples": done.counts} if adaptive else {}, told, plan)

    def outline(done: _core.Rendering) -> dict[str, Any]:
        return overall(done) | {"plan": plan, "_doubts": tuple(doubts(done))}

    def so_far(seen: Sight) -> ImageSoFar:
        return ImageSoFar.of(seen, whole, outline, (camera.width, camera.height), adaptive)

    def look_on() -> bool:
        look()
        if snapshots is None or not snapshots.due:
            return False
        if sight.is_open:
            snapshots.take(lambda: so_far(sight), lambda: sight.is_done)
            return False
        # Between passes a picture needs the render to pause.
        return True

    def wait() -> float | None:
        return None if kept is None else kept.wait()

    def rest() -> None:
        if kept is not None and kept.wait() == 0:
            kept.write_beside(rendering)
        if snapshots is not None and snapshots.due:
            snapshots.take(lambda: so_far(AtRest(rendering)), lambda: True)

    def keep() -> None:
        # A render that could not begin leaves no checkpoint.
        if kept is not None and rendering.aim:
            kept.write(rendering)

    def run(report: Report | None) -> list[str]:
        told: list[str] = []

        def work() -> None:
            nonlocal plan
            if there is not None and there.works:
                if there.run(rendering, limits, report, rest, look):
                    return
                told.append(f"{there.row().why}, and the CPU went on")
                plan = replace(plan, rows=(there.row(), *plan.rows[1:]))
            broken = []
            if executor is not None:
                broken = _elsewhere(rendering, job, executor, limits, threads, report, rest, look)
                told.extend(broken)
            if executor is None or broken:
                _here(rendering, job, limits, threads, report, wait, rest, looks if show is None else look_on)

        try:
            look()
            if kept is None:
                work()
            else:
                unless_terminated(work, keep)
        except StoppedError:
            told.extend(_unseen(rendering, "stopped"))
        except KeyboardInterrupt as interrupt:
            if on_interrupt == "raise":
                interrupt.image = whole(rendering, _unseen(rendering, "interrupted"))  # type: ignore[attr-defined]
                raise
            told += ["interrupted by Ctrl-C", *_unseen(rendering, "interrupted")]
        finally:
            keep()
            if there is not None:
                there.end()
        return told + ([kept.trouble] if kept is not None and kept.trouble else [])

    if progress is True:
        with bar(*limits, rate(integrator)) as report:
            problems = run(report)
    else:
        problems = run(None)
    found: dict[str, NDArray[Any]] = {"samples": rendering.counts} if adaptive else {}
    found |= seen(scene, camera, names, _AOV_SAMPLES, seed, threads)
    asked = (*names, "alpha") if transparent else names
    known = covers(rendering, job, asked, None, threads)
    found |= {name: array for name, array in known.items() if name in names}
    image = made(rendering, clamp, found, problems, plan, known["alpha"] if transparent else None)
    image = doubted(image, scene)
    if rendering.dropped and isinstance(integrator, Integrator):
        _warn_of_written(integrator, rendering.dropped)
    if is_gathered(integrator):
        image = with_bias(image, limits[1], rendering, job, threads, looks)
    if apart:
        image = replace(image, halves=halves_of(rendering, scene, camera, seed, threads))
    if method is not None:
        image = _denoised(image, method, threads)
    if show is not None:
        show(image)
    return image


def _warn_of_written(integrator: Integrator, dropped: int) -> None:
    """Warn of negative or infinite radiance that a Python integrator returned: a mistake in it."""
    python_warnings.warn(
        f"{type(integrator).__name__}.radiance must return finite numbers that are at least 0, and did not "
        f"for {dropped} sample{'' if dropped == 1 else 's'}, which count as black",
        RuntimeWarning,
        stacklevel=3,
    )


class Checked(NamedTuple):
    """The checked arguments of `render`, as the core takes them."""

    limits: Limits
    seed: int
    threads: int | None
    clamp: float | None


def check(
    scene: Scene,
    camera: AnyCamera,
    integrator: AnyIntegrator,
    samples: int | None,
    error: float | None,
    seconds: float | None,
    seed: SeedLike,
    threads: int | None,
    adaptive: bool,
    clamp: float | None,
    sampler: Sampler | Unnamed | None,
    filter: Filter,
) -> Checked:
    """Raise a TypeError or a ValueError if the arguments of `render` contradict each other."""
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
    if sampler is not None and not isinstance(sampler, Sampler | Unnamed):
        raise TypeError(f"sampler must be one of raywright's, got {type(sampler).__name__}")
    if not isinstance(filter, Filter):
        raise TypeError(f"filter must be one of raywright's, got {type(filter).__name__}")
    samples = None if samples is None else integer("samples", samples, 1, 2**32 - 1)
    error = None if error is None else positive("error", error)
    seconds = None if seconds is None else positive("seconds", seconds)
    clamp = None if clamp is None else positive("clamp", clamp)
    if samples is None and error is None and seconds is None:
        samples = _DEFAULT_SAMPLES
    seed = seed_number(seed)
    threads = thread_limit(threads)
    return Checked((samples, error, seconds), seed, threads, clamp)


def _unseen(rendering: _core.Rendering, how: str) -> list[str]:
    """Return the warnings about pixels without samples, in a picture that ended so."""
    return [] if rendering.counts.all() else [f"{how} before every pixel had a sample"]


def _here(
    rendering: _core.Rendering,
    job: Job,
    limits: Limits,
    threads: int | None,
    report: Report | None,
    wait: Callable[[], float | None],
    rest: Callable[[], None],
    look: Callable[[], bool | None] | None,
) -> None:
    """Render in this process; `rest` is called whenever `wait` is over, or `look` has said so."""
    compiled = job.scene._compiled()
    while not rendering.go_on(job.core, compiled, threads, *limits, wait(), report, look):
        rest()


def _elsewhere(
    rendering: _core.Rendering,
    job: Job,
    executor: Executor,
    limits: Limits,
    threads: int | None,
    report: Report | None,
    rest: Callable[[], None],
    look: Callable[[], None],
) -> list[str]:
    """Render by an executor; if it breaks, return what there is to say of that."""
    # Imported here, because only distributed renders need it (import time).
    from .executor import BrokenError, Distribution

    def look_and_rest() -> None:
        look()
        rest()

    distribution = Distribution(rendering, job, executor, limits, threads or 1)
    try:
        distribution.run(report, look_and_rest)
    except BrokenError as error:
        return [f"the executor broke, and the rest was rendered here: {error}"]
    finally:
        for message in distribution.told:
            python_warnings.warn(message, RuntimeWarning, stacklevel=4)
    return []


def _begun(kept: Checkpoints | None, job: Job, threads: int | None) -> _core.Rendering:
    """Return an empty render, or that of a checkpoint."""
    patch = job.patch()
    film = None if kept is None else kept.read(_core.Rendering.most_bytes(job.core))
    if kept is None or film is None:
        return _core.Rendering(job.core, threads, patch)
    try:
        return _core.Rendering.from_bytes(film, job.core, threads, patch)
    except ValueError as error:
        kept.refuse(f"is damaged: {error}")


def _denoised(image: Image, method: str, threads: int | None) -> Image:
    """Return the denoised image, or the image as it is with a warning."""
    if image.halves is None:
        few = "not denoised: a quarter of the samples is less than a batch of them"
        return replace(image, warnings=(*image.warnings, few))
    return image.denoise(method, threads=threads)
