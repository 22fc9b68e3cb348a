"""Pictures in two independent halves of samples, for the denoiser."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _core
from ..arrays import frozen
from ..cameras import AnyCamera
from ..scene.scene import Scene
from .aovs import seen

# Samples per pixel of the two sets of first-hit features.
_SAMPLES = 8


@dataclass(frozen=True, eq=False, repr=False)
class Halves:
    """A picture in two independent halves of its samples. Arrays are read-only.

    Attributes
    ----------
    quarters : (4, H, W, 3) float32
        Means of four independent parts of the samples; the first two parts are one half. The batches of a
        sampler are dealt to the parts in turn.
    variance : (2, H, W, 3) float32
        The variance of the mean of either half, as for independent samples.
    albedo, normal : (2, H, W, 3) float32
        Two independent pictures of the first hit's albedo and shading normal.
    depth : (2, H, W) float32
        Two independent pictures of the distance along the ray; infinite for the background.
    samples : int
        Samples per pixel of the picture.
    patch : int
        Side of the square patches of pixels that share paths.

    See Also
    --------
    Image.denoise : Takes them.

    Examples
    --------
    >>> scene = rw.Scene(rw.Sphere(), environment=1.0)
    >>> camera = rw.Camera((0, 0, 5), (0, 0, 0), width=4, height=4)
    >>> image = rw.render(scene, camera, samples=16, halves=True, progress=False)
    >>> image.halves.rgb.shape, image.halves.samples
    ((2, 4, 4, 3), 16)
    >>> np.allclose(image.halves.rgb.mean(axis=0), image.rgb, atol=1e-5)
    True
    """

    quarters: NDArray[np.float32]
    variance: NDArray[np.float32]
    albedo: NDArray[np.float32]
    normal: NDArray[np.float32]
    depth: NDArray[np.float32]
    samples: int
    patch: int = 1

    def __post_init__(self) -> None:
        for name in ("quarters", "variance", "albedo", "normal", "depth"):
            object.__setattr__(self, name, frozen(getattr(self, name)))

    @property
    def rgb(self) -> NDArray[np.float32]:
        """The pictures of the two halves, (2, H, W, 3) float32."""
        first, second, third, fourth = self.quarters
        return np.stack([(first + second) / 2, (third + fourth) / 2])

    @property
    def features(self) -> NDArray[np.float64]:
        """Albedo, normal and nearness, (2, H, W, 7) float64: nearness is 0 for the background."""
        depth = self.depth.astype(np.float64)
        is_seen = np.isfinite(depth)
        middle = float(np.median(depth[is_seen])) if is_seen.any() else 0.0
        nearness = middle / (middle + depth) if middle > 0 else is_seen * 0.5
        parts: list[NDArray[Any]] = [self.albedo, self.normal, nearness[..., np.newaxis]]
        return np.ascontiguousarray(np.nan_to_num(np.concatenate(parts, axis=-1, dtype=np.float64)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Halves):
            return NotImplemented
        return self.samples == other.samples and all(
            np.array_equal(getattr(self, name), getattr(other, name), equal_nan=True)
            for name in ("quarters", "variance", "albedo", "normal", "depth")
        )

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Any, ...]:
        # Through the constructor, because unpickled arrays would be writeable.
        parts = self.quarters, self.variance, self.albedo, self.normal, self.depth, self.samples, self.patch
        return Halves, parts

    def __repr__(self) -> str:
        _, height, width, _ = self.quarters.shape
        return f"Halves({width}x{height}, {self.samples} samples)"


def halves_of(
    rendering: _core.Rendering, scene: Scene, camera: AnyCamera, seed: int, threads: int | None
) -> Halves | None:
    """Return the halves of a render that keeps them; None where a part of the samples has no whole batch."""
    kept = rendering.halves
    if kept is None:
        return None
    names = ("albedo", "shading_normal", "depth")
    # Seeds differ between the two, and from that of the picture's own `aov`.
    views = [seen(scene, camera, names, _SAMPLES, (seed + more) % 2**64, threads) for more in (1, 2)]
    albedo, normal, depth = (np.stack([view[name] for view in views]) for name in names)
    return Halves(*kept, albedo, normal, depth, rendering.samples, rendering.patch)
