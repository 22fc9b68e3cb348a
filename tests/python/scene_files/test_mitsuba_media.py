"""Media of scenes in Mitsuba's format."""

import struct

import numpy as np
import pytest

import raywright as rw

EYE = {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 4}}
SMOKE = {"type": "homogeneous", "albedo": 0.75, "sigma_t": {"type": "rgb", "value": [1, 2, 4]}, "scale": 2.0}


def shot(**parts):
    return rw.from_mitsuba({"type": "scene", "sensor": EYE, **parts})


def within(bsdf, medium, **more):
    shape = {"type": "sphere", "interior": medium, **more}
    return shot(one=shape if bsdf is None else {**shape, "bsdf": bsdf}).scene.shapes[0].material


def test_what_is_within_a_shape():
    smoke = rw.Homogeneous((0.5, 1.0, 2.0), (1.5, 3.0, 6.0))
    assert within({"type": "null"}, SMOKE) == rw.MediumInterface(smoke)
    glass = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
    assert within(glass, SMOKE) == rw.Dielectric(1.5, alpha=0.0, interior=smoke)
    for phase, expected in [
        ({"type": "hg", "g": 0.5}, rw.HenyeyGreenstein(0.5)),
        ({"type": "rayleigh"}, rw.media.Rayleigh()),
        ({"type": "isotropic"}, rw.media.Isotropic()),
    ]:
        told = {"type": "homogeneous", "albedo": 0.75, "sigma_t": 2.0, "phase": phase}
        assert within({"type": "null"}, told).interior == rw.Homogeneous(0.5, 1.5, expected)
    pane = {"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0}
    assert within(pane, SMOKE) == rw.ThinDielectric(1.5, interior=smoke)
    # A heterogeneous medium exists within its volume, even if it is the same everywhere.
    moved = np.diag([2.0, 3.0, 4.0, 1.0])
    constant = {"type": "constvolume", "value": 2.0, "to_world": moved}
    told = {"type": "heterogeneous", "albedo": 0.75, "sigma_t": constant}
    assert within({"type": "null"}, told).interior == rw.GridMedium(
        np.ones((1, 1, 1)), transform=moved, absorption=0.5, scattering=1.5, at="centers"
    )
    # The inside of a wall is invisible.
    assert (
        within({"type": "diffuse"}, SMOKE)
        == shot(one={"type": "sphere", "b": {"type": "diffuse"}}).scene.shapes[0].material
    )


def test_densities_from_files(tmp_path):
    numbers = np.arange(24, dtype=np.float32).reshape(2, 3, 4)
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 2, 3, 4, 1, 0, 0, 0, 2, 3, 4)
    (tmp_path / "d.vol").write_bytes(header + numbers.transpose(2, 1, 0).tobytes())
    moved = np.diag([2.0, 3.0, 4.0, 1.0])
    grid = {"type": "gridvolume", "filename": "d.vol", "to_world": moved}
    medium = {"type": "heterogeneous", "albedo": 0.5, "scale": 4.0, "sigma_t": grid}
    scene = {
        "type": "scene",
        "sensor": EYE,
        "s": {"type": "cube", "interior": medium, "bsdf": {"type": "null"}},
    }
    found = rw.from_mitsuba(scene, folder=tmp_path).scene.shapes[0].material.interior
    assert found == rw.GridMedium(numbers, transform=moved, absorption=2, scattering=2, at="centers")
    grid["use_grid_bbox"] = True
    found = rw.from_mitsuba(scene, folder=tmp_path).scene.shapes[0].material.interior
    assert found.bounds == ((0, 0, 0), (2, 3, 4))


def test_grids_of_albedos_and_of_colors(tmp_path):
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 2, 3, 4, 3, 0, 0, 0, 2, 3, 4)
    numbers = (np.arange(72, dtype=np.float32) / 72).reshape(2, 3, 4, 3)
    (tmp_path / "c.vol").write_bytes(header + numbers.transpose(2, 1, 0, 3).tobytes())
    grid = {"type": "gridvolume", "filename": "c.vol"}
    medium = {"type": "heterogeneous", "scale": 4.0, "sigma_t": grid, "albedo": dict(grid)}
    scene = {"type": "scene", "sensor": EYE, "s": {"type": "cube", "interior": medium, "b": {"type": "null"}}}

    def read():
        return rw.from_mitsuba(scene, folder=tmp_path).scene.shapes[0].material.interior

    assert read() == rw.GridMedium(numbers, transform=np.eye(4), extinction=4, albedo=numbers, at="centers")
    medium["albedo"]["to_world"] = np.diag([2.0, 3.0, 4.0, 1.0])
    with pytest.raises(ValueError, match="sigma_t and albedo must lie in the same place"):
        read()


@pytest.mark.parametrize("wrap", ["repeat", "clamp"])
def test_albedos_go_on_beyond_their_grid_in_what_is_the_same_elsewhere(tmp_path, wrap):
    rng = np.random.default_rng(3)
    shares = rng.random((2, 3, 4)).astype("<f4")
    header = struct.pack("<3sBiiiii6f", b"VOL", 3, 1, 4, 3, 2, 1, *(0, 0, 0, 1, 1, 1))
    (tmp_path / "shares.vol").write_bytes(header + shares.tobytes())
    grid = {"type": "gridvolume", "filename": str(tmp_path / "shares.vol"), "wrap_mode": wrap}
    grid["to_world"] = np.array([(0.4, 0, 0, 0.1), (0, 0.5, 0, 0), (0, 0, 0.6, 0), (0, 0, 0, 1)])
    told = {"type": "homogeneous", "albedo": grid, "sigma_t": 2.0, "scale": 3.0}
    cube = {
        "type": "cube",
        "to_world": np.diag([1.0, 0.9, 0.8, 1.0]),
        "bsdf": {"type": "null"},
        "interior": told,
    }
    medium = shot(one=cube).scene.shapes[0].material.interior
    assert medium.extinction == (6.0, 6.0, 6.0)
    assert np.array_equal(medium.density, np.ones((1, 1, 1), np.float32))
    (low, high), size = np.array(medium.bounds), np.array(medium.albedo.shape[:3])
    middles = [(np.arange(n) + 0.5) / n * (b - a) + a for n, a, b in zip(size, low, high, strict=True)]
    inside = np.abs(np.array([0.4, 0.5, 0.6]) * (low, high) + (0.1, 0, 0)) >= (1.0, 0.9, 0.8)
    assert inside.all()
    cells = [np.floor(m * n).astype(int) for m, n in zip(middles, (4, 3, 2), strict=True)]
    at = [c % n if wrap == "repeat" else c.clip(0, n - 1) for c, n in zip(cells, (4, 3, 2), strict=True)]
    assert np.array_equal(medium.albedo.squeeze(), shares.transpose(2, 1, 0)[np.ix_(*at)])


def test_what_is_around_all_shapes():
    smoke = rw.Homogeneous((0.5, 1.0, 2.0), (1.5, 3.0, 6.0))
    ball = {"type": "sphere", "bsdf": {"type": "dielectric"}}
    assert shot(one=ball).scene.medium is None
    assert shot(one={**ball, "exterior": SMOKE}).scene.medium == smoke
    seen = {"type": "scene", "fog": {**SMOKE, "id": "fog"}, "one": ball}
    assert rw.from_mitsuba({**seen, "eye": {**EYE, "m": {"type": "ref", "id": "fog"}}}).scene.medium == smoke
    # A sensor in a ball of smoke is within it, and the scene is not.
    inside = {"type": "sphere", "interior": {"type": "ref", "id": "fog"}, "bsdf": {"type": "null"}}
    assert (
        rw.from_mitsuba(
            {**seen, "two": inside, "eye": {**EYE, "m": {"type": "ref", "id": "fog"}}}
        ).scene.medium
        is None
    )


@pytest.mark.parametrize(
    ("medium", "says"),
    [
        ({"type": "homogeneous", "albedo": 2.0}, "homogeneous 'one.interior': absorption must be at least 0"),
        ({"type": "homogeneous", "phase": {"type": "hg", "g": 1.0}}, "g must be between -1 and 1"),
        ({"type": "homogeneous", "phase": {"type": "sggx"}}, "sggx 'phase' is not supported here"),
        (
            {"type": "homogeneous", "albedo": {"type": "gridvolume"}},
            "albedo on a grid is read within meshes only",
        ),
        ({"type": "heterogeneous", "sigma_t": {"type": "gridvolume"}}, "must be given by its filename"),
        ({"type": "rgb", "value": 1.0}, "interior must be one of homogeneous, heterogeneous, got rgb"),
    ],
)
def test_what_is_not_read_is_refused(medium, says):
    with pytest.raises(ValueError, match=says):
        within({"type": "null"}, medium)
