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
    return rw.render(scene, camera, way, samples=samples, sampler=rw.rendering.Independent(), progress=False)


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
    image = look(
        rw.Scene([left], precision="double"), camera, rw.integrators.BeamTraced(ambient=1.0), samples=2
    )
    # Pictures are float32, whose steps are 6e-8 just below 1.
    assert image.rgb[..., 0] == pytest.approx(edge(camera, slope, at), abs=6.1e-8)
    assert np.all(image.standard_error == 0)
    assert image.error.estimate == 0


def test_an_even_wall_has_no_edges():
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(2, 2.0)
    scene = rw.Scene([rw.Mesh(ball.vertices, ball.faces, material=rw.Diffuse(0.8))])
    camera = rw.Camera((0.1, 0.2, 0.3), (1, 0.4, 0.2), fov=70, width=12, height=9)
    # Half the light at a reflectance of 0.8; at 1e-6 a gap of a millionth of a pixel would show.
    assert look(scene, camera, rw.integrators.BeamTraced(ambient=0.5)).rgb == pytest.approx(0.4, abs=1e-6)


def room(mirror=None):
    white = rw.Diffuse(0.73)
    return [
        quad((0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1), material=white),
        quad((0, 1, 0), (1, 1, 0), (1, 1, 1), (0, 1, 1), material=white),
        quad((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), material=white),
        quad((0, 0, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1), material=rw.Diffuse((0.6, 0.1, 0.1))),
        quad((1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1), material=mirror or rw.Diffuse((0.1, 0.5, 0.1))),
        block((0.2, 0, 0.3), (0.45, 0.5, 0.55), material=white),
        block((0.6, 0, 0.6), (0.8, 0.25, 0.8), material=rw.materials.Phong((0.4, 0.4, 0.2), 0.3, 20)),
    ]


LAMPS = [rw.PointLight((0.5, 0.6, 1.7), 1.0), rw.DirectionalLight((-0.2, -0.6, -1), 0.5)]
GLASS = rw.ThinDielectric(1.5)
PANE = quad((0.1, 0.1, 0.9), (0.5, 0.1, 0.9), (0.5, 0.6, 0.9), (0.1, 0.6, 0.9), material=GLASS)


@pytest.mark.parametrize("shapes", [room(), room(rw.Mirror()), [*room(rw.Mirror(0.8))[1:], PANE]])
def test_beams_make_the_picture_that_rays_make(shapes):
    scene = rw.Scene(shapes, lights=LAMPS)
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=38, width=16, height=16)
    beams = look(scene, camera, rw.integrators.BeamTraced(ambient=0.1)).rgb.astype(float)
    rays = look(scene, camera, rw.Whitted(ambient=0.1, contribution=0), samples=1024)
    # With 768 numbers, one in a hundred pictures has one beyond 4.5 standard errors. Radiance that is no
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
        rgb = look(scene, camera, rw.integrators.BeamTraced(depth, ambient=1.0)).rgb[..., 0]
        rays = look(scene, camera, rw.Whitted(depth, contribution=0, ambient=1.0), samples=512)
        # If all samples agree, all may have missed a sliver of a pixel.
        assert np.all(np.abs(rgb - rays.rgb[..., 0]) <= 5 * rays.standard_error[..., 0] + 0.02)
        assert rgb.mean() == pytest.approx(rays.rgb[..., 0].mean(), rel=0.01)
        for turned in (rgb[::-1], rgb[:, ::-1], rgb.T):
            assert turned == pytest.approx(rgb, abs=1e-6)
        sums.append(rgb.sum())
    assert sums[0] < 0.9 * sums[1] < 0.9 * sums[2]


def turned(mesh, degrees, center):
    sine, cosine = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    turn = np.array([[cosine, 0, sine], [0, 1, 0], [-sine, 0, cosine]])
    return rw.Mesh((np.asarray(mesh.vertices) - center) @ turn.T + center, mesh.faces, material=mesh.material)


def behind_glass(glass):
    wall = quad((-1, -1, -1), (2, -1, -1), (2, 2, -1), (-1, 2, -1), material=rw.Diffuse(0.8))
    brick = block((0.3, 0.2, -0.7), (0.6, 0.5, -0.5), material=rw.Diffuse((0.8, 0.2, 0.1)))
    return rw.Scene([wall, brick, glass], lights=[rw.PointLight((0.5, 0.9, 1.7), 1.0)])


@pytest.mark.parametrize("degrees", [0, 50])
def test_windows_show_what_rays_see_through_them(degrees):
    window = block((0.1, 0.1, 0.2), (0.9, 0.9, 0.4), material=rw.Dielectric(1.5))
    scene = behind_glass(turned(window, degrees, (0.5, 0.5, 0.3)))
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=30, width=16, height=16)
    beams = look(scene, camera, rw.integrators.BeamTraced(4, ambient=0.1)).rgb.astype(float)
    rays = look(scene, camera, rw.Whitted(4, ambient=0.1, contribution=0), samples=1024)
    off = np.abs(beams - rays.rgb) - 1e-3 * rays.rgb
    assert np.all(off <= 4.5 * rays.standard_error + 1e-6)


def seen_at(ior, height, depth, at, across):
    """Return the tangent x at which an eye over water sees what lies at x = at in its depth, of a given y."""
    low, high = 0.0, at / height
    for _ in range(60):
        x = 0.5 * (low + high)
        out = np.hypot(x, across)
        sine = np.sin(np.arctan(out)) / ior
        reach = (height * out + depth * sine / np.sqrt(1 - sine**2)) * x / out
        low, high = (x, high) if reach < at else (low, x)
    return 0.5 * (low + high)


@pytest.mark.parametrize(
    ("fov", "tolerance", "most"), [(2, np.inf, 0.002), (70, 0.02, 0.03), (70, 0.25, 0.3)]
)
def test_what_lies_in_water_is_seen_where_snell_says(fov, tolerance, most):
    ior, height, depth, size = 1.5, 2.0, 3.0, 16
    scale = size / 2 / np.tan(np.radians(fov) / 2)
    # Without refraction the edge would be at the middle of a pixel, two and a half from the picture's middle.
    at = (height + depth) * 4.5 / scale
    wide = 40.0
    water = block((-wide, -wide, -wide), (wide, wide, 0), material=rw.Dielectric(ior))
    paper = quad(
        (-wide / 2, -9, -depth), (at, -9, -depth), (at, 9, -depth), (-wide / 2, 9, -depth), material=PAPER
    )
    camera = rw.Camera((0, 0, height), (0, 0, 0), up=(0, 1, 0), fov=fov, width=size, height=size)
    scene = rw.Scene([water, paper], precision="double")
    rgb = (
        look(scene, camera, rw.integrators.BeamTraced(2, ambient=1.0, tolerance=tolerance))
        .rgb[..., 0]
        .astype(float)
    )
    for row in range(4, 12):
        expected = scale * seen_at(ior, height, depth, at, (row + 0.5 - size / 2) / scale)
        lit = np.flatnonzero(rgb[row] > 0)
        partly = rgb[row, lit[-1]] / rgb[row, lit[-2]]
        if partly > 0.999:
            partly = 1.0
        assert lit[-1] + partly - size / 2 == pytest.approx(expected, abs=most), row


def test_behind_a_window_directions_are_exact():
    paper = [
        quad((-900, -900, -900), (11.3, -900, -900), (47.1, 900, -900), (-900, 900, -900), material=PAPER)
    ]
    window = block((-3, -3, -1), (3, 3, -0.7), material=rw.Dielectric(1.5))
    camera = rw.Camera((0, 0, 0), (0, 0, -1), up=(0, 1, 0), fov=40, width=12, height=12)
    free, seen = (
        look(
            rw.Scene(shapes, precision="double"),
            camera,
            rw.integrators.BeamTraced(3, ambient=1.0, tolerance=np.inf),
        ).rgb
        for shapes in (paper, [*paper, window])
    )
    # The loss is the window's reflectance, the same near and far. The shift by a third of its depth is 2e-3
    # pixels at this distance, and does not change uniform pixels.
    share = seen[..., 0] / np.maximum(free[..., 0], 1e-9)
    covered, clear = free[..., 0] > 0.999, free[..., 0] == 0
    assert np.all(seen[clear] < 1e-6)
    assert share[covered].max() - share[covered].min() < 0.02
    partly = ~covered & ~clear
    assert share[partly] == pytest.approx(np.median(share[covered]), rel=0.02)


def test_a_prism_reflects_all_where_light_cannot_leave():
    corners = [(x, y, z) for y in (0.1, 0.9) for x, z in ((0.1, 0.2), (0.9, 0.2), (0.5, 0.5))]
    faces = [(0, 1, 2), (3, 5, 4), (0, 4, 1), (0, 3, 4), (1, 5, 2), (1, 4, 5), (2, 3, 0), (2, 5, 3)]
    scene = behind_glass(rw.Mesh(corners, faces, material=rw.Dielectric(1.5)))
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=30, width=16, height=16)
    beams = look(scene, camera, rw.integrators.BeamTraced(5, ambient=0.1, tolerance=0.05)).rgb.astype(float)
    rays = look(scene, camera, rw.Whitted(5, ambient=0.1, contribution=0), samples=1024)
    # Edges seen through two faces may be off by a tenth of a pixel; the rest agrees with rays.
    off = np.abs(beams - rays.rgb)
    within = off <= 4.5 * rays.standard_error + 2e-3 * rays.rgb + 1e-6
    assert np.mean(within) > 0.97
    assert beams.mean() == pytest.approx(rays.rgb.mean(), rel=2e-3)


def test_shading_errs_by_less_than_a_thousandth_where_light_is_steep():
    # A lamp two pixels from the wall; means of 16 by 16 finer pixels are the expectation of coarse ones.
    scene = rw.Scene([square(4, 0.0, material=PAPER)], lights=[rw.PointLight((0.13, 0.21, 0.5), 1.0)])
    coarse, fine = (
        look(
            scene,
            rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), fov=40, width=n, height=n),
            rw.integrators.BeamTraced(),
        ).rgb
        for n in (16, 256)
    )
    means = fine[..., 0].astype(float).reshape(16, 16, 16, 16).mean(axis=(1, 3))
    # At the middles of pixels alone it would err by 4 %.
    assert np.abs(coarse[..., 0] / means - 1).max() < 1e-3


FLOOR, SPHERE = square(2, 0), rw.Sphere((0, 0, 0), 1)
GLASS_BLOCK = block((0, 0, 0), (1, 1, 1), material=rw.Dielectric(1.5))
WATER_BLOCK = block((0.5, 0.5, 0.5), (2, 2, 2), material=rw.Dielectric(1.33))
TWO_WAYS = rw.Mix(rw.Dielectric(1.5), rw.ThinDielectric(1.5), 0.5)
BENT = rw.Mesh(FLOOR.vertices, FLOOR.faces, normals=[(0.1, 0, 1)] * 4, material=rw.Dielectric(1.5))
VIEW = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4)
REFUSED = [
    ([SPHERE], {}, VIEW, rw.integrators.BeamTraced(), "beams support only meshes, and shape 0 is none"),
    ([square(1, 0, emission=1.0)], {}, VIEW, rw.integrators.BeamTraced(), "shape 0 is emissive"),
    ([FLOOR, GLASS_BLOCK, WATER_BLOCK], {}, VIEW, rw.integrators.BeamTraced(), "shapes 1 and 2 are of glass"),
    (
        [square(1, 0, material=TWO_WAYS)],
        {},
        VIEW,
        rw.integrators.BeamTraced(),
        "shape 0 refracts in several directions",
    ),
    ([BENT], {}, VIEW, rw.integrators.BeamTraced(), "shape 0 reflects or refracts with shading normals"),
    ([FLOOR], {"environment": 1.0}, VIEW, rw.integrators.BeamTraced(), "the scene has an environment"),
    (
        [FLOOR],
        {"lights": [rw.PointLight((0, 0, 1), 1)] * 65},
        VIEW,
        rw.integrators.BeamTraced(),
        "at most 64 lights",
    ),
]


@pytest.mark.parametrize(("shapes", "more", "view", "way", "says"), REFUSED)
def test_what_they_cannot_do_is_refused_by_name(shapes, more, view, way, says):
    with pytest.raises(ValueError, match=says) as caught:
        look(rw.Scene(shapes, **more), view, way)
    assert "\n" not in str(caught.value)


def test_cameras_and_filters_that_are_none_of_theirs():
    way = rw.integrators.BeamTraced()
    scene = rw.Scene([FLOOR])
    with pytest.raises(ValueError, match="pinhole"):
        look(scene, rw.Orthographic((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4), way)
    with pytest.raises(ValueError, match="BoxFilter"):
        rw.render(scene, VIEW, way, samples=1, filter=rw.rendering.GaussianFilter(), progress=False)


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: rw.integrators.BeamTraced(max_depth=-1), ValueError, "max_depth must be between 0 and"),
        (lambda: rw.integrators.BeamTraced(ambient="much"), TypeError, "ambient"),
        (lambda: rw.integrators.BeamTraced(tolerance=0), ValueError, "tolerance must be greater than 0"),
        (lambda: rw.integrators.BeamTraced(tolerance=np.nan), ValueError, "tolerance must be finite"),
        (lambda: rw.integrators.BeamTraced(tolerance="fine"), TypeError, "tolerance"),
    ],
)
def test_wrong_numbers_are_told_in_a_line(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_any_number_of_threads_makes_the_same_bits():
    scene = rw.Scene(room(rw.Mirror()), lights=LAMPS)
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=38, width=9, height=7)
    pictures = (
        rw.render(scene, camera, rw.integrators.BeamTraced(3), samples=1, threads=n, progress=False)
        for n in (1, 2)
    )
    one, two = (picture.rgb for picture in pictures)
    assert np.array_equal(one, two)
