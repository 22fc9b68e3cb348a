"""The cost of finding closest hits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import same


@dataclass(frozen=True, eq=False)
class TraversalCost:
    """Traversal cost of closest hits; arrays with the leading shape of the rays, read-only.

    Attributes
    ----------
    nodes : (...) int32
        Visited nodes of the accelerator; the boxes of a node's children are tested together.
    primitives : (...) int32
        Tested primitives: all of the visited leaves.

    See Also
    --------
    Scene.traversal_cost : Makes it.

    Examples
    --------
    >>> cost = rw.Scene(rw.Sphere()).traversal_cost([[0, 0, 5], [9, 0, 5]], [0, 0, -1])
    >>> cost.primitives.tolist()
    [1, 0]
    """

    nodes: NDArray[np.int32]
    primitives: NDArray[np.int32]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, TraversalCost):
            return NotImplemented
        return same(self.nodes, other.nodes) and same(self.primitives, other.primitives)

    __hash__ = None  # type: ignore[assignment]
