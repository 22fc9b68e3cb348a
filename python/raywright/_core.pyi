"""The compiled core. Everything here takes validated, C-contiguous arrays; the public face is the package."""

from collections.abc import Callable
from typing import Any, final

import numpy as np
from numpy.typing import NDArray

__all__ = ["AcceleratorInfo", "CompiledScene", "Rendering", "camera_rays", "render", "simd"]

def simd() -> str:
    """Return the SIMD level the kernels run at: "scalar", "sse2" or "avx2"; ``RAYWRIGHT_SIMD`` forces one."""

@final
class AcceleratorInfo:
    """What the compiled accelerator looks like."""

    @property
    def kind(self) -> str: ...
    @property
    def primitives(self) -> int: ...
    @property
    def nodes(self) -> int: ...
    @property
    def leaves(self) -> int: ...
    @property
    def depth(self) -> int: ...
    @property
    def bytes(self) -> int: ...
    @property
    def build_seconds(self) -> float: ...
    @property
    def sah_cost(self) -> float: ...

@final
class CompiledScene:
    """A scene ready for rays, read by attribute from a `raywright.Scene` (shapes, lights, environment)."""

    def __new__(cls, scene: Any, accelerator: Any) -> CompiledScene: ...
    def intersect(
        self,
        origins: NDArray[np.floating[Any]],
        directions: NDArray[np.floating[Any]],
        t_min: NDArray[np.float64],
        t_max: NDArray[np.float64],
        threads: int | None,
        row: int,
    ) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
        """Closest hits of N rays: (t (N,), shape_id (N,), primitive (N,), uv (N,2)).

        ``origins`` and ``directions`` are (N,3) or (1,3), float32 or float64, each of either type; ``t_min``
        and ``t_max`` are (N,) or (1,). ``row`` is the length of an image's rows, which is then traced in
        tiles; 0 for what is no image.
        """
    def occluded(
        self,
        origins: NDArray[np.floating[Any]],
        directions: NDArray[np.floating[Any]],
        t_min: NDArray[np.float64],
        t_max: NDArray[np.float64],
        threads: int | None,
        row: int,
    ) -> NDArray[np.bool_]:
        """Whether each of N rays hits anything: (N,). Arguments as `intersect`."""
    def positions(
        self, shape_id: NDArray[np.int32], primitive: NDArray[np.int32], uv: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Points on primitives: (N,3), NaN for misses."""
    def normals(self, shape_id: NDArray[np.int32], primitive: NDArray[np.int32]) -> NDArray[np.float64]:
        """Find unit geometric normals: (N,3), NaN for misses."""
    @property
    def accelerator(self) -> AcceleratorInfo: ...
    @property
    def dropped(self) -> int:
        """Faces left out because a corner is NaN or infinite."""
    @property
    def bounds(self) -> NDArray[np.float64] | None:
        """((3,) least, (3,) greatest) as (2,3); None for an empty scene."""
    @property
    def bytes(self) -> int:
        """Memory held by the compiled scene: accelerator, vertices and faces."""

@final
class Rendering:
    """A finished render."""

    @property
    def rgb(self) -> NDArray[np.float32]: ...
    @property
    def standard_error(self) -> NDArray[np.float32]: ...
    @property
    def error(self) -> tuple[float, float, float]:
        """Estimate of relMSE, and the low and high end of its 95 % interval; NaN where unknown."""
    @property
    def history(self) -> NDArray[np.float64]:
        """(K,3): seconds, samples, error."""
    @property
    def seconds(self) -> float: ...
    @property
    def samples(self) -> int: ...
    @property
    def dropped(self) -> int:
        """Samples that were NaN, infinite or negative, and are counted as black."""

def render(
    scene: CompiledScene,
    camera: Any,
    integrator: Any,
    samples: int | None,
    error: float | None,
    seconds: float | None,
    seed: int,
    threads: int | None,
    progress: Callable[[float, int, float], None] | None,
) -> Rendering:
    """Render until the first of `samples` (per pixel), `error` (relMSE) or `seconds` is met.

    ``progress`` is called with (seconds, samples done, error estimate or NaN) after every pass.
    Signals are checked ten times a second or more; an exception raised by a handler, or by ``progress``, ends
    the render at once and is passed on.
    """

def camera_rays(camera: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Origins and directions (H,W,3) through the pixels' centres; row 0 is the top."""
