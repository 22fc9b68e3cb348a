"""Views that are compressed by meshoptimizer (EXT_meshopt_compression), by the package meshopt."""

from __future__ import annotations

from pathlib import Path

from .part import Part

# The second has the same form, and one more version of the codec.
NAMES = ("EXT_meshopt_compression", "KHR_meshopt_compression")
_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTERS = ("NONE", "OCTAHEDRAL", "QUATERNION", "EXPONENTIAL", "COLOR")
# Most output bytes per compressed byte: 256 rows of four bytes take one, and an index takes a third.
_MOST = {"ATTRIBUTES": 1024, "TRIANGLES": 12, "INDICES": 4}


def compressed(view: Part) -> Part | None:
    """Return what a view says of its compressed form; None if it has none."""
    found = (view.extension(name) for name in NAMES)
    return next((part for part in found if part is not None), None)


def decompressed(path: Path, told: Part, data: memoryview, is_required: bool) -> memoryview | None:
    """Return the bytes of a view by its compressed ones.

    Parameters
    ----------
    path : Path
        The file, for the error.
    told : Part
        Result of `compressed`.
    data : memoryview
        The compressed bytes.
    is_required : bool
        True if the file has no other form of the view.

    Returns
    -------
    memoryview, or None if meshopt is not installed and the file has another form

    Raises
    ------
    ImportError
        If meshopt is not installed, and the file has no other form.
    ValueError
        If they cannot be decompressed.
    """
    try:
        import meshopt
    except ImportError:
        if not is_required:
            return None
        raise ImportError(
            f"{path} is compressed by meshoptimizer, which needs meshopt: pip install 'raywright[meshopt]'"
        ) from None
    mode, filter_ = told.text("mode"), told.text("filter", "NONE")
    count, size = told.integer("count", least=1), told.integer("byteStride", least=2, most=256)
    for name, value, known in (("mode", mode, _MODES), ("filter", filter_, _FILTERS)):
        if value not in known:
            raise ValueError(f"{told.at(name)} must be one of {', '.join(known)}, and is {value[:20]}")
    if count * size > _MOST[mode] * len(data):
        raise ValueError(f"{told.place} has {len(data)} bytes, too few for {count} rows of {size}")
    try:
        rows = meshopt.decode_gltf_buffer(bytes(data), count, size, mode, filter_)
        return memoryview(rows.tobytes())
    except MemoryError:
        raise
    except Exception as error:
        raise ValueError(f"{told.place} holds no bytes of meshoptimizer") from error
