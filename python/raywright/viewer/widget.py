"""The viewer in a notebook: the same page in a cell, by messages between it and the kernel.

All goes by the widget's own channel, so that it works wherever the kernel runs; the viewer's server would be
out of reach of a browser on another machine.
"""

from __future__ import annotations

import re
import threading
from typing import Any

import anywidget
import traitlets

from .requests import bytes_of, is_known, scene_told, told
from .session import Session
from .texts import SHADERS, bundled, text

# Most bytes per message: some notebooks drop larger ones.
_PART = 4 << 20
# Seconds until the session notices that a page has gone, and seconds that it may take to show a picture.
_LOOK = 0.1
_SILENCE = 10.0
_BODY = re.compile(r"<body[^>]*>(.*)</body>", re.DOTALL)


class ViewerWidget(anywidget.AnyWidget):  # type: ignore[misc]
    """A session in a cell of a notebook.

    Parameters
    ----------
    session : Session
        The session to show.
    height : int
        Of the cell's output, in pixels.
    """

    _esm = bundled("widget.js")
    _parts = traitlets.Unicode().tag(sync=True)
    _style = traitlets.Unicode().tag(sync=True)
    height = traitlets.Int(520).tag(sync=True)

    def __init__(self, session: Session, height: int = 520) -> None:
        found = _BODY.search(text(""))
        super().__init__(_parts=found.group(1) if found else "", _style=text("page.css"), height=height)
        self._session = session
        self._watches: dict[int, _Watch] = {}
        self.on_msg(self._hear)

    @property
    def watches(self) -> int:
        """Number of pages that the core renders for."""
        return sum(watch.is_alive() for watch in self._watches.values())

    def again(self) -> None:
        """Notify pages that the core renders another picture now."""
        self.send({"again": True})

    def end(self) -> None:
        """Notify pages of the end."""
        for watch in self._watches.values():
            watch.end()
        self.send({"ended": True})

    def _hear(self, _: Any, content: Any, __: Any) -> None:
        """Handle a message of a page; nonsense gets an error, or no answer."""
        if not isinstance(content, dict):
            return
        page, what = content.get("page"), content.get("do")
        if not isinstance(page, int):
            return
        if what in ("ask", "bytes"):
            answer, buffers = self._answer(what, content)
            self.send({"page": page, "answer": content.get("id"), **answer}, buffers)
            if content.get("what") == "view":
                self.send({"view": self._session.view.told(), "from": page})
        elif what == "watch":
            self._watch(page, content.get("on") is True)
        elif what == "seen":
            watch = self._watches.get(page)
            # A page given up while the kernel was busy resumes.
            if watch is not None and watch.seen():
                self._watch(page, True)

    def _watch(self, page: int, is_on: bool) -> None:
        before = self._watches.pop(page, None)
        if before is not None:
            before.end()
        if is_on and not self._session.closed:
            self._watches[page] = _Watch(self, self._session, page)

    def _answer(self, what: str, content: dict[str, Any]) -> tuple[dict[str, Any], list[bytes]]:
        try:
            if what == "bytes":
                return self._bytes(content.get("name"), content.get("start"))
            asked, given = content.get("what"), content.get("given")
            if asked == "scene":
                return {"told": scene_told(self._session)}, []
            if not isinstance(asked, str) or not is_known(asked):
                return {"error": "unknown request"}, []
            return {"told": told(self._session, asked, given)}, []
        except (ValueError, TypeError) as error:
            return {"error": " ".join(str(error).split())[:200]}, []

    def _bytes(self, name: Any, start: Any) -> tuple[dict[str, Any], list[bytes]]:
        if not isinstance(name, str) or not isinstance(start, int) or start < 0:
            raise ValueError("bytes have a name, and a place to start at")
        data = text(name).encode() if name in SHADERS else bytes_of(self._session, name)
        if data is None:
            return {"error": "nothing has this name"}, []
        return {"total": len(data)}, [data[start : start + _PART]]


class _Watch(threading.Thread):
    """Sends pictures to a page, each once the one before has arrived."""

    def __init__(self, widget: ViewerWidget, session: Session, page: int) -> None:
        super().__init__(name="raywright-widget", daemon=True)
        self._widget, self._session, self._page = widget, session, page
        self._ended, self._arrived = threading.Event(), threading.Event()
        self.start()

    def end(self) -> None:
        """Send no more."""
        self._ended.set()
        self._arrived.set()

    def seen(self) -> bool:
        """Hear that a picture has arrived; whether it was given up before."""
        self._arrived.set()
        return not self.is_alive() and not self._ended.is_set()

    def run(self) -> None:
        """Send pictures until it is ended, or the page seems gone."""
        session, last = self._session, 0
        with session.watched():
            while not (self._ended.is_set() or session.closed):
                frame = session.next_frame(last, _LOOK)
                if frame is not None:
                    last = frame.number
                    kind, data = frame.data
                    self._arrived.clear()
                    self._widget.send({"page": self._page, "frame": frame.told() | {"type": kind}}, [data])
                    if not self._arrived.wait(_SILENCE):
                        return
                elif session.trouble is not None:
                    self._widget.send({"page": self._page, "trouble": session.trouble})
                    return
