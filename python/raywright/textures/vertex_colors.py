"""The colors of a mesh's vertices."""

from __future__ import annotations

from dataclasses import dataclass

from ..arrays import Triple
from .texture import Texture


@dataclass(frozen=True)
class VertexColors(Texture):
    """The colors of the mesh's vertices, interpolated; white for meshes without any.

    See Also
    --------
    ImageTexture : A picture.

    Examples
    --------
    >>> corners, colors = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    >>> mesh = rw.Mesh(corners, [[0, 1, 2]], colors=colors, material=rw.Diffuse(rw.VertexColors()))
    >>> rays = rw.query.Rays(np.array([[0.25, 0.25, 1.0]]), np.array([[0, 0, -1.0]]), np.zeros(1))
    >>> rw.Scene(mesh).interactions(rays).albedo.round(4).tolist()
    [[0.5, 0.25, 0.25]]
    """

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
