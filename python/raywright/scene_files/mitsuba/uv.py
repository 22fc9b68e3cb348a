"""Where Mitsuba has a surface's texture coordinates, and where raywright has them."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from .transforms import Matrix


class Uv(NamedTuple):
    """Texture coordinates of a kind of shape, compared with raywright's.

    Attributes
    ----------
    matrix : (3, 3) array
        From raywright's coordinates of a shape to Mitsuba's.
    turned : bool
        True if u and v change places.
    left_handed : bool
        True if u, v and the normal are left-handed, as in Mitsuba.
    """

    matrix: Matrix
    turned: bool = False
    left_handed: bool = False


# Meshes get Mitsuba's coordinates, and cylinders have them already.
SAME = Uv(np.eye(3))
# The latitude starts at the pole on +z.
SPHERE = Uv(np.array([(1.0, 0.0, 0.0), (0.0, -1.0, 1.0), (0.0, 0.0, 1.0)]))
# u is the distance from the center, and v the angle.
DISK = Uv(np.array([(0.0, -1.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]), turned=True)
# Meshes with a left-handed frame of u, v and the normal, such as the cube.
MIRRORED = Uv(np.eye(3), left_handed=True)

# Mitsuba's pictures have their top row at v = 0.
UPRIGHT: Matrix = np.array([(1.0, 0.0, 0.0), (0.0, -1.0, 1.0), (0.0, 0.0, 1.0)])
