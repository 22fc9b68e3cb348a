"""Files with all that it takes to make a picture, in Python and in the shell."""

import pickle

import numpy as np
import pytest
import trimesh
from command_line import run_command as shell

import raywright as rw
from raywright.scene_files.gltf import read_gltf

SCENE = """
<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="3"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="30"/>
        <transform name="to_world"><lookat origin="0, 0, 6" target="0, 0, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="8"/></film>
        <sampler type="independent">
            <integer name="sample_count" value="32"/><integer name="seed" value="5"/>
        </sampler>
    </sensor>
    <shape type="ply"><string name="filename" value="ball.ply"/></shape>
    <emitter type="constant"><rgb name="radiance" value="0.5"/></emitter>
</scene>
"""


@pytest.fixture
def path(tmp_path):
    ball = trimesh.creation.icosphere(subdivisions=1)
    (tmp_path / "ball.ply").write_bytes(ball.export(file_type="ply"))
    (tmp_path / "scene.xml").write_text(SCENE, encoding="utf-8")
    return tmp_path / "scene.xml"


def test_a_shot_renders_as_its_file_says_unless_told_otherwise(path):
    shot = rw.load(path)
    image = shot.render(progress=False)
    own = rw.render(
        shot.scene,
        shot.camera,
        rw.Path(max_depth=2),
        samples=32,
        seed=5,
        filter=rw.rendering.CroppedFilter(rw.rendering.GaussianFilter(2.0, 0.5)),
        progress=False,
    )
    assert np.array_equal(image.rgb, own.rgb)
    assert image.plan.sampler == own.plan.sampler == rw.rendering.Lattice(8)
    note = "the file's independent sampler is Mitsuba's default, and taken as not named"
    assert image.plan["sampler"].why == f"{own.plan['sampler'].why}; {note}"
    assert note in repr(image.plan)
    assert shot.render(samples=3, progress=False).samples == 3
    # An error or a time is a limit of its own, and the file's samples are not.
    assert shot.render(error=1e-3, progress=False).error.high <= 1e-3
    assert shot.render(samples=8, aov="depth", progress=False).aov["depth"].shape == (8, 12)
    with pytest.raises(TypeError, match="unexpected keyword argument 'sample'"):
        shot.render(sample=3)


def test_a_sampler_that_is_named_overrules_the_file(path, tmp_path):
    shot = rw.load(path, sampler=rw.rendering.Independent())
    image = shot.render(progress=False)
    assert (shot.sampler, image.plan["sampler"].why) == (rw.rendering.Independent(), "as named")
    again = rw.load(path).render(sampler=rw.rendering.Independent(), progress=False)
    assert np.array_equal(image.rgb, again.rgb)
    assert again.plan["sampler"].why == "as named"
    (tmp_path / "sobol.xml").write_text(SCENE.replace("independent", "ldsampler"), encoding="utf-8")
    assert rw.load(tmp_path / "sobol.xml").sampler == rw.rendering.Sobol()
    for file in (tmp_path / "sobol.xml", tmp_path / "ball.ply"):
        assert rw.load(file, sampler=rw.rendering.Halton()).sampler == rw.rendering.Halton()
    with pytest.raises(TypeError, match=r"^sampler must be one of raywright's, got str$"):
        rw.load(path, sampler="halton")


def test_shots_compare_and_pickle(path):
    shot = rw.load(path)
    assert shot == rw.load(str(path)) == pickle.loads(pickle.dumps(shot))
    assert shot != shot.resized(width=24)
    assert shot.scene.shapes[0].vertices.shape == (42, 3)


def test_shots_of_another_size_see_the_same():
    camera = rw.Camera(
        (0, 0, 5), (0, 0, 0), focal_length_px=(20, 30), principal_point=(4, 5), width=12, height=8
    )
    skewed = rw.Camera((0, 0, 5), (0, 0, 0), focal_length_px=(20, 30), skew=7, width=12, height=8)
    lens = rw.ThinLens((0, 0, 5), (0, 0, 0), aperture_radius=0.0, principal_point=(4, 5), width=12, height=8)
    for eye in (camera, rw.Camera((0, 0, 5), (0, 0, 0), width=12, height=8), skewed, lens):
        small = rw.rendering.RenderSetup(rw.Scene([]), eye)
        large = small.resized(width=36)
        assert (large.camera.width, large.camera.height) == (36, 24)
        assert small.resized(height=24) == large
        assert small.resized() is small
        # The middle of each pixel is the middle of one of the nine in its place.
        assert np.allclose(large.camera.rays()[1][1::3, 1::3], eye.rays()[1], rtol=0, atol=1e-14)


def test_a_mesh_is_framed_and_lit(path):
    shot = rw.load(path.parent / "ball.ply")
    scene, camera = rw.scenes.studio(path.parent / "ball.ply")
    assert shot == rw.rendering.RenderSetup(scene, camera)


def test_a_gltf_file_is_read_with_what_stands_in_it(tmp_path):
    path = tmp_path / "ball.glb"
    trimesh.creation.icosphere(subdivisions=1).export(path)
    assert rw.load(path) == read_gltf(path)


def test_the_shell_renders_and_describes_a_scene(path):
    folder = path.parent
    done = shell("render", "scene.xml", "-o", "a.npy", "--quiet", cwd=folder)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert np.array_equal(np.load(folder / "a.npy"), rw.load(path).render(progress=False).rgb)
    done = shell("render", "scene.xml", "-o", "b.npy", "--quiet", "--samples", 2, "--width", 24, cwd=folder)
    assert np.load(folder / "b.npy").shape == (16, 24, 3)
    done = shell("info", "scene.xml", cwd=folder)
    assert done.returncode == 0
    assert "vertices     42" in done.stdout
    path.write_text(SCENE.replace('type="ply"', 'type="teapot"'), encoding="utf-8")
    done = shell("render", "scene.xml", "-o", "c.npy", cwd=folder)
    assert done.returncode == 1
    assert done.stderr == "raywright: error: scene.xml: scene: teapot 'shape 3' is not supported here\n"


def test_up_is_one_of_two_axes():
    for path in ("mesh.ply", "scene.glb", "scene.xml"):
        with pytest.raises(ValueError, match="up must be one of 'y', 'z', got 'q'"):
            rw.load(path, up="q")
