"""Debian's chromium or the like, without a window, driven by playwright.

``pip install '.[browser]'`` and ``apt-get install chromium`` (or chromium-headless-shell) bring both.
"""

import base64
import io
import shutil
from contextlib import contextmanager

import numpy as np
import pytest
from PIL import Image as Pillow

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
NAMES = ("chromium", "chromium-headless-shell", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
# WebGPU in software.
WEBGPU = (
    "--enable-unsafe-webgpu",
    "--enable-features=Vulkan",
    "--use-vulkan=swiftshader",
    "--use-angle=swiftshader",
)


@contextmanager
def launched(*flags):
    """A browser."""
    with playwright.sync_playwright() as driver:
        # Its sandbox fails for root or within containers, and it only sees our own page.
        one = driver.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox", *flags])
        yield one
        one.close()


@contextmanager
def opened(browser, width=900, height=700):
    """An empty page that must have nothing to complain of."""
    page = browser.new_page(viewport={"width": width, "height": height})
    complaints = []
    page.on("console", lambda told: complaints.append(told.text) if told.type == "error" else None)
    page.on("pageerror", lambda error: complaints.append(str(error)))
    yield page
    if not page.is_closed():
        page.close()
    assert complaints == []


def decoded(data):
    """The pixels of a file."""
    return np.asarray(Pillow.open(io.BytesIO(base64.b64decode(data))).convert("RGB"), float)


def told(page, name):
    return page.text_content(f"#{name}")


def is_state(state):
    return f"document.body.dataset.state === '{state}'"
