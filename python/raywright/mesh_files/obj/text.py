"""The text of OBJ and MTL files: a statement a line."""

import re

_UTF16 = (b"\xff\xfe", b"\xfe\xff")
_UTF8 = b"\xef\xbb\xbf"
_KEYWORD = re.compile(r"[\w.-]{1,24}", re.ASCII)
_JOINED = re.compile(rb"\\[ \t]*\n")


def text_of(data: bytes) -> bytes:
    """Return a file's text with one kind of line end, and lines joined where a backslash ends one."""
    if data.startswith(_UTF16):
        data = data.decode("utf-16", "replace").encode()
    if b"\r" in data:
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    return _JOINED.sub(b" ", data.removeprefix(_UTF8))


def name_of(words: bytes) -> str:
    """Return a name as it is shown and compared: white space within is one space."""
    return " ".join(words.decode("utf-8", "replace").split())


def told(text: str, most: int = 40) -> str:
    """Return a text of a file as it may stand in a message: short, and in quotes."""
    return repr(text if len(text) <= most else f"{text[: most - 3]}...")


def told_keyword(text: str) -> str:
    """Return a keyword as it may stand in a message: as it is, if it is one."""
    return text if _KEYWORD.fullmatch(text) else told(text)
