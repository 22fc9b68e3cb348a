"""The text of OBJ and MTL files: a statement a line."""

from __future__ import annotations

import re

from ..tokens import plain_text

_KEYWORD = re.compile(r"[\w.-]{1,24}", re.ASCII)
_JOINED = re.compile(rb"\\[ \t]*\n")


def text_of(data: bytes) -> bytes:
    """Return a file's text as `plain_text` does, and lines joined where a backslash ends one."""
    return _JOINED.sub(b" ", plain_text(data, names=True))


def name_of(words: bytes) -> str:
    """Return a name as it is shown and compared: white space within is one space."""
    return " ".join(words.decode("utf-8", "replace").split())


def told(text: str, most: int = 40) -> str:
    """Return a text of a file as it may stand in a message: short, and in quotes."""
    return repr(text if len(text) <= most else f"{text[: most - 3]}...")


def told_keyword(text: str) -> str:
    """Return a keyword as it may stand in a message: as it is, if it is one."""
    return text if _KEYWORD.fullmatch(text) else told(text)
