"""Open surfaces in or on glass or water scatter light by the index of refraction around them."""

import numpy as np
import pytest

import raywright as rw

BLACK = rw.Diffuse(0.0)
HAZE = rw.Homogeneous(absorption=1e-12, scattering=0.0)
INTEGRATORS = [rw.Path(), rw.Whitted(), rw.Bidirectional()]


def sheet(height, material, emission=None, *, half=1.0, up=True):
    corners = [(-half, -half, height), (half, -half, height), (half, half, height), (-half, half, height)]
    faces = [(0, 1, 2), (0, 2, 3)] if up else [(0, 2, 1), (0, 3, 2)]
    return rw.Mesh(corners, faces, material=material, emission=emission)


def seen(things, index, integrator, *, haze=False, samples=64, camera=None):
    """The radiance that a camera sees straight below it, in a medium of an index of refraction."""
    around = rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(index, interior=HAZE if haze else None))
    camera = camera or rw.Camera((0.01, 0.02, 1), (0.01, 0.02, 0), up=(0, 1, 0), fov=0.01, width=1, height=1)
    scene = rw.Scene([*things, around])
    return rw.render(scene, camera, integrator, samples=samples, seed=3, progress=False).rgb.mean((0, 1))


def mirrored(material, index, integrator, **more):
    """The share of a lamp of radiance 1 above the camera that is mirrored."""
    lamp = sheet(2, BLACK, 1.0, up=False)
    return seen([sheet(0, material), lamp, sheet(-1, BLACK, half=19.0)], index, integrator, **more)


def passing(material, index, integrator, **more):
    """The share of a lamp of radiance 1 below a sheet that goes through it."""
    return seen([sheet(0, material), sheet(-1, BLACK, 1.0)], index, integrator, **more)


def bare(eta, k, index):
    """Fresnel at normal incidence."""
    return ((eta - index) ** 2 + k**2) / ((eta + index) ** 2 + k**2)


@pytest.mark.parametrize("haze", [False, True])
@pytest.mark.parametrize("integrator", INTEGRATORS, ids=lambda one: type(one).__name__)
def test_metals_mirror_by_the_index_around_them(integrator, haze):
    metal = rw.Conductor(eta=0.2, k=3.9)
    for index in (1.0, 1.33, 1.5, 2.0):
        found = mirrored(metal, index, integrator, haze=haze)
        np.testing.assert_allclose(found, bare(0.2, 3.9, index), rtol=1e-5)
    # Also on sheets with a mask, a mixture, a bump map, or the glass on one side.
    for other in (
        rw.Mask(metal, 1.0),
        rw.TwoSided(metal, BLACK),
        rw.Mix(metal, rw.Conductor(eta=0.2, k=3.9), 0.5),
        rw.BumpMap(metal, rw.Checker(0, 0), 0.0),
    ):
        np.testing.assert_allclose(
            mirrored(other, 1.5, integrator, haze=haze), bare(0.2, 3.9, 1.5), rtol=1e-5
        )


@pytest.mark.parametrize("haze", [False, True])
@pytest.mark.parametrize("integrator", INTEGRATORS, ids=lambda one: type(one).__name__)
def test_coats_and_panes_vanish_in_what_has_their_index(integrator, haze):
    how = {"haze": haze, "samples": 4096}
    assert mirrored(rw.Plastic(0.0, ior=1.5), 1.5, integrator, **how).max() < 1e-12
    assert mirrored(rw.Plastic(0.0, ior=1.5), 2.0, integrator, **how).max() < 1e-12
    assert mirrored(rw.ThinDielectric(1.5), 1.5, integrator, **how).max() < 1e-12
    np.testing.assert_allclose(passing(rw.ThinDielectric(1.5), 1.5, integrator, **how), 1, rtol=1e-6)
    np.testing.assert_allclose(
        mirrored(rw.Plastic(0.0, ior=1.5), 1.33, integrator, **how), bare(1.5, 0, 1.33), rtol=1e-5
    )
    # A gap of air between two faces of glass: 2 R / (1 + R), here at random.
    gap = 2 * bare(1, 0, 1.5) / (1 + bare(1, 0, 1.5))
    for share, of in ((gap, mirrored), (1 - gap, passing)):
        for pane in (rw.ThinDielectric(1.0), rw.materials.Tinted(rw.ThinDielectric(1.0))):
            # A standard deviation of 0.27 over 64 times: five standard errors, once in a million.
            np.testing.assert_allclose(of(pane, 1.5, integrator, **how), share, atol=5 * 0.27 / 64)


def test_what_is_not_metal_in_gltf_has_an_index_of_its_own():
    # An index of 1.5, by the specification: Fresnel at normal incidence, and nothing within the same index.
    for integrator in INTEGRATORS:
        for index in (1.0, 1.2, 1.33):
            found = mirrored(rw.MetallicRough(0.0, 0.0, 0.0), index, integrator, samples=16)
            np.testing.assert_allclose(found, bare(1.5, 0, index), rtol=1e-5)
        for index in (1.5, 2.0):
            assert mirrored(rw.MetallicRough(0.0, 0.0, 0.0), index, integrator, samples=16).max() < 1e-12
        # A metal's color stays as given.
        metal = mirrored(rw.MetallicRough((0.9, 0.6, 0.3), 1.0, 0.0), 1.33, integrator, samples=16)
        np.testing.assert_allclose(metal, (0.9, 0.6, 0.3), rtol=1e-6)


def met(material, index, cosine=1.0):
    """Interactions of rays with a sheet in a medium of an index of refraction."""
    to = np.array([[np.sqrt(1 - cosine**2), 0, -cosine]])
    around = [rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(index))] if index != 1 else []
    scene = rw.Scene([sheet(0, material, half=5.0), *around])
    return scene.interactions(rw.query.Rays((0.01, 0.02, 0) - to, to, np.zeros(1)))


@pytest.mark.parametrize("index", [1.0, 1.33, 1.5])
def test_interactions_scatter_by_the_index_around_them(index):
    for cosine in (1.0, 0.3):
        found = met(rw.Conductor(eta=0.2, k=3.9), index, cosine).reflected().weight
        # Only the ratios count.
        expected = met(rw.Conductor(eta=0.2 / index, k=3.9 / index), 1.0, cosine).reflected().weight
        np.testing.assert_allclose(found, expected, rtol=1e-12)
        for kind in (rw.Plastic(0.0, ior=1.5), rw.ThinDielectric(1.5), rw.MetallicRough(0.0, 0.0, 0.0)):
            found = met(kind, index, cosine).reflected().weight
            if index == 1.5:
                assert (found < 1e-12).all()
            elif cosine == 1:
                single = bare(1.5, 0, index)
                pane = 2 * single / (1 + single)
                expected = pane if isinstance(kind, rw.ThinDielectric) else single
                np.testing.assert_allclose(found, expected, rtol=1e-12)
    # Glass within glass refracts by the ratio of both: Snell, and radiance with its square.
    scene = rw.Scene(
        [
            rw.Box((-5, -5, -5), (5, 5, 0), material=rw.Dielectric(1.8, priority=1)),
            rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(index)),
        ]
    )
    to = np.array([[0.6, 0, -0.8]])
    through = scene.interactions(rw.query.Rays((0.01, 0.02, 0) - to, to, np.zeros(1))).refracted()
    np.testing.assert_allclose(through.direction[0, 0], 0.6 * index / 1.8, rtol=1e-12)


def test_albedos_that_are_seen_are_those_of_the_index_around():
    camera = rw.Camera((0.01, 0.02, 1), (0.01, 0.02, 0), up=(0, 1, 0), fov=0.01, width=2, height=2)
    for kind in (rw.MetallicRough(0.0, 0.0, 0.3), rw.Plastic(0.0, ior=1.5)):
        for index in (1.33, 1.5):
            around = rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(index))
            found = rw.aovs(rw.Scene([sheet(0, kind), around]), camera, "albedo", samples=2)["albedo"]
            np.testing.assert_allclose(found[0, 0], met(kind, index).albedo[0], rtol=1e-6)
            air = rw.aovs(rw.Scene(sheet(0, kind)), camera, "albedo", samples=2)["albedo"]
            assert (found < 0.5 * air).all()
            assert index != 1.5 or (found < 1e-12).all()


def test_a_clear_coat_vanishes_in_what_has_its_index():
    towards = np.array([[0.1, 0, np.sqrt(0.99)]])
    coated, plain = (
        rw.Principled(0.5, roughness=0.5, clearcoat=coat, clearcoat_gloss=0.9) for coat in (1.0, 0.0)
    )
    values = {}
    for index in (1.0, 1.33, 1.5):
        with_coat, without = (met(kind, index).evaluate(towards)[0] for kind in (coated, plain))
        values[index] = np.abs(with_coat - without).max()
    assert values[1.0] > 0.01
    assert values[1.5] < 1e-12
    assert 0.01 * values[1.0] < values[1.33] < 0.2 * values[1.0]


CUBE = [
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
]  # fmt: skip

SCALED = {
    "soap film": lambda n: rw.materials.SoapFilm(400 * n, 1.4 / n),
    "rough metal": lambda n: rw.Conductor(eta=0.5 / n, k=2.0 / n, roughness=0.6),
    "film on metal": lambda n: rw.materials.ThinFilm(
        300 * n, 1.6 / n, base=rw.Conductor(eta=1.2 / n, k=2.0 / n)
    ),
    "plastic": lambda n: rw.Plastic((0.2, 0.4, 0.7), ior=1.8 / n, roughness=0.4),
    "pane": lambda n: rw.ThinDielectric(1.9 / n),
    "principled": lambda n: rw.Principled((0.6, 0.3, 0.2), roughness=0.4, ior=1.9 / n),
    "principled sheet": lambda n: rw.materials.PrincipledThin(
        (0.6, 0.3, 0.2), roughness=0.4, transmission=0.5, ior=1.9 / n
    ),
}


@pytest.mark.parametrize(
    "integrator",
    [
        # Without roulette, for which the loops of both scenes draw other numbers.
        rw.Path(roulette_depth=1000),
        rw.Bidirectional(),
        rw.LightTraced(),
        rw.PhotonMap(200),
        rw.Bidirectional(vertex_merging=True),
    ],
    ids=["path", "bidirectional", "light traced", "photon map", "merged"],
)
@pytest.mark.parametrize("kind", SCALED)
def test_only_the_ratio_of_indices_counts(kind, integrator):
    # In a black room full of a medium, all is as in air with every index divided by that of the medium, and
    # with thicknesses of films multiplied by it: equal random numbers make the same picture.
    # Some stages are in float32, where a sample may pass an edge on its other side; none of these does.
    sampler = rw.rendering.Independent() if isinstance(integrator, rw.Path) else None
    how = {"samples": 64, "seed": 3, "sampler": sampler, "progress": False}

    def picture(of, index):
        room = rw.Box((-3, -3, -3), (3, 3, 3), material=BLACK)
        lamp = sheet(2.0, BLACK, (3.0, 2.0, 4.0), half=0.5, up=False)
        things = [sheet(0, SCALED[kind](of)), lamp, sheet(-0.6, rw.Diffuse(0.7), half=2.0), room]
        camera = rw.Camera((0.5, -2, 1.2), (0, 0, 0), up=(0, 0, 1), fov=60, width=5, height=5)
        if index == 1:
            return rw.render(rw.Scene(things), camera, integrator, **how).rgb
        around = rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(index))
        scene = rw.Scene([*things, around])
        return rw.render(scene, camera, integrator, **how).rgb

    air, glass = picture(1.25, 1.0), picture(1.0, 1.25)
    np.testing.assert_allclose(glass, air, rtol=1e-4, atol=1e-6)
    # Otherwise the picture differs.
    assert np.abs(picture(1.0, 1.0) - air).max() > 1e-4


def test_measured_metals_and_their_films_too():
    for kind in (rw.Conductor("Cu"), rw.materials.ThinFilm(200.0, 1.4, base=rw.Conductor("Cu"))):
        air, glass = mirrored(kind, 1.0, rw.Path()), mirrored(kind, 1.5, rw.Path())
        assert (np.abs(glass - air) > 0.003).all()


def test_a_plate_half_in_water_is_wet_below():
    metal = rw.Conductor(eta=0.2, k=3.9)
    water = rw.Box((-5, -5, -5), (5, 5, 0), material=rw.Dielectric(1.33))
    plate = rw.Mesh([(0, -1, -1), (0, 1, -1), (0, 1, 1), (0, -1, 1)], [(0, 1, 2), (0, 2, 3)], material=metal)
    lamp = rw.Mesh(
        [(2, -1, -1), (2, 1, -1), (2, 1, 1), (2, -1, 1)], [(0, 2, 1), (0, 3, 2)], material=BLACK, emission=1.0
    )
    for height, index in ((0.5, 1.0), (-0.5, 1.33)):
        camera = rw.Camera((1, 0.1, height), (0, 0.1, height), up=(0, 0, 1), fov=0.01, width=1, height=1)
        image = rw.render(rw.Scene([plate, lamp, water]), camera, samples=16, progress=False)
        np.testing.assert_allclose(image.rgb, bare(0.2, 3.9, index), rtol=1e-5)


def test_copies_stand_in_glass_too():
    metal = sheet(0, rw.Conductor(eta=0.2, k=3.9))
    lamp = sheet(2, BLACK, 1.0, up=False)
    for copied in (rw.Instance(metal, np.eye(4)), metal):
        np.testing.assert_allclose(seen([copied, lamp], 1.5, rw.Path()), bare(0.2, 3.9, 1.5), rtol=1e-5)
    # A metal surrounded by glass, copied as one.
    things = [metal, lamp, rw.Sphere((0, 0, 0), 20.0, material=rw.Dielectric(1.5))]
    camera = rw.Camera((0.01, 0.02, 1), (0.01, 0.02, 0), up=(0, 1, 0), fov=0.01, width=1, height=1)
    both = rw.Scene([rw.Instance(things, np.eye(4))])
    image = rw.render(both, camera, samples=64, progress=False)
    np.testing.assert_allclose(image.rgb, bare(0.2, 3.9, 1.5), rtol=1e-5)


def test_wavelengths_have_their_own_index_around_a_metal():
    # In dispersive glass, Fresnel at each wavelength.
    glass = rw.Dielectric(rw.materials.Cauchy(1.5, 0.05))
    lamp = sheet(2, BLACK, 1.0, up=False)
    around = rw.Sphere((0, 0, 0), 20.0, material=glass)
    camera = rw.Camera((0.01, 0.02, 1), (0.01, 0.02, 0), up=(0, 1, 0), fov=0.01, width=1, height=1)
    scene = rw.Scene([sheet(0, rw.Conductor(eta=0.2, k=3.9)), lamp, around])
    image = rw.render(scene, camera, samples=4096, seed=2, progress=False)
    # In green, by the range of the index between 500 and 600 nm.
    low, high = (bare(0.2, 3.9, 1.5 + 0.05 / um**2) for um in (0.5, 0.6))
    error = 5 * float(image.standard_error[0, 0, 1])
    assert low - error - 1e-3 <= image.rgb[0, 0, 1] <= high + error + 1e-3


def test_the_plan_says_so_and_beams_refuse():
    metal = sheet(0, rw.Conductor(eta=0.2, k=3.9))
    glass = rw.Box((-2, -2, -2), (2, 2, 2), material=rw.Dielectric(1.5))
    beside = rw.Box((5, 5, 5), (6, 6, 6), material=rw.Dielectric(1.5))
    assert "shapes in glass" in rw.Scene([metal, glass]).plan().needed
    assert "nested media" in rw.Scene([metal, glass]).plan().needed
    for scene in (rw.Scene([metal, beside]), rw.Scene([sheet(0, BLACK), glass])):
        assert "shapes in glass" not in scene.plan().needed
        assert "nested media" not in scene.plan().needed
    box = rw.Mesh(
        np.array([(x, y, z) for x in (-2, 2) for y in (-2, 2) for z in (-2, 2)]),
        CUBE,
        material=glass.material,
    )
    camera = rw.Camera((0, 0, 9), (0, 0, 0), up=(0, 1, 0), width=4, height=4)
    lit = rw.Scene([metal, box], lights=rw.PointLight((3, 3, 9), 5.0))
    with pytest.raises(ValueError, match="in or on glass"):
        rw.render(
            lit,
            camera,
            rw.integrators.BeamTraced(),
            filter=rw.rendering.BoxFilter(),
            samples=1,
            progress=False,
        )
