"""The shell command: pictures, measures and reports, a verb each."""

from __future__ import annotations

import argparse
import os
import sys
import warnings
from collections.abc import Sequence
from typing import Any

from .._core import VERSION
from ..scene.scene import Scene
from ..scene.summary import described
from ..scene_files.load import has_camera, load
from . import measures, pictures, reports
from .options import Parser

# The shells' convention: 128 plus the number of SIGINT.
INTERRUPTED = 130


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the shell command and return its exit status: 0, 1 if it failed, 2 if it was used wrongly.

    Errors are one line on stderr. Ctrl-C gives 130.

    Parameters
    ----------
    arguments : sequence of str, optional
        Arguments after the command's name; those of the process if not given.
    """
    warnings.showwarning = _show_warning
    try:
        options = _parser().parse_args(arguments)
        options.run(options)
        sys.stdout.flush()
    except KeyboardInterrupt:
        return _fail("interrupted", INTERRUPTED)
    except BrokenPipeError:
        # The reader of our output has closed the pipe; print nothing more, not even when stdout closes at
        # exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except MemoryError:
        return _fail("out of memory")
    except (OSError, ValueError, ImportError, RuntimeError) as error:
        return _fail(_told(error))
    return 0


def _info(options: argparse.Namespace) -> None:
    whole = has_camera(options.scene)
    scene = load(options.scene).scene if whole else Scene(options.scene)
    print(described(str(options.scene), scene))


def _parser() -> argparse.ArgumentParser:
    parser = Parser(
        prog="raywright", description="Render pictures with error estimates, and measure meshes with rays."
    )
    parser.add_argument(
        "--version", action="version", version=f"raywright {VERSION}", help="print the version and exit"
    )
    verbs = parser.add_subparsers(title="verbs", dest="verb", metavar="VERB", required=True)
    pictures.add(verbs)

    info = verbs.add_parser("info", help="print the contents of a file and statistics of its accelerator")
    info.set_defaults(run=_info)
    info.add_argument("scene", metavar="SCENE", help=pictures.SCENES)

    measures.add(verbs)
    reports.add(verbs)
    return parser


def _told(error: Exception) -> str:
    """Print an error in one line; the system's own begin with a number that means nothing to most."""
    if isinstance(error, OSError) and error.strerror:
        told = error.strerror[:1].lower() + error.strerror[1:]
        return f"{error.filename}: {told}" if error.filename is not None else told
    return " ".join(str(error).split()) or type(error).__name__


def _fail(message: str, status: int = 1) -> int:
    print(f"raywright: error: {message}" if status == 1 else f"raywright: {message}", file=sys.stderr)
    return status


def _show_warning(message: Warning | str, *_: Any, **__: Any) -> None:
    print(f"raywright: warning: {message}", file=sys.stderr)
