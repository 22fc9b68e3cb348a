"""Requests and messages of a page, for the server and for notebooks."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..arrays import integer, number
from .orbit import View
from .session import Session, line_of

# Pixels of a window, and stops of exposure.
_WINDOW, _EXPOSURE = (16, 4096), (-20.0, 20.0)
# Longest path from the root of a tree to a box.
_DEEPEST = 1000


def scene_told(session: Session) -> dict[str, Any]:
    """Return the first message of a scene to a page."""
    width, height = session.size
    return {
        "width": width,
        "height": height,
        "elevations": session.elevations,
        "exposure": session.exposure,
        "fits": session.fits,
        "boxes": session.depth,
        "view": session.view.told(),
    }


def told(session: Session, what: str, given: Any) -> dict[str, Any] | None:
    """Run a page's request, and return the answer, for JSON; None if there is nothing to say.

    Raises
    ------
    KeyError
        If the request is unknown.
    ValueError, TypeError
        If its arguments are invalid.
    """
    return _ANSWERS[what](session, given)


def is_known(what: str) -> bool:
    """Return whether a page may request it."""
    return what in _ANSWERS


def bytes_of(session: Session, name: str) -> bytes | None:
    """Return the bytes of something by its name; None if nothing has this name.

    Parameters
    ----------
    session : Session
        Of what.
    name : str
        ``"arrays/VERSION/NAME"``, as the answer to ``"drawing"`` tells them, or ``"boxes/DEPTH"``: the
        corners of the accelerator's boxes at a level, (K, 8, 3) float32 in box units.
    """
    kind, _, rest = name.partition("/")
    if kind == "arrays":
        version, _, which = rest.partition("/")
        return session.drawn.bytes(version, which)
    if kind == "boxes" and rest.isascii() and rest.isdigit() and len(rest) < 5:
        return session.corners(int(rest))
    return None


def _view(session: Session, given: Any) -> None:
    session.turn(View.read(given))


def _window(session: Session, given: Any) -> None:
    width, height = _named(given, "a window", "width", "height")
    session.fit(integer("width", width, *_WINDOW), integer("height", height, *_WINDOW))


def _exposure(session: Session, given: Any) -> None:
    (told,) = _named(given, "an exposure", "exposure")
    value, (least, most) = number("exposure", told), _EXPOSURE
    if not least <= value <= most:
        raise ValueError(f"exposure must be between {least:g} and {most:g}, got {value:g}")
    session.expose(value)


def _boxes(session: Session, given: Any) -> None:
    (depth,) = _named(given, "boxes", "depth")
    session.box(None if depth is None else integer("depth", depth, 0, _DEEPEST))


def _pick(session: Session, given: Any) -> dict[str, Any]:
    view, *place = _named(given, "a pick", "view", "x", "y")
    x, y = (number(name, value) for name, value in zip("xy", place, strict=True))
    if not (0 <= x < 1 and 0 <= y < 1):
        raise ValueError(f"x and y must be at least 0 and less than 1, got {x:g} and {y:g}")
    return session.pick(View.read(view), x, y)


def _camera(session: Session, given: Any) -> dict[str, Any]:
    _named(given, "a camera")
    return {"line": line_of(session.camera)}


def _drawing(session: Session, given: Any) -> dict[str, Any]:
    _named(given, "a drawing")
    return session.drawn.told()


_ANSWERS: dict[str, Callable[[Session, Any], dict[str, Any] | None]] = {
    "view": _view,
    "window": _window,
    "exposure": _exposure,
    "boxes": _boxes,
    "pick": _pick,
    "camera": _camera,
    "drawing": _drawing,
}


def _named(given: Any, what: str, *names: str) -> list[Any]:
    """Return an object's entries of these names, and no others."""
    if not isinstance(given, dict) or set(given) != set(names):
        raise ValueError(f"{what} must be an object with {' and '.join(names) or 'nothing in it'}")
    return [given[name] for name in names]
