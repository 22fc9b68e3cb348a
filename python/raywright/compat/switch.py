"""Other libraries' classes and functions replaced by raywright's, and put back."""

from __future__ import annotations

from types import TracebackType
from typing import Any, NamedTuple

_ABSENT = object()


class Replacement(NamedTuple):
    """An attribute of a class or module, and its replacement while a switch is on."""

    owner: Any
    name: str
    value: Any


class Switch:
    """Replaces attributes of another library, until it is turned off."""

    def __init__(self) -> None:
        self._before: list[Replacement] | None = None

    @property
    def is_on(self) -> bool:
        """True if the replacements are in force."""
        return self._before is not None

    def before(self, owner: Any, name: str) -> Any:
        """Return an attribute from before the switch was turned on, or its current value if it is off."""
        for replaced in self._before or ():
            if replaced.owner is owner and replaced.name == name:
                return replaced.value
        return getattr(owner, name)

    def on(self, replacements: list[Replacement]) -> Installation:
        """Put the replacements in force, unless that is done already."""
        if self.is_on:
            return Installation(self, False)
        self._before = [
            Replacement(owner, name, vars(owner).get(name, _ABSENT)) for owner, name, _ in replacements
        ]
        for owner, name, value in replacements:
            setattr(owner, name, value)
        return Installation(self, True)

    def off(self) -> None:
        """Restore the attributes; nothing happens if nothing is replaced."""
        before, self._before = self._before or (), None
        for owner, name, value in before:
            if value is _ABSENT:
                delattr(owner, name)
            else:
                setattr(owner, name, value)


class Installation:
    """The handle of an `install`; as a context manager it undoes the installation at the end.

    Examples
    --------
    >>> import trimesh
    >>> from raywright.compat.trimesh_ray import install
    >>> with install() as installation:
    ...     name = type(trimesh.creation.box().ray).__module__
    >>> name.startswith("raywright"), type(installation).__name__
    (True, 'Installation')
    """

    def __init__(self, switch: Switch, is_first: bool) -> None:
        self._switch = switch
        self._is_first = is_first

    def __enter__(self) -> Installation:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._is_first:
            self._switch.off()

    def __repr__(self) -> str:
        return f"Installation({'in force' if self._switch.is_on else 'undone'})"


class Kept:
    """Data that raywright keeps on an object of another library; pickles leave it out."""

    def __init__(self, value: Any, key: Any = None) -> None:
        self.value = value
        self.key = key

    def __reduce__(self) -> tuple[type[None], tuple[()]]:
        # None: a pickled object then loads without raywright.
        return type(None), ()
