"""The base class of media."""

from __future__ import annotations

from typing import Any


class Medium:
    """The base class of media, which absorb, scatter and emit light.

    Its subclasses give the coefficients.

    See Also
    --------
    Homogeneous, GridMedium

    Examples
    --------
    >>> isinstance(rw.Homogeneous(scattering=1.0), rw.media.Medium)
    True
    """


def medium(name: str, given: Any) -> Medium | None:
    """Return a checked medium, or None.

    Raises
    ------
    TypeError
        If it is anything else.
    """
    if given is not None and not isinstance(given, Medium):
        raise TypeError(f"{name} must be a raywright medium or None, got {type(given).__name__}")
    return given
