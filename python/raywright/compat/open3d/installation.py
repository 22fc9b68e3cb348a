"""Open3D with raywright's `RaycastingScene`, and back."""

from __future__ import annotations

from ..switch import Installation, Replacement, Switch
from .raycasting_scene import RaycastingScene

_switch = Switch()


class TensorScene(RaycastingScene):
    """The replacement in Open3D: like the class there, it always returns tensors."""

    _returns_tensors = True


def install() -> Installation:
    """Let ``open3d.t.geometry.RaycastingScene`` be `RaycastingScene`, until `uninstall`.

    It always returns tensors, as Open3D's own class does.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.open3d.install(): ...``.

    Raises
    ------
    ImportError
        If Open3D is not installed.

    See Also
    --------
    uninstall : Undoes it.

    Examples
    --------
    >>> import open3d
    >>> from raywright.compat.open3d import install
    >>> with install():
    ...     scene = open3d.t.geometry.RaycastingScene()
    >>> type(scene).__module__.startswith("raywright")
    True
    """
    import open3d

    return _switch.on([Replacement(open3d.t.geometry, "RaycastingScene", TensorScene)])


def uninstall() -> None:
    """Give Open3D its own class back; nothing happens if there is nothing to undo.

    See Also
    --------
    install : Its inverse.

    Examples
    --------
    >>> from raywright.compat.open3d import uninstall
    >>> uninstall()
    """
    _switch.off()
