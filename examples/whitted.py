"""Whitted's ray tracing in Python, on whole batches of rays: python examples/whitted.py picture.png."""

import sys

import numpy as np

import raywright as rw


class Whitted(rw.integrators.Integrator):
    """Lights at every surface, and the reflected or the refracted ray of smooth ones, as `raywright.Whitted`.

    Of the two rays one is followed, drawn by its share: the mean is the same.

    Parameters
    ----------
    max_depth : int
        Greatest number of surfaces that light comes by.
    """

    def __init__(self, max_depth=8):
        self.max_depth = max_depth

    def radiance(self, scene, rays, rng):
        """Advance all rays of the batch together, from surface to surface."""
        result = np.zeros((len(rays), 3))
        alive = np.arange(len(rays))  # of which camera ray each is
        throughput = np.ones((len(rays), 3))
        for bounce in range(self.max_depth + 1):
            here = scene.interactions(rays)
            result[alive] += throughput * here.emission
            alive, throughput, here = alive[here.hit], throughput[here.hit], here[here.hit]
            if bounce == self.max_depth or not len(alive):
                break
            light = here.sample_light(rng.next_1d(alive), rng.next_2d(alive))
            value, _ = here.evaluate(light.direction)
            arriving = throughput * value * light.weight
            result[alive] += arriving * light.visible(scene, arriving.any(axis=1))[:, None]
            # What is scattered into a single direction goes on, and nothing else.
            drawn = here.sample_bsdf(rng.next_1d(alive), rng.next_2d(alive))
            goes_on = drawn.any & np.isinf(drawn.pdf)
            rays = here.spawn_rays(drawn.direction)[goes_on]
            alive, throughput = alive[goes_on], (throughput * drawn.weight)[goes_on]
        return result


if __name__ == "__main__":
    scene, camera = rw.scenes.whitted_spheres(width=320, height=240)
    image = rw.render(scene, camera, Whitted(), samples=32)
    print(image)
    image.save(sys.argv[1] if len(sys.argv) > 1 else "whitted.png")
