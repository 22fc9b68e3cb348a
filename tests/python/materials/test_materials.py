"""Materials: what they keep, what they refuse, and what they do to light."""

import dataclasses
import math
import pickle
from dataclasses import FrozenInstanceError

import numpy as np
import pytest
import trimesh
from PIL import Image
from trimesh.visual.material import PBRMaterial, SimpleMaterial

import raywright as rw

GRAY = rw.Diffuse(0.5)
MATERIALS = [
    rw.Diffuse((0.1, 0.2, 0.3)),
    rw.Diffuse(rw.Checker()),
    rw.materials.OrenNayar(0.7, rw.textures.Noise()),
    rw.Mirror(0.9),
    rw.Conductor("gold", roughness=0.3),
    rw.Conductor(eta=0.2, k=(3, 4, 5), alpha=(0.1, 0.4)),
    rw.Dielectric(1.33, priority=2),
    rw.ThinDielectric(),
    rw.Plastic(0.6, roughness=rw.Checker(0.1, 0.5)),
    rw.materials.Phong(0.5, 0.3, 20, ambient=0.1),
    rw.materials.BlinnPhong((0.5, 0.1, 0.1)),
    rw.MetallicRough(rw.Checker(), 0.5, rw.textures.Noise(0.2, 0.4)),
    rw.Mix(GRAY, rw.Mirror(), rw.Checker(0, 1)),
    rw.Mask(GRAY, rw.textures.Stripes(0, 1)),
    rw.BumpMap(GRAY, rw.textures.FBm(), 0.1),
    rw.NormalMap(GRAY, rw.ImageTexture(np.full((2, 2, 3), 128, np.uint8), linear=True)),
    rw.TwoSided(GRAY, rw.Mirror()),
]


@pytest.mark.parametrize("material", MATERIALS, ids=lambda m: type(m).__name__)
def test_materials_pickle_compare_hash_and_print(material):
    back = pickle.loads(pickle.dumps(material))
    assert back == material
    assert hash(back) == hash(material)
    assert repr(back) == repr(material)
    assert repr(material).startswith(type(material).__name__ + "(")
    assert "\n" not in repr(material)
    assert [material == other for other in MATERIALS].count(True) == 1
    with pytest.raises(FrozenInstanceError):
        material.reflectance = 1


@pytest.mark.parametrize("material", MATERIALS, ids=lambda m: type(m).__name__)
def test_shapes_and_meshes_take_them(material, box):
    mesh = rw.Mesh(
        box.vertices, box.faces, uv=box.vertices[:, :2], material=material, emission=rw.Checker(0, 2)
    )
    sphere = rw.Sphere((5, 0, 0), material=material)
    scene = rw.Scene([mesh, sphere, rw.Instance(mesh, np.eye(4))])
    assert scene.shapes[0].material is scene.shapes[1].material is material
    assert scene.intersect((5, 0, 3), (0, 0, -1)).t == 2
    assert pickle.loads(pickle.dumps(scene)).shapes[0] == mesh


def test_metals_tell_what_was_measured():
    for name in rw.materials.metals():
        wavelengths, eta, k = rw.materials.metal_index(name)
        assert wavelengths.shape == eta.shape == k.shape
        assert (np.diff(wavelengths) > 0).all()
        assert min(eta.min(), k.min()) > 0
    gold = rw.materials.metal_index("Au")
    # Lynch and Hunter (1985), at 2 eV.
    at = np.abs(gold.wavelengths - 619.92).argmin()
    assert (gold.eta[at], gold.k[at]) == (0.194, 3.06)
    with pytest.raises(ValueError, match=r"metal must be one of silver, .*, got 'unobtainium'"):
        rw.materials.metal_index("unobtainium")
    with pytest.raises(TypeError, match="metal must be a name, got int"):
        rw.materials.metal_index(79)


def test_metals_have_names_and_symbols():
    assert {"gold", "silver", "copper", "aluminium"} <= set(rw.materials.metals())
    gold = rw.Conductor("gold")
    assert gold == rw.Conductor("Au") == rw.Conductor("GOLD") == dataclasses.replace(gold)
    assert (gold.metal, gold.eta, gold.k) == ("gold", None, None)
    constant = rw.Conductor(eta=0.2, k=(3, 4, 5))
    assert constant.metal is None
    assert constant == dataclasses.replace(constant) != gold
    assert gold.roughness == 0
    assert gold.alpha is None
    assert rw.Conductor("gold", alpha=0.25).roughness is None


@pytest.mark.parametrize(
    ("make", "error", "told"),
    [
        (
            lambda: rw.Diffuse(rw.Checker(0, 1.5)),
            ValueError,
            r"reflectance must be between 0 and 1, got a texture",
        ),
        (
            lambda: rw.materials.OrenNayar(0.5, -0.1),
            ValueError,
            r"roughness must be between 0 and 1, got -0.1",
        ),
        (lambda: rw.Mirror(math.nan), ValueError, r"reflectance must be finite, got nan"),
        (
            lambda: rw.Conductor("unobtainium"),
            ValueError,
            r"metal must be one of silver, .*, got 'unobtainium'",
        ),
        (lambda: rw.Conductor(), ValueError, r"metal must be given, or both eta and k"),
        (lambda: rw.Conductor("gold", k=3), ValueError, r"only one of metal and \(eta, k\)"),
        (lambda: rw.Conductor(eta=0, k=3), ValueError, r"eta must be greater than 0, got 0"),
        (lambda: rw.Conductor(eta=1, k=-3), ValueError, r"k must be at least 0, got -3"),
        (
            lambda: rw.Conductor("gold", roughness=0.1, alpha=0.1),
            ValueError,
            r"only one of roughness and alpha",
        ),
        (
            lambda: rw.Conductor("gold", alpha=(0.1, 2)),
            ValueError,
            r"alpha\[1\] must be between 0 and 1, got 2",
        ),
        (
            lambda: rw.Conductor("gold", alpha=(0.1, 0.2, 0.3)),
            ValueError,
            r"alpha must be one number or texture, or",
        ),
        (lambda: rw.Dielectric(0), ValueError, r"ior must be greater than 0, got 0"),
        (lambda: rw.Dielectric(math.nan), ValueError, r"ior must be finite, got nan"),
        (lambda: rw.Dielectric(roughness=-1), ValueError, r"roughness must be between 0 and 1, got -1"),
        (lambda: rw.Dielectric(alpha=(0.1, 0.2)), ValueError, r"alpha must be one number or texture, got"),
        (lambda: rw.Dielectric(priority=0.5), TypeError, r"priority must be an integer, got 0.5"),
        (lambda: rw.ThinDielectric(-1), ValueError, r"ior must be greater than 0, got -1"),
        (lambda: rw.Plastic(ior=0.9), ValueError, r"ior must be at least 1, got 0.9"),
        (
            lambda: rw.Plastic(roughness=(0.1, 0.2)),
            ValueError,
            r"roughness must be one number or texture, got",
        ),
        (
            lambda: rw.materials.Phong(0.7, 0.4),
            ValueError,
            r"diffuse and specular must add up to at most 1, got 1.1",
        ),
        (lambda: rw.materials.BlinnPhong(exponent=-1), ValueError, r"exponent must be at least 0, got -1"),
        (
            lambda: rw.MetallicRough(metallic=(0, 1)),
            ValueError,
            r"metallic must be a texture or one number, got",
        ),
        (lambda: rw.MetallicRough("red"), TypeError, r"base_color must be real numbers, got 'red'"),
        (lambda: rw.Mix(GRAY, 0.5), TypeError, r"b must be a raywright material, got float"),
        (lambda: rw.Mask(GRAY, 2), ValueError, r"opacity must be between 0 and 1, got 2"),
        (lambda: rw.BumpMap(GRAY, math.inf), ValueError, r"height must be finite, got inf"),
        (lambda: rw.NormalMap(GRAY, (0.5, 0.5, 2)), ValueError, r"normals must be between 0 and 1, got"),
        (lambda: rw.Sphere(material=0.5), TypeError, r"material must be a raywright material, got float"),
        (
            lambda: rw.Sphere(emission=rw.Checker(-1)),
            ValueError,
            r"emission must be at least 0, got a texture",
        ),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(make, error, told):
    with pytest.raises(error, match=told) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_sides_that_let_light_through_are_refused():
    scene = rw.Scene(rw.Sphere(material=rw.TwoSided(GRAY, rw.Dielectric())))
    with pytest.raises(ValueError, match="material of shape 0: back must not transmit light"):
        scene.intersect((0, 0, 3), (0, 0, -1))


def in_white_light(material) -> rw.Image:
    """A ball that fills the picture, in light of radiance 1 from everywhere."""
    camera = rw.Camera((0, 0, 10), (0, 0, 0), fov=8, width=8, height=8)
    scene = rw.Scene(rw.Sphere(material=material), environment=1)
    return rw.render(scene, camera, samples=256)


@pytest.mark.parametrize(
    ("material", "share"),
    [
        (rw.Diffuse(0.8), 0.8),
        (rw.materials.OrenNayar(1, 0.7), 1.0),
        (rw.Mirror((0.2, 0.5, 0.9)), (0.2, 0.5, 0.9)),
        (rw.Plastic(1.0, 1.5), 1.0),
        (rw.Plastic(1.0, 1.5, roughness=0.6), 1.0),
        (rw.MetallicRough(1.0, 1.0, 0.6), 1.0),
        (rw.MetallicRough(1.0, 0.0, 0.4), 1.0),
        (rw.Mix(rw.Diffuse(0.2), rw.Mirror(0.6), 0.25), 0.3),
        (rw.Mix(rw.Diffuse(0), rw.MetallicRough(1.0, 1.0, 0.5), 0.5), 0.5),
        (rw.TwoSided(rw.Diffuse(0.3), rw.Diffuse(0.9)), 0.3),
        (rw.NormalMap(rw.Diffuse(0.7), (0.5, 0.5, 1)), 0.7),
    ],
)
def test_a_ball_in_white_light_is_as_bright_as_it_reflects(material, share):
    image = in_white_light(material)
    mean = image.rgb.mean(axis=(0, 1))
    error = np.sqrt((image.standard_error.astype(float) ** 2).sum(axis=(0, 1))) / 64
    # 0.5 % for the energy compensation of rough materials; five standard errors are exceeded once in two
    # million.
    assert (np.abs(mean - share) <= 0.005 + 5 * error).all()
    assert (error < 0.01).all()


def loaded(material, **visual):
    box = trimesh.creation.box()
    box.visual = trimesh.visual.TextureVisuals(uv=np.zeros((8, 2)), material=material, **visual)
    return rw.Scene(box).shapes[0]


def picture(mode: str) -> Image.Image:
    return Image.fromarray(np.random.default_rng(1).integers(0, 255, (4, 4, 4), np.uint8), "RGBA").convert(
        mode
    )


def test_gltf_materials_are_loaded_whole():
    base, both, normals, glow = picture("RGBA"), picture("RGB"), picture("RGB"), picture("RGB")
    mesh = loaded(
        PBRMaterial(
            baseColorFactor=[255, 51, 255, 255],
            baseColorTexture=base,
            metallicRoughnessTexture=both,
            roughnessFactor=0.5,
            normalTexture=normals,
            emissiveFactor=[0.5, 1, 1],
            emissiveTexture=glow,
            alphaMode="MASK",
            alphaCutoff=0.25,
        )
    )
    mask = mesh.material
    assert isinstance(mask, rw.Mask)
    kept = np.asarray(base)[..., 3] / 255 >= 0.25
    assert np.array_equal(mask.opacity.image[..., 0] == 255, kept)
    assert mask.material.normals == rw.ImageTexture(np.asarray(normals), linear=True)
    model = mask.material.material
    assert model.base_color == rw.textures.ProductTexture(rw.ImageTexture(np.asarray(base)), (1, 0.2, 1))
    assert model.metallic == rw.ImageTexture(np.asarray(both), linear=True, channel="b")
    green = rw.ImageTexture(np.asarray(both), linear=True, channel="g")
    assert model.roughness == rw.textures.ProductTexture(green, 0.5)
    assert mesh.emission == rw.textures.ProductTexture(rw.ImageTexture(np.asarray(glow)), (0.5, 1, 1))
    assert rw.Scene(mesh).intersect((0, 0, 3), (0, 0, -1)).t == 2.5


def test_what_gltf_leaves_out_is_as_it_says():
    plain = loaded(PBRMaterial(baseColorFactor=[51, 0, 255, 255]))
    assert plain.material == rw.MetallicRough((0.2, 0, 1), 1, 1)
    assert plain.emission is None
    half = loaded(PBRMaterial(baseColorFactor=[255, 255, 255, 51], alphaMode="BLEND", metallicFactor=0.0))
    assert half.material == rw.Mask(rw.MetallicRough(1, 0, 1), 0.2)
    assert loaded(PBRMaterial()).material == rw.Diffuse()


def test_pictures_and_colors_of_vertices_are_loaded():
    shown = loaded(SimpleMaterial(image=picture("RGB")))
    assert shown.material == rw.Diffuse(rw.ImageTexture(np.asarray(picture("RGB"))))
    box = trimesh.creation.box()
    colors = np.tile([[188, 0, 255, 255], [10, 255, 0, 255]], (4, 1)).astype(np.uint8)
    box.visual = trimesh.visual.ColorVisuals(box, vertex_colors=colors)
    mesh = rw.Scene(box).shapes[0]
    assert mesh.material == rw.Diffuse(rw.VertexColors())
    assert mesh.colors[:2] == pytest.approx(np.array([(0.502886, 0, 1), (0.003035, 1, 0)]), abs=1e-6)


ROUGH = [rw.Conductor, rw.Dielectric, rw.Plastic]


def of_facets(kind, **facets):
    return rw.Conductor("Au", alpha=0.3, **facets) if kind is rw.Conductor else kind(alpha=0.3, **facets)


@pytest.mark.parametrize("kind", ROUGH)
def test_facets_are_told_and_checked(kind):
    told = of_facets(kind, distribution="beckmann", multiple_scattering=False)
    assert (told.distribution, told.multiple_scattering) == ("beckmann", False)
    assert of_facets(kind) == of_facets(kind, distribution="ggx", multiple_scattering=True) != told
    assert pickle.loads(pickle.dumps(told)) == told
    with pytest.raises(ValueError, match="distribution must be one of 'ggx', 'beckmann', got 'phong'"):
        of_facets(kind, distribution="phong")
    with pytest.raises(TypeError, match="multiple_scattering must be True or False, got 1"):
        of_facets(kind, multiple_scattering=1)
    assert of_facets(kind, distribution="beckmann").multiple_scattering is True


def test_highlights_are_those_of_the_distribution():
    """At the mirror's angle and beside it: D F G2 / (4 cos cos) of both (Walter et al., 2007)."""
    alpha, tilt = 0.2, np.radians(20)

    def lit(distribution, slope):
        # From straight above; the half vector of the light has this slope.
        half = np.arctan(slope)
        way = np.array((np.sin(2 * half), 0, np.cos(2 * half)))
        metal = rw.Conductor(
            eta=1e-9, k=1e9, alpha=alpha, distribution=distribution, multiple_scattering=False
        )
        plate = rw.Disk((0, 0, 0), (0, 0, 1), 1, material=metal)
        scene = rw.Scene(plate, lights=[rw.DirectionalLight(-way, 1.0)])
        camera = rw.Orthographic((0, 0, 5), (0, 0, 0), up=(0, 1, 0), scale=0.01, width=1, height=1)
        return float(rw.render(scene, camera, rw.Path(max_depth=1), samples=1, progress=False).rgb[0, 0, 0])

    def expected(distribution, slope):
        half = np.arctan(slope)
        cosine = np.cos(2 * half)
        a = 1 / (alpha * np.tan(2 * half)) if slope else np.inf
        if distribution == "ggx":
            density = 1 / (np.pi * alpha**2 * np.cos(half) ** 4 * (1 + (slope / alpha) ** 2) ** 2)
            hidden = (np.sqrt(1 + 1 / a**2) - 1) / 2
        else:
            density = np.exp(-((slope / alpha) ** 2)) / (np.pi * alpha**2 * np.cos(half) ** 4)
            hidden = (math.erf(a) - 1) / 2 + np.exp(-(a**2)) / (2 * a * np.sqrt(np.pi)) if slope else 0.0
        return density / (1 + hidden) / (4 * cosine) * cosine

    for distribution in ("ggx", "beckmann"):
        for slope in (0.0, 0.1, 0.3, np.tan(tilt)):
            seen, truth = lit(distribution, slope), expected(distribution, slope)
            assert seen == pytest.approx(truth, rel=1e-5), (distribution, slope)
