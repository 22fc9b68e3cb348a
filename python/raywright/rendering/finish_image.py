"""Finish a picture: auxiliary buffers, warnings, bias, halves and denoising."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from typing import Any

from numpy.typing import NDArray

from .. import _core
from ..integrators.base import Integrator
from ..io.quiet import warn_caller
from .aovs import covers, seen
from .build_image import doubted, made
from .check_request import PictureRequest, RunOptions
from .halves import halves_of
from .image import Image
from .job import Job
from .photon_bias import is_gathered, with_bias
from .plan import RenderPlan

# Samples per pixel for first hits.
_AOV_SAMPLES = 16


def finish(
    picture: PictureRequest,
    options: RunOptions,
    job: Job,
    rendering: _core.Rendering,
    plan: RenderPlan,
    problems: Iterable[str],
    look: Callable[[], None] | None,
) -> Image:
    """Return the image of a render that has ended, and show it.

    Parameters
    ----------
    picture, options : PictureRequest, RunOptions
        The arguments of `render`.
    job : Job
        The job.
    rendering : _core.Rendering
        All samples.
    plan : RenderPlan
        The choices.
    problems : iterable of str
        Warnings of the run.
    look : callable, optional
        Ends the estimate of a photon map's bias by raising `StoppedError`.
    """
    scene, camera, seed, threads = picture.scene, picture.camera, picture.seed, picture.threads
    aov: dict[str, NDArray[Any]] = {"samples": rendering.counts} if picture.adaptive else {}
    aov |= seen(scene, camera, options.aov, _AOV_SAMPLES, seed, threads)
    names = (*options.aov, "alpha") if options.is_transparent else options.aov
    cover = covers(rendering, job, names, None, threads)
    aov |= {name: array for name, array in cover.items() if name in options.aov}
    alpha = cover["alpha"] if options.is_transparent else None
    image = made(rendering, picture.clamp, aov, problems, plan, alpha)
    image = doubted(image, scene)
    if rendering.dropped and isinstance(job.integrator, Integrator):
        _warn_of_written(job.integrator, rendering.dropped)
    if is_gathered(job.integrator):
        image = with_bias(image, picture.limits[1], rendering, job, threads, look)
    if options.is_apart:
        image = replace(image, halves=halves_of(rendering, scene, camera, seed, threads))
    if options.denoise is not None:
        image = _denoised(image, options.denoise, threads)
    if options.show is not None:
        options.show(image)
    return image


def _warn_of_written(integrator: Integrator, dropped: int) -> None:
    """Warn of negative or infinite radiance that a Python integrator returned: a mistake in it."""
    warn_caller(
        f"{type(integrator).__name__}.radiance must return finite numbers that are at least 0, and did not "
        f"for {dropped} sample{'' if dropped == 1 else 's'}, which count as black"
    )


def _denoised(image: Image, method: str, threads: int | None) -> Image:
    """Return the denoised image, or the image as it is with a warning."""
    if image.halves is None:
        few = "not denoised: a quarter of the samples is less than a batch of them"
        return replace(image, warnings=(*image.warnings, few))
    return image.denoise(method, threads=threads)
