"""USD stages: what is not shown as it is written, and what a warning or an error says of it."""

import re
import warnings

import numpy as np
import pytest
from PIL import Image
from usd_files import CAMERA, LAMP, SQUARE, load, paint, picture, shapes

import raywright as rw

BALL = 'def Sphere "Ball" {\n    double radius = 1\n}\n'


RED = np.broadcast_to(np.array((200, 20, 10), np.uint8), (4, 4, 3))


@pytest.fixture(autouse=True)
def usd():
    pytest.importorskip("pxr")


def test_a_picture_that_is_missing_is_its_fallback(tmp_path):
    ink = """color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>
        float inputs:roughness.connect = </Paint/P.outputs:a>"""
    both = "float3 outputs:rgb\n        float outputs:a"
    fallback = "float4 inputs:fallback = (0.5, 0.25, 0.125, 0.75)"
    with pytest.warns(RuntimeWarning, match=r"there is no picture gone\.png: its fallback is shown"):
        (square,) = shapes(tmp_path, SQUARE + paint(ink, picture("gone.png", fallback, both)))
    assert square.material == rw.MetallicRough((0.5, 0.25, 0.125), 0.0, 0.75)
    with pytest.raises(FileNotFoundError, match=r"gone\.png"):
        shapes(tmp_path, SQUARE + paint(ink, picture("gone.png", "", both)))
    none = picture("gone.png", "", both).replace("asset inputs:file = @gone.png@", "")
    with pytest.warns(RuntimeWarning, match="textures without a file are shown by their fallback"):
        (square,) = shapes(tmp_path, SQUARE + paint(ink, none))
    assert square.material == rw.MetallicRough(0.0, 0.0, 1.0)


@pytest.mark.parametrize(
    ("text", "wanted", "told"),
    [
        (
            "float inputs:roughness = 1.05",
            rw.MetallicRough(0.18, 0.0, 1.0),
            "a roughness of 1.05 is taken as 1",
        ),
        (
            "float inputs:metallic = -0.5",
            rw.MetallicRough(0.18, 0.0, 0.5),
            "a metallic of -0.5 is taken as 0",
        ),
        (
            "color3f inputs:diffuseColor = (1.5, 0, 0.5)",
            rw.MetallicRough((1, 0, 0.5), 0.0, 0.5),
            r"a diffuseColor of \(1.5, 0, 0.5\) is taken as \(1, 0, 0.5\)",
        ),
        ("float inputs:opacity = 1.25", rw.MetallicRough(0.18, 0.0, 0.5), "a opacity of 1.25 is taken as 1"),
    ],
)
def test_numbers_beyond_their_range_are_cut_and_told(tmp_path, text, wanted, told):
    with pytest.warns(RuntimeWarning, match=told.replace("a opacity", "an? opacity")):
        (square,) = shapes(tmp_path, SQUARE + paint(text))
    assert square.material == wanted


def test_textures_that_have_no_coordinates_are_told(tmp_path):
    Image.fromarray(RED).save(tmp_path / "red.png")
    ink = paint("color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>", picture("red.png", ""))
    bare = SQUARE.replace("primvars:st", "primvars:other")
    with pytest.warns(
        RuntimeWarning, match="textures on meshes without the coordinates 'st' are placed by others"
    ):
        shapes(tmp_path, bare + ink)
    ball = BALL.replace('"Ball" {', '"Ball" (prepend apiSchemas = ["MaterialBindingAPI"]) {')
    ball = ball.replace("double radius", "rel material:binding = </Paint>\n    double radius")
    with pytest.warns(RuntimeWarning, match="textures on a Sphere are placed by coordinates of its own"):
        shapes(tmp_path, ball + ink)


LINKED = """def DistantLight "Sun" (prepend apiSchemas = ["CollectionAPI:lightLink"]) {
    bool inputs:normalize = 1
    uniform bool collection:lightLink:includeRoot = 0
    rel collection:lightLink:includes = </Square>
}
"""


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (LINKED, "links of lights are left out: each light shines on everything"),
        (
            LAMP.replace("}", "    float inputs:specular = 0\n}"),
            "the diffuse and specular multipliers of lights are left",
        ),
        (
            LAMP.replace('"Sun" {', '"Sun" (prepend apiSchemas = ["ShadowAPI"]) {').replace(
                "}", "    bool inputs:shadow:enable = 0\n}"
            ),
            "lights without shadows cast shadows here",
        ),
        (
            LAMP.replace("}", "    float inputs:shaping:focus = 2\n}"),
            "the focus and the IES profiles of lights are left out",
        ),
        ('def PortalLight "P" {\n}\n' + LAMP, "lights of type PortalLight are left out"),
        (
            SQUARE.replace('"Square"', '"Skin"').replace(
                "    int[] faceVertexCounts",
                "    int[] primvars:skel:jointIndices = [0, 0, 0, 0]\n    int[] faceVertexCounts",
            ),
            "skeletons and blend shapes are left out: meshes are shown unposed",
        ),
        (paint("float inputs:clearcoat = 1").replace("Paint", "Coat"), None),
        (
            SQUARE.replace('"Square"', '"C"').replace("/Paint", "/Coat")
            + paint("float inputs:clearcoat = 1").replace("Paint", "Coat"),
            "the clearcoat",
        ),
        (
            SQUARE.replace('"Square"', '"C"').replace("/Paint", "/Coat")
            + paint("float inputs:occlusion = 0.5").replace("Paint", "Coat"),
            "the occlusion",
        ),
        (
            SQUARE.replace('"Square"', '"C"').replace("/Paint", "/Coat")
            + paint("float inputs:ior = 1.25").replace("Paint", "Coat"),
            "the ior of opaque",
        ),
        (CAMERA.replace("Eye", "Other"), "the first of its 2 cameras is taken"),
        ('def Skeleton "Bones" {\n}\n', "skeletons and blend shapes are left out"),
        ('def RenderSettings "R" {\n}\n', "render settings are left out"),
        ('def BasisCurves "Hair" {\n}\n', "shapes of type BasisCurves are left out"),
    ],
)
def test_what_is_left_out_is_told(tmp_path, text, told):
    stage = CAMERA + SQUARE + paint("") + text
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load(tmp_path, stage)
    lines = [str(one.message) for one in caught]
    wanted = [] if told is None else [f"{tmp_path / 'stage.usda'}: {told}"]
    assert [line[: len(want)] for line, want in zip(lines, wanted, strict=True)] == wanted


def test_what_hides_all_there_is_is_named(tmp_path):
    text = """
def Sphere "Hidden" {
    token visibility = "invisible"
}
def Sphere "Guide" {
    uniform token purpose = "guide"
}
def Sphere "Proxy" {
    uniform token purpose = "proxy"
}
def Xform "Also" {
    token visibility = "invisible"
}
def BasisCurves "Hair" {
}
"""
    told = (
        "it has nothing visible: 2 prims are invisible; 1 prim is of purpose guide; "
        "1 prim is of purpose proxy; shapes of type BasisCurves are left out"
    )
    with pytest.raises(ValueError, match=re.escape(told)):
        load(tmp_path, CAMERA + text)


def test_what_there_is_instead_of_shapes_is_named(tmp_path):
    with pytest.raises(
        ValueError, match=r"nothing visible: its prims are 1 of Camera, 1 of Material, 1 of Sha"
    ):
        load(tmp_path, CAMERA + paint(""))
    with pytest.raises(ValueError, match="nothing visible: it has no prims"):
        load(tmp_path, "")


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("int normals = 3", "/Square: normals has type int, expected normal3f[]"),
        ('string normals = "up"', "/Square: normals has type string, expected normal3f[]"),
        ("float[] normals = [1, 2]", "/Square: normals has type float[], expected normal3f[]"),
        ("float[] primvars:st = [1, 2, 3]", "/Square: st must be rows of 2 numbers, got shape (3,)"),
    ],
)
def test_values_of_other_types_are_told(tmp_path, given, told):
    text = re.sub(".*primvars:st.*", "", SQUARE) + paint("")
    with pytest.raises(ValueError, match=re.escape(told)):
        shapes(
            tmp_path, text.replace("    int[] faceVertexCounts", f"    {given}\n    int[] faceVertexCounts")
        )


def test_what_usd_prints_is_told_in_one_line(tmp_path, capfd):
    """A file of broken references makes USD print some lines for each."""
    text = "".join(f'def Xform "A{k}" (\n    references = </None{k}>\n) {{\n}}\n' for k in range(9))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        load(tmp_path, CAMERA + LAMP + BALL + text)
    assert capfd.readouterr().err == ""
    lines = [str(one.message) for one in caught]
    assert lines
    assert all(line.startswith(str(tmp_path)) and "\n" not in line for line in lines)
    assert len(lines) == 1
    assert "</None" in lines[0]
    assert lines[0].endswith(", and 8 more of the kind")
