"""Run a render: passes, pictures so far, checkpoints and interrupts."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from .. import _core
from ..integrators.base import Integrator
from ..io.quiet import warn_caller
from .auto_options import StoppedError
from .build_image import doubts, made, overall
from .check_request import PictureRequest, RunOptions, Stop
from .choose_options import ChosenRender
from .image import Image
from .interrupts import unless_terminated
from .job import Job
from .partial_image import AtRest, ImageSoFar, Sight
from .photon_bias import rate
from .progress import Report, bar
from .snapshots import Snapshots

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from .checkpoints import Checkpoints


def unless_stopped(stop: Stop | None) -> None:
    """Raise a `StoppedError` if the render should stop."""
    if stop is not None and stop.is_set():
        raise StoppedError


class RenderRun:
    """The run of a render, here, on a device or by an executor.

    Parameters
    ----------
    picture : PictureRequest
        The picture.
    options : RunOptions
        Options of the run.
    chosen : ChosenRender
        The job and the plan.

    Attributes
    ----------
    rendering : _core.Rendering
        The samples so far.
    plan : RenderPlan
        The choices, and the device's loss if it was lost.
    """

    def __init__(self, picture: PictureRequest, options: RunOptions, chosen: ChosenRender) -> None:
        self.plan = chosen.plan
        self._picture, self._options = picture, options
        self._job, self._device = chosen.job, chosen.on_device
        self._kept: Checkpoints | None = None
        if options.checkpoint is not None:
            # Imported here, because only checkpoints need it (import time).
            from .checkpoints import Checkpoints

            self._kept = Checkpoints(options.checkpoint, self._job.identity())
        self.rendering = _begun(self._kept, self._job, picture.threads)
        self.rendering.spend(chosen.spent)
        self._sight = _core.Sight(self.rendering)
        self._snapshots: Snapshots | None = None
        if options.show is not None:
            # Integrators written in Python run on the thread that shows pictures.
            is_alone = isinstance(self._job.integrator, Integrator)
            self._snapshots = Snapshots(options.show, 1 if is_alone else picture.threads or _core.cores())

    def run(self) -> list[str]:
        """Render until a limit is met, and return warnings about what went wrong."""
        if not self._options.has_bar:
            return self._run(None)
        with bar(*self._picture.limits, rate(self._job.integrator)) as report:
            return self._run(report)

    def look(self) -> None:
        """Raise a `StoppedError` if the render should stop."""
        unless_stopped(self._options.stop)

    def _run(self, report: Report | None) -> list[str]:
        told: list[str] = []
        try:
            self.look()
            if self._kept is None:
                self._work(report, told)
            else:
                unless_terminated(lambda: self._work(report, told), self._keep)
        except StoppedError:
            told.extend(_unseen(self.rendering, "stopped"))
        except KeyboardInterrupt as interrupt:
            unseen = _unseen(self.rendering, "interrupted")
            if self._options.on_interrupt == "raise":
                interrupt.image = self._whole(self.rendering, unseen)  # type: ignore[attr-defined]
                raise
            told += ["interrupted by Ctrl-C", *unseen]
        finally:
            self._keep()
            if self._device is not None:
                self._device.end()
        return told + ([self._kept.trouble] if self._kept is not None and self._kept.trouble else [])

    def _work(self, report: Report | None, told: list[str]) -> None:
        """Render on the device, by the executor or here; the CPU goes on where one of the others is lost."""
        if self._device is not None and self._device.works:
            limits = self._picture.limits
            if self._device.run(self.rendering, limits, report, self._rest, self.look):
                return
            lost = self._device.row()
            told.append(f"{lost.why}, and the CPU went on")
            self.plan = replace(self.plan, rows=(lost, *self.plan.rows[1:]))
        executor = self._options.executor
        broken = [] if executor is None else self._elsewhere(executor, report)
        told.extend(broken)
        if executor is None or broken:
            self._here(report)

    def _here(self, report: Report | None) -> None:
        """Render in this process."""
        job, picture = self._job, self._picture
        compiled = job.scene._compiled()
        look = None if self._options.stop is None and self._snapshots is None else self._look_on
        while True:
            wait = None if self._kept is None else self._kept.wait()
            if self.rendering.go_on(job.core, compiled, picture.threads, *picture.limits, wait, report, look):
                return
            self._rest()

    def _elsewhere(self, executor: Executor, report: Report | None) -> list[str]:
        """Render by an executor; if it breaks, return a warning of that."""
        # Imported here, because only distributed renders need it (import time).
        from .executor import BrokenError, Distribution

        def look_and_rest() -> None:
            self.look()
            self._rest()

        picture = self._picture
        distribution = Distribution(self.rendering, self._job, executor, picture.limits, picture.threads or 1)
        try:
            distribution.run(report, look_and_rest)
        except BrokenError as error:
            return [f"the executor broke, and the rest was rendered here: {error}"]
        finally:
            for message in distribution.told:
                warn_caller(message)
        return []

    def _look_on(self) -> bool:
        """Show the picture so far if one is due; return True if the render has to pause for it."""
        self.look()
        if self._snapshots is None or not self._snapshots.due:
            return False
        if self._sight.is_open:
            self._snapshots.take(lambda: self._so_far(self._sight), lambda: self._sight.is_done)
            return False
        # Between passes a picture needs the render to pause.
        return True

    def _rest(self) -> None:
        """Write the checkpoint and show the picture, each if it is due, while the render is at rest."""
        if self._kept is not None and self._kept.wait() == 0:
            self._kept.write_beside(self.rendering)
        if self._snapshots is not None and self._snapshots.due:
            self._snapshots.take(lambda: self._so_far(AtRest(self.rendering)), lambda: True)

    def _keep(self) -> None:
        """Write the checkpoint; a render that could not begin leaves none."""
        if self._kept is not None and self.rendering.aim:
            self._kept.write(self.rendering)

    def _whole(self, done: _core.Rendering, told: Iterable[str] = ()) -> Image:
        adaptive = self._picture.adaptive
        return made(done, self._picture.clamp, {"samples": done.counts} if adaptive else {}, told, self.plan)

    def _outline(self, done: _core.Rendering) -> dict[str, Any]:
        return overall(done) | {"plan": self.plan, "_doubts": tuple(doubts(done))}

    def _so_far(self, seen: Sight) -> ImageSoFar:
        size = self._picture.camera.width, self._picture.camera.height
        return ImageSoFar.of(seen, self._whole, self._outline, size, self._picture.adaptive)


def _unseen(rendering: _core.Rendering, how: str) -> list[str]:
    """Return the warnings about pixels without samples, in a picture that ended so."""
    return [] if rendering.counts.all() else [f"{how} before every pixel had a sample"]


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
