"""One plugin of a scene: its type, its place, and its parameters, each of which must be understood."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from .errors import SceneError
from .transforms import Matrix, matrix_of, uv_matrix

Triple = tuple[float, float, float]
# Parameters of all plugins that do not affect the picture.
_COMMON = ("type", "id")
_MOST_LEVELS = 64
# Deeper than plugins nest in any scene, references included. If each referred to the next twice, the work
# would double at every level.
_MOST_WITHIN = 12


class Context:
    """Context shared by all plugins of a scene: folders of files, objects by name, and warnings given once.

    Parameters
    ----------
    tree : mapping
        The scene as a dict.
    folders : list of Path
        Folders of files, first to last.
    """

    def __init__(self, tree: Mapping[str, Any], folders: list[Path]) -> None:
        self.folders = folders
        # Results by plugin, since many places refer to the same one.
        self.kept: dict[Any, Any] = {}
        self._named: dict[str, Any] = {}
        self._warned: set[str] = set()
        # True if the scene has a spectrum, so that all of it is rendered by wavelength.
        self.by_wavelength = False
        self._name(tree, "", 0)

    def _name(self, tree: Mapping[str, Any], path: str, depth: int) -> None:
        if depth > _MOST_LEVELS:
            raise SceneError(f"{path[:80]} ...: plugins nest more than {_MOST_LEVELS} deep")
        for key, value in tree.items():
            if not isinstance(value, Mapping):
                continue
            inner = f"{path}.{key}" if path else str(key)
            self._named.setdefault(inner, value)
            if isinstance(value.get("id"), str) and value.get("type") not in ("ref", "alias"):
                self._named.setdefault(value["id"], value)
            self.by_wavelength |= _is_spectrum(value)
            self._name(value, inner, depth + 1)

    def follow(self, value: Any, where: str) -> Any:
        """Return what a reference or an alias stands for; anything else as it is."""
        for _ in range(_MOST_LEVELS):
            if not (isinstance(value, Mapping) and value.get("type") in ("ref", "alias")):
                return value
            name = value.get("id")
            if name not in self._named:
                raise SceneError(f"{where}: there is no object of id {name!r}")
            value = self._named[name]
        raise SceneError(f"{where}: references are cyclic")

    def warn(self, plugin: Plugin, message: str) -> None:
        """Warn of a plugin, once for all of its type."""
        key = f"{plugin.type}: {message}"
        if key not in self._warned:
            self._warned.add(key)
            warnings.warn(f"{plugin}: {message}", RuntimeWarning, stacklevel=2)


def _is_spectrum(plugin: Mapping[str, Any]) -> bool:
    """Tell whether a plugin is a color by wavelength."""
    if plugin.get("type") in ("regular", "irregular", "blackbody"):
        return True
    value = plugin.get("value")
    is_table = isinstance(value, list | tuple | np.ndarray) and np.ndim(value) == 2
    return plugin.get("type") == "spectrum" and ("filename" in plugin or is_table)


class Plugin:
    """A plugin, whose parameters are taken one by one; `done` refuses what is left.

    Parameters
    ----------
    values : mapping
        The plugin as a dict.
    where : str
        Its name with those of its parents, dots between.
    context : Context
        That of the scene.
    """

    def __init__(self, values: Mapping[str, Any], where: str, context: Context) -> None:
        kind = values.get("type")
        if not isinstance(kind, str):
            raise SceneError(f"{where}: a plugin must have a type, got {kind!r}")
        if where.count(".") > _MOST_WITHIN:
            raise SceneError(f"{where[:60]} ...: plugins nest more than {_MOST_WITHIN} deep")
        # Mitsuba's own names are in lower case; it accepts some in capitals.
        self.type, self.where, self.context = kind.lower(), where, context
        self.values = values
        self._left = {key for key in values if key not in _COMMON}

    def __str__(self) -> str:
        return f"{self.type} {self.where!r}" if self.where else self.type

    def fail(self, why: str) -> NoReturn:
        """Refuse the plugin."""
        raise SceneError(f"{self}: {why}")

    def warn(self, message: str) -> None:
        """Warn once a scene of an approximation in all plugins of the type."""
        self.context.warn(self, message)

    def has(self, name: str) -> bool:
        """Return whether a parameter is given."""
        return name in self.values

    def take(self, name: str, default: Any = None) -> Any:
        """Return a parameter as it is, references followed."""
        self._left.discard(name)
        if name not in self.values:
            return default
        return self.context.follow(self.values[name], f"{self}: {name}")

    def ignore(self, *names: str) -> None:
        """Skip a parameter that changes no picture here."""
        self._left.difference_update(names)

    def number(self, name: str, default: float) -> float:
        """Return a number."""
        value = self.take(name, default)
        if isinstance(value, bool) or not isinstance(value, int | float | np.number):
            self.fail(f"{name} must be a number, got {_told(value)}")
        if not np.isfinite(value):
            self.fail(f"{name} must be finite, got {value}")
        return float(value)

    def integer(self, name: str, default: int) -> int:
        """Return a whole number."""
        value = self.number(name, default)
        if value != int(value):
            self.fail(f"{name} must be a whole number, got {value:g}")
        return int(value)

    def switch(self, name: str, default: bool) -> bool:
        """Return a bool."""
        value = self.take(name, default)
        if not isinstance(value, bool | np.bool_):
            self.fail(f"{name} must be true or false, got {_told(value)}")
        return bool(value)

    def text(self, name: str, default: str | None = None) -> str:
        """Return a text, which must be there if it has no default."""
        value = self.take(name, default)
        if not isinstance(value, str):
            came = "nothing" if value is None else _told(value)
            self.fail(f"{name} must be a text, got {came}")
        return str(value)

    def choice(self, name: str, default: str, choices: tuple[str, ...]) -> str:
        """Return a text that is one of a few, in lower case."""
        value = self.text(name, default).lower()
        if value not in choices:
            self.fail(f"{name} must be one of {', '.join(choices)}, got {value!r}")
        return value

    def vector(self, name: str, default: Triple) -> NDArray[np.float64]:
        """Return three numbers, (3,)."""
        value = self.take(name, default)
        try:
            array = np.array(value, dtype=np.float64).reshape(-1)
        except (TypeError, ValueError):
            array = np.empty(0)
        if array.shape != (3,) or not np.isfinite(array).all():
            self.fail(f"{name} must be 3 finite numbers, got {_told(value)}")
        return array

    def to_world(self) -> Matrix:
        """Return the (4, 4) matrix to the world; the identity if there is none."""
        return self._matrix("to_world", matrix_of, 4)

    def to_uv(self) -> Matrix:
        """Return the (3, 3) matrix from a surface's texture coordinates; the identity if there is none."""
        return self._matrix("to_uv", uv_matrix, 3)

    def _matrix(self, name: str, read: Any, size: int) -> Matrix:
        value = self.take(name)
        if value is None:
            return np.eye(size)
        try:
            matrix: Matrix = read(value)
        except ValueError as error:
            self.fail(f"{name} {error}")
        return matrix

    def path(self, name: str = "filename") -> Path:
        """Return where a file is that the plugin names, relative to the scene's folder."""
        from .xml import resolve

        return resolve(self.text(name), self.context.folders)

    def child(self, name: str) -> Plugin | None:
        """Return the plugin that is a parameter; None if it is none, or not there."""
        value = self.take(name)
        return Plugin(value, self._inner(name), self.context) if isinstance(value, Mapping) else None

    def children(self, *types: str) -> Iterator[Plugin]:
        """Yield the plugins within that are of some types, in order, whatever they are called."""
        for name, value in self.values.items():
            if name in self._left and isinstance(value, Mapping):
                found = self.context.follow(value, f"{self}: {name}")
                if isinstance(found, Mapping) and str(found.get("type")).lower() in types:
                    self._left.discard(name)
                    yield Plugin(found, self._inner(name), self.context)

    def done(self) -> None:
        """Refuse parameters that nobody has taken."""
        for name in self.values:
            if name not in self._left:
                continue
            value = self.context.follow(self.values[name], f"{self}: {name}")
            if isinstance(value, Mapping):
                self.fail(f"{value.get('type')} {name!r} is not supported here")
            self.fail(f"parameter {name!r} is not supported")

    def _inner(self, name: str) -> str:
        return f"{self.where}.{name}" if self.where else name


def _told(value: Any) -> str:
    if isinstance(value, Mapping):
        return f"a plugin of type {value.get('type')!r}"
    told = repr(value)
    return told if len(told) <= 60 else type(value).__name__
