"""A scene with all that it takes to make a picture of it."""

from __future__ import annotations

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
class RenderSetup:
    """A scene, a camera and the options of a render: the result of `load` and `from_mitsuba`.

    Shots compare by contents, and pickle.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another kind
        Camera of the picture.
    integrator : Path or another kind
        Estimator of radiance; an `Integrator` may be written in Python.
    samples : int, optional
        Samples per pixel; None leaves it to `render`.
    sampler : Independent, Stratified, Halton, Sobol or Lattice, optional
        Sampler of the random numbers; None leaves it to `render`.
    filter : BoxFilter, GaussianFilter or another kind
        Reconstruction filter of pixels.
    seed : int, Generator or SeedSequence
        Seed of the random numbers.
    aov : tuple of str
        Auxiliary buffers of the first hit, as in `raywright.render`.
    background : {"shown", "transparent"}
        Visibility of the environment, as in `raywright.render`.
    clamp : float, optional
        Limit on the largest channel of a sample, as `raywright.render` takes it.
    unnamed : str, optional
        Reason for ignoring the sampler of the file, for the plan of the picture.

    See Also
    --------
    load : Load a shot from a file.
    render : Render without a shot.

    Examples
    --------
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> shot = rw.rendering.RenderSetup(rw.Scene(rw.Sphere(emission=1.0)), camera, samples=4)
    >>> shot.render(progress=False).samples
    4
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
            Arguments of `raywright.render`, in place of the shot's own. The shot's samples are used only if
            none of `samples`, `error` and `seconds` is given.

        Returns
        -------
        Image
            With its standard error, error estimate and history.

        Raises
        ------
        TypeError, ValueError, OSError, KeyboardInterrupt
            As `raywright.render` does.

        See Also
        --------
        render : The arguments.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
        >>> shot = rw.rendering.RenderSetup(rw.Scene(rw.Sphere(emission=1.0)), camera, samples=4)
        >>> shot.render(samples=2, progress=False).samples
        2
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

    def resized(self, width: int | None = None, height: int | None = None) -> RenderSetup:
        """Return the shot with a picture of another size.

        Parameters
        ----------
        width, height : int, optional
            In pixels. If only one is given, the other keeps the proportions.

        Returns
        -------
        RenderSetup

        Raises
        ------
        ValueError
            If a number is out of its range.
        TypeError
            If an argument is not an integer.

        Examples
        --------
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=400, height=300)
        >>> small = rw.rendering.RenderSetup(rw.Scene(rw.Sphere()), camera).resized(width=40)
        >>> small.camera.width, small.camera.height
        (40, 30)
        """
        before = self.camera
        if width is None and height is None:
            return self
        if width is None:
            width = max(round(before.width * integer("height", height or 0, 1) / before.height), 1)
        if height is None:
            height = max(round(before.height * integer("width", width, 1) / before.width), 1)
        return replace(self, camera=resized(before, width, height))
