"""A page of the viewer, as far as its server sees it."""

import base64
import io
import json
import time
from contextlib import closing, contextmanager
from http.client import HTTPConnection
from urllib.parse import urlsplit

import numpy as np
from PIL import Image as Pillow


def ask(viewer, path="", method="GET", body=None, base=None, **headers):
    at = urlsplit(viewer.url)
    with closing(HTTPConnection(at.hostname, at.port, timeout=20)) as connection:
        named = {name.replace("_", "-"): value for name, value in headers.items()}
        connection.request(method, (at.path if base is None else base) + path, body, named)
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()


def turn(viewer, **view):
    return ask(viewer, "view", "POST", json.dumps(view), Content_Type="application/json")[0]


@contextmanager
def page(viewer_or_url, path="events"):
    """What a page hears: pairs of an event's name and what it tells."""
    at = urlsplit(getattr(viewer_or_url, "url", viewer_or_url))
    with closing(HTTPConnection(at.hostname, at.port, timeout=20)) as connection:
        connection.request("GET", at.path + path)
        answer = connection.getresponse()
        assert (answer.status, answer.headers["Content-Type"]) == (200, "text/event-stream")

        def events():
            name, spoke = None, time.monotonic()
            for line in answer:
                # The server sends signs of life, so that no read takes long.
                assert time.monotonic() - spoke < 20, "nothing new is heard"
                if line.startswith(b"event: "):
                    name = line[7:].strip().decode()
                elif line.startswith(b"data: "):
                    yield name, json.loads(line[6:])
                    spoke = time.monotonic()

        try:
            yield events()
        finally:
            answer.close()


def pixels(frame):
    data = base64.b64decode(frame["picture"]["data"])
    return np.asarray(Pillow.open(io.BytesIO(data)), float)


def until(events, wanted):
    """The first frame that is as wanted."""
    return next(told for name, told in events if name == "frame" and wanted(told))


def is_done(frame):
    return frame["state"] == "done"
