"""From a scene and a camera to a picture."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from ..arrays import SeedLike
from ..cameras import AnyCamera
from ..integrators import AnyIntegrator, Path
from ..scene.scene import Scene
from .check_request import Stop, check_options, check_picture
from .choose_options import choose
from .filters import BoxFilter, Filter
from .finish_image import finish
from .image import Image
from .run_render import RenderRun, unless_stopped
from .samplers import Sampler, Unnamed

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ..gpu import Gpu

_PATH = Path()
_FILTER: Filter = BoxFilter()


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
    """Render a picture until it reaches the first of the given limits.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another kind
        Camera of the picture.
    integrator : Path or another kind
        Estimator of radiance; an `Integrator` may be written in Python. Options that a `Path` leaves open are
        chosen automatically; for a million samples or more, a pilot renders a few parts of the picture with
        each option. ``image.plan`` lists the choices with reasons.
    samples : int, optional
        Limit on samples per pixel; 64 if no limit at all is given.
    error : float, optional
        Limit on the relMSE of the picture (see `ErrorEstimate`): the render ends once the 95 % interval of
        the estimate is at or below it, and the estimate is trusted. At least 16 samples a pixel are taken,
        because no estimate includes light that no sample found. If the estimate stays below the limit without
        being trusted, the render continues to 64 times the samples at which it first fell below, or to
        another limit; ``image.error.trusted`` is False then.
    seconds : float, optional
        Limit on run time in seconds, to the nearest sample of all pixels.
    seed : int, Generator or SeedSequence
        Seed of the random numbers, 0 to 2**64 - 1. The same seed, samples and sampler give the same picture,
        bit for bit, for any number of threads. Automatic choices depend on the given limits. A
        `numpy.random.Generator` is advanced by one draw, so the next picture has other numbers; a
        `numpy.random.SeedSequence` is not changed, and always gives the same seed.
    threads : int, optional
        Number of threads; all cores if not given. With an executor, the number for each of its tasks; 1 if
        not given.
    progress : bool or callable
        True for a progress bar on stderr and, in a notebook, the picture so far; also for a bar while the
        scene compiles for more than two seconds. A function gets the picture so far, an Image, ten times a
        second (less often if it takes more than a tenth of the time), and at the end the final image. Pixels
        are computed only if the function reads them or keeps the image, so reading the progress alone costs
        nothing. Within a pass some pixels have more samples than others; before the end of the first pass,
        ``image.samples`` is 0. An exception in the function ends the render.
    adaptive : bool
        True for adaptive sampling: pixels with more of the estimated relMSE get more samples; `samples` is
        then the mean, and ``image.aov["samples"]`` has the number for each pixel. It begins after 16 samples.
        It adds no bias: the samples of each pixel form two halves, and each half decides the number of
        samples of the other.
    clamp : float, optional
        Maximum radiance of a sample, in its largest channel; brighter samples are scaled down. It removes
        fireflies and their light; the picture is marked as biased. If not given, samples are not clamped.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, optional
        Sampler of the random numbers. If not given, it is chosen for the least error, and ``image.plan`` has
        the choice and the reason: a `Lattice`, or `Sobol` for batches of 4 samples or fewer. Samplers with
        batches need fewer samples for the same error, but estimate the error of a single pixel from fewer
        independent parts. Prefer a multiple of the batch for `samples`: part of a batch is unbiased, but less
        effective.
    filter : BoxFilter, GaussianFilter or another kind
        Reconstruction filter of pixels.
    checkpoint : str or path, optional
        A file for the state of the render, written every minute, at the end, and on interruption. If it
        exists, the render continues from it, with limits counted from the first start, and ends with the bits
        of an uninterrupted render, even after ``kill -9``. A sampler, or its batch, that is not given is that
        of the file. The file remains after the render, so it can continue with other limits. If it cannot be
        written, a RuntimeWarning is issued, ``image.warnings`` has a note, and the render continues.
    executor : concurrent.futures.Executor, optional
        Executor that does the work: a ``ProcessPoolExecutor``, ``client.get_executor()`` of
        `dask.distributed`, the pool of `mpi4py.futures`, or any other. The picture has the same bits as a
        local one. The work of a lost worker is repeated; if the executor breaks, the rest is rendered
        locally, with a note in ``image.warnings``. Scene, camera and integrator are pickled, and compiled
        once in each process.
    aov : str or several, optional
        Auxiliary buffers of the first hit, by the names in `AOVS`: ``image.aov["depth"]`` and so on, as in
        `aovs`; coverage comes from the picture's own samples and filter.
    stop : threading.Event, or anything with a method is_set, optional
        An event that ends the render at once, set by another thread or by `progress`. The picture so far is
        returned, even if some of its pixels have no sample yet, with a note in ``image.warnings``.
    background : str
        ``"transparent"`` leaves the background out where the camera sees it directly, past the scene and
        through the holes of masks: ``image.alpha`` is the covered share of each pixel, and `rgb` and its
        error are premultiplied by it. The background still lights the scene; glass and mirrors show it, and
        cover everything behind them. ``"shown"`` is the picture with its background. Pictures passed to
        `progress` have no alpha yet, and a black background.
    on_interrupt : str
        Effect of Ctrl-C: ``"raise"`` raises a KeyboardInterrupt at once, whose ``image`` is the picture so
        far, without alpha and `aov`; ``"return"`` returns the picture so far, with both. ``image.warnings``
        mentions pixels without samples.
    halves : bool
        True if ``image.halves`` keeps two independent halves of the picture, with albedo, normal and depth of
        the first hit, for `Image.denoise`. The picture does not change; memory grows by 290 bytes per pixel
        during the render, and by 130 afterwards.
    denoise : bool or str
        True to apply `Image.denoise` at the end; a str is its `method`. `error` limits the error before
        denoising. A picture with too few samples is not denoised, with a note in ``image.warnings``.
    device : Gpu, optional
        Device that traces paths, in place of the CPU: the picture agrees with the CPU's within the errors of
        both, by the same estimator with other random numbers. It supports `Path`, `Camera`, meshes with the
        materials `Diffuse`, `Mirror`, `Dielectric`, `Conductor` and `Plastic`, and emission, point lights,
        directional lights and environments. The CPU renders pictures with other features, with the same bits
        as without `device`; ``image.plan["device"]`` names the feature. If the device is lost, a warning is
        issued, and the CPU continues. Limits, `progress`, `stop` and Ctrl-C take effect between pieces of
        work.

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
        When Ctrl-C is pressed, unless `on_interrupt` is "return"; a checkpoint is written first.

    See Also
    --------
    RenderSetup.render : Render with the settings of a scene file.
    render_frames : Render an animation.
    aovs : Auxiliary buffers without a picture.
    view : A window with the picture as it comes.

    Notes
    -----
    With a checkpoint, SIGTERM first writes it, and then has its usual effect. Only a render in the main
    thread handles it.

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
    picture = check_picture(
        scene, camera, integrator, samples, error, seconds, seed, threads, adaptive, clamp, sampler, filter
    )
    options = check_options(
        progress, checkpoint, executor, aov, stop, background, on_interrupt, halves, denoise, device
    )
    if executor is None:
        # Compiled here, so that warnings point to the caller.
        scene._compiled(options.has_bar)
    look = None if stop is None else lambda: unless_stopped(stop)
    chosen = choose(picture, options, look)
    run = RenderRun(picture, options, chosen)
    problems = run.run()
    return finish(picture, options, chosen.job, run.rendering, run.plan, problems, look)
