"""What all integrators have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..query.ray_batch import Rays
from .rng import Rng

if TYPE_CHECKING:
    from ..scene.scene import Scene


class CoreIntegrator:
    """What turns rays into radiance, in the core. Its subclasses say how."""


class Integrator(ABC):
    """The base class of integrators written in Python, which work on whole batches.

    `render` takes a subclass like the core's integrators, with error estimates, limits and history. Batches
    are of some thousand rays; several threads may call `radiance` at once, so it must not change the
    integrator.

    See Also
    --------
    Path : The path tracer of the core.

    Examples
    --------
    >>> class Normals(rw.integrators.Integrator):
    ...     def radiance(self, scene, rays, rng):
    ...         return np.nan_to_num(np.abs(scene.interactions(rays).normal))
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(rw.Scene(rw.Plane()), camera, Normals(), samples=1, progress=False)
    >>> image.rgb[0, 0].tolist()
    [0.0, 0.0, 1.0]
    """

    @abstractmethod
    def radiance(self, scene: Scene, rays: Rays, rng: Rng) -> NDArray[np.float64]:
        """Return the radiance that arrives along each ray.

        Parameters
        ----------
        scene : Scene
            The scene: `Scene.interactions` finds the surfaces that rays hit, `Scene.occluded` tests shadow
            rays.
        rays : Rays
            A batch of N rays that the camera sends.
        rng : Rng
            Their random numbers. A picture has the same bits for any number of threads if each row depends on
            its own ray and its own numbers only, and calls to `rng` are the same for all batches.

        Returns
        -------
        (N, 3) array
            Red, green and blue, in W·sr⁻¹·m⁻²; negative values and those that are not finite count as black,
            with a warning.

        See Also
        --------
        query.Interactions : Scattering and light at hits.

        Examples
        --------
        >>> class Lambert(rw.integrators.Integrator):
        ...     def radiance(self, scene, rays, rng):
        ...         met = scene.interactions(rays)
        ...         light = met.sample_light(rng.next_1d(), rng.next_2d())
        ...         value, _ = met.evaluate(light.direction)
        ...         return met.emission + value * light.weight * light.visible(scene)[:, None]
        >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 1), intensity=np.pi)])
        >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), fov=0.1, width=1, height=1)
        >>> image = rw.render(scene, camera, Lambert(), samples=1, progress=False)
        >>> print(image.rgb[0, 0].round(3))
        [0.5 0.5 0.5]
        """
