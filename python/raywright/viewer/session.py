"""A render that goes on while pages are open, and begins anew when the camera is moved."""

from __future__ import annotations

import math
import re
import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..cameras import AnyCamera
from ..integrators import AnyIntegrator
from ..io import shown
from ..io.tone import DEFAULT
from ..locks import Lock
from ..query.trees import TreeBoxes
from ..rendering.error_estimate import ErrorEstimate
from ..rendering.image import Image
from ..rendering.partial_image import ImageSoFar
from ..rendering.render import render
from ..scene.scene import Scene
from .boxes import check_flat, drawn, edges, largest
from .drawn import Drawn
from .lamps import behind, preview_light
from .orbit import Orbit, View, resized, scaled

# The share of a preview's light that is everywhere, so that shadows are not black.
_AMBIENT = 0.2
# How long a camera may rest, in seconds, before it counts as standing: moves of a mouse are nearer.
_REST = 0.02
# How long a render goes on without anyone who looks: a page that is loaded anew is soon back.
_GRACE = 0.2


@dataclass(frozen=True)
class Sketch:
    """A picture of `Scene.preview`, shown as it is: it knows nothing of how bright lamps are.

    Attributes
    ----------
    rgb : (H, W, 3) uint8
        Its pixels, with the curve of sRGB.
    seconds : float
        How long it took.
    """

    rgb: NDArray[np.uint8]
    seconds: float
    samples: ClassVar[int] = 0
    error: ClassVar[ErrorEstimate] = ErrorEstimate(math.nan, math.nan, math.nan, False)
    warnings: ClassVar[tuple[str, ...]] = ()

    def srgb(self, _exposure: float, _tone: str) -> NDArray[np.uint8]:
        """Return the pixels."""
        return self.rgb


@dataclass(frozen=True)
class Frame:
    """A picture on its way to a page.

    Attributes
    ----------
    number : int
        Counts the pictures of a session.
    image : Image or Sketch
        The picture.
    view : View
        Camera of the picture.
    state : str
        ``"preview"`` if it is a `Sketch`, ``"refining"``, or ``"done"``.
    size : (int, int)
        Width and height in pixels.
    camera : AnyCamera
        Camera of the picture, with the size that the caller gave it.
    exposure, tone
        Exposure and tone of the picture, as in `Image.save`.
    boxes : TreeBoxes, optional
        Level of the accelerator's boxes that is drawn over it.
    """

    number: int
    image: Image | Sketch
    view: View
    state: str
    size: tuple[int, int]
    camera: AnyCamera
    exposure: float = 0.0
    tone: str = DEFAULT
    boxes: TreeBoxes | None = None
    _lock: Lock = field(default_factory=Lock, repr=False, compare=False)

    @property
    def data(self) -> tuple[str, bytes]:
        """The picture as a file, and its type: JPEG is a small part of the work of PNG while it changes."""
        with self._lock:
            return self._data

    @cached_property
    def _data(self) -> tuple[str, bytes]:
        if self.state == "done":
            return "image/png", self.file(".png")
        return "image/jpeg", self.file(".jpg")

    def file(self, suffix: str) -> bytes:
        """Return the picture as a file of such an ending."""
        pixels = self.image.srgb(self.exposure, self.tone)
        if self.boxes is not None:
            pixels = drawn(pixels, edges(self.camera, self.boxes.corners))
        return shown.encoded(pixels, suffix)

    def told(self) -> dict[str, Any]:
        """Return the description of the picture, for JSON; None stands for unknown values."""
        image, view = self.image, self.view
        error = (image.error.estimate, image.error.low, image.error.high)
        height, width = image.rgb.shape[:2]
        return {
            "number": self.number,
            "state": self.state,
            "width": width,
            "height": height,
            "size": self.size,
            "camera": line_of(self.camera),
            "exposure": self.exposure,
            "boxes": None if self.boxes is None else int(self.boxes.depth[0]),
            "samples": image.samples,
            "seconds": image.seconds,
            "error": [None if math.isnan(value) else value for value in error],
            "trusted": image.error.trusted,
            "warnings": list(image.warnings),
            "view": view.told(),
        }


class Session:
    """Renders a scene on a thread of its own, for open pages.

    Parameters
    ----------
    scene : Scene
        The scene.
    camera : Camera or another kind
        Camera at the start.
    integrator : Path or another kind
        Estimator of radiance.
    how : mapping
        Other arguments of `render`.
    exposure, tone
        Exposure and tone of pictures, as in `Image.save`.
    fits : bool
        True if the picture takes the size of its window.
    boxes : int, optional
        Level of the accelerator's boxes that is drawn over pictures.
    """

    def __init__(
        self,
        scene: Scene,
        camera: AnyCamera,
        integrator: AnyIntegrator,
        how: Mapping[str, Any],
        exposure: float = 0.0,
        tone: str = DEFAULT,
        fits: bool = True,
        boxes: int | None = None,
    ) -> None:
        self.fits = fits
        self._exposure, self._tone = exposure, tone
        self._scene, self._integrator, self._how = scene, integrator, dict(how)
        self._given = self._size = (camera.width, camera.height)
        # Compiled here, so that warnings point to the caller and Ctrl-C ends it.
        self._orbit = Orbit(camera, scene._compiled().bounds)
        self._view = View()
        self._boxes = self._level(boxes)
        # Number of the latest request, and of the last one rendered to its end.
        self._wanted, self._done = 1, 0
        self._frame: Frame | None = None
        self._count = self._shown = 0
        self._trouble: str | None = None
        self._watchers, self._left = 0, -math.inf
        self._closed = False
        self._rendering = False
        self._changed = threading.Condition()
        self._thread = threading.Thread(target=self._work, name="raywright-viewer", daemon=True)
        self._thread.start()

    @property
    def rendering(self) -> bool:
        """True while it renders."""
        return self._rendering

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the picture in pixels."""
        return self._size

    @property
    def exposure(self) -> float:
        """By how many stops pictures are shown brighter."""
        return self._exposure

    @property
    def trouble(self) -> str | None:
        """Why there is no picture, in one line; None if all is well."""
        return self._trouble

    @property
    def closed(self) -> bool:
        """True if it was closed."""
        return self._closed

    @property
    def elevations(self) -> tuple[float, float]:
        """The least and greatest elevation of a view."""
        return self._orbit.elevations

    @property
    def view(self) -> View:
        """The view that is wanted now."""
        return self._view

    @property
    def depth(self) -> int | None:
        """Level of the accelerator's boxes that is drawn over pictures."""
        return None if self._boxes is None else int(self._boxes.depth[0])

    @cached_property
    def drawn(self) -> Drawn:
        """Data for a page that draws the scene itself."""
        return Drawn(self._scene, self._orbit, self._integrator, self._how, self._tone)

    @property
    def camera(self) -> AnyCamera:
        """The camera of the view that is wanted now."""
        return self._orbit.camera(self._view)

    def turn(self, view: View) -> None:
        """Show another view. The current render ends at once."""
        with self._changed:
            if view != self._view:
                self._view = view
                self._wanted += 1
                self._changed.notify_all()

    def show(self, integrator: AnyIntegrator) -> None:
        """Show the scene by another integrator. The render before ends at once."""
        with self._changed:
            self._integrator = integrator
            self.drawn.show(integrator)
            self._shown += 1
            self._wanted += 1
            self._changed.notify_all()

    def fit(self, width: int, height: int) -> None:
        """Render as many pixels as a window of this size has room for. The render before ends at once."""
        size = scaled(self._given, min(width / self._given[0], height / self._given[1]))
        with self._changed:
            if size != self._size:
                self._size = size
                self._wanted += 1
                self._changed.notify_all()

    def expose(self, exposure: float) -> None:
        """Show pictures brighter by so many stops, the last one too."""
        with self._changed:
            self._exposure = exposure
            self._show_again()

    def box(self, depth: int | None) -> None:
        """Draw the boxes of a level of the accelerator over pictures, the last one too; none beyond the last.

        Raises
        ------
        ValueError
            If the accelerator has no boxes, or edges are not straight in the camera's pictures.
        """
        boxes = self._level(depth)
        with self._changed:
            self._boxes = boxes
            self._show_again()

    def _level(self, depth: int | None) -> TreeBoxes | None:
        if depth is None:
            return None
        check_flat(self._orbit.camera(View()))
        level = self._tree.at(depth)
        return level if len(level) else None

    @cached_property
    def _tree(self) -> TreeBoxes:
        return self._scene.tree_boxes()

    def corners(self, depth: int) -> bytes:
        """Return the boxes of a level, (K, 8, 3) float32 in box units: of many the largest."""
        return self.drawn.local(largest(self._tree.at(depth).corners)).tobytes()

    def pick(self, view: View, x: float, y: float) -> dict[str, Any]:
        """Describe the hit at a place of the picture of a view, from (0, 0) at its upper left to (1, 1)."""
        camera = resized(self._orbit.camera(view), *self._size)
        (column, right), (row, down) = (
            divmod(share * size, 1.0) for share, size in zip((x, y), self._size, strict=True)
        )
        hit = self._scene.pick(camera, int(column), int(row), (right, down))
        if not hit.hit:
            return {"shape": None}
        return {
            "shape": int(hit.shape_id),
            "name": str(hit.names) or None,
            "face": int(hit.primitive_id),
            "position": hit.position.tolist(),
            "t": float(hit.t),
        }

    def _show_again(self) -> None:
        """Show the last picture with the current exposure and tone; the caller holds the lock."""
        if self._frame is not None:
            self._count += 1
            self._frame = replace(
                self._frame,
                number=self._count,
                exposure=self._exposure,
                boxes=self._boxes,
                _lock=Lock(),
            )
            self._changed.notify_all()

    @contextmanager
    def watched(self) -> Iterator[None]:
        """Register a viewer: without viewers, nothing is rendered."""
        with self._changed:
            self._watchers += 1
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._watchers -= 1
                self._left = time.monotonic()

    def next_frame(self, after: int, seconds: float) -> Frame | None:
        """Return the last picture that there is if it has a greater number, or wait for one for a time."""

        def newer() -> bool:
            fresh = self._frame is not None and self._frame.number > after
            return fresh or self._closed or self._trouble is not None

        with self._changed:
            self._changed.wait_for(newer, seconds)
            frame = self._frame
            return frame if frame is not None and frame.number > after else None

    @property
    def news(self) -> tuple[View, int]:
        """The view that is wanted now, and how many other integrators were shown so far."""
        return self._view, self._shown

    def next_news(self, last: tuple[View, int], seconds: float) -> tuple[View, int]:
        """Return `news`, or wait for a time for others than the last."""
        with self._changed:
            self._changed.wait_for(lambda: self.news != last or self._closed, seconds)
            return self.news

    def close(self) -> None:
        """End all work."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join()

    def is_wanted(self, job: _Job) -> bool:
        """Return whether a job is still wanted."""
        unseen = self._watchers == 0 and time.monotonic() - self._left > _GRACE
        return not self._closed and not unseen and job.number == self._wanted

    def _work(self) -> None:
        def due() -> bool:
            return self._closed or (self._watchers > 0 and self._done < self._wanted)

        while True:
            with self._changed:
                self._changed.wait_for(due)
                if self._closed:
                    return
                job = _Job(self, self._wanted, self._view, self._size)
                self._rendering = True
            try:
                self._preview(job)
                if self._rests(job):
                    self._picture(job)
            except _UnwantedError:
                pass
            except Exception as error:
                with self._changed:
                    self._trouble = " ".join(f"{type(error).__name__}: {error}".split())
                    self._changed.notify_all()
                return
            finally:
                self._rendering = False

    def _rests(self, job: _Job) -> bool:
        """Wait for a moment whether something else is wanted; whether nothing was."""
        with self._changed:
            return not self._changed.wait_for(lambda: self._closed or self._wanted != job.number, _REST)

    def _preview(self, job: _Job) -> None:
        """Show something soon: a ray and a shadow ray per pixel."""
        camera = resized(self._orbit.camera(job.view), *job.size)
        began = time.monotonic()
        pixels = self._scene.preview(
            camera,
            preview_light(self._scene, camera),
            ambient=_AMBIENT,
            background=behind(self._scene),
            threads=self._how.get("threads"),
        )
        self._show(Sketch(pixels, time.monotonic() - began), job, "preview")

    def _picture(self, job: _Job) -> None:
        def show(image: Image) -> None:
            # Until all pixels have a sample, the preview is the better picture.
            if image.samples:
                if isinstance(image, ImageSoFar):
                    # Errors of pixels are not shown here and would take much longer.
                    image.settle_seen()
                self._show(image, job, "refining")

        camera = resized(self._orbit.camera(job.view), *job.size)
        image = render(self._scene, camera, self._integrator, progress=show, stop=job, **self._how)
        self._done = job.number
        self._show(image, job, "done")

    def _show(self, image: Image | Sketch, job: _Job, state: str) -> None:
        with self._changed:
            last = self._frame
            if (
                last is not None
                and (last.view, last.size) == (job.view, job.size)
                and last.state != "preview"
            ):
                samples = 0 if state == "preview" else image.samples
                if samples < last.image.samples:
                    # An interrupted render that restarted was further before.
                    return
            self._count += 1
            seen_by = self._orbit.camera(job.view)
            self._frame = Frame(
                self._count,
                image,
                job.view,
                state,
                job.size,
                seen_by,
                self._exposure,
                self._tone,
                self._boxes,
            )
            self._changed.notify_all()


class _UnwantedError(Exception):
    """The current render is not wanted any more."""


@dataclass(frozen=True)
class _Job:
    """A render job, with the `stop` of `render`."""

    session: Session
    number: int
    view: View
    # Size of the picture, in pixels.
    size: tuple[int, int]

    def is_set(self) -> bool:
        """Raise rather than return: the picture so far is not needed."""
        if not self.session.is_wanted(self):
            raise _UnwantedError
        return False


def line_of(camera: AnyCamera) -> str:
    """Return the line of Python that makes a camera."""
    return re.sub(r"\b([A-Z]\w*\()", r"rw.\1", repr(camera))
