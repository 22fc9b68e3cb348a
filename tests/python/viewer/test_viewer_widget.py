"""The viewer in a notebook's cell: what its page and the kernel say to each other."""

import base64
import io
import queue
import sys
import time

import numpy as np
import pytest
from PIL import Image as Pillow

import raywright as rw

pytest.importorskip("anywidget", reason="anywidget is not installed")
from raywright.viewer import widget as widgets

SIZE = {"width": 48, "height": 48}


class Cell:
    """A widget's messages, without a notebook: pairs of what was said and bytes."""

    def __init__(self, viewer):
        self.widget = viewer.widget()
        self.heard = queue.Queue()
        self.widget.send = lambda content, buffers=(): self.heard.put((content, list(buffers)))
        self.count = 0

    def say(self, **content):
        self.widget._handle_custom_msg({"page": 1, **content}, [])

    def next(self, kind):
        while True:
            content, buffers = self.heard.get(timeout=20)
            if kind in content:
                return content, buffers

    def ask(self, what, given):
        self.count += 1
        self.say(do="ask", id=self.count, what=what, given=given)
        content, _ = self.next("answer")
        assert content["answer"] == self.count
        return content.get("told", content.get("error"))

    def bytes(self, name, start=0):
        self.say(do="bytes", id=0, name=name, start=start)
        content, buffers = self.next("answer")
        return content.get("total", content.get("error")), b"".join(buffers)


def is_soon(condition):
    end = time.monotonic() + 5
    while not condition() and time.monotonic() < end:
        time.sleep(0.01)
    return condition()


@pytest.fixture
def viewer():
    with rw.view(*rw.scenes.cornell_box(**SIZE), error=1e-12) as viewer:
        yield viewer


def test_it_holds_the_page_and_all_its_modules(viewer):
    widget = viewer.widget()
    assert widget is viewer.widget()
    assert 'id="drawn"' in widget._parts
    assert "<body" not in widget._parts
    assert ".viewer {" in widget._style
    assert "export default { render };" in widget._esm
    assert "import " not in "".join(line for line in widget._esm.splitlines(True) if line[0] != " ")
    bundle, _ = viewer._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in bundle


def test_pictures_come_one_after_the_other_as_long_as_someone_looks(viewer):
    cell = Cell(viewer)
    assert not viewer.rendering
    cell.say(do="watch", on=True)
    content, (data,) = cell.next("frame")
    assert content["page"] == 1
    assert np.asarray(Pillow.open(io.BytesIO(data))).std() > 10
    # The next one waits until this one has arrived.
    time.sleep(0.3)
    assert cell.heard.empty()
    cell.say(do="seen")
    later, _ = cell.next("frame")
    assert later["frame"]["number"] > content["frame"]["number"]
    assert viewer.rendering
    cell.say(do="watch", on=False)
    assert is_soon(lambda: not viewer.rendering)
    assert cell.widget.watches == 0


def test_a_page_that_is_gone_is_given_up_and_goes_on_when_it_is_back(viewer, monkeypatch):
    monkeypatch.setattr(widgets, "_SILENCE", 0.3)
    cell = Cell(viewer)
    cell.say(do="watch", on=True)
    cell.next("frame")
    assert is_soon(lambda: not viewer.rendering)
    cell.say(do="seen")
    assert cell.next("frame")[0]["frame"]["state"]
    cell.say(do="watch", on=False)


def test_it_answers_as_the_server_does(viewer, monkeypatch):
    cell = Cell(viewer)
    assert cell.ask("scene", {})["width"] == 48
    told = cell.ask("drawing", {})
    monkeypatch.setattr(widgets, "_PART", 1000)
    whole, start = b"", 0
    while start < told["arrays"]["nodes"]:
        total, part = cell.bytes(f"arrays/{told['version']}/nodes", start)
        assert total == told["arrays"]["nodes"]
        assert 0 < len(part) <= 1000
        whole, start = whole + part, start + len(part)
    scene = rw.scenes.cornell_box(**SIZE)[0]
    assert whole == scene.gpu_arrays().nodes.tobytes()
    assert b"struct Look" in cell.bytes("sight.wgsl")[1]
    assert cell.ask("pick", {"view": {}, "x": 0.5, "y": 0.6})["shape"] >= 0
    assert cell.ask("view", {"azimuth": 30}) is None
    # All pages of the widget get the message.
    assert cell.next("view")[0]["view"]["azimuth"] == 30
    assert viewer.camera.position[0] != 278
    viewer.show(rw.Whitted())
    cell.next("again")
    viewer.close()
    cell.next("ended")


def test_what_makes_no_sense_is_told_so(viewer):
    cell = Cell(viewer)
    assert "zoom must be between" in cell.ask("view", {"zoom": 0})
    assert cell.ask("none", {}) == cell.ask(["view"], {}) == "unknown request"
    assert cell.bytes("page.py") == ("nothing has this name", b"")
    assert cell.bytes("../session.py") == ("nothing has this name", b"")
    assert "a name" in cell.bytes(None)[0]
    assert "a place to start" in cell.bytes("sight.wgsl", -1)[0]
    for content in ({"page": "1", "do": "watch", "on": True}, {"do": "none"}, [], "watch", {}):
        cell.widget._handle_custom_msg(content, [])
    cell.say(do="seen")
    assert cell.heard.empty()
    assert cell.widget.watches == 0


def test_without_anywidget_it_is_told_what_is_missing(viewer, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "raywright.viewer.widget")
    with pytest.raises(ImportError, match=r"pip install 'raywright\[widget\]'"):
        viewer.widget()
    shown = viewer._repr_mimebundle_()
    assert viewer.url in shown["text/plain"]
    assert "raywright[widget]" in shown["text/plain"]


FAKE = """([esm, traits]) => {
    window.outbox = [];
    window.heard = [];
    window.lost = [];
    const listeners = name => ({ "msg:custom": heard, comm_live_update: lost })[name];
    window.model = {
        get: name => traits[name],
        send: content => outbox.push(content),
        on: (name, hear) => listeners(name).push(hear),
        off: (name, hear) => listeners(name).splice(listeners(name).indexOf(hear), 1),
    };
    window.deliver = ([content, data]) => {
        const bytes = text => Uint8Array.from(atob(text), letter => letter.charCodeAt(0));
        const buffers = data.map(text => new DataView(bytes(text).buffer));
        [...heard].forEach(hear => hear(content, buffers));
    };
    const url = URL.createObjectURL(new Blob([esm], { type: "text/javascript" }));
    return import(url).then(({ default: { render } }) => {
        const el = document.body.appendChild(document.createElement("div"));
        window.cleanup = render({ model, el });
        window.host = el.shadowRoot.querySelector(".viewer");
    });
}"""


def test_the_module_draws_in_a_cell():
    pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    from viewer_browser import CHROMIUM, WEBGPU, launched, opened

    if CHROMIUM is None:
        pytest.skip("chromium is not installed")
    scene = rw.scenes.cornell_box(**SIZE)
    with launched(*WEBGPU) as browser, opened(browser) as page, rw.view(*scene, fit=False) as viewer:
        cell = Cell(viewer)
        # A page of this machine: WebGPU is unavailable to others.
        page.route("**/*", lambda route: route.fulfill(body="<!doctype html>", content_type="text/html"))
        page.goto("http://localhost/")
        traits = {name: getattr(cell.widget, name) for name in ("_parts", "_style", "height")}
        page.evaluate(FAKE, [cell.widget._esm, traits])

        def until(condition):
            end = time.monotonic() + 30
            while not page.evaluate(condition):
                assert time.monotonic() < end, condition
                for content in page.evaluate("() => outbox.splice(0)"):
                    cell.widget._handle_custom_msg(content, [])
                while not cell.heard.empty():
                    content, buffers = cell.heard.get()
                    data = [base64.b64encode(one).decode() for one in buffers]
                    page.evaluate("told => deliver(told)", [content, data])
                time.sleep(0.01)

        until("host.viewer.drawing && host.viewer.drawing.sample >= 1")
        assert page.evaluate("host.dataset.way") == "drawn"
        assert not viewer.rendering
        page.locator("#drawn").focus()
        page.keyboard.press("ArrowRight")
        until("host.viewer.drawing.sample >= 1 && host.viewer.wire.unsent.size === 0")
        assert is_soon(lambda: viewer.camera != scene[1])
        page.keyboard.press("g")
        until("host.dataset.shown === 'picture' && host.dataset.state === 'refining'")
        assert viewer.rendering
        page.evaluate("cleanup()")
        until("outbox.length === 0 && heard.length === 0")
        assert is_soon(lambda: not viewer.rendering)


@pytest.mark.filterwarnings("default")
def test_a_real_kernel_shows_it_and_sends_pictures():
    pytest.importorskip("ipykernel", reason="ipykernel is not installed")
    manager = pytest.importorskip("jupyter_client.manager", reason="jupyter_client is not installed")
    source = (
        "import raywright as rw\n"
        "viewer = rw.view(*rw.scenes.cornell_box(width=32, height=32), error=1e-12)\n"
        "viewer"
    )
    kernel, client = manager.start_new_kernel(kernel_name="python3")
    try:
        client.execute(source)

        def heard(wanted):
            while True:
                message = client.get_iopub_msg(timeout=60)
                content = message["content"]
                assert message["msg_type"] != "error", content
                found = wanted(message["msg_type"], content)
                if found is not None:
                    return found, message["buffers"]

        def shown(kind, content):
            view = "application/vnd.jupyter.widget-view+json"
            return content["data"].get(view) if kind == "execute_result" else None

        def custom(name):
            def told(kind, content):
                is_custom = kind == "comm_msg" and content["data"].get("method") == "custom"
                return content["data"]["content"].get(name) if is_custom else None

            return told

        def say(**content):
            data = {"method": "custom", "content": {"page": 1, **content}}
            message = client.session.msg("comm_msg", {"comm_id": model["model_id"], "data": data})
            client.shell_channel.send(message)

        model, _ = heard(shown)
        say(do="ask", id=1, what="scene", given={})
        assert heard(custom("told"))[0]["width"] == 32
        say(do="watch", on=True)
        for _ in range(2):
            _, (data,) = heard(custom("frame"))
            assert np.asarray(Pillow.open(io.BytesIO(data))).std() > 10
            say(do="seen")
        client.execute("viewer.close(); viewer.rendering")
        assert heard(lambda kind, told: told["data"] if kind == "execute_result" else None)[0] == {
            "text/plain": "False"
        }
    finally:
        client.stop_channels()
        kernel.shutdown_kernel(now=True)
