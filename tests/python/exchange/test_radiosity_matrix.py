"""Radiosity and radiative exchange by the matrix of view factors."""

from typing import Any

import numpy as np
import pytest
import trimesh
from radiosity_scenes import mean, room, square

import raywright as rw

# A warm room without lamps.
DARK = room(0.6, (0,) * 6)


def by_matrix(scene: rw.Scene, **options: Any) -> rw.exchange.RadiositySolution:
    return rw.radiosity(scene, method="matrix", progress=False, **options)


def assert_books(solution: rw.exchange.RadiositySolution, within: float) -> None:
    for emitted, absorbed, escaped in zip(solution.emitted, solution.absorbed, solution.escaped, strict=True):
        assert abs(emitted - absorbed - escaped) <= within * emitted


def test_every_face_of_an_even_enclosure_has_the_same() -> None:
    ball = trimesh.creation.icosphere(1)
    convex = rw.Mesh(ball.vertices, ball.faces[:, ::-1], material=rw.Diffuse(0.6), emission=1 / np.pi)
    for scene in (rw.Scene([convex]), room(0.6)):
        found = by_matrix(scene, patch_size=0.8)
        np.testing.assert_allclose(found.radiosity, 2.5, rtol=1e-9)
        assert not found.standard_error.any()
        assert_books(found, 1e-9)


def test_the_mean_over_an_enclosure_follows_from_its_books() -> None:
    found = by_matrix(room(0.5, (1, 0, 0, 0, 0, 0)), patch_size=0.5)
    np.testing.assert_allclose(np.average(found.radiosity, axis=0, weights=found.areas), 1 / 3, rtol=1e-9)
    assert max(np.abs(found.escaped)) < 1e-9
    assert_books(found, 1e-9)


def test_two_squares_approach_the_continuous_solution() -> None:
    off = []
    for patches in (4, 8):
        scene = rw.Scene([square(0, True, 0.5, 1), square(1, False, 0.5)])
        found = by_matrix(scene, patch_size=np.sqrt(2) / patches)
        off.append(abs(mean(found, found.radiosity, 1) / 0.100947189238679 - 1))
        assert abs(mean(found, found.radiosity, 0) / 1.01021805505982 - 1) < 1e-4
        assert_books(found, 1e-6)
    # Constant patches err by the square of their size: a quarter, or less, for half of it.
    assert off[1] < 0.35 * off[0] < 1e-3


def test_rays_and_matrix_agree_on_the_cornell_box() -> None:
    scene, _ = rw.scenes.cornell_box()
    found = by_matrix(scene, patch_size=250.0)
    rays = rw.radiosity(scene, error=0.02, patch_size=250.0, sides="front", progress=False)
    both = np.hypot(found.standard_error, rays.standard_error) + 0.002 * rays.radiosity.mean()
    off = np.abs(found.radiosity - rays.radiosity) / both
    # Errors of 7 degrees of freedom are beyond 5 in 1 of 600 cases.
    assert np.mean(off > 5) < 0.01
    np.testing.assert_allclose(found.escaped, rays.escaped, rtol=0.02)


def test_lights_that_are_no_surfaces_come_by_rays() -> None:
    scene = rw.Scene(room(0.5, (0,) * 6).shapes, rw.PointLight((0.5, 0.5, 0.5), 1.0))
    found = by_matrix(scene, rays=2**16)
    # 4 π W in all; half is reflected again and again.
    absorbed = np.array(found.absorbed)
    np.testing.assert_allclose(absorbed, 4 * np.pi, rtol=0.01)
    assert found.standard_error.all()
    assert_books(found, 1e-9)


def test_an_even_temperature_exchanges_nothing() -> None:
    found = rw.radiative_exchange(DARK, 300.0, [0.2, 0.4, 0.6, 0.8, 0.9, 1.0], progress=False)
    sent = 5.670374419184429e-8 * 300.0**4
    assert abs(found.flux).max() < 1e-9 * sent
    np.testing.assert_allclose(found.radiosity, sent, rtol=1e-9)
    assert not found.standard_error.any()


def test_what_one_wall_loses_the_others_gain() -> None:
    found = rw.radiative_exchange(DARK, [400.0] + [300.0] * 5, 0.7, progress=False)
    assert found.of(0) > 0
    assert abs(found.power.sum()) < 1e-9 * found.of(0)
    rays = rw.radiative_exchange(
        DARK, [400.0] + [300.0] * 5, 0.7, method="stochastic", rays=2**16, progress=False
    )
    assert abs(rays.of(0) / found.of(0) - 1) < 0.01


def test_what_knows_fronts_only_says_so() -> None:
    with pytest.raises(ValueError, match=r"sides must be 'front' for method='matrix'"):
        by_matrix(room(), sides="both")
    with pytest.raises(ValueError, match=r"supports at most 8192 patches, got"):
        by_matrix(room(), patch_size=0.02)
