"""Materials of OBJ files, against what the format says of them and what is seen."""

import math

import numpy as np
import pytest
import trimesh
from obj_files import FACE, SQUARE, loaded, material, picture, write

import raywright as rw

LEFT_OUT = "file.mtl: what is not shown here is left out: "
PIXELS = np.random.default_rng(1).integers(0, 256, (4, 4, 4), np.uint8)
# It looks straight down at the middle of the square.
ABOVE = rw.Camera((0.5, 0.5, 2), (0.5, 0.5, 0), fov=10, width=8, height=8)


def seen(shapes, camera=ABOVE, samples=1, **more):
    return rw.render(rw.Scene(shapes, **more), camera, samples=samples, progress=False).rgb


def scattered(mesh, incoming, outgoing):
    """The scattering function of a mesh at (0.5, 0.5, 0), without its cosine: (N, 3)."""
    point = np.array((0.5, 0.5, 0.0))
    rays = rw.query.Rays(point + 2 * outgoing, -outgoing, np.zeros(len(outgoing)))
    return rw.Scene(mesh).interactions(rays).evaluate(incoming)[0] / incoming[:, 2:]


def upward(count, seed=0):
    ways = np.random.default_rng(seed).normal(size=(count, 3))
    ways[:, 2] = np.abs(ways[:, 2]) + 0.05
    return ways / np.linalg.norm(ways, axis=1, keepdims=True)


def test_a_lamp_shines_with_its_radiance_to_both_sides(tmp_path):
    mesh = loaded(write(tmp_path, "Kd 0 0 0\nKe 17 12.5 4"))
    for z in (2, -2):
        camera = rw.Camera((0.5, 0.5, z), (0.5, 0.5, 0), fov=10, width=8, height=8)
        assert np.array_equal(seen(mesh, camera), np.broadcast_to(np.float32((17, 12.5, 4)), (8, 8, 3)))


def test_a_picture_of_what_shines_is_multiplied(tmp_path):
    pixels = picture(tmp_path, "glow.png", PIXELS[..., :3])
    glow = rw.ImageTexture(pixels)
    both = loaded(write(tmp_path, "Ke 2 3 4\nmap_Ke glow.png"))
    assert both.emission == rw.Emission(rw.textures.ProductTexture(glow, (2, 3, 4)), both_sides=True)
    # Programs write black beside a picture.
    for statements in ("map_Ke glow.png", "Ke 0 0 0\nmap_Ke glow.png"):
        assert loaded(write(tmp_path, statements)).emission == rw.Emission(glow, both_sides=True)
    assert loaded(write(tmp_path, "Ke 0 0 0")).emission is None
    # The top left of the picture is at v = 1.
    camera = rw.Camera((0.125, 0.875, 2), (0.125, 0.875, 0), fov=1, width=2, height=2)
    plain = loaded(write(tmp_path, "Kd 0 0 0\nmap_Ke glow.png"))
    share = pixels[0, 0] / 255
    expected = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    assert seen(plain, camera)[0, 0] == pytest.approx(expected, rel=0.05, abs=0.02)


def test_what_shines_may_be_brighter_than_white_in_pictures_too(tmp_path):
    np.save(tmp_path / "glow.npy", np.full((2, 2, 3), (5.0, 6.0, 7.0), np.float32))
    mesh = loaded(write(tmp_path, "Kd 0 0 0\nKe 2 2 2\nmap_Ke glow.npy"))
    assert np.allclose(seen(mesh), (10, 12, 14), rtol=1e-6, atol=0)


def test_colors_are_linear(tmp_path):
    assert material(tmp_path, "Kd 0.2 0.5 0.8") == rw.Diffuse((0.2, 0.5, 0.8))
    assert material(tmp_path, "kd 0.25") == rw.Diffuse(0.25)
    assert material(tmp_path, "") == rw.Diffuse()
    pixels = picture(tmp_path, "base color.png", PIXELS[..., :3])
    # As in Blender and trimesh: most programs write black or gray beside a picture.
    for color in ("", "Kd 0 0 0\n", "Kd 0.8 0.8 0.8\n"):
        assert material(tmp_path, f"{color}map_Kd base color.png") == rw.Diffuse(rw.ImageTexture(pixels))


@pytest.mark.parametrize(("exponent", "specular"), [(1.5, 0.4), (10, 1.0), (96, 0.5), (1000, 0.9)])
def test_highlights_are_those_of_the_format(tmp_path, exponent, specular):
    """(Kd + Ks cos(h)^Ns) / pi, where h is between the normal and halfway from light to eye (Blinn, 1977)."""
    mesh = loaded(write(tmp_path, f"Kd 0.1 0.2 0.3\nKs {specular} {specular / 2} 0\nNs {exponent}\nillum 2"))
    incoming, outgoing = upward(200), upward(200, 1)
    # Half of them near the mirror direction.
    incoming[::2] = outgoing[::2] * (-1, -1, 1) + 0.1 * incoming[::2]
    incoming /= np.linalg.norm(incoming, axis=1, keepdims=True)
    half = incoming + outgoing
    cosine = half[:, 2] / np.linalg.norm(half, axis=1)
    lobe = np.array((specular, specular / 2, 0)) * (cosine**exponent)[:, None]
    expected = (np.array((0.1, 0.2, 0.3)) + lobe) / math.pi
    assert scattered(mesh, incoming, outgoing) == pytest.approx(expected, rel=2e-4, abs=1e-6)


@pytest.mark.parametrize("exponent", [2, 5, 50])
@pytest.mark.parametrize("picture_of", [None, "map_Kd", "map_Ks", "map_Ns"])
def test_no_more_is_reflected_than_comes(tmp_path, exponent, picture_of):
    """Where Kd and Ks are 1, in an even light of 1, whatever the direction."""
    picture(tmp_path, "white.png", np.full((4, 4, 3), 255))
    more = f"{picture_of} white.png" if picture_of else ""
    mesh = loaded(write(tmp_path, f"Kd 1 1 1\nKs 1 1 1\nNs {exponent}\n{more}"))
    for eye in ((0.5, 0.5, 2), (2.5, 0.5, 0.5)):
        camera = rw.Camera(eye, (0.5, 0.5, 0), (0.1, 0, 1), fov=2, width=8, height=8)
        image = rw.render(rw.Scene(mesh, environment=1.0), camera, samples=128, progress=False)
        error = np.sqrt((image.standard_error[..., 0] ** 2).sum()) / 64
        # One in ten thousand such means is farther off.
        assert 0.3 < image.rgb[..., 0].mean() < 1 + 4 * error


def test_what_has_no_highlights(tmp_path):
    matt = rw.Diffuse((0.6, 0.7, 0.8))
    kd = "Kd 0.6 0.7 0.8\n"
    # By its illum, by an exponent as trimesh and MeshLab write it, or because it is black.
    for rest in (
        "Ks 1 1 1\nNs 50\nillum 1",
        "Ks 1 1 1\nNs 50\nillum 0",
        "Ka 0.4 0.4 0.4\nKs 0.4 0.4 0.4\nNs 1.00000000",
        "Ks 1 1 1\nillum 2\nNs 0.000000",
        "Ks 0 0 0\nNs 90\nillum 2",
    ):
        assert material(tmp_path, kd + rest) == matt
    assert material(tmp_path, f"{kd}Ks 1 1 1", f"{LEFT_OUT}Ks without Ns of 'it'") == matt


def test_pictures_of_highlights(tmp_path):
    strong = rw.ImageTexture(picture(tmp_path, "strong.png", PIXELS[..., :3]))
    model = material(tmp_path, "Kd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 30\nmap_Ks strong.png")
    (share,) = {8 * (2**-15 + 30) / (32 * 34)}
    assert model.exponent == 30
    assert model.specular.a == strong
    assert model.specular.b == pytest.approx((share,) * 3)
    sharp = picture(tmp_path, "sharp.png", PIXELS[..., 0])
    model = material(tmp_path, "Kd 0.2 0.2 0.2\nKs 0.5 0.5 0.5\nNs 30\nmap_Ns sharp.png")
    assert model.exponent == rw.textures.ProductTexture(rw.ImageTexture(sharp, linear=True), 30.0)
    n = 30 * (sharp / 255)
    assert model.specular.a.image == pytest.approx(8 * (2 ** (-n / 2) + n) / ((n + 2) * (n + 4)), rel=1e-6)
    assert model.specular.b == (0.5, 0.5, 0.5)


def test_what_is_not_all_there_is_seen_through(tmp_path):
    mesh = loaded(write(tmp_path, "Kd 0 0 0\nd 0.3"))
    image = seen(mesh, samples=256, environment=(1, 2, 3))
    # The mean of 16384 draws: one in ten thousand such is farther off.
    error = 4 * math.sqrt(0.3 * 0.7 / (64 * 256))
    assert image.mean(axis=(0, 1)) / (1, 2, 3) == pytest.approx(0.7, abs=error)


@pytest.mark.parametrize("illum", ["", "illum 1", "illum 2", "illum 4\nNi 1.000000", "illum 9\nNi 1.45"])
def test_how_much_is_there(tmp_path, illum):
    matt = rw.Diffuse(0.25)
    for statement in ("d 0.25", "Tr 0.75", "d 0.25\nTr 0", "Tr 1\nd 0.25"):
        assert material(tmp_path, f"Kd 0.25 0.25 0.25\n{statement}\n{illum}") == rw.Mask(matt, 0.25)
    # MeshLab wrote Tr 1 for opaque materials.
    for statement in ("d 1", "Tr 0", "Tr 1.000000"):
        assert material(tmp_path, f"Kd 0.25 0.25 0.25\n{statement}\n{illum}") == matt
    told = f"{LEFT_OUT}d -halo of 'it'"
    assert material(tmp_path, f"Kd 0.25 0.25 0.25\nd -halo 0.5\n{illum}", told) == matt


def test_pictures_of_holes(tmp_path):
    leaf = picture(tmp_path, "leaf.png", PIXELS)
    both = material(tmp_path, "Kd 1 1 1\nmap_Kd leaf.png\nmap_d leaf.png\nd 0.5")
    assert both.material == rw.Diffuse(rw.ImageTexture(leaf))
    assert both.opacity == rw.textures.ProductTexture(rw.ImageTexture(leaf, linear=True, channel="a"), 0.5)
    # Without alpha, or with full alpha, brightness decides.
    full = picture(tmp_path, "full.png", np.dstack([PIXELS[..., :3], np.full((4, 4), 255)]))
    gray = picture(tmp_path, "gray.png", PIXELS[..., 0])
    for name, pixels in (("full.png", full), ("gray.png", gray)):
        assert material(tmp_path, f"map_d {name}").opacity == rw.ImageTexture(pixels, linear=True)


def slab(tmp_path, statements, lamp):
    """A slab of unit thickness, and a strip of light under it about x = lamp."""
    box = trimesh.creation.box((20, 20, 1))
    points = [f"v {x} {y} {z - 0.5}" for x, y, z in box.vertices]
    points += [
        f"v {x} {y} -1.001"
        for x, y in ((lamp - 0.01, -1), (lamp + 0.01, -1), (lamp + 0.01, 1), (lamp - 0.01, 1))
    ]
    faces = [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in box.faces]
    (tmp_path / "file.mtl").write_text(f"newmtl it\n{statements}\nnewmtl lamp\nKd 0 0 0\nKe 1 1 1\n")
    text = "\n".join(["mtllib file.mtl", *points, "usemtl it", *faces, "usemtl lamp", "f 9 10 11 12"])
    (tmp_path / "file.obj").write_text(text)
    return rw.Scene(tmp_path / "file.obj")


@pytest.mark.parametrize(
    ("statements", "ior"), [("illum 7\nNi 1.5", 1.5), ("illum 6\nNi 1.33\nd 0.2\nTf 1 1 1", 1.33)]
)
def test_glass_bends_light_by_the_law_of_snell(tmp_path, statements, ior):
    """A ray that comes at 45 degrees leaves the slab where sin(t) = sin(45) / ior takes it."""
    sine = math.sqrt(0.5) / ior
    cosine = math.sqrt(1 - sine**2)
    exit_at = sine / cosine + 0.001
    camera = rw.Camera((-1, 0, 1), (0, 0, 0), (0, 1, 0), fov=0.1, width=4, height=4)
    # Each of the two surfaces transmits by Fresnel's equations.
    c = math.sqrt(0.5)
    parallel, across = (ior * c - cosine) / (ior * c + cosine), (c - ior * cosine) / (c + ior * cosine)
    through = (1 - (parallel**2 + across**2) / 2) ** 2
    scene = slab(tmp_path, statements, exit_at)
    image = rw.render(scene, camera, samples=1024, progress=False)
    # Light that no surface reflects passes, in this share of 16384 draws; 4 standard errors.
    error = 4 * math.sqrt(through * (1 - through) / (16 * 1024))
    assert image.rgb.mean() == pytest.approx(through, abs=error)
    # With an index near 1, the slab is invisible.
    assert not rw.render(slab(tmp_path, statements, 1.001), camera, samples=16, progress=False).rgb.any()


def test_what_bends_light_and_what_does_not(tmp_path):
    kd, matt = "Kd 0.5 0.5 0.5\n", rw.Diffuse(0.5)
    assert material(tmp_path, f"{kd}illum 7\nNi 1.5\nKs 1 1 1\nNs 200") == rw.Dielectric(1.5, 0.0)
    assert material(tmp_path, f"{kd}illum 7\nNi 1.5\nPr 0.3") == rw.Dielectric(1.5, 0.3)
    # Files of Cinema 4D, which writes 7 for all; of 3ds Max, which writes Ni for all; and opaque by its
    # filter.
    assert material(tmp_path, f"{kd}illum 7") == matt
    assert material(tmp_path, f"{kd}Ni 1.5\nillum 2\nTf 1 1 1\nd 1\nTr 0") == matt
    assert material(tmp_path, f"{kd}Ni 1.5\nillum 7\nTf 0 0 0") == matt
    tinted = f"{LEFT_OUT}Tf of 'it'"
    assert material(tmp_path, f"{kd}Ni 1.5\nillum 7\nTf 1 0.5 0.5", tinted) == rw.Dielectric(1.5, 0.0)


def test_a_pane_is_glass_where_it_is_not_there(tmp_path):
    pane = material(tmp_path, "Kd 0.5 0.5 0.5\nd 0.25\nNi 1.5\nillum 4")
    assert pane == rw.Mix(rw.Diffuse(0.5), rw.ThinDielectric(1.5), 0.75)
    holes = rw.ImageTexture(picture(tmp_path, "holes.png", PIXELS[..., 0]), linear=True)
    pane = material(tmp_path, "Kd 0.5 0.5 0.5\nmap_d holes.png\nNi 1.5\nillum 4")
    assert pane == rw.Mix(rw.Diffuse(0.5), rw.ThinDielectric(1.5), rw.textures.MixTexture(1.0, 0.0, holes))
    # As Maya writes all opaque materials.
    maya = "illum 4\nKd 0.50 0.50 0.50\nKa 0.00 0.00 0.00\nTf 1.00 1.00 1.00\nNi 1.00"
    assert material(tmp_path, maya) == rw.Diffuse(0.5)


def test_mirrors(tmp_path):
    assert material(tmp_path, "illum 3\nKs 0.9 0.8 0.45") == rw.Mix(
        rw.Diffuse(0.0), rw.Mirror((1, 0.8 / 0.9, 0.5)), 0.9
    )
    assert material(tmp_path, "illum 3\nKs 1 1 1\nNs 10\nKd 0.5 0.5 0.5") == rw.Mirror(1.0)
    assert material(tmp_path, "illum 5\nKs 1 0.5 0.25") == rw.MetallicRough((1, 0.5, 0.25), 1.0, 0.0)
    assert material(tmp_path, "illum 3\nKs 0 0 0\nKd 0.5 0.5 0.5") == rw.Diffuse(0.5)
    # Under an even light of 1: Kd plus Ks, but no more than arrives.
    for kd, expected in ((0.25, 0.75), (0.5, 1.0), (0.9, 1.0)):
        mesh = loaded(write(tmp_path, f"illum 3\nKs 0.5 0.5 0.5\nKd {kd} {kd} {kd}"))
        image = rw.render(rw.Scene(mesh, environment=1.0), ABOVE, samples=128, progress=False)
        error = np.sqrt((image.standard_error[..., 0] ** 2).sum()) / 64
        assert image.rgb.mean() == pytest.approx(expected, abs=float(4 * error) + 1e-5)
    shares = rw.ImageTexture(picture(tmp_path, "shares.png", PIXELS[..., :3]))
    mixed = rw.Mix(rw.Diffuse(0.25), rw.Mirror(1.0), shares)
    assert material(tmp_path, "illum 3\nmap_Ks shares.png\nKd 0.25 0.25 0.25") == mixed


def test_statements_for_physically_based_rendering(tmp_path):
    kd = "Kd 0.2 0.4 0.6\nKs 0.5 0.5 0.5\nNs 98\n"
    base = (0.2, 0.4, 0.6)
    assert material(tmp_path, f"{kd}Pr 0.3\nPm 0.7") == rw.MetallicRough(base, 0.7, 0.3)
    assert material(tmp_path, f"{kd}Pr 0.3\nPs 0\nPc 0\nPcr 0.03\naniso 0\nanisor 0") == rw.MetallicRough(
        base, 0, 0.3
    )
    told = f"{LEFT_OUT}Pc of 'it', Pcr of 'it'"
    assert material(tmp_path, f"{kd}Pm 1\nPc 1\nPcr 0.03", told) == rw.MetallicRough(base, 1, 0.02**0.25)
    rough, metal = (
        picture(tmp_path, f"{name}.png", PIXELS[..., i]) for i, name in enumerate(("rough", "metal"))
    )
    model = material(tmp_path, f"{kd}Pr 0.5\nPm 0.5\nmap_Pr rough.png\nmap_Pm metal.png")
    pictures = rw.ImageTexture(metal, linear=True), rw.ImageTexture(rough, linear=True)
    assert model == rw.MetallicRough(base, *pictures)


def test_what_blender_writes_is_read_as_it_is_meant(tmp_path):
    """Ns is 1000 (1 - roughness)^2, or 900 of its first exporter; Ka is metalness where illum is 3."""
    new, old = "# Blender 3.6.0 MTL File: 'x.blend'\n", "# Blender MTL File: 'x.blend'\n# Material Count: 1\n"
    plain = "Ns 250.000000\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nKe 0 0 0\nNi 1.45\nd 1.0\n"
    assert material(tmp_path, f"{plain}illum 2", head=new) == rw.MetallicRough(0.8, 0.0, 0.5)
    metal = "Ns 360\nKa 0.9 0.9 0.9\nKd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nd 1\nillum 3"
    model = material(tmp_path, metal, head=new)
    assert model.base_color == (0.9, 0.6, 0.2)
    assert (model.metallic, model.roughness) == (pytest.approx(0.9), pytest.approx(0.4))
    assert material(
        tmp_path, "Ns 225\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nillum 2", head=old
    ) == rw.MetallicRough(0.8, 0.0, 0.5)
    clear = material(tmp_path, "Ns 250\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1.45\nd 0.25\nillum 9", head=new)
    assert clear == rw.Mask(rw.MetallicRough(0.8, 0.0, 0.5), 0.25)
    assert material(tmp_path, "Ns 0\nKd 0.8 0.8 0.8\nKs 0 0 0\nillum 1", head=new) == rw.Diffuse(0.8)
    rough, metal = (
        picture(tmp_path, f"{name}.png", PIXELS[..., i]) for i, name in enumerate(("rough", "metal"))
    )
    model = material(tmp_path, f"{plain}illum 3\nmap_Ns rough.png\nmap_refl metal.png", head=new)
    pictures = rw.ImageTexture(metal, linear=True), rw.ImageTexture(rough, linear=True)
    assert model == rw.MetallicRough(0.8, *pictures)


def test_normals_and_bumps(tmp_path):
    flat = np.full((4, 4, 3), (128, 128, 255)) + np.random.default_rng(2).integers(-20, 1, (4, 4, 3))
    normals = rw.ImageTexture(picture(tmp_path, "normals.png", flat), linear=True)
    heights = rw.ImageTexture(picture(tmp_path, "heights.png", PIXELS[..., 0]), linear=True)
    matt = rw.Diffuse(0.5)
    assert material(tmp_path, "norm normals.png") == rw.NormalMap(matt, normals, 1.0)
    # Blender and others write normal maps in place of height maps.
    for keyword in ("map_Bump", "bump", "map_bump"):
        assert material(tmp_path, f"{keyword} -bm 0.5 normals.png") == rw.NormalMap(matt, normals, 0.5)
        assert material(tmp_path, f"{keyword} -bm 0.5 heights.png") == rw.BumpMap(matt, heights, 0.005)
    # Heights are a hundredth of the picture's width, however large the mesh and however often it is repeated.
    large = SQUARE.replace("v 1 0 0", "v 8 0 0").replace("v 1 1 0", "v 8 8 0").replace("v 0 1 0", "v 0 8 0")
    assert loaded(write(tmp_path, "bump heights.png", large)).material == rw.BumpMap(matt, heights, 0.08)
    twice = loaded(write(tmp_path, "bump -s 2 2 2 heights.png", large)).material
    assert (twice.scale, twice.height.transform) == (pytest.approx(0.04), rw.textures.UvTransform(2))


def test_bumps_look_the_same_at_any_size(tmp_path):
    picture(tmp_path, "heights.png", PIXELS[..., 0])
    pictures = []
    for size in (1, 1024):
        points = "".join(
            f"v {x * size} {y * size} 0\nvt {x} {y}\n" for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))
        )
        mesh = loaded(write(tmp_path, "Kd 0.5 0.5 0.5\nbump -bm 30 heights.png", points))
        camera = rw.Camera(
            (0.5 * size, 0.5 * size, size), (0.5 * size, 0.5 * size, 0), fov=50, width=16, height=16
        )
        light = rw.DirectionalLight((1, 0, -1), 1.0)
        pictures.append(rw.render(rw.Scene(mesh, light), camera, samples=4, progress=False).rgb)
    assert pictures[0].std() > 0.01
    assert np.allclose(*pictures, rtol=1e-4, atol=1e-5)


def test_options_of_pictures(tmp_path):
    pixels = picture(tmp_path, "a b.png", PIXELS)

    def texture(options, *told):
        return material(tmp_path, f"map_Kd {options} a b.png", *told).reflectance

    def placed(**more):
        return rw.ImageTexture(pixels, **more)

    assert texture("-s 2 3 1 -o 0.5 0.25 0") == placed(
        transform=rw.textures.UvTransform((2, 3), offset=(0.5, 0.25))
    )
    assert texture("-s 2") == placed(transform=rw.textures.UvTransform((2, 1)))
    assert texture("-s 1 1 1 -o 0 0 0 -mm 0 1 -blendu on -cc off -t 0 0 0 -clamp off") == placed()
    assert texture("-clamp on") == placed(wrap="clamp")
    told = f"{LEFT_OUT}-boost of map_Kd of 'it', -mm of map_Kd of 'it'"
    assert texture("-boost 2 -mm 0.5 1", told) == placed()
    broken = "file.mtl: what cannot be read is left out: '-s nan 1e300' of 'it'"
    assert texture("-s nan 1e300", broken) == placed()
    # A name that begins like a number.
    (tmp_path / "2").write_bytes((tmp_path / "a b.png").read_bytes())
    assert material(tmp_path, "map_Kd -o 1 1 2").reflectance == placed(
        transform=rw.textures.UvTransform(offset=(1, 1))
    )
    for letter, channel in (("r", "r"), ("g", "g"), ("b", "b"), ("m", "a"), ("l", None)):
        opacity = material(tmp_path, f"map_d -imfchan {letter} a b.png").opacity
        assert opacity == placed(linear=True, channel=channel or "a")


def test_pictures_of_other_machines_are_found_by_their_last_name(tmp_path):
    (tmp_path / "maps").mkdir()
    pixels = picture(tmp_path, "maps/a.png", PIXELS[..., :3])
    found = rw.Diffuse(rw.ImageTexture(pixels))
    assert material(tmp_path, "map_Kd maps\\a.png") == found
    assert material(tmp_path, 'map_Kd "maps/a.png"') == found
    picture(tmp_path, "a.png", PIXELS[..., :3])
    assert material(tmp_path, "map_Kd C:\\Users\\somebody\\a.png") == found
    assert material(tmp_path, "map_Kd ../../a.png") == found


def test_pictures_that_cannot_be_shown_are_told(tmp_path):
    kd, matt = "Kd 0.25 0.25 0.25\n", rw.Diffuse(0.25)
    lost = "file.mtl: pictures are left out: "
    (tmp_path / "noise.png").write_bytes(bytes(range(256)))
    np.save(tmp_path / "many.npy", np.zeros((2, 2, 7), np.float32))
    for name, why in (
        ("gone.png", "it is not beside the file"),
        ("/etc/hostname", "it is not beside the file"),
        ("", "it is not beside the file"),
        ("noise.png", "it is not a picture that Pillow knows"),
        ("many.npy", "it has shape (2, 2, 7"),
    ):
        assert material(tmp_path, f"{kd}map_Kd {name}", f"{lost}{name!r} ({why}) of 'it'") == matt
    picture(tmp_path, "a.png", PIXELS)
    bare = write(tmp_path, f"{kd}map_Kd a.png", faces="f 1 2 3 4\n")
    told = "file.mtl: pictures are left out where there are no texture coordinates: map_Kd of 'it'"
    assert loaded(bare, told).material == matt


def test_each_thing_that_is_not_shown_is_told_once(tmp_path):
    text = "newmtl a\nfoo 1\ndisp x.png\nKe nan 0 0\nKd 2 0 0\nnewmtl b\nfoo 2\nbar\nnewmtl unused\nbaz\n"
    (tmp_path / "file.mtl").write_text(text)
    faces = "usemtl a\nf 1 2 3\nusemtl b\nf 1 3 4\nusemtl a\nf 2 3 4\nusemtl c\nf 1 2 4\n"
    (tmp_path / "file.obj").write_text(f"mtllib file.mtl gone.mtl\n{SQUARE}{faces}mtllib file.mtl gone.mtl\n")
    with pytest.warns(RuntimeWarning) as caught:
        rw.Scene(tmp_path / "file.obj")
    assert sorted(str(one.message) for one in caught) == [
        "file.mtl: numbers out of range are moved into it: 'Kd 2 2 2' of 'a'".replace("2 2 2", "2 0 0"),
        "file.mtl: what cannot be read is left out: 'Ke nan 0 0' of 'a'",
        f"{LEFT_OUT}foo of 'a' and 1 more, disp of 'a', bar of 'b'",
        "file.obj: files of materials are left out: 'gone.mtl' (it is not beside it)",
        "file.obj: materials that are in no file beside it are left out: 'c'",
    ]


def test_files_of_materials_that_are_not_there(tmp_path):
    path = write(tmp_path, "Kd 1 0 0")
    (tmp_path / "file.mtl").unlink()
    assert (
        loaded(path, "file.obj: files of materials are left out: 'file.mtl' (it is not beside it)").material
        == rw.Diffuse()
    )
    path.write_text(f"{SQUARE}usemtl it\n{FACE}")
    assert (
        loaded(path, "file.obj: materials that are in no file beside it are left out: 'it'").material
        == rw.Diffuse()
    )


def test_names_with_spaces_and_several_files(tmp_path):
    (tmp_path / "my file.mtl").write_text("newmtl  red  paint\nKd 1 0 0\n")
    (tmp_path / "b.mtl").write_text("newmtl red paint\nKd 0 1 0\nnewmtl green\nKd 0 1 0\n")
    path = tmp_path / "file.obj"
    path.write_text(
        f"mtllib my file.mtl\nmtllib b.mtl\n{SQUARE}usemtl red paint \nf 1 2 3\nusemtl green\nf 1 3 4\n"
    )
    assert [mesh.material for mesh in rw.Scene(path).shapes] == [rw.Diffuse((1, 0, 0)), rw.Diffuse((0, 1, 0))]


def test_trimesh_and_files_give_the_same_looks(tmp_path):
    picture(tmp_path, "base.png", PIXELS[..., :3])
    for statements in (
        "Kd 0.1 0.2 0.3\nKs 0.5 0.5 0.5\nNs 50\nillum 2\nKe 3 2 1\nd 0.5",
        "Kd 0.1 0.2 0.3\nPr 0.25\nPm 1",
        "Kd 0.1 0.2 0.3\nNi 1.5\nillum 7",
        "map_Kd base.png\nTr 0.25",
    ):
        path = write(tmp_path, statements)
        mesh, held = loaded(path), trimesh.load(path, process=False)
        (here,) = rw.Scene(held).shapes
        assert (here.material, here.emission) == (mesh.material, mesh.emission)
    # Painted since, by an object with sRGB colors.
    held = trimesh.load(write(tmp_path, "Kd 0.1 0.2 0.3"), process=False)
    held.visual.material.diffuse = [188, 0, 255, 255]
    (mesh,) = rw.Scene(held).shapes
    assert mesh.material.reflectance == pytest.approx((0.502886, 0, 1), abs=1e-6)
    held = trimesh.load(write(tmp_path, "Kd 0.1 0.2 0.3\nmap_Ke base.png\nfoo 1"), process=False)
    with pytest.warns(RuntimeWarning, match="of trimesh: ") as caught:
        rw.Scene(held)
    assert [str(one.message) for one in caught] == [
        "a material of trimesh: pictures are left out: 'base.png' (it came without its file) of 'it'",
        "a material of trimesh: what is not shown here is left out: foo of 'it'",
    ]
