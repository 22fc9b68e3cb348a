"""The job of a render."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from .. import _core
from ..cameras import AnyCamera
from ..integrators import AnyIntegrator, Path
from ..locks import Lock
from ..scene.digest import digest
from ..scene.scene import Scene
from .filters import Filter
from .samplers import Sampler


@dataclass
class Job:
    """All that the bits of a picture depend on: the same for each piece of the work, wherever it is done."""

    scene: Scene
    camera: AnyCamera
    integrator: AnyIntegrator
    seed: int
    adaptive: bool
    clamp: float | None
    sampler: Sampler
    filter: Filter
    transparent: bool = False
    apart: bool = False
    told: tuple[str, ...] = ()
    _compiling: Lock = field(default_factory=Lock, repr=False)

    def _arguments(self) -> tuple[Any, ...]:
        how = self.seed, self.adaptive, self.clamp, self.sampler, self.filter, self.transparent, self.apart
        return (self.scene, self.camera, self.integrator, *how)

    def __reduce__(self) -> tuple[Any, ...]:
        return Job, self._arguments()

    @cached_property
    def core(self) -> _core.Job:
        """The job as the core reads it, once."""
        return _core.Job(*self._arguments())

    def compiled(self) -> _core.CompiledScene:
        """Return the scene, compiled the first time that it is asked for."""
        if self.scene._core is not None:
            return self.scene._core
        # Warnings go to the caller, possibly on another machine.
        with self._compiling, warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            compiled = self.scene._compiled()
            self.told += tuple(str(warning.message) for warning in caught)
        return compiled

    def patch(self) -> int:
        """Return the side of the patches of pixels whose samples are taken together."""
        if not isinstance(self.integrator, Path) or self.integrator.reuse == 1:
            return 1
        return self.core.patch(self.scene._compiled())

    def expose(self, request: bytes, threads: int) -> bytes:
        """Take the samples that a request wants."""
        return self.core.expose(self.compiled(), request, threads)

    def identity(self) -> dict[str, str | int | float | bool | None]:
        """Return all that the bits depend on, by names that users know."""
        path = self.integrator if isinstance(self.integrator, Path) else None
        return {
            "version": _core.VERSION,
            "width": self.camera.width,
            "height": self.camera.height,
            "scene": digest(self.scene),
            "camera": digest(self.camera),
            "integrator": digest(self.integrator),
            "reuse": None if path is None else path.reuse,
            "guiding": None if path is None else path.guiding,
            "seed": self.seed,
            "adaptive": self.adaptive,
            "clamp": self.clamp,
            "sampler": repr(self.sampler),
            "filter": repr(self.filter),
            "background": "transparent" if self.transparent else "shown",
            "halves": self.apart,
        }
