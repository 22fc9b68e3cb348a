"""Scenes in which light is found by few samples, beside some in which it is not: quick to render."""

from itertools import product

import numpy as np

import raywright as rw

GRAY = rw.Diffuse(0.6)
BLACK = rw.Diffuse(0.0)
EYE = (0.4, 0.4, 1.7)


def _quad(*corners, **how):
    return rw.Mesh(np.array(corners, float), [[0, 1, 2], [0, 2, 3]], **how)


def _room(low, high, without):
    """The six walls of a box but one, by its axis and side."""
    walls = []
    for axis, side in product(range(3), range(2)):
        if (axis, side) != without:
            corners = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = np.zeros(3)
                corner[axis] = (low, high)[side][axis]
                corner[(axis + 1) % 3] = (low, high)[a][(axis + 1) % 3]
                corner[(axis + 2) % 3] = (low, high)[b][(axis + 2) % 3]
                corners.append(corner)
            walls.append(_quad(*corners, material=GRAY))
    return walls


def _wall_with_hole(low, high):
    """The wall of a room of 4 by 4 by 3 at x = 4, open between two corners in y and z."""
    (y, z), (v, w) = low, high
    parts = [((0, 0), (4, z)), ((0, w), (4, 3)), ((0, z), (y, w)), ((v, z), (4, w))]
    return [_quad((4, a, b), (4, c, b), (4, c, d), (4, a, d), material=GRAY) for (a, b), (c, d) in parts]


def _camera(target, fov, side):
    return rw.Camera(EYE, target, up=(0, 0, 1), fov=fov, width=side, height=side)


def sun_through_glass(side):
    """A room whose light comes from the sky, and from a hazy sun, through a pane of glass."""
    radius = np.radians(4.5)
    way = np.array((1.0, 0.15, 0.9)) / np.linalg.norm((1.0, 0.15, 0.9))
    radiance = 4 / (np.pi * np.sin(radius) ** 2)
    sun = rw.Sphere(tuple((2, 2, 0) + 1000 * way), 1000 * np.sin(radius), material=BLACK, emission=radiance)
    pane = rw.Box((4.0, 1.2, 1.0), (4.02, 2.8, 2.4), material=rw.Dielectric(1.5))
    walls = [*_room((0, 0, 0), (4, 4, 3), (0, 1)), *_wall_with_hole((1.2, 1.0), (2.8, 2.4))]
    return rw.Scene([*walls, pane, sun], environment=0.3), _camera((2.6, 2.6, 0.8), 75, side)


def keyhole(side):
    """A room whose light comes from a lamp in the next, through a hole of 12 by 12 cm."""
    walls = [*_room((0, 0, 0), (4, 4, 3), (0, 1)), *_wall_with_hole((1.94, 1.34), (2.06, 1.46))]
    beyond = _room((4, 0, 0), (7, 4, 3), (0, 0))
    corners = [(5.5, 1.6, 2.9), (6.2, 1.6, 2.9), (6.2, 2.4, 2.9), (5.5, 2.4, 2.9)]
    lamp = _quad(*corners, material=BLACK, emission=rw.Emission(6000.0, side="both"))
    return rw.Scene([*walls, *beyond, lamp]), _camera((2.8, 2.8, 1.0), 75, side)


def small_lamp(side):
    """A lamp of 4 mm over a plate of silver, in view: few of a pixel's samples meet it."""
    lamp = rw.Sphere((2.6, 2.4, 1.2), 0.004, material=BLACK, emission=2e4)
    corners = [(1.8, 1.6, 0.4), (3.4, 1.6, 0.4), (3.4, 3.2, 0.4), (1.8, 3.2, 0.4)]
    plate = _quad(*corners, material=rw.Conductor("Ag", alpha=0.05))
    return rw.Scene([*_room((0, 0, 0), (4, 4, 3), None), plate, lamp]), _camera((2.8, 2.6, 0.9), 60, side)


def many_lamps(side):
    """A hundred lamps of all colors in a room, each smaller than a pixel."""
    rng = np.random.default_rng(1)
    lamps = [
        rw.Sphere(tuple(place), 0.015, material=BLACK, emission=tuple(rng.uniform(20, 100, 3)))
        for place in rng.uniform((0.8, 0.8, 0.2), (3.8, 3.8, 2.8), (100, 3))
    ]
    return rw.Scene([*_room((0, 0, 0), (4, 4, 3), None), *lamps]), _camera((2.8, 2.8, 1.2), 70, side)


def mesh_in_a_sky(side):
    """A knot under a sky that is the same everywhere."""
    scene, camera = rw.scenes.studio(rw.scenes.torus_knot(), width=side, height=side)
    return rw.Scene(scene.shapes[:-2], environment=1.0), camera


def cornell(side):
    """The Cornell box."""
    return rw.scenes.cornell_box(width=side, height=side)


def plates(side):
    """Veach's plates."""
    return rw.scenes.veach_plates(width=side, height=side)


def glass_spheres(side):
    """Caustics of a ball of glass and of a mirror."""
    return rw.scenes.glass_spheres(width=side, height=side)
