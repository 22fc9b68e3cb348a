"""Silence for other libraries while they read: our own errors have the message."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np

from ..locks import Lock

# Logs and warnings that a read in progress has switched off.
_silenced: list[ExitStack] = []


def _unsilence() -> None:
    """Switch on again what a thread of the parent had switched off, in a forked process."""
    while _silenced:
        _silenced.pop().close()


# Logs and Python's warnings are switched off for the whole process, so reads take turns.
_lock = Lock(abandoned=_unsilence)


@contextmanager
def quiet(strictly: type[Warning] | None = None) -> Iterator[None]:
    """Keep trimesh's log, and all warnings, from being heard; those of one kind may be errors instead."""
    # Imported here, because only readers need it (import time).
    import logging

    log = logging.getLogger("trimesh")
    with _lock, np.errstate(all="ignore"), ExitStack() as silence:
        silence.enter_context(warnings.catch_warnings())
        warnings.simplefilter("ignore")
        if strictly is not None:
            warnings.simplefilter("error", strictly)
        silence.callback(setattr, log, "disabled", log.disabled)
        log.disabled = True
        _silenced.append(silence)
        try:
            yield
        finally:
            _silenced.remove(silence)


def warn_caller(message: str) -> None:
    """Warn at the line outside of this package from where it was called."""
    # Decorators of numpy lie between this frame and the caller's.
    packages = __name__.partition(".")[0], "numpy"
    frame, level = sys._getframe(1), 2
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in packages:
        frame, level = frame.f_back, level + 1
    warnings.warn(message, RuntimeWarning, stacklevel=level)


def reason(error: Exception, most: int = 120) -> str:
    """Return why a library could not read something, in one line."""
    if isinstance(error, ModuleNotFoundError):
        return f"trimesh needs {error.name} for it"
    told = " ".join(str(error).split())
    if not isinstance(error, ValueError | OSError | IndexError) or not told:
        told = f"{type(error).__name__}: {told}" if told else type(error).__name__
    return told if len(told) <= most else f"{told[: most - 3]}..."


def refused(path: Path, what: str, error: Exception) -> Exception:
    """Return what to raise for a file of which `error` says that it cannot be read as `what`."""
    # Our ImportError names the missing package; a ModuleNotFoundError comes from another library.
    if isinstance(error, OSError | MemoryError) or type(error) is ImportError:
        return error
    return ValueError(f"{path} is not a {what} that can be read ({reason(error, 160)})")
