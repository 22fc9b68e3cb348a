"""A torus knot: a smooth closed mesh with bumps, shadows and light that bounces between its strands."""

from __future__ import annotations

import numpy as np

from ..arrays import integer, positive
from ..materials import Material
from ..shapes.mesh import Mesh


def torus_knot(
    p: int = 2,
    q: int = 3,
    along: int = 400,
    around: int = 25,
    tube: float = 0.3,
    material: Material | None = None,
) -> Mesh:
    """Return a closed tube along a torus knot, wound anticlockwise from outside, with smooth normals.

    The knot lies around the z axis, with radii 1 and 0.45 of its torus.

    Parameters
    ----------
    p, q : int
        Turns around the axis, and around the ring; 2 and 3 are the trefoil.
    along, around : int
        Quadrilaterals along the knot and around the tube, at least 3 each; two triangles for each.
    tube : float
        Radius of the tube.
    material : Material, optional
        ``Diffuse()`` if not given.

    Returns
    -------
    Mesh

    Raises
    ------
    ValueError
        If a number is out of its range.
    TypeError
        If a number is of the wrong type.

    See Also
    --------
    scenes.teapot : Another test object.

    Examples
    --------
    >>> knot = rw.scenes.torus_knot(along=40, around=8)
    >>> knot.faces.shape, rw.measure.topology(knot).is_closed
    ((640, 3), True)
    """
    p, q = integer("p", p, 1), integer("q", q, 1)
    along, around = integer("along", along, 3), integer("around", around, 3)
    tube = positive("tube", tube)
    phi = np.arange(along) * (2 * np.pi / along)
    ring, wave = 1 + 0.45 * np.cos(q * phi), 0.45 * np.sin(q * phi)
    turn = np.exp(1j * p * phi)
    # Position, velocity and acceleration along the knot; x + iy is one complex number.
    plane = ring * turn
    plane1 = (-q * wave + 1j * p * ring) * turn
    plane2 = (-q * q * (ring - 1) - 2j * p * q * wave - p * p * ring) * turn
    center = np.stack([plane.real, plane.imag, wave], axis=1)
    velocity = np.stack([plane1.real, plane1.imag, q * (ring - 1)], axis=1)
    acceleration = np.stack([plane2.real, plane2.imag, -q * q * wave], axis=1)

    # The Frenet frame depends on the curve alone, so the last ring meets the first without a twist.
    tangent = velocity / np.linalg.norm(velocity, axis=1, keepdims=True)
    binormal = np.cross(velocity, acceleration)
    binormal /= np.linalg.norm(binormal, axis=1, keepdims=True)
    normal = np.cross(binormal, tangent)
    theta = (np.arange(around) * (2 * np.pi / around))[:, np.newaxis]
    outward = np.cos(theta) * normal[:, np.newaxis] + np.sin(theta) * binormal[:, np.newaxis]
    vertices = center[:, np.newaxis] + tube * outward

    i, j = np.meshgrid(np.arange(along), np.arange(around), indexing="ij")
    i1, j1 = (i + 1) % along, (j + 1) % around
    a, b, c, d = (x * around + y for x, y in ((i, j), (i1, j), (i1, j1), (i, j1)))
    faces = np.stack([np.stack([a, c, b], axis=-1), np.stack([a, d, c], axis=-1)], axis=2)
    return Mesh(vertices.reshape(-1, 3), faces.reshape(-1, 3), outward.reshape(-1, 3), material=material)
