"""Beams: exact areas of pixels, and pictures without samples."""

import numpy as np
import pytest

import raywright as rw

PAPER = rw.Diffuse(1.0)


def quad(a, b, c, d, **kwargs):
    return rw.Mesh([a, b, c, d], [(0, 1, 2), (0, 2, 3)], **kwargs)


def square(half, z, **kwargs):
    return quad((-half, -half, z), (half, -half, z), (half, half, z), (-half, half, z), **kwargs)


def block(low, high, **kwargs):
    (a, b, c), (d, e, f) = low, high
    corners = [(x, y, z) for x in (a, d) for y in (b, e) for z in (c, f)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)]
    faces += [(2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    return rw.Mesh(corners, faces, **kwargs)


def look(scene, camera, way, samples=1):
    return rw.render(scene, camera, way, samples=samples, sampler=rw.Independent(), progress=False)


def edge(camera, slope, at):
    """Return the share of pixels to the left of x = at + slope * y at z = 0, seen from (0, 0, 5)."""
    size = np.array([camera.width, camera.height])
    scale = 5 * np.tan(np.radians(camera.fov) / 2) / (size[1] / 2)

    def below(x, y):
        # The area under the edge left of each column's side, from row to row: a polynomial between kinks.
        reach = (at + slope * scale * (size[1] / 2 - y)) / scale + size[0] / 2 - x
        return np.where(reach > 0, reach**2 / 2, 0) / (slope)

    x, y = np.meshgrid(np.arange(size[0] + 1.0), np.arange(size[1] + 1.0))
    whole = below(x, y)
    strip = whole[:-1] - whole[1:]
    return strip[:, :-1] - strip[:, 1:]


def test_an_edge_covers_pixels_by_its_exact_area():
    camera = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), fov=40, width=16, height=12)
    slope, at = 0.3, 0.137
    left = quad((-9, -9, 0), (at - 9 * slope, -9, 0), (at + 9 * slope, 9, 0), (-9, 9, 0), material=PAPER)
    image = look(rw.Scene([left], precision="double"), camera, rw.BeamTraced(ambient=1.0), samples=2)
    # Pictures are float32, whose steps are 6e-8 just below 1.
    assert image.rgb[..., 0] == pytest.approx(edge(camera, slope, at), abs=6.1e-8)
    assert np.all(image.standard_error == 0)
    assert image.error.estimate == 0


def test_an_even_wall_has_no_edges():
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(2, 2.0)
    scene = rw.Scene([rw.Mesh(ball.vertices, ball.faces, material=rw.Diffuse(0.8))])
    camera = rw.Camera((0.1, 0.2, 0.3), (1, 0.4, 0.2), fov=70, width=12, height=9)
    # Half the light, of which 0.8 come back; at 1e-6 a gap of a millionth of a pixel would show.
    assert look(scene, camera, rw.BeamTraced(ambient=0.5)).rgb == pytest.approx(0.4, abs=1e-6)


def room(mirror=None):
    white = rw.Diffuse(0.73)
    return [
        quad((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), material=white),
        quad((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1), material=white),
        quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), material=white),
        quad((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), material=rw.Diffuse((0.6, 0.1, 0.1))),
        quad((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1), material=mirror or rw.Diffuse((0.1, 0.5, 0.1))),
        block((0.2, 0, 0.3), (0.45, 0.5, 0.55), material=white),
        block((0.6, 0, 0.6), (0.8, 0.25, 0.8), material=rw.Phong((0.4, 0.4, 0.2), 0.3, 20)),
    ]


LAMPS = [rw.PointLight((0.5, 0.6, 1.7), 1.0), rw.DirectionalLight((-0.2, -0.6, -1), 0.5)]
GLASS = rw.ThinDielectric(1.5)
PANE = quad((0.1, 0.1, 0.9), (0.5, 0.1, 0.9), (0.5, 0.6, 0.9), (0.1, 0.6, 0.9), material=GLASS)


@pytest.mark.parametrize("shapes", [room(), room(rw.Mirror()), [*room(rw.Mirror(0.8))[1:], PANE]])
def test_beams_make_the_picture_that_rays_make(shapes):
    scene = rw.Scene(shapes, lights=LAMPS)
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=38, width=16, height=16)
    beams = look(scene, camera, rw.BeamTraced(ambient=0.1)).rgb.astype(float)
    rays = look(scene, camera, rw.Whitted(ambient=0.1, contribution=0), samples=1024)
    # Of 768 numbers, one in a hundred pictures has one beyond 4.5 standard errors; radiance that is no
    # polynomial over a pixel is off by less than a thousandth.
    off = np.abs(beams - rays.rgb) - 1e-3 * rays.rgb
    assert np.all(off <= 4.5 * rays.standard_error + 1e-6)
    assert np.median(rays.standard_error / (rays.rgb + 1e-9)) < 0.02


def test_two_mirrors_and_symmetry():
    # Between mirrors that face each other, four papers are seen again and again.
    mirrors = [square(2, -2, material=rw.Mirror(0.9)), square(2, 3, material=rw.Mirror(0.9))]
    corners = [(x, y) for x in (-0.7, 0.7) for y in (-0.7, 0.7)]
    around = [(-0.2, -0.2), (0.2, -0.2), (0.2, 0.2), (-0.2, 0.2)]
    papers = [quad(*((x + u, y + v, -1) for u, v in around), material=PAPER) for x, y in corners]
    scene = rw.Scene([*mirrors, *papers])
    camera = rw.Camera((0, 0, 1), (0, 0, -2), up=(0, 1, 0), fov=70, width=16, height=16)
    sums = []
    for depth in (1, 2, 5):
        rgb = look(scene, camera, rw.BeamTraced(depth, ambient=1.0)).rgb[..., 0]
        rays = look(scene, camera, rw.Whitted(depth, contribution=0, ambient=1.0), samples=512)
        # Where all samples are alike, a sliver of a pixel may have been missed by all.
        assert np.all(np.abs(rgb - rays.rgb[..., 0]) <= 5 * rays.standard_error[..., 0] + 0.02)
        assert rgb.mean() == pytest.approx(rays.rgb[..., 0].mean(), rel=0.01)
        for turned in (rgb[::-1], rgb[:, ::-1], rgb.T):
            assert turned == pytest.approx(rgb, abs=1e-6)
        sums.append(rgb.sum())
    assert sums[0] < 0.9 * sums[1] < 0.9 * sums[2]


FLOOR, SPHERE = square(2, 0), rw.Sphere((0, 0, 0), 1)
VIEW = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4)
REFUSED = [
    ([SPHERE], {}, VIEW, rw.BeamTraced(), "beams meet meshes alone, and shape 0 is none"),
    ([square(1, 0, emission=1.0)], {}, VIEW, rw.BeamTraced(), "shape 0 shines"),
    ([FLOOR, square(1, 0, material=rw.Dielectric(1.5))], {}, VIEW, rw.BeamTraced(), "shape 1 is of glass"),
    ([FLOOR], {"environment": 1.0}, VIEW, rw.BeamTraced(), "an environment has one"),
    ([FLOOR], {"lights": [rw.PointLight((0, 0, 1), 1)] * 65}, VIEW, rw.BeamTraced(), "64 lights at most"),
]


@pytest.mark.parametrize(("shapes", "more", "view", "way", "says"), REFUSED)
def test_what_they_cannot_do_is_refused_by_name(shapes, more, view, way, says):
    with pytest.raises(ValueError, match=says) as caught:
        look(rw.Scene(shapes, **more), view, way)
    assert "\n" not in str(caught.value)


def test_cameras_and_filters_that_are_none_of_theirs():
    way = rw.BeamTraced()
    scene = rw.Scene([FLOOR])
    with pytest.raises(ValueError, match="pinhole"):
        look(scene, rw.Orthographic((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4), way)
    with pytest.raises(ValueError, match="BoxFilter"):
        rw.render(scene, VIEW, way, samples=1, filter=rw.GaussianFilter(), progress=False)


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: rw.BeamTraced(max_depth=-1), ValueError, "max_depth must be between 0 and"),
        (lambda: rw.BeamTraced(ambient="much"), TypeError, "ambient"),
    ],
)
def test_wrong_numbers_are_told_in_a_line(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_any_number_of_threads_makes_the_same_bits():
    scene = rw.Scene(room(rw.Mirror()), lights=LAMPS)
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=38, width=9, height=7)
    pictures = (
        rw.render(scene, camera, rw.BeamTraced(3), samples=1, threads=n, progress=False) for n in (1, 2)
    )
    one, two = (picture.rgb for picture in pictures)
    assert np.array_equal(one, two)
