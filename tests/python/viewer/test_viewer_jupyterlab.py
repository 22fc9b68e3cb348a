"""The viewer in a cell of JupyterLab itself, driven by a real browser.

``pip install jupyterlab '.[browser,widget]'`` brings what it takes, but for the browser.
"""

import contextlib
import json
import os
import socket
import subprocess
import sys
import time
import urllib.request
from pathlib import Path

import pytest

import raywright as rw

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
pytest.importorskip("anywidget", reason="anywidget is not installed")
pytest.importorskip("jupyterlab", reason="jupyterlab is not installed")
from viewer_browser import launched, needs_chromium, opened

pytestmark = [needs_chromium, pytest.mark.slow]
VIEW = """import raywright as rw
viewer = rw.view(*rw.scenes.cornell_box(width=64, height=64), error=1e-12, fit=False)
viewer"""
ASK = "(viewer.rendering, viewer.widget().watches, viewer.camera.position[0] == 278)"
# Output of the first cell: a widget hides its parts.
VIEWER = """[...document.querySelectorAll(".jp-OutputArea-output *")]
    .find(part => part.shadowRoot)?.shadowRoot.querySelector(".viewer")"""


def notebook(*sources):
    cells = [
        {"id": f"cell{i}", "cell_type": "code", "metadata": {}, "source": source, "outputs": []}
        | {"execution_count": None}
        for i, source in enumerate(sources)
    ]
    kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
    told = {"nbformat": 4, "nbformat_minor": 5, "metadata": {"kernelspec": kernel}, "cells": cells}
    return json.dumps(told)


@contextlib.contextmanager
def served(folder):
    """A server of its own, which knows nothing of what whoever runs this has set: its address."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    kinds = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR")
    kinds += ("JUPYTERLAB_SETTINGS_DIR", "JUPYTERLAB_WORKSPACES_DIR")
    places = {kind: str(folder / kind.lower()) for kind in kinds}
    found = os.pathsep.join([str(Path(rw.__file__).parents[1]), os.environ.get("PYTHONPATH", "")])
    options = {
        "ServerApp.port": port,
        "ServerApp.port_retries": 0,
        "ServerApp.root_dir": folder,
        "IdentityProvider.token": "token",
        "LabApp.check_for_updates_class": "jupyterlab.NeverCheckForUpdate",
    }
    given = [f"--{name}={value}" for name, value in options.items()]
    server = subprocess.Popen(
        [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", *given],
        env=os.environ | places | {"PYTHONPATH": found},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        end = time.monotonic() + 60
        while True:
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{port}/api", timeout=10).close()
                break
            except OSError:
                assert server.poll() is None
                assert time.monotonic() < end
                time.sleep(0.1)
        yield f"http://127.0.0.1:{port}/lab/tree/view.ipynb?token=token"
    finally:
        server.terminate()
        try:
            server.wait(10)
        except subprocess.TimeoutExpired:
            # Its kernels end when they notice its absence.
            server.kill()
            server.wait()


def run(page, cell, source):
    """Run something in a cell that was there."""
    cell.locator(".cm-content").click()
    page.keyboard.press("Control+a")
    page.keyboard.insert_text(source)
    page.keyboard.press("Control+Enter")


def until(page, cell, wanted):
    """Ask the kernel until it says what is wanted."""
    end = time.monotonic() + 20
    said = None
    while said != wanted:
        assert time.monotonic() < end, said
        run(page, cell, ASK)
        page.wait_for_timeout(300)
        with contextlib.suppress(Exception):
            said = cell.locator(".jp-OutputArea-output").last.inner_text(timeout=1000).strip()


def command(page, cell, keys):
    """Give commands of the notebook to a cell."""
    cell.locator(".jp-InputPrompt").click()
    for key in keys:
        page.keyboard.press(key)


def test_it_is_drawn_and_moved_and_ends_with_its_cell_and_its_kernel(tmp_path):
    (tmp_path / "view.ipynb").write_text(notebook(VIEW, ASK))
    with (
        served(tmp_path) as address,
        launched("--disable-gpu") as browser,
        opened(browser, 1200, 900) as page,
    ):
        page.goto(address)
        page.locator("#jp-main-statusbar").get_by_text("| Idle").wait_for(timeout=60_000)
        first, asked = (page.locator(".jp-CodeCell").nth(i) for i in (0, 1))
        run(page, first, VIEW)
        samples = f"() => +{VIEWER}?.viewer.byId('samples').textContent"
        page.wait_for_function(f"{samples} >= 2", timeout=60_000, polling=50)
        until(page, asked, "(True, 1, True)")
        box = page.locator(".viewer #stage").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        for step in range(8):
            page.mouse.move(x + 10 * step, y)
        page.mouse.up()
        until(page, asked, "(True, 1, False)")
        assert page.evaluate(f"{VIEWER}.viewer.view.azimuth") < -10
        # Keys go to the viewer after a click on it, and to the notebook again afterwards.
        page.mouse.click(x, y)
        page.keyboard.press("d")
        page.keyboard.press("d")
        page.keyboard.press("b")
        page.wait_for_function(f"() => {VIEWER}.viewer.boxes === 0", timeout=10_000)
        command(page, first, "dd")
        page.wait_for_function("() => document.querySelectorAll('.jp-CodeCell').length === 1", timeout=10_000)
        (asked,) = page.locator(".jp-CodeCell").all()
        until(page, asked, "(False, 0, False)")
        # Shown again, by another cell, it continues; a restarted kernel knows nothing of it.
        run(page, asked, "viewer")
        page.wait_for_function(f"{samples} >= 1", timeout=20_000, polling=50)
        command(page, asked, "00")
        page.locator(".jp-Dialog").wait_for(timeout=10_000)
        page.keyboard.press("Enter")
        ended = f"() => {VIEWER}.viewer.byId('message').textContent.includes('has ended')"
        page.wait_for_function(ended, timeout=30_000, polling=100)
        page.locator("#jp-main-statusbar").get_by_text("| Idle").wait_for(timeout=30_000)
