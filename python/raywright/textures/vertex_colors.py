"""The colours of a mesh's vertices."""

from dataclasses import dataclass

from ..arrays import Triple
from .texture import Texture


@dataclass(frozen=True)
class VertexColors(Texture):
    """The colours of the mesh's vertices, between them in proportion; white on what has none."""

    @property
    def range(self) -> tuple[Triple, Triple]:
        """The least and the greatest that it may be, in red, green and blue."""
        return (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
