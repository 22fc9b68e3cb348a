"""Materials and pictures of glTF files, against what the format says of them."""

import io
import math
import warnings

import numpy as np
import pytest
from gltf_writer import SQUARE, Writer, own
from PIL import Image
from trimesh.visual.material import PBRMaterial

import raywright as rw
from raywright.scene_files.gltf import read_gltf

PIXELS = np.random.default_rng(1).integers(0, 256, (4, 4, 4), np.uint8)
UV = np.float32([(0, 0), (1, 0), (1, 1), (0, 1)])


def png(pixels: np.ndarray, kind: str = "PNG") -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, format=kind, **({"lossless": True} if kind == "WEBP" else {}))
    return out.getvalue()


def loaded(tmp_path, material, writer=None, told=None, **attributes):
    """Return the mesh of a file with one material; what is warned of must be `told`."""
    writer = writer or Writer()
    attributes = {"TEXCOORD_0": UV, **attributes}
    writer.node(mesh=writer.mesh(material, **attributes))
    path = tmp_path / "file.glb"
    path.write_bytes(writer.glb())
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        (mesh,) = own(read_gltf(path))
    assert [str(one.message) for one in caught] == ([f"file.glb: {told}"] if told else [])
    assert all(one.filename == __file__ for one in caught)
    return mesh


def clear(**more):
    """Return a material that light goes through."""
    extensions = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, **more.pop("extensions", {})}
    return {
        "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0, **more},
        "extensions": extensions,
    }


def volume(**more):
    return {"KHR_materials_volume": {"thicknessFactor": 0.1, **more}}


VOLUME = volume()
FILM = {"KHR_materials_iridescence": {"iridescenceFactor": 1.0, "iridescenceIor": 1.4}}


def test_all_of_the_model_is_read(tmp_path):
    writer = Writer()
    base, both = writer.picture(png(PIXELS)), writer.picture(png(PIXELS[..., :3]))
    normals, glow = writer.picture(png(PIXELS[::-1, :, :3])), writer.picture(png(PIXELS[:, ::-1, :3]))
    mesh = loaded(
        tmp_path,
        {
            "pbrMetallicRoughness": {
                "baseColorFactor": [1, 0.2, 1, 1],
                "baseColorTexture": base,
                "metallicRoughnessTexture": both,
                "roughnessFactor": 0.5,
            },
            "normalTexture": {**normals, "scale": 0.75},
            "emissiveFactor": [0.5, 1, 1],
            "emissiveTexture": glow,
            "alphaMode": "MASK",
            "alphaCutoff": 0.25,
            "doubleSided": True,
            "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8.0}},
        },
        writer,
    )
    kept = PIXELS[..., 3] / 255 >= 0.25
    assert np.array_equal(mesh.material.opacity.image[..., 0] == 255, kept)
    bumpy = mesh.material.material
    assert (bumpy.normals, bumpy.scale) == (rw.ImageTexture(PIXELS[::-1, :, :3], linear=True), 0.75)
    model = bumpy.material
    assert model.base_color == rw.textures.ProductTexture(rw.ImageTexture(PIXELS), (1, 0.2, 1))
    assert model.metallic == rw.ImageTexture(PIXELS[..., :3], linear=True, channel="b")
    green = rw.ImageTexture(PIXELS[..., :3], linear=True, channel="g")
    assert model.roughness == rw.textures.ProductTexture(green, 0.5)
    shown = rw.textures.ProductTexture(rw.ImageTexture(PIXELS[:, ::-1, :3]), (4, 8, 8))
    assert mesh.emission == rw.Emission(shown, both_sides=True)


def test_files_and_trimesh_give_the_same_looks(tmp_path):
    import trimesh

    given = PBRMaterial(
        baseColorFactor=[51, 102, 255, 255],
        metallicFactor=0.25,
        roughnessFactor=0.5,
        baseColorTexture=Image.fromarray(PIXELS),
        emissiveFactor=[0.5, 0.25, 0],
        alphaMode="BLEND",
    )
    box = trimesh.creation.box()
    box.visual = trimesh.visual.TextureVisuals(uv=np.random.default_rng(2).random((8, 2)), material=given)
    box.export(tmp_path / "box.glb")
    (here,), (there,) = rw.Scene(box).shapes, own(read_gltf(tmp_path / "box.glb"))
    assert there.material == here.material
    assert there.emission == here.emission
    assert np.allclose(there.uv, here.uv, rtol=0, atol=1e-6)


def test_a_point_of_a_picture_is_where_it_belongs(tmp_path):
    """The first row of the file is at v = 0 of the file."""
    pixels = np.zeros((2, 2, 3), np.uint8)
    pixels[0, 1] = 255, 0, 0
    writer = Writer()
    info = writer.picture(png(pixels))
    writer.json["samplers"] = [{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}]
    writer.json["textures"][0]["sampler"] = 0
    material = {"pbrMetallicRoughness": {"baseColorTexture": info}, "extensions": {"KHR_materials_unlit": {}}}
    told = "unlit materials are matte here"
    mesh = loaded(tmp_path, material, writer, told)
    texture = mesh.material.reflectance
    assert (texture.filter, texture.wrap) == ("nearest", ("clamp", "mirror"))
    scene = rw.Scene(mesh, environment=1.0)
    # (0.75, 0.25) of the square has coordinates (0.75, 0.25) from the top: the right of the first row.
    for x, y, expected in ((0.75, 0.25, 1), (0.75, 0.75, 0), (0.25, 0.25, 0), (0.25, 0.75, 0)):
        camera = rw.Camera((x, y, 1), (x, y, 0), fov=0.1, width=1, height=1)
        seen = rw.render(scene, camera, rw.Path(max_depth=1), samples=1, progress=False).rgb[0, 0]
        assert seen == pytest.approx((expected, 0, 0), abs=1e-6)


@pytest.mark.parametrize(
    ("told", "given", "expected"),
    [
        ({}, (0.25, 0.5), (0.25, 0.5)),
        ({"offset": [0.5, 0.25]}, (0.25, 0.5), (0.75, 0.75)),
        ({"scale": [2, 4]}, (0.25, 0.5), (0.5, 2)),
        # By KHR_texture_transform a quarter turn is anticlockwise where v goes down: right becomes up.
        ({"rotation": math.pi / 2}, (0.25, 0), (0, -0.25)),
        ({"rotation": math.pi / 2, "scale": [2, 1], "offset": [1, 0]}, (0.25, 0.5), (1.5, -0.5)),
    ],
)
def test_pictures_are_scaled_then_turned_then_moved(tmp_path, told, given, expected):
    writer = Writer()
    info = {**writer.picture(png(PIXELS)), "extensions": {"KHR_texture_transform": told}}
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": info}}, writer)
    matrix = np.array(mesh.material.base_color.transform.matrix)
    u, v = matrix @ (given[0], 1 - given[1], 1)
    assert (u, 1 - v) == pytest.approx(expected, abs=1e-12)


def test_pictures_lie_on_the_coordinates_that_they_name(tmp_path):
    writer = Writer()
    one = {**writer.picture(png(PIXELS)), "texCoord": 1}
    model = {"baseColorTexture": one, "metallicRoughnessTexture": {**one, "texCoord": 0}}
    told = "materials with pictures on several sets of texture coordinates keep those on the first"
    other = UV * np.float32(0.5)
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": model}, writer, told, TEXCOORD_1=other)
    assert np.array_equal(mesh.uv, other * (1, -1) + (0, 1))
    assert mesh.material.base_color == rw.ImageTexture(PIXELS)
    assert mesh.material.metallic == 1.0


@pytest.mark.parametrize("kind", ["PNG", "JPEG", "WEBP"])
def test_pictures_may_be_of_three_kinds(tmp_path, kind):
    data = png(PIXELS[..., :3], kind)
    writer = Writer()
    info = writer.picture(data)
    if kind == "WEBP":
        writer.json["textures"] = [{"extensions": {"EXT_texture_webp": {"source": 0}}}]
        writer.json["extensionsRequired"] = ["EXT_texture_webp"]
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": info}}, writer)
    assert np.array_equal(mesh.material.base_color.image, np.asarray(Image.open(io.BytesIO(data))))


def test_pictures_beside_the_file_are_found(tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "a picture.png").write_bytes(png(PIXELS))
    writer = Writer()
    writer.json["images"] = [{"uri": "parts/a%20picture.png"}]
    writer.json["textures"] = [{"source": 0}]
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, writer)
    assert np.array_equal(mesh.material.base_color.image, PIXELS)


@pytest.mark.parametrize(
    ("material", "expected"),
    [
        ({}, rw.Diffuse()),
        ({"pbrMetallicRoughness": {"metallicFactor": 0}}, rw.MetallicRough(1, 0, 1)),
        (
            {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.2]}, "alphaMode": "BLEND"},
            rw.Mask(rw.MetallicRough(), 0.2),
        ),
        (
            {
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.5},
                "extensions": {"KHR_materials_ior": {"ior": 1.8}},
            },
            rw.Plastic(1.0, 1.8, 0.5),
        ),
        (clear(), rw.ThinDielectric(1.5)),
        (clear(extensions={"KHR_materials_ior": {"ior": 1.33}}), rw.ThinDielectric(1.33)),
        (clear(extensions=VOLUME, roughnessFactor=0.25), rw.Dielectric(1.5, 0.25)),
        (
            clear(extensions=VOLUME, metallicFactor=0.25),
            rw.Mix(rw.MetallicRough(1, 0.25, 0), rw.Dielectric(), 0.75),
        ),
        (
            clear(extensions=volume(attenuationDistance=0.5, attenuationColor=[1, 0.25, 0])),
            rw.Dielectric(1.5, 0.0, transmittance=(1, 0.25, 1e-6), distance=0.5),
        ),
        # Without a distance nothing is lost, and a sheet has no inside.
        (clear(extensions=volume(attenuationColor=[1, 0.5, 0.5])), rw.Dielectric(1.5, 0.0)),
        (
            clear(
                extensions={"KHR_materials_volume": {"attenuationDistance": 1, "attenuationColor": [1, 0, 0]}}
            ),
            rw.ThinDielectric(1.5),
        ),
        (clear(baseColorFactor=[1, 0.5, 0, 1]), rw.materials.Tinted(rw.ThinDielectric(1.5), (1, 0.5, 0))),
        (
            clear(baseColorFactor=[1, 0.5, 0, 1], extensions=VOLUME),
            rw.materials.Tinted(rw.Dielectric(1.5, 0.0), (1, 0.5, 0)),
        ),
        (
            clear(extensions={**VOLUME, "KHR_materials_dispersion": {"dispersion": 20 / 55}}),
            rw.Dielectric(rw.materials.Cauchy.from_abbe(1.5, 55.0), 0.0),
        ),
        (clear(extensions={**VOLUME, "KHR_materials_dispersion": {}}), rw.Dielectric(1.5, 0.0)),
        (
            clear(extensions={**VOLUME, **FILM}),
            rw.materials.ThinFilm(400.0, 1.4, base=rw.Dielectric(1.5, 0.0)),
        ),
        (
            clear(extensions={"KHR_materials_iridescence": {"iridescenceFactor": 0.5}}),
            rw.Mix(rw.ThinDielectric(1.5), rw.materials.SoapFilm(400.0, 1.3), 0.5),
        ),
        (clear(extensions={"KHR_materials_iridescence": {}}), rw.ThinDielectric(1.5)),
    ],
    ids=[
        *("nothing", "matt", "blend", "ior", "pane", "water", "rough glass", "partly metal"),
        *("tint within", "no way", "no inside", "tinted pane", "tinted glass", "dispersion", "none"),
        *("film on glass", "bubble", "no film"),
    ],
)
def test_materials_become_ours(tmp_path, material, expected):
    assert loaded(tmp_path, material).material == expected


def test_what_goes_through_may_vary(tmp_path):
    writer = Writer()
    info = writer.picture(png(PIXELS[..., :3]))
    material = clear(metallicFactor=1.0, metallicRoughnessTexture=info)
    material["extensions"]["KHR_materials_transmission"] = {
        "transmissionFactor": 0.5,
        "transmissionTexture": info,
    }
    mix = loaded(tmp_path, material, writer).material
    blue, red = (rw.ImageTexture(PIXELS[..., :3], linear=True, channel=name) for name in "br")
    assert mix.a.metallic == blue
    assert mix.amount == rw.textures.ProductTexture(
        rw.textures.MixTexture(1.0, 0.0, blue), rw.textures.ProductTexture(red, 0.5)
    )


def test_tints_and_films_may_vary(tmp_path):
    writer = Writer()
    info = writer.picture(png(PIXELS[..., :3]))
    mesh = loaded(tmp_path, clear(baseColorTexture=info), writer)
    assert mesh.material == rw.materials.Tinted(rw.ThinDielectric(1.5), rw.ImageTexture(PIXELS[..., :3]))
    writer = Writer()
    info = writer.picture(png(PIXELS[..., :3]))
    film = {
        "KHR_materials_iridescence": {
            "iridescenceFactor": 0.5,
            "iridescenceTexture": info,
            "iridescenceThicknessMinimum": 200,
            "iridescenceThicknessMaximum": 600,
            "iridescenceThicknessTexture": info,
        }
    }
    mix = loaded(tmp_path, clear(extensions={**VOLUME, **film}), writer).material
    red, green = (rw.ImageTexture(PIXELS[..., :3], linear=True, channel=name) for name in "rg")
    assert mix.b == rw.materials.ThinFilm(
        rw.textures.MixTexture(200.0, 600.0, green), 1.3, base=rw.Dielectric(1.5, 0.0)
    )
    assert (mix.a, mix.amount) == (rw.Dielectric(1.5, 0.0), rw.textures.ProductTexture(red, 0.5))


def test_metal_under_a_film_reflects_its_color_where_the_film_ends(tmp_path):
    metal = {"baseColorFactor": [0.9, 0.6, 0.3, 1], "metallicFactor": 1, "roughnessFactor": 0}
    made = loaded(tmp_path, {"pbrMetallicRoughness": metal, "extensions": FILM}).material
    assert (made.thickness, made.ior) == (400.0, 1.4)
    eta = np.array(made.base.eta)
    assert np.allclose(((eta - 1) / (eta + 1)) ** 2, (0.9, 0.6, 0.3), rtol=1e-12)
    assert made.base.k == (0.0, 0.0, 0.0)


def test_metal_of_a_picture_has_its_film(tmp_path):
    shades = np.uint8(
        [[(230, 180, 90, 255), (120, 200, 240, 255)], [(255, 255, 255, 255), (90, 80, 70, 255)]]
    )
    writer = Writer()
    metal = {"baseColorTexture": writer.picture(png(shades)), "baseColorFactor": [1, 0.5, 1, 1]}
    whole = loaded(tmp_path, {"pbrMetallicRoughness": metal, "extensions": FILM}, writer).material
    eta = whole.base.eta
    shares = ((shades[..., :3] / 255 + 0.055) / 1.055) ** 2.4 * (1, 0.5, 1)
    found = np.square((eta.image - 1) / (eta.image + 1.0))
    assert np.allclose(found, np.minimum(shares, 0.9999), rtol=1e-4, atol=0)
    assert not eta.decoded
    # If only part of it is metal, the film is on that.
    writer = Writer()
    where = writer.picture(png(PIXELS[..., :3]))
    metal = {"baseColorTexture": writer.picture(png(shades)), "metallicRoughnessTexture": where}
    told = "films are left out of opaque nonmetals"
    partly = loaded(tmp_path, {"pbrMetallicRoughness": metal, "extensions": FILM}, writer, told).material
    blue, green = (rw.ImageTexture(PIXELS[..., :3], linear=True, channel=name) for name in "bg")
    assert partly.a == rw.MetallicRough(rw.ImageTexture(shades), 0.0, green)
    assert partly.b == rw.materials.ThinFilm(
        400.0, 1.4, base=rw.Conductor(eta=partly.b.base.eta, roughness=green, k=0.0)
    )
    assert partly.amount == blue
    # A film of thickness 0 is none: straight on, the metal has its color.
    writer = Writer()
    bare = {"KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessMaximum": 0}}
    gray = np.full((2, 2, 3), 150, np.uint8)
    metal = {"baseColorTexture": writer.picture(png(gray)), "roughnessFactor": 0}
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": metal, "extensions": bare}, writer)
    eye = rw.Orthographic((0.5, 0.5, 3), (0.5, 0.5, 0), up=(0, 1, 0), scale=0.5, width=2, height=2)
    scene = rw.Scene(mesh, environment=1.0)
    seen = rw.render(scene, eye, rw.Path(max_depth=1), samples=4, progress=False).rgb
    assert np.allclose(seen, ((150 / 255 + 0.055) / 1.055) ** 2.4, rtol=1e-5)


@pytest.mark.parametrize(
    ("material", "told"),
    [
        (
            clear(baseColorFactor=[1, 0, 0, 1], extensions={**VOLUME, **FILM}),
            "light through clear materials with films is not tinted by their base color",
        ),
        (
            {"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": FILM},
            "films are left out of opaque nonmetals",
        ),
        (clear(roughnessFactor=0.5), "thin clear materials are smooth here, whatever their roughness"),
        (
            {"extensions": {"KHR_materials_ior": {"ior": 1.8}}},
            "the ior is left out of opaque materials that are metallic",
        ),
    ],
)
def test_what_is_not_shown_is_told_once(tmp_path, material, told):
    writer = Writer()
    writer.node(mesh=writer.mesh(material))
    writer.node(mesh=writer.mesh(material))
    path = tmp_path / "file.glb"
    path.write_bytes(writer.glb())
    with pytest.warns(RuntimeWarning) as caught:
        read_gltf(path)
    assert [str(one.message) for one in caught] == [f"file.glb: {told}"]


@pytest.mark.parametrize("pictured", [False, True])
def test_specular_and_glossy_materials_become_metallic_and_rough(tmp_path, pictured):
    """What reflects 4 % is no metal, and what is black but for its specular color is one."""

    def model(diffuse, specular):
        writer = Writer()
        told = {"diffuseFactor": [*diffuse, 1], "specularFactor": specular, "glossinessFactor": 0.75}
        if pictured:
            told["diffuseTexture"] = writer.picture(png(np.full((2, 2, 3), 255, np.uint8)))
        material = {"extensions": {"KHR_materials_pbrSpecularGlossiness": told}}
        writer.json["extensionsRequired"] = ["KHR_materials_pbrSpecularGlossiness"]
        made = loaded(tmp_path, material, writer).material
        ends = [made.base_color, made.metallic, made.roughness]
        if pictured:
            # 8-bit pictures: sRGB for color, linear shares in the other.
            low, high = zip(*(one.range for one in ends), strict=True)
            assert low == high
            ends = [low[0], low[1][0], low[2][0]]
        assert ends[2] == pytest.approx(0.25, abs=1 / 255)
        return ends[0], ends[1]

    color, metallic = model([0.5, 0.25, 0.75], [0.04, 0.04, 0.04])
    assert (color, metallic) == (pytest.approx((0.5, 0.25, 0.75), abs=0.01), pytest.approx(0, abs=0.01))
    color, metallic = model([0, 0, 0], [0.8, 0.6, 0.4])
    assert (color, metallic) == (pytest.approx((0.8, 0.6, 0.4), abs=0.01), pytest.approx(1, abs=0.01))


def test_extensions_that_may_be_left_out_are_named(tmp_path):
    writer = Writer()
    writer.json["extensionsUsed"] = ["KHR_materials_sheen", "KHR_materials_ior", "KHR_materials_clearcoat"]
    told = "its extensions KHR_materials_clearcoat, KHR_materials_sheen are left out"
    loaded(tmp_path, {}, writer, told)


def test_colors_of_vertices_tint_the_base_color(tmp_path):
    half = np.tile(np.float32([0.5, 1, 0.25]), (len(SQUARE), 1))
    mesh = loaded(tmp_path, {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1]}}, COLOR_0=half)
    assert mesh.material == rw.MetallicRough(rw.textures.ProductTexture(rw.VertexColors(), (1, 0.5, 1)), 1, 1)
    assert np.array_equal(mesh.colors, half)


def shown_alpha(mesh, places):
    """How much of a mesh is there at (x, y): what it hides of an environment of 1, seen along -z."""
    scene = rw.Scene(mesh, environment=1.0)
    found = []
    for x, y in places:
        camera = rw.Camera((x, y, 1), (x, y, 0), fov=0.01, width=1, height=1)
        image = rw.render(scene, camera, rw.Path(max_depth=4), samples=4096, seed=1)
        found.append(1 - float(image.rgb[0, 0, 0]))
    return np.array(found)


BLACK = {"baseColorFactor": [0, 0, 0, 1]}
UNLIT = {"extensions": {"KHR_materials_unlit": {}}}
TOLD_UNLIT = "unlit materials are matte here"
PLACES = [(0.2, 0.3), (0.6, 0.3), (0.9, 0.8)]


@pytest.mark.parametrize("mode", ["RGB", "L"])
@pytest.mark.parametrize("alpha", ["MASK", "BLEND"])
def test_transparent_colors_of_pictures_are_holes(tmp_path, mode, alpha):
    picture = Image.new(mode, (2, 1))
    picture.putpixel((1, 0), 255 if mode == "L" else (255, 0, 0))
    stream = io.BytesIO()
    picture.save(stream, "PNG", transparency=255 if mode == "L" else (255, 0, 0))
    writer = Writer()
    info = writer.picture(stream.getvalue())
    writer.json["samplers"] = [{"magFilter": 9728}]
    writer.json["textures"][0]["sampler"] = 0
    mesh = loaded(
        tmp_path,
        {"pbrMetallicRoughness": {"baseColorTexture": info}, "alphaMode": alpha, **UNLIT},
        writer,
        TOLD_UNLIT,
    )
    assert shown_alpha(mesh, PLACES) == pytest.approx([1, 0, 0], abs=1e-6)


@pytest.mark.parametrize(
    ("alpha", "factor", "mode", "wanted"),
    [
        ([0.25] * 4, 1.0, "BLEND", [0.25] * 3),
        ([0.5] * 4, 0.5, "BLEND", [0.25] * 3),
        ([0.25] * 4, 1.0, "MASK", [0, 0, 0]),
        ([0.75] * 4, 1.0, "MASK", [1, 1, 1]),
        ([0.75] * 4, 0.5, "MASK", [0, 0, 0]),
        ([0, 1, 1, 0], 1.0, "BLEND", [0.2, 0.6, 0.9]),
        ([0, 1, 1, 0], 0.5, "BLEND", [0.1, 0.3, 0.45]),
        ([0, 1, 1, 0], 1.0, "MASK", [0, 1, 1]),
        ([0, 1, 1, 0], 0.75, "MASK", [0, 0, 1]),
        ([0, 1, 1, 0], 1.0, "OPAQUE", [1, 1, 1]),
    ],
)
@pytest.mark.parametrize("colors", ["one", "many"])
def test_alpha_of_colors_of_vertices(tmp_path, alpha, factor, mode, wanted, colors):
    rgb = np.zeros((4, 3))
    if colors == "many":
        # A channel without meaning.
        rgb[:, 2] = 0, 0.25, 0.5, 1
    vertex = np.column_stack([rgb, alpha]).astype(np.float32)
    material = {"pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, factor]}, "alphaMode": mode, **UNLIT}
    mesh = loaded(tmp_path, material, None, TOLD_UNLIT, COLOR_0=vertex)
    # Means of 4,096 samples have a standard deviation of .0078 at most; six are exceeded once in 5e8.
    assert shown_alpha(mesh, PLACES) == pytest.approx(wanted, abs=0.047)
    if set(wanted) <= {0, 1}:
        assert shown_alpha(mesh, PLACES) == pytest.approx(wanted, abs=1e-6)


@pytest.mark.parametrize("rgb", [(1, 1, 1), (0.5, 0.25, 1)])
def test_alpha_of_vertices_and_of_pictures_is_multiplied(tmp_path, rgb):
    pixels = np.zeros((1, 2, 4), np.uint8)
    pixels[..., 3] = 255, 51
    writer = Writer()
    info = writer.picture(png(pixels))
    writer.json["samplers"] = [{"magFilter": 9728}]
    writer.json["textures"][0]["sampler"] = 0
    vertex = np.column_stack([np.tile(rgb, (4, 1)), [0, 1, 1, 0]]).astype(np.float32)
    material = {"pbrMetallicRoughness": {"baseColorTexture": info}, "alphaMode": "BLEND", **UNLIT}
    mesh = loaded(tmp_path, material, writer, TOLD_UNLIT, COLOR_0=vertex)
    assert shown_alpha(mesh, PLACES) == pytest.approx([0.2, 0.12, 0.18], abs=0.04)
