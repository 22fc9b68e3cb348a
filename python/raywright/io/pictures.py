"""Picture files: formats, checks before writing, and reading."""

from __future__ import annotations

import errno
import io
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .quiet import quiet, reason
from .radiance_hdr import read_hdr
from .shown import FORMATS, check_format

# Tags of TIFF files for bits per sample and sample format, and the value for unsigned integers.
_BITS, _SAMPLES, _UNSIGNED = 258, 339, 1
SUFFIXES = (*FORMATS, ".exr", ".npy")


def check_writable(
    path: str | PathLike[str], suffixes: tuple[str, ...] = SUFFIXES, what: str = "a picture"
) -> Path:
    """Find out, before any work is done, whether a picture can be saved at `path`.

    Nothing is left behind, and an existing file stays unchanged.

    Parameters
    ----------
    path : str or path
        File to write.
    suffixes : tuple of str
        Suffixes of supported files, in lower case.
    what : str
        Kind of file, for the error message.

    Returns
    -------
    Path
        The path.

    Raises
    ------
    ValueError
        If the suffix is not one of those.
    ImportError
        If the suffix is one that the installed Pillow cannot write.
    FileNotFoundError, IsADirectoryError, NotADirectoryError, PermissionError, OSError
        If the folder is missing, the path is a folder, or the file cannot be written.
    TypeError
        If `path` is not a path.

    See Also
    --------
    Image.save : Writes the picture.

    Examples
    --------
    >>> rw.io.check_writable("picture.png").name
    'picture.png'
    >>> rw.io.check_writable("picture.gif", suffixes=(".png", ".npy"))
    Traceback (most recent call last):
        ...
    ValueError: a picture is saved as .png, .npy; picture.gif is none of these
    """
    if not isinstance(path, str | PathLike):
        raise TypeError(f"path must be a str or a path, got {type(path).__name__}")
    path = Path(path)
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"{what} is saved as {', '.join(suffixes)}; {path} is none of these")
    if path.suffix.lower() in FORMATS:
        check_format(path.suffix.lower())
    if path.is_dir():
        raise IsADirectoryError(errno.EISDIR, "is a folder", str(path))
    if not path.parent.exists():
        raise FileNotFoundError(errno.ENOENT, "no such folder", str(path.parent))
    # Only trying is reliable: root ignores permissions, and file systems may be read-only or full.
    try:
        with open(path, "xb"):
            pass
    except FileExistsError:
        with open(path, "ab"):
            pass
    else:
        path.unlink()
    return path


def read(path: str | PathLike[str]) -> NDArray[Any]:
    """Read a picture without conversion: (H, W, C), rows from the top, of 1 to 4 channels.

    Parameters
    ----------
    path : str or path
        A PNG or any other picture that Pillow reads (uint8 or, of 16 bits, uint16), an EXR (float32; its
        channels R, G and B, or Y, RY and BY, in Rec. 709, or Y, and A), an HDR (float32), or an NPY.

    Returns
    -------
    (H, W, C) array
        The picture.

    Raises
    ------
    FileNotFoundError
        If the file is missing.
    ValueError
        If it is not a picture that can be read.
    """
    path = Path(path)
    if not path.exists():
        raise FileNotFoundError(errno.ENOENT, "no such file", str(path))
    suffix = path.suffix.lower()
    try:
        if suffix == ".npy":
            # A memory map cannot exceed the file, whatever size its header claims.
            array = np.array(np.load(path, mmap_mode="r", allow_pickle=False))
        elif suffix == ".hdr":
            array = read_hdr(path)
        elif suffix == ".exr":
            # Imported here, because only EXR files need it (import time).
            from .exr.reader import read_exr

            array = read_exr(path, _colors)
        else:
            array = decode(path)
    except (ImportError, MemoryError):
        raise
    except Exception as error:
        # Parsers raise any exception on bad bytes; the caller needs one type of error and one line.
        raise ValueError(f"{path} is not a picture that can be read ({reason(error)})") from error
    return np.asarray(array if array.ndim != 2 else array[..., np.newaxis])


def decode(source: Path | bytes, formats: tuple[str, ...] | None = None) -> NDArray[Any]:
    """Read a picture with Pillow, from a file or from its bytes: (H, W, C), rows from the top.

    Parameters
    ----------
    source : Path or bytes
        The file.
    formats : tuple of str, optional
        Allowed formats, by Pillow's names; any if not given.

    Raises
    ------
    ValueError
        If it has more points than ``PIL.Image.MAX_IMAGE_PIXELS``; found out before anything is decoded.
    Exception
        As Pillow raises for files that it cannot read.
    """
    from PIL import Image, UnidentifiedImageError

    stream = io.BytesIO(source) if isinstance(source, bytes) else source
    try:
        with quiet(Image.DecompressionBombWarning):
            opened = Image.open(stream, formats=formats)
    except (Image.DecompressionBombWarning, Image.DecompressionBombError):
        raise ValueError(_TOO_MANY.format(Image.MAX_IMAGE_PIXELS)) from None
    except UnidentifiedImageError:
        kinds = "Pillow knows" if formats is None else f"is {', '.join(formats)}"
        raise ValueError(f"it is not a picture that {kinds}") from None
    with opened:
        return pixels_of(opened)


def pixels_of(picture: Any) -> NDArray[Any]:
    """Return a picture of Pillow's as an (H, W, C) array: uint8, of 16 bits uint16, of floats float32.

    Integers of 32 bits become 16, as shares of the most that they hold. A gray or a color that the picture
    says is transparent becomes alpha.

    Raises
    ------
    ValueError
        If it has more points than ``PIL.Image.MAX_IMAGE_PIXELS``.
    """
    from PIL import Image

    most = Image.MAX_IMAGE_PIXELS
    if most is not None and picture.width * picture.height > most:
        raise ValueError(_TOO_MANY.format(most))
    # Before the pixels are decoded, because decoding drops the raw mode.
    key = _transparent(picture)
    if picture.mode == "I":
        array = _of_integers(picture)
    elif picture.mode.startswith("I"):
        array = np.asarray(picture).astype(np.uint16)
    else:
        if key is not None and picture.mode == "1":
            picture = picture.convert("L")
        elif picture.mode not in ("L", "LA", "RGB", "RGBA", "F"):
            clear = "A" in picture.getbands() or "transparency" in picture.info
            picture = picture.convert("RGBA" if clear else "RGB")
        array = np.array(picture)
    if key is not None and picture.mode not in ("LA", "RGBA"):
        array = _with_alpha(array, key)
    return array if array.ndim == 3 else array[..., np.newaxis]


def _transparent(picture: Any) -> tuple[int, ...] | None:
    """Return the levels of the one gray or color of a picture that is transparent, as pixels have them."""
    told = picture.info.get("transparency")
    if picture.mode not in ("1", "L", "I", "I;16", "I;16B", "RGB") or not isinstance(told, int | tuple):
        return None
    levels = (told,) if isinstance(told, int) else told
    form = picture.tile[0][3] if getattr(picture, "tile", None) else ""
    form = form[0] if isinstance(form, tuple) else form
    # PNG states levels in its stored bit depth. Pixels have 8 bits for a depth of 1, 2, 4, and for colors of
    # 16.
    bits = {"1": 1, "L;1": 1, "L;2": 2, "L;4": 4}.get(form, 8)
    shift = 8 if str(form).startswith("RGB;16") else 0
    most = 2**bits - 1
    # Some versions of Pillow scale some levels already.
    return tuple((level * 255 // most if level <= most else level) >> shift for level in levels)


def _with_alpha(array: NDArray[Any], key: tuple[int, ...]) -> NDArray[Any]:
    """Return a picture with a last channel that is 0 where its others are all as `key` says."""
    deep = array if array.ndim == 3 else array[..., np.newaxis]
    alpha = np.where((deep == np.array(key)).all(axis=-1), 0, np.iinfo(array.dtype).max)
    return np.concatenate([deep, alpha.astype(array.dtype)[..., np.newaxis]], axis=-1)


def _of_integers(picture: Any) -> NDArray[np.uint16]:
    """Return integers that Pillow has in 32 bits, in 16: of TIFF files as shares of the most they hold."""
    array = np.asarray(picture)
    tags = getattr(picture, "tag_v2", {})
    if _first(tags.get(_BITS)) != 32 and array.min(initial=0) >= 0 and array.max(initial=0) <= 0xFFFF:
        return array.astype(np.uint16)
    if _first(tags.get(_SAMPLES)) == _UNSIGNED:
        shares = array.view(np.uint32) / (2**32 - 1)
    else:
        shares = np.maximum(array, 0) / (2**31 - 1)
    whole: NDArray[np.uint16] = np.rint(shares * 0xFFFF).astype(np.uint16)
    return whole


def _first(told: Any) -> Any:
    return told[0] if isinstance(told, tuple) and told else told


def _colors(names: list[str]) -> list[str]:
    """Return the channels of an EXR file that are its picture, of all that it has."""
    if "R" in names:
        wanted = ["R", "G", "B"]
    else:
        wanted = ["Y", "RY", "BY"] if "RY" in names and "BY" in names else ["Y"]
    if missing := [name for name in wanted if name not in names]:
        raise ValueError(f"it has no channel {missing[0]}, only {', '.join(names)}")
    return [*wanted, *(["A"] if "A" in names else [])]


def read_linear(path: str | PathLike[str]) -> NDArray[np.floating[Any]]:
    """Return the linear colors of a picture file, (H, W, 3), or an NPY file's contents, from the top row on.

    EXR, HDR and NPY files are not converted. Files of 8 or 16 bits are taken as sRGB. Transparency is left
    out. Errors are those of `read`.
    """
    array = read(path)
    if Path(path).suffix.lower() == ".npy":
        return array[..., 0] if array.shape[-1] == 1 else array
    colors = array[..., : 1 if array.shape[-1] < 3 else 3]
    if colors.dtype.kind == "u":
        coded = colors / np.iinfo(colors.dtype).max
        colors = np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)
    return np.broadcast_to(colors, (*colors.shape[:2], 3)).astype(np.float32)


_TOO_MANY = "it has more than {} points by its header, which is PIL.Image.MAX_IMAGE_PIXELS"
