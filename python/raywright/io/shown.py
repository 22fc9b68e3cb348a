"""Pictures for the eye: 8 bits with the sRGB transfer, as arrays and as files."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .tone import DEFAULT, toned

# Pillow's format name for each file name extension.
FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP", ".avif": "AVIF"}
# Almost visually lossless, and without chroma subsampling, which would bleed colors over neighbors.
_HOW: dict[str, dict[str, Any]] = {
    "PNG": {},
    "JPEG": {"quality": 92, "subsampling": 0},
    "WEBP": {"quality": 92, "method": 4},
    "AVIF": {"quality": 85, "subsampling": "4:4:4"},
}


def check_format(suffix: str) -> None:
    """Raise an ImportError if the installed Pillow cannot write files of such an ending."""
    name = FORMATS[suffix]
    if name in ("WEBP", "AVIF"):
        from PIL import features

        # Pillow warns if it does not know the queried feature.
        known = features.get_supported_modules() if name.lower() in features.modules else []
        if name.lower() not in known:
            raise ImportError(f"saving {suffix} needs a Pillow that has {name}: pip install 'Pillow>=11.3'")


def srgb(
    rgb: NDArray[np.floating[Any]],
    alpha: NDArray[np.floating[Any]] | None = None,
    exposure: float = 0.0,
    tone: str = DEFAULT,
) -> NDArray[np.uint8]:
    """Linear colors to 8 bits, with a tone (see `toned`) and the sRGB transfer (IEC 61966-2-1).

    With `alpha`, (H, W), colors are premultiplied, and the result is (H, W, 4), not premultiplied: tones
    apply to the whole color of the covering surface, not to its share of the pixel.
    """
    if alpha is None:
        return _bytes(_transfer(toned(rgb, exposure, tone)))
    cover = np.clip(np.nan_to_num(np.asarray(alpha, np.float64), nan=0.0), 0.0, 1.0)[..., np.newaxis]
    whole = np.divide(rgb, cover, out=np.zeros(rgb.shape, np.float64), where=cover > 0)
    # Alpha is not light and is stored linearly.
    return _bytes(np.concatenate([_transfer(toned(whole, exposure, tone)), cover], axis=-1))


def encoded(pixels: NDArray[np.uint8], suffix: str) -> bytes:
    """Return the bytes of a picture file with such an ending, made by `srgb`."""
    from PIL import Image

    name = FORMATS[suffix]
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format=name, **_HOW[name])
    return out.getvalue()


def png(rgb: NDArray[np.floating[Any]], alpha: NDArray[np.floating[Any]] | None = None) -> bytes:
    """Return a PNG file of linear colors, with the tone that all pictures have."""
    return encoded(srgb(rgb, alpha), ".png")


def _transfer(linear: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _bytes(shares: NDArray[np.float64]) -> NDArray[np.uint8]:
    return np.asarray(shares * 255 + 0.5, np.uint8)
