"""Data for a page that draws a scene by itself: arrays for its graphics processor, and the spread of rays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core import FlatScene
from ..cameras import Camera, Orthographic, ThinLens
from ..exchange.copies import laid_out
from ..gpu.material_table import LeftError
from ..gpu.packing import known_lit, packed
from ..integrators import AnyIntegrator, Path
from ..io.tone import TONES
from ..locks import Lock
from ..query.gpu_arrays import GpuArrays, flat_arrays
from ..rendering.filters import BoxFilter
from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene
from ..shapes.mesh import Mesh
from .lamps import behind, lamp
from .orbit import Orbit, View
from .paint import paints

# Largest scene that is sent to a page.
_MOST_BYTES = 1 << 30
_FILTER = BoxFilter()
# Default limits on surfaces per path and paths per pixel.
_DEEPEST = 1 << 20
_SAMPLES = 4096
# Features, as plans name them, that paths in a page do not support.
_MISSING = ("masks", "smoke and haze", "patterned lights", "normals as given", "shapes in glass")
# Bytes per primitive: in the tree, with the two nodes that it takes at most, as a face, and its paint.
_EACH = 48 + 64 + 112 + 8


class Drawn:
    """A scene for pages that draw it themselves, laid out on the first request.

    Parameters
    ----------
    scene : Scene
        What.
    orbit : Orbit
        Of the camera.
    integrator : Path or another kind
        Integrator of the core's renders.
    how : mapping
        Other arguments of `render`.
    tone : str
        As in `Image.save`.
    """

    def __init__(
        self, scene: Scene, orbit: Orbit, integrator: AnyIntegrator, how: Mapping[str, Any], tone: str
    ) -> None:
        self._scene, self._orbit, self._integrator = scene, orbit, integrator
        self._how, self._tone = how, tone
        self._lock = Lock()
        self._core: Any = None
        self._version = 0
        self._flat: GpuArrays | None = None
        self._arrays: dict[str, bytes] = {}
        # Features of the scene that the page cannot shade like the core.
        self._left: str | None = None
        self._known = ""

    def show(self, integrator: AnyIntegrator) -> None:
        """Take another integrator from now on."""
        self._integrator = integrator

    def told(self) -> dict[str, Any]:
        """Return the first message to a page: if it cannot draw the scene ``{"why": ...}``, in one line."""
        why = self._refused()
        if why is not None:
            return {"why": why}
        with self._lock:
            flat = self._laid_out()
            if not len(flat.nodes):
                return {"why": "the scene is empty"}
            if len(flat.unbounded) or (flat.triangles["largest"] < 0).any():
                return {"why": "the page draws triangles alone, and the scene has other shapes"}
            left = self._left_out() or self._left
            return {
                "why": None,
                "version": str(self._version),
                "arrays": {name: len(data) for name, data in self._arrays.items()},
                "nodes": flat.own,
                "depth": flat.depth,
                "center": flat.center.tolist(),
                "scale": flat.scale,
                "orbit": self._orbit.told(),
                "lamp": lamp(self._scene, self._orbit.camera(View())),
                "behind": behind(self._scene),
                "known": self._known,
                "tone": TONES.index(self._tone),
                "traced": None if left else self._limits(),
                "left": left,
            }

    def bytes(self, version: str, name: str) -> bytes | None:
        """Return an array of a version; None if there is none."""
        with self._lock:
            return self._arrays.get(name) if version == str(self._version) else None

    def local(self, points: NDArray[np.float64]) -> NDArray[np.float32]:
        """Return points in box units."""
        with self._lock:
            flat = self._laid_out()
            return np.asarray((points - flat.center) * flat.scale, "<f4")

    def _refused(self) -> str | None:
        camera = self._orbit.camera(View())
        if not isinstance(camera, Camera | ThinLens | Orthographic):
            return f"the page draws no pictures of a {type(camera).__name__}"
        if camera.end_pose is not None:
            return "the page draws no camera that moves while its shutter is open"
        if "motion" in self._scene.plan().needed:
            return "the page draws nothing that moves while the shutter is open"
        if sum(map(_faces, self._scene.shapes)) * _EACH > _MOST_BYTES:
            return "the scene is too large for the page to draw"
        return None

    def _left_out(self) -> str | None:
        """Return the reason why the core renders still pictures of supported surfaces and lights."""
        integrator = self._integrator
        if not isinstance(integrator, Path):
            return f"the page has no {type(integrator).__name__}"
        if isinstance(self._orbit.camera(View()), ThinLens):
            return "the page has no lenses"
        if self._scene.wavelengths is not None:
            return "the page has no wavelengths"
        needed = self._scene.plan().needed
        for what in _MISSING:
            if what in needed:
                return f"the page has no {what}"
        if self._how.get("filter", _FILTER) != _FILTER or self._how.get("clamp") is not None:
            return "the page has no filters and does not clamp"
        return None

    def _limits(self) -> dict[str, Any]:
        """Return how paths end, and how many there are of each pixel."""
        path: Any = self._integrator
        return {
            "depth": _DEEPEST if path.max_depth is None else path.max_depth,
            "roulette": path.roulette_depth,
            "seed": self._how.get("seed", 0) % 2**16,
            "samples": self._how.get("samples") or _SAMPLES,
            "seconds": self._how.get("seconds"),
            "error": self._how.get("error"),
        }

    def _laid_out(self) -> GpuArrays:
        """Return the arrays of the current scene; the caller holds the lock."""
        core = self._scene._compiled()
        if self._flat is None or self._core is not core:
            # Copies become separate shapes.
            scene = laid_out(self._scene).scene
            inner = scene._compiled()
            flat = flat_arrays(FlatScene(inner, scene.accelerator, scene.quality, True))
            self._flat, self._core = flat, core
            self._version += 1
            self._arrays = {
                "nodes": flat.nodes.tobytes(),
                "triangles": flat.triangles.tobytes(),
                "paints": paints(scene.shapes, flat).tobytes(),
            }
            try:
                looks = packed(scene, flat)
            except LeftError as left:
                self._left = str(left)
            else:
                self._left, self._known = None, known_lit(looks.lit)
                self._arrays |= {name: array.tobytes() for name, array in vars(looks).items()}
        return self._flat


def _faces(shape: AnyShape) -> int:
    """Return how many primitives a shape has, in all copies."""
    if isinstance(shape, Instance):
        return len(shape) * shape.primitives
    return len(shape.faces) if isinstance(shape, Mesh) else 1
