"""Surface interactions of ray batches, for integrators written in Python."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from .ray_batch import Floats, Rays, numbers, vectors
from .scattering_samples import BsdfSamples, LightSamples


class Interactions:
    """Surface interactions of a batch of rays: one entry per ray. Made by `Scene.interactions`.

    Arrays are float64 and read-only, NaN for misses unless said otherwise. Indexing with a mask or with
    indices gives a part of the batch.

    See Also
    --------
    Scene.interactions : Makes it.
    Hits : The geometry of hits alone.

    Examples
    --------
    >>> scene = rw.Scene(rw.Plane(material=rw.Diffuse(0.5)), environment=2.0)
    >>> rays = rw.query.Rays(np.array([[0, 0, 1.0]] * 2), np.array([[0, 0, -1.0], [0, 0, 1]]), np.zeros(2))
    >>> met = scene.interactions(rays)
    >>> met.hit.tolist(), met.emission[:, 0].tolist()
    ([True, False], [0.0, 2.0])
    >>> met[met.hit].position.tolist()
    [[0.0, 0.0, 0.0]]
    """

    def __init__(self, core: _core.Interactions, rays: Rays) -> None:
        self._core = core
        self.rays = rays

    def __len__(self) -> int:
        return len(self._core)

    def __getitem__(self, which: ArrayLike) -> Interactions:
        index = np.asarray(which)
        if index.dtype == np.bool_:
            if index.shape != (len(self),):
                raise IndexError(f"a mask must have shape ({len(self)},), got {index.shape}")
            index = np.flatnonzero(index)
        index = np.ascontiguousarray(index, np.int64)
        return Interactions(self._core.take(index), self.rays[index])

    @cached_property
    def t(self) -> Floats:
        """Distance from the ray's origin: (N,); infinite for a miss."""
        return self._core.t

    @cached_property
    def hit(self) -> NDArray[np.bool_]:
        """Mask of rays that hit something: (N,) bool."""
        return self.shape_id >= 0

    @cached_property
    def shape_id(self) -> NDArray[np.int32]:
        """Which of ``scene.shapes``: (N,) int32; -1 for a miss."""
        return self._core.shape_id

    @cached_property
    def primitive_id(self) -> NDArray[np.int32]:
        """Face of that shape: (N,) int32; -1 for a miss."""
        return self._core.primitive_id

    @cached_property
    def uv(self) -> Floats:
        """Surface coordinates, as `Hits.uv`: (N, 2)."""
        return self._core.uv

    @cached_property
    def position(self) -> Floats:
        """Position of the hit: (N, 3)."""
        return self._core.position

    @cached_property
    def normal(self) -> Floats:
        """Unit geometric normal on the side that the ray came from: (N, 3)."""
        return self._core.normal

    @cached_property
    def shading_normal(self) -> Floats:
        """Unit shading normal on the side that the ray came from: (N, 3)."""
        return self._core.shading_normal

    @cached_property
    def emission(self) -> Floats:
        """Radiance along the ray that nothing has scattered: (N, 3); of a miss, that of the environment."""
        return self._core.emission

    @cached_property
    def albedo(self) -> Floats:
        """About the share of white light that is scattered, by color: (N, 3)."""
        return self._core.albedo

    @cached_property
    def ior(self) -> Floats:
        """Index of refraction inside the shape: (N,); 1 for shapes that enclose nothing."""
        return self._core.ior

    def reflected(self) -> BsdfSamples:
        """Return the specular reflection of mirrors and smooth glass.

        Returns
        -------
        BsdfSamples
            One direction for each ray, with its weight: the share of light from there that is reflected along
            the ray, by Fresnel's equations for glass. Weight 0 and NaN without specular reflection.

        See Also
        --------
        Interactions.refracted : Specular transmission.

        Examples
        --------
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = rw.Scene(rw.Sphere(material=rw.Dielectric(1.5))).interactions(rays)
        >>> met.reflected().weight.round(4).tolist()
        [[0.04, 0.04, 0.04]]
        """
        return BsdfSamples(*self._core.single(False))

    def refracted(self) -> BsdfSamples:
        """Return the specular transmission of smooth glass and panes.

        Returns
        -------
        BsdfSamples
            As in `reflected`, on the other side. Weights are for radiance, and include the square of the
            relative index of refraction.

        See Also
        --------
        Interactions.reflected : Specular reflection.

        Examples
        --------
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = rw.Scene(rw.Sphere(material=rw.Dielectric(1.5))).interactions(rays)
        >>> met.refracted().direction.tolist(), (met.refracted().weight * 1.5**2).round(4).tolist()
        ([[0.0, 0.0, -1.0]], [[0.96, 0.96, 0.96]])
        """
        return BsdfSamples(*self._core.single(True))

    def evaluate(self, directions: ArrayLike) -> tuple[Floats, Floats]:
        """Evaluate the BSDF for light from given directions, scattered back along the rays.

        Parameters
        ----------
        directions : (N, 3) array
            Unit directions towards the light.

        Returns
        -------
        value : (N, 3)
            BSDF times cosine; 0 for misses, and for specular scattering.
        pdf : (N,)
            The density, in solid angle, with which `sample_bsdf` draws the direction.

        See Also
        --------
        Interactions.sample_bsdf : Draw directions with this density.

        Examples
        --------
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = rw.Scene(rw.Plane(material=rw.Diffuse(0.5))).interactions(rays)
        >>> value, pdf = met.evaluate(np.array([[0, 0, 1.0]]))
        >>> (value * np.pi).round(6).tolist(), (pdf * np.pi).round(6).tolist()
        ([[0.5, 0.5, 0.5]], [1.0])
        """
        return self._core.evaluate(vectors("directions", directions))

    def sample_bsdf(self, choice: Floats, u: Floats) -> BsdfSamples:
        """Sample directions from the BSDF at the points.

        Parameters
        ----------
        choice : (N,) array
            Numbers in [0, 1) that choose among lobes.
        u : (N, 2) array
            Pairs of numbers in (0, 1) for the direction.

        Returns
        -------
        BsdfSamples
            One direction for each ray.

        See Also
        --------
        Interactions.evaluate : The value and the density of given directions.

        Examples
        --------
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = rw.Scene(rw.Plane(material=rw.Diffuse(0.5))).interactions(rays)
        >>> drawn = met.sample_bsdf(np.array([0.5]), np.array([[0.25, 0.75]]))
        >>> drawn.weight.round(6).tolist(), bool(drawn.direction[0, 2] > 0)
        ([[0.5, 0.5, 0.5]], True)
        """
        return BsdfSamples(*self._core.sample_bsdf(numbers("choice", choice), numbers("u", u)))

    def sample_light(self, choice: Floats, u: Floats) -> LightSamples:
        """Sample light that reaches the points from the scene's lights.

        Parameters
        ----------
        choice : (N,) array
            Numbers in [0, 1) that choose among the lights.
        u : (N, 2) array
            Pairs of numbers in (0, 1) for the point on the light.

        Returns
        -------
        LightSamples
            One sample for each ray.

        See Also
        --------
        LightSamples.visible : Test whether the light arrives.
        Interactions.light_pdf : The density of hits on emitters.

        Examples
        --------
        >>> scene = rw.Scene(rw.Plane(), lights=[rw.PointLight((0, 0, 2), intensity=8.0)])
        >>> rays = rw.query.Rays(np.array([[0, 0, 1.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = scene.interactions(rays)
        >>> light = met.sample_light(np.zeros(1), np.full((1, 2), 0.5))
        >>> value, _ = met.evaluate(light.direction)
        >>> (value * light.weight * np.pi).round(6).tolist()
        [[1.0, 1.0, 1.0]]
        """
        (direction, weight, origins, ways), most, pdf = self._core.sample_light(
            numbers("choice", choice), numbers("u", u)
        )
        return LightSamples(direction, weight, pdf, (origins, ways, most), self.rays.time)

    def light_pdf(self, before: Interactions) -> Floats:
        """Return the density of `sample_light` at the emitters that the rays hit: (N,).

        Parameters
        ----------
        before : Interactions
            Surfaces that the rays leave, an entry for each ray.

        Returns
        -------
        (N,) float64
            In solid angle; 0 where the rays hit no emitter.

        See Also
        --------
        power_heuristic : Weights of the two strategies.

        Examples
        --------
        >>> lamp = rw.Disk((0, 0, 2), normal=(0, 0, -1), radius=0.5, emission=3.0)
        >>> scene = rw.Scene([rw.Plane(), lamp])
        >>> down = rw.query.Rays(np.array([[0, 0, 1.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> floor = scene.interactions(down)
        >>> found = scene.interactions(floor.spawn_rays(np.array([[0, 0, 1.0]])))
        >>> bool(found.light_pdf(floor)[0] > 0)
        True
        """
        return self._core.light_pdf(before._core)

    def spawn_rays(self, directions: ArrayLike) -> Rays:
        """Return rays that leave in given unit directions, (N, 3), without hitting the same surface.

        Parameters
        ----------
        directions : (N, 3) array
            Unit directions.

        Returns
        -------
        Rays
            One entry per ray; NaN origins for misses.

        See Also
        --------
        Hits.spawn_rays : The same for hits, with broadcast directions.

        Examples
        --------
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = rw.Scene(rw.Plane()).interactions(rays)
        >>> met.spawn_rays(np.array([[0, 0, 1.0]])).origins.round(9).tolist()
        [[0.0, 0.0, 0.0]]
        """
        ways = vectors("directions", directions)
        return Rays(self._core.spawn_rays(ways), ways, self.rays.time)

    def __repr__(self) -> str:
        return f"Interactions({len(self)}, {int(np.count_nonzero(self.hit))} hit)"
