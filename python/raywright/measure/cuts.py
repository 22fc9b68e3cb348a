"""Cross sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import _core
from ..arrays import choice
from ..query.tabular import Tabular
from ..scene.scene import Scene, SceneLike
from .places import Floats, common, units, vectors
from .triangles import triangles

AreaRule: TypeAlias = Literal["winding", "even-odd"]


@dataclass(frozen=True, eq=False, repr=False)
class CrossSection(Tabular):
    """The cross section of meshes with a plane.

    Attributes
    ----------
    lines : tuple of (K, 3) float64
        Polylines, open ones first; the last point of a closed one is the first again. For a body with outward
        normals, closed lines are anticlockwise as seen against the plane's normal, and those of holes
        clockwise.
    closed : tuple of bool
        True for closed lines: all are, if the meshes are closed.
    area : float
        Area covered by closed lines, by `rule`; open ones cover nothing.
    length : float
        Total length of all lines.

    See Also
    --------
    measure.cross_section : Makes it.

    Examples
    --------
    >>> import trimesh
    >>> section = rw.measure.cross_section(trimesh.creation.box((2, 2, 2)), (0, 0, 0.5), (0, 0, 1))
    >>> section.is_closed, round(section.area, 9), round(section.length, 9)
    (True, 4.0, 8.0)
    """

    lines: tuple[Floats, ...]
    closed: tuple[bool, ...]
    area: float
    length: float

    def __len__(self) -> int:
        return len(self.lines)

    @property
    def is_closed(self) -> bool:
        """True if all lines are closed, so that `area` leaves nothing out."""
        return all(self.closed)

    @property
    def gaps(self) -> tuple[float, ...]:
        """Distance between the ends of each line: 0 for closed ones."""
        return tuple(float(np.linalg.norm(line[-1] - line[0])) for line in self.lines)

    def to_dict(self) -> dict[str, NDArray[Any]]:
        """Return flat arrays by name, an entry for each point of each line: its line, and x, y and z.

        Returns
        -------
        dict
            An array for each column.

        Examples
        --------
        >>> import trimesh
        >>> section = rw.measure.cross_section(trimesh.creation.box((2, 2, 2)), (0, 0, 0.5), (0, 0, 1))
        >>> sorted(section.to_dict())
        ['closed', 'line', 'x', 'y', 'z']
        """
        counts = [len(line) for line in self.lines]
        points = np.concatenate([np.empty((0, 3)), *self.lines])
        columns = {
            "line": np.repeat(np.arange(len(self)), counts),
            "closed": np.repeat(np.array(self.closed, np.bool_), counts),
        }
        return columns | dict(zip("xyz", points.T, strict=True))

    def __repr__(self) -> str:
        loops = sum(self.closed)
        return f"CrossSection({loops} closed and {len(self) - loops} open lines, area={self.area:g})"


def cross_section(
    scene: SceneLike, point: ArrayLike, normal: ArrayLike, rule: AreaRule = "winding"
) -> CrossSection | tuple[CrossSection, ...]:
    """Cut meshes with a plane, or with many.

    Parameters
    ----------
    scene : Scene, Mesh or anything else that Scene takes
        Meshes, and static copies of them.
    point : (3,) or (N, 3) array
        A point on each plane.
    normal : (3,) or (N, 3) array
        Normal of each plane, of any length; broadcast against `point`.
    rule : {"winding", "even-odd"}
        Area that the closed lines cover. "winding": points with a nonzero winding number, so overlapping
        bodies form a union, and holes count by their orientation; the area is negative where normals point
        in. "even-odd": points inside an odd number of lines, so overlaps are left out.

    Returns
    -------
    CrossSection or tuple of CrossSection
        The polylines of one plane, empty if it misses the meshes; for N planes a tuple of N.

    Raises
    ------
    ValueError
        If something in the scene is not a mesh or moves, a number is not finite, the normal has no length,
        the planes are not (3,) or (N, 3) arrays, or `rule` is not a known rule.
    TypeError
        If an argument is not a number.

    See Also
    --------
    Scene.intersect : Cut with rays.

    Notes
    -----
    The side of a corner is decided once for all faces that share it, and a corner exactly on the plane counts
    as above (Edelsbrunner and Mücke, "Simulation of Simplicity", 1990): so lines of closed meshes always
    close, and a face that lies in the plane is cut along its edge if at all. Each point is computed once, on
    its edge, and is right to a few units in the last place of the corners. Vertices are those of the meshes,
    not rounded as a scene may round them.

    Equal corners are one. If lines stay open, corners that differ by rounding are merged, as in
    ``Scene(weld=)``, and ends of lines are joined at T-junctions.

    Lines are joined regardless of the orientation of faces, and take the orientation of most of their length;
    if each face occurs with both orientations, that of outward normals. Faces with the same corners count
    once. Eight planes or more are cut with a tree of the faces.

    Examples
    --------
    >>> import trimesh
    >>> box = trimesh.creation.box((2, 2, 2))
    >>> section = rw.measure.cross_section(box, (0, 0, 0), (0, 0, 1))
    >>> round(section.area, 9), len(section.lines)
    (4.0, 1)
    >>> slices = rw.measure.cross_section(box, [[0, 0, 0], [0, 0, 9]], (0, 0, 1))
    >>> [round(section.area, 9) for section in slices]
    [4.0, 0.0]
    """
    choice("rule", rule, get_args(AreaRule))
    origins, ways = vectors("point", point), units("normal", normal)
    lead = common({"point": origins.shape[:-1], "normal": ways.shape[:-1]})
    if len(lead) > 1:
        raise ValueError(f"point and normal must be of shape (3,) or (N, 3), got planes of shape {lead}")
    # Corners are welded only if some lines stay open, since welding takes longer than cutting.
    whole = scene if isinstance(scene, Scene) else Scene(scene, weld=None)
    corners, faces, tolerance = triangles(whole, whole._tolerance if whole is scene else None)
    places, normals = (
        np.ascontiguousarray(np.broadcast_to(part, (*lead, 3)).reshape(-1, 3)) for part in (origins, ways)
    )
    found = _core.sections(corners, faces, places, normals, rule == "even-odd", tolerance)
    sections = tuple(map(_section, *zip(*found, strict=True))) if found else ()
    return sections if lead else sections[0]


def _section(points: Floats, splits: list[int], closed: list[bool], area: float) -> CrossSection:
    lines = tuple(line for line in np.split(points, splits[1:-1]) if len(line))
    length = sum(float(np.linalg.norm(np.diff(line, axis=0), axis=1).sum()) for line in lines)
    return CrossSection(lines, tuple(closed), area, length)
