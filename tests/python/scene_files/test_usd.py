"""USD stages: meshes, preview surfaces, cameras and lights, by usd-core where it is installed."""

import re
import sys

import numpy as np
import pytest
from PIL import Image
from usd_files import CAMERA, HEAD, LAMP, SQUARE, load, paint, shapes

import raywright as rw

COPIES = """
def PointInstancer "P" {{
    rel prototypes = [</P/S>]
    int[] protoIndices = {which}
    point3f[] positions = {places}
    def Sphere "S" {{
    }}
}}
"""


@pytest.fixture(autouse=True)
def usd():
    pytest.importorskip("pxr")


def test_meshes_stand_where_they_are(tmp_path):
    (square,) = shapes(tmp_path, SQUARE + paint("color3f inputs:diffuseColor = (0.5, 0.25, 0)"))
    assert square.name == "Square"
    assert square.bounds.tolist() == [[0, 0, 0], [2, 2, 0]]
    assert len(square.faces) == 2
    assert np.allclose(square.uv, square.vertices[:, :2] / 2, rtol=0, atol=1e-12)
    assert square.material == rw.MetallicRough((0.5, 0.25, 0), 0.0, 0.5)
    hit = rw.Scene(square).intersect([(0.5, 0.5, 1.0)], [(0.0, 0.0, -1.0)])
    assert hit.normal[0].tolist() == [0, 0, 1]


def test_faces_have_materials_of_their_own(tmp_path):
    parts = SQUARE.replace("[4]", "[3, 3]").replace("[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]")
    parts = parts.replace(
        "[(0, 0), (1, 0), (1, 1), (0, 1)]", "[(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]"
    )
    other = paint("color3f inputs:diffuseColor = (1, 1, 1)").replace("Paint", "Other")
    subset = """
    def GeomSubset "Part" (prepend apiSchemas = ["MaterialBindingAPI"]) {
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </Other>
    }
}
"""
    at = parts.rindex("}")
    found = shapes(tmp_path, parts[:at] + subset + paint("color3f inputs:diffuseColor = (0, 0, 0)") + other)
    assert [mesh.material.base_color for mesh in found] == [(0, 0, 0), (1, 1, 1)]
    assert [len(mesh.faces) for mesh in found] == [1, 1]


def test_pictures_are_on_surfaces(tmp_path):
    pixels = np.random.default_rng(0).integers(0, 255, (4, 4, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "p.png")
    reader = """
    def Shader "P" {
        uniform token info:id = "UsdUVTexture"
        asset inputs:file = @p.png@
        token inputs:wrapS = "clamp"
        token inputs:wrapT = "repeat"
        float2 inputs:st.connect = </Paint/R.outputs:result>
        float3 outputs:rgb
        float outputs:g
    }
    def Shader "R" {
        uniform token info:id = "UsdPrimvarReader_float2"
        string inputs:varname = "st"
        float2 outputs:result
    }
"""
    inputs = """color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>
        float inputs:roughness.connect = </Paint/P.outputs:g>"""
    (square,) = shapes(tmp_path, SQUARE + paint(inputs, reader))
    color, rough = square.material.base_color, square.material.roughness
    assert np.array_equal(color.image, pixels)
    assert (color.wrap, color.linear) == (("clamp", "repeat"), False)
    # Scalar textures are not sRGB.
    assert (rough.channel, rough.linear) == ("g", True)


def test_surfaces_shine_and_are_clear(tmp_path):
    (lamp,) = shapes(tmp_path, SQUARE + paint("color3f inputs:emissiveColor = (3, 2, 1)"))
    assert lamp.emission == (3, 2, 1)
    (glass,) = shapes(tmp_path, SQUARE + paint("float inputs:opacity = 0\n float inputs:ior = 1.25"))
    assert glass.material == rw.Dielectric(1.25, 0.5)
    (lace,) = shapes(
        tmp_path, SQUARE + paint('float inputs:opacity = 0.25\n token inputs:opacityMode = "presence"')
    )
    assert isinstance(lace.material, rw.Mask)
    assert lace.material.opacity == 0.25


def test_cameras_see_what_theirs_do(tmp_path):
    shot = load(tmp_path, CAMERA + LAMP + SQUARE + paint(""))
    assert (shot.camera.width, shot.camera.height) == (720, 480)
    assert np.tan(np.radians(shot.camera.fov / 2)) == pytest.approx(12 / 50, rel=1e-6)
    assert shot.camera.forward.tolist() == [0, 0, -1]
    lens = CAMERA.replace("}", "    float fStop = 2\n    float focusDistance = 5\n}")
    camera = load(tmp_path, lens + LAMP + SQUARE + paint("")).camera
    # Focal lengths are in tenths of a unit: 5 units over twice the stop.
    assert (camera.lens_radius, camera.focused_distance) == (pytest.approx(1.25), 5)
    assert load(tmp_path, CAMERA + LAMP + SQUARE + paint(""), width=72).camera.height == 48


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ('def SphereLight "L" {\n float inputs:radius = 2\n %s\n}', rw.Sphere),
        ('def DiskLight "L" {\n float inputs:radius = 2\n %s\n}', rw.Disk),
        ('def RectLight "L" {\n float inputs:width = 2\n float inputs:height = 3\n %s\n}', rw.Mesh),
    ],
)
def test_lamps_have_their_radiance(tmp_path, text, kind):
    shine = "float inputs:intensity = 3\n float inputs:exposure = 1\n color3f inputs:color = (1, 0.5, 0)"
    lamp = load(tmp_path, CAMERA + SQUARE + paint("") + text % shine).scene.shapes[-1]
    assert isinstance(lamp, kind)
    assert lamp.emission == (6, 3, 0)
    areas = {rw.Sphere: 16 * np.pi, rw.Disk: 4 * np.pi, rw.Mesh: 6}
    spread = load(tmp_path, CAMERA + SQUARE + paint("") + text % (shine + "\n bool inputs:normalize = 1"))
    assert spread.scene.shapes[-1].emission == pytest.approx(np.array((6, 3, 0)) / areas[kind])
    if kind is not rw.Sphere:
        # Lights emit along -z.
        normal = rw.Scene(lamp).intersect([(0.1, 0.1, -5.0)], [(0.0, 0.0, 1.0)]).normal[0]
        assert normal.tolist() == pytest.approx([0, 0, -1])


def test_the_sun_and_the_sky(tmp_path):
    sky = 'def DomeLight "Sky" {\n float inputs:intensity = 0.5\n}\n'
    scene = load(tmp_path, CAMERA + LAMP + sky + SQUARE + paint("")).scene
    assert scene.lights == (rw.DirectionalLight((0, 0, -1), 2.0),)
    assert scene.environment == rw.ConstantEnvironment(0.5)
    wide = LAMP.replace("bool inputs:normalize = 1", "float inputs:angle = 90")
    # An unnormalized light has the radiance of a disk of this angle, in degrees.
    with pytest.warns(RuntimeWarning, match="the angle of DistantLights is left out of their shadows"):
        sun = load(tmp_path, CAMERA + wide + SQUARE + paint("")).scene.lights[0]
    # The radiance times π, and the square of the sine of half the angle.
    assert sun.irradiance[0] == pytest.approx(2 * np.pi / 2)
    image = np.zeros((4, 8, 3), np.float32)
    image[1, 2] = 1.0
    np.save(tmp_path / "sky.npy", image)
    pictured = sky.replace("0.5", "2\n asset inputs:texture:file = @sky.npy@")
    around = load(tmp_path, CAMERA + pictured + SQUARE + paint("")).scene.environment
    assert np.array_equal(around.image, 2 * image)
    # The middle of the picture is along +z.
    assert (around.to_world @ (0, 0, -1)).tolist() == [0, 0, 1]


def test_copies_and_simple_shapes(tmp_path):
    text = """
def PointInstancer "Many" {
    int[] protoIndices = [0, 0]
    point3f[] positions = [(1, 0, 0), (0, 2, 0)]
    rel prototypes = </Many/Ball>
    def Sphere "Ball" {
        double radius = 0.25
    }
}
def Cube "Box" {
    double size = 2
}
def Cylinder "Tube" {
    double height = 4
    double radius = 0.5
    uniform token axis = "X"
}
def Sphere "Hidden" {
    token visibility = "invisible"
}
"""
    copies, box, tube = shapes(tmp_path, text)
    assert np.allclose(copies.transform[:, :3, 3], [(1, 0, 0), (0, 2, 0)], rtol=0, atol=1e-12)
    assert copies.shapes[0].radius == 0.25
    assert box.bounds.tolist() == pytest.approx(np.array([[-1] * 3, [1] * 3]))
    assert tube.bounds.tolist() == pytest.approx(np.array([[-2, -0.5, -0.5], [2, 0.5, 0.5]]))


def test_what_is_left_out_is_told(tmp_path):
    text = SQUARE.replace('subdivisionScheme = "none"', 'subdivisionScheme = "catmullClark"')
    with pytest.warns(RuntimeWarning, match=r"stage\.usda: subdivision is not applied to meshes"):
        shapes(tmp_path, text + paint(""))


def test_what_is_no_stage_is_refused(tmp_path):
    path = tmp_path / "stage.usda"
    path.write_text("no stage")
    with pytest.raises(ValueError, match=r"stage\.usda is not a USD file that can be read") as caught:
        rw.load(path)
    assert "\n" not in str(caught.value)
    with pytest.raises(ValueError, match="it has nothing visible"):
        load(tmp_path, CAMERA)
    broken = SQUARE.replace("[0, 1, 2, 3]", "[0, 1, 2, 9]")
    with pytest.raises(ValueError, match="/Square has face counts or indices that do not match its points"):
        load(tmp_path, broken + paint(""))
    with pytest.raises(TypeError, match="spp is not a parameter"):
        rw.load(path, spp=3)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('def Sphere "Ball" {\n    double radius = -1\n}', "/Ball: radius must be greater than 0, got -1"),
        ('def Cylinder "Rod" {\n    token axis = "Q"\n}', "/Rod: axis must be one of 'X', 'Y', 'Z', got 'Q'"),
        (
            'def DistantLight "Lamp" {\n    float inputs:intensity = -1\n}',
            "/Lamp: irradiance must be at least",
        ),
        (SQUARE + paint("float inputs:roughness = nan"), "/Square: roughness must be finite, got nan"),
        (
            SQUARE.replace("[4]", "[-2, 6]").replace("[0, 1, 2, 3]", "[0, 1, 2, 3]") + paint(""),
            "/Square has face counts or indices that do not match its points",
        ),
        (
            SQUARE.rstrip().removesuffix("}")
            + 'def GeomSubset "Half" {\n    int[] indices = [-1]\n'
            + '    uniform token familyName = "materialBind"\n}\n}'
            + paint(""),
            "/Square/Half has faces that are not there: number -1 of 1",
        ),
        (COPIES.format(which="[0, 1]", places="[(0, 0, 0), (1, 0, 0)]"), "number 1 of 1"),
        (
            COPIES.format(which="[0]", places="[(0, 0, 0), (1, 0, 0)]"),
            "/P: it has 1 protoIndices, but 2 positions",
        ),
    ],
)
def test_what_is_wrong_is_told_with_its_prim(tmp_path, text, told):
    with pytest.raises(ValueError, match=re.escape(told)) as caught:
        load(tmp_path, 'def Sphere "S" {\n}\n' + text)
    assert "\n" not in str(caught.value)


def test_a_missing_reference_is_told_and_a_mesh_without_points_is_none(tmp_path):
    ball = 'def Sphere "S" {\n}\n'
    with pytest.raises(FileNotFoundError, match=r"gone\.usda"):
        load(tmp_path, ball + 'def Xform "A" (\n    references = @gone.usda@\n) {\n}\n')
    with pytest.warns(RuntimeWarning, match="it is not composed as specified: Cycle detected"):
        load(tmp_path, ball + 'def Xform "A" (\n    references = </A>\n) {\n}\n')
    assert len(shapes(tmp_path, ball + 'def Mesh "Empty" {\n}\n')) == 1


def test_without_the_library_it_is_named(tmp_path, monkeypatch):
    (tmp_path / "a.usda").write_text(HEAD)
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(ImportError, match=r"reading USD needs usd-core: pip install 'raywright\[usd\]'"):
        rw.load(tmp_path / "a.usda")
