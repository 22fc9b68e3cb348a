"""Masks of rays and of shapes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import bools
from ..foreign_arrays import as_array
from .rays import AskedRays, RayArguments, view

ShapeMask: TypeAlias = str | Sequence[str] | ArrayLike
Cull: TypeAlias = Literal["back"]
# A flag per shape, and whether back faces are culled; None if everything counts.
Counted: TypeAlias = tuple[list[bool] | None, bool] | None


def names_of(shapes: Sequence[Any]) -> tuple[str, ...]:
    """Return the name of each shape, "" where it has none."""
    return tuple(shape.name or "" for shape in shapes)


def counted(shapes: ShapeMask | None, cull: Cull | None, all_shapes: Sequence[Any]) -> Counted:
    """Return a checked mask of shapes for the core.

    Raises
    ------
    ValueError
        If a mask has not one entry per shape, a name is that of no shape, or `cull` is not "back".
    TypeError
        If `shapes` is neither bool nor names.
    """
    if cull is not None and cull != "back":
        raise ValueError(f'cull must be "back" or None, got {cull!r}')
    if shapes is None:
        return None if cull is None else (None, True)
    return _each(shapes, all_shapes), cull is not None


def _each(shapes: ShapeMask, all_shapes: Sequence[Any]) -> list[bool]:
    wanted = [shapes] if isinstance(shapes, str) else shapes
    if isinstance(wanted, list | tuple | set | frozenset) and all(isinstance(name, str) for name in wanted):
        names = names_of(all_shapes)
        known = {name for name in names if name}
        for name in wanted:
            if name not in known:
                told = f"its names are {', '.join(map(repr, sorted(known)))}" if known else "none has a name"
                raise ValueError(
                    f"shapes has {name!r}, which is not the name of a shape of the scene: {told}"
                )
        return [name in wanted for name in names]
    count = len(all_shapes)
    try:
        mask = bools("shapes", wanted, "one for each shape, or names")
    except TypeError as error:
        if as_array("shapes", wanted).dtype.kind not in "iu":
            raise
        raise TypeError(f"{error}; to select shapes by index, use np.isin(range({count}), shapes)") from None
    if mask.shape != (count,):
        raise ValueError(f"shapes must have shape ({count},), one bool a shape, got {mask.shape}")
    kept: list[bool] = mask.tolist()
    return kept


def asked(rays: RayArguments, mask: ArrayLike | None) -> AskedRays:
    """Return rays as the core takes them: those without a True in `mask`, if there is one, meet nothing.

    Raises
    ------
    ValueError
        If the mask does not broadcast to the leading shape of the rays.
    TypeError
        If it is not bool.
    """
    if mask is None:
        return *rays, None
    which = bools("mask", mask, "one for each ray")
    shape = rays[4]
    try:
        np.broadcast_to(which, shape)
    except ValueError:
        raise ValueError(
            f"mask has shape {which.shape}, which does not broadcast to rays of {shape}"
        ) from None
    return *rays, view(which, shape)
