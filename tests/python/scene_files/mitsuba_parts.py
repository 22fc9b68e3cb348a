"""What the scenes of `mitsuba_scenes` are put together from, in Mitsuba's format."""

import numpy as np

# Of pictures, in pixels.
SIZE = 32


def rgb(*value):
    return {"type": "rgb", "value": list(value) if len(value) > 1 else value[0]}


def matrix(position, right, up, forward, scale=(1.0, 1.0, 1.0)):
    """What stands at a position with its axes so, as nested lists."""
    columns = [np.array(axis, float) * s for axis, s in zip((right, up, forward), scale, strict=True)]
    return [[*(float(c[i]) for c in columns), float(position[i])] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def moved(x, y, z, scale=1.0, turn=0.0):
    """Scaled, turned about z by some degrees, and moved."""
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    return matrix((x, y, z), (c, s, 0), (-s, c, 0), (0, 0, 1), np.broadcast_to(scale, 3))


def looking(origin, target, up=(0, 0, 1)):
    """Along +z to the target, with +x to the left."""
    forward = np.subtract(target, origin) / np.linalg.norm(np.subtract(target, origin))
    left = np.cross(up, forward)
    left /= np.linalg.norm(left)
    return matrix(origin, left, np.cross(forward, left), forward)


EYE = looking((0.5, -5.0, 2.5), (0.0, 0.0, 0.6))


def plate(*scale):
    """Upright before the camera."""
    facing = np.array(looking((0, 0, 1), (0.5, -5, 2.5)))
    return (facing @ np.diag([*scale, 1.0])).tolist()


FLOOR = {"type": "rectangle", "to_world": moved(0, 0, 0, 4.0), "bsdf": {"type": "diffuse"}}
LAMP = {
    "type": "rectangle",
    "to_world": matrix((1, -1, 4), (1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "emitter": {"type": "area", "radiance": rgb(9.0, 8.0, 7.0)},
}
# To the camera and some degrees upwards and to its right.
NEAR_NORMAL = {
    "type": "directional",
    "to_world": looking((1.2, -5, 3.7), (0, 0, 1)),
    "irradiance": rgb(3.0),
}
SKY = {"type": "constant", "radiance": rgb(0.5, 0.6, 0.8)}


def scene(depth=4, sensor=None, **parts):
    """A scene of parts, seen by a pinhole unless told otherwise."""
    eye = {"type": "perspective", "to_world": EYE, **(sensor or {})}
    if eye["type"] != "orthographic" and "focal_length" not in eye:
        eye.setdefault("fov", 40.0)
    eye.setdefault("film", {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}})
    eye["sampler"] = {"type": "independent", "sample_count": 16}
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": depth},
        "sensor": eye,
        **parts,
    }


def ball(bsdf, **more):
    return {"type": "sphere", "center": [0.0, 0.0, 1.0], "radius": 1.0, "bsdf": bsdf, **more}


def checks(*scale, a=0.7, b=0.15):
    return {
        "type": "checkerboard",
        "color0": rgb(a),
        "color1": rgb(b, b, 2 * b),
        "to_uv": matrix((0.1, 0.2, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (*scale, 1.0)),
    }


def picture(name, **more):
    return {"type": "bitmap", "filename": name, **more}


GOLD = {"eta": rgb(0.19, 0.54, 1.33), "k": rgb(3.4, 2.23, 1.87)}
# Seen from above, facets scatter little light onto others. So Mitsuba's energy loss, compensated here, does
# not show.
ROUGH = {"distribution": "ggx", "alpha": 0.03}
TILED = {**FLOOR, "bsdf": {"type": "diffuse", "reflectance": checks(3.0, 3.0)}}
