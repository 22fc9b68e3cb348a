"""The closest points of trimesh by raywright, and back."""

from __future__ import annotations

import trimesh

from ..switch import Installation, Replacement, Switch
from .closest import closest_point, signed_distance

_switch = Switch()


def install() -> Installation:
    """Let ``trimesh.proximity`` find closest points and signed distances with raywright, until `uninstall`.

    ``mesh.nearest`` of every mesh does so too, and all of trimesh that calls them. Functions imported by name
    from ``trimesh.proximity`` before stay as they were. Rays are a switch of their own: see ``trimesh_ray``.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.trimesh_proximity.install(): ...``.

    See Also
    --------
    uninstall : Undoes it.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_proximity import install
    >>> with install():
    ...     distance = trimesh.proximity.signed_distance(trimesh.creation.box((2, 2, 2)), [[0, 0, 0]])
    >>> distance.tolist()
    [1.0]
    """
    return _switch.on(
        [
            Replacement(trimesh.proximity, "closest_point", closest_point),
            Replacement(trimesh.proximity, "signed_distance", signed_distance),
        ]
    )


def uninstall() -> None:
    """Give trimesh its own functions back; nothing happens if there is nothing to undo.

    See Also
    --------
    install : Its inverse.

    Examples
    --------
    >>> from raywright.compat.trimesh_proximity import uninstall
    >>> uninstall()
    """
    _switch.off()
