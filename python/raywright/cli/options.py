"""Arguments shared by all subcommands."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from math import isfinite
from typing import Any, NoReturn


class Parser(argparse.ArgumentParser):
    """One that fails in one line."""

    def error(self, message: str) -> NoReturn:
        """End the process with status 2."""
        self.exit(2, f"raywright: error: {message} (see {self.prog} --help)\n")


def number(kind: type[Any], least: float | None = None, most: float | None = None) -> Callable[[str], Any]:
    """Read a number in least..most; without `least`, one above 0 and finite."""

    def read(text: str) -> Any:
        value = kind(text)
        if least is None:
            if not 0 < value < float("inf"):
                raise argparse.ArgumentTypeError(f"must be greater than 0, got {text}")
        elif not value >= least or (most is not None and value > most):
            limits = f"at least {least}" if most is None else f"between {least} and {most}"
            raise argparse.ArgumentTypeError(f"must be {limits}, got {text}")
        return value

    # argparse names the function in "invalid ... value".
    read.__name__ = "whole number" if kind is int else "number"
    return read


def finite(text: str) -> float:
    """Read any number that is not infinite."""
    value = float(text)
    if not isfinite(value):
        raise argparse.ArgumentTypeError(f"must be finite, got {text}")
    return value


# argparse names the function in "invalid ... value".
finite.__name__ = "number"
