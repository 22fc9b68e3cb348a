"""Laser scans, against closed forms."""

import numpy as np
import pytest
import trimesh

import raywright as rw

measure = rw.measure

BALL = rw.Sphere((6.0, 0.0, 0.0), 1.5, name="ball")
RASTER = measure.RasterLidar(columns=81, rows=61, horizontal=40, vertical=30)


def away(scanner, towards=(1.0, 0, 0)):
    """The angle between each beam and a direction."""
    ways = scanner.directions()
    return np.arctan2(np.linalg.norm(np.cross(ways, towards), axis=-1), ways @ towards)


def test_a_ball_is_as_far_as_it_is():
    """At an angle a from its middle, a ball of radius r is D cos a - sqrt(r^2 - D^2 sin^2 a) away, and
    its normal is
    tilted by arcsin(D sin a / r).
    """
    scan = measure.lidar(BALL, RASTER)
    angle = away(RASTER)
    side = 6.0 * np.sin(angle)
    met = side < 1.5
    assert scan.shape == (61, 81)
    assert np.array_equal(scan.count == 1, met)
    assert len(scan) == met.sum() > 500
    expected = 6.0 * np.cos(angle[met]) - np.sqrt(1.5**2 - side[met] ** 2)
    assert np.allclose(scan.range, expected, rtol=1e-13)
    grazing = np.degrees(np.arcsin(side[met] / 1.5))
    assert np.allclose(scan.incidence, grazing, rtol=0, atol=1e-5)
    assert np.allclose(scan.position, scan.range[:, None] * RASTER.directions()[met], rtol=1e-15)
    assert np.allclose(np.linalg.norm(scan.position - BALL.center, axis=1), 1.5, rtol=1e-13)
    assert np.array_equal(scan.image()[met], scan.range)
    assert np.isnan(scan.image()[~met]).all()
    # A whole number fills the misses, and leaves the fractions of the ranges.
    assert np.array_equal(scan.image(fill=0), np.where(met, scan.image(), 0.0))
    assert set(scan.strength) == {1.0}


def test_beams_go_where_the_scanner_says():
    """Up is y, as for the sun and everywhere in `raywright.measure`, so that left of x is -z."""
    spinning = measure.SpinningLidar(elevations=[-10, 0, 30], columns=8, forward=(0, 5, 0), up=(0, 0, 2))
    ways = spinning.directions()
    assert spinning.shape == ways.shape[:2] == (3, 8)
    assert np.allclose(np.linalg.norm(ways, axis=-1), 1)
    assert np.allclose(np.degrees(np.arcsin(ways[..., 2])), np.array([-10.0, 0, 30])[:, None] * np.ones(8))
    assert np.allclose(ways[1, 0], (0, 1, 0))
    assert np.allclose(ways[1, 2], (-1, 0, 0))  # to the left
    corners = measure.RasterLidar(columns=3, rows=3, horizontal=60, vertical=40).directions()
    turn, high = np.radians(30), np.radians(20)
    assert np.allclose(corners[1, 1], (1, 0, 0))
    first = (np.cos(high) * np.cos(turn), np.sin(high), -np.cos(high) * np.sin(turn))
    assert np.allclose(corners[0, 0], first)
    assert np.allclose(corners[2, 2], (first[0], -first[1], -first[2]))
    straight = measure.SpinningLidar(elevations=[90], columns=1).directions()[0, 0]
    noon = measure.sun_directions("2025-03-20T12:07Z", 0.0, 0.0)
    assert straight @ noon > 0.999


def test_a_scanner_that_stands_on_the_ground_does_not_measure_it_where_it_stands():
    """Beams that go up return from a dome, and those that go down from a floor below."""
    ground = trimesh.creation.box(bounds=[(-9, -1, -9), (9, 0, 9)])
    scanner = measure.SpinningLidar(elevations=[60, 1e-3, -1e-3, -60], columns=8, position=(0.3, 0, 0.1))
    scan = measure.lidar([ground, rw.Sphere((0.3, 0, 0.1), 5.0)], scanner)
    assert np.array_equal(scan.count, np.ones((4, 8)))
    assert np.allclose(scan.image()[:3], 5.0)
    assert np.allclose(scan.image()[3], 1 / np.sin(np.radians(60)))


def test_near_and_far_are_not_measured():
    near = measure.RasterLidar(columns=3, rows=3, horizontal=1, vertical=1, min_range=5.0)
    # The near side of the ball, at 4.5, hides the far side at 7.5, and a wall behind it.
    assert len(measure.lidar([BALL, rw.Plane((9.0, 0, 0), (1, 0, 0))], near)) == 0
    wall = rw.Plane((9.0, 0, 0), (1, 0, 0))
    assert np.allclose(measure.lidar(wall, near).range, 9.0, atol=0.01)
    # A beam half blocked by a post that is too near returns half from the wall.
    post = rw.Mesh([(1, -9, 0), (1, -9, 9), (1, 9, 9), (1, 9, 0)], [(0, 1, 2), (0, 2, 3)])
    wide = measure.SpinningLidar(elevations=[0], columns=1, divergence=1.0, rays=100, min_range=2.0)
    scan = measure.lidar([post, wall], wide)
    assert np.allclose(scan.range, [9.0], rtol=1e-4)
    assert np.array_equal(scan.number, [0])
    assert np.allclose(scan.strength, 0.5, atol=0.1)
    far = measure.RasterLidar(columns=3, rows=3, horizontal=1, vertical=1, max_range=4.0)
    assert len(measure.lidar(BALL, far)) == 0


def test_noise_has_the_spread_that_was_asked_for():
    """Of n numbers the mean is within 4 / sqrt(n) deviations, and the deviation within 4 / sqrt(2 n) of
    itself: 1e-4 each.
    """
    wall = rw.Plane((10.0, 0, 0), (1, 0, 0))
    exact = measure.lidar(wall, RASTER)
    n = len(exact)
    noisy = measure.lidar(wall, RASTER, range_sigma=0.03, range_sigma_share=0.004, seed=7)
    expected = np.sqrt(0.03**2 + (0.004 * exact.range) ** 2)
    standard = (noisy.range - exact.range) / expected
    assert abs(standard.mean()) < 4 / np.sqrt(n)
    assert abs(standard.std() - 1) < 4 / np.sqrt(2 * n)
    assert np.allclose(np.linalg.norm(noisy.position, axis=1), noisy.range)
    again = measure.lidar(wall, RASTER, range_sigma=0.03, range_sigma_share=0.004, seed=7, threads=1)
    assert np.array_equal(noisy.range, again.range)
    assert not np.array_equal(noisy.range, measure.lidar(wall, RASTER, range_sigma=0.03, seed=8).range)
    # Losses remove returns, and change none.
    lossy = measure.lidar(wall, RASTER, range_sigma=0.03, range_sigma_share=0.004, seed=7, dropout=0.5)
    assert np.array_equal(lossy.range, noisy.range[np.isin(noisy.beam, lossy.beam)])


def test_noise_stays_within_the_limits_of_the_range():
    """Of a wall at one limit, half of the ranges would lie beyond it."""
    for limits in ({"min_range": 10.0}, {"max_range": 10.001}):
        scanner = measure.RasterLidar(columns=20, rows=20, horizontal=0.5, vertical=0.5, **limits)
        scan = measure.lidar(rw.Plane((10.0, 0, 0), (1, 0, 0)), scanner, range_sigma=0.5)
        assert len(scan) == 400
        assert scan.range.min() >= scanner.min_range
        assert scan.range.max() <= scanner.max_range
        assert np.allclose(np.linalg.norm(scan.position, axis=1), scan.range)
        assert scan.range.std() > 0.1


@pytest.mark.parametrize("elevation", [-0.5, -1.0, -3.0, -20.0])
@pytest.mark.parametrize(("divergence", "rays"), [(0.05, 16), (0.2, 5), (0.2, 16), (0.5, 40)])
def test_flat_ground_returns_once(elevation, divergence, rays):
    """However far along the ground a beam stretches, its waveform has one peak, at the mean over its disk.

    The mean of h / sin(a + x) over a disk of radius d is h / sin a (1 + (d / a)^2 / 4) to the second order;
    200 spirals of 5 points tell it to some (d / a) / 100.
    """
    height = 1.7
    scanner = measure.SpinningLidar(
        elevations=[elevation], columns=200, position=(0, height, 0), divergence=divergence, rays=rays
    )
    scan = measure.lidar(rw.Plane((0, 0, 0), (0, 1, 0)), scanner)
    assert np.array_equal(scan.count, np.ones((1, 200)))
    assert set(scan.strength) == {1.0}
    steep = divergence / 2 / abs(elevation)
    middle = height / np.sin(np.radians(-elevation))
    assert scan.range.mean() / middle - 1 == pytest.approx(steep**2 / 4, abs=steep**4 + steep / 100 + 1e-6)


@pytest.mark.parametrize("resolution", [0.1, 0.3, 1.0])
def test_two_surfaces_are_two_returns_from_the_resolution_on(resolution):
    """Two equal pulses a full width at half maximum apart have a dip of 1 / 17 between them."""
    edge = rw.Mesh([(5, -9, 0), (5, -9, 9), (5, 9, 9), (5, 9, 0)], [(0, 1, 2), (0, 2, 3)])
    scanner = measure.SpinningLidar(
        elevations=[0], columns=1, divergence=1.0, rays=400, resolution=resolution
    )
    for apart, count in ((0.9, 1), (1.1, 2), (3.0, 2)):
        behind = rw.Plane((5 + apart * resolution, 0, 0), (1, 0, 0))
        scan = measure.lidar([edge, behind], scanner)
        assert len(scan) == count
        expected = [5.0, 5 + apart * resolution] if count == 2 else [5 + apart * resolution / 2]
        assert np.allclose(scan.range, expected, rtol=0, atol=0.05 * resolution + 1e-3)


def test_losses_are_as_likely_as_told():
    """The number of returns is within 4 deviations of the sum of their probabilities: 1e-4."""
    wall = rw.Plane((10.0, 0, 0), (1, 0, 0))
    exact = measure.lidar(wall, RASTER)
    cosine = np.cos(np.radians(exact.incidence))
    assert np.allclose(cosine, 10 / exact.range)
    for options, kept in [
        ({"dropout": 0.3}, np.full(len(exact), 0.7)),
        ({"fading_range": 9.0}, np.exp(-((exact.range / 9.0) ** 2))),
        ({"incidence_power": 8.0}, cosine**8),
        ({"dropout": 0.1, "fading_range": 20.0, "incidence_power": 2.0},
         0.9 * np.exp(-((exact.range / 20.0) ** 2)) * cosine**2),
    ]:  # fmt: skip
        found = len(measure.lidar(wall, RASTER, seed=2, **options))
        assert abs(found - kept.sum()) < 4 * np.sqrt((kept * (1 - kept)).sum())
    assert len(measure.lidar(wall, RASTER, dropout=1.0)) == 0


def test_a_wide_beam_returns_from_all_that_it_meets():
    """Of a beam that half passes an edge, half comes from behind: a spiral of n points tells a half-disk
    to 1 / sqrt(n).
    """
    edge = rw.Mesh([(5, -9, 0), (5, -9, 9), (5, 9, 9), (5, 9, 0)], [(0, 1, 2), (0, 2, 3)])
    scene = rw.Scene([edge, rw.Plane((8.0, 0, 0), (1, 0, 0))])
    options = {"elevations": [0.0], "columns": 1, "divergence": 1.0, "rays": 400}
    scan = measure.lidar(scene, measure.SpinningLidar(**options))
    assert np.array_equal(scan.number, [0, 1])
    assert np.allclose(scan.range, (5, 8), rtol=1e-4)
    assert np.allclose(scan.strength, 0.5, atol=0.05)
    assert scan.strength.sum() == pytest.approx(1)
    assert np.array_equal(scan.shape_id, [0, 1])
    for returns, expected in (("first", [5.0]), ("last", [8.0])):
        kept = measure.lidar(scene, measure.SpinningLidar(**options), returns=returns)
        assert np.allclose(kept.range, expected, rtol=1e-4)
    strong = measure.lidar(scene, measure.SpinningLidar(**options), returns="strongest")
    assert strong.strength == scan.strength.max()
    # Returns closer than the scanner's resolution merge.
    coarse = measure.lidar(scene, measure.SpinningLidar(**options, resolution=4.0))
    assert coarse.range == pytest.approx(5 * scan.strength[0] + 8 * scan.strength[1], rel=1e-3)
    # All rays of a beam are within half its divergence: from beside the edge, none hits it.
    aside = measure.SpinningLidar(**options, start=0.51)
    assert np.allclose(measure.lidar(scene, aside).range, 8, rtol=1e-3)


def test_names_and_wrong_input():
    told = []
    measure.lidar(BALL, RASTER, progress=told.append)
    assert told[-1] == 1
    with pytest.raises(TypeError, match="scanner must be a SpinningLidar or a RasterLidar, got str"):
        measure.lidar(BALL, "scanner")
    for options, text in [
        ({"returns": "second"}, "returns must be one of 'all', 'first', 'last', 'strongest', got 'second'"),
        ({"dropout": 1.5}, "dropout must be between 0 and 1, got 1.5"),
        ({"range_sigma": -1}, "range_sigma must be at least 0, got -1"),
        ({"fading_range": 0}, "fading_range must be greater than 0, got 0"),
    ]:
        with pytest.raises(ValueError, match=text):
            measure.lidar(BALL, RASTER, **options)
    for kind, options, text in [
        (
            measure.SpinningLidar,
            {"elevations": []},
            "elevations must be one or more numbers between -90 and 90",
        ),
        (measure.SpinningLidar, {"elevations": [0], "columns": 0}, "columns must be at least 1, got 0"),
        (measure.SpinningLidar, {"elevations": [0], "up": (1, 0, 0)}, "forward must not be parallel to up"),
        (measure.RasterLidar, {"vertical": 190}, "vertical must be between 0 and 180 degrees, got 190"),
        (
            measure.RasterLidar,
            {"min_range": 3, "max_range": 2},
            "min_range must be at least 0 and less than max_range",
        ),
        (measure.RasterLidar, {"divergence": -1}, "divergence must be at least 0 and less than 90 degrees"),
    ]:
        with pytest.raises(ValueError, match=text):
            kind(**options)
    scan = measure.lidar(BALL, RASTER)
    with pytest.raises(ValueError, match="name must be one of 'range', 'incidence', 'strength', got 'color'"):
        scan.image("color")
