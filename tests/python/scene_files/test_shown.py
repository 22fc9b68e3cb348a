"""How files are shown that say nothing of light, or of a camera: alike, whatever their kind."""

import numpy as np
import pytest
import trimesh
from command_line import run_command
from gltf_writer import Writer
from obj_files import SQUARE, picture, write

import raywright as rw
from raywright.scene_files.shown import own_radiance, shown

# The square from straight above.
EYE = {"type": "perspective", "perspective": {"yfov": 0.6, "aspectRatio": 1.5, "znear": 0.1}}


def gltf(tmp_path, emission=0.0, camera=None, lights=(), **node):
    writer = Writer()
    writer.node(mesh=writer.mesh({"emissiveFactor": [emission] * 3}), **node)
    if camera is not None:
        writer.node(camera=writer.add("cameras", EYE), **camera)
    for light in lights:
        writer.node(translation=[0, 0, 2], extensions=writer.light(**light))
    (tmp_path / "file.glb").write_bytes(writer.glb())
    return rw.load(tmp_path / "file.glb")


def leftward(near):
    """The way to the lamp of one who looks along -near."""
    right = np.cross((0, 1, 0), near)
    level = np.array(near) * np.cos(np.pi / 3) - right * np.sin(np.pi / 3)
    return level * np.cos(np.radians(55)) + np.array((0, np.sin(np.radians(55)), 0))


def test_the_same_mesh_looks_the_same_from_any_file(tmp_path):
    knot = trimesh.creation.torus(1.0, 0.4)
    # All its numbers have 32 bits and few digits, so that every kind of file stores them exactly.
    knot.vertices = np.round(knot.vertices * 256) / 256
    pictures = []
    for kind in ("obj", "ply", "stl", "glb", "off"):
        knot.export(tmp_path / f"knot.{kind}")
        shot = rw.load(tmp_path / f"knot.{kind}", width=40, height=30)
        mesh, floor, lamp = shot.scene.shapes
        assert np.array_equal(mesh.vertices[mesh.faces], knot.triangles)
        expected, camera = rw.scenes.studio(knot, width=40, height=30)
        assert (floor, lamp) == expected.shapes[1:]
        assert shot.scene.environment == expected.environment
        assert shot.camera == camera
        pictures.append(shot.render(samples=4, progress=False).rgb)
    assert all(np.array_equal(one, pictures[0]) for one in pictures)


def test_a_material_looks_the_same_from_blenders_obj_and_glb(tmp_path):
    head = "# Blender 4.2.0 MTL File: 'None'\n# www.blender.org\n\n"
    statements = "Ns 250\nKa 0.5 0.5 0.5\nKd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.5\nd 1.0\nillum 3"
    path = write(tmp_path, statements, geometry=SQUARE.replace("vt", "#"), faces="f 1 2 3 4\n", head=head)
    writer = Writer()
    model = {"baseColorFactor": [0.8, 0.4, 0.2, 1], "metallicFactor": 0.5, "roughnessFactor": 0.5}
    writer.node(mesh=writer.mesh({"pbrMetallicRoughness": model}))
    (tmp_path / "file.glb").write_bytes(writer.glb())
    one, other = (rw.load(one, width=24, height=18) for one in (path, tmp_path / "file.glb"))
    assert one.scene.shapes[0].material == other.scene.shapes[0].material
    assert np.array_equal(
        one.render(samples=4, progress=False).rgb, other.render(samples=4, progress=False).rgb
    )


def test_a_camera_of_the_file_stays_and_gets_the_studios_light(tmp_path):
    shot = gltf(tmp_path, camera={"translation": [0.5, 0.5, 3]})
    assert (shot.camera.position, shot.camera.width, shot.camera.height) == ((0.5, 0.5, 3), 720, 480)
    square, lamp = shot.scene.shapes
    studio, _ = rw.scenes.studio(square)
    assert shot.scene.environment == studio.environment
    assert lamp.emission == studio.shapes[-1].emission
    # 60 degrees to the left of the view along -z, 55 above, 5 times the radius of the mesh away.
    middle = lamp.vertices.mean(axis=0) - (0.5, 0.5, 0)
    assert np.allclose(middle, 5 * np.sqrt(0.5) * leftward((0, 0, 1)), rtol=0, atol=1e-12)
    # From the studio's own camera, it is the studio's lamp.
    _, own = rw.scenes.studio(square)
    assert np.allclose(shown([square], camera=own).scene.shapes[-1].vertices, studio.shapes[-1].vertices)


@pytest.mark.parametrize(
    ("way", "up", "near"),
    [
        ((1, 0, 0), (0, 1, 0), (1, 0, 0)),
        ((0, 1, 0), (0, 0, -1), (0, 0, 1)),
        ((0, -1, 0), (-1, 0, 0), (1, 0, 0)),
    ],
)
def test_the_lamp_goes_with_the_camera_and_out_of_its_picture(way, up, near):
    """As far as a camera that is far away, and to the left of one that looks straight down or up."""
    box = trimesh.creation.box()
    camera = rw.Camera(40 * np.array(way), (0, 0, 0), up, fov=70, width=90, height=60)
    scene = shown(box, camera=camera).scene
    assert np.allclose(scene.shapes[1].vertices.mean(axis=0), 40 * leftward(near), rtol=0, atol=1e-9)
    hits = scene.intersect(*camera.rays())
    # Rays that look up see it.
    assert set(np.unique(hits.shape_id)) == ({-1, 0} if way[1] >= 0 else {-1, 0, 1})


def test_what_has_light_of_its_own_is_shown_in_it(tmp_path):
    alone = {"environment": None, "shapes": 1}

    def held(shot):
        return {"environment": shot.scene.environment, "shapes": len(shot.scene.shapes)}

    assert held(gltf(tmp_path, lights=[{"type": "point", "intensity": 683.0}])) == alone
    assert held(gltf(tmp_path, emission=1.0)) == alone
    # Small lights on a device do not light it, unless the file has a camera.
    assert held(gltf(tmp_path, emission=0.01, camera={"translation": [0, 0, 4]})) == alone
    assert held(gltf(tmp_path, emission=0.01))["shapes"] == 3
    assert held(rw.load(write(tmp_path, "Ke 0.02 0.02 0.02"))) == alone
    assert held(rw.load(write(tmp_path, "Ke 0.019 0.019 0.019")))["shapes"] == 3
    shot = rw.load(write(tmp_path, "Kd 0 0 0\nKe 3 2 1"), width=32, height=24)
    mask = shot.scene.intersect(*shot.camera.rays()).hit
    image = shot.render(samples=1, integrator=rw.Path(max_depth=2), progress=False).rgb
    # Pixels entirely within it.
    inner = mask[1:-1, 1:-1] & mask[2:, 1:-1] & mask[:-2, 1:-1] & mask[1:-1, 2:] & mask[1:-1, :-2]
    assert inner.sum() > 20
    assert np.array_equal(image[1:-1, 1:-1][inner], np.broadcast_to(np.float32((3, 2, 1)), (inner.sum(), 3)))


def test_the_mean_of_what_is_given_off(tmp_path):
    """Over area: of a picture over all its points, and of copies with their sizes."""
    mesh = rw.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)], emission=(1.0, 2.0, 6.0))
    dark = rw.Mesh([(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 1, 2)])
    assert own_radiance([mesh]) == 3
    assert own_radiance([mesh, dark]) == 1
    twice = rw.Instance(mesh, [np.diag([2.0, 2, 2, 1]), np.diag([1.0, -1, 1, 1])])
    assert own_radiance([twice, dark]) == pytest.approx(3 * 2.5 / 3.5)
    pixels = picture(tmp_path, "half.png", [[255, 0], [188, 188]])
    gray = ((188 / 255 + 0.055) / 1.055) ** 2.4
    both = rw.Emission(rw.textures.ProductTexture(rw.ImageTexture(pixels), 4.0), both_sides=True)
    lit = rw.Mesh(mesh.vertices, mesh.faces, uv=np.zeros((3, 2)), emission=both)
    assert own_radiance([lit]) == pytest.approx(4 * (1 + 2 * gray) / 4)
    assert own_radiance([rw.Sphere((0, 0, 0), 1.0)]) == own_radiance([]) == 0


def test_size_and_the_way_up_may_be_told(tmp_path):
    path = write(tmp_path, "Kd 1 0 0")
    assert rw.load(path, "z", 20, 10) == rw.rendering.RenderSetup(*rw.scenes.studio(path, "z", 20, 10))
    camera = gltf(tmp_path, camera={"translation": [0, 0, 4]}).camera
    small = rw.load(tmp_path / "file.glb", width=72).camera
    assert (camera.width, camera.height, small.width, small.height) == (720, 480, 72, 48)
    # Pictures without a camera in the file have 4 by 3.
    write(tmp_path, "Kd 0 0 0")
    for size in ({"width": 72}, {"height": 54}, {"width": 72, "height": 54}):
        small = rw.load(tmp_path / "file.obj", **size).camera
        assert (small.width, small.height) == (72, 54)
    gltf(tmp_path)
    for one in (path, tmp_path / "file.glb"):
        with pytest.raises(ValueError, match=r"^width must be"):
            rw.load(one, width=0)
        with pytest.raises(TypeError, match=r"^height must be"):
            rw.load(one, height=1.5)


def test_the_shell_shows_a_lamp(tmp_path):
    write(tmp_path, "Kd 0 0 0\nKe 17 12 4\nfoo 1\nPc 1")
    done = run_command(
        "render", "file.obj", "-o", "a.npy", "--samples", 1, "--quiet", "--width", 64, cwd=tmp_path
    )
    told = "raywright: warning: file.mtl: what is not shown here is left out: foo of 'it', Pc of 'it'\n"
    assert (done.returncode, done.stdout, done.stderr) == (0, "", told)
    assert np.load(tmp_path / "a.npy").max(axis=(0, 1)).tolist() == [17, 12, 4]
    done = run_command("info", "file.obj", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, told)
    assert "faces        2" in done.stdout
