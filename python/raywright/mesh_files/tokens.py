"""Text of mesh files as numbers, whatever stands between them."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .. import _core

_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_UTF8 = b"\xef\xbb\xbf"
# White space and line ends outside ASCII.
_ODD_SPACE = re.compile("[\xa0\u1680\u2000-\u200a\u202f\u205f\u3000]")
_ODD_LINE = re.compile("[\x85\u2028\u2029]")
# ASCII's white space and separators other than spaces and line feeds.
_WHITE = bytes.maketrans(b"\t\v\f\x1c\x1d\x1e\x1f", b" \n\n\n\n\n ")


def without_mark(data: bytes) -> bytes:
    """Return text without a byte-order mark, as UTF-8 if the mark is that of UTF-16."""
    if data.startswith(_UTF16):
        return data.decode("utf-16", "replace").encode()
    return data.removeprefix(_UTF8)


def plain_text(data: bytes, names: bool = False) -> bytes:
    """Return text as UTF-8 without a byte-order mark, with spaces and line feeds as its only white space.

    Where it may have names of files in it, white space that is not of ASCII stays.
    """
    data = without_mark(data).rstrip(b"\0")
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    if not names and not data.isascii():
        text = data.decode("utf-8", "replace")
        if _ODD_SPACE.search(text) or _ODD_LINE.search(text):
            data = _ODD_LINE.sub("\n", _ODD_SPACE.sub(" ", text)).encode()
    return data.translate(_WHITE)


def leading_numbers(text: bytes, skipped: Sequence[bytes] = ()) -> NDArray[np.float64]:
    """Return the numbers that a text begins with; words of `skipped` may stand between them."""
    return _core.leading_numbers(text, skipped)[0]


def word_at(text: bytes, index: int) -> str | None:
    """Return a word of a text as a message shows it, such as ``'abc'``; None behind its end."""
    words = text.split(maxsplit=index + 1)
    return repr(words[index][:20].decode("utf-8", "replace")) if index < len(words) else None


def lines_of(text: bytes) -> list[bytes]:
    """Return the lines of a text that are not blank."""
    return [line for line in text.split(b"\n") if line.strip()]
