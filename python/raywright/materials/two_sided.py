"""One material on the front and another on the back."""

from dataclasses import dataclass

from .material import Material, material


@dataclass(frozen=True, init=False)
class TwoSided(Material):
    """A sheet of one material where its normals point to, and of another behind.

    Neither lets light through or has holes; a `Mask` of the whole has them in both.

    Parameters
    ----------
    front, back : Material
        On the side of the normals, and on the other.

    Raises
    ------
    ValueError
        If one of them lets light through or has holes, once the scene is compiled.
    TypeError
        If something is not of the kinds above.
    """

    front: Material
    back: Material

    def __init__(
        self,
        front: Material,
        back: Material,
    ) -> None:
        self._set(
            front=material("front", front),
            back=material("back", back),
        )
