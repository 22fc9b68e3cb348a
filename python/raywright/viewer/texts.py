"""The texts of a page: its own, and the kernels of graphics processors."""

from __future__ import annotations

import re
from functools import lru_cache
from importlib.resources import files

from ..gpu.kernels import text as kernel

_SCRIPT, _SHADER = "text/javascript; charset=utf-8", "text/plain; charset=utf-8"
# Each module follows its imports.
MODULES = (
    "orbit.js",
    "device.js",
    "error.js",
    "passes.js",
    "paths.js",
    "drawing.js",
    "stream.js",
    "figures.js",
    "controls.js",
    "viewer.js",
    "wire.js",
)
SHADERS = (
    "walk.wgsl",
    "shading.wgsl",
    "sight.wgsl",
    "screen.wgsl",
    "lines.wgsl",
    "path.wgsl",
    "brought.wgsl",
    "error.wgsl",
)
# Static files and their types, by the path after the token.
FILES = {
    "": "text/html; charset=utf-8",
    "page.css": "text/css; charset=utf-8",
    "page.js": _SCRIPT,
    **dict.fromkeys(MODULES, _SCRIPT),
    **dict.fromkeys(SHADERS, _SHADER),
}
_KERNELS = ("walk.wgsl", "shading.wgsl")
_IMPORT = re.compile(r"^import [^;]*;\n", re.MULTILINE)
_EXPORT = re.compile(r"^export ", re.MULTILINE)


@lru_cache
def text(path: str) -> str:
    """Return the text of a file of the page by its name."""
    if path in _KERNELS:
        return kernel(path)
    return (files(__package__) / (path or "page.html")).read_text(encoding="utf-8")


@lru_cache
def bundled(entry: str) -> str:
    """Return a module with all that it imports as one text, for where a module cannot import from beside it.

    All names at the top of modules stand in one scope then, so no two of them have the same.
    """
    parts = (_EXPORT.sub("", _IMPORT.sub("", text(name))) for name in MODULES)
    return "\n".join([*parts, _IMPORT.sub("", text(entry))])
