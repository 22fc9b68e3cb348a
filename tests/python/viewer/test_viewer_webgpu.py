"""The viewer's page where it draws by itself, with WebGPU: chromium's own, in software."""

import json
import time

import numpy as np
import pytest
from PIL import Image as Pillow

import raywright as rw
from raywright.viewer.boxes import drawn, edges
from raywright.viewer.orbit import Orbit, View

pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
from viewer_browser import WEBGPU, decoded, is_state, launched, needs_chromium, opened, told

pytestmark = needs_chromium
SIZE = 48
FILE = """async () => {
    const bytes = new Uint8Array(await (await viewer.drawing.saved()).arrayBuffer());
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


@pytest.fixture(scope="module")
def box():
    return rw.scenes.cornell_box(width=SIZE, height=SIZE)


def begin(page, viewer):
    """Wait until it is known which way it is drawn."""
    page.goto(viewer.url)
    page.wait_for_function("() => window.viewer")
    page.evaluate("() => viewer.ready")


def state(page, name):
    return page.get_attribute("body", f"data-{name}")


def wait(page, condition, seconds=20):
    page.wait_for_function(f"() => {condition}", timeout=1000 * seconds, polling=20)


def picture(page, condition="true", seconds=20):
    """The pixels that are drawn once something is true."""
    wait(page, condition, seconds)
    return decoded(page.evaluate(FILE))


def test_paths_are_traced_while_the_camera_stands_and_the_picture_gets_better(page, box):
    truth = rw.render(*box, samples=256, progress=False).srgb().astype(float)
    with rw.view(*box, fit=False, samples=16) as viewer:
        begin(page, viewer)
        assert state(page, "way") == state(page, "shown") == "drawn"
        assert told(page, "way") == "WebGPU"
        early = picture(page, "viewer.drawing.sample >= 1")
        at = page.evaluate("viewer.drawing.sample")
        late = picture(page, is_state("done"))
        assert told(page, "samples") == "16"
        # Errors fall with the number of paths in the mean.
        errors = [np.square(one - truth).mean() for one in (early, late)]
        assert errors[1] < 2 * errors[0] * at / 16 + 20
        # The mean of a picture covers paths by the ten thousand, and errs by less than a hundredth.
        assert np.allclose(late.mean(axis=(0, 1)), truth.mean(axis=(0, 1)), rtol=0.04, atol=0)
        # The page does all the work.
        assert not viewer.rendering


def test_a_dragged_camera_is_drawn_at_once_and_the_core_knows_where_it_is(page, box):
    with rw.view(*box, fit=False) as viewer:
        begin(page, viewer)
        start = picture(page, "viewer.drawing.sample >= 1")
        # No more than that: a standing camera draws nothing.
        page.evaluate("() => { viewer.drawing.told.traced = null; viewer.drawing.on.stands = () => {}; }")
        drawings = page.evaluate("viewer.drawing.pictures")
        page.mouse.move(300, 150)
        page.mouse.down()
        for x in range(300, 361, 10):
            page.mouse.move(x, 150)
        sketch = picture(page, f"viewer.drawing.pictures > {drawings}")
        assert told(page, "samples") == "sketch"
        page.mouse.up()
        assert np.abs(sketch - start).mean() > 10
        azimuth = page.evaluate("viewer.view.azimuth")
        assert azimuth < -10
        seen_by = Orbit(box[1]).camera(View(azimuth=azimuth))
        end = time.monotonic() + 5
        while viewer.camera != seen_by and time.monotonic() < end:
            time.sleep(0.01)
        assert viewer.camera == seen_by
        assert not viewer.rendering
        # The picture agrees with the core's from there: it is dark where the core sees nothing.
        hits = box[0].pick(seen_by, np.arange(SIZE), np.arange(SIZE)[:, None])
        whole = picture(page, "viewer.drawing.isWhole && !viewer.drawing.isWorking")
        agree = (whole.max(axis=2) > 40) == hits.hit
        assert agree.mean() > 0.99


def test_rays_of_all_views_are_those_of_the_core(page, box):
    eye = {"position": (1.0, 2.0, 6.0), "target": (0.5, 1.0, 0.0), "width": 120, "height": 90}
    K = [[150.0, 3.0, 61.0], [0.0, 140.0, 40.0], [0.0, 0.0, 1.0]]
    cameras = [
        rw.Camera(**eye),
        rw.Camera.from_intrinsics(K, np.diag([1.0, -1.0, -1.0]), (0, 0, 5), 120, 90),
        rw.ThinLens(**eye, f_stop=0.05),
        rw.Orthographic(**eye, scale=4.0),
    ]
    places = np.array([(0.0, 0.0), (0.3, 0.9), (0.5, 0.5), (1.0, 0.2)])
    ask = """async ([url, orbit, view]) => (await import(url)).spread(orbit, view)"""
    with rw.view(*box, fit=False, samples=1) as viewer:
        begin(page, viewer)
        for camera in cameras:
            orbit = Orbit(camera, np.array([(-1, -1, 0), (1, 1, 2)]))
            for view in (View(), View(azimuth=75, elevation=-30, zoom=1.7, right=0.2, up=-0.4), View(0, 150)):
                given = [viewer.url + "orbit.js", orbit.told(), view.told()]
                spread = {name: np.array(rows) for name, rows in page.evaluate(ask, given).items()}
                starts, ways = (
                    rows[0] + places[:, :1] * rows[1] + places[:, 1:] * rows[2] for rows in spread.values()
                )
                origins, directions = orbit.camera(view).rays_through(places * (120, 90))
                assert np.allclose(starts, origins, rtol=0, atol=1e-12)
                ways /= np.linalg.norm(ways, axis=1, keepdims=True)
                assert np.allclose(ways, directions, rtol=0, atol=1e-12)


def test_heat_and_boxes_are_drawn_by_keys(page):
    scene, camera = rw.scenes.cornell_box(rw.scenes.torus_knot(), width=128, height=128)
    with rw.view(scene, camera, fit=False) as viewer:
        begin(page, viewer)
        page.keyboard.press("h")
        heat = picture(page, "viewer.isHeat && viewer.drawing.isWhole && !viewer.drawing.isWorking")
        # Many boxes lie around the knot, and few around walls.
        assert heat[80:100, 80:120, 0].mean() > 1.5 * heat[30:50, 40:80, 0].mean()
        assert "1 to 256 nodes" in told(page, "samples")
        page.keyboard.press("b")
        page.keyboard.press("b")
        wait(page, "document.getElementById('message').textContent === 'boxes 1 step from the root'")
        lines = picture(page) - heat
        # At the same place as the core's boxes, to a pixel.
        level = edges(camera, scene.tree_boxes().at(1).corners)
        wanted = drawn(np.zeros((128, 128, 3), np.uint8), level).any(axis=2)
        found = np.abs(lines).max(axis=2) > 20
        near = np.zeros_like(wanted)
        for x in (-1, 0, 1):
            for y in (-1, 0, 1):
                near |= np.roll(wanted, (y, x), (0, 1))
        assert found.sum() > 0.5 * wanted.sum()
        assert (found & ~near).sum() < 0.02 * found.sum()
        for _ in range(2):
            page.keyboard.press("B")
        wait(page, "viewer.boxes === null && !viewer.drawing.passes.boxes")
        assert np.array_equal(picture(page), heat)


def test_a_click_is_answered_by_the_core(page, box):
    scene, camera = box
    with rw.view(scene, camera, fit=False, samples=1) as viewer:
        begin(page, viewer)
        wait(page, is_state("done"))
        room = page.evaluate(
            "(({ left, top, width, height }) => [left, top, width, height])(drawn.getBoundingClientRect())"
        )
        scale = min(room[2], room[3])
        for x, y in ((0.5, 0.6), (0.1, 0.5), (0.7, 0.8)):
            left, top = room[0] + (room[2] - scale) / 2, room[1] + (room[3] - scale) / 2
            at = [round(left + x * scale), round(top + y * scale)]
            page.evaluate("delete document.body.dataset.picked")
            page.mouse.click(*at)
            wait(page, "document.body.dataset.picked")
            found = json.loads(state(page, "picked"))
            place = np.clip([(at[0] - left) / scale, (at[1] - top) / scale], 0, 0.9999) * SIZE
            hit = scene.pick(camera, *np.int64(place).tolist(), place % 1)
            assert (found["shape"], found["face"]) == (hit.shape_id, hit.primitive_id)
            assert np.allclose(found["position"], hit.position, rtol=0, atol=1.0)
            assert found["t"] == pytest.approx(float(hit.t), abs=1.0)
            assert told(page, "message").startswith(f"shape {hit.shape_id}")


def test_the_core_draws_by_a_key_and_what_the_page_does_not_know(page, box):
    with rw.view(*box, fit=False, samples=4) as viewer:
        begin(page, viewer)
        page.keyboard.press("g")
        wait(page, f"document.body.dataset.shown === 'picture' && {is_state('done')}")
        assert told(page, "way") == "the core"
        assert float(told(page, "error").removesuffix(" ?")) > 0
        page.keyboard.press("g")
        wait(page, "document.body.dataset.shown === 'drawn' && viewer.drawing.sample >= 1")
        # Standing still, another integrator shows the core's picture.
        viewer.show(rw.Whitted())
        wait(page, f"document.body.dataset.shown === 'picture' && {is_state('done')}")
        assert told(page, "way") == "WebGPU"
        assert "what stands is the core's: the page has no Whitted" in page.get_attribute("#way", "title")
        page.focus("#picture")
        page.keyboard.press("ArrowRight")
        wait(page, "document.body.dataset.shown === 'drawn'")
        wait(page, f"document.body.dataset.shown === 'picture' && {is_state('done')}")


def test_what_has_no_triangles_is_streamed(page):
    scene = rw.Scene([rw.Sphere((0, 0, 0), 1.0)], environment=1.0)
    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=SIZE, height=SIZE)
    with rw.view(scene, camera, fit=False, samples=4) as viewer:
        begin(page, viewer)
        wait(page, is_state("done"))
        assert (state(page, "way"), told(page, "way")) == ("core", "the core")
        assert "the page draws triangles alone" in page.get_attribute("#way", "title")
        # Scenes too large for the device are refused, too.
        told_of = """async ([url, most]) => (await import(url)).noRoom(
            { limits: { maxStorageBufferBindingSize: most, maxBufferSize: 2 ** 40 } },
            { nodes: 5e6, faces: 9e6 })"""
        module = viewer.url + "device.js"
        assert page.evaluate(told_of, [module, 9_000_000]) is None
        assert page.evaluate(told_of, [module, 8_999_999]).startswith("faces of the scene take 9 MiB")


def test_what_is_drawn_is_saved_and_has_an_end(page, box):
    with rw.view(*box, fit=False, seconds=0.2) as viewer:
        begin(page, viewer)
        wait(page, is_state("done"))
        spent, samples = page.evaluate("[viewer.drawing.spent, viewer.drawing.sample]")
        assert spent >= 0.2
        with page.expect_download() as download:
            page.click("#save")
        saved = np.asarray(Pillow.open(download.value.path()).convert("RGB"), float)
        assert np.array_equal(saved, picture(page))
        assert page.evaluate("viewer.drawing.sample") == samples
        viewer.close()
        wait(page, "document.getElementById('message').textContent.includes('has ended')")
        # A picture drawn here stays, and the camera can move.
        page.focus("#drawn")
        page.keyboard.press("ArrowRight")
        wait(page, "viewer.drawing.sample >= 1")
