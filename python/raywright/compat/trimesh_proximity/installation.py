"""The closest points of trimesh by raywright, and back."""

import trimesh

from ..switch import Installation, Replacement, Switch
from .closest import closest_point, signed_distance

_switch = Switch()


def install() -> Installation:
    """Let ``trimesh.proximity`` find closest points and signed distances with raywright, until `uninstall`.

    So do ``mesh.nearest`` of every mesh and all of trimesh that calls them. What was imported by name from
    ``trimesh.proximity`` before stays as it was. Rays are a switch of their own: see ``trimesh_ray``.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.trimesh_proximity.install(): ...``.
    """
    return _switch.on(
        [
            Replacement(trimesh.proximity, "closest_point", closest_point),
            Replacement(trimesh.proximity, "signed_distance", signed_distance),
        ]
    )


def uninstall() -> None:
    """Give trimesh its own functions back; nothing happens if there is nothing to undo."""
    _switch.off()
