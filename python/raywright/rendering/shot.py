"""A scene with all that it takes to make a picture of it."""

from dataclasses import dataclass, field, replace
from typing import Any

from ..arrays import SeedLike, integer, seed_number
from ..cameras import AnyCamera
from ..cameras.any_camera import resized
from ..integrators import AnyIntegrator, Path
from ..scene.scene import Scene
from .filters import BoxFilter, Filter
from .image import Image
from .render import render
from .samplers import Sampler, Unnamed

_LIMITS = ("samples", "error", "seconds")


@dataclass(frozen=True)
class Shot:
    """A scene, a camera, and how they are rendered: what `load` and `from_mitsuba` return.

    Shots compare by what they hold, and pickle.

    Parameters
    ----------
    scene : Scene
        What to look at.
    camera : Camera or another kind
        From where.
    integrator : Path or another kind
        What turns rays into radiance.
    samples : int, optional
        Samples per pixel; None leaves it to `render`.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, optional
        Where the random numbers come from; None leaves it to `render`.
    filter : BoxFilter, GaussianFilter or another kind
        What part of the film a pixel is the mean of.
    seed : int, Generator or SeedSequence
        Picks the random numbers.
    aov : tuple of str
        What is seen first, besides the picture, as `raywright.render` takes it.
    background : {"shown", "transparent"}
        Whether what surrounds the scene is seen, as `raywright.render` takes it.
    clamp : float, optional
        Limit on the largest channel of a sample, as `raywright.render` takes it.
    unnamed : str, optional
        Why no sampler is named although the file has one; the plan of the picture tells it.
    """

    scene: Scene
    camera: AnyCamera
    integrator: AnyIntegrator = field(default_factory=Path)
    samples: int | None = None
    sampler: Sampler | None = None
    filter: Filter = field(default_factory=BoxFilter)
    seed: SeedLike = 0
    aov: tuple[str, ...] = ()
    background: str = "shown"
    clamp: float | None = None
    unnamed: str | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.seed, int):
            # Every picture of a shot is made of the same random numbers.
            object.__setattr__(self, "seed", seed_number(self.seed))

    def render(self, **overrides: Any) -> Image:
        """Render the picture.

        Parameters
        ----------
        **overrides
            Arguments of `raywright.render`, in place of what the shot has. The samples of the shot count
            only where none of `samples`, `error` and `seconds` is given.

        Returns
        -------
        Image
            With its standard error, error estimate and history.

        Raises
        ------
        TypeError, ValueError, OSError, KeyboardInterrupt
            As `raywright.render` does.
        """
        own: dict[str, Any] = {
            "scene": self.scene,
            "camera": self.camera,
            "integrator": self.integrator,
            "sampler": Unnamed(self.unnamed) if self.sampler is None and self.unnamed else self.sampler,
            "filter": self.filter,
            "seed": self.seed,
            "aov": self.aov,
            "background": self.background,
            "clamp": self.clamp,
        }
        if all(overrides.get(limit) is None for limit in _LIMITS):
            own["samples"] = self.samples
            overrides = {name: value for name, value in overrides.items() if name not in _LIMITS}
        return render(**(own | overrides))

    def resized(self, width: int | None = None, height: int | None = None) -> "Shot":
        """Return the shot with a picture of another size.

        Parameters
        ----------
        width, height : int, optional
            In pixels. If only one is given, the other keeps the proportions.

        Raises
        ------
        ValueError
            If a number is out of its range.
        TypeError
            If it is not an integer.
        """
        before = self.camera
        if width is None and height is None:
            return self
        if width is None:
            width = max(round(before.width * integer("height", height or 0, 1) / before.height), 1)
        if height is None:
            height = max(round(before.height * integer("width", width, 1) / before.width), 1)
        return replace(self, camera=resized(before, width, height))
