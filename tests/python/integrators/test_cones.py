"""Solid cones: exact shares of solid angles, and pictures of one cone per pixel."""

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


# Half angles of the cone and of a sphere, and the angle between, in degrees; their common solid angle, in
# steradians, and its share of the cone.
CAPS = [
    ((10, 5, 12), 0.00518813004400439, 0.0543511794252946),
    ((40, 60, 50), 0.893351850795718, 0.607728086778201),
    ((0.001, 30, 30.0002), 3.57459326971932e-10, 0.373527022080118),
]


@pytest.mark.parametrize(("degrees", "solid_angle", "share"), CAPS)
def test_a_cone_sees_of_a_sphere_what_caps_share(degrees, solid_angle, share):
    _, ball, between = np.radians(degrees)
    # Ten away; the sine is that of the sphere's half angle.
    center = 10 * np.array([np.sin(between), 0, np.cos(between)])
    scene = rw.Scene([rw.Sphere(center, 10 * np.sin(ball))])
    found = scene.cone_coverage((0, 0, 0), (0, 0, 3), degrees[0])
    # The angle between comes back from the center's coordinates within 2e-16, which moves the smallest cone's
    # share by 2e-11 of itself.
    assert found.solid_angle == pytest.approx(solid_angle, rel=1e-8)
    assert found.share == pytest.approx(share, rel=1e-8)


def test_faces_cover_exactly_and_inner_edges_never_show():
    rng = np.random.default_rng(4)
    axes, angles = rng.normal(size=(40, 3)), rng.uniform(0.01, 80, 40)
    # All around, from within: a closed mesh covers every cone, whatever its edges.
    inside = rw.Scene([block((-1, -2, -1.5), (1.3, 1, 2))])
    assert inside.cone_coverage((0.1, -0.2, 0.3), axes, angles).share == pytest.approx(1, abs=1e-10)
    # A floor that goes to the horizon covers half of a level cone.
    half = rw.Scene([square(1e7, -1.0)])
    assert half.cone_coverage((0, 0, 0), (1, 0, 0), 30.0).share == pytest.approx(0.5, abs=1e-6)
    # A square seen from above its middle, all within the cone: its solid angle in closed form.
    one = rw.Scene([square(1.0, -2.0), square(0.3, -2.5)])
    found = one.cone_coverage((0, 0, 0), (0, 0, -1), [60.0, 70.0])
    assert found.solid_angle == pytest.approx(4 * np.arcsin(1 / 5), abs=1e-12)
    assert found.share[0] > found.share[1]


def test_shares_are_those_of_rays_through_faces_that_hide_each_other():
    rng = np.random.default_rng(8)
    corners = rng.normal(size=(30, 3, 3)) * (1, 1, 0.6) - (0, 0, 4)
    scene = rw.Scene(rw.Mesh(corners.reshape(-1, 3), np.arange(90).reshape(-1, 3)))
    count = 20_000
    for angle in (3.0, 20.0, 60.0):
        # Evenly over the cone.
        cosine = 1 - (1 - np.cos(np.radians(angle))) * rng.random(count)
        sine, turn = np.sqrt(1 - cosine**2), 2 * np.pi * rng.random(count)
        ways = np.stack([sine * np.cos(turn), sine * np.sin(turn), -cosine], axis=1)
        met = scene.occluded((0, 0, 0), ways).mean()
        share = scene.cone_coverage((0, 0, 0), (0, 0, -1), angle).share
        # One in a hundred thousand seeds is beyond 4.5 standard errors.
        assert abs(share - met) < 4.5 * np.sqrt(max(share * (1 - share), 1e-4) / count)


def test_spheres_blend_behind_each_other():
    near, far = rw.Sphere((0, 0, -5), 0.5), rw.Sphere((0, 0, -9), 1.5)
    share = [rw.Scene(s).cone_coverage((0, 0, 0), (0, 0, -1), 20).share for s in ([near], [far], [near, far])]
    assert share[2] == pytest.approx(1 - (1 - share[0]) * (1 - share[1]), abs=1e-14)
    wall = square(50, -20)
    both = rw.Scene([near, wall]).cone_coverage((0, 0, 0), (0, 0, -1), 20)
    assert both.share == pytest.approx(1, abs=1e-12)
    assert rw.Scene([wall]).cone_coverage((0, 0, 0), (0, 0, -1), 20, t_max=19).share == 0


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


def test_an_edge_covers_pixels_to_within_the_roundness_of_cones():
    camera = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), fov=40, width=16, height=12)
    slope, at = 0.3, 0.137
    left = quad((-9, -9, 0), (at - 9 * slope, -9, 0), (at + 9 * slope, 9, 0), (-9, 9, 0), material=PAPER)
    image = look(rw.Scene([left]), camera, rw.integrators.ConeTraced(ambient=1.0), samples=2)
    # A cone is round: it has more or less of a pixel at an edge, and all or nothing of others.
    exact = edge(camera, slope, at)
    assert np.abs(image.rgb[..., 0] - exact).max() < 0.15
    assert image.rgb[..., 0].mean() == pytest.approx(exact.mean(), rel=1e-2)
    assert np.all(image.standard_error == 0)


def test_an_even_wall_has_no_edges():
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(2, 2.0)
    scene = rw.Scene([rw.Mesh(ball.vertices, ball.faces, material=rw.Diffuse(0.8))])
    camera = rw.Camera((0.1, 0.2, 0.3), (1, 0.4, 0.2), fov=70, width=12, height=9)
    # Half the light at a reflectance of 0.8; at 1e-6 a gap of a millionth of a cone would show.
    assert look(scene, camera, rw.integrators.ConeTraced(ambient=0.5)).rgb == pytest.approx(0.4, abs=1e-6)


def test_a_mirror_shows_cones_what_stands_before_it():
    # Behind a flat mirror is the same scene again.
    mirrored = rw.Scene([square(9, -2, material=rw.Mirror()), square(1.5, 1.0, material=PAPER)])
    behind = rw.Scene([square(1.5, -5.0, material=PAPER)])
    camera = rw.Camera((0.3, 0.2, 0.5), (0.3, 0.2, -2), up=(0, 1, 0), fov=60, width=15, height=15)
    a, b = (look(s, camera, rw.integrators.ConeTraced(ambient=1.0)).rgb for s in (mirrored, behind))
    assert a == pytest.approx(b, abs=2e-6)


def test_a_ball_hides_a_round_lamp_as_caps_share():
    # Seen from the floor below both, the ball and the lamp are caps about nearly the same direction.
    lamp = rw.Sphere((0, 0, 10), 1.0, material=rw.Diffuse(0), emission=100.0)
    ball = rw.Sphere((0.25, 0, 5), 0.3)
    camera = rw.Camera((0, -6, 3), (0, 0, 0), up=(0, 0, 1), fov=0.5, width=1, height=1)
    floor = square(4, 0.0, material=rw.Diffuse(0.6))
    free = look(rw.Scene([floor, lamp]), camera, rw.integrators.ConeTraced()).rgb[0, 0, 0]
    half = look(rw.Scene([floor, lamp, ball]), camera, rw.integrators.ConeTraced()).rgb[0, 0, 0]
    # Irradiance of a sphere overhead, π L sin², reflected by the floor with 0.6 / π.
    assert free == pytest.approx(0.6 * 100 / 10**2, rel=1e-3)
    only = rw.Scene([ball]).cone_coverage((0, 0, 1e-6), (0, 0, 1), np.degrees(np.arcsin(0.1))).share
    assert 0.1 < only < 0.9
    assert half / free == pytest.approx(1 - only, rel=2e-3)


def test_rough_metal_shows_an_edge_as_blurred_as_rays_do():
    # A plate of silver under the end of a wide white wall, seen from nearly straight above: at grazing angles
    # a part of a wide cone is below the plate and lost.
    silver = rw.Conductor("Ag", alpha=0.15)
    plate = square(20, 0.0, material=silver)
    corners = [(0, -60, 10), (120, -60, 10), (120, 60, 10), (0, 60, 10)]
    wall = quad(*corners, material=rw.Diffuse(0), emission=rw.Emission(1.0, side="both"))
    lit = quad(*corners, material=PAPER)
    camera = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), fov=15, width=20, height=4)
    # Cones see surfaces under an even light; rays get an emitter of the same radiance.
    cones = (
        look(rw.Scene([plate, lit]), camera, rw.integrators.ConeTraced(ambient=1.0)).rgb[..., 1].astype(float)
    )
    rays = look(rw.Scene([plate, wall]), camera, rw.Path(max_depth=1, guiding="none"), samples=2048).rgb[
        ..., 1
    ]
    cones, rays = cones.mean(axis=0), rays.mean(axis=0)
    assert rays.min() < 0.1 * rays.max()
    # A uniform cone has no tails, which have less than a tenth of the reflected light.
    assert np.abs(cones - rays).max() < 0.1
    assert cones.sum() == pytest.approx(rays.sum(), rel=0.03)
    # At roughness 0 it is the mirror's own picture.
    plates = [square(20, 0.0, material=rw.Conductor("Ag", alpha=alpha)) for alpha in (0.0, 1e-3)]
    one, other = (
        look(rw.Scene([smooth, lit]), camera, rw.integrators.ConeTraced(ambient=1.0)).rgb for smooth in plates
    )
    assert np.abs(one - other).max() < 0.03


def test_cones_see_no_moire_in_a_chequered_floor():
    pattern = rw.Checker(0.0, 1.0, transform=rw.textures.UvTransform(scale=(40, 40)))
    floor = rw.Mesh(
        [(-20, 0, -20), (-20, 0, 20), (20, 0, 20), (20, 0, -20)],
        [(0, 1, 2), (0, 2, 3)],
        uv=[(0, 0), (0, 1), (1, 1), (1, 0)],
        material=rw.Diffuse(pattern),
    )
    scene = rw.Scene([floor])
    camera = rw.Camera((0, 1, 19), (0, 0.4, 0), fov=50, width=24, height=24)
    cones = look(scene, camera, rw.integrators.ConeTraced(ambient=1.0)).rgb[..., 0].astype(float)
    rays = look(scene, camera, rw.Whitted(ambient=1.0), samples=256).rgb[..., 0]
    lit = rays > 0.05
    # In the far rows all squares blur into gray, and rows have the mean.
    assert np.abs(cones.mean(1) - rays.mean(1)).max() < 0.08
    assert abs(cones[lit].mean() - rays[lit].mean()) < 0.02


FLOOR = square(2, 0)
VIEW = rw.Camera((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4)
MASKED = square(2, 0, material=rw.Mask(rw.Diffuse(0.5), 0.5))
GLASS_BALL = rw.Sphere((0, 0, 0), 1, material=rw.Dielectric(1.5))
REFUSED = [
    ([rw.Torus((0, 0, 0), (0, 0, 1), 1, 0.2)], {}, "shape 0 is neither"),
    ([FLOOR, rw.Instance(FLOOR, np.eye(4))], {}, "shape 1 is neither"),
    ([GLASS_BALL], {}, "shape 0 is of glass"),
    ([MASKED], {}, "shape 0 has a mask"),
    ([FLOOR], {"environment": 1.0}, "do not support environments"),
]


@pytest.mark.parametrize(("shapes", "more", "says"), REFUSED)
def test_what_cones_cannot_do_is_refused_by_name(shapes, more, says):
    with pytest.raises(ValueError, match=says) as caught:
        look(rw.Scene(shapes, **more), VIEW, rw.integrators.ConeTraced())
    assert "\n" not in str(caught.value)


def test_cameras_and_filters_that_are_none_of_theirs():
    scene, way = rw.Scene([FLOOR]), rw.integrators.ConeTraced()
    with pytest.raises(ValueError, match="pinhole"):
        look(scene, rw.Orthographic((0, 0, 5), (0, 0, 0), up=(0, 1, 0), width=4, height=4), way)
    with pytest.raises(ValueError, match="BoxFilter"):
        rw.render(scene, VIEW, way, samples=1, filter=rw.rendering.GaussianFilter(), progress=False)


def covered(half_angle, **kwargs):
    return rw.Scene([FLOOR]).cone_coverage((0, 0, 1), (0, 0, 1), half_angle, **kwargs)


@pytest.mark.parametrize(
    ("call", "error", "says"),
    [
        (lambda: rw.integrators.ConeTraced(contribution=1), ValueError, "contribution must be at least 0"),
        (lambda: rw.integrators.ConeTraced(max_depth=1.5), TypeError, "max_depth"),
        (lambda: rw.integrators.ConeTraced(ambient="much"), TypeError, "ambient"),
        (lambda: covered(0), ValueError, "half_angle must be above 0"),
        (lambda: covered([10.0, 0.0]), ValueError, "half_angle must be above 0"),
        (lambda: covered(90), ValueError, "half_angle must be at least"),
        (lambda: covered("wide"), TypeError, "half_angle"),
        (lambda: covered(10, t_max=np.nan), ValueError, "t_max"),
        (
            lambda: rw.Scene([rw.Torus((0, 0, 0), (0, 0, 1), 1, 0.2)]).cone_coverage(*"xyz"),
            TypeError,
            "half_angle",
        ),
        (
            lambda: rw.Scene([FLOOR, rw.Plane((0, 0, 0), (0, 0, 1))]).cone_coverage((0, 0, 1), (0, 0, 1), 5),
            ValueError,
            "shape 1 is neither",
        ),
    ],
)
def test_wrong_numbers_are_told_in_a_line(call, error, says):
    with pytest.raises(error, match=says):
        call()


def test_any_number_of_threads_makes_the_same_bits():
    box = [block((0.2, 0, 0.3), (0.45, 0.5, 0.55)), rw.Sphere((0.7, 0.3, 0.3), 0.2, material=rw.Mirror())]
    scene = rw.Scene([square(1, -0.1), *box], lights=[rw.PointLight((0.5, 0.6, 1.7), 1.0)])
    camera = rw.Camera((0.5, 0.5, 2.6), (0.5, 0.5, 0), up=(0, 1, 0), fov=38, width=9, height=7)
    one, two = (
        rw.render(scene, camera, rw.integrators.ConeTraced(3), samples=1, threads=n, progress=False).rgb
        for n in (1, 2)
    )
    assert np.array_equal(one, two)
    rng = np.random.default_rng(2)
    cones = rng.normal(size=(2, 50, 3)) + 0.5
    many = scene.cone_coverage(cones[0], cones[1], 20.0)
    assert many.share.shape == (50,)
    assert np.array_equal(many.share, scene.cone_coverage(cones[0], cones[1], 20.0, threads=1).share)
    assert np.isnan(scene.cone_coverage((np.nan, 0, 0), (0, 0, 1), 20.0).share)
    # An invalid direction touches nothing, for cones as for rays.
    nowhere = scene.cone_coverage((0, 0, 5), [(0, 0, 0), (0, 0, np.inf), (0, 0, -1)], 20.0)
    assert nowhere.share[:2].tolist() == nowhere.solid_angle[:2].tolist() == [0, 0]
    assert nowhere.share[2] == scene.cone_coverage((0, 0, 5), (0, 0, -1), 20.0).share
    assert scene.cone_coverage(np.zeros((0, 3)), (0, 0, 1), 20.0).share.shape == (0,)


def test_cones_are_compared_with_distributed_rays():
    lamp = rw.Sphere((0.3, 0, 3), 0.2, material=rw.Diffuse(0), emission=20.0)
    scene = rw.Scene([square(2, 0.0, material=rw.Diffuse(0.6)), rw.Sphere((0, 0, 0.6), 0.3), lamp])
    camera = rw.Camera((0, -4, 3), (0, 0, 0), up=(0, 0, 1), width=12, height=12)
    cones = look(scene, camera, rw.integrators.ConeTraced(), samples=2)
    rays = look(scene, camera, rw.integrators.Distributed(), samples=512)
    # A small round lamp and a ball: soft shadows differ where one cone per pixel is shaded at one point.
    assert cones.error.estimate == 0
    assert cones.rgb.mean() == pytest.approx(rays.rgb.mean(), rel=5e-3)
    assert np.abs(cones.rgb - rays.rgb).max() < 0.03
    ways = {"cones": rw.integrators.ConeTraced(), "rays": rw.integrators.Distributed()}
    contest = rw.report.convergence(scene, camera, ways, seconds=0.1, seeds=1)
    assert set(contest.column("contender")) == {"cones", "rays"}
