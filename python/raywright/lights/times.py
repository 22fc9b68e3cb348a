"""Times, however they are written."""

from __future__ import annotations

from collections.abc import Iterable
from datetime import datetime, timezone
from typing import TypeAlias, Union

import numpy as np
from numpy.typing import NDArray

# One time; datetime64 has no time zone and means UTC, as in numpy.
Time: TypeAlias = datetime | np.datetime64 | str
Times: TypeAlias = Union[Iterable[Time], "NDArray[np.datetime64]"]

# Years that a datetime can hold.
_YEARS = np.datetime64("0001"), np.datetime64("9999")
_KINDS = "a datetime, a numpy.datetime64, or ISO 8601 text"


def one_or_many(name: str, value: Time | Times) -> datetime | list[datetime]:
    """Return a time, or a list of them, each with its zone.

    Raises
    ------
    ValueError
        If a time has no zone, is none at all, is a text that is not ISO 8601, or is outside of the years 1 to
        9999; or if an array has more than one dimension. An error about several names the one.
    TypeError
        If it is not a time.
    """
    if isinstance(value, np.ndarray):
        if value.ndim > 1:
            raise ValueError(f"{name} must be one time or a row of them, got shape {value.shape}")
        value = value[()] if value.ndim == 0 else value
    if isinstance(value, datetime | np.datetime64 | str) or not isinstance(value, Iterable):
        return _one(name, value)
    return [_one(f"{name}[{i}]", each) for i, each in enumerate(value)]


def _one(name: str, value: object) -> datetime:
    if isinstance(value, np.datetime64):
        return _of_numpy(name, value)
    if isinstance(value, str):
        time = _of_text(name, value)
    elif isinstance(value, datetime):
        time = value
    else:
        raise TypeError(f"{name} must be {_KINDS}, or a sequence of these, got {value!r}")
    # pandas's NaT is an instance of datetime, and does not equal itself.
    if time != time:
        raise ValueError(f"{name} must be a time, got {value!r}")
    if time.utcoffset() is None:
        told = "add an offset as in '2025-06-21T12:00+02:00', or Z for UTC"
        how = told if isinstance(value, str) else "use .replace(tzinfo=timezone.utc) if it is in UTC"
        raise ValueError(f"{name} must have a time zone, got {value!r}: {how}")
    return time


def _of_numpy(name: str, value: np.datetime64) -> datetime:
    if np.isnat(value):
        raise ValueError(f"{name} must be a time, got {value!r}")
    if not _YEARS[0] <= value.astype("datetime64[Y]") <= _YEARS[1]:
        raise ValueError(f"{name} must be between the years 1 and 9999, got {value}")
    time: datetime = value.astype("datetime64[us]").item()
    return time.replace(tzinfo=timezone.utc)


def _of_text(name: str, value: str) -> datetime:
    try:
        # Python 3.10 cannot parse Z.
        return datetime.fromisoformat(value[:-1] + "+00:00" if value[-1:] in ("Z", "z") else value)
    except ValueError:
        raise ValueError(f"{name} must be ISO 8601, as '2025-06-21T12:00+02:00', got {value!r}") from None
