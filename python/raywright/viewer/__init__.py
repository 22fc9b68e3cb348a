"""Scenes in the browser: a page that shows a render while it gets better, and lets the camera be moved."""

from __future__ import annotations

import atexit
import threading
from typing import TYPE_CHECKING, Any

from ..arrays import SeedLike, integer
from ..cameras import AnyCamera
from ..integrators import AnyIntegrator, Path, check_integrator
from ..io.tone import DEFAULT, check_tone
from ..public_names import public_names
from ..rendering.build_image import shines
from ..rendering.check_request import check_picture
from ..rendering.filters import BoxFilter, Filter
from ..rendering.samplers import Sampler
from ..scene.framing import framed
from ..scene.scene import Scene
from ..scenes.studio import lit

if TYPE_CHECKING:
    from .server import Server
    from .session import Session
    from .widget import ViewerWidget

__all__ = ["Viewer", "view"]
__dir__ = public_names(__name__)

_PATH = Path()
_FILTER: Filter = BoxFilter()
_ERROR = 1e-4
_NO_WIDGET = (
    "the viewer in a notebook needs anywidget, which is not installed: pip install 'raywright[widget]'"
)


class Viewer:
    """A scene that is served to the browsers of this machine until it is closed; `view` makes it.

    It is a context manager, which closes it at the end. In a notebook it shows itself in its cell, by
    `widget`, if the extra ``raywright[widget]`` is installed.

    Attributes
    ----------
    url : str
        Address of the page: on 127.0.0.1, under a secret token.

    See Also
    --------
    view : Makes it.

    Examples
    --------
    >>> with rw.view(rw.Scene(rw.Sphere())) as viewer:
    ...     print(viewer.url.startswith("http://127.0.0.1:"))
    True
    """

    url: str

    def __init__(self, server: Server, session: Session) -> None:
        self.url = server.url
        self._server, self._session = server, session
        self._widget: ViewerWidget | None = None
        self._closed = threading.Event()
        # The interpreter does not wait for daemon threads at its end.
        atexit.register(self.close)
        self._thread = threading.Thread(
            target=server.serve_forever, args=(0.1,), name="raywright-server", daemon=True
        )
        self._thread.start()

    @property
    def rendering(self) -> bool:
        """True during a render; False without open pages, and after the picture is finished."""
        return self._session.rendering

    @property
    def camera(self) -> AnyCamera:
        """The current camera; its repr is the expression that makes it."""
        return self._session.camera

    def show(self, integrator: AnyIntegrator) -> None:
        """Switch to another integrator, such as the next state of a radiosity solution.

        Parameters
        ----------
        integrator : Path or another kind
            Estimator of radiance from now on. The current render ends at once; the camera stays in place.

        Raises
        ------
        TypeError
            If `integrator` is none.

        See Also
        --------
        view : Takes the first integrator.

        Examples
        --------
        >>> with rw.view(rw.Scene(rw.Sphere())) as viewer:
        ...     viewer.show(rw.AmbientOcclusion())
        """
        check_integrator("integrator", integrator)
        self._session.show(integrator)
        if self._widget is not None:
            self._widget.again()

    def widget(self) -> ViewerWidget:
        """Return the viewer as a widget for notebooks.

        It is the page, connected by the notebook's own messages, so it also works with a kernel on another
        machine. Nothing is rendered while it is not visible.

        Returns
        -------
        ViewerWidget

        Raises
        ------
        ImportError
            If anywidget is not installed.

        See Also
        --------
        view : Serves a page instead.

        Examples
        --------
        >>> import anywidget
        >>> with rw.view(rw.Scene(rw.Sphere())) as viewer:
        ...     print(type(viewer.widget()).__name__)
        ViewerWidget
        """
        if self._widget is None:
            try:
                from .widget import ViewerWidget
            except ImportError as missing:
                raise ImportError(_NO_WIDGET) from missing
            self._widget = ViewerWidget(self._session)
        return self._widget

    def wait(self) -> None:
        """Wait until the viewer is closed, or close it on Ctrl-C.

        See Also
        --------
        Viewer.close : Ends the waiting.

        Examples
        --------
        >>> viewer = rw.view(rw.Scene(rw.Sphere()))
        >>> viewer.close()
        >>> viewer.wait()
        """
        try:
            # In short waits: signals that do not interrupt a wait are handled in between.
            while not self._closed.wait(0.5):
                pass
        except KeyboardInterrupt:
            pass
        finally:
            self.close()

    def close(self) -> None:
        """End the render and the server. Open pages keep their last picture.

        See Also
        --------
        Viewer.wait : Waits for it.

        Examples
        --------
        >>> viewer = rw.view(rw.Scene(rw.Sphere()))
        >>> viewer.close()
        >>> viewer.rendering
        False
        """
        if not self._closed.is_set():
            self._closed.set()
            atexit.unregister(self.close)
            self._session.close()
            if self._widget is not None:
                self._widget.end()
            self._server.shutdown()
            self._server.server_close()
            self._thread.join()

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> Any:
        """Return the notebook's display: the widget, or the page's address and the missing package."""
        try:
            widget = self.widget()
        except ImportError as missing:
            return {"text/plain": f"{self!r}\n({missing})"}
        return widget._repr_mimebundle_(include=include, exclude=exclude)

    def __enter__(self) -> Viewer:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"Viewer({'closed' if self._closed.is_set() else self.url})"


def view(
    scene: Scene,
    camera: AnyCamera | None = None,
    integrator: AnyIntegrator = _PATH,
    samples: int | None = None,
    error: float | None = None,
    seconds: float | None = None,
    *,
    seed: SeedLike = 0,
    threads: int | None = None,
    adaptive: bool = False,
    clamp: float | None = None,
    sampler: Sampler | None = None,
    filter: Filter = _FILTER,
    exposure: float = 0.0,
    tone: str = DEFAULT,
    fit: bool = True,
    boxes: int | None = None,
    port: int = 0,
    open: bool = False,
) -> Viewer:
    """Show a scene in the browser, or in a notebook cell, with a camera moved by the mouse.

    The page is served to this machine only, until the process ends or the viewer is closed. With WebGPU, the
    page draws scenes of meshes itself: one ray and one shadow ray per pixel while the camera moves, then more
    and more paths. For materials, lights and integrators that the page does not support, the core renders
    once the camera is still. Without WebGPU the core renders all pictures: a small one at once, then a better
    one. The error of the picture is always shown. The key g switches between page and core. Nothing is
    rendered while no page is open. A notebook cell that ends with the viewer shows it (`Viewer.widget`).

    Parameters
    ----------
    scene, integrator, samples, error, seconds, seed, threads, adaptive, clamp, sampler, filter
        As in `render`. If no limit is given, it renders to a relMSE of 1e-4.
    camera : Camera or another kind, optional
        Camera at the start. If not given, the scene is framed; a scene without light is lit as in
        `scenes.studio`.
    exposure, tone
        Exposure and tone of pictures, as in `Image.save`. The page changes the exposure without a new render.
    fit : bool
        True to fill the window, in the proportions of the camera's picture; False for the camera's number of
        pixels. `Viewer.camera` keeps its own size.
    boxes : int, optional
        Level of the accelerator's boxes to draw over the picture, 0 for the root; at most the 20,000 largest
        are drawn. The keys b and B go a level deeper and back. `Scene.tree_boxes` gives the boxes.
    port : int
        Port of the server; any free port if 0.
    open : bool
        True to open a browser.

    Returns
    -------
    Viewer
        Its `url` is the address of the page; ``viewer.wait()`` waits until Ctrl-C, ``viewer.close()`` ends
        it.

    Raises
    ------
    TypeError, ValueError
        As `render`; also if `boxes` is negative, the accelerator has none, or the camera is a `Fisheye` or a
        `Panorama`, in whose pictures edges are bent.
    OSError
        If the port is taken.

    See Also
    --------
    render : A picture without a window.

    Examples
    --------
    >>> with rw.view(rw.Scene(rw.Sphere()), samples=16) as viewer:
    ...     print(viewer.camera.forward.shape)
    (3,)
    """
    if not isinstance(fit, bool):
        raise TypeError(f"fit must be True or False, got {fit!r}")
    boxes = None if boxes is None else integer("boxes", boxes, 0)
    port, exposure = integer("port", port, 0, 65535), check_tone(exposure, tone)
    if samples is None and error is None and seconds is None:
        error = _ERROR
    if camera is None and isinstance(scene, Scene):
        camera = framed(scene.shapes)
        if not shines(scene):
            scene = lit(scene.shapes, camera)
    checked = check_picture(
        scene, camera, integrator, samples, error, seconds, seed, threads, adaptive, clamp, sampler, filter
    )
    how: dict[str, Any] = {
        "samples": samples,
        "error": error,
        "seconds": seconds,
        "seed": checked.seed,
        "threads": threads,
        "adaptive": adaptive,
        "clamp": clamp,
        "sampler": sampler,
        "filter": filter,
    }
    # Imported here, because only the viewer needs it (import time).
    from .server import Server
    from .session import Session

    session = Session(scene, camera, integrator, how, exposure, tone, fit, boxes)
    try:
        server = Server(session, port)
    except BaseException:
        session.close()
        raise
    viewer = Viewer(server, session)
    if open:
        import webbrowser

        webbrowser.open(viewer.url)
    return viewer
