"""Radiative exchange against closed forms."""

import pickle
from typing import Any

import numpy as np
import pytest
from radiosity_scenes import CUBE, room, square

import raywright as rw
from raywright.exchange.radiative import STEFAN_BOLTZMANN


def exchanged(scene: rw.Scene, *arguments: Any, **options: Any) -> rw.exchange.RadiativeExchange:
    return rw.radiative_exchange(scene, *arguments, progress=False, **options)


def spheres(inner: float) -> rw.Scene:
    return rw.Scene([rw.Sphere((0, 0, 0), inner), rw.Sphere((0, 0, 0), 1.0)])


@pytest.mark.parametrize(("inner", "emissivity"), [(0.5, (0.9, 0.4)), (0.9, (0.3, 0.8))])
def test_concentric_spheres(inner: float, emissivity: tuple[float, float]) -> None:
    found = exchanged(spheres(inner), [400.0, 300.0], list(emissivity), sides="both", rays=2**18)
    share = inner**2
    truth = STEFAN_BOLTZMANN * (400.0**4 - 300.0**4) / (1 / emissivity[0] + share * (1 / emissivity[1] - 1))
    # Rows: fronts of both, backs of both; the hollow inside of the ball exchanges nothing.
    off = 3 * found.standard_error[0]
    assert off < 0.006 * truth
    assert abs(found.flux[0] - truth) < off + 1e-3 * truth
    assert abs(found.flux[2]) < 1e-5 * truth
    inwards = -found.flux[3] * found.areas[3]
    assert abs(inwards / (truth * found.areas[0]) - 1) < 0.01


def test_two_plates() -> None:
    corners = np.array(CUBE[0]) * 1000.0
    plates = [rw.Polygon(corners), rw.Polygon(corners[::-1] + np.array((0, 0, 1e-4)))]
    found = exchanged(
        rw.Scene(plates), {0: 500.0, 1: 300.0}, {0: 0.8, 1: 0.3}, method="stochastic", rays=2**14
    )
    truth = STEFAN_BOLTZMANN * (500.0**4 - 300.0**4) / (1 / 0.8 + 1 / 0.3 - 1)
    # The loss through the gap between them is some 4e-7 of all.
    np.testing.assert_allclose(found.flux, [truth, -truth], rtol=1e-4)
    assert found.of(0) == found.power[0]


@pytest.mark.parametrize("method", ["matrix", "stochastic"])
def test_arrays_belong_to_the_caller(method: str) -> None:
    kelvin, gray = np.full(2, 300.0), np.full(2, 0.5)
    found = exchanged(rw.Scene(square(0.5, True)), kelvin, gray, method=method, rays=2**8)
    back = pickle.loads(pickle.dumps(found))
    assert back == found
    # torch warns of what cannot be written to; numbers of shapes and faces alone are read-only.
    arrays = {name: value for name, value in vars(found).items() if isinstance(value, np.ndarray)}
    assert [name for name, array in arrays.items() if not array.flags.writeable] == ["patches"]
    for name, array in arrays.items():
        if name != "patches":
            array[:] = -1.0
    assert (kelvin.min(), gray.min()) == (300.0, 0.5)
    assert back.areas.min() > 0


def test_what_shapes_shine_themselves_is_light_too() -> None:
    found = exchanged(room(), 0.0, 0.25, method="stochastic", rays=2**12)
    # All that is emitted, 1 W/m², is absorbed in the end.
    assert abs(found.power.sum() + 6) < 1e-6
    assert not found.radiosity.any()


def test_a_plate_beneath_the_sky_and_the_sun() -> None:
    plate = rw.Scene([square(0, True)], rw.DirectionalLight((0, 0, -1), 800.0))
    found = exchanged(
        plate, 300.0, 0.9, sky_temperature=270.0, absorptance=0.2, method="stochastic", rays=2**16
    )
    truth = 0.9 * STEFAN_BOLTZMANN * (300.0**4 - 270.0**4) - 0.2 * 800
    np.testing.assert_allclose(found.flux, truth, rtol=0.01)
    np.testing.assert_allclose(found.absorbed_light, 160.0, rtol=1e-6)
    assert pickle.loads(pickle.dumps(found)) == found
    assert "2 surfaces" in repr(found)


def test_numbers_may_be_told_in_several_ways() -> None:
    scene = room(0.6, (0,) * 6)
    each = np.array([300.0] * 2 + [310.0] * 10)
    ways = [each, [300.0] + [310.0] * 5, {0: [300.0, 300.0]} | {i: 310.0 for i in range(1, 6)}]
    found = [exchanged(scene, way, 0.8, method="stochastic", rays=2**16) for way in ways]
    assert found[0] == found[1] == found[2]
    assert found[0].of(0) < 0 < sum(found[0].of(shape) for shape in range(1, 6))
    # Unshot power is below 1e-7 of the 3 kW emitted in all.
    assert abs(found[0].power.sum()) < 3e-4


@pytest.mark.parametrize(
    ("line", "options"),
    [
        ("temperature must be at least 0, got -1", {"temperature": -1.0}),
        ("temperature must have 6 entries, one per shape, got 2", {"temperature": [1.0, 2.0]}),
        ("temperature must be one number, or one for each of 12 faces", {"temperature": np.ones(6)}),
        (
            "temperature must have an entry for each of 6 shapes by number, has none for 1",
            {"temperature": {0: 1.0}},
        ),
        ("temperature must be finite, got nan", {"temperature": np.full(12, np.nan)}),
        (r"temperature must be at most 1e\+70, got 1e\+80", {"temperature": 1e80}),
        (r"sky_temperature must be at most 1e\+70, got 1e\+80", {"sky_temperature": 1e80}),
        ("threads must be at least 1, got -1", {"threads": -1}),
        ("emissivity must be above 0 and at most 1, got 0", {"emissivity": 0.0}),
        ("absorptance must be above 0 and at most 1, got 2", {"absorptance": 2.0}),
        ("sky_temperature must be at least 0", {"sky_temperature": -3.0}),
        ("method must be one of", {"method": "progressive"}),
        ("sides must be 'front' for method='matrix'", {"method": "matrix", "sides": "both"}),
        ("error must be greater than 0", {"error": 0.0}),
        ("threads must be at least 1, got 0", {"threads": 0}),
    ],
)
def test_what_cannot_be_is_refused_in_a_line(line: str, options: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match=line) as refused:
        exchanged(room(), **{"temperature": 300.0, **options})
    assert "\n" not in str(refused.value)
