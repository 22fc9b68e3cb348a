"""Check the arguments of a render."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from ..arrays import SeedLike, integer, positive, seed_number, thread_limit
from ..cameras import AnyCamera
from ..integrators import AnyIntegrator, check_integrator
from ..scene.scene import Scene
from .aovs import names_of
from .choices import Limits
from .denoising import check_method
from .filters import Filter
from .image import Image
from .interrupts import ON_INTERRUPT
from .notebook import display
from .on_device import check_device
from .samplers import Sampler, Unnamed

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from ..gpu import Gpu

BACKGROUNDS = ("shown", "transparent")
_DEFAULT_SAMPLES = 64


class Stop(Protocol):
    """A request to stop a render, such as a `threading.Event`."""

    def is_set(self) -> bool:
        """Return True if the render should stop."""


@dataclass(frozen=True)
class PictureRequest:
    """The requested picture: checked arguments of `render` on which its samples depend.

    Attributes
    ----------
    sampler : Sampler or None
        The sampler named by the user, if any.
    unnamed : str or None
        Reason for ignoring the sampler of a scene file.
    """

    scene: Scene
    camera: AnyCamera
    integrator: AnyIntegrator
    limits: Limits
    seed: int
    threads: int | None
    adaptive: bool
    clamp: float | None
    sampler: Sampler | None
    unnamed: str | None
    filter: Filter


@dataclass(frozen=True)
class RunOptions:
    """Checked arguments of `render` about its run, and about what comes with the picture.

    Attributes
    ----------
    show : callable or None
        Takes the pictures so far.
    has_bar : bool
        Whether there are progress bars.
    aov : tuple of str
        Names of auxiliary buffers.
    denoise : str or None
        Method of `Image.denoise`.
    begun : mapping
        Settings of the render in the checkpoint; empty if there is none.
    """

    show: Callable[[Image], object] | None
    has_bar: bool
    checkpoint: str | os.PathLike[str] | None
    executor: Executor | None
    aov: tuple[str, ...]
    stop: Stop | None
    background: str
    on_interrupt: str
    halves: bool
    denoise: str | None
    device: Gpu | None
    begun: Mapping[str, Any]

    @property
    def is_transparent(self) -> bool:
        """True if the picture leaves the background out."""
        return self.background == "transparent"

    @property
    def is_apart(self) -> bool:
        """True if parts of the samples are kept apart."""
        return self.halves or self.denoise is not None


def check_picture(
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
) -> PictureRequest:
    """Return the arguments of `render` that describe the picture.

    Raises
    ------
    TypeError, ValueError
        As `render` does.
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
    return PictureRequest(
        scene,
        camera,
        integrator,
        (samples, error, seconds),
        seed_number(seed),
        thread_limit(threads),
        adaptive,
        clamp,
        None if isinstance(sampler, Unnamed) else sampler,
        sampler.why if isinstance(sampler, Unnamed) else None,
        filter,
    )


def check_options(
    progress: bool | Callable[[Image], object],
    checkpoint: str | os.PathLike[str] | None,
    executor: Executor | None,
    aov: str | Iterable[str],
    stop: Stop | None,
    background: str,
    on_interrupt: str,
    halves: bool,
    denoise: bool | str,
    device: Gpu | None,
) -> RunOptions:
    """Return the other arguments of `render`, with the settings in the checkpoint.

    Raises
    ------
    TypeError, ValueError, OSError
        As `render` does.
    """
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
    if device is not None:
        check_device(device)
    names = names_of(aov)
    begun: Mapping[str, Any] = {}
    if checkpoint is not None:
        if not isinstance(checkpoint, str | os.PathLike):
            raise TypeError(f"checkpoint must be a path, got {type(checkpoint).__name__}")
        # Imported here, because only checkpoints need it (import time).
        from .checkpoints import held

        begun = held(checkpoint)
    return RunOptions(
        show,
        progress is True,
        checkpoint,
        executor,
        names,
        stop,
        background,
        on_interrupt,
        halves,
        method,
        device,
        begun,
    )
