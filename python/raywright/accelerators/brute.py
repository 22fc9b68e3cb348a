"""No structure."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class BruteForce:
    """No structure: every ray is tested against every primitive. The reference for all other accelerators.

    See Also
    --------
    BVH : The default.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8), accelerator=rw.BruteForce())
    >>> scene.traversal_cost([0, 0, 9], [0, 0, -1]).primitives.item() >= 640
    True
    """
