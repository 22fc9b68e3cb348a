"""What queries need of a scene: its compiled form."""

from __future__ import annotations

from .._core import CompiledScene


class Compilable:
    """A scene that its first query compiles."""

    _core: CompiledScene | None

    def _compiled(self) -> CompiledScene:
        raise NotImplementedError
