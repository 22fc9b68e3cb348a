"""Where Mitsuba has a surface's texture coordinates, and where raywright has them."""

from typing import NamedTuple

import numpy as np

from .transforms import Matrix


class Uv(NamedTuple):
    """How texture coordinates of a kind of shape differ.

    Attributes
    ----------
    matrix : (3, 3) array
        From raywright's coordinates of a shape to Mitsuba's.
    turned : bool
        Whether u and v change places.
    left_handed : bool
        Whether u, v and the normal are left-handed, as Mitsuba has them.
    """

    matrix: Matrix
    turned: bool = False
    left_handed: bool = False


# Meshes are given Mitsuba's coordinates, and cylinders have them.
SAME = Uv(np.eye(3))
# The latitude counts from the pole on +z.
SPHERE = Uv(np.array([(1.0, 0.0, 0.0), (0.0, -1.0, 1.0), (0.0, 0.0, 1.0)]))
# u is the distance from the centre and v the angle.
DISK = Uv(np.array([(0.0, -1.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)]), turned=True)
# Faces of meshes on which u, v and the normal are left-handed, as on all of the cube.
MIRRORED = Uv(np.eye(3), left_handed=True)

# Mitsuba's pictures have their top row at v = 0.
UPRIGHT: Matrix = np.array([(1.0, 0.0, 0.0), (0.0, -1.0, 1.0), (0.0, 0.0, 1.0)])
