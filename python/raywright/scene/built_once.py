"""The build of a scene: once, by one thread, watched by progress."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

from .. import _core
from ..debug_log import debug
from ..io.quiet import warn_caller
from ..locks import Lock
from ..query.queries import Queries
from ..shapes.mesh import face_count
from .instance import AnyShape
from .progress import BuildProgress, check_progress, watcher
from .unpickle_cache import Arrival


class BuiltOnce(Queries):
    """A scene that is compiled once: by `build`, or else by its first query."""

    _shapes: tuple[AnyShape, ...]

    def __init__(self) -> None:
        self._core: _core.CompiledScene | None = None
        self._has_arrived = False
        # A compiled scene of the same shapes.
        self._alike: _core.CompiledScene | None = None
        self._is_loss_told = False
        # Progress callbacks run in the building thread, which must not wait for itself.
        self._lock = Lock()
        # Process id of the builder: a build by another thread of the parent does not continue after a fork.
        self._building = 0

    def build(self, progress: BuildProgress = True) -> None:
        """Compile the scene for rays now; otherwise the first query does.

        Parameters
        ----------
        progress : bool or callable
            True for a progress bar on stderr after two seconds. Or a function that gets the completed share,
            from 0 to 1 and never decreasing: at most ten times a second, and at the end with 1. An exception
            in the function ends the build; the function cannot query the scene. If a query compiles the
            scene, there is a bar if stderr is a terminal.

        Raises
        ------
        TypeError
            If `progress` is anything else.
        ValueError
            If something in the scene cannot be compiled.
        KeyboardInterrupt
            At once, when Ctrl-C is pressed, as in any query that compiles the scene. The scene is unchanged,
            and can be compiled again.

        See Also
        --------
        Scene.rebuild : Build the accelerator anew.

        Examples
        --------
        >>> scene = rw.Scene(rw.scenes.torus_knot(along=40, around=8))
        >>> shares = []
        >>> scene.build(progress=shares.append)
        >>> shares[-1]
        1.0
        """
        check_progress(progress)
        self._compiled(progress)

    def rebuild(self, progress: BuildProgress = True) -> None:
        """Rebuild the accelerator for the current vertices.

        Parameters
        ----------
        progress : bool or callable
            As for `build`.

        Raises
        ------
        TypeError, KeyboardInterrupt
            As `build` does.

        See Also
        --------
        Scene.refit : Move the vertices without a new accelerator.

        Examples
        --------
        >>> knot = rw.scenes.torus_knot(along=40, around=8)
        >>> scene = rw.Scene(knot)
        >>> scene.build(progress=False)
        >>> growth = scene.refit(knot.vertices * [1, 3, 1])
        >>> scene.accelerator_info.kind.endswith("refitted")
        True
        >>> scene.rebuild(progress=False)
        >>> scene.accelerator_info.kind.endswith("refitted")
        False
        """
        check_progress(progress)
        with self._unless_building():
            # Builds again even if an unpickled scene could reuse a cached one.
            self._core, self._has_arrived = None, False
            self._alike = None
        self._compiled(progress)

    @contextmanager
    def _unless_building(self) -> Iterator[None]:
        """Wait for another thread that builds the scene."""
        with self._lock:
            if self._building and self._building == os.getpid():
                raise RuntimeError("the scene is being built: its progress function cannot query it")
            yield

    def _compiled(self, progress: BuildProgress | None = None) -> _core.CompiledScene:
        with self._unless_building():
            if self._core is not None:
                if callable(progress):
                    progress(1.0)
                return self._core
            arrival = Arrival.of(self) if self._has_arrived else None
            if arrival is not None and (core := arrival.core()) is not None:
                if callable(progress):
                    progress(1.0)
                self._core = core
                return core
            self._building = os.getpid()
            try:
                compiled = self._alike and self._alike.refitted(self)
                if compiled is None:
                    with watcher(progress) as report:
                        compiled = _core.CompiledScene(self, self._accelerator, report)
                elif callable(progress):
                    progress(1.0)
                self._core, self._alike = compiled, None
                _log_build(compiled)
                if arrival is not None:
                    arrival.keep(compiled)
            finally:
                self._building = 0
        if compiled.dropped:
            faces = sum(map(face_count, self._shapes))
            warn_caller(f"{compiled.dropped} of {faces} faces were dropped: a corner is NaN or infinite")
        self._tell_loss(compiled)
        return compiled

    def _tell_loss(self, compiled: _core.CompiledScene) -> None:
        """Warn once of digits lost by rounding to float32."""
        if compiled.loss is None or self._is_loss_told:
            return
        self._is_loss_told = True
        moved, share = compiled.loss
        warn_caller(
            f'precision="single" moves vertices by up to {moved:.3g}, {share:.2g} of the extent of their '
            'mesh; "auto" and "double" keep them where they are'
        )


def _log_build(compiled: _core.CompiledScene) -> None:
    info = compiled.accelerator
    what = info.kind, info.primitives, info.build_seconds, info.nodes, info.precision, compiled.bytes
    debug("scene built: %s of %d primitives in %.4f s, %d nodes, %s precision, %d bytes", *what)
