"""A scene on a graphics processor."""

from __future__ import annotations

from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .._core import FlatScene
from ..io.quiet import warn_caller
from ..locks import Lock
from ..query.gpu_arrays import flat_arrays
from ..query.hits import Hits
from ..query.masks import asked
from ..query.ray_queries import known_by
from ..query.rays import AskedRays, ray_arguments
from ..scene.scene import Scene
from .kernels import Kernels
from .stats import GpuStats

# Kernels return this for rays that the CPU must trace.
_OPEN = 0xFFFFFFFE


class GpuScene:
    """A scene on a graphics processor, with the scene's results to the bit: `Scene.on_device` makes it.

    The CPU decides the rays that the device leaves undecided; `stats` counts them. If the device is lost, a
    warning is issued once, and the CPU answers from then on.

    See Also
    --------
    Scene.on_device : Makes it.

    Examples
    --------
    >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
    >>> rays = [0, 0, 9], np.random.default_rng(0).normal(size=(100, 3)) - [0, 0, 3]
    >>> with scene.on_device(rw.Gpu()) as there:
    ...     print(bool((there.intersect(*rays).t == scene.intersect(*rays).t).all()))
    True
    """

    def __init__(
        self, device: Any, name: str, scene: Scene, most: int, bounds: float, pipelines: dict[str, Any]
    ) -> None:
        self._core = scene._compiled()
        self._flat = FlatScene(self._core, scene.accelerator, scene.quality, False)
        self._name = name
        self._stats = GpuStats()
        arrays = flat_arrays(self._flat)
        self._bytes = arrays.bytes
        self._is_closed = False
        # The buffers belong to the scene, so batches take turns.
        self._lock = Lock()
        self._kernels: Kernels | None = Kernels(
            device, arrays.nodes, arrays.triangles, arrays.depth, most, bounds, pipelines
        )

    @property
    def stats(self) -> GpuStats:
        """Statistics of the rays so far."""
        return self._stats

    @property
    def bytes(self) -> int:
        """Bytes of the scene that the device holds."""
        return self._bytes

    def intersect(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> Hits:
        """Find the closest hit of each ray, with the bits of `Scene.intersect`.

        Arguments, results and errors are those of the scene's query.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time
            As for `Scene.intersect`.

        Returns
        -------
        Hits

        Raises
        ------
        RuntimeError
            If the ``with`` block has ended.

        See Also
        --------
        GpuScene.occluded : Any hit.

        Examples
        --------
        >>> with rw.Scene(rw.Sphere()).on_device(rw.Gpu()) as there:
        ...     print(there.intersect([0, 0, 5], [0, 0, -1]).t.tolist())
        4.0
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        with self._lock:
            told = self._ask("closest", rays)
        hits, (decided, walked) = self._flat.intersect(rays, told)
        self._stats.closest += len(told)
        self._stats.closest_decided += decided
        self._stats.closest_walked += walked
        return Hits(*hits, self._core, known_by(self._core, rays))

    def occluded(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        t_min: ArrayLike = 0.0,
        t_max: ArrayLike = np.inf,
        threads: int | None = None,
        time: ArrayLike | None = None,
    ) -> NDArray[np.bool_]:
        """Find whether each ray hits anything: the same as `Scene.occluded`.

        Arguments, results and errors are those of the scene's query.

        Parameters
        ----------
        origins, directions, t_min, t_max, threads, time
            As for `Scene.occluded`.

        Returns
        -------
        (...) bool array

        Raises
        ------
        RuntimeError
            If the ``with`` block has ended.

        See Also
        --------
        GpuScene.intersect : The closest hit.

        Examples
        --------
        >>> with rw.Scene(rw.Sphere()).on_device(rw.Gpu()) as there:
        ...     print(there.occluded([0, 0, 5], [[0, 0, -1], [0, 0, 1]]).tolist())
        [True, False]
        """
        rays = asked(ray_arguments(origins, directions, t_min, t_max, threads, time), None)
        with self._lock:
            told = self._ask("occluded", rays)
        found, (decided, walked) = self._flat.occluded(rays, told)
        self._stats.any += len(told)
        self._stats.any_decided += decided
        self._stats.any_walked += walked
        return found

    def _ask(self, kernel: str, rays: AskedRays) -> NDArray[np.uint32]:
        """Return a kernel's answers for all rays; undecided ones are left open."""
        if self._is_closed:
            raise RuntimeError("the scene is no longer on the device: its with block has ended")
        count = int(np.prod(rays[4], dtype=np.int64))
        shape = (count, 4) if kernel == "closest" else (count,)
        told = np.full(shape, _OPEN, np.uint32)
        if self._kernels is None:
            return told
        chunk = self._kernels.chunk
        before: tuple[int, int, Any] | None = None
        # The host prepares the next batch while the device works on this one.
        for slot, start in enumerate(range(0, count + chunk, chunk)):
            stop = min(start + chunk, count)
            ready = self._flat.rays(_part(rays, count, start, stop)) if start < count else None
            try:
                work = None if ready is None else self._kernels.submit(kernel, ready, slot % 2)
                if before is not None:
                    told[before[0] : before[1]] = self._kernels.read(before[2])
            except Exception as lost:
                self._kernels = None
                warn_caller(f"{self._name} was lost, and the CPU takes over: {str(lost).strip()}")
                break
            before = (start, stop, work)
        return told

    def __enter__(self) -> GpuScene:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        if self._kernels is not None:
            self._kernels.destroy()
        self._kernels, self._is_closed = None, True

    def __repr__(self) -> str:
        return f"GpuScene({self._core.accelerator.primitives} primitives on {self._name!r})"


def _part(rays: AskedRays, count: int, start: int, stop: int) -> AskedRays:
    """Return the rays from `start` to `stop` of `count`, as the core takes them; time is not asked for."""
    origins, directions, t_min, t_max, lead, threads, *_ = rays

    def some(array: NDArray[Any], columns: tuple[int, ...]) -> NDArray[Any]:
        if array.flags.c_contiguous:
            array = array.reshape(-1, *columns)
            return array[start:stop] if len(array) == count and count > 1 else array
        # Broadcast rays are not copied as a whole.
        return array[np.unravel_index(np.arange(start, stop), lead)]

    starts, ways = (some(array, (3,)) for array in (origins, directions))
    near, far = (some(x, ()) if isinstance(x, np.ndarray) else x for x in (t_min, t_max))
    return starts, ways, near, far, (stop - start,), threads, None, None
