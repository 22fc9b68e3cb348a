"""Whom the viewer answers, and what it takes from them."""

import re
import socket
import sys
import time
from contextlib import closing
from urllib.parse import urlsplit

import pytest
from viewer_page import ask

import raywright as rw
from raywright.viewer.texts import MODULES, SHADERS

SIZE = {"width": 96, "height": 72}


@pytest.fixture
def viewer():
    """One that goes on for ever."""
    with rw.view(*rw.scenes.cornell_box(**SIZE), error=1e-12) as viewer:
        yield viewer


def test_it_listens_on_this_machine_alone(viewer):
    at = urlsplit(viewer.url)
    assert at.hostname == "127.0.0.1"
    # All of 127/8 is this machine, and would answer if the server listened on all addresses.
    others = ["127.0.0.2"] if sys.platform == "linux" else []
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as outside:
        try:
            outside.connect(("192.0.2.1", 9))
            others.append(outside.getsockname()[0])
        except OSError:
            pass
    for host in others:
        with pytest.raises((ConnectionRefusedError, TimeoutError)):
            socket.create_connection((host, at.port), timeout=2).close()


def test_the_page_is_served_with_what_keeps_others_out(viewer):
    scripts = [(name, "text/javascript") for name in ("page.js", *MODULES)]
    shaders = [(name, "text/plain") for name in SHADERS]
    for path, kind in (("", "text/html"), ("page.css", "text/css"), *scripts, *shaders):
        status, headers, body = ask(viewer, path)
        assert status == 200
        assert headers["Content-Type"].startswith(kind)
        assert len(body) == int(headers["Content-Length"]) > 500
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "default-src 'none'" in headers["Content-Security-Policy"]
        assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
        assert "Access-Control-Allow-Origin" not in headers


def test_foreign_hosts_and_origins_are_refused(viewer):
    port = urlsplit(viewer.url).port
    foreign = [
        {"Host": "example.org"},
        {"Host": f"example.org:{port}"},
        {"Host": "127.0.0.1"},
        {"Host": f"127.0.0.1:{port + 1}"},
        {"Host": ""},
        {"Origin": "http://example.org"},
        {"Origin": f"http://example.org:{port}"},
        {"Origin": f"https://127.0.0.1:{port}"},
        {"Origin": "http://127.0.0.1"},
        {"Origin": "null"},
        {"Sec_Fetch_Site": "cross-site", "Sec_Fetch_Mode": "cors"},
    ]
    view = {"method": "POST", "body": "{}", "Content_Type": "application/json"}
    for headers in foreign:
        for path, how in (
            ("", {}),
            ("events", {}),
            ("news", {}),
            ("picture.png", {}),
            ("boxes/0", {}),
            ("view", view),
            ("pick", view),
            ("drawing", view),
        ):
            status, _, body = ask(viewer, path, **how, **headers)
            assert (status, body.count(b"\n")) == (403, 1), headers
    for host in (f"127.0.0.1:{port}", f"localhost:{port}"):
        assert ask(viewer, Host=host, Origin=f"http://{host}", Sec_Fetch_Site="same-origin")[0] == 200


def test_nothing_is_found_without_the_token(viewer):
    token = urlsplit(viewer.url).path.strip("/")
    assert len(token) >= 24
    for base in ("/", "/page.js", "/events", f"/{token[:-1]}/", f"/{token}.", "*", "/%00/"):
        status, _, body = ask(viewer, base=base)
        assert (status, body.count(b"\n")) == (404, 1), base
    with rw.view(*rw.scenes.cornell_box(**SIZE)) as other:
        assert urlsplit(other.url).path != urlsplit(viewer.url).path


@pytest.mark.parametrize(
    "path",
    [
        "events2",
        "page.html",
        "../server.py",
        "view",
        "..%2fserver.py",
        "drawing",
        "widget.js",
        "arrays/1/nodes",
    ],
)
def test_nothing_else_is_served(viewer, path):
    assert ask(viewer, path)[0] == 404


@pytest.mark.parametrize(
    ("body", "line"),
    [
        (b"", "Expecting value"),
        (b"{", "Expecting property name"),
        (b"\xc3(", "codec can't decode"),
        (b"[]", "view must be an object, got list"),
        (b'{"roll": 1}', "view has no 'roll'"),
        (b'{"zoom": 0}', "zoom must be between"),
        (b'{"zoom": NaN}', "zoom must be"),
        (b'{"zoom": "1"}', "zoom must be"),
        (b'{"zoom": 1' + b"0" * 4000 + b"}", "."),
        (b"[" * 4000, "."),
    ],
)
def test_bad_views_are_refused_in_one_line(viewer, body, line):
    status, _, told = ask(viewer, "view", "POST", body, Content_Type="application/json")
    assert status == 400
    assert re.fullmatch(f".*{line}.*\n", told.decode())


@pytest.mark.parametrize(
    ("path", "body", "line"),
    [
        ("window", b"[]", "a window must be an object with width and height"),
        ("window", b'{"width": 100}', "a window must be an object with width and height"),
        ("window", b'{"width": 100, "height": 1e9}', "height must be an integer"),
        ("window", b'{"width": 100, "height": 5000}', "height must be .*4096.*got 5000"),
        ("window", b'{"width": 0, "height": 100}', "width must be .*16.*got 0"),
        ("exposure", b'{"exposure": 100}', "exposure must be between -20 and 20, got 100"),
        ("exposure", b'{"exposure": "1"}', "exposure must be"),
        ("exposure", b'{"exposure": NaN}', "exposure must be"),
        ("exposure", b'{"tone": 1}', "an exposure must be an object with exposure"),
    ],
)
def test_bad_windows_and_exposures_are_refused_in_one_line(viewer, path, body, line):
    status, _, told = ask(viewer, path, "POST", body, Content_Type="application/json")
    assert status == 400
    assert re.fullmatch(f".*{line}.*\n", told.decode()), told


def test_what_is_too_much_or_of_another_kind_is_refused(viewer):
    kind = {"Content_Type": "application/json"}
    assert ask(viewer, "view", "POST", b"{}")[0] == 400
    assert ask(viewer, "view", "POST", b"{}", Content_Type="text/plain")[0] == 400
    assert ask(viewer, "view", "POST", b" " * 5000, **kind)[0] == 413
    assert ask(viewer, "view", "POST", Content_Length="9" * 5000, **kind)[0] == 413
    assert ask(viewer, "view", "POST", Content_Length="-1", **kind)[0] == 411
    assert ask(viewer, "view", "POST", iter([b"{}"]), **kind)[0] == 411
    assert ask(viewer, "", "POST", b"{}", **kind)[0] == 404
    for method in ("PUT", "DELETE", "OPTIONS", "HEAD", "TRACE"):
        assert ask(viewer, method=method)[0] == 501


def test_who_still_sends_what_is_refused_learns_why(viewer):
    at = urlsplit(viewer.url)
    head = f"POST {at.path}view HTTP/1.1\r\nHost: {at.netloc}\r\nContent-Type: application/json\r\n"
    for length, status in (("Transfer-Encoding: chunked", b"411"), ("Content-Length: 5000", b"413")):
        with closing(socket.create_connection((at.hostname, at.port), timeout=20)) as connection:
            connection.sendall(f"{head}{length}\r\n\r\n".encode())
            # The answer has arrived, and the server has finished with the connection.
            assert connection.recv(1, socket.MSG_PEEK)
            time.sleep(0.2)
            for _ in range(5):
                connection.sendall(b" " * 1000)
                time.sleep(0.01)
            told = b"".join(iter(lambda: connection.recv(65536), b""))
        assert told.startswith(b"HTTP/1.1 " + status), told


def test_what_is_no_request_is_refused_in_one_line(viewer):
    at = urlsplit(viewer.url)
    for said in (
        b"\x00\x01\r\n\r\n",
        b"GET\r\n\r\n",
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET / HTTP/1.1\r\nno header\r\n\r\n",
    ):
        with closing(socket.create_connection((at.hostname, at.port), timeout=20)) as connection:
            connection.sendall(said)
            told = b"".join(iter(lambda: connection.recv(65536), b""))
        # Before the version is known, the answer is HTTP/0.9, without headers.
        line = told.rpartition(b"\r\n\r\n")[2]
        assert line.count(b"\n") == 1, told
        assert b"<" not in line
