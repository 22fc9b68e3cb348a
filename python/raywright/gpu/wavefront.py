"""Path tracing on a device: kernels by turns, and sums of samples back."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from ..query.gpu_arrays import GpuArrays
from .eyes import Eye
from .kernels import Parts, text
from .packing import Packed, known_lit

# 128 bytes: see `Job` of paths.wgsl.
JOB = np.dtype(
    [
        ("eye", "<f4", 3),
        ("zero", "<u4"),
        ("corner", "<f4", 3),
        ("width", "<u4"),
        ("across", "<f4", 3),
        ("height", "<u4"),
        ("down", "<f4", 3),
        ("nodes", "<u4"),
        ("first_pixel", "<u4"),
        ("pixels", "<u4"),
        ("first_sample", "<u4"),
        ("samples", "<u4"),
        ("max_depth", "<u4"),
        ("roulette_depth", "<u4"),
        ("seed", "<u4", 2),
        ("now", "<u4"),
        ("capacity", "<u4"),
        ("quantiles", "<u4"),
        ("reserved", "<u4"),
    ]
)
_PATH, _SHADOW, _PIXEL = 80, 64, 80
_LISTS, _GROUP = 8, 64
# Most paths in flight, if the device has room.
_CAPACITY = 1 << 20
# Target seconds per dispatch; first and least number of paths.
_PIECE, _FIRST, _LEAST = 0.25, 1 << 16, 1 << 15
# Bounces between readbacks of the number of live paths.
_BOUNCES = 8
# Number of bindings before those of the scene.
_OWN = 8
_TO_LIGHT = 7
# By shading kernel: its list, and the kinds of materials it handles; the sky needs none.
_SHADING: dict[str, tuple[int, set[int]]] = {
    "add_outside": (2, set()),
    "leave_matte": (3, {0}),
    "leave_any": (4, {1, 2, 3, 6}),
    "leave_brushed": (5, {4}),
    "leave_frosted": (6, {5}),
}
_NO_LIMIT = 0xFFFFFFFF


# A kernel, its list of rays, and its number of workgroups, or None for an indirect dispatch.
Step: TypeAlias = tuple[str, int, int | None]


class Wavefront:
    """Paths of a scene on a device.

    Parameters
    ----------
    device : wgpu.GPUDevice
        The device.
    flat : GpuArrays
        The scene's tree.
    scene : Packed
        Appearance of the scene.
    eye : Eye
        Camera of the picture.
    max_depth, roulette_depth, seed : int
        As `Path` and `render` have them; None for no greatest depth.
    quantiles : (1025,) array
        Of how far from a pixel's center its samples lie along either axis, in pixels.
    most : int
        Bytes that a binding holds.
    known : dict
        Pipelines that were made before, by text and entry.

    Raises
    ------
    MemoryError
        If the scene needs more bindings than the device has.
    """

    def __init__(
        self,
        device: Any,
        flat: GpuArrays,
        scene: Packed,
        eye: Eye,
        max_depth: int | None,
        roulette_depth: int,
        seed: int,
        quantiles: NDArray[np.float64],
        most: int,
        known: dict[Any, Any],
    ) -> None:
        self._device, self._known = device, known
        self._pixels = eye.width * eye.height
        room = min(_CAPACITY, most // _PATH) // _GROUP * _GROUP
        self._capacity = max(min(room, -(-self._pixels * 16 // _GROUP) * _GROUP), _GROUP)
        self._buffers: list[Any] = []
        parts = {
            "Node": Parts(device, flat.nodes[: flat.own], most),
            "Triangle": Parts(device, flat.triangles, most),
            "Face": Parts(device, scene.faces, most),
            "Material": Parts(device, scene.materials, most),
            "Light": Parts(device, scene.lights, most),
            "f32": Parts(device, np.append(scene.numbers, quantiles.astype(np.float32)), most),
        }
        self._scene = [buffer for part in parts.values() for buffer in part.buffers]
        self._kinds = [kind for kind, part in parts.items() for _ in part.buffers]
        # The kernel with the most bindings: shading has four of its own.
        used = len(self._scene) - len(parts["Node"].buffers) - len(parts["Triangle"].buffers) + 4
        have = device.limits["max-storage-buffers-per-shader-stage"]
        if used > have:
            self.destroy()
            raise MemoryError(f"the scene needs {used} bindings, and the device has {have}")
        bindings, first = [], _OWN
        for kind, part in parts.items():
            bindings.append(part.declared(kind, first, "number" if kind == "f32" else kind.lower()))
            first += len(part.buffers)
        bindings.append(known_lit(scene.lit))
        depth = f"{(flat.depth // 32 + 1) * 32}u"
        self._code = "\n".join(
            [
                text("shading.wgsl"),
                text("walk.wgsl").replace("STACK", depth),
                text("paths.wgsl").replace("BINDINGS", "\n".join(bindings)),
            ]
        )
        self._job = np.zeros((), JOB)
        for name in ("eye", "corner", "across", "down", "width", "height"):
            self._job[name] = getattr(eye, name)
        self._job["nodes"], self._job["capacity"] = flat.own, self._capacity
        self._job["max_depth"] = _NO_LIMIT if max_depth is None else max_depth
        self._job["roulette_depth"] = min(roulette_depth, 4096)
        self._job["quantiles"] = len(scene.numbers)
        self._job["seed"] = seed & 0xFFFFFFFF, seed >> 32
        self._max_depth = max_depth
        self._make(scene.lit)
        # Kernels for absent materials are neither compiled nor run.
        kinds = set(scene.materials["kind"].tolist())
        self._shading = {
            entry: which
            for entry, (which, needs) in _SHADING.items()
            if (needs & kinds if needs else int(scene.lit["sky_kind"]))
        }
        self._asks = int(scene.lit["lights"]) > 0 or int(scene.lit["sky_kind"]) > 0
        entries = (
            "start",
            "plan_first",
            "find_closest",
            "plan_shading",
            *self._shading,
            "plan_rays",
            "follow_shadows",
            "gather",
        )
        self._pipelines = {entry: self._pipeline(entry) for entry in entries}
        self._groups: dict[tuple[str, int], Any] = {}
        # Drivers may compile at the first dispatch.
        self._wave = min(_FIRST, self._capacity)
        self._block(0, 1, 0, 1, lambda: None)

    def _make(self, lit: NDArray[np.void]) -> None:
        """Make the buffers that are not the scene's."""
        import wgpu

        usage = wgpu.BufferUsage

        def make(size: int, use: int) -> Any:
            self._buffers.append(self._device.create_buffer(size=size, usage=use))
            return self._buffers[-1]

        # One for each list of rays.
        self._jobs = [make(JOB.itemsize, usage.UNIFORM | usage.COPY_DST) for _ in range(2)]
        self._lit = make(lit.nbytes, usage.UNIFORM | usage.COPY_DST)
        self._paths = make(_PATH * self._capacity, usage.STORAGE)
        self._counts = make(4 * _LISTS, usage.STORAGE | usage.COPY_SRC | usage.COPY_DST)
        lists = make(4 * (_LISTS - 1) * self._capacity, usage.STORAGE)
        self._plan = make(16 * _LISTS, usage.STORAGE | usage.INDIRECT | usage.COPY_DST)
        shadows = make(_SHADOW * self._capacity, usage.STORAGE)
        self._film = make(
            _PIXEL * min(self._capacity, self._pixels),
            usage.STORAGE | usage.COPY_SRC | usage.COPY_DST,
        )
        self._device.queue.write_buffer(self._lit, 0, np.ascontiguousarray(lit).reshape(1).view(np.uint8))
        self._own = [self._lit, self._paths, self._counts, lists, self._plan, shadows, self._film]

    def _pipeline(self, entry: str) -> Any:
        if (self._code, entry) not in self._known:
            if self._code not in self._known:
                self._known[self._code] = self._device.create_shader_module(code=self._code)
            self._known[self._code, entry] = self._device.create_compute_pipeline(
                layout="auto", compute={"module": self._known[self._code], "entry_point": entry}
            )
        return self._known[self._code, entry]

    def _bound(self, entry: str, now: int) -> Any:
        """Return the bindings of a kernel: those that its text says it has."""
        if (entry, now) not in self._groups:
            buffers = [self._jobs[now], *self._own, *self._scene]
            entries = [
                {"binding": i, "resource": {"buffer": buffers[i], "offset": 0, "size": buffers[i].size}}
                for i in self._used(entry)
            ]
            layout = self._pipelines[entry].get_bind_group_layout(0)
            self._groups[entry, now] = self._device.create_bind_group(layout=layout, entries=entries)
        return self._groups[entry, now]

    def _used(self, entry: str) -> list[int]:
        """Return the bindings of a kernel."""
        scene = list(range(_OWN, _OWN + len(self._scene)))
        walk, some, numbers = (
            [i for i in scene if self._kinds[i - _OWN] in kinds]
            for kinds in (("Node", "Triangle"), ("Face", "Material"), ("f32",))
        )
        looks = scene[len(walk) :]
        own = {
            "start": [0, 2, 3, 4, *numbers],
            "plan_first": [0, 3, 5],
            "find_closest": [0, 2, 3, 4, *walk, *some],
            "plan_shading": [0, 3, 5],
            "add_outside": [0, 1, 2, 3, 4, *numbers],
            "plan_rays": [0, 3, 5],
            "follow_shadows": [0, 2, 3, 6, *walk],
            "gather": [0, 2, 7],
        }
        return own.get(entry, [0, 1, 2, 3, 4, 6, *looks])

    def add(
        self, first_sample: int, samples: int, look: Callable[[], object]
    ) -> tuple[NDArray[np.float64], int]:
        """Take samples of all pixels.

        Parameters
        ----------
        first_sample, samples : int
            Their numbers.
        look : callable
            Called between pieces of work; an exception ends them.

        Returns
        -------
        sums : (H * W, 9) float64
            Of each pixel's samples their sum, that of their squares, and the largest.
        dropped : int
            Number of samples without a valid radiance.
        """
        sums = np.empty((self._pixels, 9))
        dropped = 0
        first = 0
        while first < self._pixels:
            count = min(self._wave, self._pixels - first)
            film = self._block(first, count, first_sample, samples, look)
            rows = film.reshape(count, 5, 4)[:, :, :3].astype(np.float64)
            sums[first : first + count] = np.concatenate(
                [rows[:, 0] + rows[:, 1], rows[:, 2] + rows[:, 3], rows[:, 4]], axis=1
            )
            dropped += int(film.view(np.uint32).reshape(count, 20)[:, 3].sum(dtype=np.int64))
            first += count
        return np.maximum(sums, 0.0), dropped

    def _block(
        self, first: int, pixels: int, first_sample: int, samples: int, look: Callable[[], object]
    ) -> NDArray[np.float32]:
        """Take samples of some pixels, and return the film's share of them."""
        queue = self._device.queue
        encoder = self._device.create_command_encoder()
        encoder.clear_buffer(self._film)
        queue.submit([encoder.finish()])
        some = 0
        while some < samples:
            count = min(max(self._wave // pixels, 1), samples - some)
            self._job["first_pixel"], self._job["pixels"] = first, pixels
            self._job["first_sample"], self._job["samples"] = first_sample + some, count
            for now, buffer in enumerate(self._jobs):
                self._job["now"] = now
                queue.write_buffer(buffer, 0, self._job.reshape(1).view(np.uint8))
            longest = 0.0
            for steps, is_last in self._rounds():
                began = time.perf_counter()
                self._submit(steps, pixels * count)
                left = np.frombuffer(queue.read_buffer(self._counts), np.uint32)[:2].any()
                longest = max(longest, time.perf_counter() - began)
                look()
                if is_last or not left:
                    break
            self._keep_pace(pixels * count, longest)
            some += count
            self._submit([("gather", 0, -(-pixels // _GROUP))], 0)
        return np.frombuffer(queue.read_buffer(self._film, size=_PIXEL * pixels), np.float32)

    def _keep_pace(self, paths: int, took: float) -> None:
        """Adapt the number of paths at work, so that stopping never takes long.

        Sums are the same: paths of a pixel join them in the order of their numbers.
        """
        if 2 * paths >= self._wave:
            wave = self._wave * min(max(_PIECE / max(took, 1e-6), 0.25), 4.0)
            self._wave = min(max(int(wave) // _GROUP * _GROUP, _LEAST), self._capacity)

    def _rounds(self) -> Iterator[tuple[list[Step], bool]]:
        """Yield the remaining work until paths end, and whether they have certainly ended."""
        steps: list[Step] = [("start", 0, None), ("plan_first", 0, 1)]
        bounce, last = 0, self._max_depth
        while True:
            for _ in range(_BOUNCES):
                now = bounce % 2
                steps += [("find_closest", now, None), ("plan_shading", now, 1)]
                steps += [(entry, now, None) for entry in self._shading]
                steps += [("plan_rays", now, 1), *([("follow_shadows", now, None)] if self._asks else [])]
                bounce += 1
                if last is not None and bounce > last:
                    yield steps, True
                    return
            yield steps, False
            steps = []

    def _submit(self, steps: list[Step], paths: int) -> None:
        """Set kernels to work, one after the other, on so many paths if they are to be generated."""
        encoder = self._device.create_command_encoder()
        if steps[0][0] == "start":
            encoder.clear_buffer(self._counts)
            encoder.clear_buffer(self._plan)
        compute = encoder.begin_compute_pass()
        for entry, now, groups in steps:
            compute.set_pipeline(self._pipelines[entry])
            compute.set_bind_group(0, self._bound(entry, now))
            if entry == "start":
                compute.dispatch_workgroups(-(-paths // _GROUP))
            elif groups is not None:
                compute.dispatch_workgroups(groups)
            else:
                which = now if entry == "find_closest" else self._shading.get(entry, _TO_LIGHT)
                compute.dispatch_workgroups_indirect(self._plan, 16 * which)
        compute.end()
        self._device.queue.submit([encoder.finish()])

    def destroy(self) -> None:
        """Give the device's memory back."""
        for buffer in [*self._buffers, *self._scene]:
            buffer.destroy()
        self._buffers, self._scene = [], []
