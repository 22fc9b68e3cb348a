"""Radiosity against closed forms, its books, and what it refuses."""

import pickle
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import trimesh
from radiosity_scenes import CUBE, cube, mean, room, square, swept, zone

import raywright as rw
from raywright.exchange.patches import cut
from raywright.exchange.problem import UNSHOT, Problem


def solved(scene: rw.Scene, **options: Any) -> rw.RadiositySolution:
    return rw.radiosity(scene, **{"progress": False, "sides": "front", **options})


def assert_mean(solution: rw.RadiositySolution, shape: int, truth: float, patches: float = 0.0) -> None:
    """Within three standard errors, of at most 0.2 %, and what is unshot or patches are off by."""
    rows = (solution.patches["shape"] == shape) & (solution.patches["side"] == 1)
    areas = solution.areas[rows]
    # What comes to one patch does not come to another: their errors add up to less than independent ones.
    error = float(np.linalg.norm(areas * solution.standard_error[rows, 0]) / areas.sum())
    assert error <= 2e-3 * truth
    found = mean(solution, solution.radiosity, shape)
    assert abs(found - truth) <= 3 * error + (solution.bound + patches) * truth


def assert_books(solution: rw.RadiositySolution) -> None:
    for emitted, *parts in zip(
        solution.emitted, solution.absorbed, solution.escaped, solution.unshot, strict=True
    ):
        assert abs(emitted - sum(parts)) <= 1e-12 * emitted


def test_in_a_closed_sphere_radiosity_is_the_geometric_series() -> None:
    shell = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0.5), emission=rw.Emission(1 / np.pi, side="back"))
    found = rw.radiosity(rw.Scene([shell]), error=1e-9, rays=4096, progress=False)
    # One patch gets all that it sends: nothing is drawn that matters.
    np.testing.assert_allclose(found.radiosity, [[0] * 3, [2] * 3], rtol=1e-9)
    assert (found.error, found.escaped) == (0, (0, 0, 0))


def test_the_mean_over_any_enclosure_follows_from_its_books() -> None:
    found = solved(room(0.5, (1, 0, 0, 0, 0, 0)), error=1e-9, rays=2**14)
    average = np.average(found.radiosity, axis=0, weights=found.areas)
    np.testing.assert_allclose(average, 1 / 3, rtol=1e-9)
    assert found.escaped == (0, 0, 0)
    assert_books(found)


def test_what_is_missing_after_each_sweep_is_a_power_of_the_reflectance() -> None:
    scene = room(0.6)
    problem = Problem.of(scene, cut(scene, None), False, "face", 0, None, None)
    problem.begin(0, 1)
    missing = []
    for _ in range(29):
        arrived = problem.core.arrived.mean(axis=0)
        whole = (problem.emission * problem.areas[:, None] + problem.reflectance * arrived).sum(axis=0)
        missing.append(1 - whole[0] / (6 * 2.5))
        bound = problem.bound(arrived, problem.core.books.mean(axis=0)[UNSHOT])
        # Where all reflect alike and nothing leaves, the bound is off by what of the unshot is absorbed.
        assert abs(0.6 * bound * whole[0] / 15 - missing[-1]) < 1e-12
        problem.core.shoot_all(1000, None)
    np.testing.assert_allclose(
        [missing[k] for k in (1, 5, 20)], [0.36, 0.046656, 2.19369506403779e-05], rtol=1e-9
    )
    assert missing[27] < 1e-6 < missing[26]


def test_every_face_of_an_even_enclosure_has_the_same() -> None:
    ball = trimesh.creation.icosphere(1)
    star = ball.vertices * (1 + 0.5 * (np.arange(len(ball.vertices)) % 3 == 0))[:, None]
    mesh = rw.Mesh(star, ball.faces[:, ::-1], material=rw.Diffuse(0.6), emission=1 / np.pi)
    for method in ("stochastic", "progressive"):
        found = solved(rw.Scene([mesh]), method=method, rays=2**16, error=2e-3)
        assert abs(np.average(found.radiosity[:, 0], weights=found.areas) / 2.5 - 1) <= found.bound
        # Of 80 faces, whose errors have 7 degrees of freedom each, one beyond 5 is rarer than 1 in 8.
        off = np.abs(found.radiosity[:, 0] - 2.5) / (found.standard_error[:, 0] + 2.5 * found.bound)
        assert np.sort(off)[-2] < 5


def test_a_cube_of_one_patch_a_side() -> None:
    found = solved(cube((0.5, 0.7, 0.3, 0.3, 0.8, 0.8), (1, 0, 0, 0, 0, 0)), rays=2**20, error=3e-4)
    truth = (1.117137782, 0.280955869, 0.129560233, 0.129560233, 0.315676279, 0.315676279)
    for shape, value in enumerate(truth):
        assert_mean(found, shape, value)


def test_two_squares_of_one_patch_each() -> None:
    low = rw.Polygon(CUBE[0], material=rw.Diffuse(0.5), emission=1 / np.pi)
    high = rw.Polygon(CUBE[1], material=rw.Diffuse(0.5))
    found = solved(rw.Scene([low, high]), rays=2**21, error=3e-4)
    assert_mean(found, 0, 1.0100831522749245)
    assert_mean(found, 1, 0.10091988027501761)
    assert_books(found)


def test_two_squares_in_small_patches_approach_the_continuous_solution() -> None:
    scene = rw.Scene([square(0, True, 0.5, 1), square(1, False, 0.5)])
    found = solved(scene, per="vertex", patch_size=np.sqrt(2) / 12, rays=2**21)
    assert len(found) == 4 * 144
    assert_mean(found, 0, 1.01021805505982)
    assert_mean(found, 1, 0.100947189238679)


@pytest.mark.slow
def test_corners_of_small_patches_approach_the_continuous_solution() -> None:
    # The middle, corners and middles of edges, by the middles of the patches that meet there: what these are
    # off goes with the patches' size, so that two sizes tell where it goes to. There, some 10,000 and 3,000
    # rays come to each of about three patches at four places: half a percent, and one of twice the finer less
    # the coarser.
    scene = rw.Scene([square(0, True, 0.5, 1), square(1, False, 0.5)])
    seen = []
    for sides in (12, 24):
        found = solved(scene, per="vertex", patch_size=np.sqrt(2) / sides, rays=2**25)
        places = found.corners.reshape(-1, 3)
        values = found.corner_radiosity.reshape(-1, 3)[:, 0]
        here = [
            np.concatenate([values[np.linalg.norm(places - (*place, 1), axis=1) < 1e-6] for place in alike])
            for alike in ([(0, 0)], [(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)], EDGES)
        ]
        seen.append([one.mean() for one in here])
    truth = (0.120976802028842, 0.0699750447890257, 0.0911150166561579)
    assert np.abs((2 * np.array(seen[1]) - seen[0]) / truth - 1).max() < 0.03


EDGES = [(0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5)]


def disk(height: float, up: bool, reflectance: float, emitted: float) -> rw.Mesh:
    profile = [(float(r), height) for r in np.linspace(0, 1, 9)]
    return swept(profile if up else profile[::-1], 48, reflectance, emitted)


def test_two_disks() -> None:
    found = solved(rw.Scene([disk(0, True, 0.5, 1), disk(1, False, 0.8, 0)]), per="vertex", rays=2**20)
    assert_mean(found, 0, 1.06404273389228)
    assert_mean(found, 1, 0.325778564648401)
    centre = np.linalg.norm(found.corners.reshape(-1, 3) - (0, 0, 1), axis=1) < 1e-6
    assert abs(found.corner_radiosity.reshape(-1, 3)[centre, 0].mean() / 0.427571610132653 - 1) < 0.03


@pytest.mark.parametrize(
    ("radius", "inner", "outer", "truth"),
    [
        (0.01, 0.9, 0.1, (0.900080934443101, 0.000809344431010881, 0.89927159001209)),
        (0.999, 0.05, 0.05, (0.512345599954664, 0.486679578899646, 0.0256660210550177)),
    ],
)
def test_concentric_spheres(radius: float, inner: float, outer: float, truth: tuple[float, ...]) -> None:
    ball = rw.Sphere((0, 0, 0), radius, material=rw.Diffuse(1 - inner), emission=inner / np.pi)
    shell = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(1 - outer))
    found = rw.radiosity(rw.Scene([ball, shell]), error=1e-3, rays=2**18, progress=False)
    assert_mean(found, 0, truth[0])
    within = found.radiosity[found.patches["side"] == -1][1, 0]
    off = 3 * found.standard_error[found.patches["side"] == -1][1, 0] + found.bound * truth[0]
    assert off < 0.006 * truth[1] or radius < 0.1
    assert abs(within - truth[1]) < off
    assert abs((found.radiosity - found.irradiance)[0, 0] - truth[2]) < off + 0.003 * truth[2]
    assert_books(found)


def test_zones_of_a_sphere_get_the_same() -> None:
    # Shares 0.1, 0.25 and 0.65 of the area are those of the height.
    heights = [-1, -0.8, -0.3, 1]
    shapes = [
        swept(zone(heights[i], heights[i + 1], strips), 48, rho, e)
        for i, (strips, rho, e) in enumerate(((6, 0, 2), (6, 0.5, 0), (14, 0.95, 0)))
    ]
    found = solved(rw.Scene(shapes), rays=2**18, error=1e-3)
    assert max(found.escaped) < 1e-3 * max(found.emitted)
    # The polyhedron is a sphere but for 2 %, squared.
    for shape, truth in ((1, 0.388349514563107), (2, 0.737864077669903)):
        assert abs(mean(found, found.radiosity, shape) / truth - 1) < 4e-3
    assert abs(mean(found, found.irradiance, 0) / 0.776699029126214 - 1) < 4e-3


@pytest.mark.slow
def test_a_sphere_that_hardly_absorbs() -> None:
    low, high = zone(-1, 0, 6), zone(0, 1, 6)
    found = solved(rw.Scene([swept(low, 24, 0.999, 1), swept(high, 24, 0.99)]), error=1e-2, rays=2**14)
    assert abs(mean(found, found.radiosity, 0) / 91.8181818181818 - 1) < 0.006
    assert abs(mean(found, found.radiosity, 1) / 90 - 1) < 0.006
    assert_books(found)


def test_the_cavity_of_a_sphere_looks_blacker_than_its_wall() -> None:
    wall = swept(zone(-1, float(np.cos(np.radians(30))), 20), 48, 0.5, 0.5)
    found = solved(rw.Scene([wall]), rays=2**18, error=1e-3)
    assert abs(mean(found, found.radiosity, 0) / 0.937218279705318 - 1) < 4e-3


@pytest.mark.parametrize(
    ("emissivity", "depth", "truth"),
    [(0.5, 2, (0.839427255751651, 0.808299030278271)), (0.9, 4, (0.993635214015189, 0.974662207708861))],
)
def test_the_cavity_of_a_cylinder(emissivity: float, depth: float, truth: tuple[float, float]) -> None:
    base = [(float(r), 0.0) for r in np.linspace(0, 1, 7)]
    wall = [(1.0, float(z)) for z in np.linspace(0, depth, 6 * int(depth) + 1)]
    parts = [swept(base, 32, 1 - emissivity, emissivity), swept(wall, 32, 1 - emissivity, emissivity)]
    found = solved(rw.Scene(parts), rays=2**19, per="vertex")
    opening = np.pi
    assert abs(found.escaped[0] / opening / truth[1] - 1) < 4e-3
    centre = np.linalg.norm(found.corners.reshape(-1, 3), axis=1) < 1e-6
    assert abs(found.corner_radiosity.reshape(-1, 3)[centre, 0].mean() / truth[0] - 1) < 0.006


def test_nearly_infinite_plates() -> None:
    corners = np.array(CUBE[0]) * 1000.0
    low = rw.Polygon(corners, material=rw.Diffuse(0.2), emission=0.8 / np.pi)
    high = rw.Polygon(corners[::-1] + np.array((0, 0, 1e-4)), material=rw.Diffuse(0.7))
    found = solved(rw.Scene([low, high]), rays=2**14, error=1e-9)
    # What leaves between them is some 4e-7 of all.
    np.testing.assert_allclose(found.radiosity[:, 0], [0.930232558139535, 0.651162790697674], rtol=1e-5)
    assert abs((found.radiosity - found.irradiance)[0, 0] - 0.27906976744186) < 1e-5


def test_lights_that_are_no_surfaces_shine_too() -> None:
    floor = square(0, True, 0.5, size=2e-3)
    point = rw.PointLight((0, 0, 2), 8.0)
    sun = rw.DirectionalLight((0, 1, -1), (1, 2, 3))
    lit = rw.Scene([floor], [point, sun], environment=(0.1, 0.2, 0.4))
    found = rw.radiosity(lit, rays=2**17, progress=False)
    front = found.patches["side"] == 1
    truth = 8 / 4 + np.array([1, 2, 3]) / np.sqrt(2) + np.pi * np.array([0.1, 0.2, 0.4])
    # Three standard errors of some 0.2 %, and 5 ppm for the size of the floor.
    np.testing.assert_allclose(found.irradiance[front], np.tile(truth, (2, 1)), rtol=0.01)
    np.testing.assert_allclose(
        found.irradiance[~front], np.tile(np.pi * np.array([0.1, 0.2, 0.4]), (2, 1)), rtol=0.03
    )
    assert_books(found)


def test_a_sheet_has_a_light_of_its_own_on_each_side() -> None:
    material = rw.TwoSided(rw.Diffuse((0.8, 0.1, 0.1)), rw.Diffuse((0.1, 0.1, 0.8)))
    sheet = rw.Mesh(CUBE[0], [(0, 1, 2), (0, 2, 3)], material=material)
    found = rw.radiosity(rw.Scene([sheet], rw.DirectionalLight((0, 0, -1), 1.0)), rays=4096, progress=False)
    np.testing.assert_allclose(found.radiosity[:2], np.tile((0.8, 0.1, 0.1), (2, 1)), rtol=1e-12)
    assert not found.radiosity[2:].any()
    np.testing.assert_allclose(found.reflectance[2:], np.tile((0.1, 0.1, 0.8), (2, 1)))


def test_textures_count_by_their_mean() -> None:
    floor = rw.Mesh(
        CUBE[0],
        [(0, 1, 2), (0, 2, 3)],
        uv=[(0, 0), (1, 0), (1, 1), (0, 1)],
        material=rw.Diffuse(rw.Checker(0.2, 0.8, transform=rw.UvTransform(scale=2))),
    )
    found = rw.radiosity(
        rw.Scene([floor], rw.DirectionalLight((0, 0, -1), 1.0)), rays=4096, patch_size=0.2, progress=False
    )
    front = found.patches["side"] == 1
    assert abs(np.average(found.radiosity[front, 0], weights=found.areas[front]) - 0.5) < 0.05
    assert {0.2, 0.8} <= set(np.round(found.reflectance[:, 0], 6))


def test_the_same_seed_gives_the_same_bits_on_any_number_of_threads() -> None:
    scene, _ = rw.scenes.cornell_box()
    one, two = (solved(scene, rays=2**14, threads=threads, seed=3) for threads in (1, 2))
    assert np.array_equal(one.radiosity, two.radiosity)
    assert not np.array_equal(one.radiosity, solved(scene, rays=2**14, seed=4).radiosity)


def test_progressive_states_come_nearer_shot_by_shot() -> None:
    scene = room(0.5, (1, 0, 0, 0, 0, 0))
    states = list(
        rw.radiosity(scene, method="progressive", rays=2**15, states=True, progress=False, sides="front")
    )
    bounds = [state.bound for state in states]
    assert bounds[-1] <= 0.01 < bounds[-2]
    assert all(a > b for a, b in pairwise(bounds))
    for state in states:
        assert_books(state)
    end = solved(scene, method="progressive", rays=2**15)
    assert abs(end.radiosity - states[-1].radiosity).max() < 0.02


def test_methods_agree_on_the_cornell_box() -> None:
    scene, _ = rw.scenes.cornell_box()
    options = {"patch_size": 200.0, "sides": "front"}
    one = solved(scene, error=0.02, **options)
    two = solved(scene, method="progressive", error=2e-3, rays=2**17, **options)
    both = np.hypot(one.standard_error, two.standard_error) + 0.002 * one.radiosity.mean()
    off = np.abs(one.radiosity - two.radiosity) / both
    # Differences of 14 degrees of freedom are beyond 4 in 1 of 1000 cases.
    assert np.mean(off > 4) < 0.01
    assert_books(one)
    assert_books(two)


def test_a_bar_or_a_function_is_told_how_far_it_is() -> None:
    shares: list[float] = []
    rw.radiosity(room(0.5), rays=2**12, progress=shares.append)
    assert shares == sorted(shares)
    assert shares[-1] == 1


def test_a_solution_travels() -> None:
    found = solved(room(0.3), rays=2**12)
    again = pickle.loads(pickle.dumps(found))
    assert again == found
    assert not again.radiosity.flags.writeable
    assert "12 sides of patches, stochastic" in repr(found)


@pytest.mark.parametrize("ending", ["ply", "glb", "obj"])
def test_a_solution_is_saved_as_a_coloured_mesh(tmp_path: Any, ending: str) -> None:
    scene, _ = rw.scenes.cornell_box()
    found = solved(scene, per="vertex", rays=2**14, patch_size=300.0)
    path = tmp_path / f"room.{ending}"
    found.save(path)
    mesh = trimesh.load(path, force="mesh", process=False)
    assert len(mesh.faces) == len(found)
    assert mesh.visual.kind == "vertex"
    colours = np.asarray(mesh.visual.vertex_colors)[:, :3]
    assert colours.max() == 255
    np.testing.assert_allclose(mesh.area, found.areas.sum(), rtol=1e-5)
    with pytest.raises(ValueError, match=r"path must end in"):
        found.save(tmp_path / "room.png")
    with pytest.raises(ValueError, match=r"exposure must be greater than 0"):
        found.to_mesh(0.0)
    with pytest.raises(ValueError, match=r"no back of a mesh"):
        found.to_mesh(side="back")


def test_vertices_are_smooth_within_a_plane_and_sharp_at_edges() -> None:
    faces = np.concatenate([np.array([(0, 1, 2), (0, 2, 3)]) + 4 * i for i in range(6)])
    walls = rw.Mesh(np.concatenate(CUBE), faces, material=rw.Diffuse(0.5))
    scene = rw.Scene([walls], rw.PointLight((0.3, 0.4, 0.6), 1.0))
    found = solved(scene, per="vertex", rays=2**14, patch_size=0.3)
    places = np.round(found.corners.reshape(-1, 3), 6)
    normals = np.cross(found.corners[:, 1] - found.corners[:, 0], found.corners[:, 2] - found.corners[:, 0])
    keys = np.column_stack(
        [places, np.repeat(np.round(normals / np.linalg.norm(normals, axis=1)[:, None]), 3, axis=0)]
    )
    _, group = np.unique(keys, axis=0, return_inverse=True)
    values = found.corner_irradiance.reshape(-1, 3)[:, 0]
    group = group.reshape(-1)
    sums = np.bincount(group, values) / np.bincount(group)
    np.testing.assert_allclose(values, sums[group], rtol=1e-12)
    # Where three walls meet, each has its own.
    corner = np.unique(np.round(values[(places == 0).all(axis=1)], 9))
    assert len(corner) == 3


REFUSED: list[tuple[str, Any, dict[str, Any]]] = [
    ("method must be one of", lambda: room(), {"method": "hemicube"}),
    ("per must be one of", lambda: room(), {"per": "shape"}),
    ("sides must be one of", lambda: room(), {"sides": "back"}),
    ("error must be greater than 0", lambda: room(), {"error": -1.0}),
    ("rays must be between 1", lambda: room(), {"rays": 0}),
    ("patch_size must be greater than 0", lambda: room(), {"patch_size": 0.0}),
    ("give a larger one", lambda: room(), {"patch_size": 1e-7}),
    ("states are those of method='progressive'", lambda: room(), {"states": True}),
    ("shape 0 reflects all light", lambda: room(1.0), {}),
    ("nothing shines", lambda: room(0.5, (0,) * 6), {}),
    ("scene has no shapes", lambda: rw.Scene([]), {}),
    (
        "shape 0 is of Mirror",
        lambda: rw.Scene([rw.Sphere((0, 0, 0), 1, material=rw.Mirror(), emission=1.0)]),
        {},
    ),
    (
        "face 1 of shape 0 has no area",
        lambda: rw.Scene([rw.Mesh(CUBE[0], [(0, 1, 2), (0, 1, 1)], emission=1.0)]),
        {},
    ),
    ("has no area, or no end", lambda: rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1), emission=1.0)]), {}),
    (
        "stretched",
        lambda: rw.Scene([rw.Ellipsoid((0, 0, 0), (1, 2, 3), emission=1.0)]),
        {},
    ),
]


@pytest.mark.parametrize(("line", "scene", "options"), REFUSED, ids=[line for line, _, _ in REFUSED])
def test_what_cannot_be_is_refused_in_a_line(line: str, scene: Any, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=line) as refused:
        rw.radiosity(scene(), progress=False, **options)
    assert "\n" not in str(refused.value)


def test_what_is_of_the_wrong_kind_is_refused() -> None:
    with pytest.raises(TypeError, match=r"scene must be a raywright.Scene"):
        rw.radiosity(3)  # type: ignore[call-overload]
    with pytest.raises(TypeError, match=r"progress must be"):
        rw.radiosity(room(), progress=3)  # type: ignore[call-overload]
