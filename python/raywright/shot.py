"""A scene with all that is needed to render it."""

from dataclasses import dataclass, field
from typing import Any

from .cameras import AnyCamera
from .filters import BoxFilter, Filter
from .image import Image
from .integrators import AnyIntegrator, Path
from .rendering import render
from .samplers import Independent, Sampler
from .scene import Scene


@dataclass(frozen=True)
class Shot:
    """A scene, a camera, and how the picture is made."""

    scene: Scene
    camera: AnyCamera
    integrator: AnyIntegrator = field(default_factory=Path)
    samples: int = 64
    sampler: Sampler = field(default_factory=Independent)
    filter: Filter = field(default_factory=BoxFilter)

    def render(self, **overrides: Any) -> Image:
        """Render it; what is given is as `render` takes it."""
        own = {"samples": self.samples, "sampler": self.sampler, "filter": self.filter}
        how = {"integrator": self.integrator, **own, **overrides}
        return render(self.scene, self.camera, **how)
