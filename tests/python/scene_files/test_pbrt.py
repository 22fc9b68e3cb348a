"""Files of pbrt-v4: what stands in them, seen as pbrt sees it, and what is refused with its line."""

import re

import numpy as np
import pytest
from pbrt_files import HEAD, load, material
from PIL import Image

import raywright as rw
from raywright.scene_files.pbrt.lights import folded, unfolded


def seen(shot, point):
    """Where a point is in the picture, from -1 on its left and at its bottom to 1."""
    camera = shot.camera
    ahead, up = camera.forward, np.array(camera.up)
    right = np.cross(ahead, up)
    d = np.subtract(point, camera.position)
    return np.sign([d @ right, d @ up])


def test_the_world_is_left_handed(tmp_path):
    """pbrt has +x on the right of a camera that looks along +z, and on the left of one along -z."""
    world = 'Translate 1 0.5 0\nShape "sphere" "float radius" 0.1'
    for eye, side in (("0 0 -5", 1), ("0 0 5", -1)):
        shot = load(tmp_path, world, HEAD.replace("0 0 5", eye))
        (ball,) = shot.scene.shapes
        assert seen(shot, ball.bounds.mean(axis=0)).tolist() == [side, 1]
    # A mirrored file, as many are, is not mirrored again.
    shot = load(tmp_path, world, "Scale -1 1 1" + HEAD)
    assert seen(shot, shot.scene.shapes[0].bounds.mean(axis=0)).tolist() == [1, 1]


def test_options_are_read(tmp_path):
    shot = load(tmp_path, 'Shape "sphere"')
    assert (shot.camera.width, shot.camera.height, shot.camera.fov, shot.camera.fov_axis) == (
        40,
        30,
        50,
        "smaller",
    )
    assert (shot.samples, shot.sampler, shot.integrator) == (8, rw.rendering.Independent(), rw.Path(3))
    assert shot.filter == rw.rendering.GaussianFilter(1.5, 0.5)
    lens = HEAD.replace('"float fov" 50', '"float fov" 50 "float lensradius" 0.1 "float focaldistance" 4')
    assert load(tmp_path, 'Shape "sphere"', lens).camera.focused_distance == 4
    flat = load(
        tmp_path, 'Shape "sphere"', HEAD.replace('"perspective" "float fov" 50', '"orthographic"')
    ).camera
    assert (flat.scale, flat.scale_axis) == (2, "smaller")
    for name, wanted in {
        '"bdpt"': rw.Bidirectional(3),
        '"lightpath"': rw.LightTraced(3),
        '"sppm"': rw.ProgressivePhotonMap(max_depth=3),
        '"sppm" "integer photonsperiteration" 5000 "float radius" 0.1': rw.ProgressivePhotonMap(
            5000, 0.1, max_depth=3
        ),
    }.items():
        assert load(tmp_path, 'Shape "sphere"', HEAD.replace('"volpath"', name)).integrator == wanted
    boxed = load(tmp_path, 'Shape "sphere"', HEAD + 'PixelFilter "box"\n')
    assert boxed.filter == rw.rendering.BoxFilter()


def test_transforms_follow_each_other(tmp_path):
    world = """
    Translate 1 2 3
    AttributeBegin
      Scale 2 2 2
      Rotate 90 0 0 1
      Shape "sphere"
    AttributeEnd
    TransformBegin
      ConcatTransform [ 1 0 0 0  0 1 0 0  0 0 1 0  5 0 0 1 ]
      CoordinateSystem "there"
    TransformEnd
    Shape "sphere"
    CoordSysTransform "there"
    Shape "sphere"
    Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  0 0 7 1 ]
    Shape "sphere"
    """
    places = [ball.transform @ (0, 0, 0, 1) for ball in load(tmp_path, world).scene.shapes]
    # A right-handed world has x mirrored.
    assert np.allclose(
        places, [(-1, 2, 3, 1), (-1, 2, 3, 1), (-6, 2, 3, 1), (0, 0, 7, 1)], rtol=0, atol=1e-12
    )
    first = load(tmp_path, world).scene.shapes[0].transform
    assert np.allclose(first[:3, :3] @ (1, 0, 0), (0, 2, 0), rtol=0, atol=1e-12)


def test_materials(tmp_path):
    assert material(tmp_path, "") == rw.Diffuse(0.5)
    assert material(tmp_path, 'Material "diffuse" "rgb reflectance" [.1 .2 .3]') == rw.Diffuse(
        (0.1, 0.2, 0.3)
    )
    gold = material(tmp_path, 'Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k"')
    assert gold == rw.Conductor("gold", alpha=(0.0, 0.0), multiple_scattering=False)
    # pbrt takes the root of a roughness for alpha, unless remaproughness is false.
    rough = 'Material "conductor" "float roughness" 0.25'
    assert material(tmp_path, rough).alpha == (0.5, 0.5)
    assert material(tmp_path, rough + ' "bool remaproughness" false').alpha == (0.25, 0.25)
    white = material(tmp_path, 'Material "conductor" "rgb reflectance" [.5 .5 .5]')
    # At normal incidence it reflects as much.
    eta, k = white.eta[0], white.k[0]
    assert ((eta - 1) ** 2 + k * k) / ((eta + 1) ** 2 + k * k) == pytest.approx(0.5, rel=1e-9)
    glass = material(tmp_path, 'Material "dielectric" "spectrum eta" "glass-BK7"')
    assert glass.ior == rw.materials.glasses["N-BK7"]
    assert material(tmp_path, 'Material "thindielectric" "spectrum eta" "glass-F10"').ior == pytest.approx(
        1.72825, abs=1e-5
    )
    assert material(tmp_path, 'Material "thindielectric" "float eta" 1.3') == rw.ThinDielectric(1.3)
    with pytest.warns(RuntimeWarning, match="coateddiffuse is approximated by a plastic without thickness"):
        assert material(tmp_path, 'Material "coateddiffuse"') == rw.Plastic(0.5, 1.5, alpha=0.0)
    mixed = """
    MakeNamedMaterial "a" "string type" "diffuse" "rgb reflectance" [0 0 0]
    MakeNamedMaterial "b" "string type" "diffuse" "rgb reflectance" [1 1 1]
    Material "mix" "string materials" [ "a" "b" ] "float amount" 0.25
    """
    assert material(tmp_path, mixed) == rw.Mix(rw.Diffuse(0), rw.Diffuse(1), 0.25)
    assert material(tmp_path, mixed + 'NamedMaterial "b"') == rw.Diffuse(1)
    # A name may precede its definition.
    early = 'NamedMaterial "b"\nShape "sphere"\n' + mixed + 'Shape "sphere"'
    first, second = load(tmp_path, early).scene.shapes
    assert (first.material, second.material) == (rw.Diffuse(1), rw.Mix(rw.Diffuse(0), rw.Diffuse(1), 0.25))
    defaults = 'Attribute "material" "rgb reflectance" [.2 .2 .2]\nMaterial "diffuse"'
    assert material(tmp_path, defaults) == rw.Diffuse(0.2)


def test_textures(tmp_path):
    rng = np.random.default_rng(1)
    pixels = rng.integers(0, 255, (4, 6, 3), np.uint8)
    Image.fromarray(pixels).save(tmp_path / "p.png")
    image = material(
        tmp_path,
        'Texture "p" "spectrum" "imagemap" "string filename" "p.png" "float uscale" 2 "string wrap" "clamp"\n'
        'Material "diffuse" "texture reflectance" "p"',
    ).reflectance
    assert np.array_equal(image.image, pixels)
    assert (image.wrap, image.transform) == (("clamp", "clamp"), rw.textures.UvTransform((2, 1)))
    tiles = material(
        tmp_path,
        'Texture "a" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 4 "rgb tex1" [.1 .1 .1]\n'
        'Texture "b" "spectrum" "scale" "texture tex" "a" "float scale" 0.5\n'
        'Material "diffuse" "texture reflectance" "b"',
    ).reflectance
    assert tiles == rw.textures.ProductTexture(rw.Checker(0.1, 0.0, rw.textures.UvTransform(4.0)), 0.5)
    bumps = material(
        tmp_path,
        'Texture "h" "float" "constant" "float value" 0.1\nMaterial "diffuse" "texture displacement" "h"',
    )
    assert bumps == rw.BumpMap(rw.Diffuse(), 0.1)


def test_shapes(tmp_path):
    world = """
    Shape "trianglemesh" "point3 P" [0 0 0  1 0 0  0 1 0] "integer indices" [0 1 2] "point2 uv" [0 0 1 0 0 1]
    Shape "bilinearmesh" "point3 P" [0 0 0  1 0 0  0 1 0  1 1 0]
    Shape "bilinearmesh" "point3 P" [0 0 0  1 0 0  0 1 0  1 1 1]
    Shape "disk" "float height" 2 "float radius" 3
    Shape "cylinder" "float zmin" 0 "float zmax" 4
    Shape "loopsubdiv" "integer levels" 2 "integer indices" [0 1 2 0 2 3 0 3 1 1 3 2]
        "point3 P" [1 1 1  -1 -1 1  -1 1 -1  1 -1 -1]
    Shape "curve" "point3 P" [0 0 0  1 0 0  2 0 0  3 0 0] "float width" 0.2 "string type" "cylinder"
    """
    triangle, flat, bent, disk, tube, smooth, hair = load(tmp_path, world).scene.shapes
    assert len(triangle.faces) == 1
    assert len(flat.faces) == 2
    # A curved patch has 16 by 16 cells, with the exact corner.
    assert len(bent.faces) == 2 * 16**2
    assert np.allclose(bent.vertices.max(axis=0), (0, 1, 1), rtol=0, atol=1e-12)
    assert disk.bounds[:, 2].tolist() == pytest.approx([2, 2])
    assert tube.bounds[:, 2].tolist() == pytest.approx([0, 4])
    assert len(smooth.faces) == 4 * 4**2
    assert np.hypot(hair.vertices[:, 1], hair.vertices[:, 2]) == pytest.approx(0.1, rel=1e-9)
    # A straight Bézier curve goes from its first point to its last.
    assert sorted((hair.vertices[:, 0].min(), hair.vertices[:, 0].max())) == pytest.approx([-3, 0])


@pytest.mark.parametrize("reverse", ["", "ReverseOrientation\n"])
def test_lamps_shine_where_their_normals_point(tmp_path, reverse):
    """A face's normal is (p1 - p0) x (p2 - p0) by the formula, which in a mirrored world looks as it was."""
    lamp = 'AreaLightSource "diffuse" "rgb L" [2 3 4] "float scale" 2\n' + reverse
    shot = load(tmp_path, lamp + 'Shape "trianglemesh" "point3 P" [-9 -9 0  9 -9 0  0 9 0]')
    (mesh,) = shot.scene.shapes
    assert mesh.emission.radiance == (4, 6, 8)
    hits = shot.scene.intersect([(0.0, 0.0, 5.0)], [(0.0, 0.0, -1.0)])
    assert hits.normal[0].tolist() == pytest.approx([0, 0, -1 if reverse else 1])
    image = shot.render(samples=1, progress=False)
    assert image.rgb[15, 20].tolist() == pytest.approx((0, 0, 0) if reverse else (4, 6, 8), rel=1e-5)


def test_lights(tmp_path):
    world = """
    LightSource "point" "rgb I" [1 2 3] "point3 from" [1 0 0]
    LightSource "spot" "float scale" 2 "point3 to" [0 0 2] "float coneangle" 40 "float conedeltaangle" 7
    LightSource "distant" "point3 from" [0 1 0] "point3 to" [0 0 0] "blackbody L" 6500
    LightSource "infinite" "rgb L" [.1 .2 .3]
    Shape "sphere"
    """
    scene = load(tmp_path, world).scene
    point, spot, sun = scene.lights
    assert point == rw.PointLight((-1, 0, 0), (1, 2, 3))
    assert (spot.angle, spot.falloff, spot.intensity, spot.target) == (40, 7, (2, 2, 2), (0, 0, 2))
    assert sun.direction == (0, -1, 0)
    # A black body has a luminance of 1, and at 6,500 K is nearly as white as D65.
    assert np.dot(sun.irradiance, (0.212671, 0.715160, 0.072169)) == pytest.approx(1, rel=1e-12)
    assert np.allclose(sun.irradiance, 1, rtol=0, atol=0.06)
    assert scene.environment == rw.ConstantEnvironment((0.1, 0.2, 0.3))


def test_squares_of_all_directions_have_equal_areas():
    """Of even directions as many fall in each of 16 parts, by their chi-square, within 5 deviations."""
    rng = np.random.default_rng(0)
    directions = rng.normal(size=(64_000, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    counts = np.histogram2d(*folded(*directions.T), bins=4, range=[[0, 1], [0, 1]])[0]
    assert ((counts - 4000) ** 2 / 4000).sum() < 15 + 5 * np.sqrt(30)
    # +z is the middle, -z the corners, and +x and +y the middles of the right and the lower side.
    x, y, z = (np.array(axis, float) for axis in ((1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, -1)))
    u, v = folded(x, y, z)
    assert np.allclose(u[:3], (1, 0.5, 0.5), rtol=0, atol=1e-12)
    assert np.allclose(v[:3], (0.5, 1, 0.5), rtol=0, atol=1e-12)
    assert {float(u[3]), float(v[3])} <= {0.0, 1.0}
    # A picture of the directions themselves is reproduced.
    side = 256
    names = np.stack(np.meshgrid(*2 * [(np.arange(side) + 0.5) / side]), -1)
    flat = unfolded(names)
    polar, turn = np.pi * 100.5 / side, 2 * np.pi * 300.5 / (2 * side) - np.pi
    at = np.sin(polar) * np.sin(turn), np.cos(polar), -np.sin(polar) * np.cos(turn)
    assert np.allclose(
        flat[100, 300], [one.item() for one in folded(*map(np.array, at))], rtol=0, atol=1 / side
    )


def test_objects_are_copied(tmp_path):
    world = """
    ObjectBegin "ball"
      Translate 0 0 1
      Shape "sphere" "float radius" 0.5
    ObjectEnd
    Translate 1 0 0
    ObjectInstance "ball"
    Scale 2 2 2
    ObjectInstance "ball"
    """
    (copies,) = load(tmp_path, world).scene.shapes
    assert isinstance(copies, rw.Instance)
    places = copies.transform @ copies.shapes[0].transform @ (0, 0, 0, 1)
    assert np.allclose(places, [(-1, 0, 1, 1), (-1, 0, 2, 1)], rtol=0, atol=1e-12)


def test_editors_may_have_marked_a_file_and_ended_its_lines_their_way(tmp_path):
    path = tmp_path / "scene.pbrt"
    text = f'{HEAD}\nWorldBegin\nMaterial "diffuse" "rgb reflectance" [.1 .1 .1]\nShape "sphere"'
    path.write_bytes(b"\xef\xbb\xbf" + text.lstrip().replace("\n", "\r\n").encode())
    (ball,) = rw.load(path).scene.shapes
    assert ball.material == rw.Diffuse(0.1)


def test_files_include_others(tmp_path):
    (tmp_path / "more.pbrt").write_text('Material "diffuse" "rgb reflectance" [.1 .1 .1]\nShape "sphere"')
    assert load(tmp_path, 'Include "more.pbrt"').scene.shapes[0].material == rw.Diffuse(0.1)
    (tmp_path / "more.pbrt").write_text('Include "more.pbrt"')
    with pytest.raises(ValueError, match=r"more\.pbrt: files include each other recursively"):
        load(tmp_path, 'Include "more.pbrt"')
    with pytest.raises(FileNotFoundError):
        load(tmp_path, 'Include "gone.pbrt"')


@pytest.mark.parametrize(
    ("world", "told"),
    [
        ("Blob", "line 9: 'Blob' is not a known directive"),
        ('Shape "sphere" "float radius" [ 1', "a bracket is not closed"),
        ('Shape "sphere', "a quoted string does not end"),
        ('Shape "sphere" "float radius" "one"', "radius must be finite numbers"),
        ('Shape "sphere" "float size" 1', "line 9: Shape sphere: parameter 'size' is not supported"),
        ('Shape "teapot"', "Shape teapot: a shape 'teapot' is not supported"),
        ('Shape "sphere" "float phimax" 90', "a part of it is not supported: phimax must be 360, got 90"),
        ('Material "hair"', "Material hair: a material 'hair' is not supported"),
        ('Material "diffuse" "texture reflectance" "x"', "reflectance: there is no texture of colors 'x'"),
        ('Texture "x" "spectrum" "ptex"', "a texture 'ptex' is not supported"),
        ('LightSource "goniometric"', "a light 'goniometric' is not supported"),
        (
            'MakeNamedMedium "fog" "string type" "homogeneous"',
            "MakeNamedMedium is not supported, as media are not",
        ),
        ('MediumInterface "fog" ""', "MediumInterface is not supported, as media are not"),
        (
            'Shape "trianglemesh" "point3 P" [0 0 0 1 0 0] "integer indices" [0 1 2]',
            "indices must be at least 0 and",
        ),
        ('NamedMaterial "x"', "line 9: NamedMaterial x: there is no material 'x'"),
        ('ObjectInstance "x"', "there is no object 'x'"),
        ("AttributeEnd", "AttributeEnd without its begin"),
        ("AttributeBegin", "ends within an attribute or an object"),
        ("Scale 1 0 1", "Scale must not be 0"),
        ("Translate 1 2", "is not a value"),
        (
            'Shape "curve" "point3 P" [0 0 0 1 0 0 2 0 0 3 0 0] "integer degree" 2 "string type" "cylinder"',
            "a curve must be cubic",
        ),
        # Errors of the library itself have the line as well.
        ('LightSource "point" "rgb I" [-1 0 0]', "line 9: LightSource point: intensity must be at least 0"),
        ('LightSource "spot" "float coneangle" 200', "line 9: LightSource spot: angle must be above 0"),
        ('AreaLightSource "diffuse" "rgb L" [-1 0 0]', "line 9: AreaLightSource diffuse: radiance must be"),
        ('Shape "sphere" "float alpha" 2', "line 9: Shape sphere: opacity must be between 0 and 1, got 2"),
        ('Texture "x" "spectrum" "mix" "float amount" 5', "line 9: Texture x spectrum mix: amount must be"),
        ("Translate 0 inf 0", "line 9: Translate must be finite numbers"),
        ('AreaLightSource "diffuse" "rgb L" ["a" "b" "c"]', "L must be an rgb or a spectrum of numbers"),
        ('AreaLightSource "diffuse" "rgb L" [true true true]', "L must be an rgb or a spectrum of numbers"),
        ('AreaLightSource "diffuse" "blackbody L" 0', "L must be a temperature above 0, in kelvin, got 0"),
        ('AreaLightSource "diffuse" "blackbody L" [nan]', "L must be finite numbers"),
        ('Shape "sphere" "float radius" "2"', "radius must be finite numbers"),
        ('Shape "sphere" "bool radius" true', "radius must be finite numbers"),
        ('Material "conductor" "spectrum eta" []', "eta must be an rgb or a spectrum of numbers, got a"),
        ('Material "conductor" "rgb reflectance" [-1 0 0]', "reflectance must be at least 0, got -1"),
        ('Material "dielectric" "spectrum eta" [500 1.5 400 1.4]', "eta must have increasing wavelengths"),
        ('Material "dielectric" "float roughness" -1', "a roughness must be at least 0"),
        ('Shape "bilinearmesh" "point3 P" [0 0 0] "integer indices" []', "indices must be given"),
        ('Shape "trianglemesh" "point3 P" [0 0 0] "integer indices" [0 0 1e300]', "at least 0 and below 1"),
        (
            'Shape "loopsubdiv" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2 0 1 2 1 0 2]',
            "its faces must form a surface",
        ),
        ('Attribute "shapes" "float radius" 2', "its target must be one of shape, light, material"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(tmp_path, world, told):
    with pytest.raises(ValueError, match=re.escape(told)) as caught:
        load(tmp_path, world + ("\nWorldEnd" if world == "Translate 1 2" else ""))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("head", "told"),
    [
        ("", "has no Camera"),
        (HEAD.replace("perspective", "realistic"), "Camera realistic: a camera 'realistic' is not supported"),
        (HEAD.replace("volpath", "magic"), "an integrator 'magic' is not supported"),
        (HEAD + 'ColorSpace "rec2020"', "a color space must be srgb"),
        (HEAD.replace("[ 40 ]", "0"), "line 4: Film rgb: a resolution must be between 1 and 65536, got 0"),
        (HEAD.replace("50", "200"), "line 3: Camera perspective: fov must be between 0 and 180 degrees"),
        (HEAD.replace("fov", "lensradius").replace("50", "-1"), "lensradius must be at least 0, got -1"),
        (HEAD + 'PixelFilter "gaussian" "float sigma" 0', "line 7: PixelFilter gaussian: sigma must be"),
        (HEAD + 'Sampler "stratified" "integer xsamples" -2 "integer ysamples" -2', "samples must be at"),
        (HEAD + 'Integrator "sppm" "float radius" -1', "Integrator sppm: radius must be greater than 0"),
    ],
)
def test_options_that_are_wrong_are_told(tmp_path, head, told):
    with pytest.raises(ValueError, match=re.escape(told)):
        load(tmp_path, 'Shape "sphere"', head)
    (tmp_path / "empty.pbrt").write_text("# nothing")
    with pytest.raises(ValueError, match=r"empty\.pbrt has no WorldBegin"):
        rw.load(tmp_path / "empty.pbrt")
