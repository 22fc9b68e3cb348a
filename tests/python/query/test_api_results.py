"""Arrays of results belong to the caller: writing to them breaks nothing and reaches no one else."""

import dataclasses

import numpy as np
import pytest

import raywright as rw

MESH = rw.scenes.torus_knot(along=40, around=8)
SCENES = {
    "mesh": [MESH],
    "curved": [rw.Sphere((0, 0, 0), 1.5), MESH],
    "copies": [rw.Instance(MESH, np.eye(4)[None])],
}
ORIGINS = np.random.default_rng(0).normal(size=(40, 3)) * 3
WAYS = -ORIGINS + 0.3


def results(scene):
    """Return one of each result of points and rays, by name."""
    hits = scene.intersect(ORIGINS, WAYS)
    camera = rw.Camera((0, 0, 8), (0, 0, 0), width=8, height=6)
    return {
        "intersect": hits,
        "rows": hits[hits.hit],
        "one": hits[3],
        "first hits": scene.first_hits(camera),
        "all": scene.intersect_all(ORIGINS, WAYS),
        "first of all": scene.intersect_all(ORIGINS, WAYS).first,
        "closest": scene.closest_point(ORIGINS),
        "surface": hits.surface,
        "sight": rw.measure.line_of_sight(scene, ORIGINS, -ORIGINS),
        "sky": rw.measure.sky_view(scene, ORIGINS, (0, 1, 0), rays=16),
        "sun": rw.measure.solar_exposure(scene, ORIGINS, (0, 1, 0), sun=[(0, 1, 1)]),
        "lidar": rw.measure.lidar(
            scene, rw.measure.SpinningLidar(elevations=(-80.0, -60.0), columns=20, position=(0, 6, 0))
        ),
    }


def numbers(result):
    """Yield names and arrays of floats and bools of a result, what is worked out late too."""
    fields = [field.name for field in dataclasses.fields(result)]
    for name in (*fields, "hit", "found", "position", "normal"):
        array = getattr(result, name, None)
        if isinstance(array, np.ndarray) and array.dtype.kind in "fb":
            yield name, array


@pytest.mark.parametrize("kind", SCENES)
def test_floats_and_bools_can_be_written_to(kind):
    scene = rw.Scene(SCENES[kind])
    told = results(scene)
    again = results(scene)
    for of, result in told.items():
        found = dict(numbers(result))
        assert found, of
        for name, array in found.items():
            # torch.from_numpy warns of read-only arrays, and broadcast ones would change in several places.
            assert array.flags.writeable, (of, name)
            assert 0 not in array.strides or array.size <= 1, (of, name)
            array[...] = 1
    after = results(scene)
    for of, result in again.items():
        for (name, before), (_, now) in zip(numbers(result), numbers(after[of]), strict=True):
            np.testing.assert_array_equal(before, now, err_msg=f"{name} of {of}")


@pytest.mark.parametrize("kind", SCENES)
@pytest.mark.parametrize("value", [np.nan, -np.inf, 1e300, -3.0])
def test_numbers_that_were_changed_crash_nothing(kind, value):
    scene = rw.Scene(SCENES[kind])
    for points in (
        scene.intersect(ORIGINS, WAYS),
        scene.intersect_all(ORIGINS, WAYS),
        scene.closest_point(ORIGINS),
    ):
        for name in ("t", "distance", "uv", "position"):
            if name in vars(points):
                getattr(points, name)[...] = value
        lead = points.primitive_id.shape
        assert points.position.shape == points.normal.shape == points.surface.dp_du.shape == (*lead, 3)
        assert points.spawn_rays((0, 1, 0)).origins.shape == (*lead, 3)


def test_what_leads_back_into_the_scene_is_read_only():
    hits = rw.Scene(SCENES["copies"]).intersect(ORIGINS, WAYS)
    for name in ("shape_id", "primitive_id", "instance_id", "cell", "names"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(hits, name)[...] = 7
