"""Integrators that are written in Python."""

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..query.interactions import Rays
from .rng import Rng

if TYPE_CHECKING:
    from ..scene.scene import Scene


class Integrator(ABC):
    """What turns rays into radiance, written in Python on whole batches.

    A subclass is given to `render` as the core's integrators are, and its pictures have error estimates,
    limits and history as theirs do. Batches are of some thousand rays; several threads may call `radiance` at
    once, so it must not change the integrator.
    """

    @abstractmethod
    def radiance(self, scene: "Scene", rays: Rays, rng: Rng) -> NDArray[np.float64]:
        """Return the radiance that arrives along each ray.

        Parameters
        ----------
        scene : Scene
            The scene: `Scene.interactions` finds what rays meet, `Scene.occluded` whether they are free.
        rays : Rays
            A batch of N rays that the camera sends.
        rng : Rng
            Their random numbers. A picture has the same bits for any number of threads if each row depends on
            its own ray and its own numbers only, and calls to `rng` are the same for all batches.

        Returns
        -------
        (N, 3) array
            Red, green and blue, in W·sr⁻¹·m⁻²; what is negative or not finite counts as black, with a
            warning.
        """
