"""Copies of instances as shapes of their own, each face of which exchanges light for itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..descriptions import changed
from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene
from ..shapes import Shape
from ..shapes.mesh import Mesh
from ..shapes.shape import affine

Integers = NDArray[np.int64]
# Copy number for faces of an instance that is not copied.
NO_COPY = -1


@dataclass(frozen=True)
class LaidOut:
    """A scene without instances, and the origin of each of its faces in the scene with them.

    Attributes
    ----------
    scene : Scene
        Its faces are numbered as `Instance` does it: shape after shape, and of an instance copy after copy.
    shape, copy, face : (F,) int64
        Of each face: which shape it is of, which copy of that if it is an instance, or else -1, and which
        face of the shape, or of the copy.
    mirrored : (F,) bool
        True if it stands in a mirrored copy, so that its second and third corner changed places.
    counts : (S,) int64
        Number of faces of each shape, with all of its copies.
    """

    scene: Scene
    shape: Integers
    copy: Integers
    face: Integers
    mirrored: NDArray[np.bool_]
    counts: Integers


def laid_out(scene: Scene) -> LaidOut:
    """Return a scene whose instances are laid out as moved copies of their shapes.

    Raises
    ------
    ValueError
        If copies move: their exchange changes with time.
    """
    shapes: list[AnyShape] = []
    shape, copy, face, mirrored = [], [], [], []
    for number, one in enumerate(scene.shapes):
        if isinstance(one, Instance):
            parts = list(_parts(one, np.eye(4), number))
            shapes += [part for part, _ in parts]
            turned = [np.full(_faces(part), is_mirrored) for part, is_mirrored in parts]
            mirrored.append(np.concatenate([np.zeros(0, np.bool_), *turned]))
            copies = np.repeat(np.arange(len(one)), one.primitives)
            within = np.tile(np.arange(one.primitives), len(one))
        else:
            shapes.append(one)
            mirrored.append(np.zeros(_faces(one), np.bool_))
            copies, within = np.full(_faces(one), NO_COPY), np.arange(_faces(one))
        shape.append(np.full(len(within), number))
        copy.append(copies)
        face.append(within)
    has_copies = any(isinstance(one, Instance) for one in scene.shapes)
    nothing = np.zeros(0, np.int64)
    return LaidOut(
        scene.replace(shapes=shapes) if has_copies else scene,
        np.concatenate([nothing, *shape]),
        np.concatenate([nothing, *copy]),
        np.concatenate([nothing, *face]),
        np.concatenate([nothing.astype(np.bool_), *mirrored]),
        np.array([len(part) for part in face], np.int64),
    )


def _faces(shape: AnyShape) -> int:
    return len(shape.faces) if isinstance(shape, Mesh) else 1


def _parts(instance: Instance, outer: NDArray[np.float64], number: int) -> Iterator[tuple[AnyShape, bool]]:
    """Give the shapes of all copies, moved, and whether they are mirrored meshes."""
    if instance.transform_end is not None:
        raise ValueError(
            f"shape {number} has moving copies, whose exchange changes over time: give no transform_end"
        )
    for matrix in instance.transform.reshape(-1, 4, 4):
        whole = outer @ matrix
        for shape in instance.shapes:
            if isinstance(shape, Instance):
                yield from _parts(shape, whole, number)
            elif isinstance(shape, Mesh):
                yield shape.transformed(whole), bool(np.linalg.det(whole[:3, :3]) < 0)
            else:
                yield _moved(shape, whole), False


def _moved(shape: Shape, matrix: NDArray[np.float64]) -> Shape:
    whole = matrix if shape.transform is None else matrix @ shape.transform
    return changed(shape, transform=affine("transform", whole))
