"""Queries of light: interactions for integrators written in Python, and photons."""

from __future__ import annotations

from .. import _core
from ..arrays import SeedLike
from .compilable import Compilable
from .interactions import Interactions
from .photons import Photons, photon_arguments
from .ray_batch import Rays


class LightQueries(Compilable):
    """Queries of light at surfaces; the first one compiles the scene."""

    def interactions(self, rays: Rays) -> Interactions:
        """Find the surface interaction of each ray: the hit, with its BSDF and emission.

        It serves integrators written in Python (see `Integrator`): the result has the emission, and samples
        BSDFs and lights for the whole batch.

        Parameters
        ----------
        rays : Rays
            Rays with unit directions, from the arguments of an integrator or from `Interactions.spawn_rays`.

        Returns
        -------
        Interactions
            One entry per ray.

        Raises
        ------
        TypeError
            If `rays` are no `Rays`.
        ValueError
            If their arrays are not (N, 3), (N, 3) and (N,).

        See Also
        --------
        integrators.Integrator : The base class of integrators written in Python.
        Scene.intersect : Hits alone, of rays of any length.

        Examples
        --------
        >>> scene = rw.Scene(rw.Sphere(material=rw.Diffuse(0.8)), environment=1.0)
        >>> rays = rw.query.Rays(np.array([[0, 0, 3.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
        >>> met = scene.interactions(rays)
        >>> met.t.tolist(), met.albedo.round(2).tolist()
        ([2.0], [[0.8, 0.8, 0.8]])
        """
        if not isinstance(rays, Rays):
            raise TypeError(f"rays must be raywright.query.Rays, got {type(rays).__name__}")
        core = self._core or self._compiled()
        return Interactions(_core.interactions(core, rays.origins, rays.directions, rays.time), rays)

    def photons(
        self,
        count: int,
        max_depth: int | None = None,
        roulette_depth: int = 4,
        seed: SeedLike = 0,
        threads: int | None = None,
    ) -> Photons:
        """Trace photons from the lights, and record them at each surface that they reach.

        Paths start at lights chosen by power, at points uniform in area and in cosine-weighted directions.
        Surfaces scatter them until they leave the scene, end by Russian roulette, or reach `max_depth`
        surfaces. Absorption and scattering events in media count as surfaces, and are recorded as well.

        Parameters
        ----------
        count : int
            Number of paths, 1 to 2**31 - 1. Each surface on a path gives a photon of about 200 bytes.
        max_depth : int, optional
            Maximum number of surfaces on a path, at least 1. No limit if not given.
        roulette_depth : int
            Surfaces before Russian roulette begins, at least 0.
        seed : int, Generator or SeedSequence
            Seed of the random numbers, 0 to 2**64 - 1.
        threads : int, optional
            Number of threads; all cores if not given. The answer does not depend on it.

        Returns
        -------
        Photons
            In order of paths, and along each path.

        Raises
        ------
        ValueError
            If a number is out of its range, or no path can start at a light of the scene: infinite emitters,
            emitters that move in instances, light from outside on infinite shapes, or media that glow.
        TypeError
            If a number is not an integer.
        KeyboardInterrupt
            At once, when Ctrl-C is pressed.

        See Also
        --------
        PhotonMap : Renders from photons.

        Examples
        --------
        >>> lamp = rw.PointLight((0, 0, 3), intensity=1.0)
        >>> scene = rw.Scene(rw.Sphere(material=rw.Diffuse(0.5)), lights=[lamp])
        >>> photons = scene.photons(1000, max_depth=1)
        >>> photons.positions.shape[1], np.round(photons.emitted, 4).tolist()
        (3, [12.5664, 12.5664, 12.5664])
        """
        arguments = photon_arguments(count, max_depth, roulette_depth, seed, threads)
        return Photons._of(*_core.photons(self._core or self._compiled(), *arguments))
