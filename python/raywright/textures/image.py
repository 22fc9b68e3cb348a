"""Pictures on surfaces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from os import PathLike
from typing import Any, Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from ..arrays import Triple, choice, frozen
from ..descriptions import restored, state
from ..foreign_arrays import as_array
from .texture import Texture
from .transform import UvTransform

Wrap: TypeAlias = Literal["repeat", "clamp", "mirror"]
Filter: TypeAlias = Literal["trilinear", "bilinear", "nearest"]
Channel: TypeAlias = Literal["r", "g", "b", "a"]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class ImageTexture(Texture):
    """A picture over texture coordinates, its lower left at (0, 0) and its upper right at (1, 1).

    Parameters
    ----------
    image : (H, W), (H, W, C) array, or path
        Rows from the top, of 1 to 4 channels: a gray, gray and alpha, red, green and blue, or these and
        alpha. uint8 is kept as it is, float32 too; uint16 and other floats become float32. A path names a
        PNG, EXR, NPY or any other picture that Pillow reads.
    linear : bool
        True if integers are linear values; otherwise they are decoded from sRGB. Floats and alpha are always
        linear.
    channel : {"r", "g", "b", "a"}, optional
        Channel to use where a single number is needed; all if not given.
    filter : {"trilinear", "bilinear", "nearest"}
        "trilinear" averages detail finer than a pixel, from a pyramid of smaller copies (Williams, "Pyramidal
        Parametrics", 1983); "bilinear" interpolates between texels, and "nearest" takes the nearest one.
    wrap : {"repeat", "clamp", "mirror"}, or two of them
        Extension beyond the edges, along both axes or along u and along v.
    transform : UvTransform or float, optional
        Map from the surface's coordinates to the picture's; a number is the number of repetitions.

    Attributes
    ----------
    image : (H, W, C) array
        The picture, uint8 or float32, read-only.

    Raises
    ------
    ValueError
        If the array is empty or of another shape, a number is not finite, a channel is missing, or an option
        is unknown.
    TypeError
        If an argument has another type.
    FileNotFoundError
        If the file is missing.

    See Also
    --------
    VertexColors : Colors of a mesh.

    Notes
    -----
    Unused channels are dropped when the scene is compiled: a channel of uint8 takes 1 byte a point and, for
    "trilinear", a third as many points more, of float32.

    Examples
    --------
    >>> picture = np.array([[[255, 0, 0], [0, 255, 0]]], np.uint8)
    >>> texture = rw.ImageTexture(picture, filter="nearest")
    >>> texture.image.shape, texture.channels
    ((1, 2, 3), (0, 1, 2))
    """

    image: NDArray[Any]
    linear: bool
    channel: Channel | None
    filter: Filter
    wrap: tuple[Wrap, Wrap]
    transform: UvTransform

    def __init__(
        self,
        image: NDArray[Any] | str | PathLike[str],
        linear: bool = False,
        channel: Channel | None = None,
        filter: Filter = "trilinear",
        wrap: Wrap | tuple[Wrap, Wrap] = "repeat",
        transform: UvTransform | float | None = None,
    ) -> None:
        if isinstance(image, str | PathLike):
            from ..io.pictures import read

            image = read(image)
        if not isinstance(linear, bool | np.bool_):
            raise TypeError(f"linear must be True or False, got {linear!r}")
        pixels = _pixels(image, bool(linear))
        if channel is not None:
            choice("channel", channel, get_args(Channel))
            if _index(channel, pixels.shape[2]) is None:
                raise ValueError(f"channel is {channel!r}, but the image has {pixels.shape[2]} channels")
        choice("filter", filter, get_args(Filter))
        both = (wrap, wrap) if isinstance(wrap, str) else tuple(wrap)
        if len(both) != 2:
            raise ValueError(f"wrap must be one word or two, got {wrap!r}")
        for one in both:
            choice("wrap", one, get_args(Wrap))
        if transform is None or isinstance(transform, int | float | np.number):
            transform = UvTransform(1.0 if transform is None else float(transform))
        elif not isinstance(transform, UvTransform):
            came = type(transform).__name__
            raise TypeError(f"transform must be a UvTransform or a number, got {came}")
        self._set(
            image=pixels, linear=bool(linear), channel=channel, filter=filter, wrap=both, transform=transform
        )

    @property
    def channels(self) -> tuple[int, ...]:
        """Channels of the image in use: one of them, or three for red, green and blue."""
        count = self.image.shape[2]
        if self.channel is None:
            return (0, 1, 2) if count > 2 else (0,)
        index = _index(self.channel, count)
        assert index is not None
        return (index,)

    @property
    def range(self) -> tuple[Triple, Triple]:
        """Bounds of its values: the least and the greatest red, green and blue."""
        return self._range

    @cached_property
    def _range(self) -> tuple[Triple, Triple]:
        ends = [np.broadcast_to(end, 3) for end in self._ends()]
        (x, y, z), (r, s, t) = (tuple(float(v) for v in end) for end in ends)
        return (x, y, z), (r, s, t)

    @property
    def decoded(self) -> bool:
        """True if the channels in use are decoded from sRGB."""
        return self.image.dtype == np.uint8 and not self.linear and self.channel != "a"

    def _ends(self) -> list[NDArray[np.float64]]:
        counted = self.image[..., list(self.channels)]
        ends = [counted.min(axis=(0, 1)), counted.max(axis=(0, 1))]
        if self.image.dtype != np.uint8:
            return [end.astype(np.float64) for end in ends]
        shares = [end / 255 for end in ends]
        return [_from_srgb(share) for share in shares] if self.decoded else shares

    def _parts(self) -> tuple[Any, ...]:
        return self.image, self.linear, self.channel, self.filter, self.wrap, self.transform

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, ImageTexture):
            return NotImplemented
        same = self.image is other.image or (
            self.image.dtype == other.image.dtype and np.array_equal(self.image, other.image)
        )
        return self._parts()[1:] == other._parts()[1:] and same

    def __hash__(self) -> int:
        # Equal pictures agree in these; hashing every pixel would be slow.
        return hash((self.image.shape, self._parts()[1:]))

    def __reduce__(self) -> tuple[Any, ...]:
        return restored, (type(self), state(self))

    def __repr__(self) -> str:
        height, width, count = self.image.shape
        parts = [f"{width} x {height} of {count} channels, {self.image.dtype}"]
        parts += ["linear"] if self.linear else []
        parts += [] if self.channel is None else [f"channel={self.channel!r}"]
        parts += [f"filter={self.filter!r}", f"wrap={self.wrap!r}"]
        parts += [] if self.transform == UvTransform() else [repr(self.transform)]
        return f"ImageTexture({', '.join(parts)})"


def _index(channel: str, count: int) -> int | None:
    """Where a channel is among so many; None if it is not."""
    if channel == "a":
        return count - 1 if count in (2, 4) else None
    place = "rgb".index(channel)
    return place if count > 2 else 0


def _pixels(image: Any, linear: bool) -> NDArray[Any]:
    """Return a read-only copy of a picture as (H, W, C), uint8 or float32."""
    array = given = as_array("image", image)
    if array.ndim == 2:
        array = array[..., np.newaxis]
    if array.ndim != 3 or not 1 <= array.shape[2] <= 4 or 0 in array.shape:
        raise ValueError(f"image must have shape (H, W) or (H, W, 1 to 4), got {given.shape}")
    if array.dtype.newbyteorder("=") == np.uint16:
        colors = array.shape[2] - (array.shape[2] in (2, 4))
        shares = array / 65535
        if not linear:
            shares[..., :colors] = _from_srgb(shares[..., :colors])
        array = shares.astype(np.float32)
    elif array.dtype != np.uint8:
        if array.dtype.kind != "f":
            raise TypeError(f"image must be uint8, uint16 or floats, got dtype {array.dtype}")
        array = array.astype(np.float32, copy=False)
        finite = np.isfinite(array)
        if not finite.all():
            row, column, _ = np.argwhere(~finite)[0]
            raise ValueError(
                f"image must be finite as float32, got NaN or infinity in row {row}, column {column}"
            )
    return frozen(array)


def _from_srgb(c: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shares of 8 bits to linear (IEC 61966-2-1)."""
    return np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
