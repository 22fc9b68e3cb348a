"""Deformation of the meshes of a glTF file at rest: skins and blended shapes (glTF 2.0, 3.7)."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .accessors import Accessors
from .part import Part

Array = NDArray[np.floating[Any]]


class Deform(NamedTuple):
    """Deformation of one node's mesh.

    Attributes
    ----------
    accessors : Accessors
        The arrays of the file.
    weights : tuple of float
        Weight of each blended shape (3.7.2.2).
    joints : (J, 4, 4) array, optional
        From the mesh as it was bound to a skin to the world, one matrix a joint (3.7.3); None without a skin.
    """

    accessors: Accessors
    weights: tuple[float, ...]
    joints: NDArray[np.float64] | None

    @property
    def linear(self) -> NDArray[np.float64]:
        """The linear maps that vertices are taken through, (..., 3, 3)."""
        return np.eye(3) if self.joints is None else self.joints[:, :3, :3]

    def applied(self, primitive: Part, vertices: Array, normals: Array | None) -> tuple[Array, Array | None]:
        """Return vertices and normals as they are when bent."""
        for target, weight in zip(primitive.parts("targets"), self.weights, strict=False):
            if weight:
                vertices = self._moved(target, "POSITION", vertices, weight)
                normals = None if normals is None else self._moved(target, "NORMAL", normals, weight)
        if self.joints is None:
            return vertices, normals
        blended = self._blended(primitive.part("attributes"), len(vertices), self.joints)
        if blended is None:
            return vertices, normals
        linear = blended[:, :3, :3]
        if normals is not None:
            normals = np.einsum("nij,nj->ni", _cofactors(linear), normals)
            length = np.linalg.norm(normals, axis=1, keepdims=True)
            normals = np.divide(normals, length, out=np.zeros_like(normals), where=length > 0)
        return np.einsum("nij,nj->ni", linear, vertices) + blended[:, :3, 3], normals

    def _moved(self, target: Part, name: str, given: Array, weight: float) -> Array:
        if name not in target:
            return given
        by = self.accessors.vectors(target, name, 3)
        if len(by) != len(given):
            raise ValueError(f"{target.at(name)} moves {len(by)} vertices of {len(given)}")
        return given + weight * by.astype(np.float64)

    def _blended(
        self, attributes: Part, count: int, joints: NDArray[np.float64]
    ) -> NDArray[np.float64] | None:
        """Return the matrix of each vertex: those of its joints by their weights."""
        result = np.zeros((count, 4, 4))
        total = np.zeros(count)
        number = 0
        while (name := f"JOINTS_{number}") in attributes:
            which = self.accessors.integers(attributes, name, 4)
            share = self.accessors.vectors(attributes, f"WEIGHTS_{number}", 4).astype(np.float64)
            if not len(which) == len(share) == count:
                raise ValueError(f"{attributes.at(name)} must have one element a vertex")
            if which.max() >= len(joints):
                raise ValueError(f"{attributes.at(name)} names joint {which.max()} of {len(joints)}")
            for column in range(4):
                result += share[:, column, None, None] * joints[which[:, column]]
            total += share.sum(axis=1)
            number += 1
        if not number:
            return None
        # Rounded weights do not quite add up to 1. Vertices without joints keep their bind pose.
        free = total <= 0
        result[free], total[free] = np.eye(4), 1
        return result / total[:, None, None]


def _cofactors(matrices: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return what (N, 3, 3) matrices do to normals: as faces turn, and without a division."""
    x, y, z = matrices.transpose(1, 0, 2)
    return np.stack([np.cross(y, z), np.cross(z, x), np.cross(x, y)], axis=1)
