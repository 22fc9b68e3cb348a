"""Debug messages for the logger "raywright"."""

from __future__ import annotations

import sys


def debug(message: str, *values: object) -> None:
    """Log a message on the level DEBUG; nothing is imported, since a listener has imported logging."""
    if (logging := sys.modules.get("logging")) is not None:
        logging.getLogger("raywright").debug(message, *values)
