"""Every way to carry light makes the same picture, of ten scenes, within what each says of its error."""

from itertools import combinations

import numpy as np
import pytest
from long_runs import part
from rare_scenes import keyhole

import raywright as rw

pytestmark = pytest.mark.slow

SIDE = 64


def _floor(half, **how):
    corners = [(-half, 0, half), (half, 0, half), (half, 0, -half), (-half, 0, -half)]
    return rw.Mesh(corners, [(0, 1, 2), (0, 2, 3)], **how)


def _look(at=(2.2, 2.4, 3.6), target=(0, 0.4, 0), **how):
    return rw.Camera(at, target, fov=40, width=SIDE, height=SIDE, **how)


def _glossy():
    scene, camera = rw.scenes.material_ball(rw.Plastic((0.2, 0.4, 0.7), roughness=0.4), SIDE, SIDE)
    return scene, camera


def _gold_in_a_sky():
    ball = rw.Sphere((0, 0.6, 0), 0.6, material=rw.Conductor("Au", roughness=0.5))
    sky = rw.ConstantEnvironment((0.5, 0.7, 1.0))
    return rw.Scene([_floor(3, material=rw.Diffuse(0.6)), ball], environment=sky), _look()


def _rough_glass():
    ball = rw.Sphere((0, 0.7, 0), 0.6, material=rw.Dielectric(1.5, roughness=0.5))
    lamp = rw.Sphere((1.0, 2.6, 0.5), 0.3, material=rw.Diffuse(0), emission=30.0)
    return rw.Scene([_floor(3, material=rw.Diffuse(0.6)), ball, lamp]), _look()


def _spot_and_point():
    ball = rw.Sphere((0, 0.6, 0), 0.6, material=rw.Diffuse((0.8, 0.4, 0.2)))
    lights = [rw.SpotLight((1.5, 2.5, 1), (0, 0, 0), 12, angle=30, falloff=8), rw.PointLight((-2, 2, 1), 5)]
    return rw.Scene([_floor(3, material=rw.Diffuse(0.6)), ball], lights=lights), _look()


def _instances():
    ball = rw.Sphere((0, 0.3, 0), 0.3, material=rw.Diffuse(0.7))
    places = np.tile(np.eye(4), (5, 1, 1))
    places[:, 0, 3], places[:, 2, 3] = np.linspace(-1.6, 1.6, 5), (0, 0.6, -0.6, 0.4, 0)
    lamp = rw.Disk((0, 2.8, 0), (0, -1, 0), 0.6, material=rw.Diffuse(0), emission=12.0)
    return rw.Scene([_floor(3, material=rw.Diffuse(0.6)), rw.Instance(ball, places), lamp]), _look()


def _lens():
    scene, _ = _spot_and_point()
    camera = rw.ThinLens(
        (2.2, 2.4, 3.6),
        (0, 0.4, 0),
        fov=40,
        width=SIDE,
        height=SIDE,
        aperture_radius=0.1,
        focus_point=(0, 0.6, 0),
    )
    return scene, camera


def _masks():
    lace = rw.Mask(rw.Diffuse(0.7), rw.Checker(1.0, 0.3, 6))
    screen = rw.Mesh(
        [(-1, 1.4, 1), (1, 1.4, 1), (1, 1.4, -1), (-1, 1.4, -1)], [(0, 1, 2), (0, 2, 3)], material=lace
    )
    lamp = rw.Disk((0, 2.8, 0), (0, -1, 0), 0.6, material=rw.Diffuse(0), emission=12.0)
    return rw.Scene([_floor(3, material=rw.Diffuse(0.6)), screen, lamp]), _look()


SCENES = {
    "Cornell": lambda: rw.scenes.cornell_box(width=SIDE, height=SIDE),
    "many lights": lambda: rw.scenes.many_lights(40, width=SIDE, height=SIDE),
    "glossy ball": _glossy,
    "gold in a sky": _gold_in_a_sky,
    "rough glass": _rough_glass,
    "spot and point": _spot_and_point,
    "instances": _instances,
    "lens": _lens,
    "masks": _masks,
    "keyhole": lambda: keyhole(SIDE),
}

# Each with enough samples for a reliable error: few samples of light that arrives at the lens are bright.
WAYS = {
    "path": (rw.Path(reuse=1, guiding="none"), part(256, 4)),
    "light traced": (rw.LightTraced(), part(1024, 4)),
    "bidirectional": (rw.Bidirectional(), part(256, 4)),
    "progressive": (rw.ProgressivePhotonMap(), part(256, 4)),
}

# Equal error bars are exceeded once in 180 blocks, and those of blocks with few bright samples more often: 5
# % of blocks may, plus three deviations of the binomial for the 64 of one pair of pictures.
MOST = 0.05
MOST_OF_ONE = MOST + 3 * np.sqrt(MOST * (1 - MOST) / 64)


def _blocks(values):
    return values.astype(float).reshape(SIDE // 8, 8, SIDE // 8, 8, -1).mean((1, 3))


def _told(scene, camera, way, samples):
    """Means of blocks, and half of the 95 % interval of each, with its bias and the error of that."""

    def half(error):
        return 1.96 * np.sqrt(_blocks(error.astype(float) ** 2) / 64)

    image = rw.render(scene, camera, way, samples, progress=False)
    bar = half(image.standard_error)
    if image.bias is not None:
        bar += np.abs(_blocks(image.bias)) + half(image.bias_error)
    return _blocks(image.rgb), bar


@pytest.mark.parametrize("name", SCENES)
def test_all_ways_make_the_same_picture(name):
    scene, camera = SCENES[name]()
    told = {way: _told(scene, camera, *how) for way, how in WAYS.items()}
    shares = {}
    for (first, (a, bar_a)), (second, (b, bar_b)) in combinations(told.items(), 2):
        shares[first, second] = float((np.abs(a - b) > bar_a + bar_b + 1e-6 * np.abs(a)).mean())
    assert np.mean(list(shares.values())) <= MOST, shares
    assert max(shares.values()) <= MOST_OF_ONE, shares
