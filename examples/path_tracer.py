"""A path tracer written in Python, on whole batches of rays: python examples/path_tracer.py picture.png."""

import sys

import numpy as np

import raywright as rw


class PathTracer(rw.integrators.Integrator):
    """Next-event estimation, multiple importance sampling and Russian roulette, as `Path` has them."""

    def radiance(self, scene, rays, rng):
        """Advance all paths of the batch together, a bounce at a time."""
        result = np.zeros((len(rays), 3))
        alive = np.arange(len(rays))  # of which ray each path is
        throughput = np.ones((len(rays), 3))
        pdf, before, bounce = np.full(len(rays), np.inf), None, 0
        while len(alive):
            here = scene.interactions(rays)
            # What the path has run into, beside what asking a light would have found.
            light_pdf = here.light_pdf(before) if before else 0.0
            weight = rw.query.power_heuristic(pdf, light_pdf)
            result[alive] += throughput * here.emission * weight[:, None]
            alive, throughput, here = alive[here.hit], throughput[here.hit], here[here.hit]

            # One light is asked directly.
            light = here.sample_light(rng.next_1d(alive), rng.next_2d(alive))
            value, scatter_pdf = here.evaluate(light.direction)
            arriving = throughput * value * light.weight
            arriving *= rw.query.power_heuristic(light.pdf, scatter_pdf)[:, None]
            result[alive] += arriving * light.visible(scene, arriving.any(axis=1))[:, None]

            # Where the path goes on to, if roulette lets it.
            drawn = here.sample_bsdf(rng.next_1d(alive), rng.next_2d(alive))
            throughput = throughput * drawn.weight
            survival = np.ones(len(alive))
            if bounce >= 3:
                survival = np.minimum(np.sqrt(throughput.max(axis=1)), 0.999)
            goes_on = drawn.any & (rng.next_1d(alive) < survival)
            throughput = (throughput / np.maximum(survival, 1e-300)[:, None])[goes_on]
            rays, alive, before = here.spawn_rays(drawn.direction)[goes_on], alive[goes_on], here[goes_on]
            pdf, bounce = drawn.pdf[goes_on], bounce + 1
        return result


if __name__ == "__main__":
    scene, camera = rw.scenes.cornell_box(width=256, height=256)
    image = rw.render(scene, camera, PathTracer(), samples=64)
    print(image)
    image.save(sys.argv[1] if len(sys.argv) > 1 else "path_tracer.png")
