"""Files of pixels, and quiet for the libraries that read files."""

from __future__ import annotations

from ..public_names import public_names
from .pictures import check_writable

__all__ = [
    "check_writable",
]
__dir__ = public_names(__name__)
