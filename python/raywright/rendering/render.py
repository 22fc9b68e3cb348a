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
