"""Errors of a USD stage by prim."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from ..notes import Notes

__all__ = ["Notes", "told_of"]


@contextmanager
def told_of(prim: Any) -> Iterator[None]:
    """Name the prim in errors about its values."""
    try:
        yield
    except (ValueError, TypeError, IndexError) as error:
        told, name = _mistyped(prim) or str(error), str(prim.GetPath())
        raise ValueError(told if told.startswith(name) else f"{name}: {told}") from error


def _mistyped(prim: Any) -> str | None:
    """Return which attribute has another type than the schema of its prim says, None if none has."""
    known = prim.GetPrimDefinition()
    for attribute in prim.GetAuthoredAttributes():
        own, stack = known.GetAttributeDefinition(attribute.GetName()), attribute.GetPropertyStack()
        if not own or not stack:
            continue
        came, expected = stack[0].typeName, own.GetTypeName()
        if came.isArray != expected.isArray or _kind(came) != _kind(expected):
            return f"{attribute.GetName()} has type {came}, expected {expected}"
    return None


def _kind(type_name: Any) -> str:
    """Return what a value is, whatever its role and precision."""
    name = str(type_name.scalarType.cppTypeName)
    if name.startswith("Gf"):
        return name[:-1]
    texts = ("TfToken", "std::string", "SdfAssetPath")
    return "text" if name in texts else "number"
