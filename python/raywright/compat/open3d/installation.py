"""Open3D with raywright's `RaycastingScene`, and back."""

from ..switch import Installation, Replacement, Switch
from .raycasting_scene import RaycastingScene

_switch = Switch()


class TensorScene(RaycastingScene):
    """What stands in Open3D: like the class there, it returns tensors whatever is passed."""

    _returns_tensors = True


def install() -> Installation:
    """Let ``open3d.t.geometry.RaycastingScene`` be `RaycastingScene`, until `uninstall`.

    It returns tensors whatever is passed, as Open3D's own class does.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.open3d.install(): ...``.

    Raises
    ------
    ImportError
        If Open3D is not installed.
    """
    import open3d

    return _switch.on([Replacement(open3d.t.geometry, "RaycastingScene", TensorScene)])


def uninstall() -> None:
    """Give Open3D its own class back; nothing happens if there is nothing to undo."""
    _switch.off()
