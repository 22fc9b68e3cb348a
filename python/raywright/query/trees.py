"""The boxes of a scene's tree."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from ..arrays import sealed


@dataclass(frozen=True, eq=False, repr=False)
class TreeBoxes:
    """The boxes of all nodes of an accelerator, from the root down: `Scene.tree_boxes` makes it.

    Arrays are read-only. A scene of meshes and curved shapes has two trees, and so two roots.

    Attributes
    ----------
    depth : (K,) int32
        Steps from the root, ascending.
    primitives : (K,) int32
        Number of primitives in a leaf; -1 for an inner node.
    corners : (K, 8, 3) float64
        The corners of each box. Bits 0 to 2 of a corner's index are set for the greater end along the first
        to third axis of the tree, which may be rotated against the scene's axes.

    See Also
    --------
    Scene.tree_boxes : Makes it.

    Examples
    --------
    >>> boxes = rw.Scene([rw.Sphere(), rw.Sphere((9, 0, 0))]).tree_boxes()
    >>> boxes.lower[0].round(3).tolist(), boxes.upper[0].round(3).tolist()
    ([-1.0, -1.0, -1.0], [10.0, 1.0, 1.0])
    """

    depth: NDArray[np.int32]
    primitives: NDArray[np.int32]
    corners: NDArray[np.float64]

    @property
    def leaf(self) -> NDArray[np.bool_]:
        """Mask of leaves: (K,) bool."""
        return self.primitives >= 0

    @cached_property
    def lower(self) -> NDArray[np.float64]:
        """Least corner along the scene's own axes: (K, 3) float64."""
        return sealed(self.corners.min(axis=1))

    @cached_property
    def upper(self) -> NDArray[np.float64]:
        """Greatest corner along the scene's own axes: (K, 3) float64."""
        return sealed(self.corners.max(axis=1))

    def at(self, depth: int) -> TreeBoxes:
        """Return the boxes that are `depth` steps from the root.

        Parameters
        ----------
        depth : int
            Steps from the root, 0 for the root itself.

        Returns
        -------
        TreeBoxes

        Examples
        --------
        >>> boxes = rw.Scene(rw.scenes.torus_knot(along=40, around=8)).tree_boxes()
        >>> len(boxes.at(0).depth), bool((boxes.at(2).depth == 2).all())
        (1, True)
        """
        some = slice(*np.searchsorted(self.depth, (depth, depth + 1)))
        return TreeBoxes(self.depth[some], self.primitives[some], self.corners[some])

    def __len__(self) -> int:
        return len(self.depth)

    def __repr__(self) -> str:
        depth = int(self.depth[-1]) if len(self) else 0
        return f"TreeBoxes({len(self)} boxes, {np.count_nonzero(self.leaf)} leaves, depth {depth})"
