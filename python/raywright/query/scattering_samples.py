"""Samples of scattering and of light at surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .ray_batch import Floats


class Occluding(Protocol):
    """An object that tests rays for occlusion: a scene."""

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = ...,
        t_max: ArrayLike = ...,
        threads: int | None = ...,
        time: ArrayLike | None = ...,
    ) -> NDArray[np.bool_]:
        """See `Scene.occluded`."""
        ...


@dataclass(frozen=True, eq=False, repr=False)
class BsdfSamples:
    """Directions sampled from the BSDF at surfaces.

    Attributes
    ----------
    direction : (N, 3) float64
        Unit directions in which paths continue; NaN where nothing is scattered.
    weight : (N, 3) float64
        BSDF times cosine over density, the factor of the throughput; 0 where nothing is scattered.
    pdf : (N,) float64
        Density in solid angle; infinite for specular scattering, as by a mirror.

    See Also
    --------
    Interactions.sample_bsdf : Makes it.

    Examples
    --------
    >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> met = rw.Scene(rw.Sphere(material=rw.Mirror(0.9))).interactions(rays)
    >>> mirrored = met.reflected()
    >>> mirrored.direction.tolist(), mirrored.weight.tolist(), mirrored.any.tolist()
    ([[0.0, 0.0, 1.0]], [[0.9, 0.9, 0.9]], [True])
    """

    direction: Floats
    weight: Floats
    pdf: Floats

    @property
    def any(self) -> NDArray[np.bool_]:
        """Mask of points with scattering: (N,) bool."""
        return np.asarray(self.weight.any(axis=1))

    def __len__(self) -> int:
        return len(self.pdf)

    def __repr__(self) -> str:
        return f"BsdfSamples({len(self)})"


@dataclass(frozen=True, eq=False, repr=False)
class LightSamples:
    """Samples of the lights of a scene, as seen from surfaces.

    Attributes
    ----------
    direction : (N, 3) float64
        Unit directions towards the light; NaN where there is none.
    weight : (N, 3) float64
        Radiance over density, without occlusion; 0 where there is no light.
    pdf : (N,) float64
        Density in solid angle; infinite for lights without extent.

    See Also
    --------
    Interactions.sample_light : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(), lights=[rw.PointLight((0, 0, 3), intensity=4.0)])
    >>> rays = rw.query.Rays(np.array([[0, 0, 5.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> light = scene.interactions(rays).sample_light(np.zeros(1), np.full((1, 2), 0.5))
    >>> light.direction.tolist(), light.weight.round(9).tolist()
    ([[0.0, 0.0, 1.0]], [[1.0, 1.0, 1.0]])
    """

    direction: Floats
    weight: Floats
    pdf: Floats
    _segments: tuple[Floats, Floats, Floats]
    _time: Floats

    def visible(self, scene: Occluding, which: ArrayLike | None = None) -> NDArray[np.bool_]:
        """Return whether each sample is unoccluded: (N,) bool.

        Parameters
        ----------
        scene : Scene
            The scene of the lights.
        which : (N,) bool array, optional
            Mask of samples to test; the others are False. By default all with light.

        Returns
        -------
        (N,) bool
            False for samples that are occluded, without light, or not in `which`.

        See Also
        --------
        Scene.occluded : Test any rays.

        Examples
        --------
        >>> lid = rw.Disk((0, 0, 2), radius=0.1)
        >>> scene = rw.Scene([rw.Plane(), lid], lights=[rw.PointLight((0, 0, 3), intensity=4.0)])
        >>> rays = rw.query.Rays(np.array([[0, 0, 1.0], [5, 0, 1]]), np.array([[0, 0, -1.0]] * 2),
        ... np.zeros(2))
        >>> light = scene.interactions(rays).sample_light(np.zeros(2), np.full((2, 2), 0.5))
        >>> light.visible(scene).tolist()
        [False, True]
        """
        asked = self.weight.any(axis=1) if which is None else np.asarray(which, np.bool_)
        origins, directions, most = (part[asked] for part in self._segments)
        result = np.zeros(len(self), np.bool_)
        result[asked] = ~scene.occluded(origins, directions, t_max=most, time=self._time[asked])
        return result

    def __len__(self) -> int:
        return len(self.pdf)

    def __repr__(self) -> str:
        return f"LightSamples({len(self)})"
