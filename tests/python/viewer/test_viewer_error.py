"""How wrong the page's own pictures are, as it tells: chromium's WebGPU, in software."""

import base64
import warnings

import numpy as np
import pytest

import raywright as rw

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
from viewer_browser import WEBGPU, is_state, launched, needs_chromium, opened, told

pytestmark = needs_chromium
# Sums over paths: radiance, their number, squared deviations from the mean, and the largest.
BROUGHT = """async () => {
    const { paths, device } = viewer.drawing.passes;
    const size = paths.sums.size;
    const copy = device.createBuffer({ size, usage: GPUBufferUsage.COPY_DST | GPUBufferUsage.MAP_READ });
    const encoder = device.createCommandEncoder();
    encoder.copyBufferToBuffer(paths.sums, 0, copy, 0, size);
    device.queue.submit([encoder.finish()]);
    await copy.mapAsync(GPUMapMode.READ);
    const bytes = new Uint8Array(copy.getMappedRange());
    return btoa(Array.from(bytes, byte => String.fromCharCode(byte)).join(""));
}"""


@pytest.fixture(scope="module")
def browser():
    with launched(*WEBGPU) as one:
        yield one


@pytest.fixture
def page(browser):
    with opened(browser, 600, 400) as page:
        yield page


def go_on(page, **limits):
    """Draw to other limits: the estimate, and the sums of paths."""
    page.evaluate("limits => Object.assign(viewer.drawing.told.traced, limits)", limits)
    page.evaluate("() => { delete document.body.dataset.state; viewer.drawing.work(); }")
    page.wait_for_function(
        f"() => {is_state('done')} && !viewer.drawing.isWorking", timeout=60_000, polling=20
    )
    brought = np.frombuffer(base64.b64decode(page.evaluate(BROUGHT)), "<f4").astype(float)
    width, height = page.evaluate("viewer.drawing.passes.paths.size")
    return page.evaluate("viewer.drawing.error"), brought.reshape(height, width, 3, 4)


def begin(page, viewer):
    page.goto(viewer.url)
    page.wait_for_function("() => window.viewer?.drawing?.passes.paths.isReady", timeout=60_000, polling=20)


class Brought:
    """A device that brings the page's sums, so that the core's film tells how wrong they are."""

    name = "the page"

    def __init__(self, brought):
        count, sums = brought[..., 0, 3], brought[..., :3]
        squares = sums[..., 1, :] + sums[..., 0, :] ** 2 / count[..., None]
        self.rows = np.stack([sums[..., 0, :], squares, sums[..., 2, :]], axis=-2).reshape(-1, 9)
        self.samples = int(count[0, 0])

    def _paths(self, *_):
        return self

    def add(self, done, count, look):
        return self.rows * (done == 0), 0

    def destroy(self):
        pass

    def error(self, scene, camera):
        how = {"samples": self.samples, "device": self, "progress": False}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return rw.render(scene, camera, rw.Path(reuse=1, guiding="none"), **how).error


def glass():
    """A ball of glass beneath a small lamp: light that few paths find."""
    round_ = rw.scenes.torus_knot(along=60, around=12, material=rw.Dielectric(1.5))
    ground = rw.Mesh([(-6, -3, -6), (-6, -3, 6), (6, -3, 6), (6, -3, -6)], [(0, 1, 2), (0, 2, 3)])
    bulb = rw.Mesh([(0, 6, 0), (0.3, 6, 0), (0, 6, 0.3)], [(0, 1, 2)], emission=400.0)
    return rw.Scene([round_, ground, bulb]), rw.Camera((0, 4, 12), (0, 0, 0), width=40, height=32)


def agrees(error, core):
    """Whether an estimate is the core's, but for f32 and what is counted in bins."""
    assert [error[name] for name in ("value", "low", "high")] == pytest.approx(
        [core.estimate, core.low, core.high], rel=1e-3
    )
    assert error["isTrusted"] is core.trusted


def test_the_page_tells_how_wrong_its_picture_is(page):
    scene, camera = rw.scenes.cornell_box(width=32, height=32)
    # Off by a hundredth of the picture below.
    reference = {"samples": 1024, "sampler": rw.rendering.Sobol(), "seed": 10**9, "progress": False}
    truth = rw.render(scene, camera, rw.Path(reuse=4), **reference).rgb.astype(float)
    with rw.view(scene, camera, fit=False, samples=2) as viewer:
        begin(page, viewer)
        few, brought = go_on(page)
        agrees(few, Brought(brought).error(scene, camera))
        # The render ends once the whole interval is below the wanted error.
        enough, _ = go_on(page, samples=4096, error=0.05)
        ended = page.evaluate("viewer.drawing.sample")
        assert 16 <= ended < 64
        assert enough["high"] <= 0.05
        error, brought = go_on(page, samples=64, error=None)
        agrees(error, Brought(brought).error(scene, camera))
        rgb = brought[..., 0, :3] / 64
        wrong = np.mean((rgb - truth) ** 2 / (truth**2 + 0.01))
        assert error["low"] < wrong < error["high"]
        assert error["value"] == pytest.approx(wrong, rel=0.25)
        # It falls as one over the number of paths, within the errors of either picture.
        assert error["value"] == pytest.approx(enough["value"] * ended / 64, rel=0.3)
        assert float(told(page, "error")) == pytest.approx(error["value"], rel=0.01)
        low, high = (float(end) for end in told(page, "interval").split(" to "))
        assert (low, high) == pytest.approx((error["low"], error["high"]), rel=0.01)
        seconds, errors = np.array(page.evaluate("viewer.figures.history")).T
        assert len(errors) > 5
        assert (np.diff(seconds) >= 0).all()
        # A moving camera reports no error, and a standing one begins anew.
        page.evaluate("() => { viewer.drawing.told.traced = null; viewer.drawing.on.stands = () => {}; }")
        page.evaluate("viewer.move({ azimuth: 30 })")
        page.wait_for_function("() => document.getElementById('samples').textContent === 'sketch'", polling=5)
        assert told(page, "error") == "\N{EN DASH}"
        assert told(page, "interval") == ""


def test_a_page_that_is_given_up_while_it_estimates_has_nothing_to_complain_of(page):
    with rw.view(*rw.scenes.cornell_box(width=16, height=16), fit=False, samples=2) as viewer:
        begin(page, viewer)
        go_on(page)
        # The promise of the estimate never settles.
        page.evaluate("""async () => {
            const { drawing } = viewer;
            const { errors } = drawing.passes.paths;
            const estimate = errors.estimate.bind(errors);
            const begun = new Promise(done => {
                errors.estimate = () => { setTimeout(done); return estimate(); };
            });
            drawing.told.traced.samples = 3;
            drawing.work();
            await begun;
            viewer.close();
            while (drawing.isWorking) {
                await new Promise(done => setTimeout(done, 10));
            }
        }""")


@pytest.mark.slow
def test_few_paths_that_find_the_light_are_not_trusted(page):
    scene, camera = glass()
    with rw.view(scene, camera, fit=False, samples=8) as viewer:
        begin(page, viewer)
        for samples in (8, 64, 65):
            error, brought = go_on(page, samples=samples)
            core = Brought(brought).error(scene, camera)
            agrees(error, core)
            assert core.trusted is (samples == 8)
            assert told(page, "error").endswith(" ?") is not core.trusted
