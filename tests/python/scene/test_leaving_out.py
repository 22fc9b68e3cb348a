"""What is not needed takes no memory: of two scenes, the one that has more holds exactly that more."""

import numpy as np
import pytest

import raywright as rw

RNG = np.random.default_rng(0)
COUNT = 300
VERTICES = RNG.uniform(-1, 1, (COUNT, 3)).astype(np.float32)
FACES = np.arange(COUNT).reshape(-1, 3)
NORMALS = RNG.normal(size=(COUNT, 3))
UV = RNG.uniform(0, 1, (COUNT, 2))
COLORS = RNG.uniform(0, 1, (COUNT, 3))

PLAIN = rw.Diffuse()
CHECKED = rw.Diffuse(rw.Checker())
COLORED = rw.Diffuse(rw.VertexColors())

# All consecutive meshes with vertex values share one table entry of three words.
ENTRY = 12


def mesh(material=PLAIN, **more):
    return rw.Mesh(VERTICES, FACES, material=material, **more)


def held(*shapes):
    return rw.Scene(shapes).bytes


@pytest.mark.parametrize(
    ("material", "more", "each"),
    [
        (PLAIN, {"uv": UV}, 0),
        (PLAIN, {"colors": COLORS}, 0),
        (CHECKED, {"colors": COLORS}, 0),
        (COLORED, {"uv": UV}, 0),
        (rw.Diffuse(rw.textures.Noise()), {"uv": UV, "colors": COLORS}, 0),
        (CHECKED, {"uv": UV}, 8),
        (COLORED, {"colors": COLORS}, 12),
        (CHECKED, {"uv": UV, "colors": COLORS}, 8),
        (PLAIN, {"normals": NORMALS}, 12),
    ],
)
def test_of_vertices_only_what_is_asked_for_is_kept(material, more, each):
    wanted = COUNT * each + (ENTRY if each else 0)
    assert held(mesh(material, **more)) - held(mesh(material)) == wanted
    # A group stores the same as a scene.
    inside, without = (rw.Instance(mesh(material, **kept), np.eye(4)) for kept in (more, {}))
    assert held(inside) - held(without) == wanted


@pytest.mark.parametrize("where", range(3))
def test_a_mesh_that_has_none_is_not_filled_up_beside_one_that_has_some(where):
    def meshes(**more):
        return [mesh(CHECKED, **(more if i == where else {})) for i in range(3)]

    assert held(*meshes(uv=UV)) - held(*meshes()) == COUNT * 8 + ENTRY
    assert held(*meshes(normals=NORMALS)) - held(*meshes()) == COUNT * 12 + ENTRY


def test_neighbors_with_values_share_an_entry():
    some, none = mesh(CHECKED, uv=UV), mesh(CHECKED)
    assert held(some, some, none) - held(none, none, none) == 2 * COUNT * 8 + ENTRY
    assert held(some, none, some) - held(none, none, none) == 2 * (COUNT * 8 + ENTRY)


def test_each_mesh_has_its_own_coordinates_and_normals_among_those_that_have_none():
    corners = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], float)
    slopes = [np.array([(x, 0.0, 1.0)] * 4) / np.hypot(x, 1) for x in (0.1, 0.3)]
    both = iter(slopes)
    shapes = [
        rw.Mesh(
            corners + np.array((2 * i, 0, 0)),
            [(0, 1, 2), (0, 2, 3)],
            normals=next(both) if i % 2 else None,
            uv=corners[:, :2] / 4 + i / 8 if i % 2 else None,
            material=CHECKED,
        )
        for i in range(5)
    ]
    # A pixel for each, and for each gap between them.
    camera = rw.Orthographic((4.5, 0.5, 9), (4.5, 0.5, 0), scale=9, scale_axis="x", width=9, height=1)
    names = ("uv", "shading_normal")
    together = rw.aovs(rw.Scene(shapes), camera, names)
    for i, shape in enumerate(shapes):
        alone = rw.aovs(rw.Scene(shape), camera, names)
        assert all(np.array_equal(together[name][0, 2 * i], alone[name][0, 2 * i]) for name in names)
        np.testing.assert_allclose(together["shading_normal"][0, 2 * i, 0], (0, 0.1, 0, 0.3, 0)[i], atol=0.02)


def test_what_stands_still_keeps_no_second_place():
    there = np.tile(np.eye(4), (50, 1, 1))
    there[:, 0, 3] = np.arange(50)
    none, still = held(mesh()), held(rw.Instance(mesh(), there))
    moving = held(rw.Instance(mesh(), there, transform_end=there))
    # A matrix and its inverse against two matrices of twelve float64, plus a second box in the nodes above.
    assert still - none < 160 * 50
    assert moving - still > 96 * 50


def test_hits_hold_no_array_that_was_not_asked_for():
    scene = rw.Scene(mesh())
    hits = scene.intersect(np.zeros((1000, 3)), np.array((1.0, 0.1, 0.2)))
    arrays = {name for name, value in vars(hits).items() if isinstance(value, np.ndarray)}
    assert arrays == {"t", "shape_id", "primitive_id", "uv"}
    # One number seen from every index.
    assert hits.instance_id.strides == (0,)
    assert not (hits.instance_id != -1).any()
