"""What plugins of Mitsuba stand for, and how those that are not known, or only nearly, are told of."""

import re
import warnings

import numpy as np
import pytest

import raywright as rw
from raywright.scenes import cornell_spectra

EYE = {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 4}}
POINT = {"type": "hdrfilm", "width": 1, "height": 1, "rfilter": {"type": "box"}}


def shot(**parts):
    return rw.from_mitsuba({"type": "scene", "sensor": EYE, **parts})


def material(bsdf, **shape):
    return shot(one={"type": "sphere", **shape, "bsdf": bsdf}).scene.shapes[0].material


def front(bsdf):
    """The material of a BSDF that only has a front; what is behind it is black."""
    both = material(bsdf)
    assert both.back == rw.Diffuse(0.0)
    return both.front


class Transform:
    """Stands for mitsuba's own, which have a matrix."""

    def __init__(self, matrix):
        self.matrix = matrix


def test_transforms_are_told_in_any_way():
    nested = [[0.0, -2.0, 0.0, 1.0], [2.0, 0.0, 0.0, 2.0], [0.0, 0.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0]]
    array = np.array(nested)
    ways = (nested, array, array.astype(np.float32), Transform(array), Transform(array[..., np.newaxis]))
    shots = [shot(one={"type": "sphere", "to_world": way}) for way in ways]
    assert all(one == shots[0] for one in shots)
    assert (shots[0].scene.shapes[0].transform == nested).all()


def test_matrices_of_few_digits_are_straightened():
    rough = [[-0.224951, -1e-6, -0.97437, 0], [-0.97437, 0, 0.224951, 0], [0, 1, -1e-6, 8.87], [0, 0, 0, 1]]
    read = shot(sky={"type": "envmap", "bitmap": np.ones((2, 4, 3), np.float32), "to_world": rough})
    turned = read.scene.environment.to_world
    assert np.allclose(turned @ turned.T, np.eye(3), rtol=0, atol=1e-15)
    assert np.allclose(turned @ np.diag([-1, 1, -1]), np.array(rough)[:3, :3], rtol=0, atol=2e-6)
    skewed = [[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    with pytest.raises(ValueError, match="'sensor': to_world must rotate, translate and scale only"):
        rw.from_mitsuba({"type": "scene", "sensor": {**EYE, "to_world": skewed}})


def test_what_is_not_given_is_as_mitsuba_has_it():
    bare = rw.from_mitsuba({"type": "scene", "sensor": {"type": "perspective"}, "s": {"type": "sphere"}})
    assert (bare.camera.width, bare.camera.height) == (768, 576)
    # 50 mm on a film of 36 by 24 mm.
    assert bare.camera.fov_axis == "diagonal"
    assert np.isclose(np.tan(np.radians(bare.camera.fov / 2)), np.hypot(36, 24) / 100, rtol=1e-15)
    assert bare.filter == rw.rendering.CroppedFilter(rw.rendering.GaussianFilter(radius=2.0, sigma=0.5))
    assert bare.scene.shading_normals == "raw"
    assert (bare.samples, bare.seed, bare.integrator) == (4, 0, rw.Path(None, 4))
    assert bare.scene.shapes == (rw.Sphere(material=rw.TwoSided(rw.Diffuse(0.5), rw.Diffuse(0.0))),)
    assert front({"type": "plastic"}).ior == 1.49 / 1.000277
    assert material({"type": "dielectric"}) == rw.Dielectric(1.5046 / 1.000277, alpha=0)
    assert material({"type": "thindielectric"}) == rw.ThinDielectric(1.5046 / 1.000277)
    assert front({"type": "conductor"}) == rw.Mirror(1.0)
    spot = shot(s={"type": "spot"}).scene.lights[0]
    assert (spot.angle, spot.falloff, spot.profile, spot.target) == (20, 5, "linear", (0, 0, 1))


def test_names_stand_for_metals_and_indices():
    # Measured spectra, over the observer's table of every nm, linear between, summed at every hundredth nm by
    # separate code. Mitsuba (3.9.1) has the table of every fifth nm: the same sum over that gives its values,
    # (0.143036, 0.375307, 1.442045) and (3.982997, 2.385557, 1.603359), to 5e-5.
    gold = front({"type": "conductor", "material": "Au"})
    assert np.allclose(gold.eta, (0.143124, 0.374962, 1.442346), rtol=1e-4)
    assert np.allclose(gold.k, (3.983135, 2.385747, 1.603086), rtol=1e-4)
    # Among spectra metals have spectra.
    even = {"type": "spectrum", "value": [(300, 1.0), (900, 1.0)]}
    ball = {"type": "sphere", "bsdf": {"type": "conductor", "material": "Ni_palik"}}
    read = shot(lamp={"type": "constant", "radiance": even}, ball=ball).scene.shapes[0].material.front
    assert read == rw.Conductor("nickel", alpha=0)
    assert material({"type": "dielectric", "int_ior": "Water", "ext_ior": "vacuum"}).ior == 1.333
    with pytest.raises(
        ValueError, match=r"dielectric 'one.bsdf': int_ior must be a number or one of .*diamond"
    ):
        material({"type": "dielectric", "int_ior": "treacle"})


def test_colors_are_told_in_any_way():
    def seen(value):
        return front({"type": "diffuse", "reflectance": value}).reflectance

    assert seen(0.25) == (0.25, 0.25, 0.25)
    assert seen({"type": "rgb", "value": [0.1, 0.2, 0.3]}) == (0.1, 0.2, 0.3)
    assert seen({"type": "rgb", "value": "#ff8000"}) == (1.0, 128 / 255, 0.0)
    assert np.allclose(seen({"type": "srgb", "color": "#ff8000"}), (1.0, 0.2158605, 0.0), rtol=0, atol=1e-7)
    assert seen({"type": "spectrum", "value": 0.5}) == (0.5, 0.5, 0.5)
    even = seen({"type": "spectrum", "value": [(300, 0.5), (900, 0.5)]})
    assert even == rw.Spectrum([300, 900], [0.5, 0.5])
    assert np.allclose(even.reflected_rgb, 0.5, rtol=0, atol=1e-12)
    # The walls of the Cornell box, with values of Mitsuba (3.9).
    walls = {
        "_WHITE": (0.7350, 0.7356, 0.7363),
        "_RED": (0.4913, 0.0492, 0.0509),
        "_GREEN": (0.0683, 0.3978, 0.0863),
    }
    for name, expected in walls.items():
        measured = list(
            zip(range(400, 701, 4), map(float, getattr(cornell_spectra, name).split()), strict=True)
        )
        wall = seen({"type": "spectrum", "value": measured})
        assert np.allclose(wall.reflected_rgb, expected, rtol=0, atol=4e-3)
    # An equal-energy spectrum is reddish: white is D65.
    lamp = shot(one={"type": "constant", "radiance": {"type": "spectrum", "value": 2.0}}).scene.environment
    assert np.allclose(lamp.radiance, 2 * np.array([1.2047939, 0.948291, 0.908916]), rtol=0, atol=2e-6)
    d65 = shot(one={"type": "constant", "radiance": {"type": "d65", "scale": 2.0}}).scene.environment
    assert d65 == rw.ConstantEnvironment(2.0)


def test_spectra_are_told_in_any_way(tmp_path):
    def seen(value):
        return front({"type": "diffuse", "reflectance": value}).reflectance

    told = rw.Spectrum([400, 500, 700], [0.2, 0.8, 0.4])
    for value in (
        {"type": "spectrum", "value": [(400, 0.2), (500, 0.8), (700, 0.4)]},
        {"type": "irregular", "wavelengths": "400, 500, 700", "values": "0.2, 0.8, 0.4"},
        {"type": "irregular", "wavelengths": [400, 500, 700], "values": np.array([0.2, 0.8, 0.4])},
    ):
        assert seen(value) == told
    regular = {"type": "regular", "wavelength_min": 400.0, "wavelength_max": 600.0, "values": "0.2 0.8 0.4"}
    assert seen(regular) == rw.Spectrum([400, 500, 600], [0.2, 0.8, 0.4])
    (tmp_path / "wall.spd").write_text("# measured\n400 0.2\n500 0.8  # peak\n\n700 0.4\n")
    (tmp_path / "scene.xml").write_text(
        """<scene version="3.0.0"><sensor type="perspective"/><shape type="sphere"><bsdf type="diffuse">
        <spectrum name="reflectance" filename="wall.spd"/></bsdf><emitter type="area">
        <spectrum type="blackbody" name="radiance"><float name="temperature" value="3000"/>
        </spectrum></emitter></shape></scene>"""
    )
    ball = rw.load(tmp_path / "scene.xml").scene.shapes[0]
    assert ball.material.front.reflectance == told
    # Values of Mitsuba's spectral variants (3.9), within their noise.
    assert ball.emission.rgb == pytest.approx((733.35, 350.0, 112.98), rel=4e-3)
    for bad, why in [
        ({"type": "irregular", "wavelengths": "400 500", "values": "1 2 3"}, "length 2 like wavelengths"),
        ({"type": "irregular", "wavelengths": "500 400", "values": "1 2"}, "rise"),
        ({"type": "irregular", "wavelengths": "400 many", "values": "1 2"}, "finite numbers"),
        ({"type": "regular", "values": "1"}, "two or more finite numbers"),
        ({"type": "spectrum", "value": [(400, 1), (500, -1)]}, "at least 0, got -1"),
        ({"type": "spectrum", "value": [(400, 1)]}, "two or more, and rise"),
    ]:
        with pytest.raises(ValueError, match=why):
            seen(bad)
    (tmp_path / "wall.spd").write_text("400 0.2 0.3\n")
    with pytest.raises(ValueError, match=r"wall\.spd must have a wavelength and a number in each line"):
        rw.load(tmp_path / "scene.xml")
    # RGB approximations raise a warning.
    slide = {"type": "projector", "irradiance": {"type": "blackbody", "temperature": 3000.0}}
    with pytest.warns(RuntimeWarning, match="approximated by red, green and blue here"):
        shot(one=slide)


def test_the_base_of_plastic_gives_what_it_does_in_mitsuba():
    """Without ``nonlinear`` r / (1 - F) of it gets out, and so the base here has another reflectance."""
    within = rw.scene_files.mitsuba.coats.smooth(1.5)
    # Duntley (1942).
    assert abs(within - 0.5963) < 1e-4
    base = front({"type": "plastic", "int_ior": 1.5, "ext_ior": 1.0, "diffuse_reflectance": 0.4}).reflectance[
        0
    ]
    assert np.isclose(base / (1 - base * within), 0.4 / (1 - within), rtol=1e-12)
    plain = {"type": "plastic", "nonlinear": True, "diffuse_reflectance": 0.4}
    assert front(plain).reflectance == (0.4, 0.4, 0.4)


def test_inside_out_shapes_have_their_front_within():
    matt = {"type": "diffuse", "reflectance": 0.3}
    assert material(matt, flip_normals=True) == rw.TwoSided(rw.Diffuse(0.0), rw.Diffuse(0.3))
    mirrored = np.diag([-1.0, 1, 1, 1])
    assert material(matt, to_world=mirrored) == material(matt, flip_normals=True)
    assert material(matt, to_world=mirrored, flip_normals=True) == material(matt)
    glass = material({"type": "dielectric", "int_ior": 2.0, "ext_ior": 1.0}, flip_normals=True)
    assert glass.ior == 0.5


def test_inside_out_shapes_shine_inwards():
    lamp = {"type": "area", "radiance": 2.0}
    mirrored = np.diag([-1.0, 1, 1, 1])

    def emission(kind, **more):
        return shot(one={"type": kind, "e": lamp, **more}).scene.shapes[0].emission

    inwards = rw.Emission(2.0, side="back")
    assert emission("sphere", flip_normals=True) == emission("sphere", to_world=mirrored) == inwards
    assert emission("sphere") == emission("sphere", flip_normals=True, to_world=mirrored) == (2.0, 2.0, 2.0)
    # In Mitsuba (3.9) a mirrored cylinder keeps its outside.
    assert emission("cylinder", flip_normals=True) == inwards
    assert emission("cylinder", to_world=mirrored) == (2.0, 2.0, 2.0)
    # Other flipped shapes have their front there: the normal points to the lit side.
    for kind in ("rectangle", "cube", "disk"):
        (up,) = shot(one={"type": kind, "e": lamp}).scene.shapes
        (down,) = shot(one={"type": kind, "e": lamp, "flip_normals": True}).scene.shapes
        assert up.emission == down.emission == (2.0, 2.0, 2.0)
        normals = [
            rw.Scene(one).intersect([(0.1, 0.2, 3.0)], [(0.0, 0.0, -1.0)]).normal[0] for one in (up, down)
        ]
        assert np.allclose(normals, [(0, 0, 1), (0, 0, -1)], rtol=0, atol=1e-12), kind


def test_copies_of_a_group_are_one_instance():
    group = {"type": "shapegroup", "one": {"type": "sphere"}, "two": {"type": "cube"}}
    there = [np.diag([2.0, 2, 2, 1]), np.diag([1.0, 1, 3, 1])]
    copies = {
        f"c{i}": {"type": "instance", "to_world": m, "g": {"type": "ref", "id": "group"}}
        for i, m in enumerate(there)
    }
    (instance,) = shot(group=group, **copies).scene.shapes
    assert (instance.transform == there).all()
    assert [type(one) for one in instance.shapes] == [rw.Sphere, rw.Mesh]


def test_integrators_samplers_and_filters():
    def read(integrator=None, sampler=None, rfilter=None, border=True):
        film = {"type": "hdrfilm", "sample_border": border, **({"f": rfilter} if rfilter else {})}
        eye = {**EYE, "film": film}
        eye |= {"s": sampler} if sampler else {}
        return rw.from_mitsuba({"type": "scene", "e": eye, **({"i": integrator} if integrator else {})})

    assert read({"type": "path", "max_depth": 5, "rr_depth": 3}).integrator == rw.Path(4, 2)
    assert read({"type": "volpath", "max_depth": -1}).integrator == rw.Path(None, 4)
    assert read({"type": "direct", "emitter_samples": 2}).integrator == rw.Direct(2, 1)
    assert read({"type": "ao", "shading_samples": 4, "ray_length": 2.0}).integrator == rw.AmbientOcclusion(
        2.0, samples=4
    )
    seen = read({"type": "aov", "aovs": "d:depth, n:sh_normal", "img": {"type": "direct"}})
    assert (seen.aov, seen.integrator) == (("depth", "shading_normal"), rw.Direct())
    assert read(sampler={"type": "ldsampler", "sample_count": 32, "seed": 7}).sampler == rw.rendering.Sobol()
    default = read(sampler={"type": "independent", "sample_count": 16, "seed": 3})
    assert (default.sampler, default.samples, default.seed) == (None, 16, 3)
    assert "independent" in default.unnamed
    assert (read().sampler, read().unnamed) == (None, None)
    counted = read(sampler={"type": "multijitter", "sample_count": 32, "seed": 7})
    assert (counted.sampler, counted.samples, counted.seed) == (rw.rendering.Stratified(), 32, 7)
    assert read(rfilter={"type": "tent"}).filter == rw.rendering.TriangleFilter(1.0)
    assert read(rfilter={"type": "gaussian", "stddev": 0.25}).filter == rw.rendering.GaussianFilter(1.0, 0.25)
    assert read(rfilter={"type": "mitchell", "B": 0.5}).filter == rw.rendering.MitchellFilter(2.0, 0.5, 1 / 3)
    assert read(rfilter={"type": "catmullrom"}).filter == rw.rendering.MitchellFilter(2.0, 0.0, 0.5)
    assert read(rfilter={"type": "lanczos"}).filter == rw.rendering.LanczosFilter(3)
    cropped = read(rfilter={"type": "tent"}, border=False).filter
    assert cropped == rw.rendering.CroppedFilter(rw.rendering.TriangleFilter(1.0))
    # The box filter of one pixel does not reach beyond.
    assert read(rfilter={"type": "box"}, border=False).filter == rw.rendering.BoxFilter()


def test_a_part_of_a_film_sees_what_the_whole_does_there():
    film = {"type": "hdrfilm", "width": 12, "height": 8}
    part = {**film, "crop_width": 5, "crop_height": 3, "crop_offset_x": 2, "crop_offset_y": 4}
    middle = {**film, "crop_width": 6, "crop_height": 4, "crop_offset_x": 3, "crop_offset_y": 2}
    turned = [[0.6, 0, 0.8, 1], [0, 1, 0, 2], [-0.8, 0, 0.6, 3], [0, 0, 0, 1]]
    for kind, crop in (("perspective", part), ("orthographic", part), ("thinlens", middle)):
        eye = {"type": kind, "to_world": turned, "film": film}
        eye |= {"aperture_radius": 0.1, "focus_distance": 3.0} if kind == "thinlens" else {}
        eye |= {"fov": 50.0} if kind != "orthographic" else {}
        whole, cut = (
            rw.from_mitsuba({"type": "scene", "e": {**eye, "film": one}}).camera for one in (film, crop)
        )
        rows = slice(crop["crop_offset_y"], crop["crop_offset_y"] + crop["crop_height"])
        columns = slice(crop["crop_offset_x"], crop["crop_offset_x"] + crop["crop_width"])
        for mine, all_of_it in zip(cut.rays(), whole.rays(), strict=True):
            assert np.allclose(mine, all_of_it[rows, columns], rtol=0, atol=1e-12), kind


@pytest.mark.parametrize(
    ("parts", "told"),
    [
        ({"m": {"type": "piecewise"}}, "scene: piecewise 'm' is not supported here"),
        ({"s": {"type": "sphere", "b": {"type": "hair"}}}, "sphere 's': hair 'b' is not supported here"),
        ({"s": {"type": "sphere", "color": 1}}, "sphere 's': parameter 'color' is not supported"),
        ({"s": {"type": "sphere", "radius": -1.0}}, "sphere 's': radius must be greater than 0"),
        (
            {"s": {"type": "sphere", "to_world": [[1]]}},
            "sphere 's': to_world must be a matrix of shape (4, 4)",
        ),
        ({"s": {"type": "sphere", "b": {"type": "ref", "id": "x"}}}, "there is no object of id 'x'"),
        (
            {"s": {"type": "sphere", "b": {"type": "twosided", "i": {"type": "dielectric", "tint": 1}}}},
            "dielectric 's.b.i': parameter 'tint' is not supported",
        ),
        (
            {"s": {"type": "sphere", "b": {"type": "diffuse", "reflectance": 1.5}}},
            "diffuse 's.b': reflectance must be between 0 and 1",
        ),
        (
            {"s": {"type": "sphere", "b": {"type": "diffuse", "reflectance": {"type": "volume"}}}},
            "volume 's': a volume must be within, of type constvolume or gridvolume",
        ),
        (
            {"e": {"type": "spot", "cutoff_angle": 85.0, "texture": {"type": "checkerboard"}}},
            "spot 'e': cutoff_angle must be above 0 and at most 80 with a texture, got 85",
        ),
        ({"e": {"type": "projector", "irradiance": {"type": "volume"}}}, "volume 'e.irradiance': this kind"),
        ({"e": {"type": "constant", "radiance": {"type": "volume"}}}, "must be the same everywhere"),
        ({"i": {"type": "stokes"}}, "stokes 'i' is not supported here"),
        ({"i": {"type": "path", "max_depth": 0}}, "path 'i': max_depth must be -1 or at least 1"),
        ({"i": {"type": "aov", "aovs": "x:boundary_test"}}, "aov 'i': aovs must be of depth,"),
        ({"e2": {"type": "batch"}}, "batch 'e2' is not supported here"),
        ({"i": {"type": "moment"}}, "moment 'i': one integrator must be within, got 0"),
        (
            {"i": {"type": "direct", "emitter_samples": 0, "bsdf_samples": 0}},
            "direct 'i': emitter_samples and bsdf_samples must be at least 0, and not both, got 0 and 0",
        ),
        (
            {"s": {"type": "sphere", "b": {"type": "principled", "eta": 1.5, "specular": 0.5}}},
            "principled 's.b': either eta or specular must be given, got both",
        ),
    ],
)
def test_what_is_not_supported_is_refused_by_name(parts, told):
    with pytest.raises(ValueError, match=re.escape(told)) as caught:
        shot(**parts)
    assert "\n" not in str(caught.value)


def test_what_is_approximated_is_warned_of_once():
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        shot(a={"type": "sunsky"}, b={"type": "sunsky", "hour": 12.0})
    assert [str(one.message) for one in caught] == [
        "sunsky 'a': its sky is approximated by that of Preetham et al. (1999), which is brighter"
    ]


def test_what_shines_is_hidden_as_a_transparent_background():
    hidden = {"type": "path", "hide_emitters": True}
    ball, sky = {"type": "sphere"}, {"type": "constant"}
    assert shot(i=hidden, b=ball, s=sky).background == "transparent"
    assert shot(i={"type": "path"}, b=ball, s=sky).background == "shown"
    with pytest.warns(
        RuntimeWarning, match="path 'i': hide_emitters hides environments only: emissive surfaces"
    ):
        shot(i=hidden, b={**ball, "e": {"type": "area"}})


def test_direct_light_without_one_of_its_ways():
    """By surfaces alone, what has no size is never found, and by lights alone all else is."""
    parts = {"b": {"type": "sphere"}, "p": {"type": "point"}, "s": {"type": "constant"}}
    with pytest.warns(RuntimeWarning, match="without emitter_samples"):
        found = shot(i={"type": "direct", "emitter_samples": 0, "bsdf_samples": 3}, **parts)
    assert (found.integrator, found.scene.lights) == (rw.Direct(1, 3), ())
    with pytest.warns(RuntimeWarning, match="without bsdf_samples mirrors and smooth glass would be black"):
        found = shot(i={"type": "direct", "emitter_samples": 2, "bsdf_samples": 0}, **parts)
    assert found.integrator == rw.Direct(2, 1)
    assert len(found.scene.lights) == 1


def test_moments_are_told_of_any_integrator():
    moment = {
        "type": "moment",
        "inner": {"type": "aov", "aovs": "d:depth", "light": {"type": "path", "max_depth": 3}},
    }
    found = shot(i=moment, b={"type": "sphere"})
    assert (found.integrator, found.aov) == (rw.Path(2, 4), ("depth",))
    assert shot(i={"type": "depth"}, b={"type": "sphere"}).aov == ("depth",)


@pytest.mark.parametrize(
    "eye",
    [
        {"type": "radiancemeter", "origin": [0.0, 0.0, 4.0], "direction": [0.0, 0.0, -1.0]},
        {"type": "distant", "direction": [0.0, 0.0, -1.0], "target": [0.0, 0.0, 0.0]},
    ],
)
def test_meters_measure_along_one_ray(eye):
    """Of a matt ball under an even sky, its reflectance: all of the sky is seen from its pole."""
    gray = {"type": "diffuse", "reflectance": 0.6}
    parts = {"b": {"type": "sphere", "bsdf": gray}, "s": {"type": "constant"}}
    found = rw.from_mitsuba({"type": "scene", "eye": {**eye, "film": POINT}, **parts})
    assert found.camera.rays()[1][0, 0].tolist() == [0.0, 0.0, -1.0]
    image = found.render(samples=64, progress=False)
    assert abs(image.rgb[0, 0] - 0.6).max() < 4 * image.standard_error.max() + 1e-4
    with pytest.raises(ValueError, match="its film must be of 1 by 1 pixels, got 8 by 4"):
        rw.from_mitsuba({"type": "scene", "eye": {**eye, "film": EYE["film"]}, **parts})


def test_a_distant_meter_wants_a_point():
    with pytest.raises(ValueError, match="distant 'eye': target must be a point"):
        rw.from_mitsuba({"type": "scene", "eye": {"type": "distant", "film": POINT}, "b": {"type": "sphere"}})


def test_the_sun_is_where_mitsuba_has_it():
    """In Tokyo at three in the afternoon, by Mitsuba 3.9.1, to a hundredth of a degree."""
    with pytest.warns(RuntimeWarning, match="sunsky 's': its sky is approximated"):
        day = shot(s={"type": "sunsky"}).scene.environment
    assert np.linalg.norm(np.subtract(day.sun, (0.0513854, 0.691748, 0.720308))) < np.radians(0.01)
    with pytest.warns(RuntimeWarning):
        told = shot(
            s={"type": "sunsky", "sun_direction": [0.0, 3.0, 4.0], "turbidity": 5.0}
        ).scene.environment
    assert (told.sun, told.turbidity, told.up) == ((0.0, 3.0, 4.0), 5.0, (0.0, 0.0, 1.0))


def test_principled_numbers_are_those_of_the_scene():
    made = material({"type": "principled", "specular": 0.5, "spec_trans": 0.5, "sheen": 0.25})
    assert (made.ior, made.transmission, made.sheen) == (pytest.approx(1.5, abs=1e-12), 0.5, 0.25)
    # An opaque material is black behind.
    assert front({"type": "principled", "eta": 1.7}).ior == 1.7
    sheet = material({"type": "principledthin", "diff_trans": 1.5, "eta": 1.2})
    assert (sheet.diffuse_transmission, sheet.ior) == (0.75, 1.2)


def test_black_bodies_shine_as_hot_as_they_are():
    """In Mitsuba's units, as spectral variants have them: about D65's white at 6,500 K."""

    def shine(kelvin, **more):
        lamp = {"type": "constant", "radiance": {"type": "blackbody", "temperature": kelvin, **more}}
        return np.array(shot(s=lamp).scene.environment.radiance.rgb)

    white = shine(6500.0)
    assert np.ptp(white) / white.mean() < 0.08
    assert np.allclose(shine(6500.0, scale=0.5), white / 2, rtol=1e-12)
    # Planck's law at 560 nm, near the peak of the eye's sensitivity; the luminance is a mean around it.
    planck = 1.191042972e-16 / 560e-9**5 / np.expm1(0.01438776877 / (560e-9 * 6500)) * 1e-9
    assert white @ (0.212671, 0.715160, 0.072169) == pytest.approx(planck, rel=0.02)


def test_merged_shapes_are_themselves():
    ball, disk = {"type": "sphere"}, {"type": "disk"}
    apart = shot(a=ball, b=disk)
    assert shot(m={"type": "merge", "a": ball, "n": {"type": "merge", "b": disk}}) == apart


def test_names_of_plugins_are_known_in_capitals():
    assert shot(one={"type": "Sphere", "b": {"type": "Diffuse"}}) == shot(
        one={"type": "sphere", "b": {"type": "diffuse"}}
    )


def test_facets_are_those_of_the_scene():
    """Beckmann's unless it says otherwise, as Mitsuba has it, and without what they throw on each other."""
    for kind in ("roughconductor", "roughdielectric", "roughplastic"):
        for told, distribution in (({}, "beckmann"), ({"distribution": "ggx"}, "ggx")):
            scene = shot(a={"type": "sphere", "b": {"type": kind, "alpha": 0.2, **told}}).scene
            material = scene.shapes[0].material
            material = getattr(material, "front", material)
            assert (material.distribution, material.multiple_scattering) == (distribution, False)


def test_bumps_on_the_inside_are_refused():
    bumps = {
        "type": "bumpmap",
        "height": {"type": "checkerboard"},
        "bsdf": {"type": "diffuse"},
        "use_shadowing_function": False,
    }
    with (
        pytest.warns(RuntimeWarning, match="use_shadowing_function is on"),
        pytest.raises(ValueError, match=r"sphere 'one': flip_normals with bumps .* is not supported"),
    ):
        material(bumps, flip_normals=True)


def test_files_that_are_missing_are_told():
    with pytest.raises(FileNotFoundError) as caught:
        shot(s={"type": "ply", "filename": "gone.ply"})
    assert caught.value.filename == "gone.ply"
    with pytest.raises(FileNotFoundError):
        rw.load("gone.xml")
    with pytest.raises(TypeError, match="scene must be a dict or a path, got int"):
        rw.from_mitsuba(3)
    with pytest.raises(ValueError, match="there is no sensor 1: it has 1"):
        rw.from_mitsuba({"type": "scene", "sensor": EYE}, sensor=1)
    with pytest.raises(ValueError, match="sensor must be at least 0, got -1"):
        rw.from_mitsuba({"type": "scene", "sensor": EYE}, sensor=-1)
    with pytest.raises(TypeError, match="sensor must be an integer, got 'eye'"):
        rw.from_mitsuba({"type": "scene", "sensor": EYE}, sensor="eye")


@pytest.mark.parametrize("kind", ["irradiancemeter", "batch"])
def test_a_sensor_that_is_not_supported_is_named(kind):
    told = f"scene: {kind} 'eye' is not supported here; sensors are perspective, thinlens, orthographic, "
    for others in ({}, {"sensor": EYE}):
        with pytest.raises(ValueError, match=re.escape(told)):
            rw.from_mitsuba({"type": "scene", **others, "eye": {"type": kind}})


def test_a_scene_without_a_sensor_is_told_so():
    with pytest.raises(ValueError, match=r"^scene: it has no sensor$"):
        rw.from_mitsuba({"type": "scene", "ball": {"type": "sphere"}})
    with pytest.raises(ValueError, match=r"^scene: my_camera 'eye' is not supported here$"):
        rw.from_mitsuba({"type": "scene", "eye": {"type": "my_camera", "film": {"type": "hdrfilm"}}})


def test_a_spot_throws_each_point_of_its_picture():
    """Between whole points of a picture the same is thrown, however many there are."""
    bands = np.repeat(np.arange(1, 301)[None, :, None] % 7 / 7, 2, axis=0).astype(np.float32)
    picture = {"type": "bitmap", "data": bands, "filter_type": "nearest", "raw": True}
    (light,) = shot(
        s={"type": "spot", "cutoff_angle": 10.0, "beam_width": 10.0, "texture": picture}
    ).scene.lights
    tangent = np.tan(np.radians(10.0)) * (1 - 2 * (np.arange(600) + 0.5) / 600)
    cosine = 1 / np.sqrt(1 + tangent**2 + tangent[300] ** 2)
    inside = np.degrees(np.arccos(cosine)) < 10
    expected = np.where(inside, np.repeat(bands[0, :, 0], 2)[::-1] * cosine**3, 0)
    assert light.image.shape == (600, 600, 3)
    assert np.allclose(light.image[300, :, 1], expected, rtol=1e-5, atol=0)
