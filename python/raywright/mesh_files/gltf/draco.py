"""Primitives that are compressed by Draco (KHR_draco_mesh_compression), by the package DracoPy."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .document import Document
from .part import Part

NAME = "KHR_draco_mesh_compression"


def decompressed(document: Document, primitive: Part) -> Iterator[tuple[Part, str, NDArray[Any]]]:
    """Yield the numbers of the accessors that a compressed primitive names: of a part, by their name in it.

    Raises
    ------
    ImportError
        If DracoPy is not installed, and the file has no other form of the primitive.
    ValueError
        If the numbers cannot be decompressed, or there is no such attribute.
    """
    compressed = primitive.extension(NAME)
    if compressed is None:
        return
    try:
        import DracoPy
    except ImportError:
        if NAME not in document.root.texts("extensionsRequired"):
            return
        raise ImportError(
            f"{document.path} is compressed by Draco, which needs DracoPy: pip install 'raywright[draco]'"
        ) from None
    data, _ = document.view(compressed)
    try:
        found = DracoPy.decode(bytes(data))
    except MemoryError:
        raise
    except Exception as error:
        raise ValueError(f"{compressed.place} holds no mesh of Draco") from error
    arrays = {one["unique_id"]: np.asarray(one["data"]) for one in found.attributes}
    attributes, named = primitive.part("attributes"), compressed.part("attributes")
    for name in named.names():
        number = named.integer(name)
        if number not in arrays:
            raise ValueError(f"{named.at(name)} is {number}, which the mesh of Draco has not")
        yield attributes, name, arrays[number].reshape(len(arrays[number]), -1)
    if "indices" in primitive:
        faces = getattr(found, "faces", None)
        if faces is None:
            raise ValueError(f"{compressed.place} has no faces")
        yield primitive, "indices", np.asarray(faces).reshape(-1, 1)
