"""The rays: what a camera, a diffuse surface, a lamp's shadow and chance ask for."""

from typing import NamedTuple

import numpy as np

import raywright as rw


class Rays(NamedTuple):
    """float32 rays of shape (...,3), how far they go, and whether any hit will do."""

    origins: np.ndarray
    directions: np.ndarray
    t_max: float
    any_hit: bool

    @property
    def count(self):
        """How many rays there are."""
        return self.origins.size // 3


NAMES = ("primary", "diffuse", "random", "shadow any", "diffuse any", "random any")


def ray_sets(scene, subject, side, rng):
    """Return a set of rays for each of `NAMES`.

    `primary` are a pinhole camera's, of shape (side, side, 3). `diffuse` and `shadow` leave from where these
    hit, one for each in the order of the pixels, as a renderer asks for them: in a direction distributed as
    the cosine to the normal, and to the lamp, which is at t = 1. `random` have origins anywhere in a box 1.5
    times that of the mesh and directions anywhere on the sphere.
    """
    corners = subject.vertices[subject.faces]
    low, high = corners.min(axis=(0, 1)), corners.max(axis=(0, 1))
    eye, towards = rw.Camera(subject.eye, subject.target, fov=50, width=side, height=side).rays()
    hits = scene.intersect(eye, towards)
    if not hits.hit.any():
        raise ValueError(f"no primary ray meets {subject.name}")
    normal = hits.normal[hits.hit]
    normal = np.where(np.sum(normal * towards[hits.hit], axis=-1, keepdims=True) > 0, -normal, normal)
    # Off the surface, since engines in single precision would hit it again.
    point = hits.position[hits.hit] + 1e-4 * np.linalg.norm(high - low) / 2 * normal
    # Lambert's law: a point of the unit sphere that touches the surface, seen from the point of contact.
    bounced = unit(normal + unit(rng.normal(size=normal.shape)))
    anywhere = (low + high) / 2 + (high - low) * 1.5 * (rng.random((side * side, 3)) - 0.5)
    everywhere = unit(rng.normal(size=anywhere.shape))
    sets = (
        (eye, towards, np.inf, False),
        (point, bounced, np.inf, False),
        (anywhere, everywhere, np.inf, False),
        (point, subject.lamp - point, 1.0, True),
        (point, bounced, np.inf, True),
        (anywhere, everywhere, np.inf, True),
    )
    return {name: rays(*parts) for name, parts in zip(NAMES, sets, strict=True)}


def rays(origins, directions, t_max, any_hit):
    """Return rays as arrays that every engine takes: float32, C-contiguous, of one shape."""
    arrays = (np.array(a, np.float32, order="C") for a in np.broadcast_arrays(origins, directions))
    return Rays(*arrays, t_max, any_hit)


def unit(vectors):
    """Return (...,3) vectors scaled to length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)
