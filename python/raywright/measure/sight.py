"""Lines of sight between points."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import number
from ..query.hits import Hits
from ..scene.scene import SceneLike
from .places import Floats, Touching, common, scene_of, touching, vectors
from .plots import Plotted


@dataclass(frozen=True, eq=False, repr=False)
class LineOfSight(Plotted):
    """Lines of sight between points; arrays of the leading shape of the pairs.

    Attributes
    ----------
    visible : (...) bool
        True if nothing is between the points.
    obstruction : Hits
        First obstruction from `a`; `t` is the fraction of the segment from `a` to `b`.
    distance : (...) float64
        Distance from one point to the other.

    See Also
    --------
    measure.line_of_sight : Makes it.

    Examples
    --------
    >>> sight = rw.measure.line_of_sight(rw.Sphere(), (0, 0, -4), [[0, 0, 4], [4, 0, -4]])
    >>> sight.visible.tolist(), sight.obstruction.t.tolist(), sight.distance.tolist()
    ([False, True], [0.375, inf], [8.0, 4.0])
    """

    visible: NDArray[np.bool_]
    obstruction: Hits
    distance: Floats
    _drawn = ("visible", "distance")

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each pair, in C order.

        Columns of the obstruction: ``t``, shape and face.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> sight = rw.measure.line_of_sight(rw.Sphere(), (0, 0, -4), [[0, 0, 4], [4, 0, -4]])
        >>> sight.to_dict()["visible"].tolist()
        [False, True]
        """
        first = self.obstruction
        columns = {"visible": self.visible, "distance": self.distance, "t": first.t}
        columns |= {"shape_id": first.shape_id, "primitive_id": first.primitive_id}
        return {name: column.reshape(-1) for name, column in columns.items()}

    def __repr__(self) -> str:
        seen = int(np.count_nonzero(self.visible))
        return f"LineOfSight(shape={self.visible.shape}, {seen} of {self.visible.size} visible)"


def line_of_sight(
    scene: SceneLike, a: ArrayLike, b: ArrayLike, margin: float | None = None, threads: int | None = None
) -> LineOfSight:
    """Test whether points see each other, and find the first obstruction.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Obstructions.
    a, b : (..., 3) arrays
        The points, broadcast against each other.
    margin : float, optional
        Share of the segment to ignore at either end, at least 0 and less than 0.5. With 0, surfaces at both
        points count. If not given, a surface does not hide a point that lies on it to within rounding: the
        ray starts beyond the error bound, as in `Hits.spawn_rays`. All other surfaces count, however near.
    threads : int, optional
        Number of threads; all cores if not given. The answer does not depend on it.

    Returns
    -------
    LineOfSight
        With the shape that both broadcast to. A point sees itself.

    Raises
    ------
    ValueError
        If a last dimension is not 3, shapes do not broadcast, or a number is not finite or out of its range.
    TypeError
        If an array does not hold real numbers.

    See Also
    --------
    Scene.occluded : Rays instead of pairs of points.

    Examples
    --------
    >>> wall = rw.Disk(normal=(0, 0, 1), radius=1)
    >>> sight = rw.measure.line_of_sight(wall, (0, 0, -1), [[0, 0, 1], [5, 0, 1]])
    >>> sight.visible.tolist()
    [False, True]
    """
    starts, ends = vectors("a", a), vectors("b", b)
    lead = common({"a": starts.shape[:-1], "b": ends.shape[:-1]})
    scene = scene_of(scene)
    way = np.broadcast_to(ends - starts, (*lead, 3))
    far = np.linalg.norm(way, axis=-1)
    if margin is None:
        from_, first = _left(touching(scene, a, threads).spread(starts.shape[:-1], lead), starts, way, far)
        to, last = _left(touching(scene, b, threads).spread(ends.shape[:-1], lead), ends, -way, far)
        hits = scene.intersect(from_, to - from_, t_min=first, t_max=1.0 - last, threads=threads)
    else:
        least = number("margin", margin)
        if not 0 <= least < 0.5:
            raise ValueError(f"margin must be at least 0 and less than 0.5, got {margin}")
        hits = scene.intersect(starts, way, t_min=least, t_max=1.0 - least, threads=threads)
    found = LineOfSight(~hits.hit, hits, np.asarray(far))
    # The larger array: with one viewer and many points, the points.
    found._at(scene, starts if ends.size < starts.size else ends)
    return found


def _left(at: Touching, points: Floats, way: Floats, far: Floats) -> tuple[Floats, Floats]:
    """Return points off the surfaces that they lie on, and the share of the way that is still of these."""
    return at.beside(points, way), np.divide(at.slack(), far, out=np.zeros(far.shape), where=far > 0)
