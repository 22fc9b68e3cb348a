"""Pictures of renders in progress, computed on access."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import sealed
from .image import Image


class AtRest:
    """A render at rest, with the interface of `_core.Sight`."""

    def __init__(self, rendering: _core.Rendering) -> None:
        self._rendering = rendering

    def outline(self) -> _core.Rendering:
        """Return the render."""
        return self._rendering

    copy = outline

    @property
    def rgb(self) -> NDArray[np.float32]:
        """The picture."""
        return self._rendering.rgb

    @property
    def counts(self) -> NDArray[np.uint32]:
        """Samples of each pixel."""
        return self._rendering.counts

    @property
    def amiss(self) -> tuple[int, int]:
        """Number of samples that were not finite or negative, and number of clamped samples."""
        return self._rendering.dropped, self._rendering.clamped[0]


Sight = AtRest | _core.Sight


class ImageSoFar(Image):
    """A picture that is still being worked on.

    It knows the render's state as a whole; pixels, their errors and the like are computed when they are asked
    for, while it is shown. `settle` computes all of it, after which it does not change.
    """

    _sight: Sight
    _made: Callable[[_core.Rendering], Image]
    _size: tuple[int, int]
    _counted: bool
    # Warnings that need no pixel.
    _doubts: tuple[str, ...]

    @classmethod
    def of(
        cls,
        sight: Sight,
        made: Callable[[_core.Rendering], Image],
        outline: Callable[[_core.Rendering], Mapping[str, Any]],
        size: tuple[int, int],
        counted: bool,
    ) -> ImageSoFar:
        """Return one field of the picture.

        Parameters
        ----------
        sight : Sight
            Where the render is seen.
        made : callable
            Makes a whole picture of a render at rest.
        outline : callable
            Pictures of a render in progress: statistics of all pixels without any pixels, and warnings as
            ``_doubts``.
        size : (int, int)
            Width and height in pixels.
        counted : bool
            True if samples are counted for each pixel.
        """
        image = object.__new__(cls)
        known = sight.outline()
        assert known is not None, "there is something to be seen"
        own = {"_sight": sight, "_made": made, "_size": size, "_counted": counted}
        vars(image).update(own, **outline(known))
        return image

    @property
    def is_whole(self) -> bool:
        """True if all fields were computed, errors of pixels included."""
        return "_whole" in vars(self)

    def settle(self) -> None:
        """Compute all of it."""
        for name in ("standard_error", "pooled_error", "degrees", "rgb", "aov", "warnings", "biased"):
            getattr(self, name)

    def settle_seen(self) -> None:
        """Compute the buffers for callers that keep them without errors of pixels: these are NaN."""
        unknown = np.broadcast_to(np.float32(np.nan), self.rgb.shape)
        vars(self).update(standard_error=unknown, pooled_error=None, degrees=None)
        self.settle()

    def _extent(self) -> tuple[int, int]:
        return self._size

    @cached_property
    def _whole(self) -> Image:
        rendering = self._sight.copy()
        if rendering is None:
            raise RuntimeError("a partial picture was used by another thread after its callback had returned")
        return self._made(rendering)

    @cached_property
    def rgb(self) -> NDArray[np.float32]:
        """The picture so far."""
        if self.is_whole:
            return self._whole.rgb
        pixels = self._sight.rgb
        return self._whole.rgb if pixels is None else sealed(pixels)

    @cached_property
    def aov(self) -> Mapping[str, NDArray[Any]]:
        """Samples of each pixel, if they may differ."""
        counts = self._sight.counts if self._counted else None
        return {} if counts is None else {"samples": sealed(counts)}

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Reasons to distrust the picture."""
        return self._whole.warnings if any(self._sight.amiss or ()) else self._doubts

    @cached_property
    def biased(self) -> bool:
        """True if samples were clamped."""
        return bool((self._sight.amiss or (0, 0))[1])

    @cached_property
    def standard_error(self) -> NDArray[np.float32]:
        """Standard error of each pixel, by its own samples."""
        return self._whole.standard_error

    @cached_property
    def pooled_error(self) -> NDArray[np.float32] | None:
        """The same by the pixels around too."""
        return self._whole.pooled_error

    @cached_property
    def degrees(self) -> NDArray[np.float32] | None:
        """Degrees of freedom of that."""
        return self._whole.degrees
