"""Media as they are described, and what they must do at their extremes."""

import math
import pickle
import struct

import media_scenes as media
import numpy as np
import pytest

import raywright as rw

SKY = rw.ConstantEnvironment(1.0)
NOISE = np.random.default_rng(3).random((6, 5, 7))
PHASES = {
    "isotropic": rw.media.Isotropic(),
    "Rayleigh": rw.media.Rayleigh(),
    "forward": rw.HenyeyGreenstein(0.9),
    "backward": rw.HenyeyGreenstein(-0.9),
    "a needle": rw.HenyeyGreenstein(0.9999),
    "a mirror": rw.HenyeyGreenstein(-0.9999),
}


def ball(material, radius=1.0):
    return rw.Sphere((0, 0, 0), radius, material=material)


def assert_invisible(scene, samples=64, camera=None, integrator=None):
    """Seen against an even sky of 1, within four standard errors of the mean, which chance exceeds once in
    16,000, of at most two hundredths."""
    camera = camera or rw.Camera((0, 0, 3), (0, 0, 0), fov=30, width=16, height=16)
    image = rw.render(scene, camera, integrator or rw.Path(), samples, progress=False)
    values = image.rgb.reshape(-1, 3).astype(float)
    error = values.std(axis=0, ddof=1) / math.sqrt(len(values))
    assert (np.abs(values.mean(axis=0) - 1) <= 4 * error + 1e-6).all(), (values.mean(axis=0), error)
    assert error.max() < 0.02


@pytest.mark.parametrize(
    ("depth", "name"),
    [
        pytest.param(
            d,
            name,
            marks=pytest.mark.slow if d == 30 and name in ("Rayleigh", "backward", "a mirror") else (),
        )
        for d in (1e-6, 1.0, 30.0)
        for name in PHASES
    ],
)
def test_a_white_ball_in_an_even_sky_is_invisible(name, depth):
    medium = rw.Homogeneous(0.0, depth, PHASES[name])
    assert_invisible(rw.Scene([ball(rw.MediumInterface(medium))], environment=SKY), 16 if depth > 10 else 64)


def test_so_is_one_of_noise_of_colors_and_of_glass():
    box = [(-1, -1, -1), (1, 1, 1)]
    for at in ("corners", "centers"):
        cloud = rw.GridMedium(NOISE, box, scattering=(1, 5, 20), phase=rw.HenyeyGreenstein(0.6), at=at)
        assert_invisible(rw.Scene([ball(rw.MediumInterface(cloud))], environment=SKY))
    colored = rw.Homogeneous(0.0, (0.1, 2.0, 9.0))
    assert_invisible(rw.Scene([ball(rw.MediumInterface(colored))], environment=SKY))
    for roughness in (0.0, 0.4):
        # On average, rough glass compensates its loss to half a percent.
        glass = rw.Dielectric(1.4, roughness, interior=rw.Homogeneous(0.0, 3.0))
        image = rw.render(
            rw.Scene([ball(glass)], environment=SKY),
            rw.Camera((0, 0, 3), (0, 0, 0), fov=30, width=16, height=16),
            rw.Path(),
            128,
            progress=False,
        )
        assert image.rgb.mean() == pytest.approx(1, abs=0.01)


@pytest.mark.slow
def test_so_is_one_of_an_optical_depth_of_ten_thousand():
    """Where no light can be asked for, for it would have to come through glass, every path brings all that it
    has kept: a path that is lost would be a black pixel. Rounds of roulette at the glass end one in 4,096, so
    that more than two of 64 are lost once in a thousand times at most."""
    medium = rw.Homogeneous(0.0, 1e4)
    camera = rw.Camera((0, 0, 3), (0, 0, 0), fov=30, width=8, height=8)
    glass = ball(rw.Dielectric(1.0001, interior=medium))
    image = rw.render(rw.Scene([glass], environment=SKY), camera, rw.Path(), 1, progress=False)
    assert (np.abs(image.rgb[..., 0] - 1) > 0.002).sum() <= 2


def test_cameras_and_lamps_stand_in_media():
    medium = rw.Homogeneous(0.0, 2.0)
    inside = rw.Camera((0.1, 0.2, 0.3), (1, 0, 0), fov=80, width=16, height=16)
    assert_invisible(rw.Scene([ball(rw.MediumInterface(medium))], environment=SKY), camera=inside)
    # A lamp in an absorbing ball, from outside of it and from within.
    lamp = rw.Sphere((0, 0, 0), 0.1, material=rw.Diffuse(0), emission=1.0)
    scene = rw.Scene([ball(rw.MediumInterface(rw.Homogeneous(2.0))), lamp])
    for distance, way in [(3.0, 0.9), (0.5, 0.4)]:
        camera = rw.Orthographic((0, 0, distance), (0, 0, 0), scale=1e-3, width=2, height=2)
        for integrator in (rw.Path(), rw.Direct(), rw.Whitted()):
            image = rw.render(scene, camera, integrator, 1, progress=False)
            assert image.rgb == pytest.approx(math.exp(-2 * way), rel=1e-4)


def test_shadows_are_as_deep_as_what_light_comes_through():
    # A floor under a point light, through an absorbing slab, in absorbing haze.
    floor = rw.Plane((0, 0, -3), material=rw.Diffuse(0.5))
    slab = media.slab(rw.Homogeneous((1.0, 0.5, 0.0)))
    lamp = rw.PointLight((0, 0, 1), 4.0)
    camera = rw.Orthographic((0, 0, -2.5), (0, 0, -3), up=(0, 1, 0), scale=1e-4, width=2, height=2)
    expected = 0.5 / math.pi * 4 / 16
    for haze, depth in [(None, 0.0), (rw.Homogeneous(0.1), 0.1 * (0.5 + 2 + 1))]:
        scene = rw.Scene([floor, slab], lights=[lamp], medium=haze)
        for integrator in (rw.Path(1), rw.Direct(), rw.Whitted()):
            image = rw.render(scene, camera, integrator, 1, progress=False)
            through = np.exp(-np.array([1.0, 0.5, 0.0]) - depth)
            assert image.rgb[0, 0] == pytest.approx(expected * through, rel=1e-5)


GRIDS = {
    "linear": (lambda x: 1.2 * x, 3.0, 0.165298888221587),
    "a bump": (lambda x: 3 * np.exp(-(0.49 + (3 * x - 1) ** 2) / 0.5), 3.0, 0.251830353254435),
    "waves": (lambda x: 1 + 0.9 * np.sin(20 * x), 1.0, 0.358209844236789),
}


@pytest.mark.parametrize(
    "name", ["linear", *(pytest.param(n, marks=pytest.mark.slow) for n in ("a bump", "waves"))]
)
def test_light_comes_through_grids_as_their_optical_depth_says(name):
    f, length, expected = GRIDS[name]
    # Linear profiles stay linear between few values, in five blocks.
    density = f(np.linspace(0, 1, 33 if name == "linear" else 401)).reshape(-1, 1, 1)
    box = [(0, -1, -1), (length, 1, 1)]
    camera = rw.Orthographic((-1, 0, 0), direction=(1, 0, 0), scale=1e-3, width=16, height=16)
    absorbing = rw.GridMedium(density, box, absorption=1.0)
    scene = rw.Scene([rw.Box(*box, material=rw.MediumInterface(absorbing))], environment=SKY)
    media.assert_seen(scene, camera, 512, expected)
    # By shadow rays: the sun through it, on a sheet behind.
    sheet = rw.Mesh(
        [(9, -1, -1), (9, 1, -1), (9, 1, 1), (9, -1, 1)], [(0, 2, 1), (0, 3, 2)], material=rw.Diffuse(0.5)
    )
    sun = rw.DirectionalLight((1, 0, 0), math.pi)
    lit = rw.Scene([rw.Box(*box, material=rw.MediumInterface(absorbing)), sheet], lights=[sun])
    close = rw.Orthographic((8, 0, 0), direction=(1, 0, 0), scale=1e-3, width=16, height=16)
    media.assert_seen(lit, close, 2048, 0.5 * expected, rw.Path(1))
    # Scattering removes light as well, except for light scattered into the ray: none for a thin ray.
    scattering = rw.GridMedium(density, box, scattering=1.0)
    scene = rw.Scene([rw.Box(*box, material=rw.MediumInterface(scattering))], environment=SKY)
    media.assert_seen(scene, camera, 2048 if name == "linear" else 1024, expected, rw.Path(0))
    media.assert_seen(scene, camera, 512, expected, rw.Direct())


def test_numbers_stand_at_corners_or_in_the_middle_of_cells():
    cube = np.array([[[0, 1], [2, 3]], [[4, 0], [1, 6]]], float)
    medium = rw.GridMedium(cube, absorption=1.0)
    scene = rw.Scene([rw.Box(material=rw.MediumInterface(medium))], environment=SKY)
    way = np.ones(3) / math.sqrt(3)
    camera = rw.Orthographic(-way, direction=way, scale=1e-9, width=16, height=16)
    media.assert_seen(scene, camera, 16, 0.015210193488951, most=1e-6)
    # Along x through the middle of the cells of two: 1 and 3, half of the way each, and linear between.
    cells = rw.GridMedium(np.array([1.0, 3.0]).reshape(2, 1, 1), absorption=1.0, at="centers")
    scene = rw.Scene([rw.Box(material=rw.MediumInterface(cells))], environment=SKY)
    camera = rw.Orthographic((-1, 0.5, 0.5), direction=(1, 0, 0), scale=1e-6, width=16, height=16)
    media.assert_seen(scene, camera, 1024, math.exp(-2.0))


def test_a_grid_of_the_same_numbers_is_as_a_medium_of_one():
    # Enough cells for several blocks, with a transform, and in an instance.
    sun = rw.DirectionalLight((0.3, 0.2, -1), (3, 2, 1))
    phase = rw.HenyeyGreenstein(0.4)
    even = rw.Homogeneous((0.2, 0.4, 0.1), (1.0, 2.0, 0.5), phase)
    grid = {"absorption": (0.1, 0.2, 0.05), "scattering": (0.5, 1.0, 0.25), "phase": phase}
    dense = np.full((20, 9, 1), 2.0)
    box = [(-1, -1, -0.5), (1, 1, 0.5)]
    placed = np.diag([2.0, 2.0, 1.0, 1.0])
    placed[:3, 3] = (-1, -1, -0.5)
    small = np.diag([2.0, 4.0, 1.0, 1.0])
    small[:3, 3] = (-1, -1, -0.5)
    within = rw.Box(
        (0, 0, 0),
        (1, 0.5, 1),
        material=rw.MediumInterface(rw.GridMedium(dense, [(0, 0, 0), (1, 0.5, 1)], **grid)),
    )
    scenes = [
        rw.Box(*box, material=rw.MediumInterface(even)),
        rw.Box(*box, material=rw.MediumInterface(rw.GridMedium(dense, box, **grid))),
        rw.Box(
            *box, material=rw.MediumInterface(rw.GridMedium(dense, transform=placed, at="centers", **grid))
        ),
        rw.Instance([within], small),
    ]
    camera = rw.Camera((2, -3, 2), (0, 0, 0), up=(0, 0, 1), fov=40, width=24, height=24)
    images = [
        rw.render(rw.Scene(s, lights=[sun], environment=0.3), camera, rw.Path(), 256, progress=False)
        for s in scenes
    ]
    truth = images[0]
    for image in images[1:]:
        blocks = [i.rgb.astype(float).reshape(3, 8, 3, 8, 3).mean((1, 3)) for i in (truth, image)]
        errors = [
            (i.standard_error.astype(float) ** 2).reshape(3, 8, 3, 8, 3).sum((1, 3)) / 64**2
            for i in (truth, image)
        ]
        # Five standard errors: chance exceeds them once in two million.
        assert (np.abs(blocks[0] - blocks[1]) <= 5 * np.sqrt(errors[0] + errors[1]) + 1e-6).all()


def test_max_depth_counts_what_scatters_and_no_boundary():
    sun = rw.DirectionalLight((0, 0, -1), 1.0)
    floor = rw.Plane((0, 0, -5), material=rw.Diffuse(0.5))
    empty = rw.MediumInterface(rw.Homogeneous())
    matched = rw.Dielectric(1.0, interior=rw.Homogeneous())
    layers = [rw.Box((-9, -9, -i - 0.8), (9, 9, -i), material=matched if i % 2 else empty) for i in range(4)]
    camera = media.looking(side=2, distance=1.0)
    plain = rw.render(rw.Scene([floor], lights=[sun]), camera, rw.Path(1), 1, progress=False)
    through = rw.render(rw.Scene([floor, *layers], lights=[sun]), camera, rw.Path(1), 1, progress=False)
    assert plain.rgb == pytest.approx(0.5 / math.pi, rel=1e-6)
    assert np.array_equal(plain.rgb, through.rgb)


def test_of_what_overlaps_the_greatest_priority_is_there():
    def image(*shapes, medium=None):
        scene = rw.Scene(list(shapes), environment=SKY, medium=medium)
        camera = rw.Orthographic((-5, 0, 0), direction=(1, 0, 0), scale=1e-6, width=2, height=2)
        return rw.render(scene, camera, rw.Path(), 1, progress=False).rgb[0, 0, 1]

    def box(low, high, material):
        return rw.Box((low, -1, -1), (high, 1, 1), material=material)

    thin, thick = rw.Homogeneous(1.0), rw.Homogeneous(3.0)
    for thin_first in (True, False):
        # From 0 to 2 and from 1 to 3, with one or the other in the middle; at equal priority, the later one.
        for priorities, depth in [((1, 0), 1 + 1 + 3), ((0, 1), 1 + 3 + 3), ((0, 0), 7 if thin_first else 5)]:
            both = [
                box(0, 2, rw.MediumInterface(thin, priorities[0])),
                box(1, 3, rw.MediumInterface(thick, priorities[1])),
            ]
            assert image(*(both if thin_first else both[::-1])) == pytest.approx(math.exp(-depth), rel=1e-5)
    # Two equal ones count twice, and haze fills the rest.
    apart = [box(0, 1, rw.MediumInterface(thin)), box(2, 3, rw.MediumInterface(thin))]
    assert image(*apart) == pytest.approx(math.exp(-2), rel=1e-5)
    touching = [
        box(0, 1, rw.MediumInterface(thin)),
        box(1, 2, rw.MediumInterface(thin)),
        box(2, 3, rw.MediumInterface(thick)),
    ]
    assert image(*touching) == pytest.approx(math.exp(-5), rel=1e-5)
    within = [box(0, 3, rw.MediumInterface(thin)), box(1, 2, rw.MediumInterface(thick, 1))]
    assert image(*within) == pytest.approx(math.exp(-5), rel=1e-5)
    behind = rw.Plane((4, 0, 0), (-1, 0, 0), material=rw.Diffuse(0), emission=1.0)
    assert image(behind, box(0, 3, rw.MediumInterface(thick)), medium=rw.Homogeneous(0.1)) == pytest.approx(
        math.exp(-9 - 0.1 * 6), rel=1e-4
    )
    # Copies of one object, with separate numbers for their media.
    copies = np.tile(np.eye(4), (3, 1, 1))
    copies[:, 0, 3] = [0, 1, 1.5]
    many = rw.Instance([box(0, 1, rw.MediumInterface(thin))], copies)
    assert image(many) == pytest.approx(math.exp(-2.5), rel=1e-5)


def test_pictures_are_the_same_for_any_threads_and_batches():
    cloud = rw.GridMedium(NOISE, [(-1, -1, -1), (1, 1, 1)], absorption=0.3, scattering=(3, 4, 6))
    scene = rw.Scene([ball(rw.MediumInterface(cloud))], lights=[rw.PointLight((2, 2, 2), 9)], environment=0.2)
    camera = rw.Camera((0, 0, 4), (0, 0, 0), fov=40, width=20, height=12)
    one = rw.render(scene, camera, rw.Path(), 8, threads=1, progress=False)
    two = rw.render(scene, camera, rw.Path(), 8, threads=2, progress=False)
    assert np.array_equal(one.rgb, two.rgb)
    other = rw.render(scene, camera, rw.Path(), 8, seed=1, progress=False)
    assert not np.array_equal(one.rgb, other.rgb)


def test_standard_errors_cover():
    """Of 60 pictures of 64 samples, the mean over pixels lies within 1.96 of its standard errors of the truth
    95 times of 100; fewer than 49 of 60 happen once in ten thousand."""
    scene = rw.Scene([media.slab(media.of_depth(2.0, 0.9, 0.75))], environment=SKY)
    scene = rw.Scene([*scene.shapes, rw.Plane((0, 0, -2), material=rw.Diffuse(0))], environment=SKY)
    inside = 0
    for seed in range(60):
        image = rw.render(scene, media.looking(side=4), rw.Path(), 64, seed=seed, progress=False)
        error = math.sqrt((image.standard_error[..., 1].astype(float) ** 2).sum()) / 16
        inside += abs(image.rgb[..., 1].mean(dtype=float) - 0.0973946386706) < 1.96 * error
    assert inside >= 49


OTHERS = [
    rw.RayCast(),
    rw.integrators.Distributed(),
    rw.integrators.BeamTraced(),
    rw.AmbientOcclusion(),
]


@pytest.mark.parametrize("integrator", OTHERS, ids=lambda i: type(i).__name__)
def test_who_knows_nothing_of_media_says_so(integrator):
    lamp = rw.PointLight((0, 0, 3), 1)
    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=4, height=4)
    for scene in (
        rw.Scene([ball(rw.MediumInterface(rw.Homogeneous(1)))], lights=[lamp]),
        rw.Scene([ball(rw.Diffuse())], lights=[lamp], medium=rw.Homogeneous(1)),
        rw.Scene(
            [rw.Instance([ball(rw.Dielectric(1.5, interior=rw.Homogeneous(1)))], np.eye(4))], lights=[lamp]
        ),
    ):
        with pytest.raises(ValueError, match="does not support media"):
            rw.render(scene, camera, integrator, 4, progress=False)


def test_scenes_without_media_are_as_they_were():
    clear = rw.Scene([ball(rw.Dielectric(1.5))], environment=SKY)
    assert clear.medium is None
    assert "smoke and haze" not in clear.plan().needed
    hazy = clear.replace(medium=rw.Homogeneous(0.1))
    assert hazy != clear
    assert hazy.replace(medium=None) == clear
    assert hazy.medium == rw.Homogeneous(0.1)
    assert pickle.loads(pickle.dumps(hazy)) == hazy
    assert "medium=Homogeneous(" in repr(hazy)
    assert "smoke and haze" in hazy.plan().needed
    camera = rw.Camera((0, 0, 4), (0, 0, 0), width=4, height=4)
    before, after = (
        rw.render(s, camera, rw.Path(), 4, progress=False).rgb for s in (clear, hazy.replace(medium=None))
    )
    assert np.array_equal(before, after)


def test_media_compare_print_and_pickle():
    grid = rw.GridMedium(NOISE, scattering=2, emission=NOISE[..., None].repeat(3, -1))
    assert grid == pickle.loads(pickle.dumps(grid))
    assert hash(grid) == hash(pickle.loads(pickle.dumps(grid)))
    assert grid != rw.GridMedium(NOISE, scattering=2)
    assert grid != rw.GridMedium(NOISE * 2, scattering=2, emission=grid.emission)
    assert repr(rw.GridMedium(NOISE)) == "GridMedium(<6 x 5 x 7>)"
    assert not grid.density.flags.writeable
    assert rw.GridMedium(grid.density).density is grid.density
    haze = rw.Homogeneous(0.1, (1, 2, 3), rw.media.Rayleigh())
    assert haze == pickle.loads(pickle.dumps(haze)) != rw.Homogeneous(0.1, (1, 2, 3))
    glass = rw.Dielectric(1.5, interior=haze)
    assert glass == pickle.loads(pickle.dumps(glass)) != rw.Dielectric(1.5)
    assert (
        rw.MediumInterface(haze, 2)
        == pickle.loads(pickle.dumps(rw.MediumInterface(haze, 2)))
        != rw.MediumInterface(haze)
    )


@pytest.mark.parametrize(
    ("make", "error", "says"),
    [
        (lambda: rw.Homogeneous(-1), ValueError, "absorption must be at least 0"),
        (lambda: rw.Homogeneous(0, float("nan")), ValueError, "scattering must be finite"),
        (lambda: rw.Homogeneous(0, 1, emission=(1, 2)), ValueError, "emission must be one number or 3"),
        (lambda: rw.Homogeneous(0, 1, 0.5), TypeError, "phase must be one of"),
        (lambda: rw.HenyeyGreenstein(1), ValueError, "g must be between -1 and 1"),
        (lambda: rw.HenyeyGreenstein("a"), TypeError, "g must be"),
        (lambda: rw.GridMedium(np.ones((2, 2))), ValueError, r"density must have shape \(X, Y, Z\)"),
        (lambda: rw.GridMedium(np.ones((2, 0, 2))), ValueError, "not be empty"),
        (lambda: rw.GridMedium(-np.ones((1, 1, 2))), ValueError, r"at least 0, got -1.0 at \[0, 0, 0\]"),
        (lambda: rw.GridMedium([[[1, float("nan")]]]), ValueError, r"got nan at \[0, 0, 1\]"),
        (lambda: rw.GridMedium([[[1, 1e39]]]), ValueError, "must be finite"),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), [(0, 0, 0), (1, 0, 1)]),
            ValueError,
            "bounds must be finite",
        ),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), transform=np.eye(3)),
            ValueError,
            "transform must have shape",
        ),
        (lambda: rw.GridMedium(np.ones((1, 1, 1)), at="edges"), ValueError, "at must be one of"),
        (
            lambda: rw.GridMedium(np.ones((1, 1, 1)), emission=np.ones((1, 1, 1, 2))),
            ValueError,
            "emission must",
        ),
        (lambda: rw.GridMedium("smoke.vdb"), TypeError, "density must be"),
        (lambda: rw.GridMedium.load("smoke.raw"), ValueError, "a .npy, a .vol or a .vdb"),
        (lambda: rw.GridMedium.load(3), TypeError, "path must be"),
        (lambda: rw.MediumInterface(None), TypeError, "interior must be a raywright medium"),
        (lambda: rw.MediumInterface(rw.Diffuse()), TypeError, "interior must be a raywright medium"),
        (lambda: rw.Dielectric(1.5, interior=0.5), TypeError, "interior must be a raywright medium"),
        (lambda: rw.Scene([], medium="fog"), TypeError, "medium must be a raywright medium"),
    ],
)
def test_what_cannot_be_is_refused(make, error, says):
    with pytest.raises(error, match=says) as told:
        make()
    assert "\n" not in str(told.value)


def test_a_grid_that_lies_nowhere_is_refused_with_the_scene():
    flat = rw.GridMedium(np.ones((1, 1, 1)), transform=np.diag([1.0, 1.0, 0.0, 1.0]))
    scene = rw.Scene([ball(rw.MediumInterface(flat))])
    with pytest.raises(ValueError, match="transform has no inverse"):
        scene.build(progress=False)


def test_densities_are_read_from_files(tmp_path):
    np.save(tmp_path / "smoke.npy", NOISE)
    loaded = rw.GridMedium.load(tmp_path / "smoke.npy", scattering=2)
    assert loaded == rw.GridMedium(NOISE, scattering=2)
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 6, 5, 7, 1, -1, -2, -3, 1, 2, 3)
    # x runs fastest.
    data = NOISE.astype("<f4").transpose(2, 1, 0).tobytes()
    (tmp_path / "smoke.vol").write_bytes(header + data)
    loaded = rw.GridMedium.load(str(tmp_path / "smoke.vol"), absorption=1)
    assert loaded == rw.GridMedium(NOISE, [(-1, -2, -3), (1, 2, 3)], absorption=1, at="centers")
    assert rw.GridMedium.load(tmp_path / "smoke.vol", [(0, 0, 0), (1, 1, 1)], at="corners") == rw.GridMedium(
        NOISE
    )
    with pytest.raises(FileNotFoundError):
        rw.GridMedium.load(tmp_path / "none.npy")
    for name, content, says in [
        ("a.npy", b"not an array", "cannot be read"),
        ("b.npy", b"", "cannot be read"),
        ("c.vol", b"VOL", "does not begin as"),
        ("d.vol", header + data[:-4], "but holds 209"),
        ("e.vol", b"VOL" + bytes([2]) + header[4:] + data, "got version 2"),
        ("f.vol", struct.pack("<3sBiiiii6f", b"VOL", 3, 1, -1, -1, 1, 1, *[0] * 6), "-1 x -1 x 1"),
    ]:
        (tmp_path / name).write_bytes(content)
        with pytest.raises(ValueError, match=says):
            rw.GridMedium.load(tmp_path / name)
