"""Lights as values: what they keep, what they refuse, and where the sun is."""

import math
import pickle
from dataclasses import FrozenInstanceError, replace
from datetime import datetime, timedelta, timezone

import numpy as np
import pytest

import raywright as rw
from raywright.io.pictures import read_linear
from raywright.lights.sun_position import sun_positions

PICTURE = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
NOON = datetime(2024, 6, 20, 12, tzinfo=timezone.utc)

VALUES = [
    rw.SpotLight((1, 2, 3), (0, 0, 0), 4, angle=40, falloff=10, profile="linear"),
    rw.DirectionalLight((0, 0, -2), (1, 2, 3)),
    rw.ProjectorLight(PICTURE, (0, 0, 5), (0, 0, 0), fov=50, intensity=2),
    rw.EnvironmentMap(PICTURE, scale=3),
    rw.SunSky((0, 1, 1), turbidity=4),
    rw.SunSky((0, -1, 5)),
    rw.Emission((1, 2, 3), both_sides=True),
    rw.Emission((1, 2, 3), side="back"),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda v: type(v).__name__)
def test_values_pickle_compare_hash_print_and_are_frozen(value):
    back = pickle.loads(pickle.dumps(value))
    assert back == value
    assert hash(back) == hash(value)
    assert repr(back) == repr(value)
    assert "\n" not in repr(value)
    assert value != VALUES[VALUES.index(value) - 1]
    with pytest.raises(FrozenInstanceError):
        value.scale = 1


def test_sides_that_shine_are_told_in_either_way():
    assert rw.Emission(1) == rw.Emission(1, side="front") == rw.Emission(1, False)
    assert rw.Emission(1, True) == rw.Emission(1, both_sides=True, side="both") == rw.Emission(1, side="both")
    assert [rw.Emission(1, side=side).both_sides for side in ("front", "back", "both")] == [
        False,
        False,
        True,
    ]
    assert replace(rw.Emission(1, side="back"), radiance=(2, 2, 2)) == rw.Emission(2, side="back")


def test_pictures_are_kept_read_only_and_gray_ones_become_colors():
    light = rw.EnvironmentMap(PICTURE.astype(np.float64))
    assert light.image.dtype == np.float32
    assert not light.image.flags.writeable
    assert not pickle.loads(pickle.dumps(light)).image.flags.writeable
    assert np.array_equal(rw.EnvironmentMap(np.ones((3, 5), int)).image, np.ones((3, 5, 3)))
    assert light != rw.EnvironmentMap(PICTURE[:, :2])


@pytest.mark.parametrize(
    ("kind", "arguments", "error", "message"),
    [
        (rw.SpotLight, {"angle": 0}, ValueError, "angle must be above 0 and at most 90 degrees, got 0"),
        (rw.SpotLight, {"angle": 90.1}, ValueError, "angle must be above 0 and at most 90 degrees"),
        (rw.SpotLight, {"angle": math.nan}, ValueError, "angle must be finite, got nan"),
        (rw.SpotLight, {"falloff": 31}, ValueError, "falloff must be between 0 and angle = 30 degrees"),
        (rw.SpotLight, {"profile": "steep"}, ValueError, "profile must be one of 'smooth', 'linear', got"),
        (rw.SpotLight, {"falloff": -1}, ValueError, "falloff must be between 0 and angle"),
        (rw.SpotLight, {"target": (1, 0, 0)}, ValueError, "target must differ from position"),
        (rw.SpotLight, {"intensity": -1}, ValueError, "intensity must be at least 0, got -1"),
        (rw.DirectionalLight, {"direction": (0, 0, 0)}, ValueError, "direction must not be zero"),
        (rw.DirectionalLight, {"irradiance": math.inf}, ValueError, "irradiance must be finite"),
        (rw.ProjectorLight, {"image": np.zeros((0, 4, 3))}, ValueError, "image must have shape"),
        (rw.ProjectorLight, {"fov": 180}, ValueError, "fov must be between 0 and 180 degrees, got 180"),
        (rw.ProjectorLight, {"up": (2, 0, 0)}, ValueError, "up must not be zero or parallel to the axis"),
        (rw.ProjectorLight, {"up": (0, 0, 0)}, ValueError, "up must not be zero"),
        (rw.ProjectorLight, {"target": (1, 0, 0)}, ValueError, "target must differ from position"),
        (
            rw.EnvironmentMap,
            {"image": np.zeros((2, 3, 4))},
            ValueError,
            r"image must have shape .* got \(2, 3, 4\)",
        ),
        (rw.EnvironmentMap, {"image": []}, ValueError, "image must have shape"),
        (rw.EnvironmentMap, {"image": [[1, -1]]}, ValueError, "at least 0, got .* in row 0, column 1"),
        (rw.EnvironmentMap, {"image": [[1], [math.nan]]}, ValueError, "finite .* in row 1, column 0"),
        (rw.EnvironmentMap, {"image": [[1e40]]}, ValueError, "image must be finite"),
        (rw.EnvironmentMap, {"image": [["x"]]}, TypeError, "image must be real numbers"),
        (rw.EnvironmentMap, {"image": "nothing.exr"}, FileNotFoundError, "nothing.exr"),
        (rw.EnvironmentMap, {"scale": -1}, ValueError, "scale must be at least 0, got -1"),
        (rw.EnvironmentMap, {"to_world": np.diag([1, 2, 1])}, ValueError, "to_world must be a rotation"),
        (rw.EnvironmentMap, {"to_world": np.eye(2)}, ValueError, r"rotation of shape .* got \(2, 2\)"),
        (rw.SunSky, {"sun": (0, 0, 0)}, ValueError, "sun must not be zero"),
        (rw.SunSky, {"turbidity": 1}, ValueError, "turbidity must be between 2 and 10, got 1"),
        (rw.SunSky, {"ground_albedo": 1.5}, ValueError, "ground_albedo must be between 0 and 1, got 1.5"),
        (rw.SunSky, {"sky_scale": -1}, ValueError, "sky_scale must be at least 0"),
        (rw.Emission, {"radiance": -1}, ValueError, "radiance must be at least 0, got -1"),
        (rw.Emission, {"both_sides": 1}, TypeError, "both_sides must be True or False, got 1"),
        (
            rw.Emission,
            {"side": "left"},
            ValueError,
            "side must be one of 'front', 'back', 'both', got 'left'",
        ),
        (
            rw.Emission,
            {"both_sides": True, "side": "back"},
            ValueError,
            "only one of both_sides and side can be given, got True and 'back'",
        ),
    ],
)
def test_nonsense_is_refused_in_one_line(kind, arguments, error, message):
    good = {
        rw.SpotLight: {"position": (1, 0, 0), "target": (0, 0, 0), "intensity": 1},
        rw.DirectionalLight: {"direction": (0, 0, 1), "irradiance": 1},
        rw.ProjectorLight: {"image": PICTURE, "position": (1, 0, 0), "target": (0, 0, 0)},
        rw.EnvironmentMap: {"image": PICTURE},
        rw.SunSky: {"sun": (0, 1, 0)},
        rw.Emission: {"radiance": 1},
    }
    with pytest.raises(error, match=message) as caught:
        kind(**{**good[kind], **arguments})
    assert "\n" not in str(caught.value)


def test_scenes_take_lights_and_environments_of_all_kinds():
    spot, sky = VALUES[0], VALUES[3]
    assert rw.Scene([], lights=spot).lights == (spot,)
    assert rw.Scene([], environment=2).environment == rw.ConstantEnvironment(2)
    assert rw.Scene([], environment=(1, 2, 3)).environment == rw.ConstantEnvironment((1, 2, 3))
    assert rw.Scene([], environment=sky).environment is sky
    both = rw.Scene([], environment=[sky, rw.ConstantEnvironment(1)])
    assert both.environment == (sky, rw.ConstantEnvironment(1))
    assert pickle.loads(pickle.dumps(both)) == both
    with pytest.raises(TypeError, match="lights must be raywright lights, got EnvironmentMap"):
        rw.Scene([], lights=[sky])
    with pytest.raises(TypeError, match="environment must be one environment or a sequence of them, got int"):
        rw.Scene([], environment=[sky, 1])


def test_the_sun_is_where_almanacs_have_it():
    # The example of Reda and Andreas, "Solar Position Algorithm for Solar Radiation Applications" (2003).
    when = datetime(2003, 10, 17, 12, 30, 30, tzinfo=timezone(timedelta(hours=-7)))
    azimuth, elevation = (math.degrees(angle[0]) for angle in sun_positions([when], 39.742476, -105.1786))
    assert azimuth == pytest.approx(194.34024, abs=0.02)
    assert elevation == pytest.approx(39.872046, abs=0.02)
    # At the pole the elevation is the declination: extreme at the solstices of 2024, none at the equinox.
    for day, expected in ((datetime(2024, 6, 20, 20, 51), 23.436), (datetime(2024, 12, 21, 9, 20), -23.436),
                          (datetime(2024, 3, 20, 3, 6), 0.0)):  # fmt: skip
        assert math.degrees(sun_positions([day.replace(tzinfo=timezone.utc)], 90, 0)[1][0]) == pytest.approx(
            expected, abs=0.02
        )


def test_daylight_of_a_time_and_place_points_to_the_sun():
    # In Greenwich the sun stands in the south at about noon, in the morning in the east.
    noon = rw.SunSky.at(NOON, 51.48, 0)
    assert noon.elevation == pytest.approx(90 - 51.48 + 23.44, abs=0.1)
    assert noon.sun[1] == pytest.approx(math.sin(math.radians(noon.elevation)))
    assert noon.sun[2] > 0.4
    assert abs(noon.sun[0]) < 0.02
    morning = rw.SunSky.at(NOON - timedelta(hours=6), 51.48, 0, up=(0, 0, 1), north=(0, 1, 0))
    assert morning.sun[0] > 0.8
    assert morning.up == (0, 0, 1)
    midnight = rw.SunSky.at(NOON - timedelta(hours=12), 51.48, 0)
    assert midnight.elevation == pytest.approx(51.48 - 90 + 23.44, abs=0.1)
    assert midnight.sun[1] == pytest.approx(math.sin(math.radians(midnight.elevation)))
    with pytest.raises(ValueError, match="when must have a time zone"):
        rw.SunSky.at(NOON.replace(tzinfo=None), 51.48, 0)
    with pytest.raises(ValueError, match="latitude must be between -90 and 90 degrees, got 91"):
        rw.SunSky.at(NOON, 91, 0)
    with pytest.raises(ValueError, match="north must not be parallel to up"):
        rw.SunSky.at(NOON, 51.48, 0, north=(0, 2, 0))


def test_pictures_of_light_are_read_from_files(tmp_path, picture):
    picture.save(tmp_path / "a.npy")
    picture.save(tmp_path / "a.exr")
    picture.save(tmp_path / "a.png", tone="linear")
    for name, tolerance in (("a.npy", 0), ("a.exr", 0), ("a.png", 5e-3)):
        clipped = np.minimum(picture.rgb, 1) if name == "a.png" else picture.rgb
        assert np.abs(read_linear(tmp_path / name) - clipped).max() <= tolerance
        assert rw.EnvironmentMap(tmp_path / name).image.shape == picture.rgb.shape
    (tmp_path / "no.png").write_text("no picture")
    with pytest.raises(ValueError, match="is not a picture that can be read"):
        read_linear(tmp_path / "no.png")


def test_radiances_own_files_are_read(tmp_path):
    # Mantissas 128, 64, 0 with exponent 130 are 2, 1, 0; a run of ten, then ten one by one, and a flat row.
    head = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n"
    runs = bytes((2, 2, 0, 20)) + b"".join(
        bytes((138, value, 10)) + bytes([value] * 10) for value in (128, 64, 0, 130)
    )
    path = tmp_path / "a.hdr"
    path.write_bytes(head + b"-Y 2 +X 20\n" + runs + bytes((0, 0, 0, 0)) * 20)
    expected = np.zeros((2, 20, 3), np.float32)
    expected[0] = (2, 1, 0)
    assert np.array_equal(read_linear(path), expected)
    for bad in (
        head + b"-Y 2 +X 20\n" + runs,
        head + b"+Y 2 +X 20\n" + runs,
        b"P6 nothing",
        head + b"-Y a +X 2\n",
    ):
        path.write_bytes(bad)
        with pytest.raises(ValueError, match=r"a\.hdr"):
            read_linear(path)
