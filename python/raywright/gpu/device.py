"""A graphics processor."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..cameras import AnyCamera
from ..debug_log import debug
from ..scene.scene import Scene
from .adapters import chosen, name_of
from .arithmetic import pairs, trouble
from .eyes import eye_of
from .kernels import limits_of, probed
from .material_table import LeftError
from .packing import packed
from .scene_buffers import GpuScene
from .wavefront import Wavefront
from .wgpu_api import changes_named

# Features that the rendering kernels do not support, as `Scene.plan` names them.
_LEFT = (
    "masks",
    "smoke and haze",
    "patterned lights",
    "motion",
    "instances",
    "normals as given",
    "shapes in glass",
)


class Gpu:
    """A graphics processor that traces rays, by WebGPU: ``with scene.on_device(rw.Gpu()) as there: ...``.

    It needs the extra ``raywright[gpu]``, and a driver for Vulkan, Metal or Direct3D 12. Its arithmetic is
    tested once. Results have the CPU's bits on every device that computes as WGSL promises.

    Parameters
    ----------
    adapter : str or wgpu.GPUAdapter, optional
        Device, by a part of its name or as wgpu's object. If not given, the one that wgpu prefers.

    Raises
    ------
    ImportError
        If wgpu is not installed, or lacks a required function.
    RuntimeError
        If there is no such driver, or the arithmetic of the device breaks WGSL's promises.
    ValueError
        If no device has such a name.
    TypeError
        If `adapter` is neither.

    See Also
    --------
    Scene.on_device : Puts a scene on it.

    Examples
    --------
    >>> gpu = rw.Gpu()
    >>> gpu.backend in ("Vulkan", "Metal", "D3D12")
    True
    """

    def __init__(self, adapter: Any = None) -> None:
        found = chosen(adapter)
        given = pairs()
        # Covers the first use of nearly all wgpu calls.
        with changes_named():
            self._limits = limits_of(found)
            self._name, self._backend = name_of(found), str(found.info["backend_type"])
            self._device = found.request_device_sync(required_limits=self._limits)
            computed = probed(self._device, given)
        # Scale of error bounds, and the largest binding: tests change both.
        self._bounds = 1.0
        self._most = min(self._limits["max-storage-buffer-binding-size"], self._limits["max-buffer-size"])
        self._pipelines: dict[str, Any] = {}
        if wrong := trouble(given, computed):
            raise RuntimeError(f"{self._name} does not meet the accuracy that WGSL requires: {wrong}")

    @property
    def name(self) -> str:
        """Name of the device."""
        return self._name

    @property
    def backend(self) -> str:
        """Interface of its driver: "Vulkan", "Metal" or "D3D12"."""
        return self._backend

    def upload(self, scene: Scene) -> GpuScene:
        """Put a scene on the device; `Scene.on_device` does it.

        Parameters
        ----------
        scene : Scene
            The scene.

        Returns
        -------
        GpuScene

        Raises
        ------
        MemoryError
            If the device has no room for the scene.

        See Also
        --------
        Scene.on_device : Calls it.

        Examples
        --------
        >>> with rw.Gpu().upload(rw.Scene(rw.Sphere())) as there:
        ...     print(there.intersect([0, 0, 5], [0, 0, -1]).t.tolist())
        4.0
        """
        if not isinstance(scene, Scene):
            raise TypeError(f"scene must be a Scene, got {type(scene).__name__}")
        debug("device: scene held by %s", self._name)
        return GpuScene(self._device, self._name, scene, self._most, self._bounds, self._pipelines)

    def _paths(
        self,
        scene: Scene,
        camera: AnyCamera,
        max_depth: int | None,
        roulette_depth: int,
        seed: int,
        quantiles: NDArray[np.float64],
    ) -> Wavefront:
        """Return the paths of a picture, ready to be followed; `render` does it, by its `device`.

        The parameters are those of `Wavefront`.

        Raises
        ------
        LeftError
            If only the CPU supports a feature, with its name.
        MemoryError
            If the device has no room for the scene.
        """
        if scene.wavelengths is not None:
            raise LeftError(f"paths carry wavelengths: {scene.wavelengths}")
        needed = scene.plan().needed
        for what in _LEFT:
            if what in needed:
                raise LeftError(f"the scene has {what}")
        flat = scene.gpu_arrays()
        eye, looks = eye_of(camera, flat), packed(scene, flat)
        settings = max_depth, roulette_depth, seed, quantiles
        return Wavefront(self._device, flat, looks, eye, *settings, self._most, self._pipelines)

    def __repr__(self) -> str:
        return f"Gpu({self._name!r}, {self._backend})"
