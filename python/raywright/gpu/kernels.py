"""Kernels on a device: their text put together, buffers, and one dispatch after the other."""

from __future__ import annotations

from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray

# Bindings of a kernel besides the scene: rays, answers and others.
_OTHERS = 3
_GROUP = 64


def text(name: str) -> str:
    """Return the text of a file of this folder."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def limits_of(adapter: Any) -> dict[str, int]:
    """Return the limits that a device is asked for: all that its adapter has, of those that matter."""
    wanted = (
        "max-storage-buffer-binding-size",
        "max-buffer-size",
        "max-storage-buffers-per-shader-stage",
    )
    return {name: int(adapter.limits[name]) for name in wanted}


class Parts:
    """An array of rows on a device, in as many buffers as its bindings hold.

    Parameters
    ----------
    device : wgpu.GPUDevice
        Where.
    rows : (N,) structured array
        What.
    most : int
        Bytes that a binding holds.
    """

    def __init__(self, device: Any, rows: NDArray[Any], most: int) -> None:
        import wgpu

        size = rows.dtype.itemsize
        self.rows = max(most // size, 1)
        # An empty buffer cannot be bound.
        some = rows if len(rows) else np.zeros(1, rows.dtype)
        pieces = [some[i : i + self.rows] for i in range(0, len(some), self.rows)]
        usage = wgpu.BufferUsage.STORAGE
        self.buffers = [
            device.create_buffer_with_data(data=np.ascontiguousarray(piece).view(np.uint8), usage=usage)
            for piece in pieces
        ]

    def declared(self, kind: str, first: int, name: str | None = None) -> str:
        """Return the bindings in WGSL, from a number on, and the function that reads an element of all."""
        name = name or kind.lower()
        count = len(self.buffers)
        bindings = [
            f"@group(0) @binding({first + i}) var<storage, read> {name}s{i}: array<{kind}>;"
            for i in range(count)
        ]
        reads = [
            f"    if i < {(i + 1) * self.rows}u {{ return {name}s{i}[i - {i * self.rows}u]; }}"
            for i in range(count - 1)
        ]
        last = f"    return {name}s{count - 1}[i - {(count - 1) * self.rows}u];"
        return "\n".join([*bindings, f"fn {name}(i: u32) -> {kind} {{", *reads, last, "}"])


class Kernels:
    """Both kernels over a scene's flat arrays, on a device.

    Parameters
    ----------
    device : wgpu.GPUDevice
        Which.
    nodes, triangles : structured arrays
        As in `GpuArrays`.
    depth : int
        Of the tree.
    most : int
        Bytes that a binding holds.
    bounds : float
        Factor of all bounds: 1 except in tests of the bounds.
    known : dict
        Pipelines that were made before, by their text.

    Raises
    ------
    MemoryError
        If the scene needs more bindings than the device has.
    """

    def __init__(
        self,
        device: Any,
        nodes: NDArray[np.void],
        triangles: NDArray[np.void],
        depth: int,
        most: int,
        bounds: float,
        known: dict[str, Any],
    ) -> None:
        self._device, self._known = device, known
        self._nodes = len(nodes)
        parts = [Parts(device, nodes, most), Parts(device, triangles, most)]
        used = sum(len(part.buffers) for part in parts) + _OTHERS - 1
        room = device.limits["max-storage-buffers-per-shader-stage"]
        if used > room:
            gib = (nodes.nbytes + triangles.nbytes) / 2**30
            self._destroy([buffer for part in parts for buffer in part.buffers])
            raise MemoryError(f"a scene of {gib:.1f} GiB needs {used} bindings, and the device has {room}")
        self._scene = [buffer for part in parts for buffer in part.buffers]
        first = _OTHERS + len(parts[0].buffers)
        bindings = f"{parts[0].declared('Node', _OTHERS)}\n{parts[1].declared('Triangle', first)}"
        shared = text("trace.wgsl").replace("BINDINGS", bindings).replace("SCALE", repr(float(bounds)))
        # The stack holds one child per level. Rounding lets most trees share one shader.
        closest = text("closest.wgsl").replace("STACK", f"{(depth // 32 + 1) * 32}u")
        self._pipelines = {
            "closest": self._pipeline(shared.replace("ANSWER", "vec4<u32>") + closest, "closest"),
            "occluded": self._pipeline(shared.replace("ANSWER", "u32") + text("occluded.wgsl"), "occluded"),
        }
        self._slots: list[list[Any]] = [[], []]
        self._most = most

    @property
    def chunk(self) -> int:
        """Rays that go in one dispatch at most."""
        return max(min(1 << 20, self._most // 32) // _GROUP * _GROUP, _GROUP)

    def _pipeline(self, code: str, entry: str) -> Any:
        if code not in self._known:
            module = self._device.create_shader_module(code=code)
            self._known[code] = self._device.create_compute_pipeline(
                layout="auto", compute={"module": module, "entry_point": entry}
            )
        return self._known[code]

    def _room(self, slot: int, rays: int) -> list[Any]:
        """Return a slot's buffers for so many rays: of the job, the rays and the answers."""
        import wgpu

        if not self._slots[slot] or self._slots[slot][1].size < 32 * rays:
            self._destroy(self._slots[slot])
            usage = wgpu.BufferUsage
            make = self._device.create_buffer
            room = max(rays, 1024)
            self._slots[slot] = [
                make(size=16, usage=usage.UNIFORM | usage.COPY_DST),
                make(size=32 * room, usage=usage.STORAGE | usage.COPY_DST),
                make(size=16 * room, usage=usage.STORAGE | usage.COPY_SRC),
            ]
        return self._slots[slot]

    def submit(self, kernel: str, rays: NDArray[np.float32], slot: int) -> tuple[str, int, int]:
        """Start "closest" or "occluded" on rays, (N, 8), in slot 0 or 1; return the argument of `read`."""
        count = len(rays)
        job, given, answers = self._room(slot, count)
        queue = self._device.queue
        queue.write_buffer(job, 0, np.array([0, count, self._nodes, 0], np.uint32))
        queue.write_buffer(given, 0, np.ascontiguousarray(rays))
        pipeline = self._pipelines[kernel]
        encoder = self._device.create_command_encoder()
        compute = encoder.begin_compute_pass()
        compute.set_pipeline(pipeline)
        compute.set_bind_group(0, self._bound(pipeline, [job, given, answers, *self._scene]))
        compute.dispatch_workgroups(-(-count // _GROUP))
        compute.end()
        queue.submit([encoder.finish()])
        return kernel, count, slot

    def read(self, work: tuple[str, int, int]) -> NDArray[np.uint32]:
        """Wait for work, and return the answers of "closest", (N, 4), or of "occluded", (N,)."""
        kernel, count, slot = work
        width = 4 if kernel == "closest" else 1
        answers = self._device.queue.read_buffer(self._slots[slot][2], size=4 * width * count)
        told = np.frombuffer(answers, np.uint32)
        return told.reshape(count, width) if width > 1 else told

    def _bound(self, pipeline: Any, buffers: list[Any]) -> Any:
        entries = [
            {"binding": i, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
            for i, buffer in enumerate(buffers)
        ]
        return self._device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)

    def destroy(self) -> None:
        """Give the device's memory back."""
        self._destroy([*self._slots[0], *self._slots[1], *self._scene])
        self._slots, self._scene = [[], []], []

    @staticmethod
    def _destroy(buffers: list[Any]) -> None:
        for buffer in buffers:
            buffer.destroy()


def probed(device: Any, pairs: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the results of probe.wgsl for pairs of numbers, (N, 2), on a device: (N, 12)."""
    import wgpu

    usage = wgpu.BufferUsage
    module = device.create_shader_module(code=text("probe.wgsl"))
    pipeline = device.create_compute_pipeline(
        layout="auto", compute={"module": module, "entry_point": "probe"}
    )
    job = np.array([0, len(pairs), 0, 0], np.uint32)
    buffers = [
        device.create_buffer_with_data(data=job, usage=usage.UNIFORM),
        device.create_buffer_with_data(data=pairs, usage=usage.STORAGE),
        device.create_buffer(size=48 * len(pairs), usage=usage.STORAGE | usage.COPY_SRC),
    ]
    entries = [
        {"binding": i, "resource": {"buffer": buffer, "offset": 0, "size": buffer.size}}
        for i, buffer in enumerate(buffers)
    ]
    group = device.create_bind_group(layout=pipeline.get_bind_group_layout(0), entries=entries)
    encoder = device.create_command_encoder()
    compute = encoder.begin_compute_pass()
    compute.set_pipeline(pipeline)
    compute.set_bind_group(0, group)
    compute.dispatch_workgroups(-(-len(pairs) // _GROUP))
    compute.end()
    device.queue.submit([encoder.finish()])
    return np.frombuffer(device.queue.read_buffer(buffers[2]), np.float32).reshape(-1, 12)
