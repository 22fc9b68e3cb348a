"""The shell command, run in this process."""

import contextlib
import io
import os
import warnings
from types import SimpleNamespace

from raywright.cli import main


def run_command(*arguments, cwd):
    """Return the status and the output of `raywright` with these arguments.

    A process takes longer to start than most commands take to run. `test_cli.py` tests the process itself.
    """
    out, err = io.StringIO(), io.StringIO()
    before = os.getcwd()
    os.chdir(cwd)
    try:
        # `main` replaces `warnings.showwarning`, and pytest turns warnings into errors.
        with warnings.catch_warnings(), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            warnings.simplefilter("default")
            try:
                status = main([str(argument) for argument in arguments])
            except SystemExit as end:
                status = end.code or 0
    finally:
        os.chdir(before)
    return SimpleNamespace(returncode=status, stdout=out.getvalue(), stderr=err.getvalue())
