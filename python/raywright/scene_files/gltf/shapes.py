"""Shapes of a glTF file: its meshes, transformed by its nodes."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...mesh_files.gltf.document import Document
from ...mesh_files.gltf.nodes import Matrix, Node
from ...mesh_files.gltf.stands import moved, stands
from ...scene.instance import AnyShape, Instance
from ...shapes.mesh import Mesh

# Copies of fewer faces become separate meshes, which are faster to hit; others become instances.
_MANY_FACES = 50_000


def shapes(document: Document, nodes: list[Node]) -> Iterator[AnyShape]:
    """Yield the meshes of `meshes`, with an `Instance` for large ones that stand at several places."""
    together: dict[int, tuple[tuple[Mesh, ...], list[Matrix]]] = {}
    for made, worlds in stands(document, nodes):
        together.setdefault(id(made), (made, []))[1].extend(worlds)
    for made, worlds in together.values():
        faces = sum(len(mesh.faces) for mesh in made)
        alone = [world for world in worlds if _side(world) == 0]
        for side in (1, -1):
            copies = [world for world in worlds if _side(world) == side]
            if (len(copies) - 1) * faces < _MANY_FACES:
                alone += copies
                continue
            # Mirrored meshes have reversed winding, as have their copies.
            mirror = np.diag([side, 1.0, 1, 1])
            yield Instance([*moved(made, mirror)], np.array(copies) @ mirror)
        for world in alone:
            yield from moved(made, world)


def _side(world: Matrix) -> int:
    """Return 1 of a matrix that has an inverse by some margin, -1 if it mirrors too, and 0 of others."""
    linear = world[:3, :3]
    lengths = np.linalg.norm(linear, axis=0)
    volume = float(np.linalg.det(linear / np.where(lengths > 0, lengths, 1)))
    return int(np.sign(volume)) if abs(volume) > 1e-6 else 0
