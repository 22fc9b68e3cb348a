"""Radiosity against closed forms, its books, and what it refuses."""

import pickle
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import trimesh
from radiosity_scenes import CUBE, cube, mean, room, square, swept, zone

import raywright as rw
from raywright.exchange.patches import cut
from raywright.exchange.problem import UNSHOT, Problem


def solved(scene: rw.Scene, **options: Any) -> rw.exchange.RadiositySolution:
    return rw.radiosity(scene, **{"progress": False, "sides": "front", **options})


def assert_mean(
    solution: rw.exchange.RadiositySolution, shape: int, truth: float, patches: float = 0.0
) -> None:
    """Within three standard errors, of at most 0.2 %, and what is unshot or patches are off by."""
    rows = (solution.patches["shape"] == shape) & (solution.patches["side"] == 1)
    areas = solution.areas[rows]
    # Light that arrives at one patch does not at another: their errors add up to less than independent ones.
    error = float(np.linalg.norm(areas * solution.standard_error[rows, 0]) / areas.sum())
    assert error <= 2e-3 * truth
    found = mean(solution, solution.radiosity, shape)
    assert abs(found - truth) <= 3 * error + (solution.bound + patches) * truth


def assert_books(solution: rw.exchange.RadiositySolution) -> None:
    for emitted, *parts in zip(
        solution.emitted, solution.absorbed, solution.escaped, solution.unshot, strict=True
    ):
        assert abs(emitted - sum(parts)) <= 1e-12 * emitted


def test_in_a_closed_sphere_radiosity_is_the_geometric_series() -> None:
    shell = rw.Sphere((0, 0, 0), 1, material=rw.Diffuse(0.5), emission=rw.Emission(1 / np.pi, side="back"))
    found = rw.radiosity(rw.Scene([shell]), error=1e-9, rays=4096, progress=False)
    # One patch receives everything that it emits: no random choice matters, and the error is unshot light.
    np.testing.assert_allclose(found.radiosity, [[0] * 3, [2] * 3], rtol=1e-9)
    assert 0 < found.error <= 1e-9
    assert found.escaped == (0, 0, 0)


def test_told_errors_of_radiosity_hold_what_is_unshot() -> None:
    # The walls of a uniform enclosure have E / (1 - R), without a statistical error: the error is unshot
    # light.
    for method in ("stochastic", "progressive"):
        for reflectance in (0.5, 0.9):
            found = rw.radiosity(room(reflectance), method=method, rays=2**16, sides="front", progress=False)  # type: ignore[arg-type]
            truth = 1 / (1 - reflectance)
            off = np.abs(found.radiosity - truth) / found.standard_error
            assert off.max() < 4.5
            whole = np.sqrt(np.average((found.irradiance - truth) ** 2, weights=found.areas, axis=0)).max()
            assert whole <= 2 * found.error * truth


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
        # In a closed room of equal reflectance, the bound is off by the unshot light's absorbed share.
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
        # Over 80 faces, whose errors have 7 degrees of freedom each, one beyond 5 is rarer than 1 in 8.
        off = np.abs(found.radiosity[:, 0] - 2.5) / (found.standard_error[:, 0] + 2.5 * found.bound)
        assert np.sort(off)[-2] < 5


def test_a_cube_of_one_patch_a_side() -> None:
    found = solved(cube((0.5, 0.7, 0.3, 0.3, 0.8, 0.8), (1, 0, 0, 0, 0, 0)), rays=2**19, error=3e-4)
    truth = (1.117137782, 0.280955869, 0.129560233, 0.129560233, 0.315676279, 0.315676279)
    for shape, value in enumerate(truth):
        assert_mean(found, shape, value)


def test_two_squares_of_one_patch_each() -> None:
    low = rw.Polygon(CUBE[0], material=rw.Diffuse(0.5), emission=1 / np.pi)
    high = rw.Polygon(CUBE[1], material=rw.Diffuse(0.5))
    found = solved(rw.Scene([low, high]), rays=2**20, error=3e-4)
    assert_mean(found, 0, 1.0100831522749245)
    assert_mean(found, 1, 0.10091988027501761)
    assert_books(found)


def test_two_squares_in_small_patches_approach_the_continuous_solution() -> None:
    scene = rw.Scene([square(0, True, 0.5, 1), square(1, False, 0.5)])
    found = solved(scene, per="vertex", patch_size=np.sqrt(2) / 12, rays=2**21)
    assert len(found) == 4 * 144
    assert_mean(found, 0, 1.01021805505982)
    assert_mean(found, 1, 0.100947189238679)


def at_corners(found: rw.exchange.RadiositySolution, places: list[tuple[float, float, float]]) -> float:
    """The mean of what corners of patches have, of those that lie at these places."""
    corners, values = found.corners.reshape(-1, 3), found.corner_radiosity.reshape(-1, 3)[:, 0]
    here = [np.linalg.norm(corners - place, axis=1) < 1e-6 for place in places]
    return float(np.mean(np.concatenate([values[at] for at in here])))


def test_corners_of_small_patches_approach_the_continuous_solution() -> None:
    # The middle, corners and middles of edges of both, from the middles of adjacent patches. Their error
    # depends on the patches' size and its square, so that three sizes give the limit.
    scene = rw.Scene([square(0, True, 0.5, 1), square(1, False, 0.5)])
    kinds = ([(0, 0)], [(x, y) for x in (-0.5, 0.5) for y in (-0.5, 0.5)], EDGES)
    seen = []
    for sides in (4, 8, 16):
        found = solved(scene, per="vertex", method="matrix", patch_size=np.sqrt(2) / sides)
        seen.append([at_corners(found, [(x, y, z) for x, y in alike]) for z in (0, 1) for alike in kinds])
    coarse, finer = (2 * fine - rough for rough, fine in pairwise(np.array(seen)))
    truth = (1.01232676296358, 1.00700634835602, 1.00919121580736)
    truth += (0.120976802028842, 0.0699750447890257, 0.0911150166561579)
    assert np.abs((4 * finer - coarse) / 3 / truth - 1).max() < 0.002


EDGES = [(0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5)]


def assert_limit(
    scene: Callable[[int], rw.Scene], seen: Callable[[rw.exchange.RadiositySolution], Any], truth: Any
) -> None:
    """Flat faces are off what they stand for by the square of their size: two sizes tell where it goes to.

    Nothing is sampled. The next term is of the fourth power, and a tenth of what samples may be off, 0.2 %.
    """
    rough, fine = (np.array(seen(solved(scene(cuts), per="vertex", method="matrix"))) for cuts in (1, 2))
    assert np.abs(fine / truth - 1).max() < 0.02
    assert np.abs((4 * fine - rough) / 3 / truth - 1).max() < 2e-4


def test_two_disks() -> None:
    def disk(height: float, up: bool, cuts: int, reflectance: float, emitted: float) -> rw.Mesh:
        profile = [(float(r), height) for r in np.linspace(0, 1, 2 * cuts + 1)]
        return swept(profile if up else profile[::-1], 12 * cuts, reflectance, emitted)

    assert_limit(
        lambda cuts: rw.Scene([disk(0, True, cuts, 0.5, 1), disk(1, False, cuts, 0.8, 0)]),
        lambda found: [
            *(mean(found, found.radiosity, shape) for shape in (0, 1)),
            *(at_corners(found, [(0, 0, height)]) for height in (0, 1)),
        ],
        (1.06404273389228, 0.325778564648401, 1.08701971534618, 0.427571610132653),
    )


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
    found = rw.radiosity(rw.Scene([ball, shell]), error=1e-5, rays=2**14, progress=False)
    within = found.patches["side"] == -1
    values = np.array([found.radiosity[0, 0], found.radiosity[within][1, 0]])
    errors = np.array([found.standard_error[0, 0], found.standard_error[within][1, 0]])
    # The ball loses B - H = B - (B - E) / rho.
    values = np.append(values, found.radiosity[0, 0] - found.irradiance[0, 0])
    errors = np.append(errors, errors[0] * inner / (1 - inner))
    assert (errors < 0.002 * np.array(truth)).all()
    assert (np.abs(values - truth) <= 3 * errors + found.bound).all()
    assert_books(found)


def test_zones_of_a_sphere_get_the_same() -> None:
    # Shares 0.1, 0.25 and 0.65 of the area equal those of the height.
    heights = [-1, -0.8, -0.3, 1]

    def scene(cuts: int) -> rw.Scene:
        return rw.Scene(
            [
                swept(zone(*ends, strips * cuts), 12 * cuts, rho, e)
                for ends, (strips, rho, e) in zip(
                    pairwise(heights), ((2, 0, 2), (2, 0.5, 0), (4, 0.95, 0)), strict=True
                )
            ]
        )

    assert_limit(
        scene,
        lambda found: [
            *(mean(found, found.radiosity, shape) for shape in (1, 2)),
            mean(found, found.irradiance, 0),
        ],
        (0.388349514563107, 0.737864077669903, 0.776699029126214),
    )


def test_a_sphere_that_hardly_absorbs() -> None:
    def scene(cuts: int) -> rw.Scene:
        low, high = zone(-1, 0, 2 * cuts), zone(0, 1, 2 * cuts)
        return rw.Scene([swept(low, 10 * cuts, 0.999, 1), swept(high, 10 * cuts, 0.99)])

    assert_limit(
        scene,
        lambda found: [mean(found, found.radiosity, shape) for shape in (0, 1)],
        (91.8181818181818, 90),
    )
    # By rays, some 180 bounces each.
    found = solved(scene(2), error=1e-2, rays=2**14)
    assert_books(found)
    assert abs(mean(found, found.radiosity, 0) / 91.8181818181818 - 1) < 3 * 0.002 + found.bound


def test_the_cavity_of_a_sphere_looks_blacker_than_its_wall() -> None:
    assert_limit(
        lambda cuts: rw.Scene(
            [swept(zone(-1, float(np.cos(np.radians(30))), 3 * cuts), 10 * cuts, 0.5, 0.5)]
        ),
        lambda found: mean(found, found.radiosity, 0),
        0.937218279705318,
    )


@pytest.mark.parametrize(
    ("emissivity", "depth", "truth"),
    [
        (0.5, 2, (0.839427255751651, 0.808299030278271)),
        pytest.param(0.9, 4, (0.993635214015189, 0.974662207708861), marks=pytest.mark.slow),
    ],
)
def test_the_cavity_of_a_cylinder(emissivity: float, depth: float, truth: tuple[float, float]) -> None:
    def scene(cuts: int) -> rw.Scene:
        base = [(float(r), 0.0) for r in np.linspace(0, 1, 2 * cuts + 1)]
        wall = [(1.0, float(z)) for z in np.linspace(0, depth, 2 * cuts * int(depth) + 1)]
        return rw.Scene([swept(part, 10 * cuts, 1 - emissivity, emissivity) for part in (base, wall)])

    assert_limit(scene, lambda found: [at_corners(found, [(0, 0, 0)]), found.escaped[0] / np.pi], truth)


def test_nearly_infinite_plates() -> None:
    corners = np.array(CUBE[0]) * 1000.0
    low = rw.Polygon(corners, material=rw.Diffuse(0.2), emission=0.8 / np.pi)
    high = rw.Polygon(corners[::-1] + np.array((0, 0, 1e-4)), material=rw.Diffuse(0.7))
    found = solved(rw.Scene([low, high]), rays=2**14, error=1e-9)
    # The loss through the gap between them is some 4e-7 of all.
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
        material=rw.Diffuse(rw.Checker(0.2, 0.8, transform=rw.textures.UvTransform(scale=2))),
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
def test_a_solution_is_saved_as_a_colored_mesh(tmp_path: Any, ending: str) -> None:
    scene, _ = rw.scenes.cornell_box()
    found = solved(scene, per="vertex", rays=2**14, patch_size=300.0)
    path = tmp_path / f"room.{ending}"
    found.save(path)
    mesh = trimesh.load(path, force="mesh", process=False)
    assert len(mesh.faces) == len(found)
    assert mesh.visual.kind == "vertex"
    colors = np.asarray(mesh.visual.vertex_colors)[:, :3]
    assert colors.max() == 255
    np.testing.assert_allclose(mesh.area, found.areas.sum(), rtol=1e-5)
    with pytest.raises(ValueError, match=r"path must end in"):
        found.save(tmp_path / "room.png")
    with pytest.raises(ValueError, match=r"exposure must be greater than 0"):
        found.to_mesh(0.0)
    with pytest.raises(ValueError, match=r"no back side of a mesh"):
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
    # At a corner of three walls, each has its own value.
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
    ("states requires method='progressive'", lambda: room(), {"states": True}),
    ("shape 0 reflects all light", lambda: room(1.0), {}),
    ("the scene has no light", lambda: room(0.5, (0,) * 6), {}),
    ("scene has no shapes", lambda: rw.Scene([]), {}),
    (
        "shape 0 is of Mirror",
        lambda: rw.Scene([rw.Sphere((0, 0, 0), 1, material=rw.Mirror(), emission=1.0)]),
        {},
    ),
    (
        "scene must have no medium",
        lambda: rw.Scene([*room().shapes], medium=rw.Homogeneous(1.0)),
        {},
    ),
    ("must have a finite area above 0", lambda: rw.Scene([rw.Plane((0, 0, 0), (0, 0, 1), emission=1.0)]), {}),
    (
        "nonuniform scale",
        lambda: rw.Scene([rw.shapes.Ellipsoid((0, 0, 0), (1, 2, 3), emission=1.0)]),
        {},
    ),
]


@pytest.mark.parametrize(("line", "scene", "options"), REFUSED, ids=[line for line, _, _ in REFUSED])
def test_what_cannot_be_is_refused_in_a_line(line: str, scene: Any, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=line) as refused:
        rw.radiosity(scene(), progress=False, **options)
    assert "\n" not in str(refused.value)


def test_what_is_of_the_wrong_kind_is_refused() -> None:
    with pytest.raises(TypeError, match=r"shapes must be a Mesh, .* got builtins.int"):
        rw.radiosity(3)
    with pytest.raises(TypeError, match=r"progress must be"):
        rw.radiosity(room(), progress=3)  # type: ignore[call-overload]


def test_shapes_exchange_light_as_their_scene_does() -> None:
    corners = np.array([(x, y, z) for z in (0.0, 1.0) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
    lamp = rw.Mesh(corners[4:], [(0, 2, 1), (0, 3, 2)], emission=1.0)
    parts = {"below": (corners[:4], [(0, 1, 2, 3)]), "above": lamp}
    scene = rw.Scene(parts)
    quiet: dict[str, Any] = {"progress": False}
    assert np.array_equal(rw.view_factors(parts, **quiet).matrix, rw.view_factors(scene, **quiet).matrix)
    heat = (rw.radiative_exchange(of, [300.0, 400.0], **quiet) for of in (parts, scene))
    assert np.array_equal(*(found.flux for found in heat))
    light = (rw.radiosity(of, **quiet) for of in (parts, scene))
    assert np.array_equal(*(found.radiosity for found in light))
    assert rw.view_factors(parts, **quiet).to_surroundings.max() < 1
