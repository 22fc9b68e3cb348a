"""Pictures that a stage names: files, and parts of packages."""

from __future__ import annotations

import errno
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...io.pictures import read, read_linear


class Pictures:
    """Pictures by the path of their asset, each decoded once."""

    def __init__(self) -> None:
        self._kept: dict[tuple[str, bool], NDArray[Any]] = {}

    def read(self, asset: Any, linear: bool = False) -> NDArray[Any]:
        """Return the picture of an asset, as `io.pictures.read` does, or as `read_linear` does.

        Raises
        ------
        FileNotFoundError
            If it is missing.
        ValueError
            If it is not a picture that can be read.
        """
        name = str(asset.resolvedPath or asset.path)
        key = name, linear
        if key not in self._kept:
            with _file(name) as path:
                try:
                    found: NDArray[Any] = np.asarray(read_linear(path) if linear else read(path))
                except ValueError as error:
                    raise ValueError(str(error).replace(str(path), name)) from error
            # Several textures share it.
            found.flags.writeable = False
            self._kept[key] = found
        return self._kept[key]


@contextmanager
def _file(name: str) -> Iterator[Path]:
    """Yield a file with the bytes of an asset: a part of a package is copied out of it."""
    from pxr import Ar

    if not Ar.IsPackageRelativePath(name):
        yield Path(name)
        return
    asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(name))
    if not asset:
        raise FileNotFoundError(errno.ENOENT, "no such file", name)
    _, inner = Ar.SplitPackageRelativePathInner(name)
    with tempfile.TemporaryDirectory() as folder:
        # USD detects formats by their suffix.
        path = Path(folder) / f"picture{Path(inner).suffix}"
        path.write_bytes(asset.GetBuffer())
        yield path
