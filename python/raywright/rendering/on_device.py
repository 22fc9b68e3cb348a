"""Pictures whose paths are traced by a graphics processor: supported features, and the passes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from .. import _core
from ..cameras import AnyCamera
from ..descriptions import changed
from ..integrators import AnyIntegrator, Path
from ..io.quiet import warn_caller
from ..scene.instance import AnyShape, Instance
from ..scene.scene import Scene
from ..shapes.mesh import face_count
from .auto_options import StoppedError
from .choices import Limits
from .filters import Filter
from .plan import Choice, RenderPlan
from .progress import Report
from .quantiles import quantiles
from .samplers import Independent, Sampler

if TYPE_CHECKING:
    from ..gpu.wavefront import Wavefront

# Most faces to lay out copies as.
_LAID_OUT = 4_000_000
# Samples per pass from this number on, if neither an error nor a time limits the render.
_PASS = 64
# Options of paths on the device.
_PLAIN: dict[str, Any] = {"reuse": 1, "guiding": "none"}


def check_device(device: Any) -> None:
    """Raise a TypeError unless a device is one."""
    if isinstance(device, type) or not callable(getattr(device, "_paths", None)):
        raise TypeError(f"device must be a raywright.Gpu, got {device!r}")


class OnDevice:
    """A picture on a device, if it can be there.

    Parameters
    ----------
    device : Gpu
        The device.
    scene, camera, integrator, seed
        As in `render`.
    asked : dict of str to bool
        Other requested features that devices lack, by name; True if requested.
    sampler, filter
        As in `render`.
    """

    def __init__(
        self,
        device: Any,
        scene: Scene,
        camera: AnyCamera,
        integrator: AnyIntegrator,
        seed: int,
        asked: dict[str, bool],
        sampler: Sampler | None,
        filter: Filter,
    ) -> None:
        self.name = str(device.name)
        self._paths: Wavefront | None = None
        self._lost = ""
        self._left = _left(integrator, asked, sampler, filter)
        if self._left:
            return
        from ..gpu.material_table import LeftError

        assert isinstance(integrator, Path)
        depths = integrator.max_depth, integrator.roulette_depth
        try:
            self._paths = device._paths(_without_copies(scene), camera, *depths, seed, quantiles(filter))
        except LeftError as left:
            self._left = str(left)
        except MemoryError as little:
            self._left = f"no room: {little}"
        except Exception as broken:
            self._give_up(broken)

    @property
    def works(self) -> bool:
        """True if the device renders."""
        return self._paths is not None

    def row(self) -> Choice:
        """Return its row of the plan."""
        if self._lost:
            return Choice("device", "CPU", f"{self.name} was lost: {self._lost}")
        if self._left:
            return Choice("device", "CPU", f"left by {self.name}: {self._left}")
        return Choice("device", self.name, "paths are traced there in float32, and errors told here")

    def plan(self, integrator: AnyIntegrator) -> tuple[Path, Sampler, RenderPlan]:
        """Return the path tracer, sampler and plan of a picture there."""
        assert isinstance(integrator, Path)
        path = changed(integrator, **_PLAIN)
        rows = (
            self.row(),
            Choice("sampler", "Independent", "devices hash what a number is for (pcg4d), not Philox"),
            *(Choice(name, "no", "devices follow each path by itself") for name in _PLAIN),
        )
        sampler = Independent()
        return path, sampler, RenderPlan(rows, sampler, path)

    def run(
        self,
        rendering: _core.Rendering,
        limits: Limits,
        report: Report | None,
        rest: Callable[[], None],
        look: Callable[[], None],
    ) -> bool:
        """Go on until a limit is met: True. False if the device was lost, and the CPU can go on.

        `report` and `rest` are called after each pass, `look` more often.
        """
        started, earlier = time.perf_counter(), rendering.seconds

        def elapsed() -> float:
            return earlier + time.perf_counter() - started

        while self._paths is not None:
            done = rendering.samples
            aim = rendering.next_aim(*limits, done, elapsed(), rendering.rate)
            if aim <= done:
                return True
            if limits[0] is not None and limits[1:] == (None, None) and done >= _PASS:
                aim = min(limits[0], done + _PASS)
            try:
                sums, dropped = self._paths.add(done, aim - done, look)
            except StoppedError:
                raise
            except Exception as broken:
                self._give_up(broken)
                return False
            rendering.begin(aim)
            rendering.add(aim - done, sums, dropped)
            row = rendering.end(elapsed())
            if report is not None:
                report(*row)
            rest()
        return False

    def _give_up(self, broken: Exception) -> None:
        self._lost = (str(broken).strip() or type(broken).__name__).splitlines()[0]
        self._paths = None
        warn_caller(f"{self.name} was lost, and the CPU takes over: {self._lost}")

    def end(self) -> None:
        """Give the device's memory back."""
        if self._paths is not None:
            self._paths.destroy()


def _without_copies(scene: Scene) -> Scene:
    """Return a scene with still copies laid out as shapes of their own, if they are few enough."""
    needed = scene.plan().needed
    if "instances" not in needed or "motion" in needed or sum(map(_faces, scene.shapes)) > _LAID_OUT:
        return scene
    from ..exchange.copies import laid_out

    return laid_out(scene).scene


def _faces(shape: AnyShape) -> int:
    """Return how many faces a shape has, in all copies."""
    return len(shape) * shape.primitives if isinstance(shape, Instance) else face_count(shape)


def _left(integrator: AnyIntegrator, asked: dict[str, bool], sampler: Sampler | None, filter: Filter) -> str:
    """Return the features of a render that devices lack; nothing if they support all."""
    if not isinstance(integrator, Path):
        return f"the integrator is a {type(integrator).__name__}, not a Path"
    for name, plain in _PLAIN.items():
        if getattr(integrator, name) not in (None, plain):
            return f"{name}={getattr(integrator, name)!r} of Path"
    for name, is_asked in asked.items():
        if is_asked:
            return name
    if not isinstance(sampler, Independent | None):
        return f"the sampler is a {type(sampler).__name__}"
    if quantiles(filter) is None:
        return f"the filter is {filter!r}"
    return ""
