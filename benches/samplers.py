"""Samplers on the scenes of `render_peers.py`: what of the error of independent samples is left.

    python benches/samplers.py [--scene NAME ...] [--side 128] [--samples 16 64 256] [--batch 4 64]

Of every picture the relMSE is taken against a long one of other seeds; what that has of noise itself is
taken off. It does not tell how errors lie beside each other: seeds that make them blue noise over the
picture change no pixel's error.
"""

import argparse
import math
from itertools import product

import numpy as np
from render_peers import relmse, scenes

import raywright as rw

KINDS = (rw.rendering.Stratified, rw.rendering.Halton, rw.rendering.Sobol, rw.rendering.Lattice)


def errors(make, arguments):
    """RelMSE by (samples, sampler), its mean over seeds."""
    scene, camera, depth = make()

    def render(samples, seed, sampler):
        image = rw.render(
            scene, camera, rw.Path(depth), samples=samples, seed=seed, sampler=sampler, progress=False
        )
        return image.rgb.astype(np.float64)

    halves = [render(arguments.reference // 2, 10**6 + half, rw.rendering.Sobol(64)) for half in range(2)]
    reference = sum(halves) / 2
    # The halves differ by twice the variance of either; their mean has half of it.
    noise = relmse(halves[0], halves[1]) / 4
    for samples in arguments.samples:
        batched = (kind(min(batch, samples)) for batch, kind in product(arguments.batch, KINDS))
        for sampler in dict.fromkeys((rw.rendering.Independent(), *batched)):
            told = [relmse(render(samples, seed, sampler), reference) for seed in range(arguments.repeat)]
            yield samples, sampler, np.mean(told) - noise


def main():
    """Render and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    known = scenes(None, 0)
    parser.add_argument("--scene", action="append", choices=known, help="which; all if not given")
    parser.add_argument("--side", type=int, default=128, help="pixels on a side")
    parser.add_argument("--samples", type=int, nargs="+", default=[16, 64, 256], help="of each pixel")
    parser.add_argument("--batch", type=int, nargs="+", default=[4, 64], help="samples placed together")
    parser.add_argument("--reference", type=int, default=4096, help="samples of the long picture")
    parser.add_argument("--repeat", type=int, default=2, help="seeds")
    arguments = parser.parse_args()
    known, rows = scenes(None, arguments.side), {}
    for name in arguments.scene or known:
        for samples, sampler, error in errors(known[name], arguments):
            if isinstance(sampler, rw.rendering.Independent):
                alone = error
                print(f"{name}, {samples} samples: relMSE {alone:.2e} with independent ones", flush=True)
            else:
                rows.setdefault((samples, sampler), {})[name] = error / alone
    names = arguments.scene or list(known)
    print("\nRelMSE over that of independent samples; the last column is the geometric mean.\n")
    print("| samples | sampler | " + " | ".join(names) + " | all |\n|---|---|" + "---|" * (len(names) + 1))
    for (samples, sampler), ratios in rows.items():
        mean = math.prod(ratios.values()) ** (1 / len(ratios))
        cells = " | ".join(f"{ratios[name]:.2f}" for name in names)
        kind = f"{type(sampler).__name__}({sampler.batch})"
        print(f"| {samples} | {kind} | {cells} | {mean:.2f} |")


if __name__ == "__main__":
    main()
