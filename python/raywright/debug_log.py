"""What goes on, for the logger "raywright"."""

import sys


def debug(message: str, *values: object) -> None:
    """Log a message on the level DEBUG; nothing is imported, for who listens has imported logging."""
    if (logging := sys.modules.get("logging")) is not None:
        logging.getLogger("raywright").debug(message, *values)
