"""Nodes of a glTF file: their transforms and contents (glTF 2.0, 3.5)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .document import Document
from .part import Part

Matrix = NDArray[np.float64]


class Node(NamedTuple):
    """One node of the scene.

    Attributes
    ----------
    part : Part
        Its JSON object.
    world : (4, 4) array
        From its own space to the world.
    """

    part: Part
    world: Matrix


def placed(document: Document) -> list[Node]:
    """Return the nodes of the file's scene, each before its children, in the order of the file.

    Raises
    ------
    ValueError
        If they do not form a tree, or a transform has no finite numbers.
    """
    parts = document.root.parts("nodes")
    children = [part.references("children", "nodes", len(parts)) for part in parts]
    left = [(root, np.eye(4)) for root in reversed(_roots(document, children))]
    seen = np.zeros(len(parts), np.bool_)
    found = []
    while left:
        index, parent = left.pop()
        if seen[index]:
            raise ValueError(f"nodes[{index}] is reached twice: nodes must be a tree")
        seen[index] = True
        with np.errstate(over="ignore", invalid="ignore"):
            world = parent @ local(parts[index])
        if not np.isfinite(world).all():
            raise ValueError(f"nodes[{index}] has a transform that is not finite in the world")
        found.append(Node(parts[index], world))
        left += [(child, world) for child in reversed(children[index])]
    return found


def _roots(document: Document, children: list[list[int]]) -> list[int]:
    scenes = document.root.parts("scenes")
    if scenes:
        which = document.root.reference("scene", "scenes", len(scenes)) if "scene" in document.root else 0
        return scenes[which].references("nodes", "nodes", len(children))
    held = {child for some in children for child in some}
    return [index for index in range(len(children)) if index not in held]


def local(part: Part) -> Matrix:
    """Return the matrix from a node's space to its parent's: its matrix, or its parts (3.5.2)."""
    if "matrix" in part:
        matrix = part.numbers("matrix", 16).reshape(4, 4).T
        if matrix[3].tolist() != [0, 0, 0, 1]:
            row = ", ".join(f"{x:g}" for x in matrix[3])
            raise ValueError(f"{part.at('matrix')} must have (0, 0, 0, 1) as its last row, and has ({row})")
        return matrix
    turn = part.numbers("rotation", 4, (0.0, 0.0, 0.0, 1.0))
    if not turn.any():
        raise ValueError(f"{part.at('rotation')} must not be zero")
    matrix = composed(
        part.numbers("translation", 3, (0.0, 0.0, 0.0))[np.newaxis],
        turn[np.newaxis],
        part.numbers("scale", 3, (1.0, 1.0, 1.0))[np.newaxis],
    )
    return np.asarray(matrix[0])


def composed(translation: Matrix, rotation: Matrix, scale: Matrix) -> Matrix:
    """Return (N, 4, 4) matrices that scale, then turn, then move.

    Parameters
    ----------
    translation, scale : (N, 3) arrays
        By how much.
    rotation : (N, 4) array
        Quaternions x, y, z, w of any length but 0.
    """
    rotation = rotation / np.abs(rotation).max(axis=1, keepdims=True)
    x, y, z, w = (rotation / np.linalg.norm(rotation, axis=1, keepdims=True)).T
    # Shoemake, "Animating Rotation with Quaternion Curves" (1985).
    turned = np.array(
        [
            (1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)),
            (2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)),
            (2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)),
        ]
    )
    result = np.zeros((len(rotation), 4, 4))
    result[:, :3, :3] = turned.transpose(2, 0, 1) * scale[:, np.newaxis]
    result[:, :3, 3] = translation
    result[:, 3, 3] = 1
    return result
