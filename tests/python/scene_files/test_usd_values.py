"""USD stages: values that change a picture by a figure that is known."""

import re

import numpy as np
import pytest
from PIL import Image
from usd_files import CAMERA, HEAD, LAMP, SQUARE, load, paint, picture, shapes, write

import raywright as rw
from raywright.io import pictures

BALL = 'def Sphere "Ball" {\n    double radius = 1\n}\n'
RED = np.broadcast_to(np.array((200, 20, 10), np.uint8), (4, 4, 3))


@pytest.fixture(autouse=True)
def usd():
    pytest.importorskip("pxr")


def textured(folder, **more):
    """Write a package of a stage and its pictures, and return its path."""
    from pxr import UsdUtils

    Image.fromarray(RED).save(folder / "red.png")
    np.save(folder / "unused.npy", RED)
    text = SQUARE + paint(
        "color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>", picture("red.png", "")
    )
    stage = write(folder, CAMERA + LAMP + text + more.get("text", ""))
    packed = folder / "packed.usdz"
    assert UsdUtils.CreateNewUsdzPackage(str(stage), str(packed))
    (folder / "red.png").unlink()
    return packed


def test_pictures_in_a_package_are_read(tmp_path):
    sky = np.zeros((2, 4, 3), np.uint8)
    sky[0] = 255
    Image.fromarray(sky).save(tmp_path / "sky.png")
    given = "float inputs:intensity = 3\n    asset inputs:texture:file = @sky.png@"
    dome = f'def DomeLight "Sky" {{\n    {given}\n}}\n'
    scene = rw.load(textured(tmp_path, text=dome)).scene
    (square,) = scene.shapes
    assert np.array_equal(square.material.base_color.image, RED)
    assert scene.environment.image[:, :, 0].tolist() == [[3] * 4, [0] * 4]


def test_a_picture_that_is_damaged_is_told_by_its_name_in_the_package(tmp_path):
    import zipfile

    packed = textured(tmp_path)
    data = bytearray(packed.read_bytes())
    at = data.index(b"\x89PNG")
    data[at : at + 40] = bytes(40)
    packed.write_bytes(data)
    with pytest.raises(ValueError, match=r"packed\.usdz\[.*red\.png\] is not a picture that can be read"):
        rw.load(packed)
    assert zipfile.is_zipfile(packed)


def test_a_picture_is_decoded_once(tmp_path, monkeypatch):
    """Once a file, whatever number of prims, materials and inputs it is in."""
    Image.fromarray(RED).save(tmp_path / "red.png")
    count = []
    decode = pictures.decode
    monkeypatch.setattr(pictures, "decode", lambda *given: count.append(given) or decode(*given))
    inputs = """color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>
        color3f inputs:emissiveColor.connect = </Paint/P.outputs:rgb>
        float inputs:roughness.connect = </Paint/P.outputs:g>"""
    both = "float3 outputs:rgb\n        float outputs:g"
    first = paint(inputs, picture("red.png", "", both))
    text = (
        SQUARE
        + SQUARE.replace('"Square"', '"Second"')
        + SQUARE.replace('"Square"', '"Third"').replace("Paint", "Other")
    )
    found = shapes(tmp_path, text + first + first.replace("Paint", "Other"))
    assert len(found) == 3
    assert len(count) == 1
    looks = [one.material for one in found]
    assert looks[0].base_color is looks[1].base_color is looks[2].base_color
    assert looks[0].base_color is looks[0].base_color
    assert found[0].emission is looks[0].base_color


@pytest.mark.parametrize(
    ("head", "place"), [("", 1), ("    startTimeCode = 5\n", 9), ("    endTimeCode = 9\n", 1)]
)
def test_a_stage_is_shown_at_its_start_or_at_its_first_samples(tmp_path, head, place):
    """Values that have samples alone are those of the first, as is the place of what moves."""
    text = f"""
def Xform "Moving" {{
    double3 xformOp:translate.timeSamples = {{ 1: (1, 0, 0), 5: (9, 0, 0) }}
    uniform token[] xformOpOrder = ["xformOp:translate"]
    {
        SQUARE.replace(
            "points = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)]",
            "points.timeSamples = { 3: [(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)] }",
        )
    }
    def PointInstancer "P" {{
        rel prototypes = [</Moving/P/Ball>]
        int[] protoIndices.timeSamples = {{ 2: [0] }}
        point3f[] positions.timeSamples = {{ 2: [(0, 4, 0)] }}
        def Sphere "Ball" {{
            double radius.timeSamples = {{ 4: 0.25 }}
        }}
    }}
}}
"""
    lamp = LAMP.replace("float inputs:intensity = 2", "float inputs:intensity.timeSamples = { 1: 7 }")
    ink = paint("color3f inputs:diffuseColor.timeSamples = { 1: (0.5, 0.25, 0) }")
    scene = load(tmp_path, CAMERA + lamp + text + ink, HEAD.replace('"Z"\n', f'"Z"\n{head}')).scene
    square, copies = scene.shapes
    assert square.bounds.tolist() == [[place, 0, 0], [place + 2, 2, 0]]
    assert square.material.base_color == (0.5, 0.25, 0)
    assert copies.transform[0, :3, 3].tolist() == [place, 4, 0]
    assert copies.shapes[0].radius == 0.25
    assert scene.lights[0].irradiance == (7, 7, 7)


@pytest.mark.parametrize("kind", ["Sphere", "Cube", "Cylinder", "Cone"])
def test_shapes_have_the_colors_that_are_theirs(tmp_path, kind):
    own = f'def {kind} "S" {{\n    color3f[] primvars:displayColor = [(0.5, 0.25, 1)]\n}}\n'
    (shape,) = shapes(tmp_path, own)
    assert shape.material == rw.Diffuse((0.5, 0.25, 1))
    # A color of a group applies to all its members.
    group = f"""def Xform "Group" {{
    color3f[] primvars:displayColor = [(0.5, 0.25, 1)] (interpolation = "constant")
    float[] primvars:displayOpacity = [0.75] (interpolation = "constant")
    def {kind} "S" {{
    }}
    {SQUARE.replace("rel material:binding = </Paint>", "")}
}}
"""
    for shape in shapes(tmp_path, group):
        assert shape.material == rw.Mask(rw.Diffuse((0.5, 0.25, 1)), 0.75)
    reader = """
    def Shader "R" {
        uniform token info:id = "UsdPrimvarReader_float3"
        string inputs:varname = "displayColor"
        float3 outputs:result
    }
"""
    ink = paint("color3f inputs:diffuseColor.connect = </Paint/R.outputs:result>", reader)
    inked = own.replace(
        '"S" {', '"S" (prepend apiSchemas = ["MaterialBindingAPI"]) {\n    rel material:binding = </Paint>'
    )
    (shape,) = shapes(tmp_path, inked + ink)
    assert shape.material.base_color == (0.5, 0.25, 1)
    clear = own.replace(
        "color3f[] primvars:displayColor = [(0.5, 0.25, 1)]", "float[] primvars:displayOpacity = [0.5]"
    )
    (shape,) = shapes(tmp_path, clear)
    assert shape.material == rw.Mask(rw.Diffuse(0.5), 0.5)
    varied = own.replace("[(0.5, 0.25, 1)]", '[(0, 0, 0), (1, 1, 1)] (interpolation = "vertex")')
    with pytest.warns(RuntimeWarning, match=f"a displayColor that varies over a {kind} is taken as its mean"):
        (shape,) = shapes(tmp_path, varied)
    assert shape.material == rw.Diffuse(0.5)


def test_meshes_read_the_colors_that_their_material_names(tmp_path):
    reader = """
    def Shader "R" {
        uniform token info:id = "UsdPrimvarReader_float3"
        string inputs:varname = "tint"
        float3 inputs:fallback = (0, 0.5, 1)
        float3 outputs:result
    }
"""
    ink = paint("color3f inputs:diffuseColor.connect = </Paint/R.outputs:result>", reader)
    tint = (
        'color3f[] primvars:tint = [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 1, 1)] (interpolation = "vertex")\n'
    )
    (square,) = shapes(
        tmp_path, SQUARE.replace("    int[] faceVertexCounts", f"    {tint}    int[] faceVertexCounts") + ink
    )
    corner = np.argmin(square.vertices.sum(axis=1))
    assert square.colors[corner].tolist() == [1, 0, 0]
    (square,) = shapes(tmp_path, SQUARE + ink)
    assert (square.colors == (0, 0.5, 1)).all()


def covered(scene, count):
    """Return the share of each texel that is there, of 4 by 4 on a square from 0 to 2."""
    eye = rw.Orthographic((1, 1, 5), direction=(0, 0, -1), scale=2, width=4, height=4)
    lit = rw.Scene(scene.shapes, [], rw.ConstantEnvironment(1.0))
    return rw.render(lit, eye, samples=count, background="transparent", progress=False).alpha


def test_a_threshold_cuts_a_picture(tmp_path):
    """Below the threshold nothing is there, and elsewhere all of it."""
    alpha = np.full((4, 4), 255, np.uint8)
    alpha[:, :2] = 94
    alpha[0, 3] = 128
    Image.fromarray(np.dstack([RED, alpha])).save(tmp_path / "leaf.png")
    inputs = "float inputs:opacity.connect = </Paint/P.outputs:a>\n float inputs:opacityThreshold = 0.5"
    scene = load(tmp_path, CAMERA + SQUARE + paint(inputs, picture("leaf.png", "", "float outputs:a"))).scene
    share = covered(scene, 64)
    assert (share[1:, 0] == 0).all()
    assert (share[1:, 3] == 1).all()
    # Scale and bias come first.
    for text, left, right in (
        ("float4 inputs:scale = (1, 1, 1, 2)", 1, 1),
        ("float4 inputs:bias = (0, 0, 0, -0.6)", 0, 0),
    ):
        more = picture("leaf.png", text, "float outputs:a")
        share = covered(load(tmp_path, CAMERA + SQUARE + paint(inputs, more)).scene, 16)
        assert (share[2:, 0] == left).all()
        assert (share[:1, 3] == right).all()
    # The threshold applies to numbers as well.
    for given, kept in ((0.5, 1.0), (0.25, 0.0)):
        (square,) = shapes(
            tmp_path, SQUARE + paint(f"float inputs:opacity = {given}\n float inputs:opacityThreshold = 0.5")
        )
        assert getattr(square.material, "opacity", 1.0) == kept


def test_a_film_that_is_shifted_has_a_lens_too(tmp_path):
    shifted = CAMERA.replace(
        "}", "    float horizontalApertureOffset = 9\n    float verticalApertureOffset = -6\n}"
    )
    lens = shifted.replace("}", "    float fStop = 2\n    float focusDistance = 5\n}")
    pinhole = load(tmp_path, shifted + LAMP + SQUARE + paint("")).camera
    camera = load(tmp_path, lens + LAMP + SQUARE + paint("")).camera
    assert (camera.lens_radius, camera.focused_distance) == (pytest.approx(1.25), 5)
    # From -half + offset to half + offset, over the focal length.
    for one in (pinhole, camera):
        middle = one.principal_point
        assert middle == pytest.approx((720 * (0.5 - 9 / 36), 480 * (0.5 - 6 / 24)))
        if one is pinhole:
            corner = one.rays_through((0, 0))[1]
            assert corner / -corner[2] == pytest.approx(((-18 + 9) / 50, (12 - 6) / 50, -1), rel=1e-6)
    flat = shifted.replace("}", '    token projection = "orthographic"\n}')
    moved = load(tmp_path, flat + LAMP + SQUARE + paint("")).camera
    assert moved.position == pytest.approx((0.9, -0.6, 6))
    assert moved.scale == pytest.approx(2.4)


POINT = """
def SphereLight "L" {{
    double3 xformOp:translate = (1, 2, 3)
    uniform token[] xformOpOrder = ["xformOp:translate"]
{}
}}
"""


def lamp(folder, text):
    return load(folder, CAMERA + SQUARE + paint("") + POINT.format(text)).scene.lights[0]


def test_spheres_that_are_points(tmp_path):
    """From afar a sphere of radiance L and radius r has an intensity of L π r²."""
    shine = "    float inputs:intensity = 8\n    float inputs:radius = {}\n"
    far = lamp(tmp_path, shine.format(0.5) + "    bool treatAsPoint = 1")
    assert far == rw.PointLight((1, 2, 3), 8 * np.pi * 0.25)
    # A normalized light has the same power at any radius: L / (4 π r²) · π r².
    for size in ("0.5", "0"):
        text = shine.format(size) + "    bool treatAsPoint = 1\n    bool inputs:normalize = 1"
        assert lamp(tmp_path, text).intensity == pytest.approx((2, 2, 2))
    with pytest.warns(RuntimeWarning, match="SphereLights without a radius are taken as normalized"):
        assert lamp(tmp_path, shine.format(0)).intensity == pytest.approx((2, 2, 2))
    cone = "float inputs:shaping:cone:angle = 30\nfloat inputs:shaping:cone:softness = 0.25\n"
    cone += "bool treatAsPoint = 1"
    spot = lamp(tmp_path, shine.format(0.5) + cone)
    assert (spot.position, spot.target, spot.angle, spot.falloff) == ((1, 2, 3), (1, 2, 2), 30, 7.5)


def test_lights_have_the_color_of_their_temperature(tmp_path):
    """At 6,500 K it is nearly that of daylight, which is white, and at 2,000 K it is red; both as bright."""
    text = "bool treatAsPoint = 1\nbool inputs:normalize = 1\nbool inputs:enableColorTemperature = 1\n"
    white = lamp(tmp_path, text + "    float inputs:colorTemperature = 6500").intensity
    assert white == pytest.approx((0.25,) * 3, rel=0.06)
    red, green, blue = lamp(tmp_path, text + "    float inputs:colorTemperature = 2000").intensity
    assert red > 2 * green > 20 * blue
    assert np.dot((red, green, blue), (0.2126, 0.7152, 0.0722)) == pytest.approx(0.25, rel=1e-3)


def test_meshes_are_lights(tmp_path):
    shine = "float inputs:intensity = 3\n    color3f inputs:color = (1, 0.5, 0)"
    api = SQUARE.replace('["MaterialBindingAPI"]', '["MaterialBindingAPI", "MeshLightAPI"]')
    text = api.replace("    int[] faceVertexCounts", f"    {shine}\n    int[] faceVertexCounts")

    def lit(text, ink=""):
        (mesh,) = load(tmp_path, CAMERA + text + (ink or paint(""))).scene.shapes
        return mesh

    assert lit(text).emission == (3, 1.5, 0)
    assert lit(text).material == rw.MetallicRough((0.18,) * 3, 0.0, 0.5)
    # Over its area in the world, which is 4.
    assert lit(text.replace("float inputs:i", "bool inputs:normalize = 1\n    float inputs:i")).emission == (
        0.75,
        0.375,
        0,
    )
    # The emission of the material tints the light, unless the two are independent.
    glow = paint("color3f inputs:emissiveColor = (1, 0.5, 1)")
    assert lit(text, glow).emission == (3, 0.75, 0)
    for mode, wanted in (
        ("independent", rw.MetallicRough((0.18,) * 3, 0.0, 0.5)),
        ("noMaterialResponse", rw.Diffuse(0.0)),
    ):
        mesh = lit(
            text.replace(
                "float inputs:i", f'uniform token light:materialSyncMode = "{mode}"\n    float inputs:i'
            ),
            glow,
        )
        assert (mesh.emission, mesh.material) == ((3, 1.5, 0), wanted)


@pytest.mark.parametrize(
    ("text", "factor"),
    [("float exposure = 2", 4), ("float exposure:iso = 500", 5), ("float exposure:time = 0.5", 0.5)],
)
def test_the_exposure_of_a_camera_counts(tmp_path, text, factor):
    from pxr import UsdGeom

    if not hasattr(UsdGeom.Camera, "ComputeLinearExposureScale") and ":" in text:
        pytest.skip("of newer stages")
    sky = 'def DomeLight "Sky" {\n    float inputs:intensity = 0.5\n}\n'
    ball = 'def SphereLight "L" {\n    float inputs:intensity = 3\n}\n'
    glow = paint("color3f inputs:emissiveColor = (3, 2, 1)")
    scene = load(tmp_path, CAMERA.replace("}", f"    {text}\n}}") + LAMP + sky + ball + SQUARE + glow).scene
    assert scene.lights[0].irradiance == pytest.approx((2 * factor,) * 3)
    assert scene.environment.radiance == pytest.approx((0.5 * factor,) * 3)
    lamp, square = scene.shapes
    assert lamp.emission == pytest.approx((3 * factor,) * 3)
    assert square.emission == pytest.approx((3 * factor, 2 * factor, factor))


@pytest.mark.parametrize(
    ("kind", "axis", "middle", "top"),
    [
        ("DomeLight", "", (0, 0, 1), (0, 1, 0)),
        ("DomeLight_1", "", (0, -1, 0), (0, 0, 1)),
        ("DomeLight_1", "Z", (0, -1, 0), (0, 0, 1)),
        ("DomeLight_1", "Y", (0, 0, 1), (0, 1, 0)),
    ],
)
def test_a_dome_has_the_pole_that_it_names(tmp_path, kind, axis, middle, top):
    """By its default that of DomeLight_1 is the stage's up, and that of DomeLight is y."""
    np.save(tmp_path / "sky.npy", np.ones((2, 4, 3), np.float32))
    pole = f'    uniform token poleAxis = "{axis}"\n' if axis else ""
    sky = f'def {kind} "Sky" {{\n    asset inputs:texture:file = @sky.npy@\n{pole}}}\n'
    around = load(tmp_path, CAMERA + BALL + sky).scene.environment
    assert (around.to_world @ (0, 0, -1)).tolist() == list(middle)
    assert (around.to_world @ (0, 1, 0)).tolist() == list(top)


def test_instancers_hide_what_they_say(tmp_path):
    text = """
def PointInstancer "P" {
    rel prototypes = [</P/A>, </P/Inner>]
    int[] protoIndices = [0, 0, 0, 1]
    point3f[] positions = [(1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 0)]
    int64[] ids = [7, 8, 9, 10]
    int64[] invisibleIds = [8]
    def Xform "A" {
        def Sphere "Ball" {
            double radius = 0.25
        }
        def Sphere "Hidden" {
            token visibility = "invisible"
        }
        def Cube "Guide" {
            uniform token purpose = "guide"
        }
    }
    def PointInstancer "Inner" {
        rel prototypes = [</P/Inner/B>]
        int[] protoIndices = [0, 0]
        point3f[] positions = [(0, 1, 0), (0, 2, 0)]
        def Sphere "B" {
            double radius = 0.125
        }
    }
}
"""
    first, second = shapes(tmp_path, text)
    assert first.transform[:, :3, 3].tolist() == [[1, 0, 0], [3, 0, 0]]
    assert [one.radius for one in first.shapes] == [0.25]
    (inner,) = second.shapes
    assert inner.transform[:, :3, 3].tolist() == [[0, 1, 0], [0, 2, 0]]
    assert second.transform[0, :3, 3].tolist() == [4, 0, 0]
    inactive = text.replace("    int64[] invisibleIds = [8]\n", "").replace(
        '"P" {\n    rel', '"P" (\n    inactiveIds = [7]\n) {\n    rel'
    )
    first, _ = shapes(tmp_path, inactive)
    assert first.transform[:, :3, 3].tolist() == [[2, 0, 0], [3, 0, 0]]


def test_polygons_keep_their_area_and_holes_are_none(tmp_path):
    arrow = SQUARE.replace(
        "(0, 0, 0), (2, 0, 0), (2, 1, 0), (0, 1, 0)", "(0, 0, 0), (4, 0.5, 0), (0, 1, 0), (1.5, 0.5, 0)"
    )
    (mesh,) = shapes(tmp_path, arrow + paint(""))
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    assert np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2 == pytest.approx(2.5, rel=1e-12)
    two = SQUARE.replace("[4]", "[3, 3]").replace(
        "[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]\n    int[] holeIndices = [1]"
    )
    two = two.replace("[(0, 0), (1, 0), (1, 1), (0, 1)]", "[(0, 0), (1, 0), (1, 1), (0, 0), (1, 1), (0, 1)]")
    (mesh,) = shapes(tmp_path, two + paint(""))
    assert len(mesh.faces) == 1
    with pytest.raises(ValueError, match="/Square has holes that are not there: number 2 of 2"):
        shapes(tmp_path, two.replace("holeIndices = [1]", "holeIndices = [2]") + paint(""))


def test_textures_beyond_their_range_are_cut(tmp_path):
    Image.fromarray(np.full((2, 2), 153, np.uint8)).save(tmp_path / "p.png")
    bright = picture("p.png", "float4 inputs:scale = (2, 2, 2, 2)\n float4 inputs:bias = (-0.1, 0, -2, 0)")
    (square,) = shapes(
        tmp_path, SQUARE + paint("color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>", bright)
    )
    # A one-channel picture is not sRGB by default.
    assert square.material.base_color.image[0, 0] == pytest.approx((1, 1, 0))
    deep = (np.full((2, 2, 3), 0.6) * 65535).astype(np.uint16)
    raw = "color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>"
    np.save(tmp_path / "deep.npy", deep)
    (square,) = shapes(tmp_path, SQUARE + paint(raw, picture("deep.npy", "")))
    assert square.material.base_color.image[0, 0] == pytest.approx((0.6,) * 3, abs=1e-5)


def test_inputs_of_a_material_are_those_of_its_shader(tmp_path):
    """An input may be connected to one of the material, which has the value or is connected on."""
    Image.fromarray(RED).save(tmp_path / "red.png")
    more = picture("", "").replace(
        "asset inputs:file = @@", "asset inputs:file.connect = </Paint.inputs:picture>"
    )
    ink = paint(
        """color3f inputs:diffuseColor.connect = </Paint/P.outputs:rgb>
        float inputs:roughness.connect = </Paint.inputs:rough>""",
        more + "    float inputs:rough = 0.25\n    asset inputs:picture = @red.png@\n",
    )
    (square,) = shapes(tmp_path, SQUARE + ink)
    assert np.array_equal(square.material.base_color.image, RED)
    assert square.material.roughness == 0.25


def test_normal_maps_are_scaled(tmp_path):
    """A normal is what is stored times the scale plus the bias, and 2 and -1 if neither is given."""
    normal = np.array((0.6, -0.48, 0.64))
    link = "normal3f inputs:normal.connect = </Paint/P.outputs:rgb>"

    def stored(values, inputs, name="n.png"):
        if name.endswith(".png"):
            Image.fromarray(np.full((2, 2, 3), np.round(255 * np.array(values)), np.uint8)).save(
                tmp_path / name
            )
        else:
            np.save(tmp_path / name, np.full((2, 2, 3), values, np.float32))
        (square,) = shapes(tmp_path, SQUARE + paint(link, picture(name, inputs)))
        texture = square.material.normals
        return 2 * texture.image[0, 0].astype(float) / (255 if texture.image.dtype == np.uint8 else 1) - 1

    halved = 0.5 + 0.5 * normal
    assert stored(halved, "") == pytest.approx(normal, abs=5e-3)
    usual = "float4 inputs:scale = (2, 2, 2, 1)\nfloat4 inputs:bias = (-1, -1, -1, 0)"
    assert stored(halved, usual) == pytest.approx(normal, abs=5e-3)
    turned = "float4 inputs:scale = (2, -2, 1, 1)\nfloat4 inputs:bias = (-1, 1, 0, 0)"
    assert stored((halved[0], 1 - halved[1], normal[2]), turned) == pytest.approx(normal, abs=5e-3)
    assert stored(normal, "", "n.npy") == pytest.approx(normal, abs=1e-6)
    assert stored(halved, usual, "n.npy") == pytest.approx(normal, abs=1e-6)


def test_a_texture_without_coordinates_of_its_own_is_one_point_of_its_picture(tmp_path):
    pixels = np.arange(48, dtype=np.uint8).reshape(4, 4, 3)
    Image.fromarray(pixels).save(tmp_path / "p.png")
    for given, texel in (("", (3, 0)), ("float2 inputs:st = (0.9, 0.6)", (1, 3))):
        more = re.sub(
            "float2 inputs:st.connect = .*", given, picture("p.png", 'token inputs:sourceColorSpace = "raw"')
        )
        ink = paint("color3f inputs:emissiveColor.connect = </Paint/P.outputs:rgb>", more)
        scene = load(tmp_path, CAMERA + SQUARE + ink).scene
        eye = rw.Camera((1, 1, 5), direction=(0, 0, -1), width=2, height=2, fov=5)
        seen = rw.render(scene, eye, rw.Path(0), samples=1, progress=False).rgb
        # Near the middle of a texel or at the corner, beyond which the picture repeats.
        assert seen[0, 0] == pytest.approx(pixels[texel] / 255, abs=0.03)
        assert np.ptp(seen, axis=(0, 1)).max() < 1e-6
