"""Topology of meshes: defects that keep them from being closed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..query.tabular import Tabular
from ..scene.scene import SceneLike
from .places import Floats, scene_of
from .triangles import triangles


@dataclass(frozen=True, eq=False, repr=False)
class Topology(Tabular):
    """Topology of meshes after welding.

    Attributes
    ----------
    tolerance : float
        Welding distance, in the scene's unit.
    cracks : (K, 2, 3) float64
        Ends of open edges: those that an odd number of faces share.
    t_junctions : (K, 3) float64
        Corners of faces that lie within open edges of other faces. Rays pass there only through gaps by
        rounding.
    volumes : tuple of float
        Volume of each body, a set of connected faces without an open edge; negative if normals point in, NaN
        if the orientation is inconsistent.
    open_faces : int
        Number of faces that are part of no body.
    inner_faces : int
        Number of faces of walls within a body, such as between two chambers.
    turned_edges : int
        Number of edges whose two faces have inconsistent orientation.
    duplicate_faces : int
        Number of faces with the same corners as another.
    degenerate_faces : int
        Number of faces with two corners in one place, or one that is NaN or infinite.

    See Also
    --------
    measure.topology : Makes it.

    Examples
    --------
    >>> lid = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    >>> found = rw.measure.topology(lid)
    >>> found.is_closed, len(found.cracks), found.open_faces
    (False, 3, 1)
    """

    tolerance: float
    cracks: Floats
    t_junctions: Floats
    volumes: tuple[float, ...]
    open_faces: int
    inner_faces: int
    turned_edges: int
    duplicate_faces: int
    degenerate_faces: int

    @property
    def is_closed(self) -> bool:
        """True if all faces are part of a body."""
        return bool(self.volumes) and not self.open_faces

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return the counts by name, and the tolerance, as arrays of one entry.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> lid = rw.Mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
        >>> rw.measure.topology(lid).to_dict()["cracks"].tolist()
        [3]
        """
        counts = {"bodies": len(self.volumes), "cracks": len(self.cracks)}
        counts["t_junctions"] = len(self.t_junctions)
        for kind in ("open_faces", "inner_faces", "turned_edges", "duplicate_faces", "degenerate_faces"):
            counts[kind] = getattr(self, kind)
        columns: dict[str, NDArray[Any]] = {name: np.array([count]) for name, count in counts.items()}
        return columns | {"tolerance": np.array([self.tolerance])}

    def __repr__(self) -> str:
        return (
            f"Topology({len(self.volumes)} bodies, {self.open_faces} faces in no body, "
            f"{self.inner_faces} inner faces, "
            f"{len(self.cracks)} cracks, "
            f"{len(self.t_junctions)} T-junctions, {self.turned_edges} turned edges, "
            f"{self.duplicate_faces} duplicate and {self.degenerate_faces} degenerate faces)"
        )


def topology(scene: SceneLike) -> Topology:
    """Find the defects that keep meshes from being closed: cracks, T-junctions, turned and duplicate faces.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Meshes, and static copies of them, joined to one. Corners are welded by ``Scene(weld=)``.

    Returns
    -------
    Topology

    Raises
    ------
    ValueError
        If something in the scene is not a mesh or moves; the error names the shape.

    See Also
    --------
    Scene.welded : Merge corners that differ by rounding.
    Scene.contains : Needs closed shapes.

    Examples
    --------
    >>> import trimesh
    >>> box = trimesh.creation.box((2, 2, 2))
    >>> found = rw.measure.topology(box)
    >>> found.is_closed, [round(volume, 9) for volume in found.volumes]
    (True, [8.0])
    """
    whole = scene_of(scene)
    corners, faces, tolerance = triangles(whole, whole._tolerance)
    found = _core.mesh_topology(corners, faces, tolerance)
    pairs = zip(found.volumes, found.is_oriented, strict=True)
    return Topology(
        tolerance=found.tolerance,
        cracks=corners[np.array(found.cracks, np.int64).reshape(-1, 2)],
        t_junctions=corners[np.array(found.junctions, np.int64)],
        volumes=tuple(volume if is_oriented else np.nan for volume, is_oriented in pairs),
        open_faces=found.open,
        inner_faces=found.inner,
        turned_edges=found.turned,
        duplicate_faces=found.duplicates,
        degenerate_faces=found.degenerate,
    )
