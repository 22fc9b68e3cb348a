"""Where the meshes of a glTF file stand."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...shapes.mesh import Mesh
from .accessors import Accessors
from .deform import Deform
from .document import Document
from .geometry import Geometry
from .nodes import Matrix, Node, composed
from .part import Part


def meshes(document: Document, nodes: list[Node]) -> Iterator[Mesh]:
    """Yield a mesh for each node and primitive that is of triangles, in the world, in the order of nodes."""
    for made, worlds in stands(document, nodes):
        for world in worlds:
            yield from moved(made, world)


def stands(document: Document, nodes: list[Node]) -> Iterator[tuple[tuple[Mesh, ...], list[Matrix]]]:
    """Yield the meshes of each node that has some, and where they are; all once where they are the same."""
    accessors = Accessors(document)
    geometry = Geometry(document, accessors)
    skins = _Skins(document, accessors, nodes)
    for node in nodes:
        if "mesh" not in node.part:
            continue
        index = geometry.index(node.part)
        deform = None
        weights = _weights(node.part, geometry.weights(index)) if geometry.is_morphed(index) else ()
        joints = skins.joints(node.part) if "skin" in node.part else None
        if joints is not None or any(weights):
            deform = Deform(accessors, weights, joints)
        made = geometry.meshes(index, deform)
        if joints is not None:
            yield made, [np.eye(4)]
        else:
            yield made, _copies(node, accessors)


def moved(made: tuple[Mesh, ...], world: Matrix) -> Iterator[Mesh]:
    """Yield meshes as a matrix takes them to the world."""
    still = np.array_equal(world, np.eye(4))
    for mesh in made:
        yield mesh if still else mesh.transformed(world)


def _weights(node: Part, mesh: Part) -> tuple[float, ...]:
    """Return how much of each shape there is at a node: what it says, or its mesh (3.7.2.2)."""
    told = node if "weights" in node else mesh
    return tuple(told.numbers("weights", None, ()).tolist())


def _copies(node: Node, accessors: Accessors) -> list[Matrix]:
    """Return where copies of a node's mesh stand: one, or those of EXT_mesh_gpu_instancing."""
    part = node.part.extension("EXT_mesh_gpu_instancing")
    if part is None:
        return [node.world]
    attributes = part.part("attributes")
    rest = {"TRANSLATION": (0.0, 0.0, 0.0), "ROTATION": (0.0, 0.0, 0.0, 1.0), "SCALE": (1.0, 1.0, 1.0)}
    given = {
        name: accessors.vectors(attributes, name, len(value)).astype(np.float64)
        for name, value in rest.items()
        if name in attributes
    }
    counts = {len(array) for array in given.values()}
    if len(counts) > 1:
        raise ValueError(f"{attributes.place} must have as many of each")
    count = counts.pop() if counts else 1
    moves, turns, scales = (given.get(name, np.tile(value, (count, 1))) for name, value in rest.items())
    if not turns.any(axis=1).all():
        raise ValueError(f"{attributes.at('ROTATION')} must not be zero")
    return list(node.world @ composed(moves, turns, scales))


class _Skins:
    """Transforms of the joints of each skin, from the nodes."""

    def __init__(self, document: Document, accessors: Accessors, nodes: list[Node]) -> None:
        self._all = document.root.parts("skins")
        self._accessors = accessors
        self._count = len(document.root.parts("nodes"))
        self._worlds = {node.part.index: node.world for node in nodes}

    def joints(self, node: Part) -> Matrix:
        """Return the (J, 4, 4) matrices of a node's skin, from the mesh as it was bound to the world."""
        skin = self._all[node.reference("skin", "skins", len(self._all))]
        joints = skin.references("joints", "nodes", self._count)
        if lost := [joint for joint in joints if joint not in self._worlds]:
            raise ValueError(f"{skin.place} has joint nodes[{lost[0]}], which is not in the scene")
        if not joints:
            raise ValueError(f"{skin.place} has no joints")
        worlds = np.array([self._worlds[joint] for joint in joints])
        if "inverseBindMatrices" not in skin:
            return worlds
        bound = self._accessors.vectors(skin, "inverseBindMatrices", 16).astype(np.float64)
        if len(bound) < len(joints):
            raise ValueError(f"{skin.place} has {len(joints)} joints and {len(bound)} inverseBindMatrices")
        return worlds @ bound[: len(joints)].reshape(-1, 4, 4).transpose(0, 2, 1)
