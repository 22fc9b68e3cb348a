"""What rays are shot at: meshes that are made here or read from a file, and from where to look at them."""

from typing import NamedTuple

import numpy as np
import trimesh

import raywright as rw

# A room's length, height and depth, in metres.
ROOM = np.array([8.0, 3.0, 5.0])


class Subject(NamedTuple):
    """A mesh, (V,3) vertices and (F,3) faces, with a place for a camera and one for a lamp.

    Vertices are float32, which each engine holds as they are: differences are then of arithmetic alone.
    """

    name: str
    vertices: np.ndarray
    faces: np.ndarray
    eye: np.ndarray
    target: np.ndarray
    lamp: np.ndarray


def seen_from_outside(name, vertices, faces):
    """Return a mesh with camera and lamp outside of the sphere around it."""
    low, high = vertices[faces].min(axis=(0, 1)), vertices[faces].max(axis=(0, 1))
    centre, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    eye = centre + radius * 1.6 * np.array([0.45, 0.5, 0.74])
    lamp = centre + radius * np.array([1.2, 2.2, 0.4])
    return Subject(name, vertices.astype(np.float32), faces, eye, centre, lamp)


def sphere(triangles, rng):
    """Return the icosphere nearest to so many triangles."""
    mesh = trimesh.creation.icosphere(subdivisions=max(round(np.log2(triangles / 20) / 2), 0))
    return seen_from_outside("icosphere", np.array(mesh.vertices), np.array(mesh.faces))


def torus(triangles, rng):
    """Return a torus with a rough surface."""
    n = max(round((triangles / 2) ** 0.5), 3)
    angle = np.arange(n) * 2 * np.pi / n
    u, v = np.meshgrid(angle, angle, indexing="ij")
    radius = 0.4 + 0.4 / n * rng.normal(size=u.shape)
    ring = 1 + radius * np.cos(v)
    vertices = np.stack([ring * np.cos(u), radius * np.sin(v), ring * np.sin(u)], axis=-1).reshape(-1, 3)
    i, j = (x.reshape(-1) for x in np.meshgrid(np.arange(n), np.arange(n), indexing="ij"))
    a, b, c, d = (i % n * n + j % n for i, j in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
    faces = np.concatenate([np.stack([a, c, b], 1), np.stack([a, d, c], 1)])
    return seen_from_outside("noisy torus", vertices, faces)


def room(triangles, rng):
    """Return a closed room, seen from inside, all of long thin boxes: boards, slats and loose beams."""
    count = max(triangles // 12, 8)
    panels = [_boards(axis, end, count // 8) for axis in range(3) for end in (0.0, ROOM[axis])]
    beams = count - 6 * (count // 8)
    # Smaller where there are more, so that in every room a ray sees as far and meets as many of their boxes.
    scale = min((1500 / beams) ** 0.5, 3)
    half = 0.004 * scale * rng.uniform(0.5, 1.5, (beams, 3))
    half[:, 0] = scale * rng.uniform(0.15, 0.75, beams)
    # Most lie along the axes, as what is built does; braces lie at any angle, and fill little of their box.
    turn = np.eye(3)[np.array([[0, 1, 2], [1, 2, 0], [2, 0, 1]])[rng.integers(3, size=beams)]]
    turn[::8] = np.linalg.qr(rng.normal(size=turn[::8].shape))[0]
    loose = rng.uniform(0, 1, (beams, 1, 3)) * ROOM + (_CUBE * half[:, None]) @ turn
    corners = np.concatenate([*panels, loose])
    faces = _CUBE_FACES + 8 * np.arange(len(corners))[:, None, None]
    eye, target, lamp = np.array([[0.05, 0.55, 0.93], [0.7, 0.4, 0.3], [0.55, 0.9, 0.55]]) * ROOM
    vertices = corners.reshape(-1, 3).astype(np.float32)
    return Subject("room", vertices, faces.reshape(-1, 3), eye, target, lamp)


def given(path):
    """Return all triangles of a mesh file: an .npz with `vertices` and `faces`, or what trimesh reads."""
    if path.endswith(".npz"):
        with np.load(path) as arrays:
            return seen_from_outside(path, arrays["vertices"], arrays["faces"].astype(np.int64))
    shapes = rw.Scene(path).shapes
    starts = np.cumsum([0] + [len(s.vertices) for s in shapes])
    vertices = np.concatenate([s.vertices for s in shapes])
    faces = [s.faces.astype(np.int64) + start for s, start in zip(shapes, starts, strict=False)]
    return seen_from_outside(path, vertices, np.concatenate(faces))


#: What `--mesh` calls the meshes that are made here.
MADE = {"sphere": sphere, "torus": torus, "room": room}

_CUBE = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
_QUADS = np.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])
_CUBE_FACES = np.concatenate([_QUADS[:, [0, 1, 2]], _QUADS[:, [0, 2, 3]]])


def _boards(axis, end, count):
    """Return one side of the room, across `axis` at `end`, as (count,8,3) corners of boards side by side."""
    across = (axis + 1) % 3
    centre, half = np.tile(ROOM / 2, (count, 1)), np.tile(ROOM / 2, (count, 1))
    centre[:, axis], half[:, axis] = end, 0.025
    half[:, across] = ROOM[across] / count / 2
    centre[:, across] = (2 * np.arange(count) + 1) * half[:, across]
    return centre[:, None] + _CUBE * half[:, None]
