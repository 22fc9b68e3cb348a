"""Pictures of radiosity solutions: beside path tracing, wherever they are made."""

import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from radiosity_scenes import CUBE, room, square

import raywright as rw


@pytest.fixture(scope="module")
def box() -> tuple[rw.Scene, rw.Camera, rw.Radiosity]:
    scene, camera = rw.scenes.cornell_box(width=32, height=32)
    found = rw.radiosity(scene, "vertex", error=0.03, patch_size=110.0, progress=False)
    return scene, camera, rw.Radiosity(found)


def test_the_cornell_box_looks_as_paths_have_it(box: tuple[rw.Scene, rw.Camera, rw.Radiosity]) -> None:
    scene, camera, shown = box
    ours = rw.render(scene, camera, shown, 16, progress=False).rgb
    paths = rw.render(scene, camera, rw.Path(reuse=1, guiding="none"), 128, progress=False).rgb
    # Pixels that contain any part of the lamp are left out.
    lamp = paths.max(axis=2) > 0.4
    # Patches of a fifth of the room's width keep the mean of a picture to 2 %, and blocks of 8 by 8 pixels to
    # 10 % of it: shadows are blurred by a patch.
    mean = paths[~lamp].mean(axis=0)
    assert (abs(ours[~lamp].mean(axis=0) / mean - 1) < 0.02).all()
    blocks = np.where(lamp[..., None], 0, ours - paths).reshape(4, 8, 4, 8, 3).mean(axis=(1, 3))
    assert np.sqrt((blocks**2).mean()) < 0.1 * mean.mean()


def test_in_an_even_room_every_pixel_is_the_series() -> None:
    scene = room(0.6)
    found = rw.radiosity(scene, rays=2**17, progress=False, sides="front")
    camera = rw.Camera((0.5, 0.4, 0.3), (0.2, 0.9, 0.8), fov=90, width=16, height=16)
    picture = rw.render(scene, camera, rw.Radiosity(found), 4, progress=False)
    np.testing.assert_allclose(picture.rgb, 2.5 / np.pi, rtol=0.01)


def test_textures_are_those_of_the_scene_and_the_sky_is_behind() -> None:
    uv = [(0, 0), (1, 0), (1, 1), (0, 1)]
    checks = rw.Diffuse(rw.Checker(0.2, 0.8, transform=rw.textures.UvTransform(scale=4)))
    floor = rw.Mesh(CUBE[0], [(0, 1, 2), (0, 2, 3)], uv=uv, material=checks)
    scene = rw.Scene([floor], rw.DirectionalLight((0, 0, -1), 2.0), environment=0.0)
    found = rw.radiosity(scene, rays=4096, progress=False)
    above = rw.Camera((0.5, 0.5, 2), (0.5, 0.5, 0), up=(0, 1, 0), fov=35, width=40, height=40)
    picture = rw.render(scene, above, rw.Radiosity(found), 1, progress=False).rgb[..., 0]
    colors = np.unique(np.round(picture, 5))
    np.testing.assert_allclose(colors, [0, 0.4 / np.pi, 1.6 / np.pi], atol=2e-5)


def test_backs_are_black_where_fronts_alone_take_part() -> None:
    scene = rw.Scene([square(0, True, 0.5, 1.0)])
    camera = rw.Camera((0, 0, -2), (0, 0, 0), up=(0, 1, 0), width=4, height=4, fov=10)
    for sides in ("front", "both"):
        found = rw.radiosity(scene, rays=256, sides=sides, progress=False)
        assert not rw.render(scene, camera, rw.Radiosity(found), 1, progress=False).rgb.any()


def test_it_travels_and_goes_on(box: tuple[rw.Scene, rw.Camera, rw.Radiosity], tmp_path: Path) -> None:
    scene, camera, shown = box
    assert pickle.loads(pickle.dumps(shown)) == shown
    whole = rw.render(scene, camera, shown, 16, progress=False, threads=1)
    with ThreadPoolExecutor(2) as executor:
        there = rw.render(scene, camera, shown, 16, progress=False, executor=executor)
    assert np.array_equal(there.rgb, whole.rgb)
    how = {"progress": False, "checkpoint": tmp_path / "c", "sampler": whole.plan.sampler}
    rw.render(scene, camera, shown, 7, **how)
    assert np.array_equal(rw.render(scene, camera, shown, 16, **how).rgb, whole.rgb)


def test_a_solution_of_another_scene_is_refused(
    box: tuple[rw.Scene, rw.Camera, rw.Radiosity],
) -> None:
    _, camera, shown = box
    with pytest.raises(ValueError, match=r"of a scene with .* faces, this one has 12: solve again"):
        rw.render(room(), camera, shown, 1, progress=False)
    found = rw.radiosity(rw.Scene([square(0, True, 0.5, 1.0)]), rays=64, progress=False)
    larger = rw.Scene([square(0, True, 0.5, 1.0, size=2.0)])
    with pytest.raises(ValueError, match=r"of a scene with area 1\.0+, this one has 4"):
        rw.render(larger, camera, rw.Radiosity(found), 1, progress=False)
    with pytest.raises(TypeError, match=r"solution must be a result of raywright.radiosity"):
        rw.Radiosity(3)  # type: ignore[arg-type]
