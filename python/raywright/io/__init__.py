"""Files of pixels, and quiet for the libraries that read files."""

from __future__ import annotations

from .pictures import check_writable

__all__ = [
    "check_writable",
]
