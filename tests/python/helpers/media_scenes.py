"""Scenes and cameras of tests of media."""

import math

import numpy as np
from long_runs import error_of_part, part

import raywright as rw

FLAT = 1000.0


def slab(medium, thickness=1.0):
    """A layer that is so wide that its edges are not seen, its top at the height 0."""
    low, high = (-FLAT, -FLAT, -thickness), (FLAT, FLAT, 0)
    return rw.Box(low, high, material=rw.MediumInterface(medium))


def of_depth(depth, albedo, g=0.0, length=1.0):
    """Return a medium of an optical depth over a length."""
    extinction = depth / length
    phase = rw.HenyeyGreenstein(g) if g else rw.media.Isotropic()
    return rw.Homogeneous((1 - albedo) * extinction, albedo * extinction, phase)


def looking(cosine=1.0, side=8, below=False, distance=0.5, azimuth=0.0):
    """Parallel rays that come down to the origin, or up to one below it, at an angle to the vertical."""
    sine = math.sqrt(1 - cosine**2)
    turn = math.radians(azimuth)
    way = np.array([sine * math.cos(turn), sine * math.sin(turn), cosine if below else -cosine])
    return rw.Orthographic(
        -way * distance, direction=way, up=(0, 1, 1e-3), scale=1e-3, width=side, height=side
    )


def seen(scene, camera, samples, integrator=None, seed=0):
    """Mean of a picture of one color, and its standard error, from pixels that are independent."""
    alone = integrator or rw.Path(reuse=1)
    image = rw.render(scene, camera, alone, samples, seed=seed, progress=False)
    values = image.rgb.astype(float)[..., 1].ravel()
    return values.mean(), values.std(ddof=1) / math.sqrt(values.size)


def assert_seen(scene, camera, samples, expected, integrator=None, most=0.002, share=1):
    """Within three standard errors, which chance exceeds once in 370, of at most 0.2 %; the seed is fixed."""
    mean, error = seen(scene, camera, part(samples, share), integrator)
    most = error_of_part(most, share)
    print(f"{mean:.6f} ± {error:.6f}, {expected:.6f}: {(mean - expected) / (error + 1e-300):+.2f}")
    # Pictures are float32.
    assert abs(mean - expected) <= 3 * error + 1e-6 * expected, (mean, error, expected)
    assert error <= most * expected, (error / expected, most)
