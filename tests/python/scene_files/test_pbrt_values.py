"""Files of pbrt-v4: parameters that change a picture by a figure that is known, and those that are told."""

import gzip
import re
import warnings

import numpy as np
import pytest
import trimesh
from pbrt_files import HEAD, load, material
from PIL import Image

import raywright as rw

LIT = 'LightSource "infinite" "rgb L" [.1 .2 .3]\nShape "sphere" "float radius" 0.1'


def film(text, camera=""):
    """Return options with more parameters of the film, and of the camera."""
    options = HEAD.replace('"integer yresolution" 30', f'"integer yresolution" 30 {text}')
    return options.replace('"float fov" 50', f'"float fov" 50 {camera}')


def quietly(*arguments):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        return load(*arguments)


@pytest.mark.parametrize(
    ("head", "ratio"),
    [
        (film('"float iso" 500'), 5.0),
        (film("", '"float shutteropen" 0.5 "float shutterclose" 0.75'), 0.25),
        (film('"float iso" 400', '"float shutterclose" 0.5'), 2.0),
        # The last film counts.
        (film("") + 'Film "rgb" "float iso" 50 "integer xresolution" 40 "integer yresolution" 30', 0.5),
        (film('"float exposuretime" 3'), 3.0),
        (film('"float iso" 500 "string sensor" "canon_eos_100d"'), 5.0),
    ],
)
def test_the_exposure_of_a_film_counts(tmp_path, head, ratio):
    """A pixel is exposure time times ISO over 100 as bright, whatever the light comes from."""
    lamp = 'AreaLightSource "diffuse" "rgb L" [2 3 4]\nShape "disk" "float radius" 9'
    world = f'{LIT}\nLightSource "point" "rgb I" [1 2 3]\nLightSource "distant" "rgb L" [3 2 1]\n{lamp}'
    shot = quietly(tmp_path, world, head)
    point, sun = shot.scene.lights
    assert shot.scene.environment.radiance == pytest.approx(ratio * np.array((0.1, 0.2, 0.3)), rel=1e-12)
    assert point.intensity == pytest.approx(ratio * np.array((1, 2, 3)), rel=1e-12)
    assert sun.irradiance == pytest.approx(ratio * np.array((3, 2, 1)), rel=1e-12)
    seen = load(tmp_path, lamp, HEAD).render(samples=1, progress=False).rgb[2, 2]
    assert seen == pytest.approx((2, 3, 4), rel=1e-3)
    seen = quietly(tmp_path, lamp, head).render(samples=1, progress=False).rgb[2, 2]
    assert seen == pytest.approx(ratio * np.array((2, 3, 4)), rel=1e-3)


@pytest.mark.parametrize(
    ("light", "factor"),
    [
        ('"point" "float power" 7', 7 / (4 * np.pi)),
        ('"point" "float power" 0', 1.0),
        ('"distant" "float illuminance" 5', 5.0),
        ('"infinite" "float illuminance" 5', 5 / np.pi),
        # The inner cone has full intensity, and the part around it half.
        (
            '"spot" "float power" 7 "float coneangle" 60 "float conedeltaangle" 60',
            7 / (np.pi * (1 - np.cos(np.pi / 3))),
        ),
    ],
)
def test_lights_have_the_power_that_they_name(tmp_path, light, factor):
    name = "I" if "power" in light else "L"
    text = f'LightSource {light} "rgb {name}" [1 2 3] "float scale" 2\nShape "sphere"'
    scene = load(tmp_path, text, film('"float iso" 200')).scene
    made = scene.environment if scene.environment is not None else scene.lights[0]
    shine = next(getattr(made, one) for one in ("radiance", "irradiance", "intensity") if hasattr(made, one))
    assert shine == pytest.approx(2 * 2 * factor * np.array((1, 2, 3)), rel=1e-12)
    with pytest.raises(ValueError, match="parameter 'power' is not supported"):
        load(tmp_path, 'LightSource "distant" "float power" 3')


def test_boxes_may_be_wider(tmp_path):
    head = HEAD + 'PixelFilter "box" "float xradius" 1.5 "float yradius" 1.5\n'
    assert load(tmp_path, LIT, head).filter == rw.rendering.BoxFilter(1.5)


def test_pictures_that_shine_are_exposed_too(tmp_path):
    np.save(tmp_path / "sky.npy", np.full((4, 4, 3), 0.5, np.float32))
    world = 'LightSource "infinite" "string filename" "sky.npy"\nShape "sphere" "float radius" 0.1'
    shot = load(tmp_path, world, film('"float iso" 300'))
    assert shot.render(samples=1, progress=False).rgb[0, 0] == pytest.approx(1.5, rel=1e-3)
    shot = quietly(tmp_path, world, film('"float iso" 300 "float whitebalance" 5000'))
    seen = shot.render(samples=1, progress=False).rgb[0, 0]
    assert seen[0] < 1.5 < seen[2]


def test_light_of_the_white_balance_is_white(tmp_path):
    """D50 is white where it is balanced for 5,000 K, and as bright as it was (xy by CIE 015:2018)."""
    to_rgb = np.array(
        [
            (3.2404542, -1.5371385, -0.4985314),
            (-0.9692660, 1.8760108, 0.0415560),
            (0.0556434, -0.2040259, 1.0572252),
        ]
    )
    x, y = 0.34567, 0.35850
    red, green, blue = to_rgb @ (x / y, 1, (1 - x - y) / y)
    world = f'LightSource "infinite" "rgb L" [{red} {green} {blue}]\nShape "sphere" "float radius" 0.1'
    with pytest.warns(RuntimeWarning, match="whitebalance is applied to the light"):
        shot = load(tmp_path, world, film('"float whitebalance" 5000'))
    assert shot.scene.environment.radiance == pytest.approx((1, 1, 1), abs=2e-3)
    # A gray ball, lit from all sides, has the same gray.
    gray = world.replace("0.1", "1.5")
    image = quietly(tmp_path, gray, film('"float whitebalance" 5000')).render(samples=64, progress=False)
    assert image.rgb[15, 20] == pytest.approx((0.5, 0.5, 0.5), abs=4e-3)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        shot = load(tmp_path, world, film('"float whitebalance" 6504'))
    assert shot.scene.environment.radiance == pytest.approx((red, green, blue), abs=2e-3)
    # Below 4,000 K, daylight equals a black body: balanced for its own temperature it is white.
    warm = 'LightSource "infinite" "blackbody L" 3000\nShape "sphere" "float radius" 0.1'
    shot = quietly(tmp_path, warm, film('"float whitebalance" 3000'))
    assert shot.scene.environment.radiance == pytest.approx((1, 1, 1), abs=4e-3)


def test_samples_are_limited(tmp_path):
    lamp = 'AreaLightSource "diffuse" "rgb L" [20 10 5]\nShape "disk" "float radius" 9'
    with pytest.warns(RuntimeWarning, match="maxcomponentvalue limits red, green and blue"):
        shot = load(tmp_path, lamp, film('"float maxcomponentvalue" 4 "float iso" 200'))
    assert shot.clamp == 4
    assert shot.render(samples=1, progress=False).rgb[2, 2] == pytest.approx((4, 2, 1), rel=1e-3)
    assert shot.render(samples=1, clamp=None, progress=False).rgb[2, 2] == pytest.approx(
        (40, 20, 10), rel=1e-3
    )


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ('"float iso" 0', "iso must be above 0, got 0"),
        ('"float whitebalance" -1', "whitebalance must be at least 0, got -1"),
        ('"float maxcomponentvalue" -1', "maxcomponentvalue must be above 0, got -1"),
    ],
)
def test_films_that_are_wrong_are_told(tmp_path, text, told):
    with pytest.raises(ValueError, match=re.escape(f"line 4: Film rgb: {told}")):
        load(tmp_path, LIT, film(text))
    with pytest.raises(
        ValueError, match="line 3: Camera perspective: shutterclose must be above shutteropen"
    ):
        load(tmp_path, LIT, film("", '"float shutteropen" 1'))


def test_cells_of_a_checkerboard_are_one_unit(tmp_path):
    """Cell (i, j) spans a unit of scaled coordinates each way, and is of tex1 if i + j is even."""
    world = """
    Texture "c" "spectrum" "checkerboard" "float uscale" 4 "float vscale" 2 "float udelta" 1
        "rgb tex1" [.1 .1 .1] "rgb tex2" [.9 .9 .9]
    Material "diffuse" "texture reflectance" "c"
    LightSource "infinite" "rgb L" [1 1 1]
    Shape "bilinearmesh" "point3 P" [0 0 0  1 0 0  0 1 0  1 1 0]
    """
    scene = load(tmp_path, world).scene
    for u, v in ((0.1, 0.2), (0.3, 0.2), (0.3, 0.7), (0.9, 0.9)):
        # x is mirrored.
        eye = rw.Camera((-u, v, 2), direction=(0, 0, -1), width=1, height=1, fov=0.1)
        seen = rw.render(scene, eye, samples=64, progress=False).rgb[0, 0, 0]
        first = (int(4 * u + 1) + int(2 * v)) % 2 == 0
        assert seen == pytest.approx(0.1 if first else 0.9, rel=1e-3)


def picture(folder, values, text="", of="spectrum", name="p.png"):
    """Return what the points of a picture become: (H, W, 3), or (H, W, 1) where they are numbers."""
    values = np.asarray(values)
    if name.endswith(".npy"):
        np.save(folder / name, values)
    else:
        Image.fromarray(values).save(folder / name)
    use = '"texture reflectance"' if of == "spectrum" else '"texture displacement"'
    made = material(
        folder,
        f'Texture "p" "{of}" "imagemap" "string filename" "{name}" {text}\nMaterial "diffuse" {use} "p"',
    )
    texture = made.reflectance if of == "spectrum" else made.height
    scale = 1.0
    if isinstance(texture, rw.textures.ProductTexture):
        texture, scale = texture.a, texture.b[0]
    texels = texture.image[..., list(texture.channels)].astype(np.float64)
    if texture.image.dtype == np.uint8:
        texels /= 255
        if not texture.linear:
            texels = np.where(texels <= 0.04045, texels / 12.92, ((texels + 0.055) / 1.055) ** 2.4)
    return scale * texels


GRAY = np.full((2, 2), 64, np.uint8)
DECODED = ((64 / 255 + 0.055) / 1.055) ** 2.4


@pytest.mark.parametrize(
    ("text", "wanted"),
    [
        ("", DECODED),
        ('"string encoding" "sRGB"', DECODED),
        ('"string encoding" "linear"', 64 / 255),
        ('"string encoding" "gamma 1"', 64 / 255),
        ('"string encoding" "gamma 2.2"', (64 / 255) ** 2.2),
        ('"float scale" 0.5', 0.5 * DECODED),
        # The scale applies before inversion, and a share below 0 becomes 0.
        ('"bool invert" true', 1 - DECODED),
        ('"bool invert" true "float scale" 0.5', 1 - 0.5 * DECODED),
        ('"bool invert" true "float scale" 4 "string encoding" "gamma 1"', 0.0),
        ('"bool invert" true "float scale" 2 "string encoding" "gamma 2.2"', 1 - 2 * (64 / 255) ** 2.2),
    ],
)
def test_points_of_a_picture_are_what_their_encoding_says(tmp_path, text, wanted):
    deep = (64 * 257 * np.ones((2, 2))).astype(np.uint16)
    for values in (GRAY, np.stack([GRAY] * 3, -1), deep):
        for of in ("spectrum", "float"):
            assert picture(tmp_path, values, text, of) == pytest.approx(wanted, abs=1e-6)
    # Float pictures are linear.
    plain = 'bool invert" true' in text
    share = float(re.search('scale" ([0-9.]+)', text)[1]) if "scale" in text else 1.0
    kept = max(1 - share * 0.25, 0) if plain else share * 0.25
    assert picture(tmp_path, np.full((2, 2, 3), 0.25, np.float32), text, name="p.npy") == pytest.approx(kept)


def test_other_pictures_are_srgb_whatever_their_encoding_says(tmp_path):
    with pytest.warns(
        RuntimeWarning, match=r"the encoding of p\.bmp is taken as sRGB: pbrt decodes PNG alone"
    ):
        assert picture(tmp_path, GRAY, '"string encoding" "linear"', name="p.bmp") == pytest.approx(DECODED)
    with pytest.raises(
        ValueError, match="encoding must be sRGB, linear or gamma and a number, got 'gamma x'"
    ):
        picture(tmp_path, GRAY, '"string encoding" "gamma x"')
    with pytest.raises(ValueError, match="filter must be one of point, bilinear, trilinear, ewa, got 'none'"):
        picture(tmp_path, GRAY, '"string filter" "none"')


def test_numbers_of_a_picture_are_its_alpha_or_its_mean(tmp_path):
    colors = np.array([[(255, 0, 0), (0, 255, 51)]], np.uint8)
    linear = '"string encoding" "linear"'
    assert picture(tmp_path, colors, linear, "float")[0, :, 0] == pytest.approx((1 / 3, 1.2 / 3), abs=1e-6)
    opaque = np.dstack([colors, np.full((1, 2), 255, np.uint8)])
    assert picture(tmp_path, opaque, linear, "float")[0, :, 0] == pytest.approx((1 / 3, 1.2 / 3), abs=1e-6)
    clear = np.dstack([colors, np.array([[255, 102]], np.uint8)])
    assert picture(tmp_path, clear, linear, "float")[0, :, 0] == pytest.approx((1, 0.4), abs=1e-6)
    assert picture(tmp_path, clear, linear)[0, 0] == pytest.approx((1, 0, 0), abs=1e-6)


@pytest.mark.parametrize(
    ("text", "version"),
    [
        ('Film "image"\nWorldBegin\nShape "sphere"\nWorldEnd', "pbrt-v2 or v3"),
        ('Integrator "path"\nWorldBegin\nMaterial "matte"\nShape "sphere"\nWorldEnd', "pbrt-v3"),
        ('SurfaceIntegrator "path"\nWorldBegin\nShape "sphere"\nWorldEnd', "pbrt-v2"),
        ('WorldBegin\nMakeNamedMaterial "a" "string type" "uber"', "pbrt-v2 or v3"),
    ],
)
def test_files_of_older_versions_say_that_they_are(tmp_path, text, version):
    path = tmp_path / "old.pbrt"
    path.write_text(f'Camera "perspective"\n{text}')
    with pytest.raises(
        ValueError, match=re.escape(f"old.pbrt is a file of {version}: pbrt-v4 makes one")
    ) as caught:
        rw.load(path)
    # Later errors still have their line.
    assert re.search(r"old\.pbrt, line [2-5]: ", str(caught.value))
    with pytest.raises(ValueError, match="a material 'hair' is not supported") as caught:
        load(tmp_path, '# Material "matte"\nMaterial "hair"')
    assert "v3" not in str(caught.value)


def test_packed_files_are_read(tmp_path):
    box = trimesh.creation.box()
    (tmp_path / "box.ply.gz").write_bytes(gzip.compress(box.export(file_type="ply")))
    (tmp_path / "more.pbrt.gz").write_bytes(gzip.compress(b'Shape "plymesh" "string filename" "box.ply.gz"'))
    path = tmp_path / "all.pbrt.gz"
    path.write_bytes(gzip.compress(f'{HEAD}\r\nWorldBegin\r\nInclude "more.pbrt.gz"'.encode()))
    (mesh,) = rw.load(path).scene.shapes
    assert mesh.bounds.tolist() == [[-0.5] * 3, [0.5] * 3]
    assert len(mesh.faces) == 12
    with pytest.raises(FileNotFoundError, match=r"gone\.ply\.gz"):
        load(tmp_path, 'Shape "plymesh" "string filename" "gone.ply.gz"')
    for damaged in (b"no gzip", gzip.compress(b"ply")[:-9]):
        (tmp_path / "box.ply.gz").write_bytes(damaged)
        with pytest.raises(ValueError, match=r"box\.ply\.gz is not a gzip file that can be read"):
            rw.load(path)
        path.write_bytes(damaged)
        with pytest.raises(ValueError, match=r"all\.pbrt\.gz is not a gzip file that can be read"):
            rw.load(path)
        path.write_bytes(gzip.compress(f'{HEAD}\nWorldBegin\nInclude "more.pbrt.gz"'.encode()))
    (tmp_path / "box.ply.gz").write_bytes(gzip.compress(b"no mesh"))
    with pytest.raises(ValueError, match=r"box\.ply\.gz is not a mesh") as caught:
        rw.load(path)
    assert str(tmp_path / "box.ply.gz") in str(caught.value)


def test_moving_objects_stand_where_the_shutter_opens(tmp_path):
    world = """
    ActiveTransform StartTime
    Translate 1 0 0
    ActiveTransform EndTime
    Translate 2 0 0
    ActiveTransform All
    Translate 0 1 0
    Shape "sphere"
    """
    with pytest.warns(RuntimeWarning, match="motion is left out"):
        (ball,) = load(tmp_path, world, "TransformTimes 0 1\n" + HEAD).scene.shapes
    assert (ball.transform @ (0, 0, 0, 1)).tolist() == [-1, 1, 0, 1]
    with pytest.raises(ValueError, match="ActiveTransform must be one of All, StartTime, EndTime"):
        load(tmp_path, "ActiveTransform Now")


@pytest.mark.parametrize(
    ("world", "head", "told"),
    [
        (
            'Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "vector3 S" [1 0 0 1 0 0 1 0 0]',
            HEAD,
            "'S' of Shape",
        ),
        (
            LIT,
            HEAD.replace('"volpath"', '"volpath" "bool regularize" true'),
            "'regularize' of Integrator volpath",
        ),
        (
            LIT,
            HEAD.replace('"independent"', '"halton" "string randomization" "none"'),
            "'randomization' of Sampler",
        ),
        (LIT, HEAD + 'Option "bool forcediffuse" true\n', "parameter 'forcediffuse' of Option is left out"),
        (LIT, HEAD + 'PixelFilter "sinc"\n', "the sinc filter is approximated by Lanczos' of 4 lobes"),
        (
            LIT,
            HEAD.replace('"perspective" "float fov" 50', '"orthographic" "float lensradius" 1'),
            "'lensradius' of",
        ),
        (LIT, HEAD.replace('Film "rgb"', 'Film "gbuffer"'), "a film 'gbuffer' is read as an RGB film"),
        (
            LIT,
            HEAD.replace('"volpath"', '"ambientocclusion"').replace(
                'Film "rgb"', 'Film "rgb" "float iso" 200'
            ),
            "exposure does",
        ),
        (
            'Material "coateddiffuse" "rgb albedo" [.5 .5 .5]\n' + LIT,
            HEAD,
            "'albedo' of Material coateddiffuse",
        ),
        (
            'AreaLightSource "diffuse"\nObjectBegin "o"\nShape "sphere"\nObjectEnd\nObjectInstance "o"',
            HEAD,
            "area lights in objects are left out",
        ),
    ],
)
def test_what_is_left_out_is_told(tmp_path, world, head, told):
    with pytest.warns(RuntimeWarning) as caught:
        load(tmp_path, world, head)
    lines = [str(one.message) for one in caught]
    assert any(told in line and line.startswith(str(tmp_path / "scene.pbrt: ")[:-1]) for line in lines), lines
    assert {one.filename for one in caught} == {load.__code__.co_filename}


def test_a_metal_is_of_one_table(tmp_path):
    mixed = 'Material "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Ag-k"'
    for text in (mixed, 'Material "conductor" "rgb k" [3 3 3]'):
        with pytest.raises(ValueError, match="eta and k must both be of one metal, or both be numbers"):
            load(tmp_path, text)
