"""Checkpoints of renders: files to resume from."""

from __future__ import annotations

import errno
import json
import os
import threading
import time
import zlib
from collections.abc import Mapping
from contextlib import suppress
from os import PathLike
from pathlib import Path
from typing import Any, NoReturn

from .. import _core
from ..io.quiet import warn_caller

# Least seconds between writes, also as a multiple of the time that a write takes.
_SECONDS = 60.0
_SHARE = 20.0

_MAGIC = b"raywright checkpoint 1\n"
# Above the size of any header, so that files of other kinds are rejected.
_MOST_HEADER = 1 << 16


def held(path: str | PathLike[str]) -> dict[str, Any]:
    """Return the settings of the render in a checkpoint file; nothing if there is no such file.

    Raises
    ------
    FileNotFoundError
        If the folder is missing.
    IsADirectoryError
        If the path is a folder.
    """
    if Path(path).is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not Path(path).absolute().parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(Path(path).parent))
    with suppress(OSError, ValueError), open(path, "rb") as file:
        if file.read(len(_MAGIC)) == _MAGIC:
            length = int.from_bytes(file.read(4), "little")
            of = json.loads(file.read(min(length, _MOST_HEADER)))["of"]
            return of if isinstance(of, dict) else {}
    return {}


class Checkpoints:
    """The checkpoint of one render: a file, written again and again, each time whole or not at all.

    The file is a line with its format, then a JSON header with the render's settings and the length of the
    data, then the film, compressed. It holds nothing that is executed.

    Parameters
    ----------
    path : str or path
        The file.
    identity : dict of str to str, number or None
        Settings of the render, by the names that users know: a checkpoint of other settings is refused.
    """

    def __init__(self, path: str | PathLike[str], identity: Mapping[str, Any]) -> None:
        self.path = Path(path)
        self.trouble: str | None = None
        self._identity = dict(identity)
        self._cost = 0.0
        self._last = time.monotonic()
        self._writer: threading.Thread | None = None

    def read(self, most: int) -> bytes | None:
        """Return the film that the file holds, of so many bytes at most; None if there is no file.

        Raises
        ------
        ValueError
            If the file is truncated, damaged, no checkpoint, or of another render: the message tells the
            difference.
        OSError
            If it cannot be read.
        """
        if not self.path.exists():
            return None
        with open(self.path, "rb") as file:
            if file.read(len(_MAGIC)) != _MAGIC:
                self.refuse("is not a checkpoint of this version")
            length = int.from_bytes(file.read(4), "little")
            if length > _MOST_HEADER:
                self.refuse("is damaged")
            header = self._header(file.read(length))
            self._compare(header["of"])
            size, packed = header["bytes"], header["packed"]
            # zlib makes incompressible data only slightly longer.
            if not 0 <= size <= most or not 0 <= packed <= size + (size >> 8) + 1024:
                self.refuse("is damaged")
            data = file.read(packed + 1)
        if len(data) < packed:
            self.refuse("is truncated")
        unpacked = zlib.decompressobj()
        try:
            film = unpacked.decompress(data, size + 1)
        except zlib.error:
            self.refuse("is damaged")
        if len(data) > packed or len(film) != size or not unpacked.eof:
            self.refuse("is damaged")
        return film

    def refuse(self, why: str) -> NoReturn:
        """Raise the ValueError that says why a file is of no use."""
        raise ValueError(f"checkpoint {self.path} {why}")

    def wait(self) -> float:
        """Return the seconds until the file should be written."""
        return max(self._last + max(_SECONDS, _SHARE * self._cost) - time.monotonic(), 0.0)

    def write_beside(self, rendering: _core.Rendering) -> None:
        """Write the file while the render goes on, unless the last write is still running."""
        if self._writer is not None and self._writer.is_alive():
            return
        self._tell()
        self._last = time.monotonic()
        film = rendering.to_bytes()
        self._writer = threading.Thread(target=self._write, args=(film,), name="raywright-checkpoint")
        self._writer.start()

    def write(self, rendering: _core.Rendering) -> None:
        """Write the file now; a failure gives a warning only."""
        if self._writer is not None:
            self._writer.join()
        self._write(rendering.to_bytes())
        self._tell()

    def _write(self, film: bytes) -> None:
        began = time.monotonic()
        # A fixed name, so that the next write reuses the leftover of a killed process. In the same folder,
        # since only there the rename is atomic.
        beside = self.path.with_name(self.path.name + ".part")
        try:
            packed = zlib.compress(film, 1)
            header = {"of": self._identity, "bytes": len(film), "packed": len(packed)}
            text = json.dumps(header).encode()
            try:
                with open(beside, "wb") as file:
                    for part in (_MAGIC, len(text).to_bytes(4, "little"), text, packed):
                        file.write(part)
                    file.flush()
                    os.fsync(file.fileno())
                os.replace(beside, self.path)
            except BaseException:
                with suppress(OSError):
                    beside.unlink()
                raise
            _sync_folder(self.path.absolute().parent)
            self.trouble = None
        except (OSError, MemoryError) as error:
            told = error.strerror if isinstance(error, OSError) and error.strerror else "out of memory"
            self.trouble = f"the checkpoint {self.path} could not be written: {told[:1].lower()}{told[1:]}"
        self._cost = time.monotonic() - began

    def _tell(self) -> None:
        """Warn of trouble at once: the picture may take hours."""
        if self.trouble is not None:
            # If warnings are errors, this one must not cost the picture.
            with suppress(RuntimeWarning):
                warn_caller(self.trouble)

    def _header(self, text: bytes) -> dict[str, Any]:
        try:
            header = json.loads(text)
            kinds = (type(header["of"]), type(header["bytes"]), type(header["packed"]))
            if kinds == (dict, int, int):
                return dict(header)
        except (ValueError, KeyError, TypeError, RecursionError):
            pass
        self.refuse("is truncated or damaged")

    def _compare(self, theirs: dict[str, Any]) -> None:
        differ = []
        for name, mine in self._identity.items():
            other = theirs.get(name)
            if other == mine and type(other) is type(mine):
                continue
            values = f"{name} {_told(other)} instead of {_told(mine)}"
            differ.append(f"another {name}" if _is_digest(mine) else values)
        if differ or theirs.keys() - self._identity.keys():
            self.refuse(f"is of another render: it has {', '.join(differ) or 'other settings'}")


def _is_digest(value: Any) -> bool:
    return isinstance(value, str) and len(value) == 64


def _told(value: Any) -> str:
    # Values of a file may be long.
    told = value if isinstance(value, str) else repr(value)
    return told if len(told) <= 40 else f"{told[:37]}..."


def _sync_folder(folder: Path) -> None:
    """Let the file's new name survive a loss of power, where folders can be synchronised."""
    with suppress(OSError):
        number = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(number)
        finally:
            os.close(number)
