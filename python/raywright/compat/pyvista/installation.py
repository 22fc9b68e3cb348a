"""The meshes of pyvista with raywright's rays, and back."""

from __future__ import annotations

from ..switch import Installation, Replacement, Switch
from .filters import multi_ray_trace, ray_trace, select_interior_points

_switch = Switch()


def install() -> Installation:
    """Let pyvista's meshes trace rays and select interior points with raywright, until `uninstall`.

    It replaces ``PolyData.ray_trace``, ``PolyData.multi_ray_trace`` and the ``select_interior_points`` of all
    meshes, for those that there are already too.

    Returns
    -------
    Installation
        A context manager that calls `uninstall` at its end, unless it was installed already:
        ``with raywright.compat.pyvista.install(): ...``.

    Raises
    ------
    ImportError
        If pyvista is not installed.

    See Also
    --------
    uninstall : Undoes it.

    Examples
    --------
    >>> import pyvista
    >>> from raywright.compat.pyvista import install
    >>> with install():
    ...     points, cells = pyvista.Sphere().ray_trace([0.01, 0.02, 5], [0.01, 0.02, -5])
    >>> len(points)
    2
    """
    import pyvista

    surfaces, meshes = pyvista.PolyDataFilters, pyvista.DataSetFilters
    return _switch.on(
        [
            Replacement(surfaces, "ray_trace", ray_trace),
            Replacement(surfaces, "multi_ray_trace", multi_ray_trace),
            Replacement(meshes, "select_interior_points", select_interior_points),
        ]
    )


def uninstall() -> None:
    """Give pyvista its own methods back; nothing happens if there is nothing to undo.

    See Also
    --------
    install : Its inverse.

    Examples
    --------
    >>> from raywright.compat.pyvista import uninstall
    >>> uninstall()
    """
    _switch.off()
