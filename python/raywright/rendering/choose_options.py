"""Choose what a render leaves open: device, sampler, and the path tracer's options."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from ..debug_log import debug
from ..integrators import Path, ProgressivePhotonMap
from .auto_options import followed
from .check_request import PictureRequest, RunOptions
from .choices import chosen, waves
from .job import Job
from .on_device import OnDevice
from .plan import RenderPlan


@dataclass(frozen=True)
class ChosenRender:
    """A render whose options are all chosen.

    Attributes
    ----------
    job : Job
        The job, with the chosen integrator and sampler.
    plan : RenderPlan
        The choices with their reasons.
    on_device : OnDevice or None
        The picture on the device, if one was given; it may have left the picture to the CPU.
    spent : float
        Seconds of the pilot and of the device's preparation, which count as part of the render.
    """

    job: Job
    plan: RenderPlan
    on_device: OnDevice | None
    spent: float


def choose(picture: PictureRequest, options: RunOptions, look: Callable[[], None] | None) -> ChosenRender:
    """Return the render with all options chosen; `look` may end a pilot by raising `StoppedError`."""
    began = time.monotonic()
    device = _on_device(picture, options)
    spent = time.monotonic() - began
    integrator, sampler = picture.integrator, picture.sampler
    is_on_device = device is not None and device.works
    if device is not None and is_on_device:
        integrator, sampler, plan = device.plan(integrator)
    else:
        photons = isinstance(integrator, ProgressivePhotonMap)
        known = options.begun.get("sampler")
        sampler, plan = chosen(sampler, picture.limits, picture.adaptive, known, options.is_apart, photons)
        if picture.unnamed is not None:
            plan = plan.explained("sampler", picture.unnamed)
    if isinstance(integrator, Path) and not is_on_device:
        what = picture.scene, picture.camera, picture.limits, picture.threads, picture.clamp, picture.filter
        integrator, rows, seconds = followed(integrator, *what, options.begun, look)
        plan = replace(plan, rows=plan.rows + rows, path=integrator)
        spent += seconds
    if device is not None and not is_on_device:
        plan = replace(plan, rows=(device.row(), *plan.rows))
    plan = replace(plan, rows=plan.rows + waves(picture.scene))
    for row in plan.rows:
        debug("render: %s: %s (%s)", row.what, row.chosen, row.why)
    job = Job(
        picture.scene,
        picture.camera,
        integrator,
        picture.seed,
        picture.adaptive,
        picture.clamp,
        sampler,
        picture.filter,
        options.is_transparent,
        options.is_apart,
    )
    return ChosenRender(job, plan, device, spent)


def _on_device(picture: PictureRequest, options: RunOptions) -> OnDevice | None:
    """Return the picture on the given device, if there is one."""
    if options.device is None:
        return None
    others = {
        "adaptive=True": picture.adaptive,
        "clamp": picture.clamp is not None,
        "background='transparent'": options.is_transparent,
        "halves=True": options.halves,
        "denoise": options.denoise is not None,
        "checkpoint": options.checkpoint is not None,
        "executor": options.executor is not None,
    }
    what = picture.scene, picture.camera, picture.integrator, picture.seed
    return OnDevice(options.device, *what, others, picture.sampler, picture.filter)
