"""Scenes from pickles: a process compiles each of them once."""

from __future__ import annotations

from collections import OrderedDict

from .. import _core
from ..locks import Lock
from .digest import digest

# More would hold the memory of scenes no longer in use.
_MOST = 2
_kept: OrderedDict[str, _core.CompiledScene] = OrderedDict()
_lock = Lock()


class Arrival:
    """A scene from a pickle, identified by its contents."""

    def __init__(self, name: str) -> None:
        self._name = name

    @classmethod
    def of(cls, scene: object) -> Arrival | None:
        """Return the key of a scene; None if Python's own pickler cannot take its contents."""
        try:
            return cls(digest(scene))
        except TypeError:
            return None

    def core(self) -> _core.CompiledScene | None:
        """Return the compiled form of such a scene in this process, if it is kept."""
        with _lock:
            found = _kept.get(self._name)
            if found is not None:
                _kept.move_to_end(self._name)
            return found

    def keep(self, core: _core.CompiledScene) -> None:
        """Keep the compiled form; the oldest makes room."""
        with _lock:
            _kept[self._name] = core
            while len(_kept) > _MOST:
                _kept.popitem(last=False)
