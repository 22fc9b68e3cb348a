"""Renders that are ended from outside keep what there is of them."""

import signal
import subprocess
import sys
import threading

import numpy as np
import pytest

import raywright as rw

# Explicit options, so that the render begins at once.
PLAIN = rw.Path(reuse=1, guiding="none")


@pytest.fixture
def box():
    return rw.scenes.cornell_box(width=40, height=30)


class Presses:
    """Watches a render, and raises a signal when it has so many samples."""

    def __init__(self, number, samples=3):
        self.number, self.samples, self.done = number, samples, False

    def __call__(self, image):
        if image.samples >= self.samples and not self.done:
            self.done = True
            signal.raise_signal(self.number)


def test_ctrl_c_leaves_the_picture_in_what_it_raises(box):
    with pytest.raises(KeyboardInterrupt) as caught:
        rw.render(*box, PLAIN, samples=10**8, progress=Presses(signal.SIGINT))
    image = caught.value.image
    assert image.samples >= 3
    # Of a box with a lamp: the mean of a long render, within some noise.
    long = rw.render(*box, PLAIN, samples=64, progress=False)
    assert image.rgb.mean() == pytest.approx(long.rgb.mean(), rel=0.2)
    assert np.isfinite(image.rgb).all()


def test_ctrl_c_may_return_the_picture_with_all_that_was_asked_for(box):
    how = {"aov": "depth", "background": "transparent", "on_interrupt": "return"}
    image = rw.render(*box, PLAIN, samples=10**8, progress=Presses(signal.SIGINT), **how)
    assert image.samples >= 3
    assert image.warnings[0] == "interrupted by Ctrl-C"
    assert image.aov["depth"].shape == image.alpha.shape == (30, 40)
    assert np.isfinite(image.standard_error).all()


def test_before_the_first_sample_of_all_pixels_it_is_told(box):
    scene, _ = box
    scene.build(progress=False)
    large = rw.scenes.cornell_box(width=400, height=400)[1]
    timer = threading.Timer(0.2, signal.raise_signal, (signal.SIGINT,))
    timer.start()
    image = rw.render(scene, large, PLAIN, samples=10**8, progress=False, on_interrupt="return")
    timer.join()
    assert image.warnings[0] == "interrupted by Ctrl-C"
    told = "interrupted before every pixel had a sample" in image.warnings
    assert told == (image.samples == 0)


SCRIPT = """
import os, signal, sys
import raywright as rw
def press(image):
    if image.samples >= 3:
        os.kill(os.getpid(), signal.SIGTERM)
handler = lambda *_: print("heard", flush=True) or os._exit(7)
if sys.argv[2] == "handled":
    signal.signal(signal.SIGTERM, handler)
box = rw.scenes.cornell_box(width=40, height=30)
path = rw.Path(reuse=1, guiding="none")
chance = rw.rendering.Independent()
rw.render(*box, path, samples=10**8, sampler=chance, progress=press, checkpoint=sys.argv[1])
"""


@pytest.mark.parametrize(("how", "status"), [("plain", -signal.SIGTERM), ("handled", 7)])
@pytest.mark.skipif(sys.platform == "win32", reason="there is no SIGTERM to catch")
def test_sigterm_writes_the_checkpoint_and_does_what_it_did(box, tmp_path, how, status):
    path = tmp_path / "kept"
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT, str(path), how], capture_output=True, text=True, timeout=60
    )
    assert done.returncode == status, done.stderr
    assert done.stdout == ("heard\n" if how == "handled" else "")
    how = {"integrator": PLAIN, "sampler": rw.rendering.Independent(), "progress": False}
    kept = rw.render(*box, samples=1, checkpoint=path, **how)
    assert kept.samples >= 3
    again = rw.render(*box, samples=kept.samples, **how)
    assert np.array_equal(kept.rgb, again.rgb)


def test_a_handler_that_lets_the_process_live_lets_the_render_end(box, tmp_path):
    heard = []
    before = signal.signal(signal.SIGTERM, lambda *_: heard.append(1))
    mine = signal.getsignal(signal.SIGTERM)
    try:
        how = {"samples": 300, "sampler": rw.rendering.Independent()}
        image = rw.render(*box, PLAIN, **how, progress=Presses(signal.SIGTERM), checkpoint=tmp_path / "kept")
        assert signal.getsignal(signal.SIGTERM) is mine
    finally:
        signal.signal(signal.SIGTERM, before)
    assert heard == [1]
    assert image.samples == 300
    assert np.array_equal(image.rgb, rw.render(*box, PLAIN, **how, progress=False).rgb)
