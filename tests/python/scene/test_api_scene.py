"""Scenes: what they take, keep and compile."""

import copy
import inspect
import pickle
import sys
import warnings
from contextlib import nullcontext

import numpy as np
import pytest

import raywright as rw

DOWN = (0.0, 0.0, -1.0)


def test_nested_lists_are_laid_out_flat(box, triangle):
    scene = rw.Scene([triangle, (box, [triangle]), []])
    assert scene.shapes == (triangle, box, triangle)
    assert scene.intersect((0.5, 0.4, 5), DOWN).shape_id == 1


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        (None, None),
        (2, rw.ConstantEnvironment(2)),
        ((1, 2, 3), rw.ConstantEnvironment((1, 2, 3))),
        (rw.ConstantEnvironment(4), rw.ConstantEnvironment(4)),
    ],
)
def test_environment_may_be_numbers(given, kept):
    assert rw.Scene([], environment=given).environment == kept


def test_one_light_need_not_be_in_a_list():
    light = rw.PointLight((0, 0, 0), 1)
    assert rw.Scene([], lights=light).lights == rw.Scene([], lights=[light]).lights == (light,)


@pytest.mark.parametrize("precision", ["auto", "single", "double"])
@pytest.mark.parametrize("quality", ["low", "medium", "high"])
def test_precision_and_quality_are_kept_and_hits_do_not_depend_on_quality(precision, quality):
    knot = rw.scenes.torus_knot(along=40, around=6)
    scene = rw.Scene(knot, precision=precision, quality=quality)
    assert (scene.precision, scene.quality) == (precision, quality)
    back = pickle.loads(pickle.dumps(scene))
    assert back == scene
    assert hash(back) == hash(scene)
    plain = rw.Scene(knot, precision=precision)
    assert (scene == plain) == (quality == "medium")
    assert (f"precision='{precision}'" in repr(scene)) == (precision != "auto")
    assert (f"quality='{quality}'" in repr(scene)) == (quality != "medium")
    rays = np.random.default_rng(4).normal(size=(2, 500, 3))
    assert scene.intersect(*rays) == plain.intersect(*rays)
    # The vertices have digits beyond float32.
    assert ("double" in scene.accelerator_info.kind) == (precision != "single")


@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BVH(bins=4), rw.BruteForce()])
def test_accelerator_is_the_one_chosen(box, accelerator):
    scene = rw.Scene(box, accelerator=accelerator)
    assert scene.accelerator == accelerator
    assert isinstance(scene.accelerator_info, rw.accelerators.AcceleratorInfo)
    assert scene.accelerator_info.primitives == 12
    assert scene.accelerator_info.build_seconds >= 0
    assert ("BVH" in scene.accelerator_info.kind) == isinstance(accelerator, rw.BVH)


def test_accelerators_agree():
    knot = rw.scenes.torus_knot(along=40, around=6)
    origins, directions = np.random.default_rng(3).normal(size=(2, 500, 3))
    hits = [rw.Scene(knot, accelerator=a).intersect(origins, directions) for a in (rw.BVH(), rw.BruteForce())]
    assert hits[0].hit.any()
    assert hits[0] == hits[1]


def test_ties_go_to_the_first_shape_and_face(triangle):
    twice = rw.Mesh(triangle.vertices, [(0, 1, 2), (0, 1, 2)])
    hit = rw.Scene([twice, triangle]).intersect((0.2, 0.3, 1), DOWN)
    assert (hit.shape_id, hit.primitive_id) == (0, 0)


@pytest.mark.parametrize("shapes", [[], rw.Mesh([], []), [rw.Mesh(np.zeros((4, 3)), [])]])
@pytest.mark.parametrize("accelerator", [rw.BVH(), rw.BruteForce()])
def test_empty_scenes_are_missed_by_every_ray(shapes, accelerator):
    scene = rw.Scene(shapes, accelerator=accelerator)
    assert scene.bounds is None
    hits = scene.intersect(np.zeros((4, 3)), DOWN)
    assert not hits.hit.any()
    assert np.isnan(hits.position).all()
    assert not scene.occluded((0, 0, 0), DOWN)


def test_bounds_hold_all_shapes(box, triangle):
    far = rw.Mesh(triangle.vertices + 4, triangle.faces)
    assert np.array_equal(rw.Scene([box, far]).bounds, [(0, 0, 0), (5, 5, 4)])


def test_faces_with_nan_are_dropped_with_one_warning(box):
    vertices = box.vertices.copy()
    vertices[7] = np.nan
    touching = int((box.faces == 7).any(axis=1).sum())
    scene = rw.Scene([rw.Mesh(vertices, box.faces), box.transformed(np.diag([1, 1, 1, 1.0]))])
    message = rf"^{touching} of 24 faces were dropped: a corner is NaN or infinite$"
    with pytest.warns(RuntimeWarning, match=message) as caught:
        hits = scene.intersect((0.4, 0.5, 5), DOWN)
    assert caught[0].filename == __file__
    assert hits.t == 4
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene.intersect((0.4, 0.5, 5), DOWN)
        assert np.array_equal(scene.bounds, [(0, 0, 0), (1, 1, 1)])


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_faces_that_stay_keep_their_numbers(triangle, bad):
    vertices = np.concatenate([np.full((1, 3), bad), triangle.vertices])
    scene = rw.Scene(rw.Mesh(vertices, [(0, 1, 2), (1, 2, 3)]))
    with pytest.warns(RuntimeWarning, match="1 of 2 faces"):
        assert scene.intersect((0.2, 0.3, 1), DOWN).primitive_id == 1


def test_scene_is_compiled_once_and_only_when_asked(box, monkeypatch):
    made = []
    compile_ = rw._core.CompiledScene
    monkeypatch.setattr(rw._core, "CompiledScene", lambda *a: made.append(1) or compile_(*a))
    scene = rw.Scene(box)
    assert not made
    scene.intersect((0, 0, 5), DOWN)
    scene.occluded((0, 0, 5), DOWN)
    assert scene.bounds is not None
    assert scene.accelerator_info.primitives == 12
    assert len(made) == 1


def test_pickle_leaves_the_compiled_scene_behind(box):
    scene = rw.Scene([box] * 2, rw.PointLight((0, 0, 0), 1), 0.5, rw.BVH(bins=7))
    fresh = pickle.dumps(scene)
    scene.intersect((0, 0, 5), DOWN)
    assert pickle.dumps(scene) == fresh
    back = pickle.loads(fresh)
    assert back == scene
    assert hash(back) == hash(scene)
    assert back.intersect((0.5, 0.4, 5), DOWN).t == 4


def test_equality_is_by_content(box, triangle):
    assert rw.Scene(box) == rw.Scene([box])
    assert rw.Scene(box) != rw.Scene(triangle)
    assert rw.Scene(box) != rw.Scene(box, environment=1)
    assert rw.Scene(box) != rw.Scene(box, rw.PointLight((0, 0, 0), 1))
    assert rw.Scene(box) != rw.Scene(box, accelerator=rw.BruteForce())
    assert rw.Scene(box) != box


def test_repr_is_one_short_line(box):
    scene = rw.Scene(box, rw.PointLight((0, 0, 0), 1), accelerator=rw.BruteForce())
    assert repr(scene) == "Scene(1 shape, 12 faces, 1 light, BruteForce())"


@pytest.mark.parametrize("name", ["shapes", "lights", "environment", "accelerator", "bounds"])
def test_scenes_do_not_change(scene, name):
    with pytest.raises(AttributeError):
        setattr(scene, name, ())


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: rw.Scene(5), TypeError, r"shapes must be a Mesh, .*, got builtins\.int"),
        (lambda: rw.Scene(None), TypeError, r"shapes must be a Mesh, .*, got builtins\.NoneType"),
        (lambda: rw.Scene([np.zeros((3, 3))]), TypeError, r"shapes must be a Mesh, .*, got numpy\.ndarray"),
        (lambda: rw.Scene([], lights=3), TypeError, r"lights must be raywright lights, got int"),
        (lambda: rw.Scene([], lights=[3]), TypeError, r"lights must be raywright lights, got int"),
        (lambda: rw.Scene([], environment="sky"), TypeError, r"radiance must be real numbers, got 'sky'"),
        (lambda: rw.Scene([], environment=-1), ValueError, r"radiance must be at least 0, got -1"),
        (
            lambda: rw.Scene([], accelerator="bvh"),
            TypeError,
            r"accelerator must be one of BVH, .*, got str",
        ),
        (
            lambda: rw.Scene([], accelerator=rw.BVH),
            TypeError,
            r"accelerator must be one of BVH, .*, got type",
        ),
    ],
)
def test_bad_scenes_are_refused_in_one_line(call, error, message):
    with pytest.raises(error, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)


def test_a_changed_copy_has_the_rest_of_its_scene(box, triangle):
    scene = rw.Scene(
        [box],
        rw.PointLight((0, 0, 5), 1),
        2.0,
        accelerator=rw.accelerators.KdTree(leaf_size=3),
        precision="double",
        quality="low",
    )
    scene.intersect((0.5, 0.4, 5), DOWN)
    changes = {
        "shapes": (box, triangle),
        "lights": (),
        "environment": rw.ConstantEnvironment(3),
        "accelerator": rw.BVH(),
        "precision": "single",
        "quality": "medium",
    }
    kept = {
        "shapes": scene.shapes,
        "lights": scene.lights,
        "environment": scene.environment,
        "accelerator": scene.accelerator,
        "precision": scene.precision,
        "quality": scene.quality,
    }
    before = pickle.dumps(scene)
    for name, value in changes.items():
        changed = scene.replace(**{name: value})
        assert changed == rw.Scene(**{**kept, name: value})
        assert changed != scene
    assert scene.replace() == scene
    assert scene.replace(**changes) == rw.Scene(**changes)
    assert scene.replace(environment=None).environment is None
    # It is another scene with its own rays, and the first one is unchanged.
    other = scene.replace(shapes=[triangle])
    assert other.intersect((0.5, 0.4, 5), DOWN) == rw.Scene(triangle).intersect((0.5, 0.4, 5), DOWN)
    assert pickle.dumps(scene) == before


def test_other_light_falls_on_the_same_accelerator(box):
    scene = rw.Scene([box, rw.Sphere((2, 0, 0), 0.5)])
    # An unbuilt scene has no tree to refit.
    assert "refitted" not in scene.replace(environment=1.0).accelerator_info.kind
    scene.build(progress=False)
    lamp = rw.PointLight((0, 0, 4), 1.0)
    lit = scene.replace(environment=1.0).replace(lights=lamp)
    scene.refit([box.vertices + 9.0, None])
    assert "refitted" in lit.accelerator_info.kind
    assert "refitted" not in scene.replace(quality="low").accelerator_info.kind
    new = rw.Scene(lit.shapes, lights=lamp, environment=1.0)
    assert lit == new
    camera = rw.Camera((0.5, 0.7, 4), (0.5, 0.5, 0.5), width=12, height=9)
    pictures = [rw.render(one, camera, samples=4, progress=False).rgb for one in (lit, new)]
    assert np.array_equal(*pictures)
    assert pictures[0].max() > 0


def test_copy_replace_makes_one_too(box):
    scene = rw.Scene(box)
    # copy.replace calls this method, from Python 3.13 on.
    assert type(scene).__replace__(scene, environment=1.0) == rw.Scene(box, environment=1.0)
    if sys.version_info >= (3, 13):
        assert copy.replace(scene, environment=1.0) == rw.Scene(box, environment=1.0)


@pytest.mark.parametrize(
    ("changes", "error", "message"),
    [
        ({"enviroment": 1}, TypeError, r"^a Scene has no 'enviroment' to replace; it has shapes, lights, "),
        (
            {"accelerator_info": rw.BVH()},
            TypeError,
            r"^a Scene has no 'accelerator_info' to replace; it has",
        ),
        ({"lights": 3}, TypeError, r"^lights must be raywright lights, got int$"),
        (
            {"precision": "half"},
            ValueError,
            r"^precision must be one of 'auto', 'single', 'double', got 'half'$",
        ),
    ],
)
def test_a_wrong_change_is_told(box, changes, error, message):
    with pytest.raises(error, match=message):
        rw.Scene(box).replace(**changes)


def test_a_device_takes_the_scene_by_the_method_that_gpus_have():
    class Device:
        def upload(self, scene):
            return nullcontext((self, scene))

    assert inspect.isfunction(rw.Gpu.upload)
    scene, device = rw.Scene([]), Device()
    with scene.on_device(device) as held:
        assert held == (device, scene)
    for wrong in (3, Device, rw.Gpu):
        with pytest.raises(TypeError, match="device must be a Gpu, got "):
            scene.on_device(wrong)
