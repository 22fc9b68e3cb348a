"""Nodes of a USD material: values and connections."""

from __future__ import annotations

from typing import Any, NamedTuple

from .reading import Reading


class Link(NamedTuple):
    """A connection: a node, and the name of its output."""

    node: Node
    output: str


class Node:
    """A shader.

    Parameters
    ----------
    shader : UsdShade.Shader
        The prim.
    reading : Reading
        The stage.
    """

    def __init__(self, shader: Any, reading: Reading) -> None:
        self.shader, self._reading = shader, reading
        self.kind = str(shader.GetShaderId() or "")

    @property
    def path(self) -> str:
        """Where it is in the stage."""
        return str(self.shader.GetPath())

    def value(self, name: str, default: Any = None) -> Any:
        """Return the value of an input, also by way of the inputs of its material; else the default."""
        source = self._source(name)
        return default if source is None or _is_output(source) else self._reading.value(source, default)

    def link(self, name: str) -> Link | None:
        """Return the output that an input is connected to, also by way of the inputs of its material."""
        from pxr import UsdShade

        source = self._source(name)
        if source is None or not _is_output(source):
            return None
        return Link(Node(UsdShade.Shader(source.GetPrim()), self._reading), source.GetBaseName())

    def is_given(self, name: str) -> bool:
        """Return whether an input is connected, or has a value of its own."""
        return self.link(name) is not None or self.value(name) is not None

    def _source(self, name: str) -> Any:
        given = self.shader.GetInput(name)
        found = given.GetValueProducingAttributes() if given else ()
        return found[0] if found else None


def _is_output(attribute: Any) -> bool:
    return bool(str(attribute.GetName()).startswith("outputs:"))
