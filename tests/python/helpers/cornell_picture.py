"""The Cornell box with the picture that renders of it tend to."""

from functools import cache
from pathlib import Path

import numpy as np

import raywright as rw

# Its relMSE is below 3e-6. The .rgb of
# rw.render(*rw.scenes.cornell_box(width=48, height=48), rw.Path(reuse=4, guiding="none"), samples=16384,
#           sampler=rw.rendering.Sobol(), seed=10**9)
STORED = Path(__file__).parents[1] / "data" / "cornell_48.npz"


@cache
def cornell_picture(side):
    """Return scene, camera and true picture in `side` by `side` pixels, where 48 is a multiple of `side`."""
    scene, camera = rw.scenes.cornell_box(width=side, height=side)
    with np.load(STORED) as stored:
        pixels = stored["rgb"].astype(float)
    many = 48 // side
    return scene, camera, pixels.reshape(side, many, side, many, 3).mean(axis=(1, 3))
