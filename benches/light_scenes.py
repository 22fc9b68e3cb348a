"""Eight scenes that ask different things of those who carry light, from a matt room to lamps behind glass."""

import numpy as np
from render_peers_mitsuba import by_constants

import raywright as rw

GRAY = rw.Diffuse(0.6)
BLACK = rw.Diffuse(0.0)


def _quad(*corners, **how):
    return rw.Mesh(np.array(corners, float), [[0, 1, 2], [0, 2, 3]], **how)


def _rectangle(axis, at, low, high, **how):
    """Return a rectangle across an axis, between two corners of the other two axes."""
    (a, b), (c, d) = low, high
    corners = np.zeros((4, 3))
    corners[:, axis] = at
    corners[:, (axis + 1) % 3] = (a, c, c, a)
    corners[:, (axis + 2) % 3] = (b, b, d, d)
    return _quad(*corners, **how)


def keyhole(width, height):
    """Return a room whose light comes from a lamp in the next room, through a hole of 12 by 12 cm."""
    walls = [
        _rectangle(axis, at, (0, 0), ((4, 3), (3, 7), (7, 4))[axis], material=GRAY)
        for axis, ends in enumerate(((0, 7), (0, 4), (0, 3)))
        for at in ends
    ]
    hole = [
        ((0, 0), (4, 1.34)),
        ((0, 1.46), (4, 3)),
        ((0, 1.34), (1.94, 1.46)),
        ((2.06, 1.34), (4, 1.46)),
    ]
    between = [_rectangle(0, 4, low, high, material=GRAY) for low, high in hole]
    # Facing up and down, a millimeter apart.
    lamp = [
        _rectangle(2, at, low, high, material=BLACK, emission=6000.0)
        for at, low, high in ((2.9, (5.5, 1.6), (6.2, 2.4)), (2.899, (5.5, 2.4), (6.2, 1.6)))
    ]
    camera = rw.Camera((0.4, 0.4, 1.7), (2.8, 2.8, 1.0), up=(0, 0, 1), fov=75, width=width, height=height)
    return rw.Scene([*walls, *between, *lamp]), camera


def behind_glass(width, height):
    """Return a lamp in a ball of glass over a floor, and a block of glass that the floor is seen through."""
    floor = _quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3), material=GRAY)
    back = _quad((-3, 0, -3), (3, 0, -3), (3, 4, -3), (-3, 4, -3), material=GRAY)
    shell = rw.Sphere((0, 2.2, 0), 0.5, material=rw.Dielectric(1.5))
    lamp = rw.Sphere((0, 2.2, 0), 0.08, material=BLACK, emission=300.0)
    block = rw.Box((-1.2, 0.01, -0.6), (1.2, 0.6, 1.2), material=rw.Dielectric(1.3))
    camera = rw.Camera((0, 2.6, 5.2), (0, 0.7, 0), fov=42, width=width, height=height)
    return rw.Scene([floor, back, shell, lamp, block]), camera


def lens(width, height):
    """Return a point light over a floor, and a ball of glass between them."""
    floor = _quad((-3, 0, 3), (3, 0, 3), (3, 0, -3), (-3, 0, -3), material=GRAY)
    ball = rw.Sphere((0, 1.2, 0), 0.6, material=rw.Dielectric(1.5))
    camera = rw.Camera((2.2, 2.4, 3.6), (0, 0.3, 0), fov=40, width=width, height=height)
    return rw.Scene([floor, ball], lights=[rw.PointLight((0, 3.2, 0), 12.0)]), camera


def mirror_room(width, height):
    """Return a ball of silver in the Cornell box."""
    scene, camera = rw.scenes.cornell_box(width=width, height=height)
    low, high = np.min([s.bounds[0] for s in scene.shapes], 0), np.max([s.bounds[1] for s in scene.shapes], 0)
    middle = (low + high) / 2
    size = (high - low).min()
    ball = rw.Sphere(
        (middle[0], low[1] + 0.75 * size, middle[2]), 0.15 * size, material=rw.Conductor("silver")
    )
    return by_constants(rw.Scene([*scene.shapes, ball], scene.lights, scene.environment), camera)


def plates(width, height):
    """Return Veach's plates."""
    return by_constants(*rw.scenes.veach_plates(width=width, height=height))


SCENES = {
    "Cornell": rw.scenes.cornell_box,
    "plates": plates,
    "glass spheres": rw.scenes.glass_spheres,
    "many lights": rw.scenes.many_lights,
    "mirror room": mirror_room,
    "keyhole": keyhole,
    "behind glass": behind_glass,
    "lens": lens,
}
