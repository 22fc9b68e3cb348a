"""How the index of refraction goes with wavelength, against what is published and against Snell's law."""

import pickle

import numpy as np
import pytest

import raywright as rw

# The lines h, g, F, e, d, that of helium and neon, C, and r.
LINES = [0.4046561, 0.4358343, 0.4861327, 0.5460740, 0.5875618, 0.6328, 0.6562725, 0.7065188]

# Indices at these lines and the number of Abbe, to 13 digits.
INDICES = {
    "N-BK7": (
        [
            *(1.530239986084, 1.52668458696161, 1.52237628973123, 1.51872197147083),
            *(1.51680003450059, 1.51508919833709, 1.51432234726137, 1.51289252212823),
        ],
        64.167336237499,
    ),
    "N-SF11": (
        [
            *(1.84235239987827, 1.82532542377869, 1.80651274400556, 1.79191756765148),
            *(1.78471994231005, 1.77860228046966, 1.77595511127719, 1.77119233819477),
        ],
        25.6799978350904,
    ),
    "F2": (
        [
            *(1.65063874996534, 1.64201791828131, 1.63208145678256, 1.6240803602221),
            *(1.62004013724627, 1.61655507118319, 1.61503169157614, 1.61226550339245),
        ],
        36.3664912530594,
    ),
    "diamond": (
        [
            *(2.46204685005769, 2.44996516191258, 2.43553792089594, 2.42359238955643),
            *(2.41748587403498, 2.41220737065312, 2.40990556465292, 2.40575307612494),
        ],
        55.3006465966684,
    ),
    "water": (
        [
            *(1.34312305001821, 1.34058560066938, 1.33749185605459, 1.33483038598404),
            *(1.33340333619894, 1.33210589639147, 1.33151260374107, 1.33037951777756),
        ],
        55.7600379976261,
    ),
}

# n_d and V_d as makers and measurers print them.
PRINTED = {
    "N-BK7": (1.51680, 64.17),
    "N-K5": (1.52249, 59.48),
    "N-BAK4": (1.56883, 55.98),
    "N-BAF10": (1.67003, 47.11),
    "N-FK51A": (1.48656, 84.47),
    "F2": (1.62004, 36.37),
    "SF5": (1.67270, 32.21),
    "SF10": (1.72825, 28.41),
    "N-SF10": (1.72828, 28.53),
    "N-SF5": (1.67271, 32.25),
    "N-SF6": (1.80518, 25.36),
    "N-SF11": (1.78472, 25.68),
    "N-LASF9": (1.85025, 32.17),
    "fused silica": (1.45846, 67.82),
    "CaF2": (1.43385, 95.00),
    "sapphire": (1.76817, 72.31),
    "diamond": (2.41749, 55.30),
    "water": (1.33340, 55.76),
}


@pytest.mark.parametrize("name", INDICES)
def test_sellmeiers_formula_gives_what_it_must(name):
    indices, abbe = INDICES[name]
    assert rw.materials.glasses[name].index(LINES) == pytest.approx(indices, rel=1e-10)
    assert rw.materials.glasses[name].abbe == pytest.approx(abbe, rel=1e-10)


def test_every_glass_is_what_its_maker_says():
    assert set(rw.materials.glasses) == set(PRINTED)
    assert len(rw.materials.glasses) == len(PRINTED)
    for name, (nd, abbe) in PRINTED.items():
        assert abs(rw.materials.glasses[name].index() - nd) < 6e-6, name
        assert abs(rw.materials.glasses[name].abbe - abbe) < 6e-3, name


@pytest.mark.parametrize(
    ("nd", "abbe", "b", "c", "seen"),
    [
        (
            1.5168,
            64.17,
            1.50458382194734,
            0.00421737733041528,
            [1.53094243, 1.51852556518838, 1.51319071445839],
        ),
        (
            1.72825,
            28.41,
            1.68936750293538,
            0.0134233604784856,
            [1.77326350592592, 1.733742248, 1.71676211615678],
        ),
        (
            2.4175,
            55.3,
            2.37861851670162,
            0.0134230104971151,
            [2.46251233230859, 2.422992105, 2.40601241567532],
        ),
    ],
)
def test_cauchys_coefficients_come_from_the_number_of_abbe(nd, abbe, b, c, seen):
    found = rw.materials.Cauchy.from_abbe(nd, abbe)
    assert pytest.approx(b, rel=1e-11) == found.B
    assert pytest.approx(c, rel=1e-11) == found.C
    assert found.index([0.4, 0.55, 0.7]) == pytest.approx(seen, rel=1e-9)
    assert found.abbe == pytest.approx(abbe, rel=1e-12)
    assert found.index() == pytest.approx(nd, rel=1e-14)


def test_cauchys_formula():
    found = rw.materials.Cauchy(1.5046, 0.0042).index([0.5875618, 0.4861327, 0.6562725])
    assert found == pytest.approx([1.516766, 1.522372, 1.514352], abs=5e-7)
    assert rw.materials.Cauchy(1.5, 0).abbe == np.inf


def test_prisms_and_lenses_send_colors_where_they_go():
    lines = [0.4358343, 0.4861327, 0.5875618, 0.6562725]
    for name, degrees in [
        ("N-BK7", [39.5194794387944, 39.1381087356575, 38.6466985052864, 38.4291367036214]),
        ("SF10", [63.5237517722133, 61.6748265170223, 59.5659105628748, 58.7283906829657]),
    ]:
        least = 2 * np.arcsin(rw.materials.glasses[name].index(lines) * np.sin(np.pi / 6)) - np.pi / 3
        assert np.degrees(least) == pytest.approx(degrees, rel=1e-11)
    focal = 0.05 / (rw.materials.glasses["N-BK7"].index(lines[1:]) - 1)
    assert focal == pytest.approx([0.0957164423096727, 0.0967492195473974, 0.0972152975001694], rel=1e-12)


@pytest.mark.parametrize("name", ["N-BK7", "SF10"])
@pytest.mark.parametrize("line", [0.4358343, 0.6562725])
def test_rays_through_a_prism_are_turned_as_the_index_says(name, line):
    """A ray that goes through a prism evenly, by Snell's law at two faces that rays find."""
    index = rw.materials.glasses[name].index(line)
    half = np.pi / 6
    shape = np.array([(-np.tan(half), 0), (np.tan(half), 0), (0, 1)])
    corners = np.array([(x, y, z) for z in (-1, 1) for x, y in shape])
    faces = [(0, 2, 1), (3, 4, 5), (0, 1, 4), (0, 4, 3), (1, 2, 5), (1, 5, 4), (2, 0, 3), (2, 3, 5)]
    scene = rw.Scene(rw.Mesh(corners, faces))
    turn = np.arcsin(index * np.sin(half)) - half
    direction = np.array([np.cos(turn), np.sin(turn), 0.0])
    start = np.array([-np.tan(half) / 2, 0.5, 0.0]) - 2 * direction
    ratio = 1 / index
    for _ in range(2):
        hit = scene.intersect(start[None], direction[None])
        normal = hit.normal[0] * -np.sign(hit.normal[0] @ direction)
        cosine = -normal @ direction
        within = np.sqrt(1 - ratio**2 * (1 - cosine**2))
        direction = ratio * direction + (ratio * cosine - within) * normal
        start, ratio = hit.position[0] + 1e-6 * direction, index
    assert direction == pytest.approx([np.cos(turn), -np.sin(turn), 0], abs=1e-6)


def test_shapes_of_arrays_are_kept():
    glass = rw.materials.glasses["F2"]
    assert isinstance(glass.index(0.5), float)
    assert glass.index(np.full((2, 3), 0.5, np.float32)).shape == (2, 3)
    assert glass.index([]).shape == (0,)
    assert pickle.loads(pickle.dumps(glass)) == glass
    assert rw.materials.Sellmeier(np.array([1.0]), [0.01]) == rw.materials.Sellmeier((1.0,), (0.01,))


def test_principled_solids_disperse():
    # A wedge deflects each color by its own angle: past an edge, some colors see light and others the dark.
    # With white transmission, both materials are glass with single scattering.
    glass = rw.materials.Cauchy(1.5, 0.03)
    ends = [(x, y, z) for z in (0, -1) for x, y in [(-1, -1), (1, -1), (1, 1), (-1, 1)]]
    ends[4:] = [(x, y, -0.1 if x < 0 else -1.1) for x, y, _ in ends[4:]]
    sides = [[0, 1, 2, 3], [7, 6, 5, 4], [4, 5, 1, 0], [5, 6, 2, 1], [6, 7, 3, 2], [7, 4, 0, 3]]
    faces = [corners for a, b, c, d in sides for corners in ((a, b, c), (a, c, d))]
    dark = rw.Diffuse(0)
    edge = rw.Mesh(
        [(-9, -9, -6), (1.9, -9, -6), (1.9, 9, -6), (-9, 9, -6)], [(0, 1, 2), (0, 2, 3)], material=dark
    )
    light = rw.Mesh(
        [(-9, -9, -7), (9, -9, -7), (9, 9, -7), (-9, 9, -7)], [(0, 1, 2), (0, 2, 3)], emission=1.0
    )
    camera = rw.Orthographic((0, 0, 3), (0, 0, 0), up=(0, 1, 0), scale=0.05, width=8, height=8)
    means, errors = [], []
    for material in (
        rw.Dielectric(glass, alpha=0.02, multiple_scattering=False),
        rw.Principled(1.0, 0.02**0.5, ior=glass, transmission=1.0),
        rw.Dielectric(1.5, alpha=0.02),
    ):
        scene = rw.Scene([rw.Mesh(ends, faces, material=material), edge, light])
        image = rw.render(scene, camera, rw.Path(max_depth=4), samples=400, progress=False)
        means.append(image.rgb.astype(float).mean(axis=(0, 1)))
        errors.append(np.sqrt((image.standard_error.astype(float) ** 2).sum(axis=(0, 1))) / 64)
    # Four standard errors of both: chance exceeds them in one of three channels once in 5000.
    assert np.all(np.abs(means[0] - means[1]) < 4 * np.hypot(*errors[:2])), (means, errors)
    assert np.ptp(means[1]) > 0.2 * means[1].max()
    assert np.ptp(means[2]) < 0.01
    # An opaque material has the index for yellow light.
    opaque = rw.Scene(rw.Sphere((0, 0, 0), 1, material=rw.Principled(ior=glass)), environment=1.0)
    assert np.isfinite(rw.render(opaque, camera, samples=2, progress=False).rgb).all()


@pytest.mark.parametrize(
    ("call", "kind", "message"),
    [
        (lambda: rw.materials.glasses["BK8"], KeyError, "no glass 'BK8'; there are N-BK7"),
        (
            lambda: rw.materials.glasses["F2"].index([0.5, 0.0]),
            ValueError,
            "micrometers must be finite and greater than 0",
        ),
        (
            lambda: rw.materials.glasses["F2"].index(np.nan),
            ValueError,
            "micrometers must be finite .* got nan",
        ),
        (lambda: rw.materials.glasses["F2"].index("red"), TypeError, "micrometers must be real numbers"),
        (lambda: rw.materials.Sellmeier([1.0], [0.01]).index(0.09), ValueError, "it has no index at 0.09"),
        (
            lambda: rw.materials.Sellmeier([1.0, 2.0], [0.01]),
            ValueError,
            "B and C must have equal lengths, got 2",
        ),
        (lambda: rw.materials.Sellmeier([1.0], [-0.01]), ValueError, "C must be at least 0, got -0.01"),
        (lambda: rw.materials.Sellmeier([], []), ValueError, "B must be one or more finite numbers"),
        (
            lambda: rw.Plastic(ior=rw.materials.Cauchy(1.5, 0.004)),
            TypeError,
            "got a Cauchy: what has been under a coat",
        ),
        (
            lambda: rw.ThinDielectric(rw.materials.glasses["SF10"]),
            TypeError,
            "got a Sellmeier: a pane sends all colors",
        ),
        (
            lambda: rw.materials.PrincipledThin(ior=rw.materials.Cauchy(1.5, 0.004)),
            TypeError,
            "a sheet sends all colors straight",
        ),
        (
            lambda: rw.materials.SoapFilm(300.0, rw.materials.Cauchy(1.3, 0.004)),
            TypeError,
            "films have the same for all colors",
        ),
        (lambda: rw.materials.Cauchy(0, 0.004), ValueError, "B must be"),
        (lambda: rw.materials.Cauchy(1.5, np.inf), ValueError, "C must be"),
        (lambda: rw.materials.Cauchy(1.5, -0.5).index(0.5), ValueError, "it has no index at 0.5"),
        (lambda: rw.materials.Cauchy.from_abbe(1.5, 0), ValueError, "Vd must be"),
    ],
)
def test_what_is_wrong_is_told(call, kind, message):
    with pytest.raises(kind, match=message):
        call()


@pytest.mark.parametrize("ior", [1e200, 1e20, 1e7])
@pytest.mark.parametrize(
    "make",
    [
        lambda ior: rw.Dielectric(ior),
        lambda ior: rw.Dielectric(ior, roughness=0.4),
        lambda ior: rw.Dielectric(ior, roughness=0.4, multiple_scattering=False),
        lambda ior: rw.Dielectric(1 / ior),
        lambda ior: rw.ThinDielectric(ior),
        lambda ior: rw.Plastic(0.5, ior),
        lambda ior: rw.Plastic(0.5, ior, roughness=0.4),
        lambda ior: rw.Plastic(0.5, ior, roughness=0.4, multiple_scattering=False),
        lambda ior: rw.Principled(0.5, ior=ior),
        lambda ior: rw.Principled(0.5, ior=ior, transmission=0.5),
        lambda ior: rw.materials.PrincipledThin(0.5, ior=ior, transmission=0.5),
    ],
)
def test_what_bends_light_without_measure_mirrors_it(make, ior):
    """What goes in is hardly any: what comes back of a light of 1 is no more than noise away from 1."""
    scene = rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1), material=make(ior))], environment=1.0)
    image = rw.render(
        scene,
        rw.Orthographic((0, 0, 3), (0, 0, 0), up=(0, 1, 0), scale=1, width=8, height=8),
        rw.Path(1),
        samples=16,
        progress=False,
    )
    assert not any("not finite" in line for line in image.warnings)
    assert np.isfinite(image.rgb).all()
    assert image.rgb.mean() == pytest.approx(1, abs=0.35)
