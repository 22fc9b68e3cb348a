"""The viewer's server: a page and its pictures, for browsers of this machine and this user alone.

It listens on 127.0.0.1. Everything is under a path that holds a random token, so that no other user of the
machine and no other page finds it. The headers Host and Origin must be the server's own: no foreign page can
ask, not even one whose name was made to mean this machine (DNS rebinding).
"""

from __future__ import annotations

import base64
import json
import secrets
import select
import socket
import socketserver
import sys
import time
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any

from .orbit import View
from .requests import bytes_of, is_known, scene_told, told
from .session import Session
from .texts import FILES, text

HOST = "127.0.0.1"
_MOST_BODY = 4096
_MOST_PAGES = 32
# Seconds until a closed page is noticed, and until a silent connection is closed.
_LOOK = 0.1
_SILENCE = 10.0
# Seconds and bytes for which the server drains a refused request.
_LINGER = 2.0
_MOST_UNREAD = 1 << 20
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; "
        "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}


class _RefusedError(Exception):
    """Why a request is refused: a status, and one line."""

    def __init__(self, status: HTTPStatus, line: str) -> None:
        super().__init__(line)
        self.status, self.line = status, line


class Server(ThreadingHTTPServer):
    """Serves a session.

    Parameters
    ----------
    session : Session
        What to show.
    port : int
        Port; 0 for any that is free.

    Raises
    ------
    OSError
        If the port is taken.
    """

    daemon_threads = True
    block_on_close = False
    # On Windows, it would let other programs take the port.
    allow_reuse_address = sys.platform != "win32"

    def __init__(self, session: Session, port: int) -> None:
        self.session = session
        self.token = secrets.token_urlsafe(18)
        self.pages = 0
        super().__init__((HOST, port), _Handler)

    def server_bind(self) -> None:
        """Bind, without asking for the machine's name: that may take long."""
        socketserver.TCPServer.server_bind(self)
        self.server_name, self.server_port = HOST, int(self.server_address[1])

    @property
    def url(self) -> str:
        """Where the page is."""
        return f"http://{HOST}:{self.server_port}/{self.token}/"

    @property
    def hosts(self) -> tuple[str, str]:
        """Names of the server."""
        return f"{HOST}:{self.server_port}", f"localhost:{self.server_port}"

    def shutdown_request(self, request: Any) -> None:
        """Close a connection so that the last answer arrives.

        Unread data would make closing reset the connection, and the sender might never see the reason of the
        refusal (RFC 9112, section 9.6). So first our side is closed alone, and the rest is read and thrown
        away.
        """
        try:
            request.shutdown(socket.SHUT_WR)
            end, left = time.monotonic() + _LINGER, _MOST_UNREAD
            while left > 0 and (wait := end - time.monotonic()) > 0:
                request.settimeout(wait)
                more = len(request.recv(min(left, 65536)))
                if more == 0:
                    break
                left -= more
        except OSError:
            pass
        self.close_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Log nothing about browsers that leave."""
        if not isinstance(sys.exc_info()[1], OSError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    server: Server
    protocol_version = "HTTP/1.1"
    # Does not reveal the server software.
    server_version, sys_version = "raywright", ""
    timeout = _SILENCE

    def do_GET(self) -> None:
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def log_message(self, *_: Any) -> None:
        """Log nothing: the shell is for important messages."""

    def send_error(self, code: int, message: str | None = None, explain: str | None = None) -> None:
        """Answer http.server's own errors in one line as well."""
        self.close_connection = True
        self._send(HTTPStatus(code), "text/plain; charset=utf-8", f"{message or 'refused'}\n".encode())

    def _answer(self, how: Any) -> None:
        try:
            how(self._path())
        except _RefusedError as refusal:
            # The rest of the request is not read.
            self.close_connection = True
            self._send(refusal.status, "text/plain; charset=utf-8", f"{refusal.line}\n".encode())

    def _path(self) -> str:
        """Return the answer to an authorized request."""
        server = self.server
        if self.headers.get_all("Host") not in [[host] for host in server.hosts]:
            raise _RefusedError(HTTPStatus.FORBIDDEN, "this server answers to its own name only")
        origins = self.headers.get_all("Origin") or []
        if origins not in [[], *([f"http://{host}"] for host in server.hosts)]:
            raise _RefusedError(HTTPStatus.FORBIDDEN, "this server answers to its own page only")
        # A link from another site may lead to the page, but to nothing else.
        own = self.headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin")
        if not own and self.headers.get("Sec-Fetch-Mode") != "navigate":
            raise _RefusedError(HTTPStatus.FORBIDDEN, "this server answers to its own page only")
        _, token, *rest = [*self.path.partition("?")[0].split("/", 2), ""][:3]
        if not secrets.compare_digest(token.encode(), server.token.encode()):
            raise _RefusedError(HTTPStatus.NOT_FOUND, "not found; use the address that was printed")
        return rest[0]

    def _get(self, path: str) -> None:
        session = self.server.session
        if path in FILES:
            self._send(HTTPStatus.OK, FILES[path], text(path).encode())
        elif path == "picture.png":
            frame = session.next_frame(0, 0.0)
            if frame is None:
                raise _RefusedError(HTTPStatus.NOT_FOUND, "there is no picture yet")
            more = {"Content-Disposition": 'attachment; filename="raywright.png"'}
            self._send(HTTPStatus.OK, "image/png", frame.file(".png"), more)
        elif path in ("events", "news"):
            self._events(session, with_pictures=path == "events")
        elif (data := bytes_of(session, path)) is not None:
            # The address of an array contains its version, so its content never changes.
            kept = (
                {"Cache-Control": "private, max-age=86400, immutable"} if path.startswith("arrays/") else {}
            )
            self._send(HTTPStatus.OK, "application/octet-stream", data, kept)
        else:
            raise _RefusedError(HTTPStatus.NOT_FOUND, "not found")

    def _post(self, path: str) -> None:
        if not is_known(path):
            raise _RefusedError(HTTPStatus.NOT_FOUND, "not found")
        if self.headers.get_content_type() != "application/json":
            raise _RefusedError(HTTPStatus.BAD_REQUEST, f"a {path} must be application/json")
        try:
            answer = told(self.server.session, path, json.loads(self._body()))
        except (ValueError, TypeError, RecursionError) as error:
            raise _RefusedError(HTTPStatus.BAD_REQUEST, " ".join(str(error).split())[:200]) from error
        if answer is None:
            self._send(HTTPStatus.NO_CONTENT, None, b"")
        else:
            data = json.dumps(answer, allow_nan=False).encode()
            self._send(HTTPStatus.OK, "application/json", data)

    def _body(self) -> bytes:
        told = self.headers.get("Content-Length", "")
        # http.server does not decode chunked bodies.
        if "Transfer-Encoding" in self.headers or not (told.isascii() and told.isdigit()):
            raise _RefusedError(HTTPStatus.LENGTH_REQUIRED, "the body must have a Content-Length")
        if len(told) > 9 or int(told) > _MOST_BODY:
            raise _RefusedError(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"a body has {_MOST_BODY} bytes at most")
        body = self.rfile.read(int(told))
        if len(body) < int(told):
            raise _RefusedError(HTTPStatus.BAD_REQUEST, "the body ends too early")
        return body

    def _events(self, session: Session, with_pictures: bool) -> None:
        """Send pictures, or only where the camera is, as server-sent events until the page is closed."""
        server = self.server
        if server.pages >= _MOST_PAGES:
            raise _RefusedError(HTTPStatus.SERVICE_UNAVAILABLE, "too many pages are connected already")
        server.pages += 1
        self.close_connection = True
        try:
            self._head(HTTPStatus.OK, {"Content-Type": "text/event-stream", "Connection": "close"})
            # Taken before the scene is sent: changes in between count as news.
            news = session.news
            self._event("scene", scene_told(session))
            if with_pictures:
                with session.watched():
                    self._pictures(session, news)
            else:
                self._news(session, news)
        except OSError:
            # The page was closed during the transfer.
            pass
        finally:
            server.pages -= 1

    def _news(self, session: Session, last: tuple[View, int]) -> None:
        """Push camera motions, by whichever page, and changes of the integrator."""
        spoke = time.monotonic()
        while not session.closed and not _has_left(self.connection):
            view, shown = news = session.next_news(last, _LOOK)
            if news != last:
                if shown != last[1]:
                    self._event("again", {})
                self._event("view", view.told())
                last = news
            elif session.trouble is not None:
                self._event("trouble", {"line": session.trouble})
                return
            elif time.monotonic() - spoke > 0.5 * _SILENCE:
                self.wfile.write(b":\n\n")
            else:
                continue
            spoke = time.monotonic()

    def _pictures(self, session: Session, news: tuple[View, int]) -> None:
        last, shown, spoke = 0, news[1], time.monotonic()
        while not session.closed and not _has_left(self.connection):
            frame = session.next_frame(last, _LOOK)
            if shown != session.news[1]:
                shown = session.news[1]
                self._event("again", {})
            if frame is not None:
                last = frame.number
                kind, data = frame.data
                picture = {"type": kind, "data": base64.b64encode(data).decode()}
                self._event("frame", frame.told() | {"picture": picture})
            elif session.trouble is not None:
                self._event("trouble", {"line": session.trouble})
                return
            elif time.monotonic() - spoke > 0.5 * _SILENCE:
                self.wfile.write(b":\n\n")
            else:
                continue
            spoke = time.monotonic()

    def _event(self, name: str, told: dict[str, Any]) -> None:
        self.wfile.write(f"event: {name}\ndata: {json.dumps(told, allow_nan=False)}\n\n".encode())

    def _send(
        self, status: HTTPStatus, kind: str | None, data: bytes, more: dict[str, str] | None = None
    ) -> None:
        headers = {} if kind is None else {"Content-Type": kind, "Content-Length": str(len(data))}
        if self.close_connection:
            headers["Connection"] = "close"
        self._head(status, headers | (more or {}))
        if self.command != "HEAD":
            self.wfile.write(data)

    def _head(self, status: HTTPStatus, headers: dict[str, str]) -> None:
        self.send_response(status)
        for name, value in (_HEADERS | headers).items():
            self.send_header(name, value)
        self.end_headers()


def _has_left(connection: socket.socket) -> bool:
    """Whether the other side has closed a connection on which it has nothing to say."""
    # poll if available, since select is limited to 1024 connections.
    if hasattr(select, "poll"):
        poll = select.poll()
        poll.register(connection, select.POLLIN)
        ready = bool(poll.poll(0))
    else:
        ready = bool(select.select([connection], [], [], 0)[0])
    return ready and not connection.recv(1, socket.MSG_PEEK)
