"""Meshes of Mitsuba's own kinds: compressed files, curves, grids of distances, attributes."""

import re

import numpy as np
import pytest
from mitsuba_files import OCTAHEDRON, curve, dabs, eight, serialized
from PIL import Image

import raywright as rw
from raywright.scene_files import tubes
from raywright.scene_files.mitsuba import sdf_grids

EYE = {"type": "perspective", "film": {"type": "hdrfilm", "width": 8, "height": 4}}


def shape(folder, **values):
    return rw.from_mitsuba({"type": "scene", "eye": EYE, "one": values}, folder=folder).scene.shapes[0]


def volume(mesh):
    """By the divergence theorem: positive where faces turn anticlockwise as seen from outside."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]].astype(np.float64) for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


@pytest.mark.parametrize("version", [3, 4])
@pytest.mark.parametrize("double", [False, True])
def test_compressed_meshes_are_read(tmp_path, version, double):
    (tmp_path / "m.serialized").write_bytes(serialized(version, double))
    gem = shape(tmp_path, type="serialized", filename="m.serialized", shape_index=1, face_normals=True)
    assert np.array_equal(gem.vertices, OCTAHEDRON)
    assert np.array_equal(gem.faces, eight())
    assert np.array_equal(gem.uv, np.array(OCTAHEDRON)[:, :2])
    assert gem.normals is None
    smooth = shape(tmp_path, type="serialized", filename="m.serialized", shape_index=1)
    assert np.allclose(smooth.normals, OCTAHEDRON, rtol=0, atol=1e-12)
    assert len(shape(tmp_path, type="serialized", filename="m.serialized").faces) == 1


def test_compressed_meshes_that_are_broken_are_refused(tmp_path):
    data = serialized()
    path = tmp_path / "m.serialized"

    def refused(given, index=1):
        path.write_bytes(given)
        with pytest.raises(ValueError, match="serialized") as caught:
            shape(tmp_path, type="serialized", filename="m.serialized", shape_index=index)
        assert "\n" not in str(caught.value)
        return str(caught.value)

    assert "has no mesh 2: it has 2" in refused(data, 2)
    assert "is not a serialized mesh" in refused(b"PK" + data[2:])
    assert "of version 9; 3 and 4 are read" in refused(data[:2] + b"\x09" + data[3:], 0)
    for length in range(0, 21, 3):
        refused(data[:length], 0)


def test_vertices_and_faces_have_their_colors(tmp_path):
    (tmp_path / "dabs.ply").write_text(dabs())
    rows = [line.split() for line in dabs().splitlines()]
    given = np.array([row[3:6] for row in rows if len(row) == 6 and row[0] != "property"], float)

    def read(name, **more):
        color = {"type": "mesh_attribute", "name": name, **more}
        return shape(tmp_path, type="ply", filename="dabs.ply", b={"type": "diffuse", "reflectance": color})

    assert np.allclose(read("vertex_color").colors, given, rtol=0, atol=1e-6)
    by_face = read("face_color", scale=0.5)
    assert by_face.material.front.reflectance == rw.textures.ProductTexture(rw.VertexColors(), 0.5)
    # Each face has its own corners, all of one color.
    assert by_face.vertices.shape == (24, 3)
    assert (by_face.colors.reshape(8, 3, 3) == by_face.colors.reshape(8, 3, 3)[:, :1]).all()
    tiles = np.array([row[4:7] for row in rows[-8:]], float)
    assert np.allclose(by_face.colors[::3], tiles, rtol=0, atol=1e-6)
    with pytest.raises(
        ValueError, match=r"dabs.ply has no attribute 'vertex_heat'; of each vertex it has x, y, z, "
    ):
        read("vertex_heat")
    with pytest.raises(ValueError, match="an attribute's name must begin with vertex_ or face_, got 'heat'"):
        read("heat")


@pytest.mark.parametrize("ends", [(0.3, 0.3), (0.2, 0.6)])
def test_a_straight_curve_is_the_hull_of_two_balls(ends):
    """What is hit across its axis is a cone and parts of balls beyond it, less what 48 sides leave out."""
    a, b = ends
    length = 2.0
    tube = tubes.linear([np.array([(0, 0, 0, a), (0, 0, length, b)], float)])
    # The radius at each height, from pole to pole.
    sin = (a - b) / length
    cos = np.sqrt(1 - sin * sin)

    def radius(z):
        balls = np.sqrt(np.maximum(a * a - z * z, 0)), np.sqrt(np.maximum(b * b - (z - length) ** 2, 0))
        return np.select([z < a * sin, z > length + b * sin], balls, (a - sin * z) / cos)

    x, w = np.polynomial.legendre.leggauss(160)
    heights = 0.5 * (length + b - a) + 0.5 * (length + a + b) * x
    # The first hit from outside is on the outermost part.
    hits = rw.Scene(rw.Mesh(tube.vertices, tube.faces)).intersect(
        np.stack([np.full(160, -5.0), np.zeros(160), heights], -1), np.broadcast_to((1.0, 0.0, 0.0), (160, 3))
    )
    found, truth = np.where(hits.hit, 5 - hits.t, 0.0), radius(heights)
    # Chords of 48 sides lie within 0.22 % of the radius, and so do those along a ball.
    assert (found <= truth + 1e-7).all()
    assert abs((w * found**2).sum() / (w * truth**2).sum() - 1) < 2 * 0.0022


def test_b_splines_go_where_they_do(tmp_path):
    """The middle line of a circle's sections is the spline; straight points give a straight tube."""
    (tmp_path / "c.txt").write_text("\n".join(f"0 0 {k} 0.25" for k in range(6)))
    tube = shape(tmp_path, type="bsplinecurve", filename="c.txt")
    radius = np.hypot(*tube.vertices[:, :2].T)
    assert np.allclose(radius, 0.25, rtol=1e-12)
    # From the second to the last point but one, and open at both ends.
    assert np.isclose(tube.vertices[:, 2].min(), 1, rtol=0, atol=1e-12)
    assert np.isclose(tube.vertices[:, 2].max(), 4, rtol=0, atol=1e-12)
    assert np.allclose(tube.normals[:, :2] * 0.25, tube.vertices[:, :2], rtol=0, atol=1e-9)
    a, b, c = (tube.vertices[tube.faces[:, k]] for k in range(3))
    outward = np.cross(b - a, c - a)[:, :2]
    assert (np.einsum("ij,ij->i", outward, (a + b + c)[:, :2]) > 0).all()
    assert (tube.uv.min(), tube.uv.max()) == (0, 1)
    # The transform moves points, and leaves radii as they are.
    large = shape(tmp_path, type="bsplinecurve", filename="c.txt", to_world=np.diag([3.0, 3, 3, 1]))
    assert np.allclose(np.hypot(*large.vertices[:, :2].T), 0.25, rtol=1e-12)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "c.txt holds no curves"),
        ("0 0 0 1\n0 0 1 1", "c.txt has a curve of 2 points, and 4 are needed"),
        ("0 0 0 1\n0 0 one 1", "c.txt, line 2: must be x, y, z and a radius of at least 0"),
        ("0 0 0 -1\n0 0 1 1", "c.txt, line 1: must be x, y, z and a radius"),
    ],
)
def test_curves_that_are_broken_are_refused(tmp_path, text, told):
    (tmp_path / "c.txt").write_text(text)
    with pytest.raises(ValueError, match=re.escape(told)):
        shape(tmp_path, type="bsplinecurve", filename="c.txt")


def vol(grid):
    z, y, x = grid.shape
    head = (
        b"VOL\x03"
        + np.array([1, x, y, z, 1], "<i4").tobytes()
        + np.array([0, 0, 0, 1, 1, 1], "<f4").tobytes()
    )
    return head + grid.astype("<f4").tobytes()


def bilinear(heights, x, y):
    """The height over points of the square from (-1, -1) to (1, 1)."""
    rows, columns = heights.shape
    u, v = (x + 1) / 2 * (columns - 1), (y + 1) / 2 * (rows - 1)
    i, j = np.minimum(u.astype(int), columns - 2), np.minimum(v.astype(int), rows - 2)
    u, v = u - i, v - j
    a, b, c, d = heights[j, i], heights[j, i + 1], heights[j + 1, i], heights[j + 1, i + 1]
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d)


def test_height_fields_stray_from_their_patches_by_a_sixteenth_of_the_twist(tmp_path):
    random = np.random.default_rng(5)
    heights = random.random((4, 6)).astype(np.float32)
    field = shape(
        tmp_path, type="heightfield", scale=0.5, texture={"type": "bitmap", "data": heights, "raw": True}
    )
    twist = np.abs(np.diff(np.diff(0.5 * heights, axis=0), axis=1)).max()
    x, y = random.uniform(-1, 1, (2, 5000))
    down = np.broadcast_to((0.0, 0.0, -1.0), (5000, 3))
    hits = rw.Scene(field).intersect(np.stack([x, y, np.full(5000, 9.0)], -1), down)
    off = np.abs(9 - hits.t - bilinear(0.5 * heights, x, y))
    # The deviation is greatest in the middle of a half edge, and bounded.
    assert 0.5 * twist / 16 < off.max() < 1.0001 * twist / 16
    # Along edges and in the middle the mesh equals the patch; rows are along y, from below.
    u, v = (np.arange(6) / 2.5 - 1), (np.arange(4) / 1.5 - 1)
    assert np.allclose(field.vertices[:24, 2], 0.5 * heights.reshape(-1), rtol=0, atol=1e-7)
    assert np.allclose(
        field.vertices[:24, :2], np.stack(np.meshgrid(u, v), -1).reshape(-1, 2), rtol=0, atol=1e-7
    )
    middles = field.vertices[24:]
    assert np.allclose(middles[:, 2], bilinear(0.5 * heights, *middles[:, :2].T), rtol=0, atol=1e-7)
    assert np.allclose(field.uv, (field.vertices[:, :2] + 1) / 2, rtol=0, atol=1e-7)


def test_height_fields_of_old_files_lie_as_their_picture_says(tmp_path):
    """A slope of one along x, from a picture of a file, as Mitsuba 0.6 has it."""
    Image.fromarray(np.array([(0, 255), (0, 255)], np.uint8)).save(tmp_path / "slope.png")
    (tmp_path / "scene.xml").write_text(
        """<scene version="0.5.0">
            <sensor type="perspective"/>
            <shape type="heightfield">
                <string name="filename" value="slope.png"/>
                <float name="scale" value="2"/>
                <boolean name="flipNormals" value="true"/>
                <transform name="toWorld"><translate z="3"/></transform>
            </shape>
        </scene>""",
        encoding="utf-8",
    )
    field = rw.load(tmp_path / "scene.xml").scene.shapes[0]
    assert np.allclose(field.vertices[:, 2], field.vertices[:, 0] + 4, rtol=0, atol=1e-6)
    assert np.allclose(field.normals, np.array((1, 0, -1)) / np.sqrt(2), rtol=0, atol=1e-6)
    a, b, c = field.vertices[field.faces[0]]
    assert np.cross(b - a, c - a)[2] < 0
    plain = shape(tmp_path, type="heightfield", filename="slope.png", shading_normals=False)
    assert plain.normals is None


@pytest.mark.parametrize(
    ("values", "told"),
    [
        ({}, "either filename or one texture of type bitmap"),
        ({"data": np.zeros((2, 2))}, "either filename or one texture of type bitmap"),
        (
            {"texture": {"type": "bitmap", "data": np.zeros((1, 2, 1)), "raw": True}},
            r"2 columns, got \(1, 2\)",
        ),
        ({"texture": {"type": "bitmap", "data": np.full((2, 2, 1), np.nan), "raw": True}}, "must be finite"),
        ({"filename": "none.exr"}, "none.exr"),
    ],
)
def test_height_fields_that_are_none_are_refused(tmp_path, values, told):
    with pytest.raises((ValueError, FileNotFoundError), match=told):
        shape(tmp_path, type="heightfield", **values)


def test_grids_of_distances_have_their_surface(tmp_path):
    """Of a ball's distances on 24³ points it is where linear interpolation has 0."""
    axis = np.linspace(0, 1, 24)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    grid = np.sqrt((x - 0.5) ** 2 + (y - 0.45) ** 2 + (z - 0.55) ** 2) - 0.3
    (tmp_path / "ball.vol").write_bytes(vol(grid))
    mesh = shape(tmp_path, type="sdfgrid", filename="ball.vol")
    distance = np.linalg.norm(mesh.vertices - (0.5, 0.45, 0.55), axis=1)
    # A chord of a cell's length h within a ball of radius r strays by h² / 8r at most, in 3 directions.
    assert np.abs(distance - 0.3).max() < 3 * (1 / 23) ** 2 / (8 * 0.3)
    # The volume error is three times that.
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi * 0.3**3, rel=9 * (1 / 23) ** 2 / (8 * 0.3**2))
    outward = (mesh.vertices - (0.5, 0.45, 0.55)) / distance[:, None]
    assert np.einsum("ij,ij->i", mesh.normals, outward).min() > 0.99
    # Closed: every edge belongs to two faces.
    edges = np.sort(
        np.concatenate([mesh.faces[:, [0, 1]], mesh.faces[:, [1, 2]], mesh.faces[:, [2, 0]]]), axis=1
    )
    assert (np.unique(edges, axis=0, return_counts=True)[1] == 2).all()
    plain = shape(tmp_path, type="sdfgrid", grid=grid[..., None], normals="analytic")
    assert plain.normals is None


def test_a_grid_of_distances_has_the_first_color_of_its_texture_all_over():
    """As Mitsuba has u and v of them: 0."""
    z, y, x = np.meshgrid(*3 * [np.linspace(0, 1, 8)], indexing="ij")
    grid = np.sqrt((x - 0.5) ** 2 + (y - 0.5) ** 2 + (z - 0.5) ** 2) - 0.3
    colors = {"color0": {"type": "rgb", "value": 0.8}, "color1": {"type": "rgb", "value": 0.1}}
    squares = {"type": "checkerboard", "to_uv": [[5, 0, 0], [0, 5, 0], [0, 0, 1]], **colors}
    eye = {
        "type": "orthographic",
        "to_world": [[-0.1, 0, 0, 0.5], [0, 0.1, 0, 0.5], [0, 0, -0.1, 3], [0, 0, 0, 1]],
    }
    shot = rw.from_mitsuba(
        {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": 2},
            "eye": {**eye, "film": {"type": "hdrfilm", "width": 4, "height": 4}},
            "sky": {"type": "constant"},
            "one": {
                "type": "sdfgrid",
                "grid": grid,
                "normals": "analytic",
                "bsdf": {"type": "diffuse", "reflectance": squares},
            },
        }
    )
    seen = shot.render(samples=16, progress=False).rgb
    assert seen.min() > 0.79
    assert seen.max() < 0.81


def test_a_plane_in_a_grid_is_a_plane():
    grid = np.broadcast_to(np.linspace(-0.3, 0.7, 5)[:, None, None], (5, 4, 3))
    found = sdf_grids.surface(grid)
    assert np.allclose(found.vertices[:, 2], 0.3, rtol=0, atol=1e-9)
    assert np.allclose(found.normals, (0, 0, 1), rtol=0, atol=1e-12)
    a, b, c = (found.vertices[found.faces[:, k]] for k in range(3))
    assert np.isclose(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, 1.0, rtol=1e-9)


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"VOX", "g.vol cannot be read: it does not begin as a .vol file does"),
        (vol(np.ones((3, 3, 3))), "a grid must have numbers on both sides of 0"),
        (vol(np.ones((3, 3, 3)))[:-4], "g.vol says 3 x 3 x 3 numbers, but holds 26"),
        (vol(np.ones((1, 3, 3))), "a grid must have at least 2 points along each axis, got (3, 3, 1)"),
        (vol(np.full((3, 3, 3), np.nan)), "a grid must be finite"),
    ],
)
def test_grids_that_are_broken_are_refused(tmp_path, data, told):
    (tmp_path / "g.vol").write_bytes(data)
    with pytest.raises(ValueError, match=re.escape(told)):
        shape(tmp_path, type="sdfgrid", filename="g.vol")


def test_curves_of_files_are_parted_by_empty_lines(tmp_path):
    (tmp_path / "curve.txt").write_text(curve())
    both = shape(tmp_path, type="linearcurve", filename="curve.txt")
    # 5 and 4 points: 7 straight pieces and 9 balls.
    assert len(both.vertices) == 7 * 2 * 49 + 9 * 25 * 49


def test_a_map_of_normals_goes_with_the_normal_where_coordinates_are_mirrored(tmp_path):
    """Mitsuba leans normals along u, and along what is at right angles to it and the normal, not along v."""

    def quads(*lefts):
        """Unit squares side by side, as a PLY, some of whose v goes down rather than up."""
        corners, faces = [], []
        for k, left in enumerate(lefts):
            faces += [(3, *(4 * k + i for i in face)) for face in ((0, 1, 2), (0, 2, 3))]
            for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corners.append((x + k - len(lefts) / 2, y - 0.5, 0, x, 1 - y if left else y))
        header = ["ply", "format ascii 1.0", f"element vertex {len(corners)}"]
        header += [f"property float {name}" for name in ("x", "y", "z", "u", "v")]
        header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
        return "\n".join([*header, *(" ".join(map(str, row)) for row in (*corners, *faces))]) + "\n"

    def shot(*lefts):
        name = f"{''.join(str(int(left)) for left in lefts)}.ply"
        (tmp_path / name).write_text(quads(*lefts))
        tilt = {"type": "rawconstant", "value": [0.6, 0.8, 0.9]}
        matt = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 0.5}}
        return rw.from_mitsuba(
            {
                "type": "scene",
                "integrator": {"type": "direct"},
                "eye": {
                    "type": "orthographic",
                    "to_world": [[-1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 3], [0, 0, 0, 1]],
                    "film": {"type": "hdrfilm", "width": 8, "height": 2, "rfilter": {"type": "box"}},
                },
                "sun": {"type": "directional", "direction": [0.0, -0.3, -1.0]},
                "one": {
                    "type": "ply",
                    "filename": name,
                    "face_normals": True,
                    "bsdf": {"type": "twosided", "a": {"type": "normalmap", "normalmap": tilt, "b": matt}},
                },
            },
            folder=tmp_path,
        )

    def picture(*lefts):
        return shot(*lefts).render(samples=4, progress=False).rgb

    straight = picture(False, False)
    lean = np.array((0.2, 0.6, 0.8)) / np.linalg.norm((0.2, 0.6, 0.8))
    cosine = lean @ np.array((0, 0.3, 1)) / np.hypot(0.3, 1)
    # The function of Estevez, Lecocq and Stein (2019), with the slopes of the normal and of the light.
    share = 2 / (1 + np.sqrt(1 + (0.2**2 + 0.6**2) / 0.8**2 / 8 * 0.3**2))
    assert np.allclose(straight[:, 2:6], 0.5 / np.pi * cosine * share, rtol=1e-6)
    assert np.array_equal(picture(True, True), straight)
    assert np.array_equal(picture(True, False), straight)
    parts = shot(True, False).scene.shapes
    assert [len(part.faces) for part in parts] == [2, 2]
    assert len(shot(True, True).scene.shapes) == 1


def test_balls_at_the_joints_of_curves_have_coordinates_as_mitsuba_has_them(tmp_path):
    """Mitsuba (3.9.1) shows the ball of a joint as of the segment before it, and v as at its end."""
    (tmp_path / "zig.txt").write_text("-1 0 -1 0.1\n-0.5 0 1 0.1\n-0.25 0 -1 0.1\n0 0 1 0.1\n")
    mesh = shape(tmp_path, type="linearcurve", filename="zig.txt")
    zig = rw.Scene(mesh)
    points = np.array([[-1, 0, -1], [-0.5, 0, 1], [-0.25, 0, -1], [0, 0, 1.0]])
    for k, point in enumerate(points):
        before = max(k, 1) - 1
        axis = points[before + 1] - points[before]
        axis /= np.linalg.norm(axis)
        rot = np.array((0, 0, 1)) - axis * axis[2]
        rot /= np.linalg.norm(rot)
        rad = np.cross(rot, axis)
        # Outwards, so that the ray only hits the ball.
        beside = [points[j] for j in (k - 1, k + 1) if 0 <= j < len(points)]
        outwards = point - np.mean(beside, axis=0)
        outwards = outwards / np.linalg.norm(outwards) + (0.1, 0.3, 0)
        outwards /= np.linalg.norm(outwards)
        hit = zig.intersect(point + 2 * outwards, -outwards)
        weights = np.array([1 - hit.uv.sum(), *hit.uv])
        u, v = weights @ np.asarray(mesh.uv)[np.asarray(mesh.faces)[hit.primitive_id]]
        expected = np.arctan2(rot @ outwards, rad @ outwards) / (2 * np.pi) % 1
        assert np.isclose(u, expected, rtol=0, atol=2e-3)
        assert np.isclose(v, k / 3, rtol=0, atol=1e-6)
