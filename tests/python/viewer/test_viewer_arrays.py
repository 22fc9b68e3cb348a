"""What a page is told to draw a scene by itself, and what it may ask."""

import json

import numpy as np
import pytest
from viewer_page import ask, page, turn

import raywright as rw
from raywright.gpu.packing import known_lit, packed
from raywright.viewer import server
from raywright.viewer.lamps import behind, lamp
from raywright.viewer.orbit import View
from raywright.viewer.paint import paints
from raywright.viewer.requests import scene_told
from raywright.viewer.texts import text

SIZE = {"width": 96, "height": 72}
JSON = {"Content_Type": "application/json"}


def asked(viewer, what, given):
    status, _, body = ask(viewer, what, "POST", json.dumps(given), **JSON)
    return status, json.loads(body) if status == 200 else body.decode().strip()


def test_arrays_are_those_of_the_scene_and_have_a_version():
    mesh = rw.scenes.torus_knot(along=40, around=8)
    scene = rw.Scene(mesh, environment=1.0)
    with rw.view(scene, rw.Camera((0, 0, 6), (0, 0, 0), **SIZE)) as viewer:
        status, told = asked(viewer, "drawing", {})
        assert (status, told["why"], told["left"]) == (200, None, None)
        flat = scene.gpu_arrays()
        path = f"arrays/{told['version']}/"
        for name, wanted in (("nodes", flat.nodes), ("triangles", flat.triangles)):
            status, headers, body = ask(viewer, path + name)
            assert (status, body) == (200, wanted.tobytes())
            assert len(body) == told["arrays"][name]
            assert "immutable" in headers["Cache-Control"]
        assert (told["nodes"], told["depth"], told["scale"]) == (flat.own, flat.depth, flat.scale)
        assert told["center"] == flat.center.tolist()
        for missing in (
            path + "none",
            path,
            "arrays/",
            f"arrays/{told['version']}9/nodes",
            "boxes/",
            "boxes/-1",
        ):
            assert ask(viewer, missing)[0] == 404
        # A moved scene is another one.
        scene.refit(1.5 * mesh.vertices)
        status, after = asked(viewer, "drawing", {})
        assert after["version"] != told["version"]
        assert ask(viewer, path + "nodes")[0] == 404
        assert ask(viewer, f"arrays/{after['version']}/nodes")[2] == scene.gpu_arrays().nodes.tobytes()
        assert not viewer.rendering


@pytest.mark.parametrize(
    ("scene", "camera", "why"),
    [
        (rw.Scene(rw.Sphere((0, 0, 0), 1.0)), rw.Camera((0, 0, 4), (0, 0, 0)), "triangles alone"),
        (rw.Scene([]), rw.Camera((0, 0, 4), (0, 0, 0)), "is empty"),
        (rw.Scene(rw.scenes.torus_knot()), rw.Fisheye((0, 0, 4), (0, 0, 0)), "no pictures of a Fisheye"),
        (
            rw.Scene(rw.scenes.torus_knot()),
            rw.Camera((0, 0, 4), (0, 0, 0), end_pose=rw.Pose((0, 1, 4), (0, 0, 0))),
            "its shutter is open",
        ),
    ],
)
def test_what_a_page_cannot_draw_is_told_in_a_line(scene, camera, why):
    with rw.view(scene, camera) as viewer:
        status, told = asked(viewer, "drawing", {})
        assert (status, set(told)) == (200, {"why"})
        assert why in told["why"]


@pytest.mark.parametrize(
    ("changes", "left"),
    [
        ({"integrator": rw.Whitted()}, "the page has no Whitted"),
        ({"clamp": 10.0}, "does not clamp"),
        ({"filter": rw.rendering.GaussianFilter()}, "the page has no filters"),
        ({"camera": rw.ThinLens((278, 273, -800), (278, 273, 0), f_stop=0.01)}, "the page has no lenses"),
    ],
)
def test_what_the_core_renders_once_the_camera_stands_is_told(changes, left):
    scene, camera = rw.scenes.cornell_box(**SIZE)
    with rw.view(scene, **({"camera": camera} | changes)) as viewer:
        told = asked(viewer, "drawing", {})[1]
        assert (told["why"], told["traced"]) == (None, None)
        assert left in told["left"]


def test_masks_are_drawn_whole_and_rendered_by_the_core():
    leaf = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], material=rw.Mask(rw.Diffuse(), 0.5))
    with rw.view(rw.Scene(leaf, environment=1.0)) as viewer:
        told = asked(viewer, "drawing", {})[1]
        assert (told["why"], told["left"], told["traced"]) == (None, "the page has no masks", None)


def test_copies_are_drawn_as_shapes_of_their_own():
    knot = rw.scenes.torus_knot(along=40, around=8)
    places = np.eye(4) + np.zeros((3, 1, 1))
    places[:, 0, 3] = (-5, 0, 5)
    camera = rw.Camera((0, 0, 20), (0, 0, 0), **SIZE)
    scene = rw.Scene([rw.Instance(knot, places)], environment=1.0)
    with rw.view(scene, camera) as viewer:
        told = asked(viewer, "drawing", {})[1]
        assert (told["why"], told["left"]) == (None, None)
        assert told["arrays"]["faces"] == 112 * 3 * len(knot.faces)
        # The core knows the visible copy.
        found = asked(viewer, "pick", {"view": {}, "x": 0.52, "y": 0.4})[1]
        hit = scene.pick(camera, 49, 28, (0.92, 0.8))
        assert found["shape"] in (0, None)
        assert (found["shape"] == 0) == bool(hit.hit)
    moving = rw.Instance(knot, np.eye(4), transform_end=np.diag([2.0, 2.0, 2.0, 1.0]))
    with rw.view(rw.Scene([moving], environment=1.0), camera) as viewer:
        assert "nothing that moves" in asked(viewer, "drawing", {})[1]["why"]


def test_limits_of_paths_are_those_of_the_render():
    path = rw.Path(max_depth=3, roulette_depth=2)
    with rw.view(*rw.scenes.cornell_box(**SIZE), path, samples=7, error=0.1, seed=5) as viewer:
        limits = asked(viewer, "drawing", {})[1]["traced"]
        wanted = {"depth": 3, "roulette": 2, "seed": 5, "samples": 7, "seconds": None, "error": 0.1}
        assert limits == wanted
        viewer.show(rw.Whitted())
        assert asked(viewer, "drawing", {})[1]["traced"] is None


def test_boxes_are_the_corners_of_a_level_in_box_units():
    scene, camera = rw.scenes.cornell_box(**SIZE)
    flat, level = scene.gpu_arrays(), scene.tree_boxes().at(1)
    with rw.view(scene, camera) as viewer:
        status, _, body = ask(viewer, "boxes/1")
        found = np.frombuffer(body, "<f4").reshape(-1, 8, 3)
        wanted = (level.corners - flat.center) * flat.scale
        assert (status, len(found)) == (200, len(level))
        key = lambda boxes: boxes[np.lexsort(np.round(boxes.reshape(len(boxes), -1), 5).T)]  # noqa: E731
        assert np.allclose(key(found), key(wanted), rtol=0, atol=1e-6)
        assert ask(viewer, "boxes/999")[::2] == (200, b"")


def test_a_pick_is_that_of_the_scene():
    scene, camera = rw.scenes.cornell_box(**SIZE)
    with rw.view(scene, camera) as viewer:
        status, found = asked(viewer, "pick", {"view": {}, "x": 40.25 / 96, "y": 50.5 / 72})
        hit = scene.pick(camera, 40, 50, (0.25, 0.5))
        assert status == 200
        assert (found["shape"], found["face"], found["t"]) == (hit.shape_id, hit.primitive_id, hit.t)
        assert (found["position"], found["name"]) == (hit.position.tolist(), str(hit.names) or None)
        away = asked(viewer, "pick", {"view": {"right": 100}, "x": 0.5, "y": 0.5})
        assert away == (200, {"shape": None})
        for given, line in (
            ({"view": {}, "x": 1, "y": 0}, "x and y must be at least 0 and less than 1"),
            ({"view": {}, "x": "0", "y": 0}, "x must be"),
            ({"view": {"zoom": 0}, "x": 0, "y": 0}, "zoom must be"),
            ({"x": 0, "y": 0}, "a pick must be an object with view and x and y"),
        ):
            status, told = asked(viewer, "pick", given)
            assert status == 400
            assert line in told
        assert asked(viewer, "camera", {})[1] == {"line": repr(camera).replace("Camera(", "rw.Camera(")}


def test_who_draws_by_itself_hears_of_the_camera_and_nothing_is_rendered():
    with rw.view(*rw.scenes.cornell_box(**SIZE)) as viewer, page(viewer, "news") as news:
        name, scene = next(news)
        assert (name, scene["view"]["azimuth"]) == ("scene", 0)
        turn(viewer, azimuth=20)
        name, view = next(news)
        assert (name, view["azimuth"]) == ("view", 20)
        viewer.show(rw.Whitted())
        assert next(news)[0] == "again"
        assert not viewer.rendering
        viewer.close()
        assert not [name for name, _ in news if name != "view"]


def test_what_changes_while_the_scene_is_told_is_news(monkeypatch):
    def tell(session):
        told = scene_told(session)
        session.turn(View(azimuth=20))
        session.show(rw.Whitted())
        return told

    with rw.view(*rw.scenes.cornell_box(**SIZE), samples=1) as viewer:
        for path in ("news", "events"):
            monkeypatch.setattr(server, "scene_told", tell)
            with page(viewer, path) as heard:
                assert next(heard)[0] == "scene"
                monkeypatch.setattr(server, "scene_told", scene_told)
                assert next(heard)[0] == "again"
                assert next(told for name, told in heard if name in ("view", "frame"))


def test_colors_and_normals_of_a_sketch():
    mesh = rw.scenes.torus_knot(along=40, around=8, material=rw.Diffuse((0.8, 0.4, 0.2)))
    two = rw.TwoSided(rw.Diffuse(0.25), rw.Mirror())
    lamp_ = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], material=two, emission=1.0)
    scene = rw.Scene([mesh, lamp_])
    flat = scene.gpu_arrays()
    rows = paints(scene.shapes, flat)
    assert rows[0, 0] == 204 + 102 * 2**8 + 51 * 2**16
    assert rows[-1, 0] == 64 * 0x010101 + 0xFF000000
    # Unfolded as in sight.wgsl.
    e = rows[:, 1:].copy().view("<i2") / 32767
    z = 1 - np.abs(e).sum(axis=1)
    folded = (1 - np.abs(e[:, ::-1])) * np.where(e >= 0, 1, -1)
    normals = np.concatenate([np.where(z[:, None] >= 0, e, folded), z[:, None]], axis=1)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    corners = mesh.vertices[mesh.faces]
    wanted = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    wanted /= np.linalg.norm(wanted, axis=1, keepdims=True)
    assert np.allclose(normals[: len(wanted)], wanted, rtol=0, atol=1e-4)


def test_the_lamp_of_a_sketch():
    knot = rw.scenes.torus_knot()
    camera = rw.Camera((0, 0, 6), (0, 0, 0))
    for scene, place, far in (
        (rw.Scene(knot, rw.DirectionalLight((0, -1, 0), 1.0)), (0, 1, 0), True),
        (rw.Scene(knot, rw.PointLight((1, 2, 3), 1.0)), (1, 2, 3), False),
        (rw.Scene(knot, environment=rw.SunSky((0, 1, 1))), (0, 1, 1), True),
        (rw.scenes.cornell_box()[0], (278, 548.8, 279.5), False),
        (rw.Scene(knot), (0.5, 0.8, 1), True),
    ):
        told = lamp(scene, camera)
        assert told["far"] is far
        parallel = np.cross(told["place"], place) if far else np.subtract(told["place"], place)
        assert np.allclose(parallel, 0, rtol=0, atol=0.2)


def test_shaders_are_what_other_browsers_take_too():
    # Firefox parses WGSL like wgpu, and unlike chromium.
    try:
        device = rw.Gpu()._device
    except (ImportError, RuntimeError) as missing:
        pytest.skip(str(missing))
    beginning = text("walk.wgsl").replace("STACK", "32u") + text("sight.wgsl")
    brought = text("brought.wgsl")
    lit = packed(rw.Scene(rw.scenes.torus_knot()), rw.Scene(rw.scenes.torus_knot()).gpu_arrays()).lit
    paths = known_lit(lit) + text("shading.wgsl") + brought + text("path.wgsl")
    for rest in (brought + text("screen.wgsl"), text("lines.wgsl"), paths):
        device.create_shader_module(code=beginning + rest)
    device.create_shader_module(code=brought + text("error.wgsl"))


def test_what_surrounds_a_sketch():
    knot = rw.scenes.torus_knot()
    image = np.zeros((4, 8, 3), np.float32)
    image[0, 0] = (32, 16, 8)
    around = [rw.ConstantEnvironment((1, 0, 0.5)), rw.EnvironmentMap(image, scale=2.0)]
    for environment, wanted in ((None, (0, 0, 0)), (0.5, (0.5, 0.5, 0.5)), (around, (3, 1, 1))):
        assert behind(rw.Scene(knot, environment=environment)) == list(wanted)


def test_a_scene_alone_is_framed_and_lit():
    with rw.view(rw.Scene(rw.scenes.torus_knot()), samples=1) as viewer:
        assert isinstance(viewer.camera, rw.Camera)
        told = asked(viewer, "drawing", {})[1]
        # The knot, and an added lamp.
        assert told["lamp"]["far"] is False
        assert asked(viewer, "pick", {"view": {}, "x": 0.999, "y": 0.999})[1] == {"shape": None}
    with rw.view(rw.scenes.cornell_box()[0], samples=1) as viewer:
        assert asked(viewer, "drawing", {})[1]["lamp"]["place"] == [278.0, 548.8, 279.5]
    with pytest.raises(TypeError, match="scene must be"):
        rw.view("scene")
