"""One material on the front and another on the back."""

from __future__ import annotations

from dataclasses import dataclass

from .material import Material, material


@dataclass(frozen=True, init=False)
class TwoSided(Material):
    """A sheet with one material on the side of its normals, and another behind.

    Both are opaque and without holes; for holes in both, put a `Mask` around the `TwoSided`.

    Parameters
    ----------
    front, back : Material
        Material on the side of the normals, and on the other.

    Raises
    ------
    ValueError
        If one of them lets light through or has holes, once the scene is compiled.
    TypeError
        If an argument has another type.

    See Also
    --------
    Mix : Two materials on both sides.

    Examples
    --------
    >>> sheet = rw.TwoSided(front=rw.Diffuse(0.8), back=rw.Diffuse(0.1))
    >>> rays = rw.query.Rays(np.array([[0, 0, 1.0], [0, 0, -1]]), np.array([[0, 0, -1.0], [0, 0, 1]]),
    ... np.zeros(2))
    >>> rw.Scene(rw.Plane(material=sheet)).interactions(rays).albedo[:, 0].round(6).tolist()
    [0.8, 0.1]
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
