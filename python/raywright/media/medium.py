"""What all media have in common."""

from typing import Any


class Medium:
    """What fills space, and absorbs, scatters and gives off light. Its subclasses say how much where."""


def medium(name: str, given: Any) -> Medium | None:
    """Return a medium as it is, or None.

    Raises
    ------
    TypeError
        If it is anything else.
    """
    if given is not None and not isinstance(given, Medium):
        raise TypeError(f"{name} must be a raywright medium or None, got {type(given).__name__}")
    return given
