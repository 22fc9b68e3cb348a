"""What rays are shot at: meshes that are made here or read from a file, and from where to look at them."""

from typing import NamedTuple

import numpy as np
import trimesh

import raywright as rw
from raywright.scenes.room import EYE, LAMP, TARGET


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
    center, radius = (low + high) / 2, np.linalg.norm(high - low) / 2
    eye = center + radius * 1.6 * np.array([0.45, 0.5, 0.74])
    lamp = center + radius * np.array([1.2, 2.2, 0.4])
    return Subject(name, vertices.astype(np.float32), faces, eye, center, lamp)


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
    """Return the package's closed room of long thin boxes, seen from inside."""
    (mesh,) = rw.scenes.room(triangles)
    return Subject("room", mesh.vertices, mesh.faces.astype(np.int64), EYE, TARGET, LAMP)


def triangle(triangles, rng):
    """Return one triangle, however many are asked for."""
    vertices = np.array([[-1.0, -0.7, 0.2], [1.1, -0.5, -0.1], [0.1, 1.0, 0.0]])
    return seen_from_outside("triangle", vertices, np.array([[0, 1, 2]]))


def box(triangles, rng):
    """Return the twelve triangles of a box, however many are asked for."""
    mesh = trimesh.creation.box((2.0, 1.0, 1.5))
    return seen_from_outside("box", np.array(mesh.vertices), np.array(mesh.faces))


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


def turned(subject, digits):
    """Return the subject turned by a rotation in no special position, with vertices of so many digits."""
    rotation = np.linalg.qr(np.random.default_rng(11).normal(size=(3, 3)))[0]
    vertices = (subject.vertices.astype(np.float64) @ rotation.T).astype(digits)
    return subject._replace(
        name=f"{subject.name}, turned",
        vertices=vertices,
        eye=rotation @ subject.eye,
        target=rotation @ subject.target,
        lamp=rotation @ subject.lamp,
    )


#: What `--mesh` calls the meshes that are made here.
MADE = {"sphere": sphere, "torus": torus, "room": room, "box": box, "triangle": triangle}
