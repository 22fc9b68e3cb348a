"""What several tests look at."""

import signal

import numpy as np
import pytest
from cornell_picture import cornell_picture

import raywright as rw

# Background jobs of a shell ignore Ctrl-C, and so would its tests, here and in children.
signal.signal(signal.SIGINT, signal.default_int_handler)

CORNERS = [(x, y, z) for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)]
# Anticlockwise from outside; the bits of i are the coordinates of corner i.
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BOX_FACES = [face for a, b, c, d in QUADS for face in ((a, b, c), (a, c, d))]


@pytest.fixture
def box() -> rw.Mesh:
    """The unit cube: 8 vertices, 12 faces, wound so that normals point out."""
    return rw.Mesh(CORNERS, BOX_FACES)


@pytest.fixture
def triangle() -> rw.Mesh:
    """One triangle in the plane z = 0 whose normal is +z."""
    return rw.Mesh([(0.0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)])


@pytest.fixture
def scene(box: rw.Mesh) -> rw.Scene:
    return rw.Scene(box)


@pytest.fixture
def camera() -> rw.Camera:
    return rw.Camera((0.5, 0.5, 4), (0.5, 0.5, 0.5), width=8, height=6)


@pytest.fixture(scope="session")
def cornell() -> tuple[rw.Scene, rw.Camera, np.ndarray]:
    """The Cornell box in 48 by 48 pixels, and how it looks."""
    # Its relMSE is below 3e-6; that of a picture with 64 samples is 3e-3.
    return cornell_picture(48)


@pytest.fixture
def picture() -> rw.Image:
    """A picture of known numbers, 3 wide and 2 high."""
    history = np.array([(0.5, 8, np.nan), (1.0, 16, 0.25), (2.0, 32, 0.125)], rw.rendering.image.HISTORY)
    rgb = np.linspace(0, 1.5, 18, dtype=np.float32).reshape(2, 3, 3)
    return rw.Image(rgb, rgb / 8, rw.rendering.ErrorEstimate(0.125, 0.1, 0.15), history, 2.0, 32)
