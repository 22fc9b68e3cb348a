"""Sizes of tests that take minutes: a part of the whole, or the whole if `RAYWRIGHT_SLOW` is set."""

import math
import os

_IS_WHOLE = "RAYWRIGHT_SLOW" in os.environ


def part(count, share):
    """Return one in `share` of a count."""
    return count if _IS_WHOLE else count // share


def error_of_part(error, share):
    """Return the standard error of that part, given that of the whole."""
    return error if _IS_WHOLE else error * math.sqrt(share)
